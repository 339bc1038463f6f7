"""One row of one path on plain numbers: where a step has one row, arrays take longer to call than to compute.

What has no answer on plain numbers is None, and arrays are asked.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite
from operator import add, sub
from typing import Any

import numpy as np

from duhem.law.shapes import Interval
from duhem.path.batch import Share
from duhem.path.closest import Closest, ShapeNumbers
from duhem.path.paths import Knot, Which
from duhem.path.rows import Given, Looked, RowsFound, Sliding, Stepped, Vector
from duhem.path.step_formulas import on_numbers
from duhem.projection import quadrants
from duhem.projection.one_increment import OneIncrement
from duhem.projection.projector import Projector
from duhem.projection.result import Array

__all__ = ["ClosestPoint", "OneRow", "closest_point"]

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

    Its methods say what those of :class:`duhem.path.rows.ManyRows` say, or None where plain numbers have no answer.
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
