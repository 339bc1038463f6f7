"""Directions along which a formula does not change: all of them, and none that is none."""

from __future__ import annotations

import pytest
import sympy as sp

from duhem.expression.invariance import invariant_directions

X, Y, Z = FORCES = sp.symbols("x y z", real=True)
K = sp.Symbol("k", real=True)


@pytest.mark.parametrize(
    ("g", "dimensions"),
    [
        (X**2 + Y**2 - 1, 1),
        (X**2 - 2 * X * Y + Y**2 + Z**2, 1),
        (X**2 - 2 * X * Y + Y**2 * (1 + sp.Rational(1, 10**12)) + Z**2, 0),
        (sp.expand((X - 2 * Y + Z) ** 4) - K, 2),
        (sp.expand((X - 2 * Y + Z) ** 4) - K * Z, 1),
        ((X - 2 * Y + Z) ** 4 - K, 2),
        (sp.expand((K * X - K * Y) ** 3 + (X - Y) * K), 2),
        (sp.expand((X - Y) ** 2 * (1 + sp.sqrt(2))) + Z, 1),
        (sp.sqrt(2) * X - sp.sqrt(3) * Y + Z**3, 0),
        (X + Y - K, 2),
        (X**3 + Y**4 + Z - 1, 0),
        (sp.Abs(X - Y) + Z**2, 1),
    ],
)
def test_how_many_there_are(g: sp.Expr, dimensions: int) -> None:
    found = invariant_directions(g, FORCES)
    assert sp.Matrix(found).rank() == len(found) == dimensions if found else not dimensions
    t = sp.Symbol("t", real=True)
    for v in found:
        moved = g.subs({x: x + c * t for x, c in zip(FORCES, v, strict=True)}, simultaneous=True)
        assert sp.expand(moved - g) == 0
        assert all(c.is_Integer for c in v)


def test_a_constant_has_none_worth_telling() -> None:
    assert invariant_directions(K - 1, FORCES) == []
