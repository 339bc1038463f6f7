"""Where the fit starts: the answer of a convex programme for quarter ellipses, the best of a few guesses for other laws.

For quarter ellipses the criterion is linear in w = 1/mu^2, so that

    minimise  sum_i |c_i (w . A_i - 1)|   subject to   w >= least > 0

is convex and every feasible w is an admissible law.  A
single minimum, so nothing depends on a guess, and sums of |.| let few points not outweigh the others.  The factor c_i =
|sigma_t| / (gamma^2 + gamma) scatter_i, gamma = sqrt(w . A_i), turns the algebraic residual into the distance along the
ray; the programme is solved with gamma = 1 first, then again with the gamma just found until that is at rest.
"""

from __future__ import annotations

from importlib import import_module
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import DuhemError
from duhem.identification.fit import HUBER, FitProblem
from duhem.identification.points import Points
from duhem.identification.surface import QuarterEllipses
from duhem.law.domain import Domain

__all__ = ["convex", "guesses"]

Array = NDArray[np.float64]

_LEAST = 1e-8  # of the w that the median of the points a coefficient is felt by allows
_MOST_ROUNDS = 6
_REST = 0.02
_INNERMOST = 0.3
_MOST_GUESSES = 81
_FITTED = 4


def convex(ellipses: QuarterEllipses, points: Points) -> Array:
    """The coefficients mu (p,) of the convex programme; every one must be felt by some point."""
    a, fixed, _ = ellipses.squares(points.forces)
    unit = np.array([np.median(column[column > 0.0]) for column in a.T])
    share, size = a / unit, np.linalg.norm(points.forces, axis=1) / points.scatter
    size /= np.median(size)
    gauge, w = np.ones_like(fixed), np.ones_like(unit)
    for _ in range(_MOST_ROUNDS):
        gauge = np.maximum(gauge, _INNERMOST)
        w = _solved(share, 1.0 - fixed, size / (gauge * gauge + gauge))
        before, gauge = gauge, np.sqrt(fixed + share @ w)
        if np.median(np.abs(gauge - before)) <= _REST:
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
        raise DuhemError(
            f"the convex programme was not solved: {fault}", remedy="check the points for numbers of very different size"
        ) from None
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
        raise DuhemError(
            "the fit has no start: the law is undefined at the points", where=points.where, remedy="fix a parameter with --set"
        )
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
