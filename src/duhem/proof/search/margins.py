"""Where a claim that stays open is closest to fail, in floats: the least margin of boundary points at a few choices of the parameters.

Walks begin at the scouts with the least margins, and go downhill over the parameters and the boundary points together.

Convexity: the curvature of the boundary times the distance from the centre, least over the tangents; 1 on a sphere, 0 where it is flat.
Dissipation: force . slip over the sizes of both.  Normality: how far a slip of length 1 leans away from every other boundary point.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from duhem.expression import defined_at
from duhem.expression.numpy_ import compiled
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Values
from duhem.proof.search.boundary_points import BoundaryScout, scouts
from duhem.proof.search.downhill import ParameterRows, downhill

__all__ = ["WALK", "Margin", "failures", "highest_at_zero", "least_margin"]

WALK = 24  # moves
_TRIED = 400  # choices at zero force
_CHOICES, _STARTS, _STEP, _ROUNDING = 6, 3, 1e-3, 1e-7  # of cosines that are found by differences
_TURNED = 0.7  # of the moves turn the ray
_ENDS, _RAYS, _WIDTHS = 3, 16, (0.3, 0.03, 0.003)  # ends of walks that are looked at; rays beside each, and how far
_BEFORE_THE_END, _STEEP = 0.999, 1e6  # a share of a ray; g at its end is so many times as deep as there, if that is a pole
_MOVE, _CLEAR = 300, 0.01  # steps of a move and a node of the formula; a margin that is farther below 0 needs no more search

Measure = Callable[[BoundaryScout], Any]


class Margin(NamedTuple):
    """The least ``value`` of a ``measure``, in floats; ``place`` is the number of its point among the boundary points of ``scout``."""

    measure: str
    value: float
    scout: BoundaryScout
    place: int


def least_margin(claim: str, subject: FormulaSubject, moves: int = 0) -> Margin | None:
    """The least margin that scouts see.  With ``moves``, walks of so many moves begin where theirs are least, unless one is clear.

    None where nothing of the claim is measured, or no boundary point is found.
    """
    if claim not in _MEASURES or (claim == "dissipation" and not subject.onto):
        return None
    measure, of = _MEASURES[claim]
    seen = sorted(((*_least(of, here), here) for here in scouts(subject, _CHOICES)), key=lambda each: each[0])
    found = [Margin(measure, value, here, k) for value, k, here in seen[:1] if np.isfinite(value)]
    if found and moves and found[0].value > -_CLEAR:
        found += [Margin(measure, value, here, k) for value, k, here in _walked(of, subject, [here for *_, here in seen], moves)]
    return min(found, key=lambda margin: margin.value, default=None)


def _walked(
    measure: Measure, subject: FormulaSubject, seen: Sequence[BoundaryScout], moves: int
) -> Iterator[tuple[float, int, BoundaryScout]]:
    """Least margins around the ends of walks over parameters and rays, which begin at the least ones of each scout seen."""
    rows = ParameterRows(subject)
    price = moves * _MOVE * sum(1 for _ in sp.preorder_traversal(subject.simple.g))
    if not subject.budget.pays(price):
        return

    def margins(own: Any, ways: Any, centres: Any) -> Any:
        here = BoundaryScout(subject, {}, ways, centres, own)
        values = np.full(len(own), np.inf)
        values[here.kept] = _measured(measure, here) if len(here.kept) else np.inf
        return np.where(rows.admitted(own), values, np.inf)

    def beside(places: Sequence[Any], widths: Any, rng: np.random.Generator) -> Sequence[Any]:
        own, ways, centres = places
        turned = ways + widths * np.linalg.norm(ways, axis=1, keepdims=True) * rng.standard_normal(ways.shape)
        return rows.beside(own, widths, rng), np.where(rng.random((len(own), 1)) < _TURNED, turned, ways), centres

    starts = [(here, k) for here in seen if len(here.boundary) > 1 for k in np.argsort(_measured(measure, here))[:_STARTS]]
    if not starts:
        return
    own = np.reshape([[float(here.parameters[x]) for x in rows.free] for here, _ in starts], (len(starts), len(rows.free)))
    ways, centres = np.array([here.directions[k] for here, k in starts]), np.array([here.centre for here, _ in starts])
    (own, ways, centres), values = downhill(margins, (own, ways, centres), beside, moves)
    for k in np.argsort(values, kind="stable")[:_ENDS]:
        if np.isfinite(values[k]) and (chosen := rows.values(own[k])) is not None:
            rng, size = np.random.default_rng(9), np.linalg.norm(ways[k])
            near = [ways[k] + width * size * rng.standard_normal((_RAYS, ways.shape[1])) for width in _WIDTHS]
            there = BoundaryScout(subject, chosen, np.vstack([ways[k], *near]), centres[k])
            yield *_least(measure, there), there


def _least(measure: Measure, scout: BoundaryScout) -> tuple[float, int]:
    """The least value, and at which boundary point; infinite where there are none."""
    if len(scout.boundary) < 2:
        return np.inf, 0
    values = _measured(measure, scout)
    return float(values.min()), int(values.argmin())


def _measured(measure: Measure, scout: BoundaryScout) -> Any:
    """The measure at each boundary point; infinite where there is none, and where a ray leaves K at a pole of g, at which g is not 0."""
    with np.errstate(all="ignore"):
        values, ends = np.asarray(measure(scout), dtype=float), scout.boundary
        deep, before = (scout.value(scout.centre + share * (ends - scout.centre)) for share in (1.0, _BEFORE_THE_END))
        return np.where(np.isfinite(values) & ~(deep < _STEEP * (np.minimum(before, 0.0) - 1.0)), values, np.inf)


def failures(claim: str, scout: BoundaryScout) -> int:
    """At how many boundary points that a scout found the measure of the claim seems to be < 0."""
    return int(np.sum(_measured(_MEASURES[claim][1], scout) < -_ROUNDING))


def highest_at_zero(subject: FormulaSubject, most: int = 2) -> list[Values]:
    """The choices of the parameters at which g is greatest at zero force, in floats: walks to them begin at the plain ones."""
    start = defined_at(subject.simple.g, dict.fromkeys(subject.simple.forces, sp.S.Zero))
    rows = ParameterRows(subject)
    if start is None or not rows.free or not len(plain := rows.plain(_TRIED)):
        return []
    run = compiled(start, rows.free)

    def depth(own: Any) -> Any:
        with np.errstate(all="ignore"):
            return np.where(rows.admitted(own), -np.nan_to_num(np.broadcast_to(run(*own.T), len(own)), nan=-np.inf), np.inf)

    (own,), values = downhill(depth, [plain], lambda places, widths, rng: [rows.beside(places[0], widths, rng)], WALK)
    found = (rows.values(own[k]) for k in np.argsort(values, kind="stable"))
    return list(islice((values for values in found if values is not None), most))


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
