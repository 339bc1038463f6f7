"""Cases of a test of which the suite, or its quick part, runs some; `python -m pytest -m long` runs those that the suite leaves out."""

from collections.abc import Iterable
from typing import Any

import pytest

__all__ = ["long_at", "long_but", "mostly_long", "mostly_slow"]


def mostly_long(cases: Iterable[Any], *kept: Any) -> list[Any]:
    """All cases; those that are not ``kept`` for every run are marked long."""
    return _marked(pytest.mark.long, cases, kept)


def long_at(places: Iterable[int], cases: Iterable[Any]) -> list[Any]:
    """All cases, of a list that is written where it is used; those at these places are marked long."""
    every, chosen = list(cases), {*places}
    assert chosen <= {*range(len(every))}, "a place beyond the last case"
    return [_as_parameters(case, pytest.mark.long) if place in chosen else case for place, case in enumerate(every)]


def long_but(places: Iterable[int], cases: Iterable[Any]) -> list[Any]:
    """All cases, of a list that is written where it is used; those at other places than these are marked long."""
    every, kept = list(cases), {*places}
    assert kept <= {*range(len(every))}, "a place beyond the last case"
    return long_at({*range(len(every))} - kept, every)


def mostly_slow(cases: Iterable[Any], *kept: Any) -> list[Any]:
    """All cases; those that are not ``kept`` for the quick part are marked slow."""
    return _marked(pytest.mark.slow, cases, kept)


def _marked(mark: pytest.MarkDecorator, cases: Iterable[Any], kept: tuple[Any, ...]) -> list[Any]:
    every = list(cases)
    assert all(case in every for case in kept), "a case that is kept is none"
    return [case if case in kept else _as_parameters(case, mark) for case in every]


def _as_parameters(case: Any, mark: pytest.MarkDecorator) -> Any:
    if hasattr(case, "marks"):  # of pytest.param
        return pytest.param(*case.values, marks=[*case.marks, mark], id=case.id)
    return pytest.param(*(case if type(case) is tuple else (case,)), marks=mark)
