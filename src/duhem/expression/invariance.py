"""Motions of the forces that do not change g: along directions, in which K is a cylinder over a smaller set, and rotations of a stress.

Along a direction nothing changes where none of the loads in g does, which are affine in the forces: g is a function of the largest ones.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import partial
from itertools import permutations
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from duhem.expression.vocabulary import EigMax, rows

__all__ = ["invariant_directions", "shears_of_isotropic"]


def invariant_directions(g: sp.Expr, forces: Sequence[sp.Symbol]) -> list[tuple[sp.Integer, ...]]:
    """Constant vectors v with v . grad g = 0 identically, by algebra.

    Either every affine part of the tree is unchanged along v, or g is a polynomial and every coefficient of v . grad g vanishes.
    """
    polynomial, found = g.is_polynomial(*forces), list[sp.Matrix]()
    if not polynomial or any(part.has(sp.Add) for part in sp.Add.make_args(g)):  # multiplied out the second says all
        matrix = sp.Matrix([[sp.diff(p, x) for x in forces] for p in dict.fromkeys(largest_loads(g, forces))])
        found = [v for v in matrix.nullspace() if all(c.is_Rational for c in v)]
    return [tuple(v / sp.gcd(tuple(v))) for v in found or (_flat(g, forces) if polynomial else ())]


def _flat(g: sp.Expr, forces: Sequence[sp.Symbol]) -> list[sp.Matrix]:
    """Rational vectors that span what is orthogonal to grad g everywhere, g being a polynomial: to the coefficients of all its terms."""
    rows: dict[tuple[tuple[int, ...], sp.Expr], list[Any]] = {}
    for powers, factor in sp.Poly(g, *forces).terms():
        numbers = {sp.S.One: factor} if factor.is_Rational else sp.expand(factor).as_coefficients_dict()
        for term, number in numbers.items():
            for i, power in enumerate(powers):
                if power:
                    lowered = (*powers[:i], power - 1, *powers[i + 1 :])
                    rows.setdefault((lowered, term), [sp.QQ.zero] * len(forces))[i] = sp.QQ.from_sympy(power * number)
    if not rows:
        return []
    reduced, pivots = DomainMatrix(list(rows.values()), (len(rows), len(forces)), sp.QQ).rref()
    return list(reduced.to_Matrix()[: len(pivots), :].nullspace()) if len(pivots) < len(forces) else []


def affine(expr: sp.Expr, forces: Collection[sp.Symbol]) -> bool:
    """Whether an expression is a load: of degree 1 in the forces."""
    moving = sorted(expr.free_symbols & set(forces), key=str)
    return bool(moving) and expr.is_polynomial(*moving) and sp.Poly(expr, *moving).total_degree() == 1


def largest_loads(expr: sp.Basic, forces: Collection[sp.Symbol]) -> list[sp.Expr]:
    """The parts of a formula that are loads and no part of a greater one."""
    if isinstance(expr, sp.Expr) and affine(expr, forces):
        return [expr]
    return [load for a in expr.args if a.free_symbols & set(forces) for load in largest_loads(a, forces)]


def shears_of_isotropic(g: sp.Expr, forces: Sequence[sp.Symbol]) -> tuple[sp.Symbol, ...] | None:
    """The shear components among six forces, the normal ones first, if g(R sigma R^T) = g(sigma) for all rotations R; else None.

    Every part of g that is a polynomial of the forces has the rate 0 along two rotations, which generate all others.
    """
    if len(forces) != 6:
        return None
    return next((shear for shear in permutations(forces[3:]) if _invariant(g, (*forces[:3], *shear))), None)


# about z and about x
_TURNS = sp.ImmutableMatrix([[0, -1, 0], [1, 0, 0], [0, 0, 0]]), sp.ImmutableMatrix([[0, 0, 0], [0, 0, -1], [0, 1, 0]])


def _rate(poly: sp.Expr, stress: Sequence[sp.Symbol], turn: sp.Matrix) -> sp.Expr:
    sigma = sp.Matrix(rows(*stress))
    moved = turn * sigma - sigma * turn
    rates = (moved[0, 0], moved[1, 1], moved[2, 2], moved[1, 2], moved[0, 2], moved[0, 1])
    return sp.expand(sp.Add(*(sp.diff(poly, x) * r for x, r in zip(stress, rates, strict=True))))


def _invariant(node: sp.Basic, stress: Sequence[sp.Symbol]) -> bool:
    if not node.free_symbols & set(stress):
        return True
    if isinstance(node, EigMax):
        return all(a.is_polynomial(*stress) for a in node.args) and _covariant(sp.Matrix(rows(*node.args)), stress)
    if isinstance(node, sp.Expr) and node.is_polynomial(*stress):
        return all(_rate(node, stress, turn) == 0 for turn in _TURNS)
    if not (node.is_Add or node.is_Mul):
        return all(_invariant(a, stress) for a in node.args)
    plain = [a for a in node.args if a.is_polynomial(*stress)]
    return _invariant(node.func(*plain), stress) and all(_invariant(a, stress) for a in node.args if a not in plain)


def _covariant(matrix: sp.Matrix, stress: Sequence[sp.Symbol]) -> bool:
    """Whether the matrix turns with the stress."""
    turned = ((matrix.applyfunc(partial(_rate, stress=stress, turn=turn)), turn * matrix - matrix * turn) for turn in _TURNS)
    return all((rates - moved).expand().is_zero_matrix for rates, moved in turned)
