"""A claim: what it states, what it rests on, and who may try it, cheapest sound method first."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from duhem.examination import Case
from duhem.verdict import Evidence, Verdict

__all__ = ["Claim", "Consequence", "Engine"]

Engine = Callable[[Case], Evidence | None]
Consequence = Callable[[Case, Mapping[str, Evidence]], Evidence | None]


@dataclass(frozen=True)
class Claim:
    """``consequence`` settles the claim from the evidence of the claims it ``needs``; else ``engines`` try in order.

    ``seconds`` is the time the deciders may spend on it; what is then still open stays undecided.
    """

    name: str
    statement: str
    theory: str
    engines: tuple[Engine, ...]
    needs: tuple[str, ...] = ()
    consequence: Consequence | None = None
    seconds: float = 16.0

    def examine(self, case: Case, settled: Mapping[str, Evidence]) -> Evidence:
        """The first answer, or ``undecided`` when every method passed."""
        case.allow(self.seconds)
        if self.consequence is not None and (found := self.consequence(case, settled)) is not None:
            return found
        for engine in self.engines:
            if (found := engine(case)) is not None:
                return found
        return Evidence(Verdict.UNDECIDED, "none", "no method decided it within its time")
