"""The steps of one path on plain numbers: where a step has one row, arrays take longer to call than to compute.

The operations and their order are those of :mod:`duhem.path.integrators` for rows, so every digit is the same.  What has no answer on
plain numbers is None, and arrays are asked.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite
from operator import add, sub
from typing import Any, NamedTuple

import numpy as np

from duhem.law.shapes import Interval
from duhem.path.batch import Share
from duhem.path.closest import Closest, ShapeNumbers
from duhem.projection import quadrants
from duhem.projection.one_increment import OneIncrement
from duhem.projection.projector import Projector
from duhem.projection.result import Array

__all__ = ["RowStep", "RowStepped", "closest_point", "extrapolated", "implicit"]

Vector = Sequence[float]
Matrix = Sequence[Vector]
Answer = tuple[Vector, Vector, float]  # stress, slip and multiplier
ClosestPoint = Callable[[Vector, int], Answer | None]  # of a trial stress at a knot


class RowStepped(NamedTuple):
    """What a step makes of one row: stress, slip, psi, what it adds to the sums, and whether it slips."""

    stress: Vector
    slip: Vector
    psi: float
    gains: tuple[float, float, float, float]
    slips: bool


RowStep = Callable[[Vector, int, Vector, int], RowStepped | None]
"""(stress where the path last slipped, and the row of it, stress before, row) -> what the step makes of it."""


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


# -- the steps ---------------------------------------------------------------------------------------------------------


def implicit(block: Share, at: ClosestPoint) -> RowStep:
    """The implicit step of the one point of a block."""
    values, k, c = block.paths.values[0], block.members[0].stiffness.tolist(), block.compliance.tolist()

    def step(anchor_stress: Vector, anchor: int, before: Vector, row: int) -> RowStepped | None:
        u, last = values[row].tolist(), values[row - 1].tolist()
        du = list(map(sub, u, last))
        trial = _moved(anchor_stress, du if anchor == row - 1 else list(map(sub, u, values[anchor].tolist())), k)
        if (found := at(trial, row)) is None:
            return None
        stress, slip, multiplier = found
        if not _slips(slip, multiplier):
            return _stuck(before, trial, slip, multiplier, c)
        return RowStepped(stress, slip, _energy(stress, c), (multiplier, *_energies(k, stress, slip, du)), True)

    return step


def extrapolated(block: Share, at: ClosestPoint) -> RowStep:
    """The extrapolated step; of a path that slips without rest the whole step and the first half are what is looked at."""
    values, k, c = block.paths.values[0], block.members[0].stiffness.tolist(), block.compliance.tolist()

    def step(anchor_stress: Vector, anchor: int, before: Vector, row: int) -> RowStepped | None:
        start, middle, u = values[2 * row - 2 : 2 * row + 1].tolist()
        fixed = start if anchor == row - 1 else values[2 * anchor].tolist()
        trial, half = (_moved(anchor_stress, list(map(sub, end, fixed)), k) for end in (u, middle))
        first, whole = at(half, 2 * row - 1), at(trial, 2 * row)
        if first is None or whole is None:
            return None
        if not (_slips(*first[1:]) or _slips(*whole[1:])):
            return _stuck(before, trial, [0.0] * len(trial), 0.0, c)
        du, d1, d2 = (list(map(sub, end, begin)) for end, begin in ((u, start), (middle, start), (u, middle)))
        if anchor != row - 1:
            first, whole = at(_moved(before, d1, k), 2 * row - 1), at(_moved(before, du, k), 2 * row)
        second = None if first is None else at(_moved(first[0], d2, k), 2 * row)
        if first is None or whole is None or second is None:
            return None
        back = at([2.0 * halves - once for halves, once in zip(second[0], whole[0], strict=True)], 2 * row)
        if back is None:
            return None
        one = whole[2], *_energies(k, *whole[:2], du)
        two = list(map(add, (first[2], *_energies(k, *first[:2], d1)), (second[2], *_energies(k, *second[:2], d2))))
        multiplier, lost, _, numerical = (2.0 * b - a if 2.0 * b >= a else b for a, b in zip(one, two, strict=True))
        slip = list(map(sub, du, _times(list(map(sub, back[0], before)), c)))
        return RowStepped(back[0], slip, _energy(back[0], c), (multiplier, lost, 2.0 * two[2] - one[2], numerical), True)

    return step


def _stuck(before: Vector, stress: Vector, slip: Vector, multiplier: float, c: Matrix) -> RowStepped:
    mean, moved = [0.5 * (a + b) for a, b in zip(before, stress, strict=True)], list(map(sub, stress, before))
    return RowStepped(stress, slip, _energy(stress, c), (multiplier, 0.0, _inner(mean, _times(moved, c)), 0.0), False)


def _slips(slip: Vector, multiplier: float) -> bool:
    return multiplier > 0.0 or any(x != 0.0 for x in slip)


def _moved(stress: Vector, du: Vector, k: Matrix) -> list[float]:
    return list(map(add, stress, _times(du, k)))


def _energies(k: Matrix, stress: Vector, slip: Vector, du: Vector) -> tuple[float, float, float]:
    return _inner(stress, slip), _inner(stress, du), _energy(list(map(sub, du, slip)), k)


def _energy(vector: Vector, matrix: Matrix) -> float:
    return 0.5 * _inner(vector, _times(vector, matrix))


def _inner(vector: Vector, other: Vector) -> float:
    total = 0.0
    for x, y in zip(vector, other, strict=True):
        total += x * y
    return total


def _times(vector: Vector, matrix: Matrix) -> list[float]:
    found = [0.0 + vector[0] * entry for entry in matrix[0]]
    for x, entries in zip(vector[1:], matrix[1:], strict=True):
        found = [total + x * entry for total, entry in zip(found, entries, strict=True)]
    return found
