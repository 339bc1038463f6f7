"""Failures with the increment that departs from the closest point, and with what the routine does instead."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import replace
from math import isnan

from duhem.testing.checks.query import Query
from duhem.testing.drawn.case import Case
from duhem.testing.failures.causes import likeliest_first
from duhem.testing.failures.departure import departure
from duhem.testing.failures.diagnosis import Part, diagnoses
from duhem.testing.failures.report import Failure
from duhem.testing.routines.origin import Origin

__all__ = ["diagnosed", "instead"]

_PARTS: dict[str, Part] = {"slip": "slip", "energy": "slip", "multiplier": "multiplier", "tangent": "tangent", "slope": "tangent"}
_TRIED = 3  # failures of a part of the answer that are diagnosed, until one of them is


def diagnosed(failures: Iterable[Failure], asked: Callable[[Case], Query], made: Origin, accused: bool) -> list[Failure]:
    """With what the routine returned, asked again; of those that speak of one part of it the likeliest causes are diagnosed.

    ``accused``: a check of the stress has failed.
    """
    told: list[Failure] = []
    tried: Counter[Part] = Counter()
    for failure in sorted(failures, key=likeliest_first):
        now = replace(failure, origin=made)
        gone = not failure.alone and isnan(failure.measured)  # it did not show when asked again, and would not here
        if not (failure.check.law_only or failure.check.whole or gone) and len(failure.case) == 1:
            part = _part(failure)
            now = replace(now, departure=departure(asked(failure.case)))
            if now.departure is not None and (now.departure.apart or part != "stress") and tried[part] < _TRIED:
                now = replace(now, diagnoses=instead(now, asked, accused))
                tried[part] += _TRIED if now.diagnoses else 1
        told.append(now)
    return told


def instead(failure: Failure, asked: Callable[[Case], Query], accused: bool) -> dict[str, str]:
    """By name, what the routine does instead, where that is known.

    Of a stress that is not the closest point a tangent says so first, where no check has ``accused`` the stress.
    """
    part, found, query = _part(failure), failure.departure, asked(failure.case)
    if found is None or (part == "stress" and not found.apart):
        return {}
    if part == "tangent" and found.apart and not accused:
        why = next(iter(diagnoses("stress", query, found).values()), "")
        return {"stress": f"the stress is not the closest point{why and ': '}{why}"}
    return diagnoses(part, query, found)


def _part(failure: Failure) -> Part:
    return _PARTS.get(failure.check.name, "stress")
