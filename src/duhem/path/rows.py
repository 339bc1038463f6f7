"""What a step takes of the rows that it steps: their displacements and closest points, as columns of many rows or as numbers of one.

Rows are many points at one knot of their paths, or one point at knots in turn, up to its first slip.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite
from operator import add, sub
from typing import Any, NamedTuple

import numpy as np

from duhem.law.shapes import Interval
from duhem.path import step_formulas
from duhem.path.closest import Closest, ShapeNumbers
from duhem.path.loading import Knot, Which
from duhem.path.run import Share
from duhem.path.step_formulas import on_numbers
from duhem.projection import quadrants
from duhem.projection.one_increment import OneIncrement
from duhem.projection.projector import Projector
from duhem.projection.result import Array

__all__ = [
    "ClosestPoint",
    "Given",
    "Looked",
    "ManyRows",
    "OneRow",
    "RowsFound",
    "Sliding",
    "Step",
    "Stepped",
    "Vector",
    "Ways",
    "by_arrays",
    "closest_point",
]

Vector = Any  # d components, each a number, or (n,) numbers of the rows


class RowsFound(NamedTuple):
    """Closest points: stress, slip, multiplier, which slip, and the status of what is not found, else 0."""

    stress: Vector
    slip: Vector
    multiplier: Any
    slips: Any
    lost: Any


class Stepped(NamedTuple):
    """What a step makes of rows: displacement, stress, slip, psi, what it adds to the four sums, which slip, the status where lost."""

    displacement: Vector
    stress: Vector
    slip: Vector
    psi: Any
    added: Any
    slips: Any
    lost: Any


Step = Callable[[Vector, Vector, Vector, Knot, Which], Any]
"""(stress and displacement where each row last slipped, stress before, knots, points) -> what the step makes of them, Stepped;
``before`` has one row where these are knots of one point in turn.  None where plain numbers have no answer, and arrays are to be asked."""

Ways = Sequence[Vector]  # displacements at the start, the middle and the end of a step
Given = tuple[Vector, Ways, Knot, Which]  # the stress before a step, its displacements, the knot of its end and the points
Sliding = Callable[..., Any]
Looked = tuple[RowsFound, RowsFound]  # at the first half of a step and at the whole


class ManyRows:
    """Many rows, as columns of arrays."""

    formulas: Any = step_formulas

    def __init__(self, block: Share, at: Closest) -> None:
        self.k, self.c = block.members[0].stiffness[:, :, None], block.compliance[:, :, None]
        self.none = np.zeros((len(self.k), 1))
        self._paths, self._at = block.paths, at

    def displacement(self, knot: Knot, which: Which) -> Vector:
        """At the knots of the rows."""
        return np.ascontiguousarray(self._paths.at(knot, which).T)

    def closest(self, trial: Vector, knot: Knot, which: Which) -> RowsFound:
        """The closest points to trial stresses."""
        found = self._at(np.ascontiguousarray(trial.T), knot, which)
        return RowsFound(
            np.ascontiguousarray(found.stress.T), np.ascontiguousarray(found.slip.T), found.multiplier, found.slips(), found.lost
        )

    def both(self, half: Vector, trial: Vector, end: Knot, which: Which) -> tuple[RowsFound, RowsFound]:
        """The same of two trials a row, the first of them one knot before the end."""
        n = len(which)
        knots = np.concatenate([np.broadcast_to(end - 1, n), np.broadcast_to(end, n)])
        found = self.closest(np.concatenate([half, trial], axis=1), knots, np.concatenate([which, which]))
        return RowsFound(*(each[..., :n] for each in found)), RowsFound(*(each[..., n:] for each in found))

    def preceding(self, before: Vector, trial: Vector) -> Vector:
        """The stress before each row."""
        missing = trial.shape[1] - before.shape[1]  # up to its first slip each row begins where the one before it stuck
        return np.concatenate([before, trial[:, :missing]], axis=1) if missing else before

    def worst(self, *found: RowsFound) -> Any:
        """The status of what is not found among several."""
        return np.max([each.lost for each in found], axis=0)

    def sliding(self, sticks: Stepped, looked: Looked, begun: Sliding, slid: Sliding, anchor: Vector, given: Given) -> Stepped:
        """Where rows slip what ``slid`` makes of them, and the others as they are.

        ``looked`` are the closest points as seen from where each row last slipped: a row that slips is ``begun`` anew from its own start.
        """
        before, ways, end, which = given
        go = np.flatnonzero(sticks.slips)
        if np.ndim(end):  # of one point nothing is asked behind the first slip, and what is lost there is asked again, which ends the run
            go = go[:1]
            end = np.asarray(end)[go]
        else:
            go = go[sticks.lost[go] == 0]
        whole = sticks._replace(slip=np.zeros_like(sticks.stress), added=np.zeros((4, len(which))))
        whole.added[2] = sticks.added[2]
        if go.size:
            slipping = before[:, go], [way[:, go] for way in ways], end, which[go]
            looked = begun(*slipping)
            if np.ndim(end) and self.worst(*looked).any():  # beyond double precision, as the trial is
                return whole
            made = slid(*slipping, *looked)
            for name in ("stress", "slip", "psi", "added", "lost"):
                getattr(whole, name)[..., go] = getattr(made, name)
        return whole


def by_arrays(step: Step) -> Step:
    """The step of columns for rows (n, d)."""

    def stepped(anchor_stress: Vector, anchor: Vector, before: Vector, knot: Knot, which: Which) -> Stepped:
        begun, fixed, last = (np.ascontiguousarray(rows.T) for rows in (anchor_stress, anchor, before))
        u, stress, slip, psi, added, slips, lost = step(begun, fixed, last, knot, which)
        return Stepped(u.T, stress.T, slip.T, psi, added, slips, lost)

    return stepped


# -- one row of one path on plain numbers: where a step has one row, arrays take longer to call than to compute ---------
# What has no answer on plain numbers is None, and arrays are asked.

Answer = tuple[Sequence[float], Sequence[float], float]  # stress, slip and multiplier
ClosestPoint = Callable[[Vector, Any], Answer | None]  # of a trial stress at a knot


# -- the closest point -------------------------------------------------------------------------------------------------


def closest_point(block: Share, method: str, shape: ShapeNumbers | None, by_arrays: Closest) -> ClosestPoint | None:
    """The closest point of the one point of a block at one of its knots; None where plain numbers do not do.

    What has no answer on them is asked of arrays, and has none where it is lost.
    """
    if shape is None:
        plain = _judged(block, method)
    else:
        plain = (_on_interval if isinstance(block.members[0].law.closed_form, Interval) else _on_quarters)(block, shape)
    if plain is None:
        return None
    which = np.zeros(1, dtype=np.intp)

    def at(trial: Vector, knot: int) -> Answer | None:
        if (answer := plain(trial, knot)) is not None:
            return answer
        found = by_arrays(np.array([trial]), knot, which)
        return None if found.lost.any() else (found.stress[0].tolist(), found.slip[0].tolist(), float(found.multiplier[0]))

    return at


def _on_quarters(block: Share, shape: ShapeNumbers) -> ClosestPoint | None:
    quarters = quadrants.Quarters.of(shape.coefficients[0].tolist(), block.members[0].stiffness)
    if quarters.flat.any():
        return None
    load, share, centre = (_along(array) for array in (shape.load, shape.share, shape.centre))
    moved = bool(shape.centre.any())

    def at(trial: Vector, knot: int) -> Answer | None:
        middle = centre(knot)
        found = quadrants.plain_closest(quarters, list(map(sub, trial, middle)) if moved else trial, load(knot))
        if found is None or not isfinite(found[2]):
            return None
        stress, slip, multiplier = found
        if moved:
            stress = list(map(add, stress, middle)) if multiplier > 0.0 else list(trial)
        return stress, slip, multiplier * share(knot)

    return at


def _on_interval(block: Share, shape: ShapeNumbers) -> ClosestPoint:
    load, share = _along(shape.load), _along(shape.share)
    (plus, minus), k = shape.coefficients[0].tolist(), float(block.members[0].stiffness[0, 0])

    def at(trial: Vector, knot: int) -> Answer | None:
        found = quadrants.plain_clamped(trial[0], minus if trial[0] < 0.0 else plus, load(knot), k)
        if found is None or not isfinite(found[2]):
            return None
        return found[:1], found[1:2], found[2] * share(knot)

    return at


def _along(array: Array) -> Callable[[int], Any]:
    """Its numbers at a knot, (1, m) or (1, m, d); of one column where all are alike."""
    if array.shape[1] > 1:
        return lambda knot: array[0, knot].tolist()
    always = array[0, 0].tolist()
    return lambda _: always


def _judged(block: Share, method: str) -> ClosestPoint | None:
    """By a method for any law, each answer judged; None without plain numbers, and where K is not shown to be convex."""
    member, pressure = block.members[0], block.paths.pressure
    prepared, known = Projector.of(member.law, member.stiffness, member.parameters, method), member.convexity
    one = OneIncrement(prepared.setting, prepared.method)
    if not (prepared.method.convex or (known is not None and known.loaded)) or not one.made():
        return None
    load = None if pressure is None else _along(pressure)

    def at(trial: Vector, knot: int) -> Answer | None:
        if (numbers := one.numbers(trial, None if load is None else load(knot))) is None or (found := one.answer(*numbers)) is None:
            return None
        return found.stress, found.slip, found.multiplier

    return at


# -- the rows of steps ---------------------------------------------------------------------------------------------------


class OneRow:
    """One row of the one point of a block, on plain numbers: vectors are lists or tuples of them.

    Its methods say what those of :class:`ManyRows` say, or None where plain numbers have no answer.
    """

    def __init__(self, block: Share, at: ClosestPoint) -> None:
        stiffness = block.members[0].stiffness
        self.formulas: Any = on_numbers(len(stiffness))
        self.k, self.c, self.none = stiffness.tolist(), block.compliance.tolist(), [0.0] * len(stiffness)
        self._values, self._at = block.paths.values[0], at

    def displacement(self, knot: Knot, which: Which) -> Vector:
        return self._values[knot].tolist()

    def closest(self, trial: Vector, knot: Knot, which: Which) -> RowsFound | None:
        if (answer := self._at(trial, knot)) is None:
            return None
        stress, slip, multiplier = answer
        return RowsFound(stress, slip, multiplier, multiplier > 0.0 or any(slip), 0)

    def both(self, half: Vector, trial: Vector, end: Knot, which: Which) -> tuple[RowsFound, RowsFound] | None:
        first, whole = self.closest(half, end - 1, which), self.closest(trial, end, which)
        return None if first is None or whole is None else (first, whole)

    def preceding(self, before: Vector, trial: Vector) -> Vector:
        return before

    def worst(self, *found: RowsFound) -> int:
        return 0

    def sliding(self, sticks: Stepped, looked: Looked, begun: Sliding, slid: Sliding, anchor: Vector, given: Given) -> Stepped | None:
        if not sticks.slips:
            return sticks
        found = looked if anchor == given[1][0] else begun(*given)
        return None if found is None else slid(*given, *found)
