"""A failing case made small: the least of those that are met while Hypothesis shrinks it, then in round numbers.

What the failure does not need is put to nothing, and the rest is rounded as far as the failure stays.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import count, takewhile
from math import floor, inf, isfinite, log10
from random import Random
from time import monotonic
from typing import Any

import numpy as np
from hypothesis import find, settings
from hypothesis.errors import Flaky, NoSuchExample

from duhem.projection.result import Array
from duhem.testing.checks.query import Raised
from duhem.testing.checks.registry import Check
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.values import Strategy, scaled
from duhem.testing.failures.failure import Failure
from duhem.testing.routines.routine import Unfinished

__all__ = ["RAISED", "least_case", "shortened", "simplified"]

_TRIES = 200  # to make a case round
_STRESSES = ("trial", "other", "third", "inside", "beside", "path")
RAISED = 60  # calls that raise while a case is made smaller, at most: each may have cost a process

Failing = Callable[[Case, Sequence[Check]], Failure | None]  # the first of some checks that fails on a case


class _Enough(BaseException):
    """Shrinking has had its tries, or the routine does not come back.  No Exception, which Hypothesis would take for one more failure."""


def least_case(
    failing: Failing,
    checks: Sequence[Check],
    drawn: Strategy,
    profile: settings,
    *,
    seed: int,
    tries: int,
    seconds: float | None,
    raised: Raised,
) -> tuple[Case, Failure] | None:
    """The least of the drawn cases that were met on which one of ``checks`` fails, and the first failure; None where none fails.

    From the first failure on only its check counts; so many ``tries``, and ``seconds``, are left then to find a smaller case.
    """
    met: list[Failure] = []
    tried, until, most = count(), inf, 0

    def fails(case: Case) -> bool:
        nonlocal until, most
        if met and (next(tried) == tries or monotonic() > until or raised.times > most):
            raise _Enough
        try:
            found = failing(case, (met[0].check,) if met else checks)
        except Unfinished as fault:
            raise _Enough(fault) from None
        if found is None:
            return False
        if not met:
            until, most = inf if seconds is None else monotonic() + seconds, raised.times + RAISED
        met.append(found)
        return True

    try:
        with suppress(NoSuchExample, Flaky):  # flaky: the routine has a memory, and the case that failed first is told
            find(drawn, fails, settings=profile, random=Random(seed))
    except _Enough as end:
        if end.args:
            raise end.args[0] from None
    return (met[-1].case, met[0]) if met else None


def simplified(
    case: Case,
    fails: Callable[[Case], bool],
    admitted: Callable[[Mapping[str, float]], bool],
    *,
    free: tuple[str, ...] = (),
    stiffness: bool = True,
    pressure: Callable[[float], bool] | None = lambda p: p <= 0.0,
) -> Case:
    """A case of one increment on which it still ``fails``, of rounder numbers, and of fewer that are not zero.

    What is left as it is: parameters but those that are ``free``, whose values have to be ``admitted``; the stiffness unless
    ``stiffness``; the pressure unless it may take the value that ``pressure`` is asked for.
    """
    shorter = _Shorter(case, fails)
    shorter.whole()
    if pressure is not None and case.pressure is not None:
        shorter.pressed(pressure)
    if stiffness:
        shorter.stiff()
    for name in free:
        shorter.parameter(name, admitted)
    for name in _STRESSES:
        shorter.numbers(name)
    return shorter.case


def shortened(case: Case, fails: Callable[[Case], bool], tries: int) -> Case:
    """A history of one increment on which it still ``fails``, with a shorter path, or none, and rounder stresses, in so many ``tries``."""
    shorter = _Shorter(case, fails, tries)
    shorter.whole(case.factor)  # which is the duration of a leg
    for name in ("trial", "path"):
        shorter.numbers(name)
    return shorter.case


class _Shorter:
    """The shortest case so far; ``left`` counts the tries that remain."""

    def __init__(self, case: Case, fails: Callable[[Case], bool], tries: int = _TRIES) -> None:
        self.case, self.fails, self.left = case, fails, tries

    def put(self, **changes: Any) -> bool:
        """Return whether the case still fails with ``changes``; they stay where it does."""
        if self.left == 0:
            return False
        self.left -= 1
        other = replace(self.case, **changes)
        if not self.fails(other):
            return False
        self.case = other
        return True

    def first(self, changes: Iterable[Mapping[str, Any]]) -> bool:
        """Try changes one after the other until the case still fails with one; return whether there was one."""
        return any(self.put(**each) for each in changes)

    def whole(self, factor: float = 2.0) -> None:
        """Put to nothing the parts that the failure does not look at."""
        case = self.case
        zero = np.zeros_like(case.trial)
        loads = None if case.pressure is None else np.repeat(case.pressure[:, None], 2, axis=1)
        if self.put(**{name: zero for name in _STRESSES[1:5]}, path=np.repeat(zero[:, None], 2, axis=1), loads=loads, factor=factor):
            return
        own, knots = case.loads, range(2, case.path.shape[1])
        self.first({"path": case.path[:, :n], "loads": None if own is None else own[:, :n]} for n in knots)
        for name in _STRESSES[1:5]:
            self.put(**{name: zero})

    def pressed(self, may: Callable[[float], bool]) -> None:
        """Put the pressure to -1 Pa, with all stresses in proportion or as they are, or else to a round number."""
        assert self.case.pressure is not None
        p = float(self.case.pressure[0])
        if may(-1.0) and p < 0.0:
            stresses = {name: getattr(self.case, name) / -p for name in _STRESSES}
            loads = None if self.case.loads is None else self.case.loads / -p
            if p == -1.0 or self.put(**stresses, pressure=[-1.0], loads=loads) or self.put(pressure=[-1.0]):
                p = -1.0
        self.first({"pressure": [other]} for other in _rounder(p) if may(other))
        if self.case.loads is not None and self.case.pressure is not None:
            self.put(loads=np.full_like(self.case.loads, self.case.pressure[0]))

    def stiff(self) -> None:
        k = self.case.stiffness
        self.first({"stiffness": other} for other in (np.eye(len(k)), np.diag(np.diag(k))) if not np.array_equal(other, k))
        for i, j in zip(*np.triu_indices(len(k)), strict=True):
            for x in _rounder(float(self.case.stiffness[i, j])):
                other = self.case.stiffness.copy()
                other[i, j] = other[j, i] = x
                if (np.linalg.eigvalsh(other / np.abs(other).max()) > 1e-12).all() and self.put(stiffness=other):
                    break

    def parameter(self, name: str, admitted: Callable[[Mapping[str, float]], bool]) -> None:
        now = self.case.parameters[name]
        simpler = takewhile(lambda x: now not in (1.0, x), (1.0, 0.5, *_rounder(now)))
        values = ({**self.case.parameters, name: x} for x in simpler)
        self.first({"parameters": each} for each in values if admitted(each))

    def numbers(self, name: str) -> None:
        """Round each number of a part by itself; equal ones are changed together, so that they stay equal."""
        given: Array = getattr(self.case, name)
        for x in np.unique(given[given != 0.0]).tolist():
            now: Array = getattr(self.case, name)
            self.first({name: np.where(now == x, other, now)} for other in (0.0, *_rounder(x)))


def _rounder(x: float) -> Iterator[float]:
    """Yield numbers near ``x`` of one digit and of two, and the next of two towards zero; none where ``x`` has no more itself."""
    if not isfinite(x) or float(f"{x:.1e}") == x:
        return
    yield float(f"{x:.0e}")
    yield float(f"{x:.1e}")
    power = floor(log10(abs(x))) - 1
    yield float(np.copysign(scaled(float(floor(abs(x) / 10.0**power)), power), x))
