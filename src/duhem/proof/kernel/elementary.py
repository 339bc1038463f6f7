"""Powers and words of intervals, from series with their remainders; the signs of a constant over a box of parameters.

Each function is that of the ends where it is monotone; sine and cosine are enclosed from the middle, their slope being at most 1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cache, reduce

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO, Bounds, Sign
from duhem.proof.kernel.interval import BITS, Enclosure
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import Term

__all__ = ["enclosed", "sign_over"]

_ONE = 1 << BITS
_FARTHEST, _HIGHEST, _MOST_BOXES = 1000 * _ONE, 64, 64
_TERMS = 32  # of a series in which each term is a ninth of the one before, or less: the rest is below one unit


def sign_over(term: Term, bounds: Mapping[str, Bounds]) -> Sign:
    """The sign of a constant, < 0 or > 0, over the ranges of its names; all three where that is not shown."""
    names = sorted(term.names() - {"pi"})
    ends = [bounds[n][:2] if n in bounds else (None, None) for n in names]
    boxes, found = [[Enclosure.between(low, high) for low, high in ends if low is not None and high is not None]], 0
    if len(boxes[0]) < len(names):
        return ANY
    for _ in range(_MOST_BOXES):
        if not boxes:
            return found
        box = boxes.pop()
        pay(100)
        try:
            sign = enclosed(term, dict(zip(names, box, strict=True))).sign
        except (ValueError, ZeroDivisionError):
            sign = ANY
        if sign in (NEGATIVE, POSITIVE) and found in (0, sign):
            found = sign
            continue
        i = max(range(len(box)), key=lambda i: box[i].high - box[i].low, default=None)
        if i is None or sign in (NEGATIVE, POSITIVE):
            return ANY
        middle = (box[i].low + box[i].high) // 2
        boxes += [[*box[:i], part, *box[i + 1 :]] for part in (Enclosure(box[i].low, middle), Enclosure(middle, box[i].high))]
    return ANY


def enclosed(term: Term, box: Mapping[str, Enclosure]) -> Enclosure:
    """What holds every value of ``term``; ValueError or ZeroDivisionError where it may be undefined or is no formula."""
    if term.op == "number":
        return Enclosure.between(term.value, term.value)
    if term.op == "name":
        return _pi() if term.name == "pi" else box[term.name]
    if term.op == "where":
        return _chosen(term, box)
    x, *others = parts = [enclosed(a, box) for a in term.args]
    match term.op:
        case "+":
            return reduce(Enclosure.plus, parts)
        case "*":
            return reduce(Enclosure.times, parts)
        case "**":
            return _power(x, others[0], term.args[1].value if term.args[1].op == "number" else None)
        case "norm":
            return reduce(Enclosure.plus, (_whole_power(p, 2) for p in parts)).root()
        case "max":
            return reduce(_greater, parts)
        case "min":
            return reduce(_greater, (p.minus() for p in parts)).minus()
        case "abs":
            return _size(x)
        case "pos" | "neg":
            return _greater(x if term.op == "pos" else x.minus(), Enclosure(0, 0))
        case "atan2":
            return _angle(x, others[0])
    return _WORDS[term.op](x) if term.op in _WORDS else _refused(term)


def _refused(term: Term) -> Enclosure:
    raise ValueError(f"no enclosure of {term.op}")


def _chosen(term: Term, box: Mapping[str, Enclosure]) -> Enclosure:
    comparison, *values = term.args
    left, right = (enclosed(a, box) for a in comparison.args)
    gap = left.plus(right.minus()).sign
    holds = {"<": NEGATIVE, "<=": NEGATIVE | ZERO, ">": POSITIVE, ">=": POSITIVE | ZERO}[comparison.op]
    taken = [enclosed(v, box) for v, kept in zip(values, (holds, ANY & ~holds), strict=True) if gap & kept]
    return Enclosure(min(v.low for v in taken), max(v.high for v in taken))


# -- sums of powers ----------------------------------------------------------------------------------------------------


def _greater(x: Enclosure, y: Enclosure) -> Enclosure:
    return Enclosure(max(x.low, y.low), max(x.high, y.high))


def _size(x: Enclosure) -> Enclosure:
    return _greater(_greater(x, x.minus()), Enclosure(0, 0))


def _shifted(x: Enclosure, whole: int) -> Enclosure:
    return x.plus(Enclosure(whole * _ONE, whole * _ONE))


def _over(x: Enclosure, n: int) -> Enclosure:
    """x/n, n > 0."""
    return Enclosure(x.low // n, -(-x.high // n))


def _series(x: Enclosure, divisors: Callable[[int], int]) -> Enclosure:
    """1 + x/d_1 (1 + x/d_2 (1 + ...)); the terms left out are together less than one unit."""
    total = Enclosure(_ONE, _ONE)
    for i in range(_TERMS, 0, -1):
        total = _shifted(_over(total.times(x), divisors(i)), 1)
    return Enclosure(total.low - 1, total.high + 1)


def _odd_series(x: Enclosure, square: Enclosure) -> Enclosure:
    """x (1 + q/3 + q^2/5 + ...) with q the ``square``, at most 1/9 in size."""
    total = Enclosure(0, 0)
    for i in range(_TERMS, -1, -1):
        total = _over(Enclosure(_ONE, _ONE), 2 * i + 1).plus(total.times(square))
    return Enclosure(total.low - 1, total.high + 1).times(x)


def _whole_power(x: Enclosure, n: int) -> Enclosure:
    if abs(n) > _HIGHEST:
        raise ValueError("the exponent is too high")
    base, total = _size(x) if n % 2 == 0 else x, Enclosure(_ONE, _ONE)
    for _ in range(abs(n)):
        total = total.times(base)
    return total if n >= 0 else total.inverse()


def _power(x: Enclosure, p: Enclosure, exact: Fraction | None) -> Enclosure:
    if exact is not None and exact.denominator == 1:
        return _whole_power(x, int(exact))
    if exact == Fraction(1, 2):
        return x.root()
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
    total = _series(y, lambda i: i)
    for _ in range(k):
        total = total.times(total)
    return total


def _log_at(x: Enclosure) -> Enclosure:
    if x.low <= 0:
        raise ValueError("a logarithm of what may be <= 0")
    e = x.low.bit_length() - BITS - 1
    m = Fraction(x.low, 1 << BITS + e)  # x = m 2^e, 1 <= m < 2, and log m = 2 atanh z
    return _twice_atanh((m - 1) / (m + 1)).plus(_times_whole(_twice_atanh(Fraction(1, 3)), e))


def _twice_atanh(z: Fraction) -> Enclosure:
    x = Enclosure.between(z, z)
    return _times_whole(_odd_series(x, x.times(x)), 2)


def _times_whole(x: Enclosure, n: int) -> Enclosure:
    return Enclosure(min(x.low * n, x.high * n), max(x.low * n, x.high * n))


def _atan_at(x: Enclosure) -> Enclosure:
    for _ in range(3):  # tan(t/2) = tan t/(1 + sqrt(1 + tan^2 t)), and tan(pi/16) < 1/3
        x = x.times(_shifted(_shifted(_whole_power(x, 2), 1).root(), 1).inverse())
    return _times_whole(_odd_series(x, _whole_power(x, 2).minus()), 8)


def _asin_at(x: Enclosure) -> Enclosure:
    if x.low < -_ONE or x.high > _ONE:
        raise ValueError("an arc sine of what may lie beyond 1")
    other = _greater(_shifted(_whole_power(x, 2).minus(), 1), Enclosure(0, 0)).root()
    return _times_whole(_atan_at(x.times(_shifted(other, 1).inverse())), 2)


@cache
def _pi() -> Enclosure:
    return _times_whole(_atan_at(Enclosure(_ONE, _ONE)), 4)


def _wave(x: Enclosure) -> tuple[Enclosure, Enclosure]:
    """Cosine and sine: those of the middle, give or take half the width."""
    middle = (x.low + x.high) // 2
    y, k = _halved(Enclosure(middle, middle))
    square = _whole_power(y, 2).minus()
    c, s = _series(square, lambda i: 2 * i * (2 * i - 1)), _series(square, lambda i: 2 * i * (2 * i + 1)).times(y)
    for _ in range(k):
        c, s = _whole_power(c, 2).plus(_whole_power(s, 2).minus()), _times_whole(c.times(s), 2)
    away = max(x.high - middle, middle - x.low)
    one, two = (Enclosure(max(v.low - away, -_ONE), min(v.high + away, _ONE)) for v in (c, s))
    return one, two


def _angle(y: Enclosure, x: Enclosure) -> Enclosure:
    if x.sign == POSITIVE:
        return _atan(y.times(x.inverse()))
    if y.sign in (NEGATIVE, POSITIVE):
        quarter = _over(_pi(), 2) if y.sign == POSITIVE else _over(_pi(), 2).minus()
        return quarter.plus(_atan(x.times(y.inverse())).minus())
    if x.sign != NEGATIVE:
        raise ValueError("an angle of what may be (0, 0)")
    return Enclosure(-_pi().high, _pi().high)


def _tanh_at(x: Enclosure) -> Enclosure:
    return _shifted(_times_whole(_shifted(_exp_at(_times_whole(x, 2)), 1).inverse(), 2).minus(), 1)


def _tan(x: Enclosure) -> Enclosure:
    c, s = _wave(x)
    return s.times(c.inverse())


_exp, _log, _atan, _asin = map(_rising, (_exp_at, _log_at, _atan_at, _asin_at))
_sinh = _rising(lambda x: _over(_exp_at(x).plus(_exp_at(x.minus()).minus()), 2))
_WORDS: Mapping[str, Callable[[Enclosure], Enclosure]] = {
    "exp": _exp, "log": _log, "atan": _atan, "asin": _asin, "sinh": _sinh, "tanh": _rising(_tanh_at), "tan": _tan,
    "acos": lambda x: _over(_pi(), 2).plus(_asin(x).minus()),
    "sin": lambda x: _wave(x)[1], "cos": lambda x: _wave(x)[0],
    "cosh": lambda x: _rising(lambda y: _over(_exp_at(y).plus(_exp_at(y.minus())), 2))(_size(x)),
}  # fmt: skip
