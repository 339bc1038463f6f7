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
    (1 / x, P, (sp.Gt(x, 0),)),
    (-1 / x, P, (sp.Lt(x, 0),)),
    (1 / (1 / x + 1), N, (sp.Gt(x, 0),)),
    (x / y + y / x - 2, N, (sp.Gt(x, 0), sp.Gt(y, 0))),
    (1 / x**3 + 1 / x, P, (sp.Gt(x, 0),)),
    ((x - p) ** 2 / p, N, ()),
    (1 / (1 / (x - 1) - 1 / (x + 1)) - (x**2 - 1) / 2, Z, (sp.Gt(x, 1),)),
    (sp.pi - x**2, P, BOX),
    (sp.sqrt(x**2 + 1) - 1, N, ()),
    (sp.sqrt(x), N, (sp.Ge(x, 0),)),
    (1 / sp.sqrt(x) - THIRD, P, (sp.Gt(x, 0), sp.Lt(x, 4))),
    (sp.sqrt(x / y) + 1, P, (sp.Ge(x, 0), sp.Gt(y, 0))),
    (sp.sqrt(x + 1) ** 3 - 1, N, (sp.Ge(x, 0),)),
    (sp.sqrt(sp.sqrt(x) + 1) - 1, N, (sp.Ge(x, 0),)),
    (Norm(x, y) ** 2 - x**2 - y**2, Z, ()),
    (sp.Abs(x) - x, N, ()),
    (Pos(x) + Neg(x) - sp.Abs(x), Z, ()),
    (Pos(x) - Neg(x) - x, Z, ()),
    (sp.Abs(x) / x, P, (sp.Gt(x, 0),)),
    (x - 1, N, (sp.Ge(sp.Abs(x), 1), sp.Gt(x, 0))),
    (sp.exp(x) * (y - 1) ** 2 * sp.Abs(y), N, ()),
    (sp.sqrt(2) + sp.pi - 3 * sp.exp(x / 5), P, BOX),  # each word lies between two numbers
    (sp.log(x) + 1, P, (sp.Ge(x, 1), sp.Le(x, 2))),
]


@pytest.mark.parametrize(("expr", "sense", "given"), HOLDS)
def test_decided(expr: sp.Expr, sense: Sense, given: tuple[sp.Basic, ...]) -> None:
    assert decide(Question(expr, sense, given)).holds is True


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
    assert decide(Question(1 / (1 / (x - 1) - 1 / (x + 1)) - (x**2 - 1), N, (sp.Gt(x, 1),))).holds is None
