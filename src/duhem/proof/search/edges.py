"""Rays from 0 along which all but one of as many loads as there are forces vanish: what is pointed is so there, be it by a hair."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, islice
from math import gcd, lcm

import sympy as sp

from duhem.proof.facts.loads import largest_loads

__all__ = ["edges", "edges_of"]

_MOST = 12


def edges(g: sp.Expr, forces: Sequence[sp.Symbol]) -> list[tuple[int, ...]]:
    """Those of the largest loads in g without a constant, each with its opposite, in whole numbers."""
    zero = dict.fromkeys(forces, sp.S.Zero)
    rows = [[load.diff(x) for x in forces] for load in dict.fromkeys(largest_loads(g, forces)) if load.xreplace(zero).is_zero]
    return list(edges_of(rows, len(forces)))


def edges_of(rows: Sequence[Sequence[sp.Expr]], n: int) -> Iterator[tuple[int, ...]]:
    """Those of loads with these coefficients of n forces."""
    plain = [row for row in rows if all(c.is_Rational for c in row)]
    for some in islice(combinations(plain, n - 1), _MOST):
        if len(flat := sp.Matrix(some).nullspace()) == 1:
            scale = lcm(*(int(c.q) for c in flat[0]))
            edge = [int(c * scale) for c in flat[0]]
            yield from (tuple(s * c // gcd(*edge) for c in edge) for s in (1, -1))
