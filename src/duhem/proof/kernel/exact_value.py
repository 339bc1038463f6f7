"""The value of a formula of numbers as a fraction, every part of it worked out: what has none, has none however it is used."""

from __future__ import annotations

from fractions import Fraction
from math import isqrt, prod

from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term

__all__ = ["exact_value", "holds"]

_MOST_BITS = 4096


def holds(comparison: Term) -> bool:
    """Whether a comparison of numbers is true; NotWritten where a side has no value or is no fraction."""
    left, right = map(exact_value, comparison.args)
    return {"<": left < right, "<=": left <= right, ">": left > right, ">=": left >= right}[comparison.op]


def exact_value(term: Term) -> Fraction:
    """NotWritten for what has no value or is no fraction; of a choice only what is chosen needs one."""
    if term.op == "number":
        return term.value
    if term.op == "where" and term.args[0].op in COMPARISONS:
        return exact_value(term.args[1 if holds(term.args[0]) else 2])
    x = [exact_value(a) for a in term.args]
    match term.op:
        case "+":
            return sum(x, Fraction(0))
        case "*":
            return prod(x, start=Fraction(1))
        case "**":
            return _power(*x)
        case "norm":
            return _power(sum((y * y for y in x), Fraction(0)), Fraction(1, 2))
        case "abs":
            return abs(x[0])
        case "pos" | "neg":
            return max(x[0] if term.op == "pos" else -x[0], Fraction(0))
        case "max" | "min":
            return max(x) if term.op == "max" else min(x)
    raise NotWritten(f"{term.op} is not worked out exactly")


def _power(base: Fraction, exponent: Fraction) -> Fraction:
    """NotWritten where it is no fraction; what is raised to 0 is 1."""
    size = max(base.numerator.bit_length(), base.denominator.bit_length()) * abs(exponent.numerator)
    if (base == 0 > exponent) or (base < 0 and exponent.denominator > 1) or exponent.denominator > 2 or size > _MOST_BITS:
        raise NotWritten("a power is no fraction")
    if exponent.denominator == 2:
        root = Fraction(isqrt(base.numerator), isqrt(base.denominator))
        if root * root != base:
            raise NotWritten("a root is no fraction")
        base = root
    return base**exponent.numerator
