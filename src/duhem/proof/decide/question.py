"""The one question every proof comes down to: is an expression >= 0 (or > 0, or = 0) wherever some relations hold?"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from duhem.proof.decide.needs import Sense, obligations

__all__ = ["Answer", "Question"]


@dataclass(frozen=True)
class Question:
    """For all real values of the symbols that satisfy every relation of ``given``: ``expr sense 0``?

    ``circle`` names two symbols x, y restricted to x^2 + y^2 = 1.
    """

    expr: sp.Expr
    sense: Sense
    given: tuple[sp.Basic, ...] = ()
    circle: tuple[sp.Symbol, sp.Symbol] | None = None

    def on_circle(self) -> tuple[sp.Basic, ...]:
        """That circle as a relation."""
        return () if self.circle is None else (sp.Eq(self.circle[0] ** 2 + self.circle[1] ** 2, 1),)

    def hidden(self, shown: Iterable[sp.Expr]) -> tuple[Question, ...]:
        """What its formula needs to be defined and some other form of it no longer shows, as abs(x)/x does not when it is 1."""
        needs = dict.fromkeys(_needs(self.expr))
        common = set(needs).intersection(*map(_needs, shown))
        lost = (need for need in needs if need not in common)
        return tuple(Question(need.expr, need.sense, (*self.given, *need.given), self.circle) for need in lost)


def _needs(expr: sp.Basic) -> list[Question]:
    """What must hold for an expression to be defined."""
    return [Question(*need.asked, need.given) for need in obligations(expr)]


@dataclass(frozen=True)
class Answer:
    """``holds`` True: proved by ``method``; False: ``point`` suggests a violation, not yet checked; None: not decided."""

    holds: bool | None
    method: str = ""
    point: Mapping[sp.Symbol, Any] | None = None
    reason: str = ""
