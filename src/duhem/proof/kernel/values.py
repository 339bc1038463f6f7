"""What a formula's parts say of its value whatever its names stand for: a constant's number, a sign, or that there is no value.

The parser refuses a text with a part that has no real value anywhere: a division by 0, a root of a negative number, log(0).  Nothing
is proved here.  A constant is a fraction, or a double with a bound of its rounding that cannot be told from 0 where it may be 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import reduce
from typing import Any, NamedTuple

__all__ = ["ANY", "NEGATIVE", "POSITIVE", "ZERO", "Known", "NoValueError", "constant", "of_word"]

NEGATIVE, ZERO, POSITIVE = 1, 2, 4
ANY = NEGATIVE | ZERO | POSITIVE
_UP = ZERO | POSITIVE
_UNIT = 2.0**-50
_MOST_BITS, _MOST_EXPONENT, _MOST_OF_NUMBER, _MOST_EXP = 8192, 1000, 64, 700


class NoValueError(ValueError):
    """A part of a formula has no real value, or one too large to reckon with."""


class Known(NamedTuple):
    """The signs that are possible; whether it is real wherever its names are; the number that a constant is, with its error.

    ``turned`` says that an angle is in it whose sign is open.
    """

    sign: int = ANY
    real: bool = True
    number: Fraction | float | None = None
    error: float = 0.0
    turned: bool = False

    @property
    def lone(self) -> bool:
        """Whether it is a constant."""
        return self.number is not None

    @property
    def double(self) -> float:
        """The constant as a double."""
        assert self.number is not None
        return float(self.number)


def constant(number: Fraction | float, error: float = 0.0) -> Known:
    """A constant; NoValueError where it is too large, or not finite."""
    if isinstance(number, Fraction):
        if number.numerator.bit_length() + number.denominator.bit_length() > _MOST_BITS:
            raise NoValueError("a number is too large")
    elif not (math.isfinite(number) and error < 1e-3 * max(1.0, abs(number))):
        raise NoValueError("a number is not finite")
    sign = ZERO if -error <= number <= error else POSITIVE if number > 0 else NEGATIVE
    return Known(sign, True, number, error)


def of_word(op: str, x: Sequence[Known]) -> Known:
    """What is known of a sum, product, power, comparison or word of parts; NoValueError where it has no value anywhere."""
    try:
        found = _POWERS[op](*x) if op in _POWERS else _of_constants(op, x) if all(a.lone for a in x) else _by_signs(op, x)
    except (OverflowError, ZeroDivisionError):
        raise NoValueError("a number is too large") from None
    except ValueError as fault:
        raise NoValueError(str(fault) if isinstance(fault, NoValueError) else "a part has no real value") from None
    return found._replace(turned=found.turned or any(a.turned for a in x)) if not found.lone else found


# -- constants ---------------------------------------------------------------------------------------------------------


def _of_constants(op: str, x: Sequence[Known]) -> Known:
    exact = [a.number for a in x if isinstance(a.number, Fraction)]
    if len(exact) == len(x):
        if op in ("+", "max", "min", "abs", "pos", "neg"):
            return constant(_EXACT[op](exact))
        if op == "*":
            return constant(Fraction(math.prod(exact)))
    doubles, error = [a.double for a in x], max((a.error for a in x), default=0.0)
    match op:
        case "+":
            size = math.fsum(map(abs, doubles))
            return constant(math.fsum(doubles), sum(a.error for a in x) + _UNIT * size)
        case "*":
            if any(a.sign == ZERO for a in x):
                return constant(Fraction(0))
            size = abs(math.prod(doubles))
            return constant(math.prod(doubles), size * sum(a.error / abs(a.double) + _UNIT for a in x))
        case "max" | "min" | "abs" | "pos" | "neg":
            return constant(float(_EXACT[op](doubles)), error)
        case "norm":
            return _root(_of_constants("+", [_of_constants("*", (a, a)) for a in x]), Fraction(1, 2))
        case "atan2":
            if all(a.sign == ZERO for a in x):
                raise NoValueError("there is no angle at (0, 0)")
            value = math.atan2(0.0 if x[0].sign == ZERO else doubles[0], doubles[1])
            return constant(value, error / math.hypot(*doubles) + _UNIT * abs(value))
        case "where" | "<" | "<=" | ">" | ">=":
            return x[1] if op == "where" and x[0].number else x[2] if op == "where" else constant(Fraction(_holds(op, *x)))
        case "eigmax":
            return Known()
    value = _VALUES[op](doubles[0])
    if op in ("asin", "acos") and abs(doubles[0]) > 1 - 1e-9:
        error = math.sqrt(error)
    if op == "tan" and abs(math.cos(doubles[0])) <= error + _UNIT:
        raise NoValueError("a tangent has no value")
    return constant(value, error * (_STEEPEST[op](doubles[0], value) if op in _STEEPEST else 1.0) + _UNIT * abs(value))


def _holds(op: str, one: Known, two: Known) -> bool:
    gap = _of_constants("+", (one, two._replace(number=-_number(two)))).sign
    return bool(gap & {"<": NEGATIVE, "<=": NEGATIVE | ZERO, ">": POSITIVE, ">=": _UP}[op])


def _number(known: Known) -> Fraction | float:
    assert known.number is not None
    return known.number


def _log(x: float) -> float:
    if x <= 0:
        raise NoValueError("a logarithm of what is not positive")
    return math.log(x)


def _exp(x: float) -> float:
    if x > _MOST_EXP:
        raise NoValueError("an exponential is too large")
    return math.exp(x)


def _inside(f: Callable[[float], float]) -> Callable[[float], float]:
    return lambda x: f(max(-1.0, min(1.0, x)) if abs(x) < 1 + 1e-12 else x)


_EXACT: dict[str, Callable[[Any], Any]] = {  # of fractions or doubles alike
    "+": sum, "max": max, "min": min, "abs": lambda x: abs(x[0]), "pos": lambda x: max(x[0], type(x[0])(0)),
    "neg": lambda x: max(-x[0], type(x[0])(0)),
}  # fmt: skip
_VALUES: dict[str, Callable[[float], float]] = {
    "exp": _exp, "log": _log, "sin": math.sin, "cos": math.cos, "tan": math.tan, "asin": _inside(math.asin), "acos": _inside(math.acos),
    "atan": math.atan, "sinh": math.sinh, "cosh": math.cosh, "tanh": math.tanh,
}  # fmt: skip
_STEEPEST: dict[str, Callable[[float, float], float]] = {  # the slope, from argument and value
    "exp": lambda _, v: v, "log": lambda x, _: 1 / x, "tan": lambda _, v: 1 + v * v, "sinh": lambda _, v: 1 + abs(v),
    "cosh": lambda _, v: v,
}  # fmt: skip


# -- powers ------------------------------------------------------------------------------------------------------------


def _power(base: Known, exponent: Known) -> Known:
    if exponent.lone:
        if abs(exponent.double) > (_MOST_OF_NUMBER if base.lone else _MOST_EXPONENT):
            raise NoValueError("an exponent is too large")
        if base.sign == ZERO and exponent.sign == NEGATIVE:
            raise NoValueError("a division by 0")
        p = exponent.number
        if base.lone:
            return _constant_power(base, exponent)
        whole = isinstance(p, Fraction) and p.denominator == 1
        if whole and p == 0:
            return constant(Fraction(1))
        if base.sign == ZERO:
            return constant(Fraction(0))
        if base.real and not base.sign & POSITIVE and not whole and isinstance(p, Fraction):
            raise NoValueError("a root of what is never positive")
        if base.real and whole and (exponent.sign == POSITIVE or not base.sign & ZERO):
            even = p is not None and p % 2 == 0
            return Known((_UP if base.sign & ZERO else POSITIVE) if even else base.sign)
        if base.real and whole:  # a quotient, whose sign is known where it has a value
            even = p is not None and p % 2 == 0
            return Known(POSITIVE if even else base.sign & ~ZERO, False)
    elif base.number == 1:
        return base
    elif base.lone and base.sign != POSITIVE:
        raise NoValueError("a variable power of a number that is not positive")
    if base.real and base.sign == POSITIVE and exponent.real:
        return Known(POSITIVE)
    if base.real and not base.sign & NEGATIVE and exponent.real and not exponent.sign & NEGATIVE:
        return Known(_UP)
    return Known(ANY, False)


def _constant_power(base: Known, exponent: Known) -> Known:
    p = _number(exponent)
    if exponent.sign == ZERO:
        return constant(Fraction(1))
    if base.sign == ZERO:
        return constant(Fraction(0))
    if isinstance(p, Fraction) and p.denominator == 1:
        if isinstance(base.number, Fraction):
            size = max(abs(base.number.numerator).bit_length(), base.number.denominator.bit_length())
            if abs(p) * size > _MOST_BITS:
                raise NoValueError("a number is too large")
            return constant(base.number ** int(p))
        value = base.double ** int(p)
        return constant(value, abs(value) * (abs(float(p)) * base.error / abs(base.double) + _UNIT))
    if base.sign == NEGATIVE:
        raise NoValueError("a root of what is negative")
    return _root(base, p, exponent.error)


def _root(base: Known, p: Fraction | float, error: float = 0.0) -> Known:
    """A power of a constant >= 0 that is no whole one."""
    if base.sign == ZERO:
        return constant(Fraction(0))
    if isinstance(base.number, Fraction) and isinstance(p, Fraction) and p.denominator == 2:
        ends = math.isqrt(base.number.numerator), math.isqrt(base.number.denominator)
        if ends[0] ** 2 == base.number.numerator and ends[1] ** 2 == base.number.denominator:
            return constant(Fraction(*ends) ** p.numerator)
    value = base.double ** float(p)
    share = abs(float(p)) * base.error / base.double + abs(math.log(base.double)) * (error + _UNIT) + _UNIT
    return constant(value, value * share)


# -- signs -------------------------------------------------------------------------------------------------------------


def _by_signs(op: str, x: Sequence[Known]) -> Known:
    real, sign = all(a.real for a in x), x[0].sign
    match op:
        case "where" if x[0].lone:
            return x[1] if x[0].number else x[2]
        case "<" | "<=" | ">" | ">=":
            gap = _of_sum((sign, _of_product(x[1].sign, NEGATIVE))) if real else ANY
            holds = {"<": NEGATIVE, "<=": NEGATIVE | ZERO, ">": POSITIVE, ">=": _UP}[op]
            return constant(Fraction(1)) if not gap & ~holds else constant(Fraction(0)) if not gap & holds else Known()
        case "+":
            return Known(_of_sum([a.sign for a in x]), real) if real else Known(ANY, False)
        case "*":
            if any(a.sign == ZERO for a in x):
                return constant(Fraction(0))
            for other in x[1:]:
                sign = _of_product(sign, other.sign)
            return Known(sign, real)
        case "abs":
            return Known(POSITIVE if x[0].real and not sign & ZERO else _UP)
        case "pos" | "neg":
            low = NEGATIVE if op == "pos" else POSITIVE
            if x[0].real and not sign & ~(low | ZERO):
                return constant(Fraction(0))
            return Known(POSITIVE if x[0].real and not sign & (low | ZERO) else _UP)
        case "norm":
            return Known(POSITIVE if any(a.real and not a.sign & ZERO for a in x) else _UP)
        case "max" | "min":
            return _extreme(op, x) if real else Known(ANY, False)
        case "exp" | "cosh":
            return Known(POSITIVE) if real else Known(ANY, False)
        case "atan" | "sinh" | "tanh":
            return Known(sign if real else ANY, real)
        case "log":
            if not sign & POSITIVE:
                raise NoValueError("a logarithm of what is not positive")
            return Known(ANY, real and sign == POSITIVE)
        case "sin" | "cos":
            return Known(ANY, real)
        case "tan" | "asin" | "acos":
            return Known(ANY, False)
        case "atan2":
            y, over = x
            sided = y.real and (y.sign == NEGATIVE or not y.sign & NEGATIVE)
            settled = over.real and (over.sign == POSITIVE or (over.sign in (NEGATIVE, ZERO) and sided))
            if any(a.turned for a in x):
                raise NoValueError("an angle stands within an angle")
            sign = y.sign if over.real and y.real and over.sign == POSITIVE else ANY
            return Known(sign, settled or any(a.real and not a.sign & ZERO for a in x), turned=not settled)
    return Known()  # an open choice, an eigenvalue


def _of_sum(signs: Sequence[int]) -> int:
    if all(s == ZERO for s in signs):
        return ZERO
    for way in (POSITIVE, NEGATIVE):
        if not any(s & ~(way | ZERO) for s in signs):
            return way if any(s == way for s in signs) else way | ZERO
    return ANY


def _of_product(one: int, two: int) -> int:
    found = 0
    for s in (NEGATIVE, ZERO, POSITIVE):
        for t in (NEGATIVE, ZERO, POSITIVE):
            if one & s and two & t:
                found |= ZERO if ZERO in (s, t) else POSITIVE if s == t else NEGATIVE
    return found


def _extreme(op: str, x: Sequence[Known]) -> Known:
    """The signs of the greatest or least of any values with the signs of the parts."""
    first, *others = ({s for s in (NEGATIVE, ZERO, POSITIVE) if a.sign & s} for a in x)
    found = reduce(lambda one, two: {(max if op == "max" else min)(s, t) for s in one for t in two}, others, first)
    return Known(sum(found)) if found != {ZERO} else constant(Fraction(0))


_POWERS = {"**": _power}
