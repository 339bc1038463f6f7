"""Where K has no inner point, as at sigma_n = 0, where most laws leave the origin alone: nothing to start a search from.

From the trial stress on, K is shut in by the half-spaces h(x) + grad h(x) . (y - x) <= 0 at the nearest point x of those
before (J. E. Kelley 1960).  Two of them end at the tip of a cone; where g has no slope in the point (a sum of squares)
each brings x nearer by a fixed share.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from duhem.projection.increment import Increment
from duhem.projection.outer_approximation import HalfSpaces
from duhem.projection.result import Array, Solution
from duhem.projection.row_by_row import times
from duhem.projection.scaled_formula import grown, level_of, power_of_two, scaled
from duhem.projection.whitened_body import Body, Index, body, whitening

__all__ = ["shrunk"]

_ROUNDS = 200
_STILL = 1e-16  # a point that a round moves by no more than the rounding of its trial is where the next leaves it
_REACHED = 1e-9  # distances from K, in lengths of the trial
_ORIGIN = (1e-7, 1e-4)  # within this of the origin, the origin is meant if it is in K; where g is flat, the rounding of g hides more
_FLAT = 1e-3  # of the slope at the trial: less is none at the point
_BESIDE = 4.0  # times as far away as the point from the origin: what is off beyond the origin cannot cancel it
_SEEN = 1e6  # times its rounding, g shows where K is
_SMALL = (2.0**-30, 2.0**-40)  # pressures close to none, relative to the trial
_SETTLED = 1e-5


def shrunk(increment: Increment, at: Index, solve: Callable[[Increment], Solution]) -> Solution:
    """The increments ``at`` (M,), whose trial is outside a K without inner points; ``failed`` where none is found.

    Stress in Pa, slip k^-1 (sigma_tr - sigma) in m.  The multiplier at the tip of a cone is the limit of small pressures,
    by ``solve``; where g has no slope in the point, so that no multiple of it is the slip, it is that of |sigma - point|.
    """
    asked = increment.of(at)
    trial, forces = asked.trial, asked.law.force_symbols()
    formula = scaled(asked.g, forces, asked.pressure_symbol)
    k = body(formula, forces, asked.pressure, power_of_two(np.max(np.abs(trial), axis=1)), whitening(asked)[1])
    found = _nearest(k, trial / k.size[:, None])
    away = trial / k.size[:, None] - found.end
    near, far = np.linalg.norm(k.whitened(found.end), axis=1), np.linalg.norm(k.whitened(away), axis=1)
    share = np.divide(_BESIDE * near, far, out=np.ones_like(far), where=far > _BESIDE * near)
    own = power_of_two(near)  # small beside a far trial is not yet small: the same again, from a trial as near as the point
    again = found.end + share[:, None] * away
    nearer = _nearest(k.resized(asked.pressure, k.size * own), again / own[:, None])
    with np.errstate(all="ignore"):
        value, hidden = level_of(asked).bounded(again * k.size[:, None], asked.pressure, k.size * own)
    blind = ~(value > _SEEN * hidden)  # g has lost its digits before: a point beside the origin says nothing
    stress = np.where(found.failed | nearer.failed | blind, found.x.T, nearer.x.T * own).T * k.size[:, None]
    slip = np.asarray(np.linalg.solve(asked.stiffness, (trial - stress).T).T)
    scale = np.max(np.abs(slip), axis=1, initial=0.0)
    length = scale * np.linalg.norm(slip / np.where(scale > 0.0, scale, 1.0)[:, None], axis=1)
    with np.errstate(over="ignore", invalid="ignore"):
        weight = grown(found.weight / whitening(asked)[0], k.size, 2.0 - formula.degree)
    multiplier = np.where(found.flat, length, weight)
    tips = np.flatnonzero(~found.flat & (asked.pressure == 0.0) & ~stress.any(axis=1)) if asked.law.pressure else at[:0]
    if tips.size:
        multiplier[tips] = _limit(replace(asked, trial=trial[tips]), multiplier[tips], solve)
    return Solution(stress, slip, multiplier, found.failed)


def _limit(increment: Increment, otherwise: Array, solve: Callable[[Increment], Solution]) -> Array:
    """The multipliers of vanishing pressures, where they settle; beside a trial so small that these have no digits there are none."""
    size, found = np.max(np.abs(increment.trial), axis=1), otherwise.copy()
    at = np.flatnonzero(size * min(_SMALL) >= np.finfo(np.float64).tiny)
    if not at.size:
        return found
    small, smaller = (solve(replace(increment, trial=increment.trial[at], pressure=-size[at] * share)) for share in _SMALL)
    settled = ~small.failed & ~smaller.failed & np.isclose(small.multiplier, smaller.multiplier, rtol=_SETTLED, atol=0.0)
    found[at[settled]] = smaller.multiplier[settled]
    return found


@dataclass(frozen=True)
class _Nearest:
    """``x`` (M, d), the origin where that is meant and ``end`` is as near as it is; ``weight`` (M,) the sum of the multipliers of
    the gradients; ``flat`` where these vanish towards x."""

    x: Array
    end: Array
    weight: Array
    flat: NDArray[np.bool_]
    failed: NDArray[np.bool_]


def _nearest(k: Body, trial: Array) -> _Nearest:
    s = k.whitened(trial)
    outer = HalfSpaces.around(s)
    slopes, first, last = np.ones(outer.held.shape), np.full(len(s), np.nan), np.full(len(s), np.nan)
    distance, left = np.full(len(s), np.inf), np.arange(len(s))
    for _ in range(_ROUNDS):
        x = times(outer.point[left], k.root.T)
        piece = k.piece(x, left, second=False)
        outside = np.isfinite(piece.normal).all(axis=1) & (piece.level > 0.0)
        distance[left] = np.where(piece.level > 0.0, piece.level, np.where(k.level(x, left) <= 0.0, 0.0, np.inf))
        left, normal, level, slope = left[outside], piece.normal[outside], piece.level[outside], piece.slope[outside]
        if not left.size:
            break
        first[left], last[left] = np.where(np.isnan(first[left]), slope, first[left]), slope
        slot = outer.free_slot(left)
        slopes[left, slot] = slope
        before = outer.point[left]
        outer.add(left, slot, normal, np.einsum("nd,nd->n", normal, before) - level)
        left = left[np.abs(outer.point[left] - before).max(axis=1) > _STILL]
    x = times(outer.point, k.root.T)
    origin = np.zeros_like(x)
    flat = last < _FLAT * first
    near = np.linalg.norm(outer.point, axis=1) <= np.where(flat, _ORIGIN[1], _ORIGIN[0]) * np.linalg.norm(s, axis=1)
    near &= k.level(origin, np.arange(len(x))) <= 0.0
    with np.errstate(all="ignore"):
        weight = np.where(outer.active, outer.multipliers / slopes, 0.0).sum(axis=1)
    failed = ~(near | (distance <= _REACHED * np.linalg.norm(s, axis=1)))
    return _Nearest(np.where(near[:, None], origin, x), x, weight, flat, failed)
