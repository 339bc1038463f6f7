"""Factors by FLINT beside SymPy's: the same numbers, factors and signs."""

from __future__ import annotations

from random import Random

import pytest
import sympy as sp

from duhem.derivation.recognise import factor_list, factored
from tests.long import long_but, mostly_long

X = sp.symbols("x y z", real=True)


def drawn(rng: Random) -> sp.Expr:
    def part() -> sp.Expr:
        return sp.Add(*(rng.randint(-3, 3) * sp.Mul(*(x ** rng.randint(0, 2) for x in X)) for _ in range(3))) + rng.randint(-2, 2)

    scale = sp.Rational(rng.choice([-6, -1, 1, 4]), rng.choice([1, 2, 9]))
    return scale * sp.Mul(*(part() ** rng.choice([1, 1, 2, 3]) for _ in range(rng.choice([1, 2, 3]))))


@pytest.mark.slow
@pytest.mark.parametrize("seed", long_but(range(7), range(40)))
def test_the_factors_are_sympys(seed: int) -> None:
    poly = sp.expand(drawn(Random(seed)))
    if poly.is_number:
        return
    number, factors = factor_list(poly)
    expected, others = sp.factor_list(poly)
    assert number == expected and len(factors) == len(others) and set(factors) == set(others)
    assert sp.expand(number * sp.Mul(*(f**n for f, n in factors)) - poly) == 0


def test_other_numbers_are_left_to_sympy() -> None:
    poly = X[0] ** 2 - 2 * sp.sqrt(2) * X[0] + 2
    assert factor_list(poly) == sp.factor_list(poly)


@pytest.mark.parametrize("digits", [10, 20, 100])
def test_large_numbers_are_no_obstacle(digits: int) -> None:
    far = sp.Rational(10**digits + 1, 10**digits)
    poly = sp.expand(-(X[0] - 1) * (X[0] - far) * (X[0] * X[1] - far))
    number, factors = factor_list(poly)
    assert len(factors) == 3 and sp.expand(number * sp.Mul(*(f**n for f, n in factors)) - poly) == 0


A, B, C = sp.symbols("a b c", positive=True)
Q = sp.Symbol("q", real=True)
QUOTIENTS = [
    1 - Q**2, A * B - 2 * A * Q + A, (A + B) / C - A / B, sp.sqrt(A) * sp.sqrt(B) * Q + A * B, A - B, 1 / sp.sqrt(A) - 1 / sp.sqrt(B),
    A ** sp.Rational(3, 2) - B ** sp.Rational(3, 2), A ** sp.Rational(1, 3) + sp.sqrt(A), sp.exp(A) - sp.exp(2 * A), sp.Abs(Q) - Q**2,
    2 * A + sp.Rational(4, 3) * B, 1 / (A + Q) + 1 / (A - Q), sp.Integer(3), Q, A / A**2,
]  # fmt: skip


@pytest.mark.parametrize("expr", QUOTIENTS, ids=str)
def test_a_product_is_the_expression(expr: sp.Expr) -> None:
    found = factored(expr)
    for numbers in ((2, 3, 5, sp.Rational(1, 7)), (sp.Rational(1, 3), 4, 1, -2)):
        here = dict(zip((A, B, C, Q), numbers, strict=True))
        assert abs(sp.N((found - expr).subs(here), 30)) < 1e-25
    assert found.is_Mul or not expr.is_Add or sp.factor(expr).is_Add or found.is_Pow


@pytest.mark.slow
@pytest.mark.parametrize("power", mostly_long([3, 6], 3))
def test_a_large_quotient_of_roots_takes_no_time(power: int) -> None:
    """The condition under which an ellipsoid with five parameters has a size, as its derivation writes it: minutes with SymPy."""
    x, y, c, d = sp.symbols("x y c d", positive=True)
    root = sp.sqrt(x) * sp.sqrt(y) * sp.sqrt(c) * sp.sqrt(d)
    product = sp.expand(
        (2 * root * Q + c * d + x * y) * (2 * root * Q - c * y - x * d) * (x * y + c) ** power * (c * d + Q * root) ** (power - 1)
    )
    below = sp.expand(4 * x * y * c * d * (x * y + c) ** power * (Q**2 - 1) * (c * d + Q * root) ** (power - 1))
    assert len(sp.Mul.make_args(factored(sp.Add(product / below, 0)))) >= 4
    assert sp.simplify(factored(1 - (below - product) / below) - factored(product / below)) == 0
