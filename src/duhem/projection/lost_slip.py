"""Next to the boundary a slip is a small difference of stresses: how much of it is left, against the law in many digits.

A slip d is right where trial - k d lies on the boundary and d along a normal of K there; each is asked relative to the slip, or to
1e-21 of the stress where the slip is less: pairs of doubles tell no more.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from duhem.expression.pairs import Pair
from duhem.projection.close_look import close_look, pushed_back
from duhem.projection.increment import Increment
from duhem.projection.level import Level
from duhem.projection.metric import Metric
from duhem.projection.normal_cones import Suspect, off_cone
from duhem.projection.result import ACCURACY, Array
from duhem.projection.row_by_row import length, share, widest

__all__ = ["AROUND", "LEAST", "Moves", "lost"]

_FAR = 1e-6  # of the stress: over shorter ways doubles do not tell one normal from the next
LEAST = 1e-21  # of the stress: what a shorter slip counts, so that 1e-27 of a stress is nothing
_BLIND = 1e-9  # of the stress: at the end of a shorter slip rounding of doubles may choose the wrong one of two pieces
AROUND = 3.0  # times as far as a corner is beside the stress: as it is a diagonal off, and the closest point as far again


@dataclass(frozen=True)
class Moves:
    """Slipping points (M,) as the judge sees them, lengths in the metric of k and over ``size``.

    ``aim``, ``point``, ``moved`` (M, d) are trial, stress and k slip; ``units`` the R of the level, ``multiplier`` and ``slope`` of
    it, ``steep`` the length of that; ``hidden`` how far the closest point may go by its rounding, as a share of the stress, ``known``
    where the slope is from many digits; ``depth`` the same by the distance from the boundary, which is ``spread`` times that;
    ``turned`` the distance of the slip from the multiplier times the normal, ``rounding`` what of it is rounding.
    """

    trial: Array
    stress: Array
    slip: Array
    pressure: Array
    units: Array
    size: Array
    aim: Array
    point: Array
    moved: Array
    multiplier: Array
    slope: Array
    steep: Array
    hidden: Array
    depth: Array
    spread: Array
    turned: Array
    rounding: Array
    known: NDArray[np.bool_]

    def of(self, at: NDArray[np.intp]) -> Moves:
        return Moves(*(getattr(self, f.name)[at] for f in fields(self)))

    def suspect(self, at: NDArray[np.intp], unit: Array, grain: float | Array = 1.0) -> Suspect:
        """Some of the points, slips in lengths of ``unit``."""
        reach = length(self.point[at])
        scale = np.where(reach > 0.0, reach, length(self.aim[at])) * self.size[at]
        return Suspect(
            self.stress[at],
            self.pressure[at],
            self.units[at],
            self.moved[at] / unit[:, None],
            self.multiplier[at] / (unit * self.size[at]),
            scale,
            self.rounding[at] / unit,
            reach == 0.0,
            np.broadcast_to(grain, reach.shape),
        )


def lost(increment: Increment, level: Level, metric: Metric, at: Moves, room: Array, distance: Array) -> Array:
    """What each slip is off by (M,), as a share of it or of 1e-21 of the stress, the longer, as far as it is more than rounding.

    ``room`` and ``distance`` are the lengths of stress and slip.  A stiffness far apart hides one force behind another in the
    metric: the components are off by ``plain`` times as much at most.  Where pieces meet, the distance from the boundary says
    nothing of that from where they do: there the slip has to add up with a stress that is there, else inf says that nobody knows.
    """
    largest = widest(at.slip)
    plain = np.maximum(share(distance * at.size, largest) * metric.steepest, 1.0)
    counted = np.maximum(distance, LEAST * room)
    good = ACCURACY * counted
    summed = plain * (length(at.aim - at.moved - at.point) + at.depth)
    blurred = plain * (metric.blur * (room + distance) + at.hidden * room)
    adds_up = summed + blurred <= good
    close = np.flatnonzero(~adds_up)
    missed, slope, turned = np.where(adds_up, summed, 0.0), at.slope.copy(), at.turned.copy()
    if close.size:
        few = at.of(close)
        ends = pushed_back(few.trial, few.slip, increment.stiffness, few.units)
        g, bound = close_look(increment).level(ends, few.pressure, few.units)
        missed[close] = share(np.abs(g) + bound, few.steep) * (few.units / few.size) * (1.0 + plain[close] * np.sqrt(few.spread**2 - 1.0))
        there = np.stack([end.high for end in ends], axis=1) * few.units[:, None]
        slope[close] = np.where(few.known[:, None], few.slope, level.gradient(there, few.pressure, few.units))
        if level.jets.kinks and (blind := np.flatnonzero(distance[close] <= _BLIND * plain[close] * room[close])).size:
            shown = [Pair(end.high[blind], end.low[blind]) for end in ends]
            slope[close[blind]] = close_look(increment).slopes(shown, few.pressure[blind], few.units[blind])
        turned[close] = length(few.moved - (few.multiplier / few.size)[:, None] * (slope[close] @ metric.of_slip))
    across = share(widest(at.slip - at.multiplier[:, None] * slope), largest) * distance
    off = missed + np.maximum(plain * turned, across)
    bent = np.flatnonzero(~(off <= good) & ~(plain * turned <= good))
    off[bent] = np.inf
    if (some := bent[adds_up[bent] & (distance[bent] >= _FAR * room[bent])]).size:
        found = off_cone(level, metric, at.suspect(some, distance[some], (room / distance)[some])) * distance[some]
        off[some] = missed[some] + AROUND * plain[some] * found
    return share(off, counted)
