"""Where a claim that stays open is closest to fail, in floats: the least margin of boundary points at a few choices of the parameters.

Walks begin at the scouts with the least margins, and go downhill over the parameters and the boundary points together.

Convexity: the curvature of the boundary times the distance from the centre, least over the tangents; 1 on a sphere, 0 where it is flat.
Dissipation: force . slip over the sizes of both.  Normality: how far a slip of length 1 leans away from every other boundary point.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from duhem.expression import defined_at
from duhem.expression.numpy_ import compiled
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Values, plain_choices
from duhem.proof.search.boundary_points import BoundaryScout, scouts

__all__ = ["WALK", "Margin", "failures", "highest_at_zero", "least_margin"]

WALK = 12  # moves
_CHOICES, _STARTS, _STEP, _ROUNDING = 6, 3, 1e-3, 1e-7  # of cosines that are found by differences
_WIDTHS, _RAYS = 4, 48  # of moves, each half of the one before; of a move, beside the one on which the margin is least
_BEFORE_THE_END, _STEEP = 0.999, 1e6  # a share of a ray; g at its end is so many times as deep as there, if that is a pole
_MOVE, _CLEAR = 5_000, 0.01  # steps of a move; a margin that is farther below 0 needs no more search


class Margin(NamedTuple):
    """The least ``value`` of a ``measure``, in floats; ``place`` is the number of its point among the boundary points of ``scout``."""

    measure: str
    value: float
    scout: BoundaryScout
    place: int


def least_margin(claim: str, subject: FormulaSubject, moves: int = 0) -> Margin | None:
    """The least margin that scouts see.  With ``moves``, walks of so many moves begin where it is least; each move leads downhill.

    None where nothing of the claim is measured, or no boundary point is found.
    """
    if claim not in _MEASURES or (claim == "dissipation" and not subject.onto):
        return None
    measure, of = _MEASURES[claim]
    best, rng = None, np.random.default_rng(9)
    seen = sorted(((*_least(of, here), here) for here in scouts(subject, _CHOICES)), key=lambda each: each[0])
    for value, k, here in seen[: _STARTS if moves else 1]:
        for move in range(moves if np.isfinite(value) else 0):
            width = 0.5 ** (move % _WIDTHS)
            there = subject.moved(here.parameters, width, rng) if move % 3 else here.parameters
            if there is None or not subject.budget.pays(_MOVE):
                continue
            way = here.directions[k]
            ways = np.vstack([way, way + width * np.linalg.norm(way) * rng.standard_normal((_RAYS, len(way)))])
            found, i = _least(of, scout := BoundaryScout(subject, there, ways))
            if found < value:
                value, k, here = found, i, scout
        if np.isfinite(value) and (best is None or value < best.value):
            best = Margin(measure, value, here, k)
            if value < -_CLEAR:
                break
    return best


def _least(measure: Callable[[BoundaryScout], Any], scout: BoundaryScout) -> tuple[float, int]:
    """The least value, and at which boundary point; infinite where there are none."""
    if len(scout.boundary) < 2:
        return np.inf, 0
    values = _measured(measure, scout)
    return float(values.min()), int(values.argmin())


def _measured(measure: Callable[[BoundaryScout], Any], scout: BoundaryScout) -> Any:
    """The measure at each boundary point; infinite where there is none, and where a ray leaves K at a pole of g, at which g is not 0."""
    with np.errstate(all="ignore"):
        values, ends = np.asarray(measure(scout), dtype=float), scout.boundary
        deep, before = (scout.value(scout.centre + share * (ends - scout.centre)) for share in (1.0, _BEFORE_THE_END))
        return np.where(np.isfinite(values) & ~(deep < _STEEP * (np.minimum(before, 0.0) - 1.0)), values, np.inf)


def failures(claim: str, scout: BoundaryScout) -> int:
    """At how many boundary points that a scout found the measure of the claim seems to be < 0."""
    return int(np.sum(_measured(_MEASURES[claim][1], scout) < -_ROUNDING))


def highest_at_zero(subject: FormulaSubject, most: int = 2) -> list[Values]:
    """The plain choices of the parameters, ends of their ranges among them, at which g is greatest at zero force, in floats."""
    free = subject.simple.parameters
    start = defined_at(subject.simple.g, dict.fromkeys(subject.simple.forces, sp.S.Zero))
    if start is None or not free:
        return []
    tried = list(plain_choices(free, subject.simple.given))
    with np.errstate(all="ignore"):
        values = compiled(start, free)(*np.array([[float(one[x]) for x in free] for one in tried]).T)
    order = np.argsort(-np.nan_to_num(np.broadcast_to(values, len(tried)), nan=-np.inf))
    return [tried[k] for k in order[:most]]


def _curvature(scout: BoundaryScout) -> Any:
    """By differences of g at points a small step along the tangents, which are found beside the gradient."""
    points, slopes = scout.boundary, np.nan_to_num(scout.gradient, nan=0.0, posinf=0.0, neginf=0.0)
    n = points.shape[1]
    reach = np.linalg.norm(points - scout.centre, axis=1)
    steep = np.linalg.norm(slopes, axis=1)
    tangents = np.linalg.svd(slopes[:, None, :])[2][:, 1:]
    ways = [tangents[:, i] for i in range(n - 1)]
    ways += [(tangents[:, i] + s * tangents[:, j]) / np.sqrt(2) for i in range(n - 1) for j in range(i) for s in (1, -1)]
    here, least = scout.value(points), np.full(len(points), np.inf)
    for way in ways:
        step = _STEP * reach[:, None] * way
        bend = (scout.value(points + step) + scout.value(points - step) - 2 * here) / _STEP**2
        least = np.fmin(least, bend / (steep * reach))
    return least


_MEASURES: Mapping[str, tuple[str, Callable[[BoundaryScout], Any]]] = {
    "convexity": ("curvature of the boundary times its distance", _curvature),
    "normality": ("slip . way from another point of K, over the sizes of both", lambda scout: -scout.leaning()),
    "dissipation": ("force . slip over the sizes of both", lambda scout: scout.power()),
}
