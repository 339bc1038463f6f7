"""Interval branch and bound with Arb balls: every box must show the goal, or lie outside a hypothesis.

Directed rounding makes each answer sound; a zero margin cannot be decided this way.  Variables need finite bounds
among the hypotheses.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression.balls import ball, enclose
from duhem.expression.number import fraction
from duhem.proof.decide.budget import Budget
from duhem.proof.decide.needs import Sense
from duhem.proof.decide.question import Answer, Question

__all__ = ["by_enclosure"]

Box = dict[sp.Symbol, tuple[Fraction, Fraction]]
_METHOD = "interval"
_BOX, _NODE = 25, 5  # steps of one box and of each node that is enclosed over it
_LEAST = 2.0**-50  # relative width of a box: what is open there has no margin, and halves of it would be open for ever


def by_enclosure(question: Question, budget: Budget) -> Answer:
    """Prove the question by subdividing the box of its variables; ``holds`` None when budget or bounds run out."""
    if question.sense is Sense.ZERO:
        return Answer(None, _METHOD, reason="an enclosure cannot prove an equality")
    box: Box = {}
    for x in sorted(question.expr.free_symbols, key=str):
        low, high = _bounds(x, question)
        if low is None or high is None:
            return Answer(None, _METHOD, reason=f"{x} is not bounded")
        box[x] = low, high
    given = [r for r in (*question.given, *question.on_circle()) if r.free_symbols <= set(box)]  # fewer say less
    price = _BOX + _NODE * sum(1 for e in (question.expr, *given) for _ in sp.preorder_traversal(e))
    wanted = sp.StrictGreaterThan if question.sense is Sense.POSITIVE else sp.GreaterThan
    queue, seen = [box], 0
    while queue:
        if not budget.pays(price):
            return Answer(None, _METHOD, reason=f"{len(queue)} of {seen} boxes still open")
        current = queue.pop()
        seen += 1
        values = {x: ball(*span) for x, span in current.items()}
        if any(_holds(enclose(r.lhs - r.rhs, values), type(r)) is False for r in given):
            continue
        if _holds(enclose(question.expr, values), wanted):
            continue
        widths = {x: float(high - low) / (1 + abs(float(low))) for x, (low, high) in current.items()}  # relative to the variable's size
        if max(widths.values(), default=0.0) < _LEAST:
            return Answer(None, _METHOD, reason="the margin is below the working precision")
        widest = max(widths, key=widths.__getitem__)
        low, high = current[widest]
        queue += [{**current, widest: half} for half in ((low, (low + high) / 2), ((low + high) / 2, high))]
    return Answer(True, _METHOD, reason=f"{seen} boxes")


def _holds(value: Any, relation: type) -> bool | None:
    """Truth of ``value relation 0`` for every real in the ball; None where the ball leaves it open."""
    if not value.is_finite():
        return None
    low, high = value.lower(), value.upper()
    if relation is sp.GreaterThan:
        return True if low >= 0 else False if high < 0 else None
    if relation is sp.StrictGreaterThan:
        return True if low > 0 else False if high <= 0 else None
    if relation is sp.LessThan:
        return True if high <= 0 else False if low > 0 else None
    if relation is sp.StrictLessThan:
        return True if high < 0 else False if low >= 0 else None
    if relation is sp.Eq:
        return False if low > 0 or high < 0 else None
    return True if low > 0 or high < 0 else None


def _bounds(x: sp.Symbol, question: Question) -> tuple[Fraction | None, Fraction | None]:
    if x in (question.circle or ()):
        return Fraction(-1), Fraction(1)
    low = [Fraction(0)] if x.is_nonnegative else []
    inequalities = [r for r in question.given if not isinstance(r, sp.Eq | sp.Ne)]
    low += [fraction(r.lts) for r in inequalities if r.gts == x and r.lts.is_Rational]
    high = [fraction(r.gts) for r in inequalities if r.lts == x and r.gts.is_Rational]
    return max(low, default=None), min(high, default=None)
