"""From usable points to an identification: the fit, what it is worth (covariance, outliers, bootstrap), and the proof of the fitted law.

The fit is one of least squares of distances over scatter, or of Huber's loss of them, over the domain of the parameters:

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

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from itertools import product
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy import stats
from scipy.optimize import brentq, least_squares

from duhem.errors import DuhemError, InputError
from duhem.identification.points import Points
from duhem.identification.result import Estimate, Identification, Outlier
from duhem.identification.surface import QuarterEllipses, Surface, free_parameters, surface
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_domain
from duhem.proof.verdict import Verdict
from duhem.proof.verification import Verification, verify

__all__ = ["estimated"]

Array = NDArray[np.float64]

# -- the fit -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Coordinates:
    """The change from parameters theta (p,) to coordinates x (p,) and back, over the ``domains`` of the parameters."""

    domains: tuple[Domain, ...]

    @property
    def logarithmic(self) -> NDArray[np.bool_]:
        """Which parameters (p,) the fit moves by their logarithm."""
        return np.array([domain.positive for domain in self.domains], dtype=np.bool_)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """The least and the greatest coordinate; they are infinite where the domain has no end."""
        low = [-np.inf if d.positive or d.low is None else float(d.low) for d in self.domains]
        high = [np.inf if d.high is None else np.log(float(d.high)) if d.positive else float(d.high) for d in self.domains]
        return np.array(low), np.array(high)

    @property
    def unbounded(self) -> bool:
        """Whether none of the coordinates has a bound."""
        low, high = self.bounds
        return bool(np.all(np.isinf(low)) and np.all(np.isinf(high)))

    def inward(self, theta: Sequence[float] | Array) -> Array:
        """Return the coordinates of the parameters ``theta``."""
        values, logs = np.asarray(theta, dtype=np.float64), self.logarithmic
        return np.where(logs, np.log(np.where(logs, values, 1.0)), values)

    def outward(self, x: Array) -> Array:
        """Return the parameters at the coordinates ``x``."""
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
        """Return the distance of each point over its scatter (m,)."""
        return np.asarray(self.surface.distance(self.points.forces, theta)[0] / self.points.scatter)

    def slope(self, theta: Array) -> Array:
        """Return the slopes d residual / d theta (m, p)."""
        return np.asarray(self.surface.slope(self.points.forces, theta) / self.points.scatter[:, None])

    def rounding(self) -> float:
        """The size up to which residuals may come from rounding alone."""
        return _ROUNDING * float(np.max(np.abs(self.points.forces) / self.points.scatter[:, None]))

    def least_squares(self, start: Array) -> Solved:
        """Return the maximum-likelihood fit; it starts at the parameters ``start``."""
        return self._at(self.minimised(start, None), np.ones(len(self.points), dtype=np.bool_))

    def huber(self, start: Array) -> Solved:
        """Return the robust fit; it starts at the parameters ``start``, which should come from a robust estimate."""
        theta, level = start, self.level(start)
        kept = self._within(theta, level)
        for _ in range(_MOST_ROUNDS):
            theta = self._of(kept).minimised(theta, HUBER * level)
            before, level, kept = level, self.level(theta), self._within(theta, self.level(theta))
            if abs(level - before) <= _REST * before:
                break
        return self._at(theta, kept)

    def level(self, theta: Array) -> float:
        """Return the level s of the scatter: 1 if the scatter is absolute, else an estimate from the median of the residuals."""
        if self.points.absolute:
            return 1.0
        sizes = np.sort(np.abs(self.residual(theta)))
        spare = max(len(sizes) - len(theta), 1)  # p of the residuals are near zero whatever the scatter
        return max(1.4826 * float(np.median(sizes[-spare:])), self.rounding())

    def _within(self, theta: Array, level: float) -> NDArray[np.bool_]:
        kept = np.abs(self.residual(theta)) <= _HOPELESS * level
        return kept if np.count_nonzero(kept) > len(theta) else np.ones_like(kept)

    def _of(self, kept: NDArray[np.bool_]) -> FitProblem:
        """Return the problem with infinite scatter for the points that are not kept."""
        return replace(self, points=replace(self.points, scatter=np.where(kept, self.points.scatter, np.inf)))

    def _at(self, theta: Array, kept: NDArray[np.bool_]) -> Solved:
        return Solved(theta, self.residual(theta), self._of(kept).slope(theta), self.level(theta), kept)

    def minimised(self, start: Array, corner: float | None) -> Array:
        """Return the parameters that minimise the loss.  ``corner`` is where Huber's loss becomes linear; None means squares."""
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
        w = _weights(share, 1.0 - fixed, size / (gauge * gauge + gauge))
        before, gauge = gauge, np.sqrt(fixed + share @ w)
        if np.median(np.abs(gauge - before)) <= _GAUGE_AT_REST:
            break
    return np.asarray(np.sqrt(unit / w))


def _weights(share: Array, target: Array, factor: Array) -> Array:
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
    """Return the best (p,) of the fits from a few guesses: a ratio, a stress or 1 for a positive parameter, else points of its interval."""
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
    """Return h_i (m,): the share of a point's own residual that the fit removes (its leverage)."""
    q, _ = np.linalg.qr(solved.slope)
    return np.asarray(np.sum(np.square(q), axis=1))


@dataclass(frozen=True)
class OutlierTest:
    """The standardised residuals (m,) of the robust fit, NaN for a point that cannot be judged, and the bound that outliers exceed."""

    standardised: Array
    bound: float

    @property
    def outliers(self) -> NDArray[np.intp]:
        """The indices of the outliers, of which the worst comes first."""
        size = np.abs(np.nan_to_num(self.standardised))
        found = np.flatnonzero(size > self.bound)
        return np.asarray(found[np.argsort(-size[found], kind="stable")])


def outlying(robust: Solved, rounding: float, *, absolute: bool) -> OutlierTest:
    """Return residuals of the robust fit over s sqrt(1 - h), and the bound |z| that one of m correct points exceeds with chance 1 %."""
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
    """Return the value at which the loss of the differences is least."""
    if corner is None or not np.ptp(pool):
        return float(np.mean(pool)) if pool.size else 0.0
    return float(brentq(lambda c: np.sum(np.clip(pool - c, -corner, corner)), pool.min(), pool.max()))


CLAIMS = ("origin", "convexity", "normality", "dissipation")
_OF_CONVEXITY = ("convexity", "normality")
_UNFELT = 1e-9
_SINGULAR = 1e-8
_SNAP = 1e-12
_NEAR = 1e-9
_SHARE = 0.01
_TAILS = (0.025, 0.975)


def estimated(family: Criterion, read: Points, *, robust: bool, bootstrap: int, seed: int, convex: str) -> Identification:
    """Return the identification of ``family``; there are at least as many points as free parameters."""
    problem, unfelt = _felt(family, read, _problem(family, read))
    solved, resistant = _solved(problem, robust)
    names = _names(problem)
    if idle := _idle(problem, solved):
        problem = _problem(_pinned(family, {n: solved.theta[names.index(n)] for n in idle} | dict.fromkeys(unfelt, 1)), read)
        unfelt, keep = (
            unfelt | dict.fromkeys(idle, "at the best fit, no point depends on it"),
            [i for i, n in enumerate(names) if n not in idle],
        )
        solved, resistant = (replace(s, theta=s.theta[keep], slope=s.slope[:, keep]) for s in (solved, resistant))
        names = _names(problem)
    _check_settled(problem, solved)
    _check_at_rest(problem, solved, robust)
    level = 1.0 if read.absolute else scatter_level(solved, problem.rounding(), robust=robust)
    judged = outlying(resistant, problem.rounding(), absolute=read.absolute)
    corner = HUBER * solved.level if robust else None
    spread = covariance(solved, level, robust=robust)
    values = {n: _decimal(x, family.parameters[n]) for n, x in zip(names, solved.theta.tolist(), strict=True)}
    exponents = _exponents(family) & set(names)
    fitted = _fixed(family, _short(family, problem, solved, corner, exponents) if exponents else values, read)
    draws = _draws(problem, solved, corner, bootstrap, seed)
    intervals = _intervals(problem, solved, spread, draws)
    ends = _ends(problem, solved)
    estimates = {n: _estimate(n, values[n], spread[i, i], intervals[i], ends[i]) for i, n in enumerate(names)}
    return Identification(
        law=fitted,
        family=family,
        points=read,
        estimates=tuple(estimates.get(n) or _not_fitted(family, n, unfelt) for n in family.parameters),
        residual=solved.residual,
        standardised=judged.standardised,
        bound=judged.bound,
        outliers=tuple(
            Outlier(int(i) + 1, read.lines[i], float(resistant.residual[i] * read.scatter[i]), float(judged.standardised[i]))
            for i in judged.outliers
        ),
        fisher=fisher_information(solved, level),
        covariance=spread,
        level=level,
        draws=draws,
        seed=seed,
        robust=robust,
        minimised=f"sum of {'Huber(1.345)' if robust else 'squares'} of distance to the boundary over scatter, distance = g/|dg/dsigma|",
        verification=_proved(fitted, convex),
    )


def _problem(law: Criterion, points: Points) -> FitProblem:
    return FitProblem(points, surface(law, points.pressure), Coordinates(tuple(law.parameters[n] for n in free_parameters(law))))


def _names(problem: FitProblem) -> tuple[str, ...]:
    return problem.surface.names


def _pinned(law: Criterion, values: Mapping[str, Any]) -> Criterion:
    return law.fix({name: _decimal(float(value), law.parameters[name]) for name, value in values.items()})


def _felt(family: Criterion, points: Points, problem: FitProblem) -> tuple[FitProblem, dict[str, str]]:
    """Return the problem without the coefficients that no point depends on, and the reason for each."""
    ellipses = problem.surface
    if not isinstance(ellipses, QuarterEllipses):
        return problem, {}
    squares = ellipses.squares(points.forces)[0]
    columns = zip(ellipses.names, squares.T, strict=True)
    unfelt = {name: f"no point has {ellipses.senses(name)}" for name, column in columns if not column.any()}
    if len(unfelt) == len(ellipses.names):
        raise InputError("; ".join(unfelt.values()), where=points.where, remedy=f"{', '.join(unfelt)} need points there")
    return (_problem(_pinned(family, dict.fromkeys(unfelt, 1)), points) if unfelt else problem), unfelt


# -- the fit and what is known of it ---------------------------------------------------------------------------------


def _solved(problem: FitProblem, robust: bool) -> tuple[Solved, Solved]:
    """Return the requested fit, and the robust fit, by which outliers are found."""
    ellipses = problem.surface
    wide = isinstance(ellipses, QuarterEllipses)
    start = convex(ellipses, problem.points) if isinstance(ellipses, QuarterEllipses) else guesses(problem, robust=True)
    plain = problem.least_squares(start if wide else guesses(problem, robust=False))
    if float(np.max(np.abs(plain.residual))) <= problem.rounding():
        return plain, plain  # every point is on the boundary
    resistant = problem.huber(start)
    return (resistant if robust else plain), resistant


def _idle(problem: FitProblem, solved: Solved) -> tuple[str, ...]:
    """Return the parameters that influence no residual at the solution."""
    influence = np.linalg.norm(solved.slope, axis=0) * problem.coordinates.stretch(solved.theta)
    idle = influence <= _UNFELT * influence.max(initial=0.0)
    if idle.all():
        raise InputError(
            f"no point depends on {', '.join(_names(problem))}", where=problem.points.where, remedy="measure in other directions"
        )
    return tuple(n for n, still in zip(_names(problem), idle, strict=True) if still)


def _check_settled(problem: FitProblem, solved: Solved) -> None:
    columns = solved.slope * problem.coordinates.stretch(solved.theta)
    _, sizes, axes = np.linalg.svd(columns / np.linalg.norm(columns, axis=0), full_matrices=False)
    if not np.all(np.isfinite(solved.theta)) or sizes[-1] <= _SINGULAR * sizes[0]:
        mixed = [n for n, share in zip(_names(problem), np.abs(axes[-1]), strict=True) if share > 0.01]
        what = f"the points determine only a combination of {' and '.join(mixed)}"
        raise InputError(what, where=problem.points.where, remedy="add points in other directions, or fix one with --set NAME=VALUE")


def _check_at_rest(problem: FitProblem, solved: Solved, robust: bool) -> None:
    """Return whether one more step would move no parameter by much of its standard error or of its value, unless its domain stops it."""
    size = HUBER * solved.level
    pull = np.clip(solved.residual, -size, size) if robust else solved.residual
    free = np.array([not end for end in _ends(problem, solved)])
    columns = (solved.slope * problem.coordinates.stretch(solved.theta))[:, free]
    if not columns.size:
        return
    step = np.abs(np.linalg.lstsq(columns, pull, rcond=None)[0])
    inverse = np.linalg.inv(np.linalg.qr(columns, mode="r"))
    error = np.linalg.norm(inverse, axis=1) * float(np.sqrt(np.mean(np.square(pull))))
    if np.any(moving := step > _SHARE * error + _NEAR):
        names = ", ".join(np.array(_names(problem))[free][moving])
        what = f"the fit of {names} has not converged"
        raise DuhemError(what, where=problem.points.where, remedy="check the points, try --robust, or fix a parameter with --set")


def _ends(problem: FitProblem, solved: Solved) -> list[str]:
    """Return on which end of its domain each fitted parameter lies, if it lies on one."""
    low, high = problem.coordinates.bounds
    x = problem.coordinates.inward(solved.theta)
    flags = zip(x <= low + _NEAR, x >= high - _NEAR, strict=True)
    return ["least" if below else "greatest" if above else "" for below, above in flags]


def _draws(problem: FitProblem, solved: Solved, corner: float | None, draws: int, seed: int) -> Array:
    if not draws or (not problem.points.absolute and len(problem.points) <= len(solved.theta)):
        return np.empty((0, len(solved.theta)))
    return bootstrapped(problem, solved, corner, draws, seed)


def _intervals(problem: FitProblem, solved: Solved, spread: Array, draws: Array) -> list[tuple[float, float] | None]:
    if len(draws):
        low, high = np.quantile(draws, _TAILS, axis=0)
        return list(zip(low.tolist(), high.tolist(), strict=True))
    m, p = solved.slope.shape
    wide = stats.norm.ppf(_TAILS[1]) if problem.points.absolute else stats.t.ppf(_TAILS[1], m - p) if m > p else np.nan
    c = problem.coordinates
    x, reach = c.inward(solved.theta), wide * np.sqrt(np.diag(spread)) / c.stretch(solved.theta)
    low, high = (np.clip(c.outward(x + sign * reach), *map(c.outward, c.bounds)) for sign in (-1, 1))
    return [(a, b) if np.isfinite(a) and np.isfinite(b) else None for a, b in zip(low.tolist(), high.tolist(), strict=True)]


def _estimate(name: str, value: str, variance: float, interval: tuple[float, float] | None, end: str) -> Estimate:
    error = float(np.sqrt(variance))
    remark = (
        f"on the {end} value of its domain; a better fit may exist beyond it; the error and the interval do not include this" if end else ""
    )
    return Estimate(name, "fitted", float(value), error if np.isfinite(error) else None, interval, remark)


def _not_fitted(family: Criterion, name: str, unfelt: Mapping[str, str]) -> Estimate:
    domain = family.parameters[name]
    if name in unfelt:
        return Estimate(name, "open", None, remark=f"not identifiable: {unfelt[name]}; left open, {domain.describe()}")
    assert domain.value is not None
    return Estimate(name, "given", float(domain.value), remark="given")


# -- the law ---------------------------------------------------------------------------------------------------------


def _decimal(value: float, domain: Domain) -> str:
    """Return the shortest decimal of ``value``, or the end of its domain if the value lies beyond it or differs from it by rounding."""
    low, high = (None if end is None else float(end) for end in (domain.low, domain.high))
    if high is not None and value >= high - _SNAP * abs(high):
        return repr(high)
    return repr(low if low is not None and not domain.positive and value <= low + _SNAP * abs(low) else float(value))


def _fixed(family: Criterion, values: Mapping[str, str], points: Points) -> Criterion:
    fitted = family.fix(values)
    try:
        check_domain(fitted)
    except InputError as fault:
        shown = ", ".join(f"{n} = {float(v):.6g}" for n, v in values.items())
        what = f"the best fit, {shown}, lies outside the domain of the law: {fault.what}"
        raise InputError(what, where=points.where, remedy="take another law") from None
    return fitted


def _exponents(law: Criterion) -> set[str]:
    """Return the free parameters in exponents.  Exact arithmetic on powers of long decimals to long decimals does not end."""
    inside = set().union(*(power.exp.free_symbols for power in law.g.atoms(sp.Pow)))
    return {symbol.name for symbol in inside} & set(free_parameters(law))


def _short(family: Criterion, problem: FitProblem, solved: Solved, corner: float | None, exponents: set[str]) -> dict[str, str]:
    """Return the values with exponents rounded to three decimals, and the other parameters fitted again and rounded to six digits."""
    theta = dict(zip(_names(problem), solved.theta.tolist(), strict=True))
    short = {n: f"{theta[n]:.3f}" for n in exponents}
    rest = _problem(family.fix(short), problem.points)
    refitted = rest.minimised(np.array([theta[n] for n in _names(rest)]), corner)
    return short | {n: f"{x:.6g}" for n, x in zip(_names(rest), refitted.tolist(), strict=True)}


def _proved(law: Criterion, convex: str) -> Verification:
    done = verify(law, claims=CLAIMS)
    for result in done.results:
        if result.verdict is Verdict.REFUTED and not (convex == "assume" and result.claim in _OF_CONVEXITY):
            what = f"the best fit of {law.name} is not admissible: {result.claim} is refuted, {result.detail}"
            raise InputError(what, where="law", remedy="choose another law, or a criterion file with narrower domains of the parameters")
    if convex == "require" and done["convexity"].verdict is not Verdict.PROVED:
        what = f"the best fit of {law.name} is not proved convex: convexity is {done['convexity'].verdict}"
        raise InputError(what, where="convex", remedy='choose another law, or convex="ask"')
    return done
