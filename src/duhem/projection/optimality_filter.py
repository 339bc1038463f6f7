"""Which points of a block are plainly right, and their residuals: by few passes over columns where the judge takes many.

The conditions and formulas are those of :mod:`duhem.projection.residuals`.  Every threshold beyond which that looks closer is halved
here, and where it asks for one of two things the stricter is asked, so that both say the same of every point, whatever the last digits
of either.  What does not pass, or is too large or too small to be squared, is left.  :mod:`duhem.projection.judge_kernel` says the same
to a compiler.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.projection.in_blocks import BLOCK, in_blocks
from duhem.projection.increment import Increment
from duhem.projection.judge_kernel import LOW
from duhem.projection.metric import ROUNDING, Metric
from duhem.projection.result import ACCURACY, Array, Residuals, Solution
from duhem.projection.row_by_row import any_of, columns_times, dot, widest
from duhem.projection.scaled_formula import power_of_two
from duhem.projection.scaled_yield_function import Level, Placed
from duhem.projection.variational_samples import Variational

__all__ = ["FirstLook"]

_HALF = 0.5  # of a threshold of the judge
_OFF = _HALF * 1e-9  # of a stress: what rounding of g hides of the boundary, or a slip is off its normal
_SQUARES = 2.0**-900, 2.0**900  # squares of lengths that have all their digits
_MULTIPLIERS = 2.0**-1017, 2.0**1020  # well within the range of doubles
_NONE = np.empty(0, dtype=np.intp)


@dataclass(frozen=True, eq=False)
class FirstLook:
    """The law, the ``stiffness``, its metric and the ``known`` points of K."""

    level: Level
    stiffness: Array
    metric: Metric
    known: Variational

    def left(
        self, increment: Increment, solution: Solution, out: Residuals, threads: int | None = 1, then: Callable[[slice], None] | None = None
    ) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The points that stick, and those that move, of which nothing is said yet; of the others ``out`` has the residuals.

        ``out`` is all zero before; what it has of points that move and are left counts for nothing.  ``then`` is told each block that
        was looked at, while it is in the cache.
        """
        found = dict[int, tuple[NDArray[np.intp], NDArray[np.intp]]]()

        def look(block: slice) -> None:
            with np.errstate(all="ignore"):
                still, moved = self._block(increment.trial[block], increment.pressure[block], solution.of(block), out.of(block))
                found[block.start] = still + block.start, moved + block.start
            if then is not None:
                then(block)

        in_blocks(len(solution.multiplier), BLOCK, look, threads)
        stills, moves = zip(*(found[start] for start in sorted(found)), strict=True) if found else ((_NONE,), (_NONE,))
        return np.concatenate(stills), np.concatenate(moves)

    def _block(self, trial: Array, pressure: Array, got: Solution, out: Residuals) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The same of one block."""
        moved = any_of((got.stress != trial) | (got.slip != 0.0))
        moved |= got.multiplier != 0.0
        size = power_of_two(widest(got.stress))
        there = self.level.placed(got.stress, pressure, size)
        value, hidden = there.bounded()
        still = np.flatnonzero(~(moved | (value * _HALF < -hidden)))
        at = np.flatnonzero(moved)
        if not at.size:
            return still, at
        vectors = (np.ascontiguousarray(x.take(at, axis=0).T).T for x in (trial, got.stress, got.slip))  # column by column in memory
        numbers = (x.take(at) for x in (pressure, got.multiplier, size, value, hidden))
        plain = self._moved(out, at, there.of(at), *vectors, *numbers)
        return still, at[:0] if plain.all() else at[~plain]

    def _moved(
        self, out: Residuals, at: NDArray[np.intp], there: Placed, trial: Array, stress: Array, slip: Array, pressure: Array, given: Array,
        size: Array, level: Array, hidden: Array,
    ) -> NDArray[np.bool_]:  # fmt: skip
        """Whether each of the points ``at`` (M,) of a block that move is plainly right, with their residuals into ``out``.

        ``given`` are multipliers of g; ``size`` is the unit of ``there``, ``level`` h and ``hidden`` a bound of its rounding.  ``room`` and
        ``far`` are the lengths of stress and slip in the metric.
        """
        metric, slopes = self.metric, there.slopes()
        point, moved = columns_times(stress.T, metric.of_stress), columns_times(slip.T, metric.of_slip)
        normal, aim = columns_times(slopes, metric.of_slip), columns_times(trial.T, metric.of_stress)
        multiplier, (missed, plain) = self.level.multiplier(given, size), self._missed(trial, stress, slip)
        squares = room2, far2 = _squared(point), _squared(moved)
        plain &= _within(given, *_MULTIPLIERS)
        for square in squares:
            plain &= _within(square, *_SQUARES)
        room, far, height = np.sqrt(room2, out=room2), np.sqrt(far2, out=far2), dot(slopes.T, there.s.T)
        if self.level.jets.kinks:  # a piece that is as high may be flatter
            np.minimum(height, there.rise(), out=height)
        unit, value = _length(normal), np.abs(level)
        unit *= room
        if (low := np.flatnonzero(~(height * size > LOW * unit))).size:
            some = there.s.T[low], slopes.T[low], pressure[low], size[low], room[low], far[low]
            height[low] = np.fmax(height[low], self.known.rise(*some))
        plain &= (height > 0.0) & self.known.around_origin
        np.divide(size, unit, out=unit)  # of h, as a share of the stress
        depth, sunk, ratio = value * unit, hidden / height, far / room
        gap = _length(columns_times(missed, metric.of_stress))
        normal *= multiplier
        turned = _length(np.subtract(moved, normal, out=normal))
        off, rounding = room + far, turned <= (_HALF * ROUNDING) * far
        if not rounding.all():  # where it is rounding, of the whole way
            off = room + far * rounding.astype(np.float64)
        np.divide(turned, off, out=off)
        stationarity = _length(aim)
        stationarity += room
        np.divide(gap, stationarity, out=stationarity)
        np.maximum(stationarity, off, out=stationarity)
        plain &= stationarity <= _OFF
        value /= height
        value += sunk
        gap += turned
        gap /= room
        value += gap
        ways = 1.0 + ratio
        value += metric.blur * ways  # seen from no stress, as K may be thin
        most = _HALF * metric.certain
        ratio *= most
        plain &= (value <= most) & (value <= ratio)
        sunk *= ways
        plain &= sunk <= _OFF
        above = np.maximum(level, np.zeros_like(unit))
        above *= unit
        if (high := np.flatnonzero(above > _HALF * ROUNDING)).size:
            above[high] = level[high] / dot(np.abs(slopes.T[high]), np.abs(there.s.T[high]))
            plain &= ~(above > _HALF * ACCURACY)
        out.feasibility[at], out.complementarity[at], out.stationarity[at] = above, depth, stationarity
        excess = self._excess(pressure, point, moved, room, far)
        if excess is not None:
            out.variational[at] = excess
            plain &= excess <= _HALF * ACCURACY
        return plain

    def _missed(self, trial: Array, stress: Array, slip: Array) -> tuple[Array, NDArray[np.bool_]]:
        """trial - k slip - stress (d, M), and the points where all of it is rounding."""
        missed, rounding = columns_times(slip.T, self.stiffness), np.ones(len(trial), dtype=np.bool_)
        for t, moved, s in zip(trial.T, missed, stress.T, strict=True):
            np.subtract(t, moved, out=moved)
            moved -= s
            size = np.abs(t)
            size += np.abs(s)
            size *= _HALF * ROUNDING
            rounding &= np.abs(moved) <= size
        if (more := np.flatnonzero(~rounding)).size:  # where parts of k slip cancel
            whole = np.abs(slip[more]) @ np.abs(self.stiffness) + np.abs(trial[more]) + np.abs(stress[more])
            rounding[more] = (np.abs(missed.T[more]) <= (_HALF * ROUNDING) * whole).all(axis=1)
        return missed, rounding

    def _excess(self, pressure: Array, point: Array, moved: Array, room: Array, far: Array) -> Array | None:
        """The residual of the variational inequality (M,), None where it is 0 for all."""
        known = self.known

        def found(at: NDArray[np.intp] | slice, of: Callable[..., Array]) -> Array:
            return of(pressure[at], point.T[at], moved.T[at], np.ones(len(room[at])), (far + room)[at], room[at])

        few = known.beyond(pressure, point, moved)
        if known.convex and not few.size:
            return None
        excess = np.zeros(len(room))
        if few.size:
            excess[few] = found(few, known.excess)
        return excess if known.convex else np.fmax(excess, found(slice(None), known.beside))


def _squared(columns: Array) -> Array:
    """Squares of lengths (M,) of vectors (d, M)."""
    found, *others = np.square(columns)
    for square in others:
        found += square
    return np.asarray(found)


def _length(columns: Array) -> Array:
    """The same, their roots."""
    squares = _squared(columns)
    return np.sqrt(squares, out=squares)


def _within(numbers: Array, least: float, most: float) -> NDArray[np.bool_] | bool:
    """Which of them lie in a range: True where all do, as they mostly do."""
    return bool(numbers.min(initial=most) >= least and numbers.max(initial=least) <= most) or (numbers >= least) & (numbers <= most)
