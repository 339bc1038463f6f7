"""Answers that doubles do not decide, held against the closest point beside them, which is found in many digits.

Lengths in the metric of k hide a soft force behind a stiff one, and next to the boundary a slip is a small difference of stresses.
The closest point beside an answer (:mod:`duhem.projection.many_digits`) has all digits of every component: the answer is as far off as
it is from there, and where both are the same answer to what is vouched for the better one takes its place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from duhem.projection.close_look import close_look
from duhem.projection.increment import Increment
from duhem.projection.level import Level, level
from duhem.projection.many_digits import ClosestInDigits, closest
from duhem.projection.metric import ROUNDING, Metric
from duhem.projection.result import ACCURACY, Array, Residuals, Solution
from duhem.projection.row_by_row import length, times, widest
from duhem.projection.scaled_formula import power_of_two

__all__ = ["LEAST_SLIP", "SLIP_SHARE", "ClosestInDigits", "closest_beside", "departures", "put_right"]

LEAST_SLIP = 1e-21  # of the stress: what a shorter slip counts, so that 1e-27 of a stress is nothing
SLIP_SHARE = 0.1  # what a relative error of a slip counts: it is vouched for to ten times the accuracy of stresses

Rows = TypeVar("Rows", Solution, Residuals)


def closest_beside(
    question: Increment, answer: Solution, multiplier: Array, units: Array, patient: bool = False
) -> list[ClosestInDigits | None]:
    """The closest point beside each answer (N,), None where none is found; ``multiplier`` of h, R = ``units``."""
    look, starts = close_look(question), zip(answer.stress, multiplier.tolist(), units.tolist(), strict=True)
    asked = zip(question.trial, question.pressure.tolist(), starts, strict=True)
    return [closest(look, trial, pressure, question.stiffness, *start, patient=patient) for trial, pressure, start in asked]


def departures(question: Increment, answer: Solution, multiplier: Array, aside: Array, points: list[ClosestInDigits | None]) -> Array:
    """How far answers (N,) are from the closest points beside them, of the largest component; slips and multipliers count a tenth.

    inf where none was found; nan where stress and slip are right and the multiplier is another one where there are several, as at an
    apex.  ``aside`` (N,) is how far a slip is from the multiplier times the slope of g at the answer, as a share of it: where K is
    thin the slopes of two stresses that are the same to what is vouched for have other lengths.
    """
    found, stiffest = np.full(len(points), np.inf), float(np.max(np.diagonal(question.stiffness)))
    for i, point in enumerate(points):
        if point is not None:
            off = departure(answer.stress[i], answer.slip[i], point.stress, point.slip, stiffest)
            short = SLIP_SHARE * min(_share(abs(multiplier[i] - point.multiplier), point.multiplier), aside[i])
            found[i] = off if short <= ACCURACY or off > ACCURACY else short if point.single or not multiplier[i] > 0.0 else np.nan
    return found


def departure(stress: Array, slip: Array, from_stress: Array, from_slip: Array, stiffest: float) -> float:
    """How far a stress and a slip (d,) are from others, of the largest component of these: a slip counts a tenth.

    ``stiffest``, the largest on the diagonal of k, makes 1e-21 of a stress a slip: a shorter one counts as long as that.
    """
    largest = np.abs(from_stress).max()
    moved = max(np.abs(from_slip).max(), LEAST_SLIP * largest / stiffest)
    off = _share(np.abs(stress - from_stress).max(), largest)
    return max(off, SLIP_SHARE * (_share(np.abs(slip - from_slip).max(), moved) + ROUNDING))


def _share(part: float, whole: float) -> float:
    return 0.0 if part == 0.0 else float(part / whole)


def put_right(
    question: Increment,
    solution: Solution,
    found: Residuals,
    judge: Callable[[Increment, Solution], Residuals],
    seen: Mapping[int, ClosestInDigits | None],
) -> tuple[Solution, Residuals]:
    """The solution and its residuals, with the closest points ``seen`` beside answers, by the place of each, where these are refused.

    Only what is the same answer is taken, and judged like any other: a wrong one stays what it is.  Where the judge saw none it is
    looked for with more patience.
    """
    at = np.array([i for i in seen if found.stationarity[i] > ACCURACY and not solution.failed[i]], dtype=np.intp)
    if not at.size:
        return solution, found
    law, asked = question.law, replace(question, trial=question.trial[at], pressure=question.pressure[at])
    g = level(question.g, law.force_symbols(), law.symbols()[law.pressure] if law.pressure else None)
    old = Solution(*(getattr(solution, f.name)[at] for f in fields(solution)))
    units = _units(old.stress, asked.trial)
    new, own = Solution(*(getattr(old, f.name).copy() for f in fields(old))), g.multiplier(old.multiplier, units)
    for i, place in enumerate(at.tolist()):
        one = slice(i, i + 1)
        few = replace(asked, trial=asked.trial[one], pressure=asked.pressure[one])
        part = Solution(*(getattr(old, f.name)[one] for f in fields(old)))
        point = seen[place] or closest_beside(few, part, own[one], units[one], patient=True)[0]
        if point is not None:
            new.stress[i], new.slip[i], own[i], _ = point
    new = replace(new, multiplier=g.own(own, units))
    with np.errstate(all="ignore"):
        same = np.flatnonzero(_same(Metric.of(asked.stiffness), g, asked, new, old))
    some = replace(asked, trial=asked.trial[same], pressure=asked.pressure[same])
    new = Solution(*(getattr(new, f.name)[same] for f in fields(new)))
    judged = judge(some, new)
    right = judged.worst() <= ACCURACY
    return _put(solution, at[same[right]], new, right), _put(found, at[same[right]], judged, right)


def _units(stress: Array, trial: Array) -> Array:
    return power_of_two(np.where(widest(stress) > 0.0, widest(stress), widest(trial)))


def _same(metric: Metric, g: Level, asked: Increment, new: Solution, old: Solution) -> NDArray[np.bool_]:
    """Where two answers agree, as seen in the metric of k or by their largest components as far as these are vouched for.

    And multipliers, where the slope of g does not tell the stresses apart.  Neither view holds the other: the metric hides a soft
    force behind a stiff one, and in components a slip may be right that a stiffness makes a wrong stress of.
    """
    size, far = _units(new.stress, asked.trial), power_of_two(widest(asked.trial))
    largest = metric.of_slip.max()
    reach, moved = (length(times(x / far[:, None], metric.of_stress)) for x in (new.stress, new.stress - old.stress))
    way, lost = (length(times(x, metric.of_slip / largest) * (largest / far)[:, None]) for x in (new.slip, new.slip - old.slip))
    alike = (moved <= ACCURACY * reach) & (lost <= ACCURACY * (reach + way))
    stiffest = float(np.max(np.diagonal(asked.stiffness)))
    each = zip(old.stress, old.slip, new.stress, new.slip, strict=True)
    alike |= np.array([departure(*one, stiffest) <= ACCURACY for one in each], dtype=np.bool_)
    slope = g.gradient(new.stress, asked.pressure, size)
    turned = widest(slope - g.gradient(old.stress, asked.pressure, size)) > ACCURACY * widest(slope)
    same = np.abs(new.multiplier - old.multiplier) * way <= ACCURACY * new.multiplier * (reach + way)  # a short slip has lost its own too
    return np.asarray(alike & (same | turned))


def _put(whole: Rows, at: NDArray[np.intp], part: Rows, rows: NDArray[np.bool_]) -> Rows:
    """``whole`` with some ``rows`` of a part in place."""
    if not at.size:
        return whole
    changed = {f.name: getattr(whole, f.name).copy() for f in fields(whole)}
    for name, array in changed.items():
        array[at] = getattr(part, name)[rows]
    return type(whole)(**changed)
