"""Rays from 0 along which all but one of as many loads as there are forces vanish: what is pointed is so there, be it by a hair."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, islice
from math import gcd, lcm

import sympy as sp

from duhem.proof.search.loads import largest_loads

__all__ = ["edges", "edges_of"]

_MOST = 12


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
