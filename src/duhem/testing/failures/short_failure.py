"""A failure on a case in round numbers, with those of its diagnoses that hold there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from duhem.testing.checks.query import Query
from duhem.testing.drawn.case import Case
from duhem.testing.failures.departure import departure
from duhem.testing.failures.diagnosed import instead
from duhem.testing.failures.report import Failure

__all__ = ["short_failure"]

_ANSWERS = "answers"  # what is no number is shown where it is none


def short_failure(
    failure: Failure,
    fails: Callable[[Case], bool],
    simplified: Callable[[Case, Callable[[Case], bool]], Case],
    again: Callable[[Case], Failure | None],
    asked: Callable[[Case], Query],
    accused: bool,
) -> Failure:
    """``simplified`` makes shorter a case on which it ``fails``, ``again`` is the same check failing there.

    Where nothing is left to tell what the routine does instead, as without stress, it is shown under some stress; as it was found where
    none of its diagnoses holds there either.
    """

    def on(case: Case) -> Failure:
        found = again(case)
        if found is None:
            return failure
        found = replace(found, origin=failure.origin, departure=failure.departure and departure(asked(case)))
        told = instead(found, asked, accused) if failure.diagnoses else {}
        return replace(found, diagnoses={name: told[name] for name in failure.diagnoses if name in told})

    short = on(simplified(failure.case, fails))
    if short.diagnoses or not failure.diagnoses or failure.check.name == _ANSWERS:
        return short
    short = on(simplified(failure.case, lambda case: bool(case.trial.any()) and fails(case)))
    return short if short.diagnoses else failure
