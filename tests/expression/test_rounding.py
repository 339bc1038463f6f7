"""What a formula in doubles is off by is never more than its running bound, nor is the bound much more; pairs have twice the digits."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp

from duhem.errors import InputError
from duhem.expression import NODES, Norm, Pos, Where, double_double, mpmath_, symbol
from duhem.expression.double_double import Pair, paired
from duhem.expression.error_bounds import bounded
from tests.expression.by_hand import ROWS, x, y

TRUTHS = (sp.StrictGreaterThan, sp.GreaterThan, sp.StrictLessThan, sp.LessThan)
POINTS = np.random.default_rng(5).uniform([-3.9, 0.1], [-0.1, 5.0], (12, 2))
CANCELLING = {
    "difference": (x + y) ** 2 - x**2 - 2 * x * y - y**2 + x / 3,
    "hyperbola": sp.sqrt(1 + x**2 * sp.Rational(1, 10**12)) - 1,
    "pnorm": (sp.Abs(x) ** sp.Rational(7, 3) + sp.Abs(y) ** sp.Rational(7, 3)) ** sp.Rational(3, 7) - y,
    "power": (y - x) ** sp.Rational(5, 2) - (y - x) ** 3 / sp.Rational(3, 2),
    "inverse": 1 / (x + y + sp.Rational(1, 3)) - 1 / (x + y),
    "symbolic": (y + 1) ** x - sp.exp(x * sp.log(y + 1)),
    "kinked": Pos(x + y) - Norm(x, y, 1) + Where(x + y > 0, x, x + sp.Rational(1, 10**9)),
}


def exact(formula: sp.Expr, point: Any) -> Any:
    with mpmath.workdps(60):
        return mpmath.mpf(mpmath_.evaluate(formula, dict(zip((x, y), point, strict=True)), 200))


def off(value: Any, true: Any) -> float:
    with mpmath.workdps(60):
        return float(abs(mpmath.mpf(float(value)) - true))


FORMULAS = {kind.__name__: ROWS[kind][0] for kind in NODES if kind not in TRUTHS} | CANCELLING


@pytest.mark.parametrize("name", FORMULAS)
def test_no_rounding_is_more_than_its_bound(name: str) -> None:
    """Of the doubles given, and of numbers within their own bounds of them."""
    value, bound = bounded(FORMULAS[name], (x, y))(list(POINTS.T), [0.0, 0.0])
    assert all(off(v, exact(FORMULAS[name], p)) <= b for v, b, p in zip(value, bound, POINTS, strict=True))
    wide = 1e-9 * np.abs(POINTS)
    value, bound = bounded(FORMULAS[name], (x, y))(list(POINTS.T), list(wide.T))
    for signs in ((1, 1), (1, -1), (-1, -1), (-1, 1), (0, 1), (1, 0)):
        moved = POINTS + wide * signs
        assert all(off(v, exact(FORMULAS[name], p)) <= b * (1 + 1e-6) for v, b, p in zip(value, bound, moved, strict=True))


@pytest.mark.parametrize("name", FORMULAS)
def test_bounds_are_no_larger_than_they_need_to_be(name: str) -> None:
    """Some hundred roundings of the largest number on the way, here at most some hundreds in size."""
    assert (bounded(FORMULAS[name], (x, y))(list(POINTS.T), [0.0, 0.0])[1] <= 4e-12).all()


def test_what_underflows_is_within_the_bound() -> None:
    value, bound = bounded(x**2, (x,))([np.array([1e-170])], [0.0])
    assert value[0] == 0.0 and 1e-340 <= bound[0] < 1e-322


def test_a_value_that_may_not_exist_has_no_bound() -> None:
    near = np.array([1e-12])
    assert np.isinf(bounded(1 / x, (x,))([near], [1e-11])[1]).all()
    assert np.isinf(bounded(sp.log(x), (x,))([near], [1e-11])[1]).all()
    assert bounded(sp.sqrt(x), (x,))([near], [1e-11])[1][0] >= np.sqrt(1.1e-11)
    z = symbol("z")
    undecided = bounded(Where(x > z, x, 5 + z), (x, z))([near, near], [1e-11, 0.0])
    assert undecided[1][0] >= 5.0


ALGEBRA = {name: formula for name, formula in FORMULAS.items() if paired(formula, (x, y)) is not None}


def test_words_that_pairs_lack_are_named() -> None:
    assert set(ALGEBRA) >= {"difference", "hyperbola", "inverse", "kinked", "Norm", "Abs", "Max"}
    assert not set(ALGEBRA) & {kind.__name__ for kind in double_double.LEFT_OUT}
    assert paired(x ** sp.Rational(1, 3), (x,)) is None
    with pytest.raises(InputError, match="pairs of doubles"):
        double_double.TABLE[sp.Pow](x ** sp.Rational(1, 3), Pair(1.0, 0.0), Pair(1.0, 0.0))


@pytest.mark.parametrize("name", ALGEBRA)
def test_pairs_have_thirty_digits(name: str) -> None:
    program = paired(ALGEBRA[name], (x, y))
    assert program is not None
    told, sound = program([Pair(p, np.full(len(p), 0.0)) for p in POINTS.T], len(POINTS))
    bound = bounded(ALGEBRA[name], (x, y))(list(POINTS.T), [0.0, 0.0])[1]
    assert sound.all()
    for high, low, b, point in zip(*told, bound, POINTS, strict=True):
        with mpmath.workdps(60):
            assert abs(mpmath.mpf(float(high)) + mpmath.mpf(float(low)) - exact(ALGEBRA[name], point)) <= 2.0**-44 * b


def test_pairs_know_the_low_part_of_their_arguments_and_their_range() -> None:
    program = paired(x - y, (x, y))
    assert program is not None
    (high, low), _ = program([Pair(np.array([1.0]), np.array([1e-20])), Pair(np.array([1.0]), np.array([0.0]))], 1)
    assert high[0] == 1e-20 and low[0] == 0.0
    square = paired(x**2, (x,))
    assert square is not None
    assert not square([Pair(np.array([1e-200]), np.array([0.0]))], 1)[1].any()
