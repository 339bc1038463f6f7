"""Chords between points of K on rays that are known exactly: K may have faces, edges or whiskers that no sample meets.

The rays lie along, between and opposite to the axes of the forces, and along the edges in which loads of g are 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.numpy_ import compiled
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.search.edges import exact_rays
from duhem.proof.search.suggestion import Chord, Point

__all__ = ["chords_between_exact_rays"]

_POWERS = range(-20, 21)  # points lie at powers of 2
_NODE, _POINTS = 200, 240  # steps of each node of the formula; most points of K
_NOTHING = 1e-12  # a height below this part of the greatest around is taken for 0
_TRIED = 6  # chords for an exact look


def chords_between_exact_rays(subject: FormulaSubject, most: int = 4) -> Iterator[Chord]:
    """Those whose midpoint is highest above K, at so many choices of the parameters."""
    forces = subject.simple.forces
    price = _NODE * sum(1 for _ in sp.preorder_traversal(subject.simple.g))
    for parameters in subject.choices(most) if len(forces) > 1 else ():
        if not subject.budget.pays(price * len(forces)):
            return
        g = subject.formula_at(parameters)
        yield from _between(g, forces, list(exact_rays(g, forces)), parameters)


def _between(g: sp.Expr, forces: Sequence[sp.Symbol], rays: Sequence[tuple[int, ...]], parameters: Values) -> Iterator[Chord]:
    run = compiled(g, forces)

    def value(points: NDArray[Any]) -> NDArray[Any]:
        heights = np.asarray(run(*np.moveaxis(points, -1, 0)), dtype=float)
        return np.where(np.isfinite(heights), heights, np.nan)

    lengths = 2.0 ** np.array(_POWERS)
    points = np.array(rays, dtype=float)[:, None, :] * lengths[:, None]
    heights = value(points)
    inside = heights <= _NOTHING * np.nanmax(np.abs(heights), axis=0, initial=0.0)
    ends = [(i, k) for i, row in enumerate(inside) for k in _ends(row)][:_POINTS]
    if len(ends) < 2:
        return
    known = np.array([points[i, k] for i, k in ends])
    one, two = np.triu_indices(len(ends), 1)
    middle = value((known[one] + known[two]) / 2)
    order = np.argsort(-np.where(np.isnan(middle), -np.inf, middle), kind="stable")[:_TRIED]
    for k in order:
        if middle[k] > 0:
            yield Chord(parameters, _place(rays, ends[one[k]]), _place(rays, ends[two[k]]))


def _ends(inside: NDArray[Any]) -> list[int]:
    """Where a ray leaves K, and half-way and a quarter of the way there; of one that does not leave it some places."""
    last = [k for k in range(len(inside) - 1) if inside[k] and not inside[k + 1]]
    places = [k - j for k in last for j in (0, 1, 2)] if last else [len(inside) // 2 + j for j in (-2, 0, 2)]
    return [k for k in places if k >= 0 and inside[k]]


def _place(rays: Sequence[tuple[int, ...]], end: tuple[int, int]) -> Point:
    i, k = end
    return tuple(c * Fraction(2) ** _POWERS[k] for c in rays[i])
