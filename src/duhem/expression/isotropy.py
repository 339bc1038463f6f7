"""Formulas that do not change when the stress is turned: functions of the principal stresses."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

import sympy as sp

from duhem.expression.vocabulary import EigMax

__all__ = ["shears_of_isotropic"]


def shears_of_isotropic(g: sp.Expr, forces: Sequence[sp.Symbol]) -> tuple[sp.Symbol, ...] | None:
    """The shear components among six forces, the normal ones first, if g(R sigma R^T) = g(sigma) for all rotations R; else None.

    Every part of g that is a polynomial of the forces has the rate 0 along two rotations, which generate all others.
    """
    if len(forces) != 6:
        return None
    for shear in permutations(forces[3:]):
        if _invariant(g, (*forces[:3], *shear)):
            return shear
    return None


def _matrix(entries: Sequence[sp.Expr]) -> sp.Matrix:
    xx, yy, zz, yz, xz, xy = entries
    return sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _turns() -> tuple[sp.Matrix, ...]:
    """About z and about x."""
    return sp.Matrix([[0, -1, 0], [1, 0, 0], [0, 0, 0]]), sp.Matrix([[0, 0, 0], [0, 0, -1], [0, 1, 0]])


def _rate(poly: sp.Expr, stress: Sequence[sp.Symbol], turn: sp.Matrix) -> sp.Expr:
    sigma = _matrix(stress)
    moved = turn * sigma - sigma * turn
    rates = (moved[0, 0], moved[1, 1], moved[2, 2], moved[1, 2], moved[0, 2], moved[0, 1])
    return sp.expand(sp.Add(*(sp.diff(poly, x) * r for x, r in zip(stress, rates, strict=True))))


def _invariant(node: sp.Basic, stress: Sequence[sp.Symbol]) -> bool:
    if not node.free_symbols & set(stress):
        return True
    if isinstance(node, EigMax):
        return all(a.is_polynomial(*stress) for a in node.args) and _covariant(_matrix(node.args), stress)
    if isinstance(node, sp.Expr) and node.is_polynomial(*stress):
        return all(_rate(node, stress, turn) == 0 for turn in _turns())
    if not (node.is_Add or node.is_Mul):
        return all(_invariant(a, stress) for a in node.args)
    plain = [a for a in node.args if a.is_polynomial(*stress)]
    return _invariant(node.func(*plain), stress) and all(_invariant(a, stress) for a in node.args if a not in plain)


def _covariant(matrix: sp.Matrix, stress: Sequence[sp.Symbol]) -> bool:
    """Whether the matrix turns with the stress."""
    return all(
        sp.expand(_rate(matrix[i, j], stress, turn) - (turn * matrix - matrix * turn)[i, j]) == 0
        for turn in _turns()
        for i in range(3)
        for j in range(i + 1)
    )
