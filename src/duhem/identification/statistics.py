"""What the fit is worth: Fisher information, covariance, standardised residuals, outliers, bootstrap."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.optimize import brentq

from duhem.identification.fit import HUBER, FitProblem, Solved

__all__ = ["bootstrapped", "covariance", "fisher_information", "leverage", "outlying", "scatter_level"]

Array = NDArray[np.float64]

OUTLIER_LEVEL = 0.01  # chance that any of the points of a sound table is named
_ALONE = 1e-9  # a point that determines a coefficient on its own has no residual to be judged by
_FEET = 4


def fisher_information(solved: Solved, level: float) -> Array:
    """Information (p, p) of independent Gaussian errors of standard deviation ``level`` x scatter in both forces.

    sum_i n_i n_i^T / (level scatter_i)^2 with n_i = d distance_i / d theta: the unknown true places along the boundary
    are projected out.  Its inverse bounds the covariance of unbiased estimates (Cramér-Rao), to first order in scatter.
    """
    return np.asarray(solved.slope.T @ solved.slope / level**2)


def scatter_level(solved: Solved, rounding: float, *, robust: bool) -> float:
    """The level s estimated from what the fit leaves: sqrt(sum r^2/(m - p)), for the robust fit the level it used.

    At least ``rounding``; NaN where there are no more points than parameters.
    """
    m, p = solved.slope.shape
    if m <= p:
        return float("nan")
    return max(rounding, solved.level if robust else float(np.sqrt(np.sum(np.square(solved.residual)) / (m - p))))


def covariance(solved: Solved, level: float, *, robust: bool) -> Array:
    """Covariance (p, p) of the parameters: the inverse of the Fisher information, for the robust fit times
    [sum psi^2/(m - p)] / [mean psi']^2, psi = Huber's clipped residual over the level (P. J. Huber, 1981, section 7.6)."""
    m, p = solved.slope.shape
    r = np.linalg.qr(solved.slope, mode="r")
    half = np.linalg.inv(r) * level
    factor = 1.0
    if robust and m > p:
        z = solved.residual / level
        inside = float(np.mean(np.abs(z) <= HUBER))
        factor = float(np.sum(np.square(np.clip(z, -HUBER, HUBER))) / (m - p)) / inside**2 if inside else float("inf")
    return np.asarray(factor * half @ half.T)


def leverage(solved: Solved) -> Array:
    """h_i (m,): the share of a point's own residual that the fit takes away."""
    q, _ = np.linalg.qr(solved.slope)
    return np.asarray(np.sum(np.square(q), axis=1))


@dataclass(frozen=True)
class OutlierTest:
    """Standardised residuals (m,) against the robust fit, NaN where a point cannot be judged, and the bound they break."""

    standardised: Array
    bound: float

    @property
    def outliers(self) -> NDArray[np.intp]:
        """Indices of the outliers, the worst first."""
        size = np.abs(np.nan_to_num(self.standardised))
        found = np.flatnonzero(size > self.bound)
        return np.asarray(found[np.argsort(-size[found], kind="stable")])


def outlying(robust: Solved, rounding: float, *, absolute: bool) -> OutlierTest:
    """Residuals of the robust fit over s sqrt(1 - h), and the bound |z| that one of m sound points breaks with chance 1 %."""
    m, p = robust.slope.shape
    rest = 1.0 - leverage(robust)
    level = max(robust.level, rounding)
    judged = rest > _ALONE
    z = np.where(judged, robust.residual / (level * np.sqrt(np.where(judged, rest, 1.0))), np.nan)
    tail = OUTLIER_LEVEL / (2 * m)
    bound = stats.norm.isf(tail) if absolute else stats.t.isf(tail, m - p) if m > p else np.inf
    return OutlierTest(np.asarray(z), float(bound))


def bootstrapped(problem: FitProblem, solved: Solved, corner: float | None, draws: int, seed: int) -> Array:
    """Parameters (draws, p) refitted to resampled points.

    Every point is put on the fitted boundary and moved off it along the normal: where the scatter is absolute by a normal
    deviate of that size, else by a residual drawn with replacement, r_j scatter_i / sqrt(1 - h_j), less the centre of
    them all in the sense of the loss (``corner`` as for the fit: the mean, or Huber's).  So each direction of the test
    keeps its points.
    """
    points, random = problem.points, np.random.default_rng(seed)
    feet = points.forces
    for _ in range(_FEET):
        distance, normal = problem.surface.distance(feet, solved.theta)
        feet = feet - distance[:, None] * normal
    rest = 1.0 - leverage(solved)
    free = solved.kept & (rest > _ALONE)
    pool = solved.residual[free] / np.sqrt(rest[free])
    pool = pool - _centre(pool, corner)
    normal = problem.surface.distance(feet, solved.theta)[1]
    found = []
    for _ in range(draws):
        deviate = random.standard_normal(len(points)) if points.absolute else random.choice(pool, size=len(points))
        moved = deviate * points.scatter
        resampled = replace(problem, points=points.at(feet + moved[:, None] * normal))
        found.append(resampled.minimised(solved.theta, corner))
    return np.array(found)


def _centre(pool: Array, corner: float | None) -> float:
    """Where the loss of the differences is least."""
    if corner is None or not np.ptp(pool):
        return float(np.mean(pool)) if pool.size else 0.0
    return float(brentq(lambda c: np.sum(np.clip(pool - c, -corner, corner)), pool.min(), pool.max()))
