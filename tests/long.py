"""Cases of a test of which the suite, or its quick part, runs some; `python -m pytest -m long` runs those that the suite leaves out."""

from collections.abc import Iterable
from typing import Any

import pytest

__all__ = ["mostly_long", "mostly_slow"]


def mostly_long(cases: Iterable[Any], *kept: Any) -> list[Any]:
    """All cases; those that are not ``kept`` for every run are marked long."""
    return _marked(pytest.mark.long, cases, kept)


def mostly_slow(cases: Iterable[Any], *kept: Any) -> list[Any]:
    """All cases; those that are not ``kept`` for the quick part are marked slow."""
    return _marked(pytest.mark.slow, cases, kept)


def _marked(mark: pytest.MarkDecorator, cases: Iterable[Any], kept: tuple[Any, ...]) -> list[Any]:
    every = list(cases)
    assert all(case in every for case in kept), "a case that is kept is none"
    return [case if case in kept else pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=mark) for case in every]
