"""Points of K nearer to a trial stress than the answer: on a K that is not known to be convex, nothing else speaks against an answer.

For all tau of any K the closest point sigma makes, in the metric of the increment,

    (sigma_tr - sigma) . k^-1 (tau - sigma) - |tau - sigma|^2/2 = (|sigma_tr - sigma|^2 - |sigma_tr - tau|^2)/2 <= 0.

It is tried on points of K on some hundred rays, beside the answer, and then on the sphere about the trial that passes just
within the answer: from each point on the rays that is nearer than those around it, g is brought down along that sphere, and
where it falls below zero K comes nearer.  That nothing is found shows nothing: the answer is stationary.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from duhem.projection.increment import Increment
from duhem.projection.metric import Metric
from duhem.projection.result import Array, Solution
from duhem.projection.row_by_row import dot, length, products, times, unit, widest
from duhem.projection.scaled_formula import power_of_two
from duhem.projection.scaled_yield_function import Level, level_of
from duhem.projection.variational_samples import looks, points_seen, tangents

__all__ = ["nearness"]

_NEARER = 4e-7  # of the length of a stress: an answer that passes may be off by a quarter of this
_FAR = 1e6  # lengths of a stress: from farther off the ball of a nearer trial is looked into, which lies within
_ASIDE = (0.3, 0.03, 0.003)  # of it
_SEEDS = 6  # of a trial, to go on from
_OWN = 2.0  # distances of neighbours
_STEPS = 16
_FALLS = 3
_AT_ONCE = 500_000  # trials times points


def nearness(question: Increment, solution: Solution) -> Array:
    """By how much (N,) a point of K that is found is nearer to the trial stress, over the length of the stress; 0 where none is."""
    search = _NearerSearch(level_of(question), Metric.of(question.stiffness), question.law.pressure is not None)
    out = np.zeros(len(solution.multiplier))
    with np.errstate(all="ignore"):
        finite = np.isfinite(solution.stress).all(axis=1) & np.isfinite(solution.slip).all(axis=1)
        out[~finite] = np.nan
        moved = np.flatnonzero(finite & (solution.slip != 0.0).any(axis=1))
        if moved.size:
            for rows, look in search.looked_at(moved, question.pressure):
                out[rows] = search.found(look, solution.stress[rows], solution.slip[rows], question.pressure[rows])
    return out


@lru_cache(maxsize=256)
def _seen(g: Level, d: int, pressure: float | None) -> tuple[Array, NDArray[np.intp]]:
    """Points of K (n, d) at one pressure, and for each the numbers of those around it (n, few)."""
    points, scale = points_seen(g, d, pressure)
    at = points / scale
    apart = np.linalg.norm(at[:, None] - at, axis=2) if len(at) else np.zeros((0, 0))
    return points, np.argsort(apart, axis=1, kind="stable")[:, 1 : 1 + 2 * d]


@dataclass(frozen=True)
class _Answers:
    """Rows to look at, in lengths of their own ``size``: ``point`` sigma and ``way`` to the trial in the metric, and how ``far``."""

    size: Array
    units: Array
    pressure: Array
    point: Array
    way: Array
    far: Array
    room: Array

    def rise(self, points: Array, rows: NDArray[np.intp]) -> Array:
        """(|sigma_tr - sigma|^2 - |sigma_tr - tau|^2) / 2 |sigma_tr - sigma| of points tau (m, d)."""
        apart = points - self.point[rows]
        return np.asarray(dot(apart, self.way[rows]) - dot(apart, apart) / (2.0 * self.far[rows]))

    def back(self, points: Array, rows: NDArray[np.intp]) -> Array:
        """Unit vectors (m, d) from the points to the trial."""
        return unit(self.far[rows, None] * self.way[rows] - (points - self.point[rows]))[0]

    def within(self, points: Array, rows: NDArray[np.intp]) -> Array:
        """The points (m, d), moved towards or from the trial onto the sphere about it that passes just within the answer."""
        back = self.back(points, rows)
        less = _NEARER * self.room[rows]
        return np.asarray(self.point[rows] + self.far[rows, None] * (self.way[rows] - back) + less[:, None] * back)


@dataclass(frozen=True, eq=False)
class _NearerSearch:
    """One formula in the metric of one stiffness."""

    g: Level
    metric: Metric
    pressed: bool

    def looked_at(self, rows: NDArray[np.intp], pressure: Array) -> Iterator[tuple[NDArray[np.intp], float | None]]:
        """The ``rows`` a few at a time, with the pressure at which to look at K: the power of two below their own, whatever others have."""
        if not self.pressed:
            yield from self._few(rows, None)
            return
        below = np.where(pressure[rows] < 0.0, -power_of_two(-pressure[rows]), 0.0)
        seen = np.empty(rows.size)
        for size in np.unique(below).tolist():
            (seen[below == size],) = looks(self.g, self.g.forces, np.array([size]))
        for look in np.unique(seen).tolist():
            yield from self._few(rows[seen == look], look)

    def _few(self, rows: NDArray[np.intp], look: float | None) -> Iterator[tuple[NDArray[np.intp], float | None]]:
        count = max(1, _AT_ONCE // max(1, len(_seen(self.g, self.g.forces, look)[0])))
        for start in range(0, rows.size, count):
            yield rows[start : start + count], look

    def found(self, look: float | None, stress: Array, slip: Array, pressure: Array) -> Array:
        """How much nearer K comes (n,), over the length of a stress."""
        answers = self._answers(stress, slip, pressure)
        height = np.zeros(len(stress))
        self._try(height, answers, *self._beside(answers))
        for start, size in self._round_the_trial(answers):
            rest = np.flatnonzero(height == 0.0)
            self._down(height, answers, start[rest], rest, size[rest])
        points, around = _seen(self.g, self.g.forces, look)
        if len(points):
            part = np.ones(len(stress)) if not look else pressure / look
            for seeds, rows, reach in self._seeds(answers, points, around, part):
                rest = np.flatnonzero(height[rows] == 0.0)
                self._down(height, answers, seeds[rest], rows[rest], reach[rest])
        return np.asarray(height / answers.room)

    def _answers(self, stress: Array, slip: Array, pressure: Array) -> _Answers:
        point, moved = times(stress, self.metric.of_stress), times(slip, self.metric.of_slip)
        size = power_of_two(np.maximum(widest(point), np.where(widest(point) > 0.0, 0.0, widest(moved))))
        point, (way, far) = point / size[:, None], unit(moved)
        room = np.where(widest(point) > 0.0, length(point), 1.0)
        far = np.minimum(far / size, _FAR * room)
        reach = np.where(widest(stress) > 0.0, widest(stress), widest(times((size * far)[:, None] * way, self.metric.to_stress)))
        return _Answers(size, power_of_two(reach), pressure, point, way, far, room)

    def _stress(self, points: Array, answers: _Answers, rows: NDArray[np.intp]) -> Array:
        return np.asarray(answers.size[rows, None] * times(points, self.metric.to_stress))

    def _try(self, height: Array, answers: _Answers, points: Array, rows: NDArray[np.intp]) -> None:
        """Enter what the points (m, d) are nearer by that lie in K."""
        rise = answers.rise(points, rows)
        near = np.flatnonzero(rise > 0.5 * _NEARER * answers.room[rows])
        stress = self._stress(points[near], answers, rows[near])
        value, bound = self.g.bounded(stress, answers.pressure[rows[near]], power_of_two(widest(stress)))
        inside = value < -bound  # and not by rounding
        np.maximum.at(height, rows[near[inside]], rise[near[inside]])

    def _beside(self, answers: _Answers) -> tuple[Array, NDArray[np.intp]]:
        """Points on the sphere close to the answers."""
        every = np.arange(len(answers.room))
        beside = [
            answers.within(answers.point + (share * answers.room)[:, None] * way, every)
            for way in tangents(answers.way)
            for share in _ASIDE
        ]
        return np.vstack([np.zeros((0, answers.point.shape[1])), *beside]), np.tile(every, len(beside))

    def _round_the_trial(self, answers: _Answers) -> Iterator[tuple[Array, Array]]:
        """Points (n, d) to go on from, and how far at first: where g falls to from the trial, and beyond two forces the axes from there."""
        every, trial = np.arange(len(answers.room)), answers.point + answers.far[:, None] * answers.way
        start = trial
        for _ in range(_FALLS):
            value, slope = self._slopes(start, answers, every)
            start = start - np.nan_to_num((value / dot(slope, slope))[:, None] * slope)
        yield start, answers.room
        if trial.shape[1] > 2:
            for axis in np.vstack([np.eye(trial.shape[1]), -np.eye(trial.shape[1])]):
                yield trial + answers.far[:, None] * axis, answers.far

    def _seeds(
        self, answers: _Answers, points: Array, around: NDArray[np.intp], part: Array
    ) -> Iterator[tuple[Array, NDArray[np.intp], Array]]:
        """Points of K nearer to the trial than those around them, one a row at a time, the best first; and how far those around are."""
        known = times(points, self.metric.of_stress)
        apart = np.linalg.norm(known[:, None] - known[around], axis=2)
        spacing, close = apart.max(axis=1, initial=0.0), apart.min(axis=1, initial=np.inf)
        by, far = (part / answers.size)[:, None], answers.far[:, None]
        square = by * by * dot(known, known) + dot(answers.point, answers.point)[:, None] - 2.0 * by * products(answers.point, known)
        rise = by * products(answers.way, known) - dot(answers.way, answers.point)[:, None] - square / (2.0 * far)
        best = rise > -by * spacing
        if answers.point.shape[1] == 2:  # rays are close there, and the answer's own place has been looked at
            best &= (rise > 0.0) | (square > (_OWN * by * close) ** 2)
        for column in around.T:
            best &= rise >= rise[:, column]
        rise[~best] = -np.inf
        for _ in range(_SEEDS):
            chosen = rise.argmax(axis=1)
            rows = np.flatnonzero(rise[np.arange(len(rise)), chosen] > -np.inf)
            if not rows.size:
                return
            at = chosen[rows]
            yield by[rows] * known[at], rows, by[rows, 0] * spacing[at]
            rise[rows, at] = -np.inf

    def _down(self, height: Array, answers: _Answers, points: Array, rows: NDArray[np.intp], reach: Array) -> None:
        """Bring g down along the sphere, from the ``points`` (m, d) and by no more than ``reach`` (m,) at first, until it is below zero."""
        self._try(height, answers, points, rows)
        at, step = answers.within(points, rows), reach
        value, slope = self._slopes(at, answers, rows)
        for _ in range(_STEPS):
            self._try(height, answers, at[value < 0.0], rows[value < 0.0])
            go = np.flatnonzero((value > 0.0) & (step > _NEARER * answers.room[rows]))
            if not go.size:
                return
            at, step, value, slope, rows = at[go], step[go], value[go], slope[go], rows[go]
            back = answers.back(at, rows)
            along = slope - dot(slope, back)[:, None] * back
            steep = length(along)
            step = np.minimum(step, value / steep)
            after = answers.within(at - (step / steep)[:, None] * along, rows)
            lower, slopes = self._slopes(after, answers, rows)
            better = lower < value
            at, slope = np.where(better[:, None], after, at), np.where(better[:, None], slopes, slope)
            value, step = np.where(better, lower, value), np.where(better, 2.0, 0.25) * step

    def _slopes(self, points: Array, answers: _Answers, rows: NDArray[np.intp]) -> tuple[Array, Array]:
        """g and its slope in the metric, in one unit a row."""
        jet, _ = self.g.slopes(self._stress(points, answers, rows), answers.pressure[rows], answers.units[rows])
        assert jet.gradient is not None
        return jet.value * answers.units[rows] / answers.size[rows], times(jet.gradient, self.metric.of_slip)
