"""The conformance suite: a routine put to every check, or to one case."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.law.catalogue import load, load_formula
from duhem.law.formula_law import Criterion
from duhem.law.state import check_stateless
from duhem.testing.checks import material_checks, state_checks  # noqa: F401 (they register their checks, and what they import)
from duhem.testing.checks.law_in_state import Places
from duhem.testing.checks.query import NoReply
from duhem.testing.checks.registry import Check, judged, registered
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.options import ACCURACY, TRIES, check_share
from duhem.testing.drawn.values import Strategy
from duhem.testing.failures.report import Report
from duhem.testing.routines.material import Material
from duhem.testing.routines.routine import Update
from duhem.testing.run import ConformanceRun

__all__ = [
    "ACCURACY", "assert_conforms", "check", "check_expected", "checks_asked", "checks_for", "conformance", "every_check", "violation",
]  # fmt: skip

_Law = Criterion | str | Path | None


def checks_for(law: _Law, *, associated: bool = False) -> tuple[Check, ...]:
    """The checks a routine for ``law`` has to pass; those that only some laws satisfy are asked for by name.

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
        near = "".join(f"; did you mean {each!r}?" for each in get_close_matches(name, known, n=1))
        remedy = f"choose one of {', '.join(known)}{near}"
        raise InputError(f"unknown check {name!r}", where=where or ("" if of_a_law else "without a law"), remedy=remedy)
    return known[name]


def checks_asked(
    law: _Law, checks: Iterable[Check | str] | Check | str | None, of_states: bool = False, where: str = ""
) -> tuple[Check, ...]:
    """The checks that ``checks`` name, of a law or of none; all that are demanded where left out.

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
    """InputError unless it maps names of checks to the reasons why they fail."""
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
    """What is wrong with the routine's answer to one case by one check, or None; ``open_parameters`` are passed to it by name.

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
    Name only the cause: checks that it explains (:mod:`duhem.testing.failures.causes`) may fail too.  ``first`` are cases that are
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
    """The law, or None.  InputError for one with a state where the routine keeps none."""
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
    """:func:`conformance`, raising AssertionError with the shrunk cases if a check fails or more than ``most_flagged`` is flagged."""
    report = conformance(law, update, parameters, most_flagged=most_flagged, **options)
    if not report.ok:
        raise AssertionError(str(report))
    return report
