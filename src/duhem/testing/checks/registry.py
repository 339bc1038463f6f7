"""The registry of checks: each with its statement, formula, source and tolerance, and a function that measures it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks.query import Query
from duhem.testing.checks.visited import Visited
from duhem.testing.drawn.case import Case

__all__ = ["Check", "Finding", "register", "registered"]


@dataclass(frozen=True)
class Finding:
    """What a check measured at each row (N,) and what it allows; more, or nan, is a violation; ``said`` (N,) instead of the numbers.

    ``unknown`` (N,): the rows of which the law does not say, as its g has no value there; they are not judged.
    ``tried``: of what it looked at more than the increments, how many, by name.  ``case``: the increments as they show what was
    found, where that was not drawn with them.
    """

    measured: Array
    allowed: Array
    said: NDArray[np.object_] | None = None
    unknown: NDArray[np.bool_] | None = None
    tried: Mapping[str, int] = field(default_factory=dict)
    case: Case | None = None

    @property
    def violated(self) -> NDArray[np.bool_]:
        return ~(self.measured <= self.allowed)


@dataclass(frozen=True)
class Check:
    """A fact every slip increment of a generalized standard law has.

    ``tolerance`` says what it is compared with and why; |s| = (s . k^-1 s)^1/2, and u is the error in stress
    the routine is held to (:mod:`duhem.testing.checks.query`).  ``law_only``: it looks at the law and never asks the routine.
    ``demanded``: the theory asks it of every law; the others are run where asked for by name.  ``whole``, of a check that no
    single case can fail, says at the end what is wrong with all that was visited, or None.  ``again``: it asks the routine for
    more than the answer to each trial, and so of some rows only (:attr:`duhem.testing.checks.query.Query.some`).
    ``needs``: what it must know to try all that it counts as tried, told where it could not.
    """

    name: str
    statement: str
    formula: str
    source: str
    tolerance: str
    measure: Callable[[Query], Finding]
    law_only: bool = False
    demanded: bool = True
    whole: Callable[[Visited], str | None] | None = None
    again: bool = False
    needs: str = ""

    @property
    def __name__(self) -> str:  # pytest names parametrised tests by it
        return self.name

    def __str__(self) -> str:
        return f"{self.name}: {self.statement}"


_checks: dict[str, Check] = {}


def register(
    name: str,
    *,
    statement: str,
    formula: str,
    source: str,
    tolerance: str,
    law_only: bool = False,
    demanded: bool = True,
    whole: Callable[[Visited], str | None] | None = None,
    again: bool = False,
    needs: str = "",
) -> Callable[[Callable[[Query], Finding]], Callable[[Query], Finding]]:
    """Add a check."""

    def add(measure: Callable[[Query], Finding]) -> Callable[[Query], Finding]:
        _checks[name] = Check(name, statement, formula, source, tolerance, measure, law_only, demanded, whole, again, needs)
        return measure

    return add


def registered() -> Iterator[Check]:
    """Every check, those of the law first: they cost least."""
    return iter(sorted(_checks.values(), key=lambda c: not c.law_only))
