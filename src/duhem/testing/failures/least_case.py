"""A case on which a check fails, looked for among what is drawn, and the least of those that were met."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from random import Random
from time import monotonic

from hypothesis import find, settings
from hypothesis.errors import Flaky, NoSuchExample

from duhem.testing.checks.raised import Raised
from duhem.testing.checks.registry import Check
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.decades import Strategy
from duhem.testing.failures.report import Failure
from duhem.testing.routines.unfinished import Unfinished

__all__ = ["RAISED", "LeastCase"]

RAISED = 60  # calls that raise while a case is made smaller, at most: each may have cost a process

Failing = Callable[[Case, Sequence[Check]], Failure | None]  # the first of some checks that fails on a case


class _Enough(BaseException):
    """Shrinking has had its tries, or the routine does not come back.  No Exception, which Hypothesis would take for one more failure."""


class LeastCase:
    """One search for a case on which one of ``checks`` fails; so many ``tries``, and ``seconds``, are left to make it smaller."""

    def __init__(self, failing: Failing, checks: Sequence[Check], tries: int, seconds: float | None, raised: Raised) -> None:
        self.failing, self.checks, self.left, self.seconds, self.raised = failing, checks, tries, seconds, raised
        self.least: Case | None = None
        self.said = ""  # of the first that failed
        self.until, self.most = float("inf"), 0
        self.unfinished: Unfinished | None = None

    def fails(self, case: Case) -> bool:
        """Whether a check that is looked for fails on the case; from the first that does on, only that one counts."""
        try:
            return self._fails(case)
        except Unfinished as fault:
            self.unfinished = fault
            raise _Enough from None

    def _fails(self, case: Case) -> bool:
        if self.least is not None:
            if self.left == 0 or monotonic() > self.until or self.raised.times > self.most:
                raise _Enough
            self.left -= 1
        found = self.failing(case, self.checks)
        if found is None:
            return False
        if self.least is None:
            self.checks, self.said = (found.check,), found.message
            self.most = self.raised.times + RAISED
            self.until = float("inf") if self.seconds is None else monotonic() + self.seconds
        self.least = found.case
        return True

    def among(self, drawn: Strategy, profile: settings, seed: int) -> Case | None:
        """The least failing case of one increment that was met."""
        with suppress(NoSuchExample, Flaky, _Enough):  # flaky: the routine has a memory, and the case that failed first is told
            find(drawn, self.fails, settings=profile, random=Random(seed))
        if self.unfinished is not None:
            raise self.unfinished
        return self.least
