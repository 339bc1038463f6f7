"""Factors by FLINT beside SymPy's: the same numbers, factors and signs."""

from __future__ import annotations

from random import Random

import pytest
import sympy as sp

from duhem.proof.decide.factoring import factor_list

X = sp.symbols("x y z", real=True)


def drawn(rng: Random) -> sp.Expr:
    def part() -> sp.Expr:
        return sp.Add(*(rng.randint(-3, 3) * sp.Mul(*(x ** rng.randint(0, 2) for x in X)) for _ in range(3))) + rng.randint(-2, 2)

    scale = sp.Rational(rng.choice([-6, -1, 1, 4]), rng.choice([1, 2, 9]))
    return scale * sp.Mul(*(part() ** rng.choice([1, 1, 2, 3]) for _ in range(rng.choice([1, 2, 3]))))


@pytest.mark.parametrize("seed", range(40))
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
