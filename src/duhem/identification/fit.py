"""The fit itself: least squares of distances over scatter, or Huber's loss of them, over the domain of the parameters.

    minimise  sum_i rho(distance_i(theta) / (s scatter_i)),   rho(z) = z^2/2, or for the robust fit z^2/2 up to |z| = 1.345
                                                              and 1.345 |z| - 1.345^2/2 beyond (P. J. Huber, 1964)

With rho = z^2/2 this is the maximum-likelihood fit of the boundary to points with independent Gaussian errors of both
forces, to first order in scatter over radius of curvature.  The robust fit needs the level s of the scatter: one, where
the scatter is absolute, else 1.4826 times the median of |distance|/scatter, renewed until it is at rest.  Points farther
off than 20 s are left out of it: so far away the first-order distance means nothing, and its slope grows without bound.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from duhem.errors import DuhemError
from duhem.identification.coordinates import Coordinates
from duhem.identification.points import Points
from duhem.identification.surface import Surface

__all__ = ["HUBER", "FitProblem", "Solved"]

Array = NDArray[np.float64]

HUBER = 1.345  # 95 % of the efficiency of least squares where the errors are Gaussian
_HOPELESS = 20.0
_FARTHEST = 16.0  # e^16 = 9e6 times the start: farther off a formula may lose every digit and seem to fit
_MOST_ROUNDS = 20
_REST = 1e-6
_TOLERANCE = 1e-14
_ROUNDING = 32.0 * float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Solved:
    """Parameters ``theta`` (p,), ``residual`` = distance/scatter (m,), its slope in the parameters (m, p), the level s.

    ``kept`` (m,): which points the fit took; the slope of the others is zero.
    """

    theta: Array
    residual: Array
    slope: Array
    level: float
    kept: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class FitProblem:
    """Points, the surface that is to pass through them, and where its parameters may lie."""

    points: Points
    surface: Surface
    coordinates: Coordinates

    def residual(self, theta: Array) -> Array:
        """Distance over scatter (m,)."""
        return np.asarray(self.surface.distance(self.points.forces, theta)[0] / self.points.scatter)

    def slope(self, theta: Array) -> Array:
        """d residual / d theta (m, p)."""
        return np.asarray(self.surface.slope(self.points.forces, theta) / self.points.scatter[:, None])

    def rounding(self) -> float:
        """The size of residuals that are nothing but rounding."""
        return _ROUNDING * float(np.max(np.abs(self.points.forces) / self.points.scatter[:, None]))

    def least_squares(self, start: Array) -> Solved:
        """The maximum-likelihood fit, from parameters ``start``."""
        return self._at(self.minimised(start, None), np.ones(len(self.points), dtype=np.bool_))

    def huber(self, start: Array) -> Solved:
        """The robust fit, from parameters ``start``, which should be robust themselves."""
        theta, level = start, self.level(start)
        kept = self._within(theta, level)
        for _ in range(_MOST_ROUNDS):
            theta = self._of(kept).minimised(theta, HUBER * level)
            before, level, kept = level, self.level(theta), self._within(theta, self.level(theta))
            if abs(level - before) <= _REST * before:
                break
        return self._at(theta, kept)

    def level(self, theta: Array) -> float:
        """The level s of the scatter: one where that is absolute, else from the median of the residuals."""
        if self.points.absolute:
            return 1.0
        sizes = np.sort(np.abs(self.residual(theta)))
        spare = max(len(sizes) - len(theta), 1)  # p of the residuals are near zero whatever the scatter
        return max(1.4826 * float(np.median(sizes[-spare:])), self.rounding())

    def _within(self, theta: Array, level: float) -> NDArray[np.bool_]:
        kept = np.abs(self.residual(theta)) <= _HOPELESS * level
        return kept if np.count_nonzero(kept) > len(theta) else np.ones_like(kept)

    def _of(self, kept: NDArray[np.bool_]) -> FitProblem:
        """The same points, those not kept with endless scatter."""
        return replace(self, points=replace(self.points, scatter=np.where(kept, self.points.scatter, np.inf)))

    def _at(self, theta: Array, kept: NDArray[np.bool_]) -> Solved:
        return Solved(theta, self.residual(theta), self._of(kept).slope(theta), self.level(theta), kept)

    def minimised(self, start: Array, corner: float | None) -> Array:
        """The parameters that minimise the loss; ``corner`` is where Huber's turns linear, None for squares."""
        c = self.coordinates
        low, high = c.bounds
        first = np.clip(c.inward(start), low, high)
        if not first.size:
            return start
        if not np.all(np.isfinite(self.residual(c.outward(first)))):
            raise DuhemError("the fit has no start: the law is undefined at the points", where=self.points.where, remedy="check the points")
        unit = 1.0 if corner is None else corner
        plain = corner is None and c.unbounded and len(self.points) >= len(first)

        def residual(x: Array) -> Array:
            near = np.all(np.abs(np.where(c.logarithmic, x - first, 0.0)) < _FARTHEST)
            values = self.residual(c.outward(x)) / unit if near else np.full(len(self.points), np.nan)
            return np.where(np.isfinite(values), values, 1e100)

        def slope(x: Array) -> Array:
            theta = c.outward(x)
            return np.nan_to_num(self.slope(theta) * c.stretch(theta) / unit, posinf=0.0, neginf=0.0)

        with np.errstate(all="ignore"):
            found = least_squares(
                residual,
                first,
                slope,
                bounds=(-np.inf, np.inf) if plain else (low, high),
                method="lm" if plain else "trf",
                loss="linear" if corner is None else "huber",
                x_scale="jac" if plain else 1.0,
                ftol=_TOLERANCE,
                xtol=_TOLERANCE,
                gtol=_TOLERANCE,
                max_nfev=100,
            )
        return c.outward(found.x)
