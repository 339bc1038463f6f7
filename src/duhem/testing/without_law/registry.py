"""The checks that need no law, in the order in which they explain each other: one that fails may be why later ones do."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, cast

from duhem.testing.checks.query import Query
from duhem.testing.checks.registry import Check, Finding
from duhem.testing.without_law.history import HistoryQuery

__all__ = ["register", "registered"]

_checks: dict[str, Check] = {}


def register(
    name: str, *, statement: str, formula: str, source: str, tolerance: str, demanded: bool = True, **more: Any
) -> Callable[[Callable[[HistoryQuery], Finding]], Callable[[HistoryQuery], Finding]]:
    """Add a check; ``demanded`` is one that no routine may fail, whatever its law."""

    def add(measure: Callable[[HistoryQuery], Finding]) -> Callable[[HistoryQuery], Finding]:
        asked = cast(Callable[[Query], Finding], measure)
        _checks[name] = Check(name, statement, formula, source, tolerance, asked, demanded=demanded, **more)
        return measure

    return add


def registered() -> Iterator[Check]:
    """Every check that needs no law."""
    return iter(_checks.values())
