"""Directions along which g does not change: K contains whole lines there and is a cylinder over a smaller set."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

__all__ = ["invariant_directions"]


def invariant_directions(g: sp.Expr, forces: Sequence[sp.Symbol]) -> list[tuple[sp.Integer, ...]]:
    """Constant vectors v with v . grad g = 0 identically, by algebra.

    Either every affine part of the tree is unchanged along v, or g is a polynomial and every coefficient of v . grad g vanishes.
    """
    if g.is_polynomial(*forces) and not any(part.has(sp.Add) for part in sp.Add.make_args(g)):  # multiplied out: the second says all
        return [tuple(v / sp.gcd(tuple(v))) for v in _flat(g, forces)]
    parts = _affine_parts(g, forces)
    matrix = sp.Matrix([[sp.diff(p, x) for x in forces] for p in parts])
    found = [tuple(v / sp.gcd(tuple(v))) for v in matrix.nullspace() if all(c.is_Rational for c in v)]
    if found or not g.is_polynomial(*forces):
        return found
    return [tuple(v / sp.gcd(tuple(v))) for v in _flat(g, forces)]


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


def _affine_parts(g: sp.Expr, forces: Sequence[sp.Symbol]) -> list[sp.Expr]:
    """The largest sub-expressions that are affine in the forces with constant coefficients; g is a function of them."""
    parts: dict[sp.Expr, None] = {}
    stack = [g]
    while stack:
        node = stack.pop()
        if not node.free_symbols & set(forces):
            continue
        if node.is_Symbol or (isinstance(node, sp.Expr) and not node.is_Pow and _degree(node, forces) == 1):
            parts.setdefault(node)
        else:
            stack.extend(node.args)
    return list(parts)


def _degree(node: sp.Expr, forces: Sequence[sp.Symbol]) -> int | None:
    """As a polynomial in the forces; None for what is none."""
    return int(sp.Poly(node, *forces).total_degree()) if node.is_polynomial(*forces) else None
