"""Interval branch and bound with Arb balls: every box must show the goal, or lie outside a hypothesis.

Directed rounding makes each answer sound; a zero margin cannot be decided this way.  Variables need finite bounds
among the hypotheses.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression.balls import ball, enclose
from duhem.expression.number import fraction, rational
from duhem.proof.decide.budget import Budget
from duhem.proof.decide.question import Answer, Question, Sense

__all__ = ["by_enclosure"]

Box = dict[sp.Symbol, tuple[Fraction, Fraction]]
_METHOD = "interval"
_WANTED = {Sense.NONNEGATIVE: sp.GreaterThan, Sense.POSITIVE: sp.StrictGreaterThan}
_BOX, _NODE = 25, 5  # steps of one box and of each node that is enclosed over it
_LEAST = 2.0**-50  # relative width of a box: what is open there has no margin, and halves of it would be open for ever


def by_enclosure(question: Question, budget: Budget) -> Answer:
    """Prove the question by subdividing the box of its variables; ``holds`` None when budget or bounds run out."""
    if question.sense is Sense.ZERO:
        return Answer(None, _METHOD, reason="an enclosure cannot prove an equality")
    asked, question = question, _within_bounds(question)
    try:
        box, angle = _box(question)
    except InputError as fault:
        return Answer(None, _METHOD, reason=fault.what)
    price = _BOX + _NODE * sum(1 for e in (question.expr, *question.given) for _ in sp.preorder_traversal(e))
    queue, seen = [box], 0
    while queue:
        if not budget.pays(price):
            return Answer(None, _METHOD, reason=f"{len(queue)} of {seen} boxes still open")
        current = queue.pop()
        seen += 1
        values = _values(current, question, angle)
        verdicts = [_holds(enclose(r.lhs - r.rhs, values), type(r)) for r in question.given]
        if any(v is False for v in verdicts):
            continue
        goal = _holds(enclose(question.expr, values), _WANTED[question.sense])
        if goal is True:
            continue
        if goal is False and all(v is True for v in verdicts) and question is asked:
            return Answer(False, _METHOD, point={x: rational(v) for x, v in _middle(current, question, angle).items()})
        if not current or max(_widths(current).values()) < _LEAST:
            return Answer(None, _METHOD, reason="the margin is below the working precision")
        queue.extend(_halves(current))
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


def _within_bounds(question: Question) -> Question:
    """Without the hypotheses on symbols that have no bounds and are not in the expression: what is asked is more."""
    others = set().union(*(r.free_symbols for r in question.given)) - question.expr.free_symbols - set(question.circle or ())
    loose = {x for x in others if None in _bounds(x, question.given)}
    return replace(question, given=tuple(r for r in question.given if not r.free_symbols & loose)) if loose else question


def _box(question: Question) -> tuple[Box, sp.Symbol | None]:
    circle = set(question.circle or ())
    angle = sp.Dummy("theta") if circle else None
    box: Box = {angle: (Fraction(-1), Fraction(1))} if angle is not None else {}
    symbols = question.expr.free_symbols.union(*(r.free_symbols for r in question.given)) - circle
    for x in sorted(symbols, key=str):
        low, high = _bounds(x, question.given)
        if low is None or high is None:
            raise InputError(f"{x} is not bounded")
        box[x] = (low, high)
    return box, angle


def _bounds(x: sp.Symbol, given: tuple[sp.Basic, ...]) -> tuple[Fraction | None, Fraction | None]:
    low: Fraction | None = Fraction(0) if x.is_nonnegative else None
    high: Fraction | None = None
    for relation in given:
        if isinstance(relation, sp.Eq | sp.Ne):
            continue
        great, least = relation.gts, relation.lts
        if great == x and least.is_Rational:
            end = fraction(least)
            low = end if low is None else max(low, end)
        elif least == x and great.is_Rational:
            end = fraction(great)
            high = end if high is None else min(high, end)
    return low, high


def _values(box: Box, question: Question, angle: sp.Symbol | None) -> Mapping[sp.Symbol, Any]:
    values = {x: ball(*span) for x, span in box.items() if x is not angle}
    if angle is not None and question.circle is not None:
        turn = ball(*box[angle])
        x, y = question.circle
        values[x], values[y] = turn.cos_pi(), turn.sin_pi()
    return values


def _middle(box: Box, question: Question, angle: sp.Symbol | None) -> dict[sp.Symbol, Fraction]:
    middle = {x: (low + high) / 2 for x, (low, high) in box.items()}
    if angle is None or question.circle is None:
        return middle
    centre = ball(middle[angle], middle[angle])
    del middle[angle]
    for x, value in zip(question.circle, (centre.cos_pi(), centre.sin_pi()), strict=True):
        middle[x] = Fraction(float(value.mid())).limit_denominator(10**12)
    return middle


def _widths(box: Box) -> dict[sp.Symbol, float]:
    """Of each side, relative to the size of the variable."""
    return {x: float(high - low) / (1 + abs(float(low))) for x, (low, high) in box.items()}


def _halves(box: Box) -> list[Box]:
    """The box cut across its widest side."""
    widths = _widths(box)
    widest = max(widths, key=widths.__getitem__)
    low, high = box[widest]
    middle = (low + high) / 2
    return [{**box, widest: (low, middle)}, {**box, widest: (middle, high)}]
