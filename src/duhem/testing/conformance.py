"""The conformance suite: every check of a routine, a check on one case, duhem's own routines, and what a campaign asks of each row."""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from dis import opmap
from functools import wraps
from inspect import Parameter, signature, unwrap
from pathlib import Path
from time import monotonic
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import DuhemError, InputError, meant
from duhem.law.catalogue import attribute, load, load_formula
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.law.state import check_stateless
from duhem.projection.increment import check_associated
from duhem.projection.methods import METHODS
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Status
from duhem.proof.facts.formula_subject import admitted_values
from duhem.testing.checks import law_checks, material_checks  # noqa: F401 (they register their checks)
from duhem.testing.checks.law_in_state import Places
from duhem.testing.checks.query import NoReply
from duhem.testing.checks.registry import Check, judged, registered
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.strategies import ACCURACY, TRIES, RunOptions, check_share
from duhem.testing.drawn.values import Strategy
from duhem.testing.failures.report import FAILED, MET, PASSED, SKIPPED, UNMET, Report
from duhem.testing.routines import Material, Step, Update, law_as_written, named
from duhem.testing.run import ConformanceRun

__all__ = [
    "ACCURACY", "PROMISED", "RoutineChecks", "assert_conforms", "check", "check_expected", "checks_asked", "checks_for", "conformance",
    "every_check", "own_solvers", "projection", "violation",
]  # fmt: skip

_Law = Criterion | str | Path | None


def checks_for(law: _Law, *, associated: bool = False) -> tuple[Check, ...]:
    """Return the checks that a routine for ``law`` has to pass; those that only some laws satisfy run only if you name them.

    For None, those that need no law; ``associated``, with those that only associated laws, and some only those without
    hardening, satisfy.
    """
    if law is not None:
        load(law)
    return tuple(c for c in every_check(law) if c.demanded or (law is None and associated))


def every_check(law: _Law, of_states: bool = False) -> tuple[Check, ...]:
    """Return all checks of a law, or those that need none, among them the ones that run only when they are named.

    ``of_states``: those of a material and a law of which it keeps the state.
    """
    return tuple(registered(law is not None, of_states).values())


def check(name: str) -> Check:
    """Return a check by its name.  Raises InputError for an unknown one."""
    return _named(name, of_a_law=True)


def _named(name: str, of_a_law: bool, of_states: bool = False, where: str = "") -> Check:
    known = registered(of_a_law, of_states)
    if name not in known:
        remedy = meant(name, known, f"choose one of {', '.join(known)}", both=True)
        raise InputError(f"unknown check {name!r}", where=where or ("" if of_a_law else "without a law"), remedy=remedy)
    return known[name]


def checks_asked(
    law: _Law, checks: Iterable[Check | str] | Check | str | None, of_states: bool = False, where: str = ""
) -> tuple[Check, ...]:
    """Return the checks that ``checks`` name, of a law or of none; without ``checks``, return all that are demanded.

    InputError for one that there is not, for what names none, and where none is asked for: nothing would be tested.
    """
    if checks is None:
        return tuple(c for c in every_check(law, of_states) if c.demanded)
    place, remedy = where or "checks", 'name some, for example "feasibility", or omit it to run all'
    if not isinstance(checks, str | Check | Iterable):
        raise InputError(f"{checks!r} names no checks", where=place, remedy=remedy)
    named = (checks,) if isinstance(checks, str | Check) else tuple(checks)
    if not named:
        raise InputError("no check is selected", where=place, remedy=remedy)
    if wrong := [each for each in named if not isinstance(each, str | Check)]:
        raise InputError(f"{wrong[0]!r} is no check", where=place, remedy=remedy)
    found = tuple(_named(each, law is not None, of_states, where) if isinstance(each, str) else each for each in named)
    if wrong := [each.name for each in found if not each.applies(law is not None, of_states)]:
        remedy = "name others; the marker of a material that is held to a law takes its state too"
        raise InputError(f"the check {wrong[0]} is not for such a routine", where=place, remedy=remedy)
    return found


def check_expected(law: _Law, expected: Mapping[str, str] | None, of_states: bool = False, where: str = "") -> None:
    """Raise InputError unless ``expected`` maps names of checks to the reasons why they fail."""
    if expected is None:
        return
    if not isinstance(expected, Mapping) or not all(isinstance(each, str) for pair in expected.items() for each in pair):
        remedy = 'give each check with its reason, for example {"slope": "no tangent yet"}'
        raise InputError(f"{expected!r} does not map checks to reasons", where=where or "expected_failed_checks", remedy=remedy)
    for name in expected:
        _named(name, law is not None, of_states, where)


def violation(
    name: str | Check,
    law: _Law,
    update: Update | Material,
    case: Case,
    *,
    open_parameters: Iterable[str] | None = None,
    accuracy: float = ACCURACY,
    parameters: Mapping[str, Any] | None = None,
    state: Places | None = None,
) -> str | None:
    """Return what one check finds wrong with the routine's answer to one case, or None; ``open_parameters`` are passed to it by name.

    ``parameters`` and ``state`` are those with which a material is held to a law (:func:`conformance`).
    """
    material = isinstance(update, Material)
    asked = (name if isinstance(name, Check) else _named(name, law is not None, law is not None and material),)
    stiffness = case.stiffness if law is None and not material else None
    told: dict[str, Any] = {"accuracy": accuracy, "state": state, "every": 1, "stiffness": stiffness}  # the case has the law's values
    run = ConformanceRun(_loaded(law, update), update, parameters if material else None, asked, **told)
    run.passed = tuple(case.parameters) if open_parameters is None else tuple(open_parameters)
    try:
        found = judged(*asked, run.query(case))
    except NoReply as fault:
        return str(fault)
    return None if found is None else found[1]


def conformance(
    law: _Law,
    update: Update | Material,
    parameters: Mapping[str, Any] | None = None,
    *,
    stiffness: ArrayLike | Strategy | None = None,
    pressure: float | Strategy | None = None,
    checks: Iterable[Check | str] | Check | str | None = None,
    accuracy: float = ACCURACY,
    max_examples: int | None = None,
    rows: int = 30,
    every: int | None = None,
    tries: int = TRIES,
    seconds: float | None = None,
    seed: int | None = None,
    expected_failed_checks: Mapping[str, str] | None = None,
    first: Iterable[Case] = (),
    most_flagged: float | None = None,
    state: Places | None = None,
    largest_strain: float | None = None,
    scale: float | None = None,
) -> Report:
    """Run every check on an update routine for ``law``, on cases that Hypothesis draws and simplifies if a check fails.

    ``update(trial (N, d), pressure (N,), stiffness (d, d), **open)`` returns the stress (N, d) in Pa or a :class:`Step`.  The pressure
    is None for a law without pressure.  ``open`` are the parameters that ``parameters`` does not fix; they are drawn from their
    domains. :func:`pointwise` and :func:`from_displacements` adapt routines with other arguments.  ``stiffness`` and ``pressure`` are
    fixed values or strategies; by default they are drawn.  ``accuracy`` is the relative error of the stress that the routine may have;
    every tolerance follows from it (:attr:`Check.tolerance`).  ``max_examples`` is the number of cases (default: that of the Hypothesis
    profile), with about ``rows`` increments each.  Some checks call the routine again, with its own answer or beside an increment
    (:attr:`Check.again`); they do this for one increment in ``every`` (default 7, without a law 2).  ``tries`` is the maximum number of
    attempts to simplify a failure; ``seconds`` also limits its time, but then the report may depend on the load of the machine.
    ``seed`` is that of the cases; by default it is random, unless the profile is derandomised, and the report names it.
    ``expected_failed_checks`` maps the checks that you expect to fail to reasons; if one of them passes, the report is not ``ok``.
    Name only the cause: checks that it explains (:mod:`duhem.testing.failures.diagnosis`) may fail too.  ``first`` are cases that are
    tried first, for example those that failed before; a case that does not fit the law and its parameters is ignored.  The law is taken
    to be associated. ``most_flagged`` is the maximum fraction of increments that the routine may flag as not solved (default:
    unlimited); with more of them, the report is not ``ok``.

    Without a law (None), ``update`` is such a routine, with ``stiffness`` (d,), (d, d) or a strategy, ``parameters`` that are numbers
    or strategies, all passed by name, and ``pressure``, which is None for a routine without pressure; or ``update`` is a
    :class:`Material`, which contains its own.  Then the checks that need no law run.

    With a law and a :class:`Material` the checks without a law run, and those of the law's implicit step at the state that the material
    keeps.  ``state`` maps the law's internal variables, or formulas of its variables and forces, to their places in that state, counted
    from 0: ``{"p": 0, "X": slice(7, 13)}``, where X stands for the variables X_xx, ... in the order of the material's components.  Slips
    need no place.  ``parameters`` are then all of the law's, and the temperature, one or several, of a law that has one.  Of materials
    and of routines without a law ``scale`` is the size of the elastic range as a strain (by default it is looked for), and
    ``largest_strain`` bounds every increment (default: 100 times the typical elastic strain).

    A failing check is data in the report and not an exception: see :func:`assert_conforms`.  So is an interrupt, and a
    routine that does not come back (:attr:`Report.ended`), with what was found before.  Raises InputError for invalid arguments:
    no check, an accuracy that is not between 0 and 1, a count below 1, a stiffness that is not symmetric and positive definite, a
    pressure > 0 (sigma_n <= 0 in compression).
    """
    if not isinstance(update, Material) and state is not None:
        raise InputError("the routine keeps no state", where="state", remedy="give a Material, such as duhem.testing.foreign.umat(...)")
    known, of_states = _loaded(law, update), law is not None and isinstance(update, Material)
    asked = checks_asked(known, checks, of_states)
    check_expected(known, expected_failed_checks, of_states)
    if most_flagged is not None:
        check_share(most_flagged, "most_flagged")
    drawn = {"stiffness": stiffness, "pressure": pressure, "max_examples": max_examples, "rows": rows, "every": every, "seed": seed}
    drawn |= {"largest_strain": largest_strain, "scale": scale}
    told: dict[str, Any] = {"accuracy": accuracy, "tries": tries, "seconds": seconds, "expected": expected_failed_checks, "given": law}
    run = ConformanceRun(known, update, parameters, asked, state=state, **told, **drawn)  # type: ignore[arg-type]
    return replace(run.outcome(first), most_flagged=most_flagged)


def _loaded(law: _Law, update: Update | Material) -> Criterion | None:
    """Return the law, or None.  Raise InputError for a law with a state if the routine keeps none."""
    if law is None or isinstance(update, Material):
        return None if law is None else load_formula(law)
    if isinstance(known := load(law), Criterion):
        check_stateless(known, "a test of single increments")
    return known


def assert_conforms(
    law: _Law,
    update: Update | Material,
    parameters: Mapping[str, Any] | None = None,
    *,
    most_flagged: float = 0.0,
    **options: Any,
) -> Report:
    """Run :func:`conformance`; raise AssertionError with the shrunk cases if a check fails or more than ``most_flagged`` is flagged."""
    report = conformance(law, update, parameters, most_flagged=most_flagged, **options)
    if not report.ok:
        raise AssertionError(str(report))
    return report


# -- duhem's own routines ----------------------------------------------------------------------------------------------


def projection(law: Criterion | str | Path, method: str = "auto", *, tangent: bool = False) -> Update:
    """Return duhem's own routine for ``law`` (:func:`duhem.project`); flagged points count as not solved.

    InputError for a law with a flow of its own, which has no such routine.
    """
    check_associated(load(law))

    def update(trial: Array, pressure: Array | None, stiffness: Array, **parameters: Any) -> Step:
        found = Projector.of(law, stiffness, parameters, method)(trial, pressure, tangent)
        solved: NDArray[np.bool_] = found.status <= Status.SLIP
        return Step(found.stress, found.slip, found.multiplier, found.tangent, solved)

    update.__qualname__ = f"projection.{method}"
    if named := law_as_written(load(law), law):
        again = f"update = projection({named}, {method!r}, tangent={tangent!r})"
        names = "from duhem import load\n" if named.startswith("load(") else ""
        if names or not named.startswith("Criterion("):
            update.__duhem_import__ = f"{names}from duhem.testing import projection\n\n{again}"  # type: ignore[attr-defined]
    return update


PROMISED = {"cvxpy": 1e-6}  # relative errors in stress of methods that are less accurate than others: the root of a solver's gap


def own_solvers(law: Criterion) -> Iterator[tuple[str, Update | str]]:
    """Yield duhem's own methods by name, each with its routine, or with the reason why it does not take the law.

    InputError for a law with a flow of its own, which none takes.
    """
    check_associated(law)
    check_stateless(law, "a test of single increments")
    point = admitted_values(law) or {}
    values = {name: point[name] for name, domain in law.parameters.items() if domain.value is None and name in point}
    for method in METHODS:
        try:
            Projector.of(law, 1.0, values, method)
        except InputError as reason:
            yield method, str(reason)
        else:
            yield method, _answering(projection(law, method))


def _answering(routine: Update) -> Update:
    """Return the routine, which flags increments as not solved at parameters to which its method does not apply."""

    @wraps(routine)
    def update(trial: Array, pressure: Array | None, stiffness: Array, **parameters: float) -> Any:
        try:
            return routine(trial, pressure, stiffness, **parameters)
        except InputError:
            return Step(np.full_like(trial, np.nan), solved=np.zeros(len(trial), dtype=np.bool_))

    return update


# -- what a campaign asks of each of its rows --------------------------------------------------------------------------


_SOLVED = "solved"
_Line: TypeAlias = tuple[str, str | None, str | None, str | None, str | None, int, float]


class _NoMemory(BaseException):
    """The routine got no memory, which says something of the limit and not of the routine; no Exception, which would be its answer.

    ``stated``: a statement of Python raised it, and no lack that was met before.
    """

    def __init__(self, fault: MemoryError) -> None:
        last = fault.__traceback__
        while last is not None and last.tb_next is not None:
            last = last.tb_next
        raises = last is not None and last.tb_frame.f_code.co_code[last.tb_lasti] == opmap["RAISE_VARARGS"]
        self.stated = raises and fault.__context__ is None


@dataclass(frozen=True)
class RoutineChecks:
    """Ask of each row whether one routine conforms to its law: ``duhem.campaign(..., ask=RoutineChecks(update))``.

    ``routine`` is what :func:`duhem.testing.conformance` takes, in a module that another process can import, or its name
    ``module:callable``, which goes to those processes in its place.  A value that the row fixes goes to it too, by name, where it has an
    argument of that name.  ``checks`` are names, all that are demanded if left out;
    ``examples`` cases are drawn by ``seed``, the same in every run.  ``accuracy``, ``shrink`` (tries to make a failing case smaller),
    ``expect`` (pairs of a check known to fail and the reason) and ``most_flagged`` are those of ``duhem test``.

    A line a check: ``passed`` or ``failed``; ``xfailed`` and ``xpassed`` of those expected to fail; ``not_applicable`` where nothing was
    there to judge.  One line more, ``solved``: no more than the share ``most_flagged`` is flagged by the routine as not solved, where it
    answered any.  The witness of a failure has its increment in round numbers, by how much the check is violated, and what the routine
    likely does instead; ``steps`` are the increments that the routine was asked for in the row, ``seconds`` the row's in equal shares.

    Raises InputError for options that cannot be used.
    """

    routine: Update | str
    checks: tuple[str, ...] | None = None
    examples: int = 30
    seed: int = 0
    accuracy: float = ACCURACY
    most_flagged: float = 0.0
    shrink: int = TRIES
    expect: tuple[tuple[str, str], ...] = ()

    def __post_init__(self) -> None:
        self._found()
        for name, given, least in (("examples", self.examples, 1), ("seed", self.seed, 0), ("shrink", self.shrink, 0)):
            if not isinstance(given, int) or isinstance(given, bool) or given < least:
                raise InputError(f"{name} = {str(given)[:40]}", where=name, remedy=f"give a whole number >= {least}")
        RunOptions(accuracy=self.accuracy).check(None)
        check_share(self.most_flagged, "most_flagged")
        if self.checks is not None:
            checks_asked(_ANY, self.checks, where="checks")
        if not isinstance(self.expect, tuple) or not all(isinstance(pair, tuple) and len(pair) == 2 for pair in self.expect):
            remedy = 'give each check with its reason, for example slope = "no tangent yet"'
            raise InputError(f"{str(self.expect)[:40]} does not map checks to reasons", where="expect", remedy=remedy)
        check_expected(_ANY, dict(self.expect), where="expect")

    @property
    def names(self) -> tuple[str, ...]:
        return (*dict.fromkeys(check.name for check in checks_asked(_ANY, self.checks)), _SOLVED)

    @property
    def options(self) -> tuple[str, ...]:
        """The options that the command line names beside the campaign."""
        return (f"--routine={self._named()}",)

    @property
    def alone(self) -> bool:
        """A routine may keep what it was called with first, and a campaign asks each row of a process of its own."""
        return True

    def told(self) -> str:
        """All that is asked, and a digest of the file of the routine's module: another routine is another campaign."""
        options = [self.names, self.examples, self.seed, self.accuracy, self.most_flagged, self.shrink, self.expect]
        return f"checks {json.dumps(options)} of {self._named()} {_digest(self._found())}"

    def _named(self) -> str:
        return self.routine if isinstance(self.routine, str) else ":".join(named(self.routine).rsplit(".", 1))

    def _found(self) -> Update:
        found = attribute(self.routine, self.routine) if isinstance(self.routine, str) else self.routine
        if isinstance(found, Material) or not callable(found):
            what = f"{str(self.routine)[:60]} is a {type(found).__name__}, no routine for a law"
            raise InputError(what, where="routine", remedy=_ROUTINE)
        return found

    def answers(self, law: Law) -> Iterator[_Line]:
        """Return a line for each name; raise InputError where the law cannot be asked."""
        began = monotonic()
        try:
            with _own_constants_left_out():
                known, drawn = load_formula(law), {"max_examples": self.examples, "tries": self.shrink, "seed": self.seed}
                checks: dict[str, Any] = {"checks": self.checks, "expected_failed_checks": dict(self.expect), **drawn}
                report = conformance(known, _bound(self._found(), known), accuracy=self.accuracy, **checks)
                if report.ended:
                    raise DuhemError(report.ended)
        except _NoMemory as fault:
            if fault.stated:
                raise DuhemError("the routine raises MemoryError by a statement of its own") from None
            raise MemoryError from None
        each = round((monotonic() - began) / len(self.names), 6)
        for name in self.names:
            verdict, said = self._of(name, report)
            yield name, verdict, None, None, None if said is None else json.dumps(said), report.points, each

    def _of(self, name: str, report: Report) -> tuple[str, dict[str, Any] | None]:
        """Return the verdict on a check, and the text beside it."""
        if name == _SOLVED and report.points == 0:
            return "not_applicable", {"reason": "no increment was answered"}
        if name == _SOLVED:
            counted = {"increments": report.points, "flagged": report.flagged, "most": self.most_flagged}
            return "passed" if report.flagged_share <= self.most_flagged else "failed", counted
        how, why = report.outcomes().get(name, (SKIPPED, "there was nothing to judge"))
        failure, cause = report.failure_of(name), report.cause_of(name)
        if failure is None:
            return _VERDICTS[how], {"reason": why} if why else None
        said = {"increment": failure.increment, "violated": f"{failure.check.formula}: {failure.message}"}
        said |= {"likely": failure.diagnosis} if failure.diagnosis else {}
        return _VERDICTS[how], said | ({"explained_by": cause} if cause else {})


_VERDICTS = {PASSED: "passed", FAILED: "failed", SKIPPED: "not_applicable", MET: "xfailed", UNMET: "xpassed"}
_ANY = "coulomb"  # the checks of one law are those of any
_ROUTINE = "give a function update(trial, pressure, stiffness), or what from_material makes of a material"


def _bound(routine: Update, law: Criterion) -> Update:
    """The routine with those values of the row for which it has an argument; where it gets no memory that is no answer of it."""
    row = {name: float(domain.value) for name, domain in law.parameters.items() if domain.value is not None}
    try:
        arguments = signature(routine).parameters.values()
    except (TypeError, ValueError):  # of a compiled one nobody says which it has
        arguments = {}.values()
    if all(argument.kind is not Parameter.VAR_KEYWORD for argument in arguments):
        row = {name: row[name] for name in row.keys() & {argument.name for argument in arguments}}

    process = os.getpid()

    @wraps(routine)
    def update(*given: Any, **values: Any) -> Any:
        try:
            return routine(*given, **values, **row)
        except MemoryError as fault:
            raise _NoMemory(fault) from None
        finally:
            if os.getpid() != process:  # it has forked, and its child would go on with the checks
                os._exit(0)

    return update


@contextmanager
def _own_constants_left_out() -> Iterator[None]:
    """Hypothesis draws numbers too that stand in loaded modules beside the user's: in a checkout duhem's own are among them, as far as
    other rows have loaded them, and the same seed would draw other cases."""
    from hypothesis.internal.conjecture import providers

    known = getattr(providers, "is_local_module_file", None)
    if known is None:  # another version, which has another way
        yield
        return
    own = str(Path(__file__).parents[1])
    vars(providers)["is_local_module_file"] = lambda path: not path.startswith(own) and known(path)
    try:
        yield
    finally:
        vars(providers)["is_local_module_file"] = known


def _digest(routine: Any) -> str:
    module = sys.modules.get(getattr(unwrap(routine), "__module__", None) or "")
    try:
        with open(module.__file__ or "", "rb") as stream:  # type: ignore[union-attr]
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except (AttributeError, OSError):
        return "unread"
