"""The one question every proof comes down to: is an expression >= 0 (or > 0, or = 0) wherever some relations hold?"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import sympy as sp

__all__ = ["Answer", "Question", "Sense"]


class Sense(StrEnum):
    """What is asked of the expression."""

    NONNEGATIVE = ">="
    POSITIVE = ">"
    ZERO = "=="


@dataclass(frozen=True)
class Question:
    """For all real values of the symbols that satisfy every relation of ``given``: ``expr sense 0``?

    ``circle`` names two symbols x, y restricted to x^2 + y^2 = 1.
    """

    expr: sp.Expr
    sense: Sense
    given: tuple[sp.Basic, ...] = ()
    circle: tuple[sp.Symbol, sp.Symbol] | None = None

    def pinned(self) -> tuple[Question, ...]:
        """The same with symbols that the relations make 0 put in place; on the circle the other coordinate is then 1 or -1.

        None at all if the relations contradict each other; only itself if the formula is undefined there or nothing is 0.
        """
        zero = self._zeros()
        if not zero:
            return (self,)
        places: list[dict[sp.Symbol, sp.Expr]] = [dict.fromkeys(zero, sp.S.Zero)]
        circle = self.circle
        if circle is not None and zero & set(circle):
            other = [s for s in circle if s not in zero]
            places = [{**places[0], s: end} for s in other for end in (sp.S.One, sp.S.NegativeOne)]
            circle = None
        found = []
        for place in places:
            expr, given = self.expr.xreplace(place), tuple(dict.fromkeys(r.xreplace(place) for r in self.given))
            if any(e.has(sp.nan, sp.zoo, sp.oo, -sp.oo) for e in (expr, *given)):
                return (self,)
            if sp.false not in given:
                found.append(Question(expr, self.sense, tuple(r for r in given if r is not sp.true), circle))
        return tuple(found)

    def _zeros(self) -> set[sp.Symbol]:
        """Symbols with s = 0 among the relations, or both s >= 0 and -s >= 0."""
        zero: set[sp.Symbol] = set()
        above: set[sp.Symbol] = set()
        below: set[sp.Symbol] = set()
        for relation in self.given:
            if isinstance(relation, sp.Eq):
                found, side = zero, relation.lhs if relation.rhs.is_zero else None
            elif isinstance(relation, sp.GreaterThan | sp.LessThan):
                upward = relation.lts.is_zero
                found, side = (above, relation.gts) if upward else (below, relation.lts if relation.gts.is_zero else None)
                if side is not None and side.could_extract_minus_sign():
                    found, side = below if upward else above, -side
            else:
                continue
            if side is not None and side.is_Symbol:
                found.add(side)
        return zero | (above & below)


@dataclass(frozen=True)
class Answer:
    """``holds`` True: proved by ``method``; False: ``point`` suggests a violation, not yet checked; None: not decided."""

    holds: bool | None
    method: str = ""
    point: Mapping[sp.Symbol, Any] | None = None
    reason: str = ""
