"""Slips next to the boundary from multiplier and normal, where the difference of stresses that a method took has lost them.

The multiplier brings trial - lambda k n onto the boundary, found by Newton's method on g in many digits; the normal n is that of g
at the stress, which has all of its own.  Where pieces of g meet, one normal is not enough: their half-spaces are cut off one after
the other.  What is still in doubt, next to the boundary or not, is made of trial and stress, and looked for in many digits.  What
is found is judged like any other answer, and taken only if it passes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from duhem.projection.close_look import close_look, pushed_back
from duhem.projection.component_errors import departure
from duhem.projection.cutting_planes import slip_over_pieces
from duhem.projection.increment import Increment
from duhem.projection.level import Level, level
from duhem.projection.many_digits import Closest, closest
from duhem.projection.metric import Metric
from duhem.projection.result import ACCURACY, Array, Residuals, Solution
from duhem.projection.row_by_row import dot, length, times, widest
from duhem.projection.scaled_formula import power_of_two

__all__ = ["recovered"]

Judge = Callable[[Increment, Solution], Residuals]
Rows = TypeVar("Rows", Solution, Residuals)

_NEXT = 1e-3  # of a stress: slips of more keep their digits in a difference
_STEPS = 5


def recovered(
    question: Increment, solution: Solution, found: Residuals, judge: Judge, beside: Mapping[int, Closest]
) -> tuple[Solution, Residuals]:
    """The solution and its residuals, with slips that were lost put right where that can be done.

    ``beside``: the closest points beside answers that were looked for already, by the place of each.
    """
    for way, where in ((_from_normals, _lost), (_over_pieces, _lost), (_from_stress, _open), (_in_many_digits, _open)):
        if not (at := where(question, solution, found)).size:
            continue
        asked = replace(question, trial=question.trial[at], pressure=question.pressure[at])
        new = way(asked, Solution(*(getattr(solution, f.name)[at] for f in fields(solution))), [beside.get(i) for i in at.tolist()])
        judged = judge(asked, new)
        right = judged.worst() <= ACCURACY
        solution, found = _put(solution, at[right], new, right), _put(found, at[right], judged, right)
    return solution, found


def _lost(question: Increment, solution: Solution, found: Residuals) -> NDArray[np.intp]:
    """The points next to the boundary that nothing but the slip speaks against."""
    suspect = np.flatnonzero(found.stationarity > ACCURACY)
    suspect = suspect[(found.feasibility[suspect] <= ACCURACY) & ~solution.failed[suspect]]
    stress = solution.stress[suspect]
    return suspect[widest(question.trial[suspect] - stress) <= _NEXT * widest(stress)]


def _open(question: Increment, solution: Solution, found: Residuals) -> NDArray[np.intp]:
    """The points whose stationarity is in doubt."""
    doubt = np.flatnonzero(found.stationarity > ACCURACY)
    stress, slip = solution.stress[doubt], solution.slip[doubt]
    known = np.isfinite(stress).all(axis=1) & np.isfinite(slip).all(axis=1) & slip.any(axis=1)
    return doubt[known & ~solution.failed[doubt]]


def _from_normals(asked: Increment, got: Solution, _beside: Sequence[Closest | None]) -> Solution:
    k, trial, pressure = asked.stiffness, asked.trial, asked.pressure
    g = _level(asked)
    look, stress, size = close_look(asked), got.stress, power_of_two(widest(got.stress))
    slip, multiplier = np.zeros_like(stress), np.zeros(len(stress))
    with np.errstate(all="ignore"):
        for _ in range(_STEPS):
            normal = g.gradient(stress, pressure, size)
            beyond, _bound = look.level(pushed_back(trial, multiplier[:, None] * normal, k, size), pressure, size)
            multiplier = np.maximum(multiplier + beyond * size / dot(normal, times(normal, k)), 0.0)
            slip = multiplier[:, None] * normal
            stress = trial - times(slip, k)
    return _slipped(asked, slip, g.own(multiplier, size), multiplier == 0.0)


def _over_pieces(asked: Increment, got: Solution, _beside: Sequence[Closest | None]) -> Solution:
    g = _level(asked)
    look, size = close_look(asked), power_of_two(widest(got.stress))
    slip, multiplier = np.zeros_like(got.stress), np.zeros(len(size))
    with np.errstate(all="ignore"):
        for i, trial in enumerate(asked.trial):
            slip[i], multiplier[i] = slip_over_pieces(look, trial, float(asked.pressure[i]), asked.stiffness, float(size[i]))
    return _slipped(asked, slip, g.own(multiplier, size), multiplier == 0.0)


def _from_stress(asked: Increment, got: Solution, _beside: Sequence[Closest | None]) -> Solution:
    """Only what is the same answer: k^-1 (trial - stress), where a soft part of a long slip does not add up with its stress."""
    slip = np.asarray(np.linalg.solve(asked.stiffness, (asked.trial - got.stress).T).T)
    new = replace(got, slip=slip)
    with np.errstate(all="ignore"):
        same = _vouched(asked, new, got)
    return _put(got, np.flatnonzero(same), new, same)


def _in_many_digits(asked: Increment, got: Solution, beside: Sequence[Closest | None]) -> Solution:
    """Only what is the same answer, to what is vouched for or in the metric of k: a wrong one stays what it is."""
    g, look, size = _level(asked), close_look(asked), power_of_two(widest(got.stress))
    stress, slip, multiplier = got.stress.copy(), got.slip.copy(), g.multiplier(got.multiplier, size).copy()
    for i in range(len(size)):
        start = stress[i], float(multiplier[i]), float(size[i])
        found = beside[i] or closest(look, asked.trial[i], float(asked.pressure[i]), asked.stiffness, *start)
        if found is not None:
            stress[i], slip[i], multiplier[i] = found
    new = Solution(stress, slip, g.own(multiplier, size), got.failed)
    with np.errstate(all="ignore"):
        same = _same(Metric.of(asked.stiffness), g, asked, new, got)
    return _put(got, np.flatnonzero(same), new, same)


def _same(metric: Metric, g: Level, asked: Increment, new: Solution, old: Solution) -> NDArray[np.bool_]:
    """Where two answers agree, as seen in the metric of k or by their largest components as far as these are vouched for.

    And multipliers, where the slope of g does not tell the stresses apart.  Neither view holds the other: the metric hides a soft
    force behind a stiff one, and in components a slip may be right that a stiffness makes a wrong stress of.
    """
    size, far = power_of_two(widest(new.stress)), power_of_two(widest(asked.trial))
    largest = metric.of_slip.max()
    reach, moved = (length(times(x / far[:, None], metric.of_stress)) for x in (new.stress, new.stress - old.stress))
    way, lost = (length(times(x, metric.of_slip / largest) * (largest / far)[:, None]) for x in (new.slip, new.slip - old.slip))
    alike = (moved <= ACCURACY * reach) & (lost <= ACCURACY * (reach + way))
    alike |= _vouched(asked, new, old)
    slope = g.gradient(new.stress, asked.pressure, size)
    turned = widest(slope - g.gradient(old.stress, asked.pressure, size)) > ACCURACY * widest(slope)
    same = np.abs(new.multiplier - old.multiplier) <= ACCURACY * new.multiplier
    return np.asarray(alike & (same | turned))


def _vouched(asked: Increment, new: Solution, old: Solution) -> NDArray[np.bool_]:
    """Where stresses and slips agree to what is vouched for of their largest components."""
    stiffest = float(np.max(np.diagonal(asked.stiffness)))
    each = zip(old.stress, old.slip, new.stress, new.slip, strict=True)
    return np.array([departure(*one, stiffest) <= ACCURACY for one in each], dtype=np.bool_)


def _level(asked: Increment) -> Level:
    law = asked.law
    return level(asked.g, law.force_symbols(), law.symbols()[law.pressure] if law.pressure else None)


def _slipped(asked: Increment, slip: Array, multiplier: Array, sticks: NDArray[np.bool_]) -> Solution:
    trial = asked.trial
    stress = trial - times(slip, asked.stiffness)
    stress = np.where(sticks[:, None], trial, stress)
    slip = np.where(sticks[:, None], 0.0, slip)
    return Solution(stress, slip, multiplier, np.zeros(len(sticks), dtype=np.bool_))


def _put(whole: Rows, at: NDArray[np.intp], part: Rows, rows: NDArray[np.bool_]) -> Rows:
    """``whole`` with some ``rows`` of a part in place."""
    if not at.size:
        return whole
    changed = {f.name: getattr(whole, f.name).copy() for f in fields(whole)}
    for name, array in changed.items():
        array[at] = getattr(part, name)[rows]
    return type(whole)(**changed)
