"""The closest-point step for any associated law: checked, solved by the cheapest method that applies, and judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.law.catalogue import load_formula
from duhem.law.formula_law import Criterion
from duhem.projection.ball_newton import put_right
from duhem.projection.declared_ranges import beyond
from duhem.projection.in_blocks import BLOCK, FEW, FEW_SEARCHED, in_blocks
from duhem.projection.increment import Increment, posed, setting
from duhem.projection.method import Compiling, Method, Options
from duhem.projection.methods import METHODS
from duhem.projection.nearer_points import nearness
from duhem.projection.residuals import Judge, Told, residuals
from duhem.projection.result import ACCURACY, Projection, Residuals, Solution, Status
from duhem.projection.row_by_row import any_of, dot

__all__ = ["ACCURACY", "Projector"]

_REFUSED = Status.INACCURATE, Status.FAILED
_WORTH_COMPILING = 4_096  # points; fewer are judged sooner than their loop is loaded


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
        solution, vouched = method.solve(question, given), self._vouched(question)
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
        worth = vouched | (len(vouched) <= FEW_SEARCHED)  # of many, where a stationary point is the closest one
        refused = (told.status == Status.FAILED) | (told.status == Status.INACCURATE) & worth
        self._asked_again(question, given, solution, found, told, np.flatnonzero(refused))
        slopes = method.tangent(question, solution) if tangent and method.tangent else (None, None)
        return Projection(
            stress=solution.stress,
            slip=solution.slip,
            multiplier=solution.multiplier,
            dissipation=told.dissipation,
            status=told.status,
            method=method.name,
            why=self.why,
            residuals=found,
            forces=question.law.forces,
            tangent=slopes[0],
            tangent_pressure=slopes[1],
            compiled=isinstance(given, Compiling) and bool(given.compiled),
        )

    def _asked_again(
        self, question: Increment, given: Options, solution: Solution, found: Residuals, told: Told, at: NDArray[np.intp]
    ) -> None:
        """Put in the place of what the judge refuses what the method finds another way, where it has one and that passes."""
        if self.method.again is None or not at.size:
            return
        another = self.method.again(given, len(told.status))
        other = replace(self, method=replace(self.method, solve=another, again=None)).at(question.of(at))
        better = np.flatnonzero(~np.isin(other.status, _REFUSED))
        for mine, its in ((solution, other), (found, other.residuals), (told, other)):
            for field in fields(mine):
                if isinstance(into := getattr(mine, field.name), np.ndarray) and hasattr(its, field.name):
                    into[at[better]] = getattr(its, field.name)[better]
        solution.failed[at[better]] = False

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
    """What the judge's loop says of the points, compiled or one by one; of as many as are sooner judged by arrays, nothing."""
    n = len(solution.multiplier)
    if not set(question.law.forces) & set(question.law.domain):
        if isinstance(given, Compiling) and given.compiled and n >= _WORTH_COMPILING:
            from duhem.projection.compiled_judge import told

            return told(question, solution, judge, given.threads)
        if n <= FEW:
            from duhem.projection.compiled_judge import told_one_by_one

            return told_one_by_one(question, solution, judge)
    return Told.nothing(n)


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
