"""The conformance suite: every check on one stream of cases, each case's replies shared, and what fails shrunk."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from random import Random
from time import monotonic
from typing import Any

import numpy as np
from hypothesis import Phase, Verbosity, find, settings
from hypothesis.errors import NoSuchExample
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.law.catalogue import load
from duhem.law.formula_law import Criterion
from duhem.testing import law_checks, routine_checks, tangent_checks  # noqa: F401 (they register their checks)
from duhem.testing.case import Case
from duhem.testing.query import NoReply, NothingToCheck, Query
from duhem.testing.region import Region
from duhem.testing.registry import Check, registered
from duhem.testing.report import Failure, Report
from duhem.testing.routine import Update
from duhem.testing.strategies import Strategy, cases

__all__ = ["ACCURACY", "assert_conforms", "check", "checks_for", "conformance", "violation"]

ACCURACY = 1e-9  # relative error in stress a routine is held to, unless it promises another
_SINGLE = 300  # single increments among which a failure is looked for again, to be shrunk


def checks_for(law: Criterion | str | Path) -> tuple[Check, ...]:
    """The checks a routine for ``law`` has to pass; those that only some laws satisfy are asked for by name."""
    load(law)
    return tuple(c for c in registered() if c.demanded)


def check(name: str) -> Check:
    """A check by name.  Raises InputError for an unknown one."""
    known = {c.name: c for c in registered()}
    if name not in known:
        raise InputError(f"unknown check {name!r}", remedy=f"choose one of {', '.join(known)}")
    return known[name]


def violation(
    name: str | Check,
    law: Criterion | str | Path,
    update: Update,
    case: Case,
    *,
    open_parameters: Iterable[str] | None = None,
    accuracy: float = ACCURACY,
) -> str | None:
    """What is wrong with the routine's answer to one case by one check, or None; ``open_parameters`` are passed to it by name."""
    known = load(law)
    asked = check(name) if isinstance(name, str) else name
    passed = tuple(case.parameters) if open_parameters is None else tuple(open_parameters)
    try:
        found = _judged(asked, Query(Region(known, case.parameters), case, update, passed, accuracy))
    except NoReply as fault:
        return str(fault)
    return None if found is None else found[1]


def _judged(asked: Check, query: Query) -> tuple[int, str, float, float] | None:
    """The worst row, a message, what was measured and what is allowed.

    Raises NothingToCheck where no row can be judged, NoReply where the routine gave none.
    """
    with np.errstate(all="ignore"):
        finding = asked.measure(query)
    judged = query.sound | asked.law_only
    if not judged.any():
        raise NothingToCheck("the routine flags every increment as not solved")
    bad = finding.violated & judged
    if not bad.any():
        return None
    with np.errstate(all="ignore"):
        excess = np.where(bad, np.nan_to_num(finding.measured - finding.allowed, nan=np.inf, posinf=1e300), -np.inf)
    i = int(np.argmax(excess))
    measured, allowed = float(finding.measured[i]), float(finding.allowed[i])
    return i, f"measured {measured:.3g}, allowed {allowed:.3g}", measured, allowed


class _Enough(BaseException):
    """Shrinking has had its time.  No Exception, which Hypothesis would take for one more failure."""


class _Search:
    """One search for a case on which one of ``checks`` fails; ``seconds`` bound its shrinking."""

    def __init__(self, run: _Run, checks: Sequence[Check], seconds: float) -> None:
        self.run, self.checks, self.seconds = run, checks, seconds
        self.least: Case | None = None
        self.until = float("inf")

    def fails(self, case: Case) -> bool:
        """Whether a check that is looked for fails on the case; from the first that does on, only that one counts."""
        if monotonic() > self.until:
            raise _Enough
        found = next(self.run.failures(case, self.checks), None)
        if found is None:
            return False
        if self.least is None:
            self.checks, self.until = (found.check,), monotonic() + self.seconds
        self.least = found.case
        return True

    def among(self, drawn: Strategy, profile: settings) -> Case | None:
        """The least failing case of one increment that was met."""
        with suppress(NoSuchExample, _Enough):
            find(drawn, self.fails, settings=profile, random=Random(0) if profile.derandomize else None)
        return self.least


class _Run:
    """What a routine is held to, and what was counted on the way."""

    def __init__(self, law: Criterion, update: Update, passed: tuple[str, ...], accuracy: float, pending: Sequence[Check]) -> None:
        self.law, self.update, self.passed, self.accuracy = law, update, passed, accuracy
        self.pending = list(pending)
        self.silence_told = any(c.name == "answers" for c in pending)  # once is enough
        self.left_out: dict[str, str] = {}
        self.judged: set[str] = set()
        self.points = self.flagged = 0

    def failures(self, case: Case, checks: Sequence[Check]) -> Iterator[Failure]:
        """The failures of some checks on the case, as they are found."""
        query = Query(Region(self.law, case.parameters), case, self.update, self.passed, self.accuracy)
        try:
            for asked in checks:
                try:
                    found = _judged(asked, query)
                except NothingToCheck as reason:
                    self.left_out[asked.name] = str(reason)
                    continue
                except NoReply as fault:
                    if self.silence_told and asked.name != "answers":
                        self.left_out[asked.name] = f"not run: {fault}"
                        continue
                    found = 0, str(fault), float("nan"), 0.0
                self.judged.add(asked.name)
                if found is not None:
                    row, message, measured, allowed = found
                    yield Failure(
                        asked, self.law, message, case.row(row), measured, allowed, self.accuracy, _name(self.update), self.passed
                    )
        finally:
            self.points += query.points
            self.flagged += query.flagged


def _name(update: Update) -> str:
    name = getattr(update, "__qualname__", type(update).__qualname__)
    return f"{getattr(update, '__module__', '')}.{name}"


def conformance(
    law: Criterion | str | Path,
    update: Update,
    parameters: Mapping[str, Any] | None = None,
    *,
    stiffness: ArrayLike | Strategy | None = None,
    pressure: float | Strategy | None = None,
    checks: Iterable[Check | str] | Check | str | None = None,
    accuracy: float = ACCURACY,
    max_examples: int | None = None,
    rows: int = 30,
    seconds: float = 10.0,
) -> Report:
    """Put a routine for the slip increment of ``law`` to every check, on cases drawn by Hypothesis and shrunk where one fails.

    ``update(trial (N, d), pressure (N,), stiffness (d, d), **open)`` returns the stress (N, d) in Pa or a :class:`Step`;
    the pressure is None for a law without, and ``open`` are the parameters ``parameters`` leaves open, drawn over their
    domain.  :func:`pointwise` and :func:`from_displacements` adapt other shapes of routine.  ``stiffness`` and
    ``pressure`` are fixed values or strategies, drawn where left out.  ``accuracy`` is the relative error in stress the
    routine promises; every tolerance follows from it (:attr:`Check.tolerance`).  ``max_examples`` cases of about ``rows``
    increments are drawn, as the Hypothesis profile says where left out; ``seconds`` bounds the shrinking of each failure.
    The law is taken to be associated.

    A failing check is data in the report, not an exception: see :func:`assert_conforms`.
    """
    known = load(law)
    named = checks_for(known) if checks is None else (checks,) if isinstance(checks, str | Check) else checks
    asked = [check(c) if isinstance(c, str) else c for c in named]
    free = tuple(name for name, domain in known.fix(parameters).parameters.items() if domain.value is None)
    run = _Run(known, update, free, accuracy, asked)
    drawn = cases(known, parameters, stiffness=stiffness, pressure=pressure, rows=rows)
    options: dict[str, Any] = {} if max_examples is None else {"max_examples": max_examples}
    profile = settings(settings.default, database=None, deadline=None, verbosity=Verbosity.quiet, print_blob=False, **options)
    failures: list[Failure] = []
    while run.pending:
        search = _Search(run, run.pending, seconds)
        found = search.among(drawn, settings(profile, phases=(Phase.generate,)))
        if found is None:
            break
        least = found
        shrinking = settings(profile, max_examples=_SINGLE)
        for fixed, k in ((parameters, stiffness), (found.parameters, found.stiffness)):  # the second is closer to what failed
            single = cases(known, fixed, stiffness=k, pressure=pressure)
            if (met := _Search(run, search.checks, seconds).among(single, shrinking)) is not None:
                least = met
                break
        again = list(run.failures(least, run.pending))
        if not again:  # a check passes over rows that the routine has flagged for one before it: here each is on its own
            again = list(run.failures(least, search.checks))
        if not again:
            raise InputError(
                "the routine answers the same increment in different ways", where="update", remedy="test one that keeps no state"
            )
        failures += again
        failed = {f.check.name for f in again}
        run.pending = [c for c in run.pending if c.name not in failed]
    left_out = {name: why for name, why in run.left_out.items() if name not in run.judged}
    bad = {f.check.name for f in failures}
    passed = tuple(c.name for c in asked if c.name in run.judged - bad)
    return Report(known.name, passed, tuple(failures), left_out, run.points, run.flagged)


def assert_conforms(
    law: Criterion | str | Path, update: Update, parameters: Mapping[str, Any] | None = None, *, most_flagged: float = 0.0, **options: Any
) -> Report:
    """:func:`conformance`, raising AssertionError with the shrunk cases if a check fails or more than ``most_flagged`` is flagged."""
    report = conformance(law, update, parameters, **options)
    if not report.ok:
        raise AssertionError(str(report))
    if report.flagged_share > most_flagged:
        raise AssertionError(
            f"the routine flags {report.flagged} of {report.points} increments as not solved, more than a share {most_flagged}"
        )
    return report
