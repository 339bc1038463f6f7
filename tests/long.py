"""Cases of a test of which the suite runs some and `python -m pytest -m long` the others."""

from collections.abc import Iterable
from typing import Any

import pytest

__all__ = ["mostly_long"]


def mostly_long(cases: Iterable[Any], *kept: Any) -> list[Any]:
    """All cases; those that are not ``kept`` for every run are marked long."""
    every = list(cases)
    assert all(case in every for case in kept), "a case that is kept is none"
    return [
        case if case in kept else pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.long) for case in every
    ]
