"""Chords between points of K on rays that are known exactly: K may have faces, edges or whiskers that no sample meets.

The rays lie along, between and opposite to the axes of the forces, and along the edges in which loads of g are 0.  Where a ray from
within K leaves it, second derivatives along the boundary may be 0 or jump, as those of |x|**m do: there a dent may be so narrow
that no sample meets it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations, islice, product
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.numpy_ import compiled
from duhem.expression.rays import Rays
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.search.edges import edges_of
from duhem.proof.search.loads import loads_of
from duhem.proof.search.precise_chords import dent_chords
from duhem.proof.search.suggestion import Chord, Point

__all__ = ["chords_between_exact_rays", "dents_on_exact_rays"]

_POWERS = range(-20, 21)  # points lie at powers of 2
_NODE, _POINTS = 200, 240  # steps of each node of the formula; most points of K
_NOTHING = 1e-12  # a height below this part of the greatest around is taken for 0
_TRIED = 6  # chords for an exact look
_RADII = 10.0 ** np.linspace(-5, 5, 61)
_NEAR, _NEARER, _SETTLED = 1e-2, 1e-3, 0.7  # shares of a ray; how much of the least second difference is left if it has a limit > 0
_FOLLOWED, _PRECISE = 8, 100_000  # rays followed in many digits, and the steps of one


def chords_between_exact_rays(subject: FormulaSubject, most: int = 4) -> Iterator[Chord]:
    """Those whose midpoint is highest above K, at so many choices of the parameters."""
    forces = subject.simple.forces
    price = _NODE * sum(1 for _ in sp.preorder_traversal(subject.simple.g))
    for parameters in subject.choices(most) if len(forces) > 1 else ():
        if not subject.budget.pays(price * len(forces)):
            return
        g = subject.formula_at(parameters)
        yield from _between(g, forces, list(_rays(g, forces)), parameters)


def dents_on_exact_rays(subject: FormulaSubject, most: int = 2) -> Iterator[Chord]:
    """Chords across dents at the ends of rays from 0, where second differences do not settle at something > 0."""
    forces = subject.simple.forces
    for parameters in subject.choices(most) if len(forces) > 1 else ():
        g = subject.formula_at(parameters)
        for ray in islice(_unsettled(g, forces), _FOLLOWED):
            if not subject.budget.pays(_PRECISE):
                return
            yield from islice(dent_chords(subject, parameters, ray), _TRIED)


def _unsettled(g: sp.Expr, forces: Sequence[sp.Symbol]) -> Iterator[tuple[int, ...]]:
    """Rays at whose ends the least second difference along the boundary is no more > 0 or falls as the difference shrinks."""
    run, n = compiled(g, forces), len(forces)

    def value(points: NDArray[Any]) -> NDArray[Any]:
        return np.asarray(run(*np.moveaxis(points, -1, 0)), dtype=float) + np.zeros(points.shape[:-1])

    if not value(np.zeros(n)) < 0:
        return
    rays = list(_rays(g, forces))
    last, first = Rays(value, np.zeros(n), np.array(rays, dtype=float)).left(_RADII)
    for ray, reach in zip(rays, np.where(last < first, last, np.nan), strict=True):
        if _unsettled_at(value, reach * np.array(ray, dtype=float)):
            yield ray


@np.errstate(all="ignore")
def _unsettled_at(value: Any, x: NDArray[Any]) -> bool:
    """Whether the least second difference along the boundary at x is no more > 0 or falls; not where there is no slope in doubles."""
    size = float(np.linalg.norm(x))
    slope = np.array([value(x + s) - value(x - s) for s in 1e-6 * size * np.eye(len(x))])
    if not (np.isfinite(slope).all() and slope.any()):
        return False
    frame = np.linalg.svd(slope[None, :])[2][1:]
    far, near = (_least_bend(value, x, size * share * frame) for share in (_NEAR, _NEARER))
    return not near > _SETTLED * far > 0


def _least_bend(value: Any, x: NDArray[Any], frame: NDArray[Any]) -> float:
    """The least of the second differences along unit combinations of some short vectors, by their squared length; nan if there is none."""
    m = len(frame)
    both = np.array([[a + b if i != j else a for j, b in enumerate(frame)] for i, a in enumerate(frame)])
    form = value(x + both) + value(x - both) - 2 * value(x)
    diagonal = np.diag(form)
    form = np.where(np.eye(m) > 0, form, (form - diagonal[:, None] - diagonal[None, :]) / 2)
    return float(np.linalg.eigvalsh(form)[0] / (frame[0] @ frame[0])) if np.isfinite(form).all() else float("nan")


def _rays(g: sp.Expr, forces: Sequence[sp.Symbol]) -> Iterator[tuple[int, ...]]:
    """Directions in whole numbers."""
    n, seen = len(forces), set[tuple[int, ...]]()
    rows = [[load.diff(x) for x in forces] for load in loads_of(g, forces)]
    edges = list(edges_of(rows, n))
    axes = product((-1, 0, 1), repeat=n) if n < 4 else ()
    few = (
        tuple(s * (k == i) + t * (k == j) for k in range(n)) for i, j in combinations(range(n), 2) for s, t in product((-1, 0, 1), repeat=2)
    )
    between = (tuple(a + b for a, b in zip(one, two, strict=True)) for one, two in combinations(edges, 2))
    for ray in (*edges, *few, *axes, *between):
        if any(ray) and ray not in seen:
            seen.add(ray)
            yield ray


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
