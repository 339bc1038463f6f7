"""Edges, along which loads vanish, and rays from 0 that are known exactly by them; a load is affine in the forces.

Along an edge all but one of as many loads as there are forces vanish: what is pointed is so there, be it by a hair.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from itertools import combinations, islice, product
from math import gcd, lcm

import sympy as sp

from duhem.expression import Where
from duhem.expression.invariance import affine, largest_loads

__all__ = ["edges", "edges_of", "exact_rays", "greatest", "loads_of"]

_MOST = 12


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


def edges(g: sp.Expr, forces: Sequence[sp.Symbol]) -> list[tuple[int, ...]]:
    """Those of the largest loads in g without a constant, each with its opposite, in whole numbers."""
    zero = dict.fromkeys(forces, sp.S.Zero)
    rows = [[load.diff(x) for x in forces] for load in dict.fromkeys(largest_loads(g, forces)) if load.xreplace(zero).is_zero]
    return list(edges_of(rows, len(forces)))


def edges_of(rows: Sequence[Sequence[sp.Expr]], n: int) -> Iterator[tuple[int, ...]]:
    """Those of loads with these coefficients of n forces: first one off each load, where there is one."""
    plain = [row for row in rows if all(c.is_Rational for c in row)]
    some = dict.fromkeys((*_off_each(plain, n), *islice(combinations(range(len(plain)), n - 1), _MOST)))
    seen = set[tuple[int, ...]]()
    for chosen in islice(some, _MOST):
        if len(flat := sp.Matrix([plain[k] for k in chosen]).nullspace()) == 1:
            scale = lcm(*(int(c.q) for c in flat[0]))
            whole = [int(c * scale) for c in flat[0]]
            edge = tuple(c // gcd(*whole) for c in whole)
            if edge not in seen:
                both = (edge, tuple(-c for c in edge))
                seen.update(both)
                yield from both


def _off_each(rows: Sequence[Sequence[sp.Expr]], n: int) -> Iterator[tuple[int, ...]]:
    """Of loads that are a basis, the first of which is left out: it is not 0 where the others are."""
    for k in range(min(len(rows), _MOST)):
        turned = [*range(k, len(rows)), *range(k)]
        basis = sp.Matrix([rows[i] for i in turned]).T.rref()[1]
        if len(basis) == n and basis[0] == 0:
            yield tuple(sorted(turned[i] for i in basis[1:]))


def exact_rays(g: sp.Expr, forces: Sequence[sp.Symbol]) -> Iterator[tuple[int, ...]]:
    """Along edges, along, between and opposite to the axes of the forces, and between edges, in whole numbers."""
    n, seen = len(forces), set[tuple[int, ...]]()
    rows = [[load.diff(x) for x in forces] for load in loads_of(g, forces)]
    along = list(edges_of(rows, n))
    axes = product((-1, 0, 1), repeat=n) if n < 4 else ()
    few = (
        tuple(s * (k == i) + t * (k == j) for k in range(n)) for i, j in combinations(range(n), 2) for s, t in product((-1, 0, 1), repeat=2)
    )
    between = (tuple(a + b for a, b in zip(one, two, strict=True)) for one, two in combinations(along, 2))
    for ray in (*along, *few, *axes, *between):
        if any(ray) and ray not in seen:
            seen.add(ray)
            yield ray
