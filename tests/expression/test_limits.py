"""Limits of formulas that are 0/0: taken where there is one, and never beyond the end of a domain."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from duhem.expression import symbol
from duhem.expression.numpy_ import Filled, compiled, filled

X, Y, Q = symbol("x"), symbol("y"), symbol("q")
R = sp.sqrt(X**2 + Y**2)
AWAY = sp.sqrt((X - 3) ** 2 + (Y + 2) ** 2)


def read(expr: sp.Expr, *points: tuple[float, float, float]) -> list[float]:
    """The formula, with limits, at points (x, y, q)."""
    return [float(v) for v in filled(expr, (X, Y, Q))(*np.array(points, dtype=float).T)]


@pytest.mark.parametrize(
    ("expr", "at", "limit"),
    [
        (X * Y / R - Q, (0.0, 0.0, 1.0), -1.0),
        (X**3 / R**2 + X - Q, (0.0, 0.0, 1e300), -1e300),
        ((X - 3) * (Y + 2) / AWAY - X, (3.0, -2.0, 0.0), -3.0),
        (R**2 * sp.cos(X / R) + 5 * R + 7, (0.0, 0.0, 0.0), 7.0),
        ((X - 3) ** 3 / AWAY**2 + (X - Y) ** 2, (3.0, -2.0, 0.0), 25.0),  # without the terms in h^2
    ],
)
def test_limits_are_found(expr: sp.Expr, at: tuple[float, float, float], limit: float) -> None:
    assert np.isnan(compiled(expr, (X, Y, Q))(*at))
    assert read(expr, at) == [pytest.approx(limit, rel=1e-14)]
    assert isinstance(filled(expr, (X, Y, Q)), Filled)


@pytest.mark.parametrize(
    ("expr", "at"),
    [
        (X * Y / R**2, (0.0, 0.0, 0.0)),  # every way another value
        (X**2 / R**2, (0.0, 0.0, 0.0)),
        (X * Y / R ** sp.Rational(3, 2), (0.0, 0.0, 0.0)),  # tends to 0 too slowly to be sure
        (X / R**3, (0.0, 0.0, 0.0)),
        (sp.sqrt(Y) + X**2 / R - Q, (1.0, -1e-9, 0.0)),  # beyond the end of its domain, however little
        (sp.sqrt(Y) + 0 * Q + X**3 / R**2, (0.0, 0.0, 0.0)),  # on it
        (sp.log(Y) / X, (1.0, -1.0, 0.0)),
        (X * Q / R, (0.0, 0.0, np.nan)),
    ],
)
def test_what_has_no_limit_keeps_none(expr: sp.Expr, at: tuple[float, float, float]) -> None:
    assert not np.isfinite(read(expr, at)).any()


def test_other_points_are_what_they_were() -> None:
    points = np.random.default_rng(0).standard_normal((50, 3))
    points[::7, :2] = 0.0
    expr = X * Y / R - Q
    plain, found = compiled(expr, (X, Y, Q))(*points.T), np.array(read(expr, *map(tuple, points)))
    known = np.isfinite(plain)
    np.testing.assert_array_equal(found[known], plain[known])
    np.testing.assert_allclose(found[~known], -points[~known, 2], rtol=1e-15)
    grid = filled(expr, (X, Y, Q))(np.zeros((2, 3)), 0.0, np.arange(3.0))
    np.testing.assert_allclose(grid, [[0.0, -1.0, -2.0]] * 2, rtol=1e-15, atol=1e-60)


def test_a_formula_without_divisors_costs_nothing_more() -> None:
    assert not isinstance(filled(sp.sqrt(X) + Y * Q, (X, Y, Q)), Filled)
