"""What a formula needs to be defined, word by word, and what of that another form of it no longer shows."""

from __future__ import annotations

from collections.abc import Iterable

import pytest
import sympy as sp

from duhem.expression import Atan2, Norm, Where, symbol
from duhem.expression.number import InertNumber
from duhem.proof.decide import Question, Sense
from duhem.proof.decide.question import NEAR_RIGHT, Obligation, obligations

x, y, r, q = symbol("x"), symbol("y"), symbol("r"), symbol("q", nonzero=True)
p, n = symbol("p", positive=True), symbol("n", nonnegative=True)
N, P, Z = Sense.NONNEGATIVE, Sense.POSITIVE, Sense.ZERO
NEAR = tuple(Obligation(NEAR_RIGHT + side * x, P, "takes the tangent of") for side in (-1, 1))
UP, DOWN = sp.Gt(x, 0), sp.Le(x, 0)
Row = tuple[sp.Expr, Sense, *tuple[sp.Basic, ...]]


def asked(needs: Iterable[Obligation]) -> set[Question]:
    return {Question(*need.asked, need.given) for need in needs}


@pytest.mark.parametrize(
    ("expr", "needs"),
    [
        (x**2 + y * Norm(x, y) + sp.Abs(x) + sp.exp(x) + sp.sin(y) + sp.atan(x), []),
        (sp.log(x), [(x, P)]),
        (sp.asin(x), [(1 - x, N), (1 + x, N)]),
        (sp.acos(x), [(1 - x, N), (1 + x, N)]),
        (Atan2(x, y), [(x**2 + y**2, P)]),
        (Atan2(x, q), []),
        (sp.tan(x), [(sp.cos(x) ** 2, P)]),
        (sp.sqrt(x), [(x, N)]),
        (1 / sp.sqrt(x), [(x, P)]),
        (x**p, [(x, N)]),
        (x**-p, [(x, P)]),
        (x**n, [(x, P)]),  # 0^0
        (x**r, [(x, P)]),
        (1 / x, [(x**2, P)]),
        (x**-3, [(x**2, P)]),
        (1 / (1 / x + 1), [(x**2, P), ((1 / x + 1) ** 2, P)]),
        (sp.Max(sp.log(x), sp.sqrt(y)), [(x, P), (y, N)]),
        (sp.log(sp.sqrt(x)), [(x, N), (sp.sqrt(x), P)]),
        (Where(UP, sp.log(x), 1 / y), [(x, P, UP), (y**2, P, DOWN)]),
        (Where(sp.Gt(1 / y, 0), 1, sp.sqrt(x)), [(y**2, P), (x, N, sp.Le(1 / y, 0))]),
        (1 + Where(UP, Where(sp.Gt(y, 0), 1, sp.log(x)), 2), [(x, P, UP, sp.Le(y, 0))]),
        (sp.sqrt(Where(UP, 1 / x, 1)), [(x**2, P, UP), (Where(UP, 1 / x, 1), N)]),
    ],
)
def test_what_a_formula_needs(expr: sp.Expr, needs: list[Row]) -> None:
    assert asked(obligations(expr)) == {Question(of, sense, tuple(given)) for of, sense, *given in needs}
    assert len(list(obligations(expr))) == len(needs)


@pytest.mark.parametrize(
    ("kind", "args", "needs"),
    [
        (sp.log, (x,), [Obligation(x, P, "takes the logarithm of")]),
        (sp.asin, (x,), [Obligation(1 + s * x, N, "needs for an arc sine that 0 <=") for s in (-1, 1)]),
        (sp.acos, (x,), [Obligation(1 + s * x, N, "needs for an arc cosine that 0 <=") for s in (-1, 1)]),
        (Atan2, (x, y), [Obligation(x**2 + y**2, P, "takes the angle of a point at the squared distance")]),
        (Atan2, (p, y), []),
        (
            sp.tan,
            (x,),
            [Obligation(sp.cos(x), Z, "divides by", instead=NEAR)],
        ),
        (sp.Pow, (x, sp.Integer(2)), []),
        (sp.Pow, (x, sp.S.Zero), []),
        (sp.Pow, (x, sp.S.NegativeOne), [Obligation(x, Z, "divides by")]),
        (sp.Pow, (x, sp.S.Half), [Obligation(x, N, "takes a root of")]),
        (sp.Pow, (x, InertNumber(sp.Rational(-31, 10))), [Obligation(x, P, "takes a root of")]),
        (sp.Pow, (x, InertNumber(sp.Rational(31, 10))), [Obligation(x, N, "takes a root of")]),
        (sp.Pow, (x, -sp.S.Half), [Obligation(x, P, "takes a root of")]),
        (
            sp.Pow,
            (x, y),
            [
                Obligation(
                    x,
                    P,
                    "takes a power of",
                    instead=(Obligation(x, N, "takes a power of"), Obligation(y, P, "takes a power with exponent")),
                )
            ],
        ),
        (sp.exp, (x,), []),
    ],
)
def test_needs_as_they_are_told(kind: type[sp.Basic], args: tuple[sp.Expr, ...], needs: list[Obligation]) -> None:
    assert list(obligations(kind(*args, evaluate=False))) == needs
