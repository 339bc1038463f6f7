"""Loads, which are affine in the forces: those of a formula, and those that are >= 0 in the region that K lies in."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import sympy as sp

from duhem.expression import Where

__all__ = ["affine", "greatest", "largest_loads", "loads_of"]


def loads_of(g: sp.Expr, forces: Collection[sp.Symbol]) -> Iterator[sp.Expr]:
    """What is >= 0 wherever g has a value and is <= 0: loads in a maximum, turned round, and those under a logarithm."""
    if g.has(Where):
        return
    for part in greatest(g):
        if affine(part, forces):
            yield sp.expand(-part)
        yield from (x.args[0] for x in sorted(part.atoms(sp.log), key=sp.default_sort_key) if affine(x.args[0], forces))


def greatest(g: sp.Expr) -> tuple[sp.Expr, ...]:
    """What a maximum is taken of; a formula that is none, alone."""
    return g.args if isinstance(g, sp.Max) else (g,)


def affine(expr: sp.Expr, forces: Collection[sp.Symbol]) -> bool:
    """Whether an expression is a load: of degree 1 in the forces."""
    moving = sorted(expr.free_symbols & set(forces), key=str)
    return bool(moving) and expr.is_polynomial(*moving) and sp.Poly(expr, *moving).total_degree() == 1


def largest_loads(expr: sp.Basic, forces: Collection[sp.Symbol]) -> list[sp.Expr]:
    """The parts of a formula that are loads and no part of a greater one."""
    if isinstance(expr, sp.Expr) and affine(expr, forces):
        return [expr]
    return [load for a in expr.args if a.free_symbols & set(forces) for load in largest_loads(a, forces)]
