"""The variational inequality of answers, tried on known points of K: (sigma_tr - sigma) . k^-1 (tau - sigma) <= 0 for all tau of K.

Which points are known: :mod:`duhem.projection.known_points`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from duhem.projection.close_look import as_pairs, close_look
from duhem.projection.in_blocks import FEW_SEARCHED
from duhem.projection.increment import Increment
from duhem.projection.judge_kernel import FARTHEST
from duhem.projection.known_points import beyond_tangents, raised, tips
from duhem.projection.level import Level
from duhem.projection.metric import Metric
from duhem.projection.result import ACCURACY, Array
from duhem.projection.row_by_row import columns_times, dot, length, share, unit, widest
from duhem.projection.scaled_formula import power_of_two

__all__ = ["Variational"]

_QUANTILES = (0.0, 0.5, 1.0)  # pressures at which K is looked at, of those that occur


@dataclass(frozen=True, eq=False)
class Variational:
    """``tips`` (T, d) are points of K at the pressure ``largest``, ``reaches`` (T, d) they in the metric of k.

    ``largest`` is the largest of the pressures; of few points on a convex K the power of two within it.  ``convex``: K need not be
    looked at close to each answer.  ``increment`` has the law for more digits.
    """

    level: Level
    metric: Metric
    tips: Array
    reaches: Array
    largest: float
    convex: bool
    increment: Increment

    @classmethod
    def of(cls, increment: Increment, level: Level, metric: Metric, convex: bool) -> Variational:
        d, pressed = level.forces, increment.law.pressure is not None
        largest = float(increment.pressure.min(initial=0.0))
        if convex and len(increment.pressure) <= FEW_SEARCHED:  # points that come one after the other share the tips of few pressures
            largest = -math.ldexp(1.0, math.frexp(largest)[1] - 1) if largest else 0.0
        known = tips(level, d, largest if pressed else None)
        if not convex:
            pressures = np.quantile(increment.pressure, _QUANTILES, method="nearest") if pressed else None
            known = np.vstack([known, beyond_tangents(level, d, None if pressures is None else np.unique(pressures))])
        return cls(level, metric, known, known @ metric.of_stress, largest, convex, increment)

    @property
    def around_origin(self) -> bool:
        """Whether K at that pressure goes on from no stress: then the sets {g <= e} are looked at from there."""
        return bool(self.tips.any())

    def part(self, pressure: Array) -> Array:
        """The pressures as parts of the one at which the tips are known."""
        return np.ones(pressure.size) if self.largest == 0.0 else pressure / self.largest

    def rise(self, s: Array, slope: Array, pressure: Array, units: Array, room: Array, far: Array) -> Array:
        """By how much h rises to stresses ``s`` (M, d) in ``units``, as over their own lengths; nan where nothing is known.

        It rises from a mean of the known points of K on the axes, not with equal weights: a formula may have no value in the middle.
        ``slope`` is dh/ds, ``room`` and ``far`` are the lengths of stress and slip in the metric.  How far the closest point goes
        with the boundary is estimated by a parabola on the way from that place, where the sets {h <= e} are not alike seen from there:
        exactly for a quadratic h.
        """
        d, part = s.shape[1], self.part(pressure) / units
        centre = np.zeros_like(s)
        for weight, tip in enumerate(self.tips[: 2 * d + 1]):
            centre += weight / (d * (2 * d + 1)) * np.clip(part[:, None] * tip, -FARTHEST, FARTHEST)
        rise = -self.level.value(*centre.T, *self.level.scaled.values(pressure, units).values())
        height, reach = dot(slope, s - centre), length((s - centre) @ self.metric.of_stress) * units
        bend = 2.0 * np.maximum(height - rise, 0.0) * units / length(slope @ self.metric.of_slip) * far / reach**2
        low = np.minimum(height, rise) if self.level.jets.kinks else height  # a piece that is as high may be flatter
        return np.where((rise > 0.0) & (height > 0.0), low * room / (reach * np.sqrt(1.0 + bend)), np.nan)

    def beyond(self, pressure: Array, point: Array, moved: Array) -> NDArray[np.intp]:
        """The points (d, N) with one of the tips beyond the plane across the slip, whether or not it lies in K."""
        most = reduce(np.maximum, columns_times(moved, self.reaches.T))
        return np.flatnonzero(~(self.part(pressure) * most <= dot(point.T, moved.T)))

    def excess(self, pressure: Array, point: Array, moved: Array, size: Array, whole: Array, reach: Array) -> Array:
        """The largest (sigma_tr - sigma) . k^-1 (tau - sigma) over known points tau of K, relative; lengths are over ``size``."""
        worst, work, part = np.zeros(len(whole)), dot(point, moved), self.part(pressure)
        for tip, way, far in zip(self.tips, *map(np.nan_to_num, unit(self.reaches)), strict=True):  # the origin has no way
            away = part * (far / size)
            excess = away * (moved @ way) - work
            if (beyond := np.flatnonzero(excess > 0.0)).size:
                inside = self._inside(part[beyond, None] * tip, pressure[beyond])
                relative = share(excess[beyond], whole[beyond] * (away[beyond] + reach[beyond]))
                against = np.flatnonzero(inside & (relative > ACCURACY))
                inside[against] = ~self._outside(part[beyond[against], None] * tip, pressure[beyond[against]])
                worst[beyond] = np.fmax(worst[beyond], np.where(inside, relative, 0.0))
        return worst

    def beside(self, pressure: Array, point: Array, moved: Array, size: Array, whole: Array, room: Array) -> Array:
        """The same over points tau close to the stress."""

        def inside(points: Array, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
            return self._inside(size[rows, None] * (points @ self.metric.to_stress), pressure[rows])

        normal, distance = map(np.nan_to_num, unit(moved))
        return np.asarray(share(distance * raised(inside, point, normal, room), whole * 2.0 * room))

    def _outside(self, stress: Array, pressure: Array) -> NDArray[np.bool_]:
        """What more digits show to be no point of K: what rounding of g calls one speaks against no answer."""
        size = power_of_two(widest(stress))
        value, bound = close_look(self.increment).level(as_pairs(stress, size), pressure, size)
        return np.asarray(value > bound)

    def _inside(self, stress: Array, pressure: Array) -> NDArray[np.bool_]:
        return np.asarray(self.level(*stress.T, pressure) < 0.0)  # at = 0 it may be rounding alone
