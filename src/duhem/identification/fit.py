"""The fit itself: least squares of distances over scatter, or Huber's loss of them, over the domain of the parameters.

    minimise  sum_i rho(distance_i(theta) / (s scatter_i)),   rho(z) = z^2/2, or for the robust fit z^2/2 up to |z| = 1.345
                                                              and 1.345 |z| - 1.345^2/2 beyond (P. J. Huber, 1964)

With rho = z^2/2 this is the maximum-likelihood fit of the boundary to points with independent Gaussian errors of both
forces, to first order in scatter over radius of curvature.  The robust fit needs the level s of the scatter: one, where
the scatter is absolute, else 1.4826 times the median of |distance|/scatter, renewed until it is at rest.  Points farther
off than 20 s are left out of it: so far away the first-order distance means nothing, and its slope grows without bound.

The fit moves in the logarithm of a positive parameter, any other parameter as it is: a positive parameter stays positive without a bound,
and a change of unit is a shift.  It starts from the answer of a convex programme for quarter ellipses (:func:`convex`), and from the best
of a few guesses for other laws.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from duhem.errors import DuhemError
from duhem.identification.points import Points
from duhem.identification.surface import QuarterEllipses, Surface
from duhem.law.domain import Domain

__all__ = ["HUBER", "Coordinates", "FitProblem", "Solved", "convex", "guesses"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Coordinates:
    """Parameters theta (p,) to coordinates x (p,) and back, over their ``domains``."""

    domains: tuple[Domain, ...]

    @property
    def logarithmic(self) -> NDArray[np.bool_]:
        """Which parameters are moved by their logarithm (p,)."""
        return np.array([domain.positive for domain in self.domains], dtype=np.bool_)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Least and greatest coordinate; infinite where the domain has no end there."""
        low = [-np.inf if d.positive or d.low is None else float(d.low) for d in self.domains]
        high = [np.inf if d.high is None else np.log(float(d.high)) if d.positive else float(d.high) for d in self.domains]
        return np.array(low), np.array(high)

    @property
    def unbounded(self) -> bool:
        """Whether no coordinate has a bound."""
        low, high = self.bounds
        return bool(np.all(np.isinf(low)) and np.all(np.isinf(high)))

    def inward(self, theta: Sequence[float] | Array) -> Array:
        """The coordinates of ``theta``."""
        values, logs = np.asarray(theta, dtype=np.float64), self.logarithmic
        return np.where(logs, np.log(np.where(logs, values, 1.0)), values)

    def outward(self, x: Array) -> Array:
        """The parameters at ``x``."""
        logs = self.logarithmic
        with np.errstate(over="ignore"):  # an interval may be endless
            return np.where(logs, np.exp(np.where(logs, x, 0.0)), x)

    def stretch(self, theta: Array) -> Array:
        """d theta / d x (p,)."""
        return np.where(self.logarithmic, theta, 1.0)


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
            tolerances = dict.fromkeys(("ftol", "xtol", "gtol"), _TOLERANCE)
            way: dict[str, Any] = {"method": "lm", "x_scale": "jac"} if plain else {"method": "trf", "x_scale": 1.0, "bounds": (low, high)}
            loss = "linear" if corner is None else "huber"
            found = least_squares(residual, first, slope, loss=loss, max_nfev=100, **way, **tolerances)
        return c.outward(found.x)


_LEAST = 1e-8  # of the w that the median of the points a coefficient is felt by allows
_MOST_PROGRAMMES = 6
_GAUGE_AT_REST = 0.02
_INNERMOST = 0.3
_MOST_GUESSES = 81
_FITTED = 4


def convex(ellipses: QuarterEllipses, points: Points) -> Array:
    """The coefficients mu (p,) of the convex programme; every one must be felt by some point.

    For quarter ellipses the criterion is linear in w = 1/mu^2, so that

        minimise  sum_i |c_i (w . A_i - 1)|   subject to   w >= least > 0

    is convex and every feasible w is an admissible law.  A single minimum, so nothing depends on a guess, and sums of |.| let few points
    not outweigh the others.  The factor c_i = |sigma_t| / (gamma^2 + gamma) scatter_i, gamma = sqrt(w . A_i), turns the algebraic residual
    into the distance along the ray; the programme is solved with gamma = 1 first, then again with the gamma just found until that is at
    rest.
    """
    a, fixed, _ = ellipses.squares(points.forces)
    unit = np.array([np.median(column[column > 0.0]) for column in a.T])
    share, size = a / unit, np.linalg.norm(points.forces, axis=1) / points.scatter
    size /= np.median(size)
    gauge, w = np.ones_like(fixed), np.ones_like(unit)
    for _ in range(_MOST_PROGRAMMES):
        gauge = np.maximum(gauge, _INNERMOST)
        w = _solved(share, 1.0 - fixed, size / (gauge * gauge + gauge))
        before, gauge = gauge, np.sqrt(fixed + share @ w)
        if np.median(np.abs(gauge - before)) <= _GAUGE_AT_REST:
            break
    return np.asarray(np.sqrt(unit / w))


def _solved(share: Array, target: Array, factor: Array) -> Array:
    cp: Any = import_module("cvxpy")
    w = cp.Variable(share.shape[1])
    row = factor / np.maximum(1.0, factor * np.linalg.norm(share, axis=1))  # a far point's row would spoil the scaling
    residual = cp.multiply(row, share @ w - target)
    problem = cp.Problem(cp.Minimize(cp.norm1(residual)), [w >= _LEAST])
    try:
        problem.solve(solver=cp.CLARABEL)
    except cp.error.SolverError as fault:
        what = f"the convex programme was not solved: {fault}"
        raise DuhemError(what, remedy="check the points for numbers of very different size") from None
    if w.value is None:
        raise DuhemError(f"the convex programme ended as {problem.status}", remedy="check the points")
    return np.maximum(np.asarray(w.value, dtype=np.float64), _LEAST)


def guesses(problem: FitProblem, *, robust: bool) -> Array:
    """The best (p,) of the fits from a few guesses: a ratio, a stress or one for what is positive, points of an interval."""
    points = problem.points
    size = np.linalg.norm(points.forces, axis=1)
    stress = float(np.median(size))
    ratio = stress if points.pressure is None else float(np.median(size / np.abs(points.pressure)))
    choices = [_candidates(domain, ratio, stress) for domain in problem.coordinates.domains]

    def loss(theta: Array) -> float:
        z = np.abs(problem.residual(theta))
        total = float(np.sum(z if robust else z * z))
        return total if np.isfinite(total) else np.inf

    ranked = sorted((np.array(guess) for guess in list(product(*choices))[:_MOST_GUESSES]), key=loss)
    ways = [
        problem.minimised(theta, HUBER * problem.level(theta) if robust else None) for theta in ranked[:_FITTED] if np.isfinite(loss(theta))
    ]
    if not ways:
        what = "the fit has no start: the law is undefined at the points"
        raise DuhemError(what, where=points.where, remedy="fix a parameter with --set")
    return min((*ways, ranked[0]), key=loss)


def _candidates(domain: Domain, ratio: float, stress: float) -> list[float]:
    low, high = (None if end is None else float(end) for end in (domain.low, domain.high))
    if domain.positive:
        found: list[Any] = [x for x in (ratio, stress, 1.0) if high is None or x <= high]
        return list(dict.fromkeys(found)) or [0.5 * (high or 1.0)]
    if low is None or high is None:
        anchor = low if low is not None else (high if high is not None else 0.0)
        return [anchor + s for s in ((1.0, 0.25, 3.0) if low is not None else (-1.0, -0.25) if high is not None else (0.0,))]
    return [low + t * (high - low) for t in (0.5, 0.1, 0.9)]
