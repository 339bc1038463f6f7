"""A second opinion on the texts that criterion files refuse: those with a part that has no real value whatever its names stand for.

A division by 0, a root of a negative number, log(0).  Nothing is proved here.  A constant is a fraction, or a double with a bound of its
rounding that cannot be told from 0 where it may be 0.  Like terms of a sum and like factors of a product are put together, as everybody
does in the head: a/(b - b) divides by 0.  Nothing else is cancelled or multiplied out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from typing import Any, NamedTuple, Protocol

__all__ = ["NoValueError", "check_values"]

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


# -- the parts of a text ----------------------------------------------------------------------------------------------

Atom = Any  # what a part is but for the order of its sums and products
Monomial = frozenset[tuple[Atom, Fraction]]
Form = dict[Monomial, Fraction]
_COMPARED = ("<", "<=", ">", ">=")
_ONE: Monomial = frozenset()
_MOST_TERMS = 200  # of a sum whose like terms are put together


class Part(Protocol):
    """A formula: its operation or word, its parts, and the number or name that it is."""

    @property
    def op(self) -> str: ...
    @property
    def args(self) -> Sequence[Any]: ...
    @property
    def value(self) -> Fraction: ...
    @property
    def name(self) -> str: ...


def check_values(term: Part, signs: Mapping[str, int]) -> None:
    """NoValueError where a part of the formula or comparison has no real value, for names of the ``signs`` given (any others: all)."""
    _Reading(signs).known(term)


class _Reading:
    """What is known of the parts of one text, and of the atoms in which its sums are written."""

    def __init__(self, signs: Mapping[str, int]) -> None:
        self._signs = signs
        self._known: dict[Any, tuple[Known, Form]] = {}
        self._atoms: dict[Atom, Known] = {}

    def known(self, term: Part) -> Known:
        return self._read(term)[0]

    def _read(self, term: Part) -> tuple[Known, Form]:
        if term not in self._known:
            self._known[term] = self._made(term)
        return self._known[term]

    def _made(self, term: Part) -> tuple[Known, Form]:
        if term.op == "number":
            return constant(term.value), {_ONE: term.value} if term.value else {}
        if term.op == "name":
            found = constant(3.141592653589793, 2.5e-16) if term.name == "pi" else Known(self._signs.get(term.name, ANY))
            return found, self._atom(term.name, found)
        parts = [self._read(a) for a in term.args]
        found = of_word(term.op, [known for known, _ in parts])
        if term.op == "where" and parts[0][0].lone:  # decided: the choice is what is chosen
            return found, parts[1 if parts[0][0].number else 2][1]
        if term.op == "where" and parts[1][1] == parts[2][1]:
            return parts[1]
        if term.op in ("asin", "acos"):
            self._check_within_one(*parts[0])
        if term.op in _COMPARED and not found.lone:
            found = self._compared(term.op, parts[0][1], parts[1][1])
        form = self._form(term, found, [form for _, form in parts])
        if not found.lone:
            if set(form) <= {_ONE}:
                found = constant(form.get(_ONE, Fraction(0)))
            elif term.op == "+" and len(form) <= _MOST_TERMS:
                found = self._sum(form, found)
        return found, form

    def _compared(self, op: str, one: Form, two: Form) -> Known:
        """A comparison, decided where the difference of its sides has the sign for it."""
        gap = {m: one.get(m, Fraction(0)) - two.get(m, Fraction(0)) for m in one | two}
        parts = [self._monomial(m, c) for m, c in gap.items() if c]
        known = of_word("+", parts) if parts else constant(Fraction(0))
        return of_word(op, (known, constant(Fraction(0)))) if known.real else Known()

    def _check_within_one(self, known: Known, form: Form) -> None:
        """NoValueError where 1 - |x| is negative by the signs of its terms."""
        if known.real and known.sign in (POSITIVE, NEGATIVE, POSITIVE | ZERO, NEGATIVE | ZERO):
            way = 1 if known.sign & NEGATIVE else -1
            rest = {m: way * c for m, c in form.items()}
            rest[_ONE] = rest.get(_ONE, Fraction(0)) + 1
            if self._sum({m: c for m, c in rest.items() if c}, known).sign == NEGATIVE:
                raise NoValueError("an arc of what lies beyond 1")

    def _sum(self, form: Form, found: Known) -> Known:
        """A sum by its terms, like ones put together."""
        return of_word("+", [self._monomial(m, c) for m, c in form.items()])._replace(turned=found.turned)

    def _monomial(self, monomial: Monomial, factor: Fraction) -> Known:
        powers = [of_word("**", (self._atoms[atom], constant(p))) if p != 1 else self._atoms[atom] for atom, p in monomial]
        return of_word("*", [constant(factor), *powers])

    def _form(self, term: Part, found: Known, parts: Sequence[Form]) -> Form:
        if found.lone and isinstance(found.number, Fraction):
            return {_ONE: found.number} if found.number else {}
        match term.op:
            case "+":
                total = dict[Monomial, Fraction]()
                for form in parts:
                    for m, c in form.items():
                        total[m] = total.get(m, Fraction(0)) + c
                return {m: c for m, c in total.items() if c}
            case "*":
                return self._product(term, parts)
            case "**" if term.args[1].op == "number":
                return self._power(parts[0], term.args[1].value, term.args[0])
        return self._atom((term.op, *map(_frozen, parts)), found)

    def _product(self, term: Part, parts: Sequence[Form]) -> Form:
        sums = [form for form in parts if len(form) > 1]
        if len(sums) == 1 and all(set(form) == {_ONE} for form in parts if form is not sums[0]):
            factor = Fraction(1)
            for form in parts:
                factor *= form[_ONE] if form is not sums[0] else 1
            return {m: c * factor for m, c in sums[0].items()}
        powers, factor = dict[Atom, Fraction](), Fraction(1)
        for form, part in zip(parts, term.args, strict=True):
            if len(form) > 1:
                form = self._atom(_frozen(form), self.known(part))
            ((monomial, c),) = form.items()
            factor *= c
            for atom, p in monomial:
                powers[atom] = powers.get(atom, Fraction(0)) + p
        return {frozenset((atom, p) for atom, p in powers.items() if p): factor}

    def _power(self, base: Form, p: Fraction, part: Part) -> Form:
        if len(base) == 1:
            ((monomial, c),) = base.items()
            if p.denominator == 1 and c.numerator.bit_length() * abs(p) < 4096:
                return {frozenset((atom, q * p) for atom, q in monomial): c ** int(p)}
        atom = self._atom(_frozen(base), self.known(part))
        ((((key, _),), _),) = ((tuple(m), c) for m, c in atom.items())
        return {frozenset({(key, p)}): Fraction(1)}

    def _atom(self, key: Atom, known: Known) -> Form:
        self._atoms.setdefault(key, known)
        return {frozenset({(key, Fraction(1))}): Fraction(1)}


def _frozen(form: Form) -> Atom:
    return frozenset(form.items())
