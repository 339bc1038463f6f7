"""The one question every proof comes down to: is an expression >= 0 (or > 0, or = 0) wherever some relations hold?"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression.number import fraction
from duhem.proof.decide.needs import Obligation, Sense, obligations

__all__ = ["Answer", "Question", "bounds"]


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

    def hidden(self, shown: Iterable[sp.Expr]) -> tuple[Obligation, ...]:
        """What its formula needs to be defined and some other form of it no longer shows, as abs(x)/x does not when it is 1."""
        needs = dict.fromkeys(obligations(self.expr))
        common = set(needs).intersection(*map(obligations, shown))
        return tuple(need for need in needs if need not in common)


def bounds(x: sp.Symbol, given: Iterable[sp.Basic]) -> tuple[Fraction | None, Fraction | None]:
    """The least and the greatest value of a symbol, by the relations that speak of it alone; None where there is none."""
    low = [fraction(r.lts) for r in given if getattr(r, "gts", None) == x and r.lts.is_Rational]
    high = [fraction(r.gts) for r in given if getattr(r, "lts", None) == x and r.gts.is_Rational]
    return max(low, default=None), min(high, default=None)


@dataclass(frozen=True)
class Answer:
    """``holds`` True: proved by ``method``; False: ``point`` suggests a violation, not yet checked; None: not decided."""

    holds: bool | None
    method: str = ""
    point: Mapping[sp.Symbol, Any] | None = None
    reason: str = ""
