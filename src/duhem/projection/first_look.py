"""Which points of a block are plainly right, and their residuals: by few passes over columns where the judge takes many.

The conditions and formulas are those of :mod:`duhem.projection.residuals`.  Every threshold beyond which that looks closer is halved
here, and where it asks for one of two things the stricter is asked, so that both say the same of every point, whatever the last digits
of either.  What does not pass, or is too large or too small to be squared, is left.  :mod:`duhem.projection.judge_kernel` says the same
to a compiler, a point at a time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.expression.length import positive_part
from duhem.projection.level import Level, Placed
from duhem.projection.metric import ROUNDING, Metric
from duhem.projection.result import ACCURACY, Array, Residuals, Solution
from duhem.projection.row_by_row import columns_times, dot, widest
from duhem.projection.scaled_formula import power_of_two
from duhem.projection.variational import Variational

__all__ = ["FirstLook"]

_HALF = 0.5  # of a threshold of the judge
_OFF = _HALF * 1e-9  # of a stress: what rounding of g hides of the boundary, or a slip is off its normal
_SQUARES = 2.0**-900, 2.0**900  # squares of lengths that have all their digits
_MULTIPLIERS = 2.0**-1017, 2.0**1020  # well within the range of doubles


@dataclass(frozen=True, eq=False)
class FirstLook:
    """The law, the ``stiffness``, its metric and the ``known`` points of K."""

    level: Level
    stiffness: Array
    metric: Metric
    known: Variational

    def __call__(self, trial: Array, pressure: Array, got: Solution, out: Residuals) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The points that stick, and those that move, of which nothing is said yet; of the others ``out`` has the residuals.

        ``out`` is all zero before; what it has of points that move and are left counts for nothing.
        """
        moved = got.multiplier != 0.0
        for t, s, d in zip(trial.T, got.stress.T, got.slip.T, strict=True):
            moved |= (s != t) | (d != 0.0)
        size = power_of_two(widest(got.stress))
        there = self.level.placed(got.stress, pressure, size)
        value, hidden = there.bounded()
        still = np.flatnonzero(~(moved | (value * _HALF < -hidden)))
        at = np.flatnonzero(moved)
        if not at.size:
            return still, at
        some = Solution(*(x.take(at, axis=0) for x in (got.stress, got.slip, got.multiplier, got.failed)))
        parts = (x.take(at, axis=0) for x in (trial, pressure, size, value, hidden))
        plain = self._moved(at, some, there.of(at), *parts, out)
        return still, at[:0] if plain.all() else at[~plain]

    def _moved(
        self,
        at: NDArray[np.intp],
        got: Solution,
        there: Placed,
        trial: Array,
        pressure: Array,
        size: Array,
        value: Array,
        hidden: Array,
        out: Residuals,
    ) -> NDArray[np.bool_]:
        """Whether the points ``at`` (M,), which move, are plainly right.  ``room`` and ``far``: the lengths of stress and slip in the metric."""
        metric, slopes = self.metric, there.slopes()
        point, moved = columns_times(got.stress.T, metric.of_stress), columns_times(got.slip.T, metric.of_slip)
        normal, aim = columns_times(slopes, metric.of_slip), columns_times(trial.T, metric.of_stress)
        multiplier, (missed, plain) = self.level.multiplier(got.multiplier, size), self._missed(trial, got)
        squares = room2, far2, steep2 = _squared(point), _squared(moved), _squared(normal)
        room, far = np.sqrt(room2), np.sqrt(far2)
        unit = size / (room * np.sqrt(steep2))  # of h, as a share of the stress
        depth, sunk, ratio = np.abs(value) * unit, hidden * unit, far / room
        gap = np.sqrt(_squared(columns_times(missed, metric.of_stress)))
        turned = np.sqrt(_squared(moved - multiplier * normal))
        off = turned / (room + far * (turned <= (_HALF * ROUNDING) * far).astype(np.float64))  # where it is rounding, of the whole way
        stationarity = np.maximum(gap / (np.sqrt(_squared(aim)) + room), off)
        left = depth + sunk + (gap + turned) / room + metric.blur * (1.0 + ratio)
        plain &= left <= (_HALF * metric.certain) * np.minimum(ratio, np.ones_like(ratio))
        plain &= (sunk * (1.0 + ratio) <= _OFF) & (stationarity <= _OFF)
        plain &= (got.multiplier >= _MULTIPLIERS[0]) & (got.multiplier <= _MULTIPLIERS[1])
        for square in squares:
            plain &= (square >= _SQUARES[0]) & (square <= _SQUARES[1])
        above = positive_part(value) * unit
        if (high := np.flatnonzero(above > _HALF * ROUNDING)).size:
            above[high] = value[high] / dot(np.abs(slopes.T[high]), np.abs(there.s.T[high]))
            plain &= ~(above > _HALF * ACCURACY)
        out.feasibility[at], out.complementarity[at], out.stationarity[at] = above, depth, stationarity
        excess = self._excess(pressure, point, moved, room, far)
        out.variational[at] = excess
        return plain & (excess <= _HALF * ACCURACY)

    def _missed(self, trial: Array, got: Solution) -> tuple[Array, NDArray[np.bool_]]:
        """trial - k slip - stress (d, M), and the points where all of it is rounding."""
        missed, rounding = columns_times(got.slip.T, self.stiffness), np.ones(len(trial), dtype=np.bool_)
        for t, moved, s in zip(trial.T, missed, got.stress.T, strict=True):
            np.subtract(t, moved, out=moved)
            moved -= s
            rounding &= np.abs(moved) <= (_HALF * ROUNDING) * (np.abs(t) + np.abs(s))
        return missed, rounding

    def _excess(self, pressure: Array, point: Array, moved: Array, room: Array, far: Array) -> Array:
        """The residual of the variational inequality (M,)."""
        known = self.known

        def found(at: NDArray[np.intp] | slice, of: Callable[..., Array]) -> Array:
            return of(pressure[at], point.T[at], moved.T[at], np.ones(len(room[at])), (far + room)[at], room[at])

        excess = np.zeros(len(room))
        if (few := known.beyond(pressure, point, moved)).size:
            excess[few] = found(few, known.excess)
        return excess if known.convex else np.fmax(excess, found(slice(None), known.beside))


def _squared(columns: Array) -> Array:
    """Squares of lengths (M,) of vectors (d, M)."""
    return dot(columns.T, columns.T)
