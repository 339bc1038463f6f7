"""The reference method: the closest-point step as a cone program, for any law that is DCP, in any number of forces.

    minimise (sigma_tr - sigma) . k^-1 (sigma_tr - sigma)/2   subject to   g(sigma, sigma_n) <= 0

is posed in y = L^-1 sigma/R with k = kappa L L^T and R the size of K towards the trial stress, one R a point:

    minimise theta |y|^2/2 - u . y   subject to   gamma h(L y, q) <= 0,   L^-1 sigma_tr = R u/theta,  |u| = 1

so that all numbers are O(1) in any unit and at any distance of the trial (h, q: :mod:`duhem.projection.scaled_formula`).
The multiplier lambda is the dual value of the constraint, taken back to the law's own units.
The problem is compiled once for a law and a stiffness, and solved for one block of points after the other by changing its
parameters (DPP; Agrawal et al. 2019, "Differentiable convex optimization layers"); the last few are kept.  It is slow and
made to be trusted: nothing here is the inner loop of anything, and its answers count only after their residuals are
recomputed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from functools import lru_cache, partial
from threading import get_ident
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.cvxpy_ import dcp_fault, expression
from duhem.expression.jets import program
from duhem.expression.number import exact_number
from duhem.projection import conic_solvers
from duhem.projection.conic_solvers import Rungs
from duhem.projection.extended_precision import put_right
from duhem.projection.increment import Increment, too_far_apart
from duhem.projection.method import Method, Options
from duhem.projection.residuals import Judge, residuals
from duhem.projection.result import Array, Residuals, Solution
from duhem.projection.scaled_formula import ScaledFormula, scaled
from duhem.projection.whitened_body import shrunk

__all__ = ["CVXPY", "CvxpyOptions", "applies", "solve"]

Indices = NDArray[np.intp]

_POOR = 3e-8  # a residual
_AGAIN = 2  # tolerances, each a tenth as tight, that a poor answer is looked for with
_KEPT = 64  # blocks of a problem

_ELSEWHERE = "or take method='newton', which needs only a smooth g and a convex K"


@dataclass(frozen=True)
class CvxpyOptions(Options):
    """``solver``: any cone solver CVXPY finds installed.  ``tolerance``: its stopping tolerance on the O(1) problem, by
    default the tightest it meets, and others where the residuals are poor.  ``batch``: points stacked into one problem,
    several times faster a point; where a block misses the tightest tolerance, its points are solved one by one.
    ``warm_start``: start from the last answer.  Raises InputError for a batch that is no count.
    """

    solver: str = "CLARABEL"
    tolerance: float | None = None
    batch: int = 32
    warm_start: bool = False

    def __post_init__(self) -> None:
        if isinstance(self.batch, bool) or not isinstance(self.batch, (int, np.integer)) or self.batch < 1:
            raise InputError(f"batch {self.batch!r} is not a count of points", where="batch", remedy="give a whole number >= 1")


_DEFAULTS = CvxpyOptions()


def applies(increment: Increment) -> str | None:
    """None if the cone program can be posed, else the part of the formula that the DCP rules reject, and what to do."""
    if not increment.law.associated:
        return f"{increment.law.name} has its own flow direction, but this method needs a slip normal to K; remove the flow"
    if far := too_far_apart(increment.stiffness):
        return far
    fault = _fault(increment, increment.g)
    if fault is None or all(_fault(increment, g) is None for g, _ in _by_pressure(increment)):
        return None
    return f"{fault}; {_ELSEWHERE}"


def solve(increment: Increment, options: CvxpyOptions = _DEFAULTS) -> Solution:
    """The increments' stress (Pa), slip k^-1 (sigma_tr - sigma) (m for k in Pa/m) and multiplier lambda, as the solver left them.

    Where no tolerance is asked for, slips that it lost are put right, and poor answers give way to better ones.
    A trial with g <= 0 is its own projection, without a solver.  ``failed`` marks the points without an answer (nan):
    K empty, no multiplier (dg/dsigma = 0 on all of K, as for some laws at sigma_n = 0), or beyond double precision.
    Raises InputError for a law that is not DCP, an unknown solver, one that lacks a cone the law needs, a bad option.
    """
    if reason := applies(increment):
        raise InputError(reason, where=increment.law.name)
    solver = conic_solvers.checked(options.solver)
    run, rungs = partial(conic_solvers.ran, warm_start=options.warm_start), conic_solvers.rungs(solver, options.tolerance)
    count = len(increment.trial)
    stress, multiplier = increment.trial.copy(), np.zeros(count)
    bare = _at_a_point(increment)
    for g, chosen in _groups(increment, np.setdiff1d(np.arange(count), bare)):
        slipping = _Slipping.of(increment, g, chosen)
        stress[slipping.outside], multiplier[slipping.outside] = slipping.answers(run, rungs, int(options.batch), solver)
    if bare.size:
        found = shrunk(increment, bare, partial(solve, options=options))
        stress[bare], multiplier[bare] = np.where(found.failed[:, None], np.nan, found.stress), found.multiplier
    slip = np.asarray(np.linalg.solve(increment.stiffness, (increment.trial - stress).T).T, dtype=np.float64)
    failed = np.logical_not(np.all(np.isfinite(np.column_stack([stress, slip, multiplier])), axis=1))
    solution = Solution(stress, slip, multiplier, np.atleast_1d(failed))
    return solution if options.tolerance is not None else _bettered(increment, solution, replace(options, solver=solver))


def _bettered(increment: Increment, solution: Solution, options: CvxpyOptions) -> Solution:
    """Lost slips put right, and then better answers for poor ones: where a solver stalls is a matter of luck.

    By tolerances nearly as tight: the answers of looser ones are off by the square root of their gap.
    """
    judged, found = partial(residuals, convex=True), Residuals(*(np.zeros(len(solution.multiplier)) for _ in fields(Residuals)))
    _, seen = Judge.of(increment, solution, convex=True).look(solution, found)
    solution, found = put_right(increment, solution, found, judged, seen)
    worst = found.worst()
    for tolerance in conic_solvers.tolerances(options.solver)[1 : 1 + _AGAIN]:
        at = np.flatnonzero(~solution.failed & (worst > _POOR))
        if not at.size:
            break
        asked = increment.of(at)
        other = solve(asked, replace(options, tolerance=tolerance, batch=1))
        left = judged(asked, other).worst()
        better = np.flatnonzero(left < worst[at])
        worst[at[better]] = left[better]
        solution.put(at[better], other.of(better))
    return solution


def _cp() -> Any:
    import cvxpy as cp

    return cp


# -- which formula for which points ------------------------------------------------------------------------------------


def _fault(increment: Increment, g: sp.Expr) -> str | None:
    return _dcp_fault(g, increment.law.force_symbols(), increment.pressure_symbol)


@lru_cache(maxsize=256)
def _dcp_fault(g: sp.Expr, forces: tuple[sp.Symbol, ...], pressure: sp.Symbol | None) -> str | None:
    cp = _cp()
    known: dict[sp.Symbol, Any] = {f: cp.Variable() for f in forces}
    if pressure is not None:
        known[pressure] = cp.Parameter(nonpos=True)
    return dcp_fault(g, known)


def _at_a_point(increment: Increment) -> Indices:
    """The trials outside a K that has shrunk for want of pressure: a cone program without inner points has no central path."""
    pressure = increment.pressure_symbol
    if pressure is None:
        return np.zeros(0, dtype=np.intp)
    at = np.flatnonzero(increment.pressure == 0.0)
    level = program(increment.g, (*increment.law.force_symbols(), pressure))
    zero = np.zeros(at.size)
    tip = ~(level(*(np.zeros((len(increment.law.forces), at.size))), zero) < 0.0)
    return at[tip & ~(level(*increment.trial[at].T, zero) <= 0.0)]


def _groups(increment: Increment, left: Indices) -> Iterator[tuple[sp.Expr, Indices]]:
    """One formula for all points, or one a pressure where only a known pressure makes it DCP (``where`` on the pressure)."""
    if _fault(increment, increment.g) is None:
        yield increment.g, left
    else:
        for g, chosen in _by_pressure(increment):
            yield g, np.intersect1d(chosen, left)


def _by_pressure(increment: Increment) -> Iterator[tuple[sp.Expr, Indices]]:
    symbol = increment.pressure_symbol
    for value in np.unique(increment.pressure):
        yield increment.g.xreplace({symbol: exact_number(float(value))}), np.flatnonzero(increment.pressure == value)


# -- the scaled problem ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Slipping:
    """The points of one formula whose trial lies outside K, in scaled units."""

    g: sp.Expr
    forces: tuple[sp.Symbol, ...]
    pressure: sp.Symbol | None
    formula: ScaledFormula
    factor: Array  # L (d, d), k = kappa L L^T
    kappa: float
    outside: Indices
    direction: Array  # u (n, d)
    distance: Array  # |L^-1 sigma_tr| (n,)
    size: Array  # R (n,), powers of two
    data: dict[sp.Symbol, Array]
    slope: float  # 1/gamma, a power of two

    @classmethod
    def of(cls, increment: Increment, g: sp.Expr, chosen: Indices) -> _Slipping:
        forces, pressure = increment.law.force_symbols(), increment.pressure_symbol
        symbols = (*forces, *([] if pressure is None else [pressure]))
        level = program(g, symbols)

        def at(stress: Array, where: Indices) -> Array:
            return level(*stress.T, *([] if pressure is None else [increment.pressure[where]]))

        outside = chosen[~(at(increment.trial[chosen], chosen) <= 0)]
        trial = increment.trial[outside]
        kappa = _power_of_two(np.max(np.diag(increment.stiffness)))
        factor = np.linalg.cholesky(increment.stiffness / kappa)
        unit = _power_of_two(np.max(np.abs(trial), axis=1, initial=0.0))  # keeps squares from overflowing
        whitened = np.linalg.solve(factor, (trial / unit[:, None]).T).T
        length = np.sqrt(np.sum(whitened**2, axis=1))
        length[length == 0] = 1.0  # a trial at the origin, and the origin outside K: any unit will do
        direction, distance = whitened / length[:, None], length * unit
        size = _size(lambda r: at(r[:, None] * (direction @ factor.T), outside), distance)
        formula = scaled(g, forces, pressure)
        data = formula.values(increment.pressure[outside], size)
        h = program(formula.expr, (*forces, *data))
        rise = h(*(2 * direction @ factor.T).T, *data.values()) - h(*(direction @ factor.T).T, *data.values())
        steep = rise[np.isfinite(rise) & (rise > 0)]
        slope = float(_power_of_two(np.median(steep))) if steep.size else 1.0
        return cls(g, forces, pressure, formula, factor, float(kappa), outside, direction, distance, size, data, slope)

    def _posed(self, width: int, solver: str) -> _Posed:
        factor = tuple(tuple(row) for row in self.factor.tolist())
        return _posed(self.g, self.forces, self.pressure, factor, self.slope, width, solver, get_ident())

    def answers(self, run: Callable[..., bool], rungs: Rungs, batch: int, solver: str) -> tuple[Array, Array]:
        """Stress (n, d) and multiplier (n,), nan where the solver has no answer."""
        count, dimension = self.direction.shape
        y, dual = np.full((count, dimension), np.nan), np.full(count, np.nan)
        sound = np.flatnonzero(np.all([np.isfinite(v) for v in [self.size, self.distance, *self.data.values()]], axis=0))
        blocks = [sound[i : i + batch] for i in range(0, len(sound), batch)]
        for width, tries in ((min(batch, len(sound)), rungs[:1]), (1, rungs)):
            if not blocks:
                break
            posed, left = self._posed(width, solver), []
            for block in blocks:
                answer = posed.answer(self, block, partial(run, tries=tries))
                if answer is None:
                    left += [block[i : i + 1] for i in range(len(block))]
                else:
                    y[block], dual[block] = answer
            blocks = left
        with np.errstate(all="ignore"):
            stress = self.size[:, None] * (y @ self.factor.T)
            multiplier = dual / self.slope * (self.distance / self.kappa) * self.size ** (1.0 - self.formula.degree)
        return stress, multiplier


def _power_of_two(x: Any) -> Any:
    """The power of two just above |x| (1 for 0), so that scaling by it is exact."""
    return np.ldexp(1.0, np.where(np.asarray(x) == 0, 0, np.clip(np.frexp(x)[1], -1000, 1000)))


def _size(along: Any, distance: Array) -> Array:
    """The power of two R with along(R) <= 0 < along(2 R), by bisection on its exponent; that below ``distance`` where there is none."""
    high = np.clip(np.frexp(distance)[1], -1000, 1000)
    low = np.full_like(high, -1010)
    start = low.copy()
    top = high - 1
    while np.any(high - low > 1):
        middle = (low + high) // 2
        inside = along(np.ldexp(1.0, middle)) <= 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.ldexp(1.0, np.where(low == start, top, low))


@dataclass(frozen=True)
class _Posed:
    """The compiled problem of a block of points, and the parameters that make it theirs."""

    problem: Any
    y: Any
    constraint: Any
    curvature: Any  # theta, repeated over the components
    pull: Any  # u
    data: dict[sp.Symbol, Any]
    width: int
    solver: str
    compiled: dict[bytes, Any]  # for the last blocks: where an answer is poor they come again, with other tolerances

    def answer(self, slipping: _Slipping, block: Indices, run: Callable[[Any, Any], bool]) -> tuple[Array, Array] | None:
        """y and the dual value at the points of the block, or None where the solver gives up."""
        points = np.resize(block, self.width)  # a last short block is filled up with points it already has
        theta = slipping.size[points] / slipping.distance[points]
        self.curvature.value = np.broadcast_to(theta[:, None], self.y.shape)
        self.pull.value = slipping.direction[points]
        for q, parameter in self.data.items():
            parameter.value = slipping.data[q][points]
        if not run(self.problem, self._given()):
            return None
        return self.y.value[: len(block)], self.constraint.dual_value[: len(block)]

    def _given(self) -> Any:
        key = b"".join(parameter.value.tobytes() for parameter in (self.curvature, self.pull, *self.data.values()))
        if key not in self.compiled:
            if len(self.compiled) == _KEPT:
                del self.compiled[next(iter(self.compiled))]
            self.compiled[key] = conic_solvers.compiled(self.problem, self.solver)
        return self.compiled[key]


@lru_cache(maxsize=16)
def _posed(
    g: sp.Expr,
    forces: tuple[sp.Symbol, ...],
    pressure: sp.Symbol | None,
    factor: tuple[tuple[float, ...], ...],
    slope: float,
    width: int,
    solver: str,
    thread: int,
) -> _Posed:
    """The problem of ``width`` points, without their numbers; a problem compiled for a solver stays so, in its own thread."""
    cp = _cp()
    formula = scaled(g, forces, pressure)
    y = cp.Variable((width, len(forces)))
    curvature, pull = cp.Parameter((width, len(forces)), nonneg=True), cp.Parameter((width, len(forces)))
    data = {q: cp.Parameter(width, **_sign(q)) for q in formula.data}
    stress = {f: sum(c * y[:, j] for j, c in enumerate(row) if c) for f, row in zip(forces, factor, strict=True)}
    constraint = expression(formula.expr, {**stress, **data}) / slope <= 0
    objective = cp.sum(cp.multiply(curvature, cp.square(y))) / 2 - cp.sum(cp.multiply(pull, y))
    return _Posed(cp.Problem(cp.Minimize(objective), [constraint]), y, constraint, curvature, pull, data, width, solver, {})


def _sign(symbol: sp.Symbol) -> dict[str, bool]:
    return {"nonneg": True} if symbol.is_nonnegative else {"nonpos": True} if symbol.is_nonpositive else {}


CVXPY = Method("cvxpy", applies, solve, CvxpyOptions, convex=True)
