"""A marked routine as tests: a node a check, and one for what it flags; one run for all of them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields
from functools import cached_property
from inspect import CO_ASYNC_GENERATOR, CO_COROUTINE, getattr_static, signature
from pathlib import Path
from types import FunctionType
from typing import Any

import pytest

from duhem.errors import DuhemError
from duhem.law.catalogue import load
from duhem.testing.conformance import check_expected, checks_asked, conformance
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.options import RunOptions, check_share
from duhem.testing.failures.report import MET, PASSED, SKIPPED, UNMET, Report
from duhem.testing.in_pytest.collected_files import UnusableTest, group, group_marks
from duhem.testing.routines.routine import Update

__all__ = ["PROFILES", "check_items", "checked", "names_of_checks"]

# as the arguments of :func:`duhem.testing.conformance`: cases of some 30 increments, and the seed where they repeat themselves;
# those of duhem test
PROFILES: dict[str, dict[str, Any]] = {
    "dev": {"max_examples": 30},
    "ci": {"max_examples": 100, "seed": 0},
    "deep": {"max_examples": 2000},
}


FLAGGED = "flagged"  # the node that says how many increments the routine gives up
_TAKES = tuple(name for name in signature(conformance).parameters if name not in ("update", "first"))
_REMEDY = 'write for example @pytest.mark.duhem(law="coulomb", parameters={"mu": 0.3})'
_ROUTINES = pytest.StashKey[dict[str, "Trial"]]()


class Trial:
    """One routine with what its marker asks; :meth:`outcome` of a node comes from one run of all that are selected."""

    def __init__(self, node: str, marker: pytest.Mark, config: pytest.Config) -> None:
        given = dict(zip(_TAKES, marker.args, strict=False)) | dict(marker.kwargs)
        if unknown := [key for key in given if key not in _TAKES]:
            raise _unusable(node, f"the marker duhem takes no {unknown[0]!r}", f"it takes {', '.join(_TAKES)}")
        if "law" not in given:
            raise _unusable(node, "the marker duhem names no law", _REMEDY)
        self.node, self.config, self.law, self.parameters = node, config, given["law"], given.get("parameters")
        self.expected, of_states = given.pop("expected_failed_checks", None), given.get("state") is not None
        try:
            check_share(given.setdefault("most_flagged", 0.0), "most_flagged")
            known = None if self.law is None else load(self.law)
            asked = checks_asked(known, given.pop("checks", None), of_states)
            check_expected(known, self.expected, of_states)
            if known is not None:
                known.fix(self.parameters)
            drawn = {each.name: given[each.name] for each in fields(RunOptions) if each.name in given}
            RunOptions(**drawn).check(None if of_states else known)
        except DuhemError as fault:
            raise _unusable(node, f"{fault}", "") from None
        if besides := {*(self.expected or ())} - {each.name for each in asked}:
            raise _unusable(node, f"{min(besides)} is expected to fail, but is not selected", "name it in checks")
        self.asked = {each.name: each for each in asked}
        self.options = given | PROFILES.get(config.getoption("--duhem-profile") or "", {})
        self.selected = list(self.asked)
        self._outcome: Report | DuhemError | None = None

    @property
    def nodes(self) -> list[str]:
        """The checks, and what is flagged."""
        return [*self.asked, FLAGGED]

    def report(self, update: Update) -> Report:
        """Return the report of all checks that are selected; the routine is run once."""
        if self._outcome is None:
            if asked := {*self.selected} & {*self.asked}:
                asked |= {*(self.expected or ())}  # one that fails explains others, though its node be left out
            checks = [each for name, each in self.asked.items() if name in asked] or list(self.asked.values())
            told = {"checks": checks, "expected_failed_checks": self.expected, "first": [*self._kept.values()]}
            try:
                self._outcome = conformance(update=update, **self.options, **told)
            except DuhemError as fault:
                self._outcome = fault
            else:
                self._keep(self._outcome)
        if isinstance(self._outcome, DuhemError):
            pytest.fail(f"{self.node}: {self._outcome}", pytrace=False)
        if self._outcome.interrupted:
            raise KeyboardInterrupt
        if self._outcome.ended:
            again = "" if self._outcome.unfinished is None else f"\nto see it again:\n{self._outcome.unfinished.reproducer()}"
            pytest.fail(f"{self.node}: {self._outcome.ended}{again}", pytrace=False)
        return self._outcome

    def fails(self, update: Update) -> bool:
        """Return whether one of the selected nodes fails."""
        report = self.report(update)
        unexpected = any(name in self.selected for name in report.unexpected)
        return bool(report.failures) or unexpected or (FLAGGED in self.selected and report.flags_too_many)

    def judge(self, node: str, update: Update, properties: list[tuple[str, object]]) -> Report:
        """Pass, fail, skip or xfail as one node says."""
        report = self.report(update)
        properties += self._properties(node, report)
        failure, cause, (how, why) = report.failure_of(node), report.cause_of(node), report.outcomes().get(node, (PASSED, ""))
        if node == FLAGGED and report.flags_too_many:
            pytest.fail(f"{self.node} {report.flags()}", pytrace=False)
        if how == MET:
            pytest.xfail(why)
            pytest.fail(f"{self.node}: {node} fails, as expected: {why}", pytrace=False)  # with --runxfail
        if how == UNMET:
            reason = f"{node} passes, but was expected to fail: {why}"
            pytest.fail(f"{self.node}: {reason}; remove it from expected_failed_checks", pytrace=False)
        if failure is not None:
            explained = f"{failure.title}: {failure.message}\n  likely for the same reason as [{cause}]"
            pytest.fail(explained if cause else str(failure), pytrace=False)
        if how == SKIPPED:
            pytest.skip(why)
        return report

    def _properties(self, node: str, report: Report) -> Iterator[tuple[str, object]]:
        failure = report.failure_of(node)
        refuted = report.flags_too_many if node == FLAGGED else node in report.failed
        yield "duhem_law", report.law
        yield "duhem_verdict", "refuted" if refuted else "undecided" if node in report.left_out else "tested"
        yield "duhem_method", "drawn cases"
        yield "duhem_seed", str(report.seed)
        yield "duhem_examples", str(report.examples)
        yield "duhem_flagged", f"{report.flagged} of {report.points}"
        yield "duhem_most_flagged", f"{report.most_flagged:g}"
        if failure is not None:
            yield "duhem_measured", repr(failure.measured)
            yield "duhem_allowed", repr(failure.allowed)
            yield "duhem_witness", json.dumps(failure.case.plain(), sort_keys=True)

    # -- failing cases are kept, and tried first -----------------------------------------------------------------------

    @property
    def _key(self) -> str:
        asked = repr((self.node, self.law, self.parameters, sorted(self.options.items())))
        return f"duhem/cases/{hashlib.sha256(asked.encode()).hexdigest()[:24]}"

    @cached_property
    def _kept(self) -> dict[str, Case]:
        cache = getattr(self.config, "cache", None)  # there is none with -p no:cacheprovider
        kept: dict[str, Case] = {}
        for name, parts in (cache.get(self._key, None) or {}).items() if cache is not None else ():
            with suppress(KeyError, TypeError, ValueError):  # what another version has kept
                kept[name] = Case(**parts)
        return kept

    def _keep(self, report: Report) -> None:
        """Keep the cases that fail now, and those of checks that did not run."""
        if getattr(self.config, "cache", None) is None or self.law is None:
            return
        ran = {*report.passed, *report.failed, *report.left_out}
        failing = {f.check.name: f.case for f in (*report.failures, *report.explained) if f.check.whole is None}
        cases = {name: case for name, case in self._kept.items() if name not in ran} | failing
        if cases or self._kept:
            self.config.cache.set(self._key, {name: case.plain() for name, case in cases.items()})


def _unusable(node: str, what: str, remedy: str) -> pytest.Collector.CollectError:
    return pytest.Collector.CollectError(f"{node}: {what}" + (f"; {remedy}" if remedy else ""))


# -- a marked function ---------------------------------------------------------------------------------------------------


class CheckTest(pytest.Item):
    """One check of a routine."""

    def __init__(self, *, trial: Trial, check: str, update: Callable[[], Update], function: FunctionType, **whole: Any) -> None:
        super().__init__(**whole)
        self.trial, self.check, self.update, self.function = trial, check, update, function
        marks = [mark for mark in function.pytestmark if mark.name != "duhem"]  # type: ignore[attr-defined]
        self.of_the_whole = [mark for mark in marks if mark.name == "xfail" and mark.kwargs.get("run", True)]
        self.own_markers += [mark for mark in marks if mark not in self.of_the_whole]
        group(self, trial.node)

    def runtest(self) -> None:
        self.trial.selected = [i.check for i in self.session.items if isinstance(i, CheckTest) and i.trial is self.trial]
        update = self.update()
        try:
            self.trial.judge(self.check, update, self.user_properties)
        except pytest.fail.Exception:
            self._expected_to_fail()
            raise
        if self.of_the_whole and not self.trial.fails(update):
            self._expected_to_fail()

    def _expected_to_fail(self) -> None:
        """The routine's xfail, which says that some check fails, is that of a check that does, and of all where none does."""
        for mark in self.of_the_whole:
            self.add_marker(pytest.mark.xfail(*mark.args, **mark.kwargs))

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, self.function.__code__.co_firstlineno - 1, self.name


def check_items(
    collector: pytest.Module | pytest.Class, name: str, function: FunctionType, marks: Sequence[pytest.Mark]
) -> list[pytest.Item]:
    """Return the nodes of a marked function; a marker that cannot be used has one node, which errs."""

    def update() -> Update:
        if isinstance(collector, pytest.Class):
            return getattr(collector.newinstance(), name)  # type: ignore[no-untyped-call]
        return function

    items: list[pytest.Item] = []
    for place, mark in enumerate(reversed(marks)):  # from the top down, as they are written
        try:
            trial = Trial(f"{collector.nodeid}::{name}", mark, collector.config)
            if fault := _needs_pytest(function, collector, trial):
                remedy = "use the fixture duhem_check in a test that makes the routine: def test_it(duhem_check): duhem_check(update)"
                raise _unusable(trial.node, fault, remedy)
        except pytest.Collector.CollectError as unusable:
            which, line = f"{name}[{place}]" if place else name, function.__code__.co_firstlineno - 1
            items.append(UnusableTest.from_parent(collector, name=which, said=str(unusable), line=line))
            items[-1].own_markers += [each for each in function.pytestmark if each.name in ("skip", "skipif")]  # type: ignore[attr-defined]
            continue
        law = f"{getattr(trial.law, 'name', trial.law)}-" if len(marks) > 1 else ""
        trial.node += f"[{law.removesuffix('-')}]" if law else ""
        for node in trial.nodes:
            whole = f"{name}[{law}{node}]"
            named = {"name": whole, "nodeid": f"{collector.nodeid}::{whole}"}  # as pytest names parameters, so that --lf knows it again
            items.append(CheckTest.from_parent(collector, **named, trial=trial, check=node, update=update, function=function))
    return items


def _needs_pytest(function: FunctionType, collector: pytest.Module | pytest.Class, trial: Trial) -> str:
    """Return why a marked function cannot be called as an update routine, as it takes what only a test is given; "" where it can."""
    if function.__code__.co_flags & (CO_COROUTINE | CO_ASYNC_GENERATOR):
        return "it is async, but an update routine must return the stress directly"
    own = [mark.name for mark in (*function.pytestmark, *collector.iter_markers())]  # type: ignore[attr-defined]
    if "parametrize" in own:
        return "it is parametrised, which is not possible for an update routine"
    takes = list(signature(function, follow_wrapped=False).parameters.values())
    if isinstance(collector, pytest.Class) and not isinstance(getattr_static(collector.obj, function.__name__, None), staticmethod):
        takes = takes[1:]
    if any(p.kind is p.VAR_POSITIONAL for p in takes):
        return ""
    in_order = [p for p in takes if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    if len(in_order) < 3:
        return f"it takes ({', '.join(p.name for p in in_order)}), but an update routine takes (trial, pressure, stiffness)"
    besides = [p.name for p in takes if p not in in_order[:3] and p.default is p.empty and p.kind is not p.VAR_KEYWORD]
    given = (trial.parameters or {}) if trial.law is None else load(trial.law).parameters
    return next((f"there is no value for its argument {name!r}" for name in besides if name not in given), "")


# -- a test that hands its routine over ----------------------------------------------------------------------------------


def names_of_checks(definition: pytest.Item) -> list[Any]:
    """Return what parametrises the fixture ``duhem_check``: nodes, or one that says what is wrong with the marker."""
    marks = group_marks(definition.config, definition.nodeid)
    try:
        nodes = _trial(definition, definition.nodeid).nodes
    except pytest.Collector.CollectError as fault:
        return [pytest.param(fault, marks=marks, id="marker")]
    return [pytest.param(node, marks=marks, id=node) for node in nodes]


def checked(request: pytest.FixtureRequest) -> Callable[..., Report]:
    """Return the function that a test with a marker hands its routine to."""
    item = request.node
    if isinstance(request.param, pytest.Collector.CollectError):
        pytest.fail(str(request.param), pytrace=False)
    key = _shared(item)
    trials = item.config.stash.setdefault(_ROUTINES, {})
    if key not in trials:
        trials[key] = _trial(item, key)
        trials[key].selected = [i.callspec.params["duhem_check"] for i in item.session.items if _shared(i) == key]

    def check_routine(update: Update) -> Report:
        __tracebackhide__ = True
        return trials[key].judge(request.param, update, item.user_properties)

    return check_routine


def _trial(item: pytest.Item, node: str) -> Trial:
    marker = item.get_closest_marker("duhem")
    if marker is None:
        raise _unusable(node, "the fixture duhem_check needs the marker duhem", _REMEDY)
    return Trial(node, marker, item.config)


def _shared(item: pytest.Item) -> str:
    """Return what the nodes of one routine have in common: all but the check."""
    call = getattr(item, "callspec", None)
    if call is None or "duhem_check" not in call.params:
        return ""
    others: Mapping[str, int] = {name: index for name, index in call.indices.items() if name != "duhem_check"}
    listed = "-".join(f"{name}{index}" for name, index in sorted(others.items()))
    return item.nodeid.partition("[")[0] + (f"[{listed}]" if listed else "")
