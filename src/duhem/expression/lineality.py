"""Directions along which g does not change: K contains whole lines there and is a cylinder over a smaller set."""

from __future__ import annotations

import random
from collections.abc import Sequence

import sympy as sp

__all__ = ["invariant_directions"]


def invariant_directions(g: sp.Expr, forces: Sequence[sp.Symbol]) -> list[tuple[sp.Integer, ...]]:
    """Constant vectors v with v . grad g = 0 identically, found among small integers and then verified by algebra.

    Two ways to verify: every affine part of the tree is unchanged along v, or the expanded v . grad g vanishes.
    """
    parts = _affine_parts(g, forces)
    matrix = sp.Matrix([[sp.diff(p, x) for x in forces] for p in parts])
    found = [tuple(v / sp.gcd(tuple(v))) for v in matrix.nullspace() if all(c.is_Rational for c in v)]
    if found or not g.is_polynomial(*forces):
        return found
    rng = random.Random(1)
    gradient = [sp.diff(g, x) for x in forces]
    others = sorted(g.free_symbols - set(forces), key=str)
    rows = []
    for _ in range(len(forces) + 2):
        point = {x: sp.Rational(rng.randint(-9, 9), rng.randint(1, 9)) for x in forces} | {
            p: sp.Rational(rng.randint(1, 9), 7) for p in others
        }
        rows.append([c.subs(point) for c in gradient])
    candidates = [tuple(v / sp.gcd(tuple(v))) for v in sp.Matrix(rows).nullspace() if all(c.is_Rational for c in v)]
    return [v for v in candidates if sp.expand(sum(c * d for c, d in zip(v, gradient, strict=True))) == 0]


def _affine_parts(g: sp.Expr, forces: Sequence[sp.Symbol]) -> list[sp.Expr]:
    """The largest sub-expressions that are affine in the forces with constant coefficients; g is a function of them."""
    parts: dict[sp.Expr, None] = {}
    stack = [g]
    while stack:
        node = stack.pop()
        if not node.free_symbols & set(forces):
            continue
        if isinstance(node, sp.Expr) and node.is_polynomial(*forces) and sp.Poly(node, *forces).total_degree() <= 1:
            parts.setdefault(node)
        else:
            stack.extend(node.args)
    return list(parts)
