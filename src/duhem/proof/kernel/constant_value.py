"""The value of a constant: worked out as a fraction, enclosed between two numbers, and the exact sign of what is made of roots.

Enclosures lie between whole multiples of 2^-96, or of a finer unit, rounded outward (R. E. Moore 1966, Interval analysis).  Words
are enclosed by series with their remainders: each is that of the ends where it is monotone; sine and cosine are enclosed from the
middle, their slope being at most 1.

A number made of fractions by sums, products, quotients and roots is U/L with algebraic integers U and L, all of whose conjugates are
at most u and l, read off its form.  If it is not 0, neither is the norm of U, a whole number; so |U/L| >= 1/(u^(D - 1) l), D the
product of the roots' indices (Burnikel, Funke, Mehlhorn, Schirra, Schmitt 2001, ESA, LNCS 2161, 254).  What an enclosure shows to be
closer to 0 is 0.

The sign of a sum rests, beside ranges and constraints, on where a constant that is no parameter lies, and on which of two is the greater.
A word that rises keeps the order of its arguments; a power of what is at most 1 is at most 1 for an exponent >= 0; a wave lies between
-1 and 1.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import reduce
from itertools import permutations
from math import factorial, isqrt, lcm, prod
from typing import ClassVar, NamedTuple

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO, Bounds, Sign
from duhem.proof.kernel.polynomial import Polynomial
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import COMPARISONS, HALF, NotWritten, Term, minus, number, product_of, sum_of

__all__ = [
    "BITS", "BOUNDED", "RISING", "Enclosure", "below_right", "enclosed", "exact_value", "finer", "holds", "ordered", "sign_of_radicals",
    "sign_over", "span",
]  # fmt: skip

BITS = 96
_ONE = 1 << BITS
_FARTHEST, _MOST_BOXES = 1000 * _ONE, 64
_TERMS = 32  # of a series in which each term is a ninth of the one before, or less: the rest is below one unit
_OF_ROOTS = ("number", "+", "*", "**", "abs", "norm")
_FEW, _MOST_BITS, _SPARE, _LARGEST = 128, 1 << 15, 64, 200  # binary digits; the largest index and exponent of a root
_MOST_BITS_OF_FRACTION = 4096


# -- exactly -----------------------------------------------------------------------------------------------------------


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
    if term.op not in _EXACT:
        raise NotWritten(f"{term.op} is not worked out exactly")
    return _EXACT[term.op](*map(exact_value, term.args))


def _fraction_power(base: Fraction, exponent: Fraction) -> Fraction:
    """NotWritten where it is no fraction; what is raised to 0 is 1."""
    size = max(base.numerator.bit_length(), base.denominator.bit_length()) * abs(exponent.numerator)
    if (base == 0 > exponent) or (base < 0 and exponent.denominator > 1) or exponent.denominator > 2 or size > _MOST_BITS_OF_FRACTION:
        raise NotWritten("a power is no fraction")
    if exponent.denominator == 2:
        root = Fraction(isqrt(base.numerator), isqrt(base.denominator))
        if root * root != base:
            raise NotWritten("a root is no fraction")
        base = root
    return base**exponent.numerator


_EXACT: Mapping[str, Callable[..., Fraction]] = {
    "+": lambda *x: sum(x, Fraction(0)), "*": lambda *x: prod(x, start=Fraction(1)), "**": _fraction_power,
    "norm": lambda *x: _fraction_power(sum((y * y for y in x), Fraction(0)), Fraction(1, 2)),
    "abs": abs, "pos": lambda x: max(x, Fraction(0)), "neg": lambda x: max(-x, Fraction(0)),
    "max": lambda *x: max(x), "min": lambda *x: min(x),
}  # fmt: skip


# -- enclosed ----------------------------------------------------------------------------------------------------------


class _Ends(NamedTuple):
    low: int
    high: int


class Enclosure(_Ends):
    """Every number from ``low`` to ``high``, both in units of 2^-bits."""

    bits: ClassVar[int] = BITS

    @classmethod
    def between(cls, low: Fraction, high: Fraction) -> Enclosure:
        """The least that holds both."""
        return cls((low.numerator << cls.bits) // low.denominator, -((-high.numerator << cls.bits) // high.denominator))

    @property
    def sign(self) -> Sign:
        """The signs in it."""
        below, above = NEGATIVE if self.low < 0 else 0, POSITIVE if self.high > 0 else 0
        return below | above | (ZERO if self.low <= 0 <= self.high else 0)

    def plus(self, other: Enclosure) -> Enclosure:
        """x + y."""
        return type(self)(self.low + other.low, self.high + other.high)

    def minus(self) -> Enclosure:
        """-x."""
        return type(self)(-self.high, -self.low)

    def times(self, other: Enclosure) -> Enclosure:
        """x y."""
        if self.low >= 0 and other.low >= 0:
            return type(self)(self.low * other.low >> self.bits, -(-self.high * other.high >> self.bits))
        ends = (self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high)
        return type(self)(min(ends) >> self.bits, -(-max(ends) >> self.bits))

    def inverse(self) -> Enclosure:
        """1/x; ZeroDivisionError where x may be 0."""
        if self.sign & ZERO:
            raise ZeroDivisionError("an interval holds 0")
        one = 1 << 2 * self.bits
        return type(self)(one // self.high, -(-one // self.low))

    def size(self) -> Enclosure:
        """|x|."""
        return type(self)(max(self.low, -self.high, 0), max(-self.low, self.high))

    def power(self, n: int) -> Enclosure:
        """x^n; ValueError where that has too many digits."""
        if (self.size().high.bit_length() - self.bits) * abs(n) > _MOST_BITS:
            raise ValueError("a power is too large")
        base = self.size() if n % 2 == 0 else self
        found = reduce(type(self).times, [base] * abs(n), self.between(Fraction(1), Fraction(1)))
        return found if n >= 0 else found.inverse()

    def root(self, k: int = 2) -> Enclosure:
        """The k-th root; ValueError where x may be < 0."""
        if self.low < 0:
            raise ValueError("a root of what may be < 0")
        shift = (k - 1) * self.bits
        return type(self)(_whole_root(self.low << shift, k), _whole_root(self.high << shift, k) + 1)


def finer(bits: int) -> type[Enclosure]:
    """Enclosures in units of 2^-bits."""
    return type("Enclosure", (Enclosure,), {"bits": bits})


def _whole_root(x: int, k: int) -> int:
    """The greatest whole number whose k-th power is at most x."""
    if k == 2 or x < 2:
        return isqrt(x)
    found = 1 << -(-x.bit_length() // k)
    while (lower := ((k - 1) * found + x // found ** (k - 1)) // k) < found:  # Newton's method, from above
        found = lower
    return found


def sign_over(term: Term, bounds: Mapping[str, Bounds], numbers: dict[Term, Enclosure] | None = None) -> Sign:
    """The sign of a constant, < 0 or > 0, over the ranges of its names; all three where that is not shown.

    ``numbers`` keeps enclosures of what has no names, where others are asked for later.
    """
    names = sorted(term.names() - {"pi"})
    ends = [bounds[n][:2] if n in bounds else (None, None) for n in names]
    boxes, found = [[Enclosure.between(low, high) for low, high in ends if low is not None and high is not None]], 0
    if len(boxes[0]) < len(names):
        return ANY

    def sign_in(box: Sequence[Enclosure]) -> Sign:
        pay(100)
        try:
            return enclosed(term, dict(zip(names, box, strict=True)), done=None if names else numbers).sign
        except (ValueError, ZeroDivisionError):
            return ANY

    corners = ([Enclosure(x.low, x.low) for x in boxes[0]], [Enclosure(x.high, x.high) for x in boxes[0]])
    if names and sign_in(corners[0]) | sign_in(corners[1]) not in (NEGATIVE, POSITIVE):
        return ANY  # one of the boxes in which a corner lies is not decided
    for _ in range(_MOST_BOXES):
        if not boxes:
            return found
        box = boxes.pop()
        sign = sign_in(box)
        if sign in (NEGATIVE, POSITIVE) and found in (0, sign):
            found = sign
            continue
        i = max(range(len(box)), key=lambda i: box[i].high - box[i].low, default=None)
        if i is None:
            return sign
        if sign in (NEGATIVE, POSITIVE):
            return ANY
        middle = (box[i].low + box[i].high) // 2
        boxes += [[*box[:i], part, *box[i + 1 :]] for part in (Enclosure(box[i].low, middle), Enclosure(middle, box[i].high))]
    return ANY


def enclosed(
    term: Term, box: Mapping[str, Enclosure], unit: type[Enclosure] = Enclosure, done: dict[Term, Enclosure] | None = None
) -> Enclosure:
    """What holds every value of ``term``; ValueError or ZeroDivisionError where it may be undefined or is no formula.

    In another unit only what is made of roots has one.  ``done`` has what was enclosed over the box before.
    """
    if not term.args:
        return _enclosed(term, box, unit, {})
    if done is None:
        done = {}
    if term not in done:
        done[term] = _enclosed(term, box, unit, done)
    return done[term]


def _enclosed(term: Term, box: Mapping[str, Enclosure], unit: type[Enclosure], done: dict[Term, Enclosure]) -> Enclosure:
    if unit is not Enclosure and term.op not in _OF_ROOTS:
        raise ValueError(f"no enclosure of {term.op}")
    if term.op == "number":
        return unit.between(term.value, term.value)
    if term.op == "name":
        return _PI if term.name == "pi" else box[term.name]
    if term.op == "where":
        return _chosen(term, box, done)
    if term.op == "**" and (n := _exponent(term)) is not None and (n.denominator <= 2 or unit is not Enclosure):
        x = enclosed(term.args[0], box, unit, done)
        return (x if n.denominator == 1 else x.root(n.denominator)).power(n.numerator)
    if term.op not in _WORDS or (term.op == "**" and unit is not Enclosure):
        raise ValueError(f"no enclosure of {term.op}")
    return _WORDS[term.op](*(enclosed(a, box, unit, done) for a in term.args))


def _chosen(term: Term, box: Mapping[str, Enclosure], done: dict[Term, Enclosure]) -> Enclosure:
    comparison, *values = term.args
    left, right = (enclosed(a, box, done=done) for a in comparison.args)
    gap = left.plus(right.minus()).sign
    holds = {"<": NEGATIVE, "<=": NEGATIVE | ZERO, ">": POSITIVE, ">=": POSITIVE | ZERO}[comparison.op]
    taken = [enclosed(v, box, done=done) for v, kept in zip(values, (holds, ANY & ~holds), strict=True) if gap & kept]
    return Enclosure(min(v.low for v in taken), max(v.high for v in taken))


# -- sums of powers ----------------------------------------------------------------------------------------------------

_NOTHING = Enclosure(0, 0)


def _greater(x: Enclosure, y: Enclosure) -> Enclosure:
    return Enclosure(max(x.low, y.low), max(x.high, y.high))


def _shifted(x: Enclosure, whole: int) -> Enclosure:
    return x.plus(Enclosure(whole * _ONE, whole * _ONE))


def _over(x: Enclosure, n: int) -> Enclosure:
    """x/n, n > 0."""
    return Enclosure(x.low // n, -(-x.high // n))


def _shares(divisor: Callable[[int], int]) -> tuple[Enclosure, ...]:
    """1/d_n for n = _TERMS, ..., 1, 0."""
    return tuple(Enclosure.between(share := Fraction(1, divisor(n)), share) for n in range(_TERMS, -1, -1))


def _series(x: Enclosure, shares: Sequence[Enclosure]) -> Enclosure:
    """c_0 + x (c_1 + x (c_2 + ...)) with the last of the ``shares`` c first; the terms left out are together less than one unit."""
    low = high = 0
    for share in shares:
        ends = (low * x.low, low * x.high, high * x.low, high * x.high)
        low, high = share.low + (min(ends) >> BITS), share.high - (-max(ends) >> BITS)
    return Enclosure(low - 1, high + 1)


_OF_EXP, _OF_ATANH = _shares(factorial), _shares(lambda n: 2 * n + 1)
_OF_COS, _OF_SIN = _shares(lambda n: factorial(2 * n)), _shares(lambda n: factorial(2 * n + 1))


def _power(x: Enclosure, p: Enclosure) -> Enclosure:
    if x.low > 0:
        return _exp(p.times(_log(x)))
    if x.low < 0 or p.low <= 0:
        raise ValueError("a root of what may be < 0")
    return Enclosure(0, _exp(p.times(_log(Enclosure(x.high, x.high)))).high if x.high else 0)


# -- words -------------------------------------------------------------------------------------------------------------


def _rising(f: Callable[[Enclosure], Enclosure]) -> Callable[[Enclosure], Enclosure]:
    """An increasing function from what holds its values at the ends."""
    return lambda x: Enclosure(f(Enclosure(x.low, x.low)).low, f(Enclosure(x.high, x.high)).high)


def _halved(x: Enclosure) -> tuple[Enclosure, int]:
    """x/2^k, of size 1/3 at most, and k."""
    if max(-x.low, x.high) > _FARTHEST:
        raise ValueError("an argument is too large")
    k = max(0, max(-x.low, x.high).bit_length() - BITS + 2)
    return Enclosure(x.low >> k, -(-x.high >> k)), k


def _exp_at(x: Enclosure) -> Enclosure:
    y, k = _halved(x)
    total = _series(y, _OF_EXP)
    for _ in range(k):
        total = total.times(total)
    return total


def _log_at(x: Enclosure) -> Enclosure:
    if x.low <= 0:
        raise ValueError("a logarithm of what may be <= 0")
    e = x.low.bit_length() - BITS - 1
    m = Fraction(x.low, 1 << BITS + e)  # x = m 2^e, 1 <= m < 2, and log m = 2 atanh z
    return _twice_atanh((m - 1) / (m + 1)).plus(_times_whole(_LOG_TWO, e))


def _twice_atanh(z: Fraction) -> Enclosure:
    x = Enclosure.between(z, z)
    return _times_whole(_series(x.times(x), _OF_ATANH).times(x), 2)


def _times_whole(x: Enclosure, n: int) -> Enclosure:
    return Enclosure(min(x.low * n, x.high * n), max(x.low * n, x.high * n))


_LOG_TWO = _twice_atanh(Fraction(1, 3))


def _atan_at(x: Enclosure) -> Enclosure:
    for _ in range(3):  # tan(t/2) = tan t/(1 + sqrt(1 + tan^2 t)), and tan(pi/16) < 1/3
        x = x.times(_shifted(_shifted(x.power(2), 1).root(), 1).inverse())
    return _times_whole(_series(x.power(2).minus(), _OF_ATANH).times(x), 8)


def _asin_at(x: Enclosure) -> Enclosure:
    if x.low < -_ONE or x.high > _ONE:
        raise ValueError("an arc sine of what may lie beyond 1")
    other = _greater(_shifted(x.power(2).minus(), 1), _NOTHING).root()
    return _times_whole(_atan_at(x.times(_shifted(other, 1).inverse())), 2)


_PI = _times_whole(_atan_at(Enclosure(_ONE, _ONE)), 4)


def _wave(x: Enclosure) -> tuple[Enclosure, Enclosure]:
    """Cosine and sine: those of the middle, less whole turns, give or take half the width."""
    middle = (x.low + x.high) // 2
    turns = _times_whole(_PI, 2 * (middle // (2 * _PI.low)))
    y, k = _halved(Enclosure(middle, middle).plus(turns.minus()))
    square = y.power(2).minus()
    c, s = _series(square, _OF_COS), _series(square, _OF_SIN).times(y)
    for _ in range(k):
        c, s = c.power(2).plus(s.power(2).minus()), _times_whole(c.times(s), 2)
    away = max(x.high - middle, middle - x.low)
    one, two = (Enclosure(max(v.low - away, -_ONE), min(v.high + away, _ONE)) for v in (c, s))
    return one, two


def _angle(y: Enclosure, x: Enclosure) -> Enclosure:
    if x.sign == POSITIVE:
        return _atan(y.times(x.inverse()))
    if y.sign in (NEGATIVE, POSITIVE):
        quarter = _over(_PI, 2) if y.sign == POSITIVE else _over(_PI, 2).minus()
        return quarter.plus(_atan(x.times(y.inverse())).minus())
    if x.sign != NEGATIVE:
        raise ValueError("an angle of what may be (0, 0)")
    return Enclosure(-_PI.high, _PI.high)


def _tanh_at(x: Enclosure) -> Enclosure:
    found = _shifted(_times_whole(_shifted(_exp_at(_times_whole(x, 2)), 1).inverse(), 2).minus(), 1)
    return Enclosure(max(found.low, -_ONE), min(found.high, _ONE))


def _tan(x: Enclosure) -> Enclosure:
    """It rises where no cosine is 0; ZeroDivisionError where one may be."""
    _wave(x)[0].inverse()
    return _rising(lambda end: (wave := _wave(end))[1].times(wave[0].inverse()))(x)


_exp, _log, _atan, _asin = map(_rising, (_exp_at, _log_at, _atan_at, _asin_at))
_sinh = _rising(lambda x: _over(_exp_at(x).plus(_exp_at(x.minus()).minus()), 2))
_WORDS: Mapping[str, Callable[..., Enclosure]] = {
    "+": lambda *x: reduce(Enclosure.plus, x), "*": lambda *x: reduce(Enclosure.times, x), "**": _power,
    "norm": lambda *x: reduce(Enclosure.plus, (y.power(2) for y in x)).root(),
    "max": lambda *x: reduce(_greater, x), "min": lambda *x: reduce(_greater, (y.minus() for y in x)).minus(),
    "abs": Enclosure.size, "pos": lambda x: _greater(x, _NOTHING), "neg": lambda x: _greater(x.minus(), _NOTHING), "atan2": _angle,
    "exp": _exp, "log": _log, "atan": _atan, "asin": _asin, "sinh": _sinh, "tanh": _rising(_tanh_at), "tan": _tan,
    "acos": lambda x: _over(_PI, 2).plus(_asin(x).minus()),
    "sin": lambda x: _wave(x)[1], "cos": lambda x: _wave(x)[0],
    "cosh": lambda x: _rising(lambda y: _over(_exp_at(y).plus(_exp_at(y.minus())), 2))(x.size()),
}  # fmt: skip


# -- of roots ----------------------------------------------------------------------------------------------------------


def sign_of_radicals(term: Term) -> Sign:
    """The sign; all three for what is no such number, may be undefined or would take too many digits."""
    try:
        roots = dict[Term, int]()
        u, below = _sizes(term, roots)
        if max(u, below) > _MOST_BITS:
            return ANY
        known, apart = enclosed(term, {}, finer(_FEW)), u * (prod(roots.values()) - 1) + below
        if known.sign & ZERO and apart <= _MOST_BITS:
            known = enclosed(term, {}, finer(apart + u + _SPARE))
            if known.sign & ZERO and known.size().high < 1 << (u + _SPARE):
                return ZERO
    except (NotWritten, ValueError, ZeroDivisionError):
        return ANY
    return ANY if known.sign & ZERO else known.sign


def _exponent(power: Term) -> Fraction | None:
    """That of a power, if it is a small fraction; not 0 unless it is written so."""
    with suppress(NotWritten):
        n = exact_value(power.args[1])
        return n if (n or power.args[1].op == "number") and max(abs(n.numerator), n.denominator) <= _LARGEST else None
    return None


def _sizes(term: Term, roots: dict[Term, int]) -> tuple[int, int]:
    """The logarithms to base 2 of u and l, rounded up; ``roots`` takes up what roots are taken of, and of which index."""
    if term.op == "number":
        return max(0, abs(term.value.numerator) - 1).bit_length(), (term.value.denominator - 1).bit_length()
    if term.op == "norm":
        return _sizes(Term("**", (sum_of(*(product_of(a, a) for a in term.args)), HALF)), roots)
    if term.op == "**":
        if (n := _exponent(term)) is None:
            raise NotWritten("an exponent is no small fraction")
        k, (u, below) = n.denominator, _sizes(term.args[0], roots)
        if k > 1:
            roots[term.args[0]] = lcm(k, roots.get(term.args[0], 1))
            u = -(-(u + (k - 1) * below) // k)  # the k-th root of U/L is that of U L^(k - 1), over L
        u, below = abs(n.numerator) * u, abs(n.numerator) * below
        return (u, below) if n > 0 else (below, u)
    if term.op not in ("+", "*", "abs"):
        raise NotWritten(f"{term.op} is no root")
    parts = [_sizes(a, roots) for a in term.args]
    below = sum(low for _, low in parts)
    if term.op == "+":
        return max(u + below - low for u, low in parts) + (len(parts) - 1).bit_length(), below
    return sum(u for u, _ in parts), below


# -- where a constant lies, and which of two is the greater ------------------------------------------------------------

_Signs = Callable[[Term], Sign]
_COARSE = 40  # binary digits that the ends of a span need not have
_UNIT, _RIGHT = Fraction(1), product_of(HALF, Term("name", name="pi"))
_NEAR_RIGHT = number(Fraction(3, 2))  # less than pi/2, and a fraction
BOUNDED = {
    "sin": Bounds(-_UNIT, _UNIT), "cos": Bounds(-_UNIT, _UNIT), "tanh": Bounds(-_UNIT, _UNIT, True, True),
    "exp": Bounds(Fraction(0), None, True),
    "atan": Bounds(-2 * _UNIT, 2 * _UNIT), "asin": Bounds(-2 * _UNIT, 2 * _UNIT), "acos": Bounds(Fraction(0), 4 * _UNIT),
}  # fmt: skip
RISING = ("exp", "log", "atan", "asin", "sinh", "tanh")  # words that rise wherever they have a value


def span(atom: Term, sign: _Signs, bounds: Mapping[str, Bounds]) -> Bounds:
    """Where a constant lies, wherever it has a value, by its ``sign``, its word and the ranges of its names."""
    found = BOUNDED.get(atom.op, Bounds(None, None))
    for end, beside in ((Fraction(0), sign(atom)), (_UNIT, _beside_one(atom, sign))):
        if not beside & NEGATIVE:
            found = found.above(end, not beside & ZERO)
        if not beside & POSITIVE:
            found = found.below(end, not beside & ZERO)
    ends = {name: bounds[name] for name in atom.names() - {"pi"} if name in bounds}
    if set(ends) == atom.names() - {"pi"} and all(own.low is not None and own.high is not None for own in ends.values()):
        pay(100)
        with suppress(ValueError, ZeroDivisionError):
            box = {name: Enclosure.between(own.low or Fraction(0), own.high or Fraction(0)) for name, own in ends.items()}
            low, high = enclosed(atom, box)
            found = found.above(Fraction(low >> _COARSE, 1 << BITS - _COARSE), False)
            found = found.below(Fraction(-(-high >> _COARSE), 1 << BITS - _COARSE), False)
    return found


def _beside_one(atom: Term, sign: _Signs) -> Sign:
    """The signs that atom - 1 may have, of an exponential and of a power of what is >= 0."""
    if atom.op == "exp":
        return sign(atom.args[0])
    if atom.op != "**" or sign(atom.args[0]) & NEGATIVE:
        return ANY
    base, exponent = sign(sum_of(atom.args[0], number(-1))), sign(atom.args[1])
    above, below = not base & NEGATIVE, not base & POSITIVE
    grows, falls = not exponent & NEGATIVE, not exponent & POSITIVE
    equal = (base | exponent) & ZERO
    if (above and grows) or (below and falls):
        return POSITIVE | equal
    return NEGATIVE | equal if (above and falls) or (below and grows) else ANY


def ordered(atoms: Collection[Term], sign: _Signs) -> Iterator[tuple[Polynomial, bool]]:
    """What is >= 0, or > 0, of two constants with one word that rises, or falls: y - x where it keeps, or turns, the order of arguments."""
    for x, y in permutations(sorted(atoms), 2):
        if x.op == y.op and (rises := _rises(x.op, (x.args[0], y.args[0]), sign)) is not None:
            gap = sign(sum_of(y.args[0], minus(x.args[0])))
            if not gap & (NEGATIVE if rises else POSITIVE):
                yield {((y, 1),): _UNIT, ((x, 1),): -_UNIT}, not gap & ZERO


def _rises(word: str, angles: Collection[Term], sign: _Signs) -> bool | None:
    """Whether a word rises, or falls, where these arguments may lie; None for a word that is not seen to do either."""
    if word in RISING or (word in ("tan", "sin") and all(below_right(angle, sign) for angle in angles)):
        return True
    ends = (end for angle in angles for end in (angle, sum_of(_RIGHT, _RIGHT, minus(angle))))
    return False if word == "acos" or (word == "cos" and not any(sign(end) & NEGATIVE for end in ends)) else None


def below_right(angle: Term, sign: _Signs) -> bool:
    """Whether an angle is less than a right one in size."""
    sides = (angle, minus(angle))
    return all(not sign(sum_of(_NEAR_RIGHT, side)) & NEGATIVE or sign(sum_of(_RIGHT, side)) == POSITIVE for side in sides)
