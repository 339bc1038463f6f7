"""The closest-point step for any associated law: checked, solved by the cheapest method that applies, and judged.

On a K that is not known to be convex only a point of K that is nearer to the trial stress speaks against an answer, and is looked for.
For all tau of any K the closest point sigma makes, in the metric of the increment,

    (sigma_tr - sigma) . k^-1 (tau - sigma) - |tau - sigma|^2/2 = (|sigma_tr - sigma|^2 - |sigma_tr - tau|^2)/2 <= 0.

It is tried on points of K on some hundred rays, beside the answer, and then on the sphere about the trial that passes just
within the answer: from each point on the rays that is nearer than those around it, g is brought down along that sphere, and
where it falls below zero K comes nearer.  That nothing is found shows nothing: the answer is stationary.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.expression.vocabulary import EigMax, symbol
from duhem.law.catalogue import load_formula
from duhem.law.formula_law import Criterion
from duhem.projection.extended_precision import put_right
from duhem.projection.in_blocks import BLOCK, FEW, FEW_SEARCHED, in_blocks
from duhem.projection.increment import ROUNDING, Increment, Metric, beyond, posed, setting, stiffness_matrix
from duhem.projection.method import Compiling, Method, Options
from duhem.projection.methods import METHODS
from duhem.projection.residuals import Judge, Told, residuals
from duhem.projection.result import ACCURACY, Array, Judged, Projection, Residuals, Solution, Status
from duhem.projection.row_by_row import any_of, dot, length, products, times, unit, widest
from duhem.projection.scaled_formula import Level, level_of, power_of_two
from duhem.projection.variational_samples import looks, points_seen, tangents

__all__ = ["ACCURACY", "Projector", "principal"]

_REFUSED, _MOVED = (Status.INACCURATE, Status.FAILED), (Status.SLIP, Status.STATIONARY)


@dataclass(frozen=True)
class Projector:
    """:func:`duhem.project` for one law, stiffness and set of parameters, checked once; ``why`` the method was taken.

    Call it with ``trial``, ``pressure``, ``tangent`` and the method's options, as often as there are steps.  It asks nobody
    whether K is convex: where that is not ``setting.convexity``, a stationary point counts as the closest one unless a known point
    of K lies beyond the plane through it across the slip (:class:`duhem.projection.result.Projection`).
    """

    setting: Increment
    method: Method[Any]
    why: str

    @classmethod
    def of(
        cls,
        law: Criterion | str | Path,
        stiffness: ArrayLike = 1.0,
        parameters: Mapping[str, Any] | None = None,
        method: str | Method[Any] = "auto",
    ) -> Projector:
        """What :func:`duhem.project` checks and chooses before it sees a stress; arguments, units and errors are the same."""
        question = setting(load_formula(law), stiffness, parameters)
        return cls(question, *cls.chosen(question, method))

    @staticmethod
    def chosen(question: Increment, method: str | Method[Any]) -> tuple[Method[Any], str]:
        """The method and why it is taken; InputError where none applies."""
        if method != "auto":
            asked = method if isinstance(method, Method) else _named(method)
            reason = asked.applies(question)
            if reason is not None:
                raise InputError(f"method {asked.name} does not apply: {reason}", where="method")
            return asked, "you selected it"
        reasons: list[str] = []
        for name, imported in METHODS.items():
            reason = imported().applies(question)
            if reason is None:
                return imported(), "; ".join([*reasons, "the cheapest method that applies"])
            reasons.append(f"not {name}: {reason}")
        raise InputError(f"no method applies: {'; '.join(reasons)}", where="method", remedy="rewrite the law so that one of them applies")

    def __call__(self, trial: ArrayLike, pressure: ArrayLike | None = None, tangent: bool = False, **options: Any) -> Projection:
        return self.at(posed(self.setting, trial, pressure), tangent, **options)

    def at(self, question: Increment, tangent: bool = False, **options: Any) -> Projection:
        """The same for points that are checked already: ``setting`` with ``trial`` (N, d) and ``pressure`` (N,) of finite numbers."""
        method = self.method
        if tangent and method.tangent is None:
            remedy = "use tangent=False, or a law with a closed form"
            raise InputError(f"method {method.name} has no tangent", where="tangent", remedy=remedy)
        given = method.options_of(options)
        if isinstance(given, Compiling):
            given = given.decided(len(question.pressure))
        found = self._answers(question, given)
        solution = found.solution
        slopes = method.tangent(question, solution) if tangent and method.tangent else (None, None)
        return Projection(
            stress=solution.stress,
            slip=solution.slip,
            multiplier=solution.multiplier,
            dissipation=found.dissipation,
            status=found.status,
            method=method.name,
            why=self.why,
            residuals=found.residuals,
            forces=question.law.forces,
            tangent=slopes[0],
            tangent_pressure=slopes[1],
            compiled=isinstance(given, Compiling) and bool(given.compiled),
        )

    def _answers(self, question: Increment, given: Options) -> Judged:
        """Those of an isotropic law are found in its principal stresses, and in all six where the trial sticks or digits would be lost."""
        if not (isinstance(given, Compiling) and self.method.has_its_own_solve) or (reduced := principal(question)) is None:
            return self._direct(question, given)
        found = self._direct(reduced.increment, given)
        solution, sure = reduced.back(found.solution)
        found = replace(found, solution=solution)
        if (rest := np.flatnonzero(~(sure & np.isin(found.status, _MOVED)))).size:
            found.put(rest, self._direct(question.of(rest), replace(given, compiled=False)))
        return found

    def _direct(self, question: Increment, given: Options) -> Judged:
        solution, vouched = self.method.solve(question, given), self._vouched(question)
        judge, sure = Judge.of(question, solution, self._taken_as_convex(question)), bool(vouched.all())
        told = _told(question, solution, judge, given) if sure else Told.nothing(len(vouched))
        threads = given.sharing if isinstance(given, Compiling) else 1
        found, settle = told.residuals, partial(_settle, question, told, vouched)
        plainly = partial(_settle_plainly, question, told, vouched, solution) if sure else None
        closely, seen = judge.look(solution, found, told.left, threads, plainly)
        self._held(question, solution, found)
        left = closely if sure else np.arange(len(vouched))
        if left.size:
            solution, found = put_right(question, solution, found, self._judged, seen)
            in_blocks(left.size, BLOCK, lambda part: settle(solution, found, left[part]), threads)
        judged = Judged(solution, found, told.dissipation, told.status)
        if self.method.again is None:
            return judged
        worth = vouched | (len(vouched) <= FEW_SEARCHED)  # of many, where a stationary point is the closest one
        refused = (told.status == Status.FAILED) | (told.status == Status.INACCURATE) & worth
        if (at := np.flatnonzero(refused)).size:  # another way, where that passes
            another = self.method.again(given, len(vouched))
            others = replace(self, method=replace(self.method, solve=another, again=None))._answers(question.of(at), given)
            better = np.flatnonzero(~np.isin(others.status, _REFUSED))
            judged.put(at[better], others.of(better))
        return judged

    def _vouched(self, question: Increment) -> NDArray[np.bool_]:
        """Points (N,) at which a stationary point is the closest one, or nobody has asked whether it is."""
        silent = self.method.convex or question.convexity is None
        return np.ones(question.pressure.shape, dtype=np.bool_) if silent else question.shown_convex()

    def _taken_as_convex(self, question: Increment) -> bool:
        """Whether the judge looks at few points of K: where K is not shown to be convex :meth:`_held` does more."""
        return self.method.convex or question.convexity is not None

    def _judged(self, question: Increment, solution: Solution) -> Residuals:
        found = residuals(question, solution, self._taken_as_convex(question))
        self._held(question, solution, found)
        return found

    def _held(self, question: Increment, solution: Solution, found: Residuals) -> None:
        """Hold the answers that nobody vouches for against nearer points of K."""
        if (at := np.flatnonzero(~self._vouched(question))).size:
            found.variational[at] = nearness(question.of(at), solution.of(at))


def _named(name: object) -> Method[Any]:
    if not isinstance(name, str) or name not in METHODS:
        raise InputError(f"unknown method {name!r}", where="method", remedy=f"choose auto, {', '.join(METHODS)}")
    return METHODS[name]()


def _told(question: Increment, solution: Solution, judge: Judge, given: Options) -> Told:
    """What the judge's loop says of the points, one by one or compiled; nothing where arrays are to judge."""
    n = len(solution.multiplier)
    threads = given.threads if isinstance(given, Compiling) and given.compiled else 0
    if set(question.law.forces) & set(question.law.domain) or (n > FEW and threads == 0):
        return Told.nothing(n)
    from duhem.projection.compiled_judge import told, told_one_by_one

    return told_one_by_one(question, solution, judge) if n <= FEW else told(question, solution, judge, threads)


def _settle_plainly(question: Increment, told: Told, vouched: NDArray[np.bool_], solution: Solution, block: slice) -> None:
    """Dissipation and status of a block of points, of which those that are not plainly right are settled afterwards."""
    slip = solution.slip[block]
    with np.errstate(all="ignore"):
        told.dissipation[block] = dot(solution.stress[block], slip)
    told.status[block] = any_of(slip != 0.0) | (solution.multiplier[block] > 0.0)  # to stick is 0, to slip 1
    others = np.arange(block.start, block.stop) if question.law.domain else np.flatnonzero(solution.failed[block]) + block.start
    if others.size:
        told.status[others] = _status(question, solution, told.residuals, others, vouched[others])


def _settle(
    question: Increment, told: Told, vouched: NDArray[np.bool_], solution: Solution, found: Residuals, at: NDArray[np.intp]
) -> None:
    """Dissipation and status of points ``at``; ``vouched`` (N,) where to be stationary is to be closest."""
    with np.errstate(all="ignore"):
        told.dissipation[at] = dot(solution.stress[at], solution.slip[at])
        told.status[at] = _status(question, solution, found, at, vouched[at])


def _status(
    question: Increment, solution: Solution, found: Residuals, block: NDArray[np.intp], vouched: NDArray[np.bool_]
) -> NDArray[np.int8]:
    """What each point of a block counts as."""
    slips = (solution.multiplier[block] > 0.0) | (solution.slip[block] != 0.0).any(axis=1)
    finite = np.isfinite(solution.stress[block]).all(axis=1) & np.isfinite(solution.slip[block]).all(axis=1)
    finite &= np.isfinite(solution.multiplier[block]) | (found.stationarity[block] <= ACCURACY)  # beyond doubles, as it should be
    judged = np.where(slips, np.where(vouched, Status.SLIP, Status.STATIONARY), Status.STICK)
    if question.law.domain:
        judged = np.where(beyond(question.law, solution.stress[block], question.trial[block]), Status.OUTSIDE, judged)
    judged = np.where(found.of(block).worst() <= ACCURACY, judged, Status.INACCURATE)
    return np.where(solution.failed[block] | ~finite, Status.FAILED, judged).astype(np.int8)


# -- points of K that are nearer to the trial stress -------------------------------------------------------------------


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


# -- an increment in six stresses as one in three principal stresses ---------------------------------------------------
#
# Where the law and the stiffness are isotropic, the closest stress has the axes of the trial, and its principal stresses are closest to
# those of the trial in the K that they have (A. S. Lewis 1996, SIAM J. Optim. 6, 164-177).  There planes bound the K of Tresca and of Mohr
# and Coulomb, and edges where two principal stresses are equal are corners.

_ROWS, _COLUMNS = (0, 1, 2, 1, 0, 0), (0, 1, 2, 2, 2, 1)  # of the entries xx, yy, zz, yz, xz, xy
_MATRIX = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
_FAR_TRIAL = 1e3  # stresses: the axes of a trial farther off leave rounding of its size
_NEAR = 1e-6  # of the trial: a way to the boundary that is shorter has lost as many digits


@dataclass(frozen=True, eq=False)
class Principal:
    """The increments in principal stresses, the ``axes`` (N, 3, 3) of the trials, and the ``places`` of the entries among the forces."""

    increment: Increment
    axes: Array
    places: NDArray[np.intp]

    def back(self, found: Solution) -> tuple[Solution, NDArray[np.bool_]]:
        """The solution in six stresses, and where it has its digits (N,)."""
        stress, slip = np.empty((2, len(self.axes), 6))
        for into, own in ((stress, found.stress), (slip, found.slip)):
            into[:, self.places] = ((self.axes * own[:, None]) @ np.swapaxes(self.axes, 1, 2))[:, _ROWS, _COLUMNS]
        slip[:, self.places[3:]] *= 2.0  # a shear strain of engineers is twice the entry
        far = widest(self.increment.trial)
        away = widest(self.increment.trial - found.stress)
        return Solution(stress, slip, found.multiplier, found.failed), (away > _NEAR * far) & (far / _FAR_TRIAL < widest(found.stress))


def principal(question: Increment) -> Principal | None:
    """Those of a question; None where the law is not known to be isotropic, or the stiffness is not."""
    if (made := _reduced(question.law)) is None:
        return None
    law, known, places = made
    k = question.stiffness[np.ix_(places, places)]
    shear, bulk = 2.0 * k[3, 3], 2.0 * k[3, 3] + 3.0 * k[0, 1]  # the two eigenvalues
    isotropic = np.diag([shear] * 3 + [k[3, 3]] * 3)
    isotropic[:3, :3] += k[0, 1]
    if np.abs(isotropic - k).max() > ROUNDING * min(shear, bulk):
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        values, axes = np.linalg.eigh(question.trial[:, places[_MATRIX]])
    if not np.isfinite(values).all():
        return None
    stiffness, diagonal = stiffness_matrix(isotropic[:3, :3], law.forces)
    own = replace(question, law=law, g=question.g.xreplace(known), trial=values, stiffness=stiffness, diagonal=diagonal)
    return Principal(own, axes, places)


@lru_cache(maxsize=64)
def _reduced(law: Criterion) -> tuple[Criterion, dict[sp.Expr, sp.Expr], NDArray[np.intp]] | None:
    """The law in principal stresses, what takes the place of eigenvalues and entries in it, and where xx, yy, zz, yz, xz, xy stand.

    Of a law whose stresses stand in eigenvalues and in the trace alone, with ranges on none of them.
    """
    forces = law.force_symbols()
    entries = next((node.args for node in law.g.atoms(EigMax) if set(node.args) == set(forces)), None)
    names = "principal_1", "principal_2", "principal_3"
    if entries is None or law.domain or set(names) & set(law.symbols()):
        return None
    nodes, trace = (EigMax(*entries), EigMax(*(-x for x in entries))), sp.Dummy()
    rest = law.g.xreplace({**{node: sp.Dummy() for node in nodes}, entries[0]: trace - entries[1] - entries[2]})
    if rest.free_symbols & set(forces):
        return None
    s = [symbol(name) for name in names]
    known = {nodes[0]: sp.Max(*s), nodes[1]: sp.Max(*(-x for x in s)), **dict(zip(entries, s, strict=False))}
    made = Criterion(law.name, law.g.xreplace(known), law.parameters, names, law.pressure, law.constraints)
    return made, known, np.array([forces.index(x) for x in entries])
