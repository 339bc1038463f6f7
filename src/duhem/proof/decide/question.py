"""The one question every proof comes down to: is an expression >= 0 (or > 0, or = 0) wherever some relations hold?"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from duhem.expression import UNDEFINED
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

    def pinned(self) -> tuple[Question, ...]:
        """The same with symbols that the relations make 0 put in place; on the circle the other coordinate is then 1 or -1.

        None at all if the relations contradict each other; only itself if the formula is undefined there or nothing is 0.
        What is hidden then is asked about as well: SymPy has 0/y = 0 and 1/(1/0) = 0.
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
            try:
                expr, given = self.expr.xreplace(place), tuple(dict.fromkeys(r.xreplace(place) for r in self.given))
                needs = [Question(q.expr.xreplace(place), q.sense, tuple(r.xreplace(place) for r in q.given)) for q in _needs(self.expr)]
            except TypeError:  # SymPy compares nothing with what is undefined
                return (self,)
            if any(e.has(*UNDEFINED) for e in (expr, *given, *(need.expr for need in needs))):
                return (self,)
            if sp.false not in given:
                kept, shown = tuple(r for r in given if r is not sp.true), set(_needs(expr))
                hidden = (need for need in dict.fromkeys(needs) if need not in shown)
                found += [Question(q.expr, q.sense, (*kept, *q.given), circle) for q in (Question(expr, self.sense), *hidden)]
        return tuple(found)

    def hidden(self, shown: Iterable[sp.Expr]) -> tuple[Question, ...]:
        """What its formula needs to be defined and some other form of it no longer shows, as abs(x)/x does not when it is 1."""
        needs = dict.fromkeys(_needs(self.expr))
        common = set(needs).intersection(*map(_needs, shown))
        lost = (need for need in needs if need not in common)
        return tuple(Question(need.expr, need.sense, (*self.given, *need.given), self.circle) for need in lost)

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
