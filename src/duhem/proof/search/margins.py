"""Where a claim that stays open is closest to fail, in floats: the least margin of boundary points at a few choices of the parameters.

Convexity: the curvature of the boundary times the distance from the centre, least over the tangents; 1 on a sphere, 0 where it is flat.
Dissipation: force . slip over the sizes of both.  Normality: how far a slip of length 1 leans away from every other boundary point.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Values
from duhem.proof.search.boundary_points import BoundaryScout, scouts

__all__ = ["Margin", "least_margin"]

_CHOICES, _STEP = 6, 1e-3
_MEASURES: Mapping[str, tuple[str, Callable[[BoundaryScout], Any]]]


class Margin(NamedTuple):
    """The least ``value`` of a ``measure``, in floats, at a choice of the parameters and a ``point`` of the boundary."""

    measure: str
    value: float
    parameters: Values
    point: tuple[float, ...]


def least_margin(claim: str, subject: FormulaSubject) -> Margin | None:
    """None where nothing of the claim is measured, or no boundary point is found."""
    if claim not in _MEASURES or (claim == "dissipation" and not subject.onto):
        return None
    measure, of = _MEASURES[claim]
    found = list[Margin]()
    for scout in scouts(subject, _CHOICES):
        if len(scout.boundary) > 1:
            with np.errstate(all="ignore"):
                values = np.asarray(of(scout), dtype=float)
            values = np.where(np.isfinite(values), values, np.inf)
            k = int(np.argmin(values))
            if np.isfinite(values[k]):
                found.append(Margin(measure, float(values[k]), scout.parameters, tuple(map(float, scout.boundary[k]))))
    return min(found, key=lambda margin: margin.value, default=None)


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


_MEASURES = {
    "convexity": ("curvature of the boundary times its distance", _curvature),
    "normality": ("slip . way from another point of K, over the sizes of both", lambda scout: -scout.leaning()),
    "dissipation": ("force . slip over the sizes of both", lambda scout: scout.power()),
}
