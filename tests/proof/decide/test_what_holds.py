"""Questions of every kind that hold and are decided, and what is undefined somewhere and is not."""

from __future__ import annotations

import pytest
import sympy as sp

from duhem.expression import Neg, Norm, Pos, Where, symbol
from duhem.proof.decide import Budget, Question, Sense, decide

x, y, p = symbol("x"), symbol("y"), symbol("p", positive=True)
N, P, Z = Sense.NONNEGATIVE, Sense.POSITIVE, Sense.ZERO
BOX = (sp.Ge(x, -1), sp.Le(x, 1))
THIRD = sp.Rational(1, 3)

HOLDS: list[tuple[sp.Expr, Sense, tuple[sp.Basic, ...]]] = [
    (1 / (x**2 + 1) - x / (x**2 + 1) + 1, P, ()),
    (1 / x, P, (sp.Gt(x, 0),)),
    (-1 / x, P, (sp.Lt(x, 0),)),
    (1 / (1 / x + 1), N, (sp.Gt(x, 0),)),
    (x / y + y / x - 2, N, (sp.Gt(x, 0), sp.Gt(y, 0))),
    (1 / x**3 + 1 / x, P, (sp.Gt(x, 0),)),
    ((x - p) ** 2 / p, N, ()),
    (1 / (1 / (x - 1) - 1 / (x + 1)) - (x**2 - 1) / 2, Z, (sp.Gt(x, 1),)),
    (sp.pi - x**2, P, BOX),
    (x * y / (x**2 + y**2) + sp.S.Half, N, (sp.Ne(x, 0),)),
    (sp.sqrt(x**2 + 1) - 1, N, ()),
    (sp.sqrt(x), N, (sp.Ge(x, 0),)),
    (1 / sp.sqrt(x) - THIRD, P, (sp.Gt(x, 0), sp.Lt(x, 4))),
    (sp.sqrt(1 / x) - THIRD, P, (sp.Gt(x, 0), sp.Lt(x, 4))),
    (sp.sqrt(x / y) + 1, P, (sp.Ge(x, 0), sp.Gt(y, 0))),
    (sp.sqrt(x + 1) ** 3 - 1, N, (sp.Ge(x, 0),)),
    (x**THIRD - x, N, (*BOX[1:], sp.Ge(x, 0))),
    (sp.sqrt(sp.sqrt(x) + 1) - 1, N, (sp.Ge(x, 0),)),
    (Norm(x, y) - x, N, ()),
    (Norm(x, y) ** 2 - x**2 - y**2, Z, ()),
    (Norm(x, y) - 1, Z, (sp.Eq(x**2 + y**2, 1),)),
    (1 / Norm(x, y), P, (sp.Gt(x**2 + y**2, 0),)),
    (sp.Abs(x) - x, N, ()),
    (sp.Max(x, y) - y, N, ()),
    (1 - sp.Min(x, 1), N, ()),
    (Pos(x) + Neg(x) - sp.Abs(x), Z, ()),
    (Pos(x) - Neg(x) - x, Z, ()),
    (Where(sp.Gt(x, 0), x + 1, 1), P, ()),
    (Where(sp.Ge(x, 0), x + 1, 1 - x), P, ()),
    (sp.Abs(x) / x, P, (sp.Gt(x, 0),)),
    (x - 1, N, (sp.Ge(sp.Abs(x), 1), sp.Gt(x, 0))),
    (sp.exp(x) * (x**2 - 2 * x + 2), P, ()),  # by its factors
    (sp.exp(x) * (y - 1) ** 2 * sp.Abs(y), N, ()),
    (sp.exp(x) * (x**2 - x + 1) * y, P, (sp.Gt(y, 1),)),
    (sp.sqrt(2) + sp.pi - 3 * sp.exp(x / 5), P, BOX),  # each word lies between two numbers
    (sp.log(x) + 1, P, (sp.Ge(x, 1), sp.Le(x, 2))),
]
ROUND: list[tuple[sp.Expr, Sense, tuple[sp.Basic, ...]]] = [
    (2 - x - y, P, ()),
    (x * y + sp.S.Half, N, ()),
    (Norm(x, y) - 1, Z, ()),
    (sp.exp(x) + y + 1, P, ()),
    (sp.Abs(x) + sp.Abs(y) - 1, N, ()),
    (x - 1, Z, (sp.Eq(y, 0), sp.Ge(x, 0))),
    (y**2 - 1, Z, (sp.Ge(x, 0), sp.Ge(-x, 0))),
]


@pytest.mark.slow
@pytest.mark.parametrize(("circle", "table"), [(None, HOLDS), ((x, y), ROUND)], ids=["free", "on the circle"])
def test_decided(circle: tuple[sp.Symbol, sp.Symbol] | None, table: list[tuple[sp.Expr, Sense, tuple[sp.Basic, ...]]]) -> None:
    def holds(expr: sp.Expr, sense: Sense, given: tuple[sp.Basic, ...]) -> bool:
        return decide(Question(expr, sense, given, circle)).holds is True

    assert [row for row in table if not holds(*row)] == []


UNDEFINED: list[tuple[sp.Expr, tuple[sp.Basic, ...]]] = [
    (sp.Abs(x) / x + 2, BOX),
    (sp.Abs(x / p) / x + 2 / p, BOX),
    (x * sp.Abs(1 / x) + 2, BOX),
    (Where(sp.Gt(1 / x, 0), 1, 2), BOX),
    (Where(sp.Gt(sp.sqrt(x), 1), 1, 2), BOX),
    (Where(sp.Gt(sp.log(x), 0), 1, 2), BOX),
    (Where(sp.Gt(sp.tan(2 * x), 0), 1, 2), BOX),
    (sp.Max(1, 1 / x), BOX),
    (sp.Max(1, sp.sqrt(x)), BOX),
    (sp.Max(1, sp.log(x)), BOX),
    (sp.Max(1, sp.tan(2 * x)), BOX),
    (sp.Abs(sp.log(x) + 1) + 1, BOX),
    (Norm(1 / x, 1), BOX),
    (Norm(sp.sqrt(x), 1), BOX),
    (sp.sqrt(1 / x) + 1, (sp.Ge(x, 0),)),
    (sp.sqrt(y / x) + 1, (sp.Ge(x, 0), sp.Ge(y, 1))),
    (1 / (1 / x + 1) + 1, (sp.Ge(x, 0),)),
    (1 / (1 / x + 1) + 1, (sp.Ge(x, 0), sp.Le(x, 0))),
    (1 / (y + 1 / x) + 1, (sp.Eq(x, 0), sp.Gt(y, 1))),
    (x / y + 1, (sp.Eq(x, 0),)),
    (x * sp.sqrt(y) + 1, (sp.Eq(x, 0),)),
    (x * sp.log(y) + 1, (sp.Eq(x, 0), sp.Ge(y, 0))),
    (x / sp.sqrt(y) + 1, (sp.Eq(x, 0), sp.Ge(y, 0))),
    (-sp.log(x), (sp.Lt(x, 1),)),
    (-sp.log(x) / 2, (sp.Lt(x, 1), sp.Ge(x, 0))),
    (sp.acos(x), (sp.Lt(x, 1),)),
    (-sp.asin(x), (sp.Lt(x, 0),)),
    (sp.sqrt(x - 1) * sp.sqrt(x - 2) + 3, (sp.Eq(x, 0),)),
    (Where(sp.Gt(y, 0), x / y, 1 / y) + 2, (sp.Eq(x, 0), sp.Gt(y, -1))),
]


@pytest.mark.parametrize(("expr", "given"), UNDEFINED)
def test_undefined_somewhere(expr: sp.Expr, given: tuple[sp.Basic, ...]) -> None:
    """Wherever it is defined it is positive; that is not enough."""
    question = Question(expr, P, given)
    assert decide(question, Budget(100_000)).holds is not True


def test_a_quotient_of_quotients_keeps_its_factor() -> None:
    """(x**2 - 1)/2 is less than x**2 - 1, and twice that more."""
    assert decide(Question(1 / (1 / (x - 1) - 1 / (x + 1)) - (x**2 - 1), N, (sp.Gt(x, 1),))).holds is False


def test_what_is_0_by_any_of_the_relations_that_say_so() -> None:
    """And both ends of the circle, where its other coordinate is."""
    both = [(sp.Ge(x, 0), sp.Le(x, 0)), (sp.Ge(x, 0), sp.Ge(-x, 0)), (sp.Le(0, x), sp.Ge(0, x)), (sp.Le(x, 0), sp.Le(-x, 0))]
    for given in ((sp.Eq(x, 0),), *both):
        assert decide(Question(x, Z, given)).holds is True and decide(Question(x * y + x, Z, given)).holds is True
        assert decide(Question(Norm(x, y) - sp.Abs(y), Z, given)).holds is True
        assert decide(Question(y**2 - 1, Z, given, (x, y))).holds is True
        assert decide(Question(y, N, given, (x, y))).holds is decide(Question(-y, N, given, (x, y))).holds is False
        assert decide(Question(1 / x, N, given)).holds is decide(Question(x / y, N, given)).holds is None
    assert decide(Question(y, N, (sp.Eq(x, 0), sp.Gt(x + 1, 2)))).holds is True  # nowhere
    for given in ((), (sp.Ge(x, 0),), (sp.Ge(x, -1), sp.Le(x, 0)), (sp.Ne(x, 0),)):
        assert decide(Question(x, Z, given)).holds is False
