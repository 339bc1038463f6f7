"""How much of an answer is certain, component by component: lengths in the metric of k hide a soft force behind a stiff one.

To move a trial by r moves the closest point of a convex K by no more than |r|, and where the boundary bends by less: by
|r|/(1 + lambda kappa), kappa the least curvature across the slip (both in the metric of k).  Where this leaves a component open, or
an answer looks wrong, the closest point beside it is found in many digits (:mod:`duhem.projection.many_digits`), and the answer
is as far off as it is from there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.projection.close_look import close_look
from duhem.projection.increment import Increment
from duhem.projection.level import Level
from duhem.projection.lost_slip import LEAST, Moves
from duhem.projection.many_digits import Closest, closest
from duhem.projection.metric import ROUNDING, Metric
from duhem.projection.result import ACCURACY, Array
from duhem.projection.row_by_row import dot, unit, widest

__all__ = ["Doubt", "by_components", "departure"]

_CLOSE = 1e-3  # how far the normal at an answer may be off for the closest point to be looked for beside it
_BEYOND = 30.0  # times as far as a point is off, its curvature is looked at again
_SLIP = 0.1  # what a relative error of a slip counts
_UNKNOWN = 10.0 * ACCURACY  # nobody knows how far off a point is


@dataclass(frozen=True, eq=False)
class Doubt:
    """Points (M,) with something missing that may leave a component open, or something wrong.

    Lengths in the metric, over the sizes of the ``moves``: ``missing`` but for the angle of the slip, ``cone`` the length of boundary
    that has the slip for a normal, ``depth`` what is missing across the boundary.  ``near``: the slip is short; ``balance``: the
    residual of the sum of trial, slip and stress, ``off`` that of the normal, ``given`` that of stationarity so far.
    """

    moves: Moves
    missing: Array
    cone: Array
    depth: Array
    near: NDArray[np.bool_]
    balance: Array
    off: Array
    given: Array


def by_components(increment: Increment, level: Level, metric: Metric, doubt: Doubt) -> tuple[Array, dict[int, Closest]]:
    """The residual of stationarity (M,): that ``given`` where no component is open, else how far off the closest point beside is.

    And those closest points that were found, by the place of each.

    It is looked for, at some milliseconds a point, where the answer is close to one: elsewhere it is wrong in the metric already.
    """
    moves, cone, depth, found, beside = doubt.moves, doubt.cone, doubt.depth, doubt.given.copy(), dict[int, Closest]()
    good = allowed(metric, moves.stress, moves.slip, doubt.near) / moves.size
    open_ = ~(doubt.missing + cone <= good)
    if (bent := np.flatnonzero(open_)).size:
        left = depth[bent] + eased(level, metric, moves.of(bent), (doubt.missing - depth + moves.turned)[bent])
        open_[bent] = ~(left <= good[bent])
    known = np.isfinite(moves.stress).all(axis=1) & np.isfinite(moves.slip).all(axis=1) & moves.stress.any(axis=1)
    close = doubt.off <= _CLOSE
    far = open_ & ~close
    found[far] = np.maximum(found, _UNKNOWN)[far]
    few = np.flatnonzero((open_ | (doubt.given > ACCURACY)) & known & close)
    if few.size:
        given, points = doubt.given[few], _closest(increment, moves.of(few))
        off = _off(increment, moves.of(few), points)
        unknown = np.where((cone + depth)[few] <= good[few], given, np.maximum(given, _UNKNOWN))  # what is more than rounding
        told = np.maximum(np.where(np.isnan(off), doubt.off[few], off), doubt.balance[few])
        found[few] = np.where(np.isinf(off), unknown, told)
        beside = {i: point for i, point in zip(few.tolist(), points, strict=True) if point is not None}
    return found, beside


def allowed(metric: Metric, stress: Array, slip: Array, short: NDArray[np.bool_]) -> Array:
    """What answers may be off by in the metric (M,) so that stresses, and slips that are not ``short``, are good in all components."""
    of_stress = ACCURACY * widest(stress) / metric.tallest
    return np.where(short, of_stress, np.minimum(of_stress, ACCURACY * widest(slip) / metric.steepest))


def eased(level: Level, metric: Metric, at: Moves, error: Array) -> Array:
    """An ``error`` along the boundary (M,), over ``size``, less what the bend of the boundary takes from it."""
    rest = at.aim - at.point - (at.multiplier / at.size)[:, None] * (at.slope @ metric.of_slip)
    normal = np.nan_to_num(unit(at.slope @ metric.of_slip)[0])
    way, far = unit(rest - dot(rest, normal)[:, None] * normal)
    way = np.where((far > 0.0)[:, None], way, 0.0)
    least = _stiffened(level, metric, at, normal, at.stress)
    step = (_BEYOND * error / np.maximum(least, 1.0) * at.size)[:, None] * (way @ metric.to_stress)
    for beside in (at.stress + step, at.stress - step):
        least = np.minimum(least, _stiffened(level, metric, at, normal, beside))
    return np.where(least > 0.0, error / least, np.inf)


def _stiffened(level: Level, metric: Metric, at: Moves, normal: Array, stress: Array) -> Array:
    """The least of 1 + lambda kappa (M,) across the normals, at a ``stress`` (M, d); 1 where nothing is known."""
    d, hessian = normal.shape[1], level.hessian(stress, at.pressure, at.units)
    bend = (at.multiplier / at.units)[:, None, None] * (metric.of_slip.T @ hessian @ metric.of_slip)
    known: NDArray[np.bool_] = np.asarray(np.isfinite(bend).all(axis=(1, 2)))
    across = np.eye(d) - normal[:, :, None] * normal[:, None, :]
    whole = across @ np.where(known[:, None, None], bend, 0.0) @ across
    size = np.maximum(np.abs(whole).max(axis=(1, 2)), 1.0)
    least = np.linalg.eigvalsh(whole + (2.0 * d * size)[:, None, None] * (normal[:, :, None] * normal[:, None, :]))[:, 0]
    return np.where(known, 1.0 + np.minimum(least, size) - 1e-14 * size, 1.0)


def _closest(increment: Increment, at: Moves) -> list[Closest | None]:
    """The closest points beside answers (M,), None where none was found."""
    look, k = close_look(increment), increment.stiffness
    starts = zip(at.trial, at.pressure.tolist(), at.stress, at.multiplier.tolist(), at.units.tolist(), strict=True)
    return [closest(look, trial, pressure, k, *start, patient=False) for trial, pressure, *start in starts]


def _off(increment: Increment, at: Moves, points: Sequence[Closest | None]) -> Array:
    """How far answers (M,) are from the closest points beside them, of the largest component; slips and multipliers count a tenth.

    inf where none was found; nan where stress and slip are right and the multiplier is another one: at an apex there are several.
    """
    found, stiffest = np.full(len(points), np.inf), float(np.max(np.diagonal(increment.stiffness)))
    for i, point in enumerate(points):
        if point is not None:
            stress, slip, multiplier = point
            off = departure(at.stress[i], at.slip[i], stress, slip, stiffest)
            same = _SLIP * abs(at.multiplier[i] - multiplier) <= ACCURACY * multiplier
            found[i] = off if same or off > ACCURACY else np.nan
    return found


def departure(stress: Array, slip: Array, from_stress: Array, from_slip: Array, stiffest: float) -> float:
    """How far a stress and a slip (d,) are from others, of the largest component of these: a slip counts a tenth.

    ``stiffest``, the largest on the diagonal of k, makes 1e-21 of a stress a slip: a shorter one counts as long as that.
    """
    largest = np.abs(from_stress).max()
    moved = max(np.abs(from_slip).max(), LEAST * largest / stiffest)
    off = _share(np.abs(stress - from_stress).max(), largest)
    return max(off, _SLIP * (_share(np.abs(slip - from_slip).max(), moved) + ROUNDING))


def _share(part: float, whole: float) -> float:
    return 0.0 if part == 0.0 else float(part / whole)
