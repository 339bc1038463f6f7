"""A claim: what it states, what it rests on, and who may try it, cheapest sound method first."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from duhem.proof.facts.case import Case
from duhem.proof.facts.curve import CurveCase
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["Claim", "Consequence", "CurveEngine", "Engine"]

Engine = Callable[[Case], Evidence | None]
C = TypeVar("C")
CurveEngine = Callable[[CurveCase], Evidence | None]
Consequence = Callable[[Case, Mapping[str, Evidence]], Evidence | None]


@dataclass(frozen=True)
class Claim:
    """``consequence`` settles the claim from the evidence of the claims it ``needs``; else ``engines`` try in order.

    Laws given by a boundary curve go to ``curve_engines``, which need no other claim.
    ``seconds`` is the time the deciders may spend on it; what is then still open stays undecided.
    """

    name: str
    statement: str
    theory: str
    engines: tuple[Engine, ...]
    curve_engines: tuple[CurveEngine, ...]
    needs: tuple[str, ...] = ()
    consequence: Consequence | None = None
    seconds: float = 16.0

    def examine(self, case: Case | CurveCase, settled: Mapping[str, Evidence]) -> Evidence:
        """The first answer, or ``undecided`` when every method passed."""
        case.allow(self.seconds)
        if isinstance(case, CurveCase):
            found = _first(self.curve_engines, case)
        else:
            found = None if self.consequence is None else self.consequence(case, settled)
            found = found or _first(self.engines, case)
        return found or Evidence(Verdict.UNDECIDED, "none", "no method decided it within its time")


def _first(engines: Sequence[Callable[[C], Evidence | None]], case: C) -> Evidence | None:
    return next((found for engine in engines if (found := engine(case)) is not None), None)
