"""One routine put to some checks: cases drawn, each case's replies shared, what fails looked for again and shrunk."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from math import isnan, nan
from numbers import Real
from random import Random
from typing import Any, cast

import numpy as np
from hypothesis import Phase, Verbosity, settings
from hypothesis.strategies import SearchStrategy, sampled_from
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.testing.checks.history import HistoryQuery
from duhem.testing.checks.law_in_state import LawInState, Places
from duhem.testing.checks.query import NoReply, NothingToCheck, Query, Raised, named_by
from duhem.testing.checks.registry import Check, Visited, judged, registered
from duhem.testing.drawn.case import Case, Region
from duhem.testing.drawn.strategies import RunOptions, cases, histories, numbers, pressures
from duhem.testing.drawn.values import Strategy, admitted
from duhem.testing.failures.diagnosis import IN_REGION, Regions, as_expected, by_cause, departure, diagnosed, instead, of_stress, region_of
from duhem.testing.failures.failure import RAISED, Failure, drawn_again, least_case, shortened, simplified
from duhem.testing.failures.report import Report
from duhem.testing.failures.suggestions import needs_the_run
from duhem.testing.routines import Material, Origin, Unfinished, Update, named, origin, stateless

__all__ = ["ConformanceRun"]

_ANSWERS, _MEMORY = "answers", "repeatability"
# So many increments, of which one is asked what the checks ask again, with a law and without: the first is odd, as seams have two sides
# by turns.
_EVERY, _EVERY_HISTORY = 7, 2
_ASKED = 4  # increments of other regions that are asked for their reason, those of the checks and regions that fail most
_LOOKED_AT = 3  # cases in which it is counted where a check fails
_FEW = 40  # tries to make a history short that is held to a law
_SINGLE = 300  # single increments among which a failure is looked for again, to be shrunk


class ConformanceRun:
    """What a routine is held to, and what was found on the way; :attr:`ended` is what ended it before its end, None where nothing did.

    ``law`` is None where none is known: the routine, or a material with its own stiffness and parameters, is put to the checks that need
    none.  A material with a law is put to these too, and ``held_to`` the law, whose variables have the places ``state`` (that of the
    material where left out).
    ``options`` are those of :class:`RunOptions`.
    """

    def __init__(
        self,
        law: Criterion | None,
        update: Update | Material,
        parameters: Mapping[str, Any] | None,
        asked: Sequence[Check],
        *,
        expected: Mapping[str, str] | None = None,
        on_case: Callable[[ConformanceRun], None] | None = None,
        given: Any = None,
        state: Places | None = None,
        **options: Any,
    ) -> None:
        drawn, self.held_to = RunOptions(**options), law if isinstance(update, Material) else None
        self.in_state: LawInState | None = None
        self.warm, self.held, pressed = None, "", self.held_to is not None and self.held_to.pressure is not None
        self.given = law if given is None else given
        said = {"parameters": parameters or None, "stiffness": drawn.stiffness, "pressure": drawn.pressure}
        if isinstance(update, Material) and law is not None:
            self.warm, values = law.temperature, dict(parameters or {})
            warm, remedy = values.get(str(self.warm)), f'give one or several, for example parameters={{"{self.warm}": [293.0, 400.0]}}'
            if self.warm is not None and (warm is None or not np.size(warm)):
                raise InputError(f"the temperature {self.warm} has no value", where="parameters", remedy=remedy)
            first = None if self.warm is None else np.ravel(numbers(warm, f"temperature {self.warm}", remedy)).tolist()
            update = replace(update, temperature=first[0] if first else None, pressed=pressed)
            self.in_state = LawInState.of(law, update, values, state)
            parameters = {} if first is None else {str(self.warm): sampled_from(first)}
            self.held = f"{drawn_again({'parameters': values})}, state={self.in_state.places!r}"
            law, said["parameters"] = None, None
        if law is None:
            _check_without_law(update, said | ({"pressure": None} if pressed else {}))
        if pressed and drawn.pressure is None:
            drawn = replace(drawn, pressure=pressures(-1, 1))
        drawn.check(law)
        most: dict[str, Any] = {} if drawn.max_examples is None else {"max_examples": drawn.max_examples}
        self.profile = settings(settings.default, database=None, deadline=None, verbosity=Verbosity.quiet, print_blob=False, **most)
        self.seed = drawn.seed if drawn.seed is not None else 0 if self.profile.derandomize else Random().getrandbits(32)
        self.every = drawn.every if drawn.every is not None else _EVERY_HISTORY if law is None else _EVERY
        self.law, self.update, self.parameters, self.on_case, self.drawn = law, update, parameters, on_case, drawn
        self.timed = self.in_state is not None and self.in_state.own.timed
        self.kind = ((), drawn.pressure is not None, self.timed) if law is None else (tuple(law.forces), law.pressure is not None)
        self.sizes = {name: size for name in ("largest_strain", "scale") if (size := getattr(drawn, name)) is not None}
        self.stiffness = update.elastic if isinstance(update, Material) else drawn.stiffness
        domains = {} if law is None else law.fix(parameters).parameters
        self.passed = tuple(parameters or ()) if law is None else tuple(name for name, domain in domains.items() if domain.value is None)
        self.asked, self.pending, self.expected = tuple(asked), list(asked), dict(expected or {})
        self.answers = next((c for c in asked if c.name == _ANSWERS), None)  # which tells of silence, once for all checks
        demanded = {check for check in registered(law is not None, self.held_to is not None).values() if check.demanded}
        chosen = {"checks": [c.name for c in asked]} if {*asked} != demanded else {}
        counts = {"max_examples": self.profile.max_examples, "rows": drawn.rows, "every": self.every, "seed": self.seed}
        again = drawn_again(said, **chosen, **counts, **self.sizes)
        self.again = ", ".join(filter(None, (self.held, again))) if again else ""
        self.ended: KeyboardInterrupt | Unfinished | None = None
        self.found: list[Failure] = []
        self.left_out: dict[str, str] = {}
        self.judged: set[str] = set()
        self.counted = Counter(points=0, flagged=0, undefined=0)  # increments asked for, and of these the ones with no answer or no g
        self.tried: Counter[tuple[str, str]] = Counter()  # by check and thing, what checks looked at more than the increments
        self.raised = Raised()
        self.last: Case | None = None
        self.opening: Case | None = None
        fixed = {"pressure": isinstance(drawn.pressure, Real), "stiffness": not isinstance(drawn.stiffness, SearchStrategy | None)}
        self.fixed = frozenset(name for name, always in fixed.items() if always)
        self.shortened: dict[str, Failure] = {}
        self.visited, self.examples = Visited(*self.kind), 0

    @property
    def _title(self) -> str:
        if self.law is not None:
            return self.law.name
        name = getattr(self.update, "name", None) or getattr(self.update, "__name__", "update")
        return f"{name}, without a law" if self.held_to is None else f"{name} as {self.held_to.name}"

    def outcome(self, first: Iterable[Case] = ()) -> Report:
        """Try the cases that come ``first``, and draw others to the end; an interrupt or a routine that does not come back ends both."""
        try:
            self._try_first(first)
            self._to_the_end()
            return self.report()
        except (KeyboardInterrupt, Unfinished) as ended:
            self.ended = ended
            return self.report()

    def _try_first(self, cases: Iterable[Case]) -> None:
        """Note what fails on cases that are known already, one increment each; those that do not fit are passed over."""
        for case in cases:
            if len(case) == 1 and self.law is not None and case.fits(self.law.fix(self.parameters)):
                self._note_all(list(self.failures(self.query(case), self.pending)))

    def _to_the_end(self) -> None:
        """Draw cases until every check has failed or has seen them all."""
        while self.pending:
            self.visited, self.examples = Visited(*self.kind), 0
            drawn = self._cases(self.parameters, self.stiffness, self.drawn.rows)
            found = self._least(self.pending, drawn, settings(self.profile, phases=(Phase.generate,)), self._drawn)
            if found is None:
                self._look_at_the_whole()
                break
            self._note(*found)
        self.visited.demand_measured(self._title)

    def _cases(self, parameters: Mapping[str, Any] | None, stiffness: ArrayLike | Strategy | None, rows: int = 1) -> Strategy:
        if self.law is not None:
            return cases(self.law, parameters, stiffness=stiffness, pressure=self.drawn.pressure, rows=rows)
        assert stiffness is not None
        given = parameters or {}, stiffness, self.drawn.pressure, rows
        told = {"accuracy": self.drawn.accuracy, "searched": self.visited.searched, "timed": self.timed, **self.sizes}
        return histories(self._material, *given, **told)

    def _material(self, values: Mapping[str, float], stiffness: Any) -> Material:
        if isinstance(self.update, Material) and self.warm is not None and self.update.temperature != values[self.warm]:
            return replace(self.update, temperature=values[self.warm])
        return stateless(self.update, stiffness, values)

    def _least(
        self, checks: Sequence[Check], cases: Strategy, profile: settings, drawn: Callable[[Query], None] = lambda _: None
    ) -> tuple[Case, Failure] | None:
        """Return the least of the cases on which one of some checks fails, and the first failure; ``drawn`` is called with each case."""

        def failing(case: Case, asked: Sequence[Check]) -> Failure | None:
            query = self.query(case)
            found = next(self.failures(query, asked), None)
            drawn(query)
            return found

        bounds: dict[str, Any] = {"seed": self.seed, "tries": self.drawn.tries, "seconds": self.drawn.seconds, "raised": self.raised}
        return least_case(failing, checks, cases, profile, **bounds)

    def _drawn(self, query: Query) -> None:
        self.examples += 1
        self.visited.measure(query)
        if "here" in query.__dict__:  # the routine was asked
            self.visited.add(query)
        if self.on_case is not None:
            self.on_case(self)

    def _note(self, first: Case, failed: Failure) -> None:
        """Look for a smaller case than the first that failed, and note every check that fails on it."""
        self.raised.said.clear()  # a routine with a memory may answer now
        checks = (failed.check,)
        if not any(self.failures(self.query(first), checks)):
            self._note_all(self._unrepeatable(first, failed))
            return
        if self.in_state is not None and any(self.failures(self.query(failed.case), checks)):  # each row is a history of its own
            least = shortened(failed.case, lambda case: any(self.failures(self.query(case), checks)), min(self.drawn.tries, _FEW))
            self._note_all(list(self.failures(self.query(least), self.pending)))
            return
        least = first
        shrinking = settings(self.profile, max_examples=_SINGLE, phases=(Phase.generate, Phase.shrink))
        for fixed, k in ((self.parameters, self.stiffness), (first.parameters, first.stiffness)):  # the second is closer to what failed
            if (met := self._least(checks, self._cases(fixed, k), shrinking)) is not None:
                least = met[0]
                break
        again = list(self.failures(self.query(least), self.pending))
        if not again:  # a check passes over rows that the routine has flagged for one before it: here each is on its own
            again = list(self.failures(self.query(least), checks))
        self._note_all(again or self._unrepeatable(first, failed))

    def _note_all(self, failures: Sequence[Failure]) -> None:
        self.found += failures
        failed = {f.check.name for f in failures}
        self.pending = [c for c in self.pending if c.name not in failed]

    def _unrepeatable(self, case: Case, failed: Failure) -> list[Failure]:
        """Return the failure to report where one does not show again: the routine keeps something between calls, which is reported once."""
        check = failed.check
        known = any(f.check.name == _MEMORY for f in self.found)
        memory = next((c for c in self.pending if c.name == _MEMORY), None)
        if memory is None and not known:
            what = "the routine gives different answers to the same increment"
            raise InputError(what, where="update", remedy="test a routine without memory")
        if check.name != _MEMORY:
            self.pending.remove(check)
            self.judged.discard(check.name)
            self.left_out[check.name] = "failed once, but not when repeated: the routine remembers earlier calls"
        if memory is None:
            return []
        message = f"{check.name} failed on this case, but not when repeated: {failed.message}"
        return [self._failure(memory, message, case)]

    def _look_at_the_whole(self) -> None:
        """Note the failures of checks that no case alone can fail."""
        for asked in self.pending:
            if asked.whole is None or self.last is None or not (asked.name in self.judged or self.counted["flagged"]):
                continue
            if (message := asked.whole(self.visited)) is not None:
                self.judged.add(asked.name)
                self.found.append(self._failure(asked, message, self.last.row(0)))

    def failures(self, query: Query, checks: Sequence[Check]) -> Iterator[Failure]:
        """Yield the failures of some checks on a case, as they are found."""
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
                    found = self._silent(asked, query.case, fault), str(fault), nan, 0.0
                    if self.answers is not None and self._is_silent(self.answers, found[0]):
                        if silent or self.answers not in checks:
                            continue
                        asked, silent = self.answers, True
                self.judged.add(asked.name)
                if found is not None:
                    case, message, *sizes = found
                    yield self._failure(asked, message, case, *sizes)
        finally:
            for part in query.parts:
                self.counted.update(points=part.points, flagged=part.flagged, undefined=int(part.unsaid.sum()))
                self.tried.update(part.tried)

    def _placed(self, fault: Unfinished, asked: Check, case: Case) -> Unfinished:
        """Return the same error with the increment, and with what shows it again."""
        failure = replace(self._failure(asked, fault.what, named_by(fault, case)), origin=self._origin())
        placed = Unfinished(fault.what, where=f"{failure.increment}, in the check {asked.name}", remedy=fault.remedy)
        placed.failure = failure
        return placed

    def _origin(self) -> Origin:
        return origin(self.update, self.held_to or self.law, self.given)

    def _silent(self, asked: Check, case: Case, fault: NoReply) -> Case:
        """Return the first increment that the routine does not answer alone, or the first of all where it answers each of them alone."""
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

    def query(self, case: Case, accuracy: float | None = None) -> Query:
        """Return what asks the routine about one case, held to the accuracy of the run or another one."""
        self.last, counted = case, (self.drawn.accuracy if accuracy is None else accuracy, self.every, self.examples)
        if self.law is None:
            made = self._material(case.parameters, case.stiffness)
            return HistoryQuery(made, case, *counted, raised=self.raised, law=self.in_state)
        former = self.opening
        self.opening = case.row(0) if former is None else former
        asked = Region(self.law, case.parameters), case, cast(Update, self.update), self.passed
        return Query(*asked, *counted, raised=self.raised, opening=former, fixed=self.fixed)

    def _failure(self, check: Check, message: str, case: Case, measured: float = nan, allowed: float = 0.0) -> Failure:
        told = check, self.law, message, case, measured, allowed, self.drawn.accuracy, named(self.update), self.passed
        return Failure(*told, drawn=self.again, alone=not check.whole and check.name != _MEMORY, held=self.held)

    # -- what is told --------------------------------------------------------------------------------------------------

    def report(self) -> Report:
        """Return what was found so far; where something has ended the run, without asking the routine what it does instead."""
        ended = self.ended
        bad = {f.check.name for f in self.found}
        passed = tuple(c.name for c in self.asked if c.name in self.judged - bad)
        left_out = {name: why for name, why in self.left_out.items() if name not in self.judged}
        expected, unexpected, left_out = as_expected(self.expected, bad, passed, left_out, self.law is not None)
        unexplained = [f for f in self.found if f.check.name not in expected]
        causes, explained = by_cause(self._told(unexplained) if ended is None else unexplained)
        if ended is None:
            causes, explained = self._elsewhere([*map(self._short, causes)], explained)
        return Report(
            law=self._title,
            passed=passed,
            failures=causes,
            ended="" if ended is None else f"{type(ended).__name__}: {ended}".removesuffix(": "),
            interrupted=isinstance(ended, KeyboardInterrupt),
            unfinished=getattr(ended, "failure", None),
            left_out=left_out,
            explained=explained,
            expected=expected,
            unexpected=unexpected,
            visited=self.visited.shares,
            decades=dict(self.visited.decades),
            examples=self.examples,
            seed=self.seed,
            unmeasured=self.visited.unmeasured,
            needs={c.name: c.needs for c in self.asked if c.needs},
            tried={name: {what: n for (by, what), n in self.tried.items() if by == name} for name, _ in self.tried},
            **self.counted,
        )

    def _told(self, failures: Iterable[Failure], known: Collection[str] = ()) -> list[Failure]:
        return diagnosed(failures, self.query, self._origin(), any(map(of_stress, self.found)), known)

    def _elsewhere(self, causes: list[Failure], explained: Sequence[Failure]) -> tuple[tuple[Failure, ...], tuple[Failure, ...]]:
        """The causes, with the regions in which each fails, and what they explain: not what has another cause in another region."""
        asked = [(c.check.name, *(c.explains if c.diagnoses and of_stress(c) else ())) for c in causes]
        looked = [f for f in (*causes, *explained) if f.alone and not f.check.law_only and not isnan(f.measured)]
        regions = {f.check.name: Regions(f.check) for f in looked if any(f.check.name in names for names in asked)}

        def seen(query: Query) -> None:
            for each in regions.values():
                with suppress(NothingToCheck, NoReply, Unfinished):
                    each.add(query)

        few = settings(self.profile, max_examples=min(_LOOKED_AT, self.profile.max_examples), phases=(Phase.generate,))
        if regions:
            self._least((), self._cases(self.parameters, self.stiffness, self.drawn.rows), few, seen)
        where = {name: str(each) for name, each in regions.items()}
        known, others = set().union(*map(_said_of, causes)), list[Failure]()
        for place, cause in enumerate(causes):
            if not of_stress(cause):  # of what is returned beside a wrong stress another region says nothing
                continue
            own = self.query(cause.case)  # of whose region the diagnosis is
            named = set[str]()
            with suppress(NoReply):
                named |= {*region_of(own, own.here).tolist()} if cause.diagnoses else set()
            worst = [(-each.failed[name], name, case, each.check) for each in map(regions.get, asked[place]) if each for name, case in each]
            for _, region, case, check in sorted(worst, key=lambda w: w[0])[:_ASKED]:
                again = () if region in named else self.failures(self.query(case), [check])
                for failure in self._told(again, known):
                    if (said := _said_of(failure)) and not known & said:
                        if causes[place].diagnoses:
                            others.append(replace(failure, where=regions[check.name].of(region)))
                        else:
                            causes[place] = replace(failure, explains=cause.explains)
                    named, known = named | ({region} if said else set()), known | said
        found, new = [*causes, *others], {f.check.name for f in others}
        told = (
            replace(f, where=f.where or where.get(f.check.name, ""), explains=tuple(n for n in f.explains if n not in new)) for f in found
        )
        return tuple(told), tuple(f for f in explained if f.check.name not in new)

    def _passing(self, failure: Failure) -> float | None:
        """The least power of ten as an accuracy at which the check passes at the increment, up to 1e-2."""
        if failure.check.whole or failure.check.law_only or not failure.alone:
            return None
        tried = (10.0**power for power in range(-14, -1) if 10.0**power > self.drawn.accuracy)
        return next((x for x in tried if not any(self.failures(self.query(failure.case, x), [failure.check]))), None)

    def _short(self, failure: Failure) -> Failure:
        """Return the failure with a case that is short to read, which is looked for once."""
        name = failure.check.name
        if name not in self.shortened:
            found = self._simplified(failure)
            self.shortened[name] = replace(found, passes_at=self._passing(found))
        short = self.shortened[name]
        return replace(short, explains=failure.explains, alone=short.alone and not needs_the_run(short.diagnoses))

    def _simplified(self, failure: Failure) -> Failure:
        """Return the failure on a case in round numbers, with those of its diagnoses that hold there.

        Where nothing is left to tell what the routine does instead, as without stress, it is shown under some stress; as it was found
        where none of its diagnoses holds there either.
        """
        enough, law = self.raised.times + RAISED, self.law

        def again(case: Case) -> Failure | None:
            return next(self.failures(self.query(case), [failure.check]), None)

        def fails(case: Case) -> bool:
            return self.raised.times <= enough and again(case) is not None

        if law is None or not failure.alone or len(failure.case) != 1 or not fails(failure.case):
            return failure
        own = law.domain.get(law.pressure or "")
        shorter = partial(
            simplified,
            admitted=admitted(law.fix(self.parameters)).holds,
            free=self.passed,
            stiffness=self.stiffness is None,
            pressure=None if self.drawn.pressure is not None else lambda p: p <= 0.0 and (own is None or p in own),
        )

        def on(case: Case) -> Failure:
            if (found := again(case)) is None:
                return failure
            found = replace(found, origin=failure.origin, departure=failure.departure and departure(self.query(case)))
            told = instead(found, self.query, any(map(of_stress, self.found))) if failure.diagnoses else {}
            return replace(found, diagnoses={name: told[name] for name in failure.diagnoses if name in told})

        short = on(shorter(failure.case, fails))
        if short.diagnoses or not failure.diagnoses or failure.check.name == _ANSWERS:  # what is no number is shown where it is none
            return short
        short = on(shorter(failure.case, lambda case: bool(case.trial.any()) and fails(case)))
        return short if short.diagnoses else failure


def _said_of(failure: Failure) -> set[str]:
    """What tells the diagnoses of a failure from others: their names, or, of what is so in one region alone, the words."""
    return {said.partition(IN_REGION)[0] if IN_REGION in said else name for name, said in failure.diagnoses.items()}


def _check_without_law(update: Update | Material, given: Mapping[str, Any]) -> None:
    """Raise InputError for what a material has itself, and where nothing says how many forces there are."""
    where = "conformance without a law"
    if isinstance(update, Material) and (told := [name for name, value in given.items() if value is not None]):
        remedy = "give its parameters where the material is made"
        raise InputError(f"a material contains its own {told[0]}", where=where, remedy=remedy)
    if not isinstance(update, Material) and given["stiffness"] is None:
        remedy = "give (d,) or (d, d), or a strategy such as stiffnesses(d)"
        raise InputError("without a law, the stiffness must give the number of forces", where=where, remedy=remedy)
