"""What pytest sees of duhem: criterion and scene files as tests, marked routines as tests, and the fixture of snapshots.

A file has a node a claim, or one for a run.  A marked routine has a node a check, and one for what it flags; one run serves all of them.
What cannot be asked is a test that errs: where a module or a run ended instead, the results of others would be hidden.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields
from functools import cached_property
from hashlib import sha256
from inspect import CO_ASYNC_GENERATOR, CO_COROUTINE, getattr_static, signature
from numbers import Real
from pathlib import Path
from types import FunctionType
from typing import Any, TypeAlias

import pytest

from duhem.errors import DuhemError, InputError
from duhem.law.catalogue import load
from duhem.law.curve_law import Law
from duhem.law.placed_toml import parsed, text_of
from duhem.path.scene import Scene
from duhem.path.scene_file import MOST_BYTES, reads
from duhem.path.simulate import parts
from duhem.proof.report import sentences
from duhem.proof.verdict import Verdict
from duhem.proof.verification import Verification, verify, wanted_claims
from duhem.show.page import Page
from duhem.testing.conformance import check_expected, checks_asked, conformance
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.strategies import RunOptions, check_share
from duhem.testing.failures.report import MET, PASSED, SKIPPED, UNMET, Report
from duhem.testing.routines import Update
from duhem.testing.snapshots import Entry, Project, SnapshotFile, differences, snapshot

__all__ = ["PROFILES", "TomlTests", "check_items", "checked", "compared", "names_of_checks"]

LookedInto: TypeAlias = Callable[[Scene], Scene]
"""As :func:`duhem.api.histories.looked_into`, which this room does not know."""


class TomlTests(pytest.File):
    """A criterion file or a scene; which of them, its tables say."""

    def __init__(self, *, looked_into: LookedInto, **whole: Any) -> None:
        super().__init__(**whole)
        self.looked_into = looked_into

    def collect(self) -> Iterator[pytest.Item]:
        try:
            text = text_of(self.path, "criterion or scene file", MOST_BYTES)
            document = parsed(text, str(self.path)).document
            if "criterion" in document:
                self.law = load(self.path)
                asked = self.config.getoption("--duhem-claims")
                named = None if asked is None else dict.fromkeys(name.strip() for name in asked.split(",") if name.strip())
                for claim in wanted_claims(named, self.law, "--duhem-claims"):
                    yield ClaimTest.from_parent(self, name=claim)
            elif "path" in document:
                scene = reads(text, str(self.path), self.path.parent)
                yield SceneTest.from_parent(self, name="simulate", scene=scene)
            else:
                remedy = "write a [criterion] (duhem init NAME) or a scene with a [path]"
                raise InputError("this is neither a criterion file nor a scene", where=f"{self.path}", remedy=remedy)
        except DuhemError as fault:
            yield UnusableTest.from_parent(self, name="read", said=str(fault))

    @cached_property
    def verification(self) -> Verification | DuhemError:
        """The verdicts on the claims that are selected, found once for all their nodes, or why there are none."""
        claims = [item.name for item in self.session.items if item.parent is self]
        try:
            return verify(self.law, claims=claims, effort=self.config.getoption("--duhem-effort"))
        except DuhemError as fault:
            return fault


class ClaimTest(pytest.Item):
    """Whether a claim is proved of a law."""

    parent: TomlTests

    def __init__(self, **whole: Any) -> None:
        super().__init__(**whole)
        group(self, self.parent.nodeid)

    def runtest(self) -> None:
        found = self.parent.verification
        if isinstance(found, DuhemError):
            pytest.fail(str(found), pytrace=False)
        result = found[self.name]
        told = result.to_dict()
        told |= {"witness": told["witness"] and json.dumps(told["witness"], sort_keys=True)}
        parts = ("verdict", "method", "scope", "trust", "witness")
        self.user_properties += [(f"duhem_{part}", told[part]) for part in parts if told[part] is not None]
        if result.verdict is Verdict.PROVED:
            return
        if result.verdict is Verdict.NOT_APPLICABLE:
            pytest.skip(result.detail)
        said = f"{self.parent.law.name}: {result.claim} is {result.verdict}: {result.detail}"
        said += "".join(f"\n  {line}" for sentence in sentences(result.witness) for line in Page(None).hanging(sentence))
        undecided = self.config.getoption("--duhem-undecided") or self.config.getini("duhem_undecided")
        if result.verdict is not Verdict.REFUTED and undecided == "xfail":
            pytest.xfail(said)
        pytest.fail(said, pytrace=False)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, None, f"{self.parent.law.name}: {self.name}"


class SceneTest(pytest.Item):
    """Whether a scene runs to its end without a step that is flagged; nothing is written."""

    parent: TomlTests

    def __init__(self, *, scene: Scene, **whole: Any) -> None:
        super().__init__(**whole)
        self.scene = scene
        group(self, self.parent.nodeid)

    def runtest(self) -> None:
        try:
            scene = self.parent.looked_into(self.scene)
            if scene.many:
                if ended := sum(part.ended_early() for part in parts(scene.batch(), scene.method, scene.threads)):
                    pytest.fail(f"{ended} points end early, at a step without a reliable answer or outside a declared range", pytrace=False)
                return
            history = scene.run()
        except DuhemError as fault:
            pytest.fail(str(fault), pytrace=False)
        self.user_properties += [("duhem_method", history.method), ("duhem_why", history.why)]

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, None, f"{self.path.name}: simulate"


# -- what the tests of duhem carry -------------------------------------------------------------------------------------


def group(item: pytest.Item, name: str) -> None:
    """Mark a test; with ``--dist loadgroup`` those of one ``name`` ask for one worker (xdist 3.8 splits them under pytest 9.2)."""
    item.add_marker("duhem")
    for mark in group_marks(item.config, name):
        item.add_marker(mark)


def group_marks(config: pytest.Config, name: str) -> list[pytest.MarkDecorator]:
    """Return the marker of a group; none without xdist, which alone knows it."""
    if not config.pluginmanager.hasplugin("xdist"):
        return []
    return [pytest.mark.xdist_group(re.sub(r"[][@]", "-", name))]  # xdist looks for brackets and @ itself


class UnusableTest(pytest.Item):
    """A marker or file of which no test can be made, and the line that says why."""

    def __init__(self, *, said: str, line: int | None = None, **whole: Any) -> None:
        super().__init__(**whole)
        self.said, self.line = said, line
        group(self, self.nodeid)

    def setup(self) -> None:
        pytest.fail(self.said, pytrace=False)

    def runtest(self) -> None:
        """There is nothing to run."""

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, self.line, self.name


# -- one routine with what its marker asks ----------------------------------------------------------------------------

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
        return f"duhem/cases/{sha256(asked.encode()).hexdigest()[:24]}"

    @cached_property
    def _kept(self) -> dict[str, Case]:
        cache = getattr(self.config, "cache", None)  # there is none with -p no:cacheprovider
        kept: dict[str, Case] = {}
        for name, given in (cache.get(self._key, None) or {}).items() if cache is not None else ():
            with suppress(KeyError, TypeError, ValueError):  # what another version has kept
                kept[name] = Case(**given)
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


# -- the fixture duhem_snapshot ----------------------------------------------------------------------------------------

_LONGEST = 100


def compared(request: pytest.FixtureRequest, project: Project) -> Callable[..., Entry]:
    """A function that compares a law, or keeps it where ``--duhem-update`` is given, and returns what was found.

    The file is of the test with its classes, ``snapshots/test_m/TestX.test_a.json``, and an entry of the law with the values it
    is given and the claims that are named.  The tolerance that the file states stays when it is written again.
    """
    test = request.node
    folder = test.path.parent / "snapshots" / test.path.stem
    classes = [each.name for each in test.listchain() if isinstance(each, pytest.Class)]
    file = folder / f"{_short('.'.join([*classes, test.name]))}.json"
    update = bool(test.config.getoption("--duhem-update"))
    asked: dict[str, Entry] = {}

    def compare(law: Law | str | Path, parameters: Mapping[str, Any] | None = None, claims: Iterable[str] | None = None) -> Entry:
        __tracebackhide__ = True
        named = (claims,) if isinstance(claims, str) else None if claims is None else tuple(claims)
        key = _key(load(law).name, parameters, named)
        shown = os.path.relpath(file, test.config.rootpath)
        kept, lacking = SnapshotFile(), ""
        try:
            kept = SnapshotFile.read(file)
            entry = {} if update else kept.entry(key, file)
        except DuhemError as fault:
            lacking = fault.what
        if update:  # the tolerance is the owner's to change; that of a new file where it cannot be read
            asked[key] = snapshot(law, project, parameters, claims=named)
            file.parent.mkdir(parents=True, exist_ok=True)
            SnapshotFile(asked, kept.tolerance).write(file)
            return asked[key]
        if lacking:  # told outside: what was raised names an option of the command, and pytest would show both
            pytest.fail(f"{key}: {shown}: {lacking}; check the results and store them with --duhem-update", pytrace=False)
        now = snapshot(law, project, parameters, claims=named, increments=entry["increments"])
        if lines := differences(entry, now, kept.tolerance):
            head = f"{key} is not as {shown} has it; if this is intended, store it with --duhem-update"
            pytest.fail("\n  ".join([head, *lines]), pytrace=False)
        return now

    return compare


def _short(name: str) -> str:
    """A name as every file system takes it; what is cut off of a long one still tells it from others."""
    plain = re.sub(r"[^A-Za-z0-9_.=+-]+", "-", name).strip("-")
    return plain if len(plain) <= _LONGEST else f"{plain[: _LONGEST - 9]}-{sha256(name.encode()).hexdigest()[:8]}"


def _key(name: str, parameters: Mapping[str, Any] | None, claims: Iterable[str] | None) -> str:
    """A law with what it is given and asked, whatever the order: ``orthotropic, mu_a = 0.2, mu_b = 0.1, claims convexity origin``."""
    values = ((each, float(value) if isinstance(value, Real) else value) for each, value in (parameters or {}).items())
    asked = [] if claims is None else [" ".join(["claims", *sorted({*map(str, claims)})])]
    return ", ".join([name, *sorted(f"{each} = {value}" for each, value in values), *asked])
