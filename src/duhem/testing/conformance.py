"""The conformance suite: a routine put to every check, or to one case."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.law.catalogue import load
from duhem.law.formula_law import Criterion
from duhem.testing.checks import material_checks  # noqa: F401 (it registers its checks, and what it imports those of laws)
from duhem.testing.checks.history import HistoryQuery
from duhem.testing.checks.query import NoReply, Query
from duhem.testing.checks.registry import Check, judged, registered
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.options import ACCURACY, TRIES, check_share
from duhem.testing.drawn.region import Region
from duhem.testing.drawn.values import Strategy
from duhem.testing.failures.report import Report
from duhem.testing.routines.material import Material, stateless
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


def every_check(law: _Law) -> tuple[Check, ...]:
    """Return all checks of a law, or those that need none, among them the ones that run only when they are named."""
    return tuple(registered(law is not None).values())


def check(name: str) -> Check:
    """Return a check by its name.  Raises InputError for an unknown one."""
    return _named(name, of_a_law=True)


def _named(name: str, of_a_law: bool) -> Check:
    known = registered(of_a_law)
    if name not in known:
        where = "" if of_a_law else "without a law"
        raise InputError(f"unknown check {name!r}", where=where, remedy=f"choose one of {', '.join(known)}")
    return known[name]


def checks_asked(law: _Law, checks: Iterable[Check | str] | Check | str | None) -> tuple[Check, ...]:
    """The checks that ``checks`` name, of a law or of none; all that are demanded where left out.

    InputError for one that there is not, for what names none, and where none is asked for: nothing would be tested.
    """
    if checks is None:
        return checks_for(law)
    remedy = 'name some, for example checks=["feasibility"], or leave it out for all'
    if not isinstance(checks, str | Check | Iterable):
        raise InputError(f"{checks!r} names no checks", where="checks", remedy=remedy)
    named = (checks,) if isinstance(checks, str | Check) else tuple(checks)
    if not named:
        raise InputError("no check is asked for", where="checks", remedy=remedy)
    if wrong := [each for each in named if not isinstance(each, str | Check)]:
        raise InputError(f"{wrong[0]!r} is no check", where="checks", remedy=remedy)
    return tuple(_named(each, law is not None) if isinstance(each, str) else each for each in named)


def check_expected(law: _Law, expected: Mapping[str, str] | None) -> None:
    """InputError unless it maps names of checks to the reasons why they fail."""
    if expected is None:
        return
    if not isinstance(expected, Mapping) or not all(isinstance(each, str) for pair in expected.items() for each in pair):
        remedy = 'give each check with its reason, for example {"slope": "no tangent yet"}'
        raise InputError(f"{expected!r} says not which check fails why", where="expected_failed_checks", remedy=remedy)
    for name in expected:
        _named(name, law is not None)


def violation(
    name: str | Check,
    law: _Law,
    update: Update | Material,
    case: Case,
    *,
    open_parameters: Iterable[str] | None = None,
    accuracy: float = ACCURACY,
) -> str | None:
    """What is wrong with the routine's answer to one case by one check, or None; ``open_parameters`` are passed to it by name."""
    asked = _named(name, law is not None) if isinstance(name, str) else name
    if law is None:
        query: Query = HistoryQuery(stateless(update, case.stiffness, case.parameters), case, accuracy)
    else:
        passed = tuple(case.parameters) if open_parameters is None else tuple(open_parameters)
        query = Query(Region(load(law), case.parameters), case, _routine(update), passed, accuracy)
    try:
        found = judged(asked, query)
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
) -> Report:
    """Put a routine for the slip increment of ``law`` to every check, on cases drawn by Hypothesis and shrunk where one fails.

    ``update(trial (N, d), pressure (N,), stiffness (d, d), **open)`` returns the stress (N, d) in Pa or a :class:`Step`;
    the pressure is None for a law without, and ``open`` are the parameters ``parameters`` leaves open, drawn over their
    domain.  :func:`pointwise` and :func:`from_displacements` adapt other shapes of routine.  ``stiffness`` and
    ``pressure`` are fixed values, then no other is asked, or strategies, drawn where left out.  ``accuracy`` is the relative error
    in stress the routine promises; every tolerance follows from it (:attr:`Check.tolerance`).  ``max_examples`` cases of about ``rows``
    increments are drawn, as the Hypothesis profile says where left out; of one in ``every`` more is asked than the answer to its
    trial, such as the answer to that answer, or to what lies beside it (:attr:`Check.again`): in 7 where left out, in 2 without a
    law, and 1 asks it of all.  ``tries`` bounds the shrinking of each failure, and ``seconds`` its time too, if that is worth
    more than being told the same by a busy machine.
    ``seed`` is that of the cases, drawn anew where left out unless the profile is derandomised; the report names it.
    ``expected_failed_checks`` gives the checks that are known to fail, each with the reason: one of them that passes makes
    the report not ``ok``.  The cause alone need be named: what a check explains that is expected and fails
    (:mod:`duhem.testing.failures.causes`) may fail with it or pass.  ``first`` are cases that are tried before any is drawn,
    such as those that failed before; one that does not fit the law and its parameters is passed over.  The law is taken to be
    associated.  The report is not ``ok`` either where the routine flags more than the share ``most_flagged`` of the increments
    as not solved; left out, any share may be.

    Without a law (None), ``update`` is such a routine, with ``stiffness`` (d,), (d, d) or a strategy, ``parameters`` that are
    numbers or strategies, all passed by name, and ``pressure``, None for a routine that is given none; or a
    :class:`Material`, which has its own.  It is put to the checks that need no law.

    A failing check is data in the report, not an exception: see :func:`assert_conforms`.  InputError where an argument cannot be
    used: no check asked for, an accuracy not between 0 and 1, a count below 1, a stiffness not symmetric and positive definite,
    a pressure > 0 (sigma_n <= 0 in compression).
    """
    known = None if law is None else load(law)
    asked = checks_asked(known, checks)
    check_expected(known, expected_failed_checks)
    if most_flagged is not None:
        check_share(most_flagged, "most_flagged")
    drawn = {"stiffness": stiffness, "pressure": pressure, "max_examples": max_examples, "rows": rows, "every": every, "seed": seed}
    told = {"accuracy": accuracy, "tries": tries, "seconds": seconds, "expected": expected_failed_checks, "given": law}
    run = ConformanceRun(known, update if known is None else _routine(update), parameters, asked, **told, **drawn)  # type: ignore[arg-type]
    run.try_first(first)
    return replace(run.to_the_end().report(), most_flagged=most_flagged)


def _routine(update: Update | Material) -> Update:
    if isinstance(update, Material):
        raise InputError("a material has its own stiffness", where="update", remedy="hold it against a law with from_material")
    return update


def assert_conforms(
    law: _Law,
    update: Update | Material,
    parameters: Mapping[str, Any] | None = None,
    *,
    most_flagged: float = 0.0,
    **options: Any,
) -> Report:
    """:func:`conformance`, raising AssertionError with the shrunk cases if a check fails or more than ``most_flagged`` is flagged."""
    check_share(most_flagged, "most_flagged")
    report = conformance(law, update, parameters, **options)
    if not report.ok:
        raise AssertionError(str(report))
    if report.flagged_share > most_flagged:
        raise AssertionError(
            f"the routine flags {report.flagged} of {report.points} increments as not solved, more than a share {most_flagged}"
        )
    return report
