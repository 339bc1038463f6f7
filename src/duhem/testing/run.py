"""One routine put to some checks: cases drawn, each case's replies shared, what fails looked for again and shrunk."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from numbers import Real
from random import Random
from typing import Any

from hypothesis import Phase, Verbosity, settings
from hypothesis.strategies import SearchStrategy
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.testing.checks.asked_for import AskedFor
from duhem.testing.checks.judged import judged
from duhem.testing.checks.query import NothingToCheck, Query
from duhem.testing.checks.raised import NoReply, Raised, named_by
from duhem.testing.checks.registry import Check, registered
from duhem.testing.checks.visited import Visited
from duhem.testing.drawn.admitted_values import admitted
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.decades import Strategy
from duhem.testing.drawn.region import Region
from duhem.testing.drawn.simplified import simplified
from duhem.testing.drawn.strategies import cases
from duhem.testing.drawn.usable_options import check_options
from duhem.testing.failures.causes import by_cause, explained_by, of_stress
from duhem.testing.failures.diagnosed import diagnosed
from duhem.testing.failures.expectation import Expectation
from duhem.testing.failures.least_case import RAISED, LeastCase
from duhem.testing.failures.replay import drawn_again
from duhem.testing.failures.report import Failure, Report
from duhem.testing.failures.short_failure import short_failure
from duhem.testing.failures.stress_diagnoses import needs_the_run
from duhem.testing.routines.material import Material
from duhem.testing.routines.origin import Origin, named, origin
from duhem.testing.routines.routine import Update
from duhem.testing.routines.unfinished import Unfinished

__all__ = ["TRIES", "ConformanceRun"]

_ANSWERS, _MEMORY = "answers", "repeatability"
_EVERY = 7  # so many increments, of which one is asked what the checks ask again: an odd number, as seams have two sides by turns
TRIES = 200  # to make a failing case smaller, counted, so that what is told does not depend on the load of the machine
_SINGLE = 300  # single increments among which a failure is looked for again, to be shrunk


class ConformanceRun:
    """What a routine is held to, and what was found on the way; :meth:`report` may be asked before it has ended."""

    def __init__(
        self,
        law: Criterion | None,
        update: Update,
        parameters: Mapping[str, Any] | None,
        asked: Sequence[Check],
        *,
        stiffness: ArrayLike | Strategy | None,
        pressure: float | Strategy | None,
        accuracy: float,
        max_examples: int | None,
        rows: int,
        every: int | None = None,
        tries: int = TRIES,
        seconds: float | None = None,
        seed: int | None = None,
        expected: Mapping[str, str] | None = None,
        on_case: Callable[[ConformanceRun], None] | None = None,
        given: Any = None,
    ) -> None:
        own = isinstance(update, Material)  # which has its stiffness, as its routine gives it
        check_options(
            law,
            stiffness=None if own else stiffness,
            pressure=pressure,
            accuracy=accuracy,
            max_examples=max_examples,
            rows=rows,
            every=_EVERY if every is None else every,
            tries=tries,
            seconds=seconds,
            seed=seed,
        )
        self.law, self.update, self.accuracy, self.on_case = law, update, accuracy, on_case
        self.tries, self.seconds, self.every = tries, seconds, _EVERY if every is None else every
        self.given = law if given is None else given
        self.parameters, self.stiffness, self.pressure, self.rows = parameters, stiffness, pressure, rows
        self.passed = self._open()
        self.asked, self.pending, self.expected = tuple(asked), list(asked), dict(expected or {})
        self.answers = next((c for c in asked if c.name == _ANSWERS), None)  # which tells of silence, once for all checks
        options: dict[str, Any] = {} if max_examples is None else {"max_examples": max_examples}
        self.profile = settings(settings.default, database=None, deadline=None, verbosity=Verbosity.quiet, print_blob=False, **options)
        self.seed = seed if seed is not None else 0 if self.profile.derandomize else Random().getrandbits(32)
        given = {"parameters": parameters or None, "stiffness": None if own else stiffness, "pressure": pressure}
        chosen = {"checks": [c.name for c in asked]} if {*asked} != {*self._demanded()} else {}
        self.again = drawn_again(given, **chosen, max_examples=self.profile.max_examples, rows=rows, every=self.every, seed=self.seed)
        self.found: list[Failure] = []
        self.left_out: dict[str, str] = {}
        self.judged: set[str] = set()
        self.asked_for = AskedFor()
        self.raised = Raised()
        self.last: Case | None = None
        self.opening: Case | None = None
        free = {"pressure": not isinstance(pressure, Real), "stiffness": stiffness is None or isinstance(stiffness, SearchStrategy)}
        self.fixed = frozenset(name for name, may_change in free.items() if not may_change)
        self.shortened: dict[str, Failure] = {}
        self.visited, self.examples = self._nothing_visited(), 0

    @property
    def known(self) -> Criterion:
        """The law; a run without one asks for none."""
        assert self.law is not None
        return self.law

    def _open(self) -> tuple[str, ...]:
        return tuple(name for name, domain in self.known.fix(self.parameters).parameters.items() if domain.value is None)

    def _demanded(self) -> Iterable[Check]:
        return [c for c in registered() if c.demanded]

    def _nothing_visited(self) -> Visited:
        return Visited(tuple(self.known.forces), self.known.pressure is not None)

    def _title(self) -> str:
        return self.known.name

    def _causes(self, failures: Sequence[Failure]) -> tuple[tuple[Failure, ...], tuple[Failure, ...]]:
        return by_cause(failures)

    def _explained_by(self, check: str, failed: Collection[str]) -> Collection[str]:
        return explained_by(check, failed)

    def try_first(self, cases: Iterable[Case]) -> None:
        """Note what fails on cases that are known already, one increment each; those that do not fit are passed over."""
        for case in cases:
            if len(case) == 1 and self.law is not None and case.fits(self.law.fix(self.parameters)):
                self._note_all(list(self.failures(self.query(case), self.pending)))

    def to_the_end(self) -> ConformanceRun:
        """Draw cases until every check has failed or has seen them all."""
        drawn = self._cases(self.parameters, self.stiffness, self.rows)
        while self.pending:
            self.visited, self.examples = self._nothing_visited(), 0
            search = self._search(self.pending, self._drawn)
            if (first := search.among(drawn, settings(self.profile, phases=(Phase.generate,)), self.seed)) is None:
                self._look_at_the_whole()
                break
            self._note(first, search.checks, search.said)
        self.visited.demand_measured(self._title())
        return self

    def _cases(self, parameters: Mapping[str, Any] | None, stiffness: ArrayLike | Strategy | None, rows: int = 1) -> Strategy:
        return cases(self.known, parameters, stiffness=stiffness, pressure=self.pressure, rows=rows)

    def _search(self, checks: Sequence[Check], drawn: Callable[[Query], None] = lambda _: None) -> LeastCase:
        def failing(case: Case, asked: Sequence[Check]) -> Failure | None:
            query = self.query(case)
            found = next(self.failures(query, asked), None)
            drawn(query)
            return found

        return LeastCase(failing, checks, self.tries, self.seconds, self.raised)

    def _drawn(self, query: Query) -> None:
        self.examples += 1
        self.visited.measure(query)
        if "here" in query.__dict__:  # the routine was asked
            self.visited.add(query)
        if self.on_case is not None:
            self.on_case(self)

    def _note(self, first: Case, checks: Sequence[Check], said: str) -> None:
        """Look for a smaller case than the first that failed, and note every check that fails on it."""
        self.raised.said.clear()  # a routine with a memory may answer now
        if not any(self.failures(self.query(first), checks)):
            self._note_all(self._unrepeatable(first, checks[0], said))
            return
        least = first
        shrinking = settings(self.profile, max_examples=_SINGLE, phases=(Phase.generate, Phase.shrink))
        for fixed, k in ((self.parameters, self.stiffness), (first.parameters, first.stiffness)):  # the second is closer to what failed
            if (met := self._search(checks).among(self._cases(fixed, k), shrinking, self.seed)) is not None:
                least = met
                break
        again = list(self.failures(self.query(least), self.pending))
        if not again:  # a check passes over rows that the routine has flagged for one before it: here each is on its own
            again = list(self.failures(self.query(least), checks))
        self._note_all(again or self._unrepeatable(first, checks[0], said))

    def _note_all(self, failures: Sequence[Failure]) -> None:
        self.found += failures
        failed = {f.check.name for f in failures}
        self.pending = [c for c in self.pending if c.name not in failed]

    def _unrepeatable(self, case: Case, check: Check, said: str) -> list[Failure]:
        """A failure that does not show again: the routine keeps something between calls, which is told once."""
        known = any(f.check.name == _MEMORY for f in self.found)
        memory = next((c for c in self.pending if c.name == _MEMORY), None)
        if memory is None and not known:
            raise InputError(
                "the routine answers the same increment in different ways", where="update", remedy="test one that keeps no state"
            )
        if check.name != _MEMORY:
            self.pending.remove(check)
            self.judged.discard(check.name)
            self.left_out[check.name] = "failed once, and not when asked again: the routine has a memory"
        if memory is None:
            return []
        message = f"{check.name} failed on this case, and not when asked again: {said}"
        return [self._failure(memory, message, case, float("nan"), 0.0)]

    def _look_at_the_whole(self) -> None:
        """The checks that no case alone can fail."""
        for asked in self.pending:
            if asked.whole is None or self.last is None or not (asked.name in self.judged or self.asked_for.flagged):
                continue
            if (message := asked.whole(self.visited)) is not None:
                self.judged.add(asked.name)
                self.found.append(self._failure(asked, message, self.last.row(0), float("nan"), 0.0))

    def failures(self, query: Query, checks: Sequence[Check]) -> Iterator[Failure]:
        """The failures of some checks on a case, as they are found."""
        silent = any(f.check.name == _ANSWERS for f in self.found) and [*checks] != [self.answers]  # asked alone, to be made short
        try:
            for asked in checks:
                try:
                    found = judged(asked, query)
                except NothingToCheck as reason:
                    self.left_out[asked.name] = str(reason)
                    continue
                except Unfinished as fault:
                    raise self._placed(fault, asked, query.case) from None
                except NoReply as fault:
                    if self.answers is not None and asked.name != _ANSWERS:
                        self.left_out[asked.name] = f"not run: {fault}"
                        if silent:
                            continue
                    found = self._silent(asked, query.case, fault), str(fault), float("nan"), 0.0
                    if self.answers is not None and self._is_silent(self.answers, found[0]):
                        if silent or self.answers not in checks:
                            continue
                        asked, silent = self.answers, True
                self.judged.add(asked.name)
                if found is not None:
                    case, message, measured, allowed = found
                    yield self._failure(asked, message, case, measured, allowed)
        finally:
            self.asked_for.add(query.parts)

    def _placed(self, fault: Unfinished, asked: Check, case: Case) -> Unfinished:
        """The same with the increment, and what shows it again."""
        failure = replace(self._failure(asked, fault.what, named_by(fault, case), float("nan"), 0.0), origin=self._origin())
        placed = Unfinished(fault.what, where=f"{failure.increment}, asked by the check {asked.name}", remedy=fault.remedy)
        placed.failure = failure
        return placed

    def _origin(self) -> Origin:
        return origin(self.update, self.law, self.given)

    def _silent(self, asked: Check, case: Case, fault: NoReply) -> Case:
        """The first increment to which the routine gives no answer alone; the first one where it is silent about several at once only."""
        if fault.row is not None:
            named = named_by(fault, case)
            return named if self._is_silent(asked, named) else case.row(fault.row)
        rows = range(len(case)) if len(case) > 1 else ()
        return case.row(next((i for i in rows if self._is_silent(asked, case.row(i))), 0))

    def _is_silent(self, asked: Check, case: Case) -> bool:
        try:
            with suppress(NothingToCheck):
                judged(asked, self.query(case))
        except NoReply:
            return True
        return False

    def query(self, case: Case) -> Query:
        """The routine asked about one case."""
        self.last, former = case, self.opening
        self.opening = case.row(0) if former is None else former
        region, asked = Region(self.known, case.parameters), (self.update, self.passed, self.accuracy, self.every, self.examples)
        return Query(region, case, *asked, raised=self.raised, opening=former, fixed=self.fixed)

    def _failure(self, check: Check, message: str, case: Case, measured: float, allowed: float) -> Failure:
        told = check, self.law, message, case, measured, allowed, self.accuracy, named(self.update), self.passed
        return Failure(*told, drawn=self.again, alone=not check.whole and check.name != _MEMORY)

    def report(self) -> Report:
        """What was found so far."""
        bad = {f.check.name for f in self.found}
        passed = tuple(c.name for c in self.asked if c.name in self.judged - bad)
        known = Expectation(self.expected, bad, self._explained_by)
        causes, explained = self._causes(self._told(f for f in self.found if f.check.name not in known.met))
        return Report(
            law=self._title(),
            passed=passed,
            failures=tuple(map(self._short, causes)),
            left_out=known.told({name: why for name, why in self.left_out.items() if name not in self.judged}),
            explained=explained,
            expected=known.met,
            unexpected=known.unmet(passed),
            visited=self.visited.shares,
            decades=self.visited.decades,
            examples=self.examples,
            seed=self.seed,
            unmeasured=self.visited.unmeasured,
            needs={c.name: c.needs for c in self.asked if c.needs},
            **self.asked_for.told(),
        )

    def _told(self, failures: Iterable[Failure]) -> list[Failure]:
        return diagnosed(failures, self.query, self._origin(), self._accused)

    @property
    def _accused(self) -> bool:
        return any(map(of_stress, self.found))

    def _short(self, failure: Failure) -> Failure:
        """With a case that is short to read; looked for once."""
        name = failure.check.name
        if name not in self.shortened:
            self.shortened[name] = self._simplified(failure)
        short = self.shortened[name]
        return replace(short, explains=failure.explains, alone=short.alone and not needs_the_run(short.diagnoses))

    def _simplified(self, failure: Failure) -> Failure:
        enough = self.raised.times + RAISED

        def fails(case: Case) -> bool:
            return self.raised.times <= enough and any(True for _ in self.failures(self.query(case), [failure.check]))

        law = self.law
        if law is None or not failure.alone or len(failure.case) != 1 or not fails(failure.case):
            return failure
        own = law.domain.get(law.pressure or "")
        shorter = partial(
            simplified,
            admitted=admitted(law.fix(self.parameters)).holds,
            free=self.passed,
            stiffness=self.stiffness is None,
            pressure=None if self.pressure is not None else lambda p: p <= 0.0 and (own is None or p in own),
        )

        def again(case: Case) -> Failure | None:
            return next(self.failures(self.query(case), [failure.check]), None)

        return short_failure(failure, fails, shorter, again, self.query, self._accused)
