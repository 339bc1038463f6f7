"""Questions evaluated at exact points, from the tree as it stands: fractions alone, nothing of the deciders."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import isqrt

import sympy as sp

from duhem.expression import Neg, Norm, Pos, Where
from duhem.proof.decide import Question, Sense

__all__ = ["Point", "UndefinedError", "UnsuitedError", "holds", "value", "violated"]

Point = Mapping[sp.Symbol, Fraction]


class UndefinedError(Exception):
    """The expression has no real value at the point."""


class UnsuitedError(Exception):
    """The value is no fraction: another point or another expression is to be taken."""


def value(expr: sp.Basic, at: Point) -> Fraction:
    """The value at the point; whatever is undefined in a part makes the whole undefined."""
    if expr.is_Symbol:
        return at[expr]
    if expr.is_Rational:
        return Fraction(int(expr.p), int(expr.q))
    if isinstance(expr, Where):
        condition, then, otherwise = expr.args
        return value(then if holds(condition, at) else otherwise, at)
    values = [value(a, at) for a in expr.args]
    if isinstance(expr, sp.Pow):
        return _power(*values)
    if isinstance(expr, Norm):
        return _power(sum((v**2 for v in values), Fraction(0)), Fraction(1, 2))
    if isinstance(expr, (sp.exp, sp.tanh, sp.log)):
        return _transcendental(type(expr), values[0])
    if type(expr) not in _MEANING:  # pi, which SymPy makes of log(-1)
        raise UnsuitedError
    return _MEANING[type(expr)](values)


_MEANING = {
    sp.Add: lambda v: sum(v, Fraction(0)),
    sp.Mul: lambda v: sp.prod(v, Fraction(1)),
    sp.Abs: lambda v: abs(v[0]),
    sp.Max: max,
    sp.Min: min,
    Pos: lambda v: max(v[0], Fraction(0)),
    Neg: lambda v: max(-v[0], Fraction(0)),
}


def _power(base: Fraction, exponent: Fraction) -> Fraction:
    if base < 0 and exponent.denominator > 1:
        raise UndefinedError
    if base == 0 and exponent <= 0:
        raise UndefinedError
    return _root(base, exponent.denominator) ** exponent.numerator


def _root(base: Fraction, q: int) -> Fraction:
    if q == 1 or base in (0, 1):
        return base
    over, under = isqrt(base.numerator), isqrt(base.denominator)
    if q != 2 or over**2 != base.numerator or under**2 != base.denominator:
        raise UnsuitedError
    return Fraction(over, under)


def _transcendental(function: type, x: Fraction) -> Fraction:
    if function is sp.log and x <= 0:
        raise UndefinedError
    if x != (1 if function is sp.log else 0):
        raise UnsuitedError
    return Fraction(function is sp.exp)


def holds(relation: sp.Basic, at: Point) -> bool:
    """Truth of a relation."""
    if relation in (sp.true, sp.false):
        return bool(relation)
    left, right = (value(side, at) for side in relation.args)
    return bool(_compared(left - right, relation.rel_op))


def _holds_where_defined(relation: sp.Basic, at: Point) -> bool:
    """An undefined hypothesis keeps no point out: a decider may not use it for more."""
    try:
        return holds(relation, at)
    except UndefinedError:
        return True


def _compared(gap: Fraction, op: str) -> bool:
    return {">=": gap >= 0, ">": gap > 0, "<=": gap <= 0, "<": gap < 0, "==": gap == 0, "!=": gap != 0}[op]


def violated(question: Question, at: Point) -> bool:
    """Whether no hypothesis fails at the point, and the expression is undefined or not as wanted."""
    if not all(_holds_where_defined(r, at) for r in question.given):
        return False
    try:
        return not _compared(value(question.expr, at), Sense(question.sense).value)
    except UndefinedError:
        return True
