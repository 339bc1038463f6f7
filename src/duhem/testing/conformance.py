"""The conformance suite: a routine put to every check, or to one case."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.law.catalogue import load
from duhem.law.formula_law import Criterion
from duhem.testing.checks import law_checks, routine_checks, run_checks, tangent_checks  # noqa: F401 (they register)
from duhem.testing.checks.query import NoReply, Query
from duhem.testing.checks.registry import Check, registered
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.decades import Strategy
from duhem.testing.drawn.region import Region
from duhem.testing.failures import output_diagnoses, stress_diagnoses  # noqa: F401 (they register)
from duhem.testing.failures.report import Report
from duhem.testing.routines.material import Material
from duhem.testing.routines.routine import Update
from duhem.testing.run import TRIES, ConformanceRun, judged
from duhem.testing.without_law import FreeRun, free_check, free_checks, free_violation

__all__ = ["ACCURACY", "assert_conforms", "check", "checks_for", "conformance", "every_check", "violation"]

ACCURACY = 1e-9  # relative error in stress a routine is held to, unless it promises another


def checks_for(law: Criterion | str | Path | None, *, associated: bool = False) -> tuple[Check, ...]:
    """The checks a routine for ``law`` has to pass; those that only some laws satisfy are asked for by name.

    For None, those that need no law; ``associated``, with those that only associated laws, and some only those without
    hardening, satisfy.
    """
    if law is None:
        return free_checks(associated)
    load(law)
    return tuple(c for c in registered() if c.demanded)


def every_check() -> tuple[Check, ...]:
    """All that there are, those asked for by name among them."""
    return tuple(registered())


def check(name: str) -> Check:
    """A check by name.  Raises InputError for an unknown one."""
    known = {c.name: c for c in registered()}
    if name not in known:
        raise InputError(f"unknown check {name!r}", remedy=f"choose one of {', '.join(known)}")
    return known[name]


def violation(
    name: str | Check,
    law: Criterion | str | Path | None,
    update: Update | Material,
    case: Case,
    *,
    open_parameters: Iterable[str] | None = None,
    accuracy: float = ACCURACY,
) -> str | None:
    """What is wrong with the routine's answer to one case by one check, or None; ``open_parameters`` are passed to it by name."""
    if law is None:
        return free_violation(free_check(name) if isinstance(name, str) else name, update, case, accuracy)
    known = load(law)
    asked = check(name) if isinstance(name, str) else name
    passed = tuple(case.parameters) if open_parameters is None else tuple(open_parameters)
    try:
        found = judged(asked, Query(Region(known, case.parameters), case, _routine(update), passed, accuracy))
    except NoReply as fault:
        return str(fault)
    return None if found is None else found[1]


def conformance(
    law: Criterion | str | Path | None,
    update: Update | Material,
    parameters: Mapping[str, Any] | None = None,
    *,
    stiffness: ArrayLike | Strategy | None = None,
    pressure: float | Strategy | None = None,
    checks: Iterable[Check | str] | Check | str | None = None,
    accuracy: float = ACCURACY,
    max_examples: int | None = None,
    rows: int = 30,
    tries: int = TRIES,
    seconds: float | None = None,
    seed: int | None = None,
    expected_failed_checks: Mapping[str, str] | None = None,
    first: Iterable[Case] = (),
) -> Report:
    """Put a routine for the slip increment of ``law`` to every check, on cases drawn by Hypothesis and shrunk where one fails.

    ``update(trial (N, d), pressure (N,), stiffness (d, d), **open)`` returns the stress (N, d) in Pa or a :class:`Step`;
    the pressure is None for a law without, and ``open`` are the parameters ``parameters`` leaves open, drawn over their
    domain.  :func:`pointwise` and :func:`from_displacements` adapt other shapes of routine.  ``stiffness`` and
    ``pressure`` are fixed values or strategies, drawn where left out.  ``accuracy`` is the relative error in stress the
    routine promises; every tolerance follows from it (:attr:`Check.tolerance`).  ``max_examples`` cases of about ``rows``
    increments are drawn, as the Hypothesis profile says where left out; ``tries`` bounds the shrinking of each failure, and
    ``seconds`` its time too, if that is worth more than being told the same by a busy machine.
    ``seed`` is that of the cases, drawn anew where left out unless the profile is derandomised; the report names it.
    ``expected_failed_checks`` gives the checks that are known to fail, each with the reason: one of them that passes makes
    the report not ``ok``.  ``first`` are cases that are tried before any is drawn, such as those that failed before; one that
    does not fit the law and its parameters is passed over.  The law is taken to be associated.

    Without a law (None), ``update`` is such a routine, with ``stiffness`` (d,), (d, d) or a strategy, ``parameters`` that are
    numbers or strategies, all passed by name, and ``pressure``, None for a routine that is given none; or a
    :class:`Material`, which has its own.  It is put to the checks that need no law.

    A failing check is data in the report, not an exception: see :func:`assert_conforms`.
    """
    known = None if law is None else load(law)
    by_name = free_check if known is None else check
    named = checks_for(known) if checks is None else (checks,) if isinstance(checks, str | Check) else checks
    asked = [by_name(c) if isinstance(c, str) else c for c in named]
    for name in expected_failed_checks or {}:
        by_name(name)
    options: dict[str, Any] = {
        "stiffness": stiffness,
        "pressure": pressure,
        "accuracy": accuracy,
        "max_examples": max_examples,
        "rows": rows,
        "tries": tries,
        "seconds": seconds,
        "seed": seed,
        "expected": expected_failed_checks,
        "given": law,
    }
    run = (
        FreeRun(update, parameters, asked, **options)
        if known is None
        else ConformanceRun(known, _routine(update), parameters, asked, **options)
    )
    run.try_first(first)
    return run.to_the_end().report()


def _routine(update: Update | Material) -> Update:
    if isinstance(update, Material):
        raise InputError("a material has its own stiffness", where="update", remedy="hold it against a law with from_material")
    return update


def assert_conforms(
    law: Criterion | str | Path | None,
    update: Update | Material,
    parameters: Mapping[str, Any] | None = None,
    *,
    most_flagged: float = 0.0,
    **options: Any,
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
