"""Signs of polynomials of one variable on an interval, in whole numbers: Sturm's theorem, roots of even multiplicity told apart.

A polynomial is the tuple of its coefficients, that of 1 first, none at the top 0; a positive factor is as good as none.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import pairwise
from math import gcd, lcm

__all__ = ["Line", "divides", "joined", "line", "nonnegative", "parts", "roots", "sign_inside"]

Line = tuple[int, ...]
_FINEST = Fraction(1, 2**30)  # a root is enclosed at least as finely as this


def line(coefficients: Iterable[Fraction]) -> Line:
    """The polynomial with these coefficients."""
    given = list(coefficients)
    scale = lcm(*(c.denominator for c in given))
    return _reduced([int(c * scale) for c in given])


def _reduced(p: list[int]) -> Line:
    while p and not p[-1]:
        p.pop()
    shared = gcd(*p)
    return tuple(c // shared for c in p)


def _sign(p: Line, x: Fraction) -> int:
    """The sign of p(x)."""
    value, power = 0, 1
    for c in reversed(p):
        value, power = value * x.numerator + c * power, power * x.denominator
    return (value > 0) - (value < 0)


def _remainder(p: Line, q: Line) -> Line:
    """Of p by q, up to a positive factor."""
    rest, lead, way = list(p), abs(q[-1]), 1 if q[-1] > 0 else -1
    while len(rest) >= len(q):
        top, shift = way * rest[-1], len(rest) - len(q)
        rest = [lead * c for c in rest]
        for i, c in enumerate(q):
            rest[i + shift] -= top * c
        while rest and not rest[-1]:
            rest.pop()
    return _reduced(rest)


def _quotient(p: Line, q: Line) -> Line:
    """p/q where q divides p; both are free of common factors, so the quotient is whole."""
    rest, found = list(p), [0] * (len(p) - len(q) + 1)
    for shift in reversed(range(len(found))):
        found[shift], left = divmod(rest[shift + len(q) - 1], q[-1])
        if left:
            raise ValueError("it does not divide")
        for i, c in enumerate(q):
            rest[i + shift] -= found[shift] * c
    if any(rest):
        raise ValueError("it does not divide")
    return _reduced(found)


def _chain(p: Line, q: Line) -> list[Line]:
    """Euclid's remainders of p and q, with Sturm's signs; the last one is their greatest common divisor."""
    found = [p]
    while q:
        found.append(q)
        p, q = q, tuple(-c for c in _remainder(p, q))
    return found


def _slope(p: Line) -> Line:
    return _reduced([i * c for i, c in enumerate(p)][1:])


def parts(p: Line) -> tuple[Line, Line]:
    """The roots of p != 0 once each, and those of odd multiplicity once each."""
    shared = _chain(p, _slope(p))[-1]  # every root once less often than in p
    every = _quotient(p, shared)
    if len(shared) == 1:
        return every, every
    repeated = _chain(shared, every)[-1]
    odd = parts(_quotient(shared, repeated))[1]  # every repeated root twice less often than in p
    return every, _product(_quotient(every, repeated), odd)


def _product(p: Line, q: Line) -> Line:
    found = [0] * (len(p) + len(q) - 1)
    for i, c in enumerate(p):
        for j, d in enumerate(q):
            found[i + j] += c * d
    return _reduced(found)


def joined(p: Line, q: Line) -> Line:
    """The roots of both, once each if they are so in each."""
    return _product(p, _quotient(q, _chain(p, q)[-1]))


def divides(p: Line, q: Line) -> bool:
    """Whether q is a multiple of p."""
    return not _remainder(q, p)


def _count(chain: list[Line], low: Fraction, high: Fraction) -> int:
    """How many roots the first of a Sturm chain without repeated roots has in (low, high]."""
    return _changes(chain, low) - _changes(chain, high)


def _changes(chain: list[Line], x: Fraction) -> int:
    signs = [s for s in (_sign(p, x) for p in chain) if s]
    return sum(s != t for s, t in pairwise(signs))


def nonnegative(p: Line, low: Fraction, high: Fraction, strict: bool = False) -> bool:
    """Whether p >= 0, or p > 0, on [low, high]."""
    if not p:
        return not strict
    if low == high or len(p) == 1 or (strict and _sign(p, low) <= 0):
        return _sign(p, low) > -(not strict)
    crossed = parts(p)[not strict]
    inside = _count(_chain(crossed, _slope(crossed)), low, high) - (not strict and _sign(crossed, high) == 0)
    return inside == 0 and sign_inside(p, low, high) > 0


def sign_inside(p: Line, low: Fraction, high: Fraction) -> int:
    """The sign of p != 0 at a point between, not at a root."""
    steps = len(p) + 1
    return next(s for k in range(1, steps) if (s := _sign(p, low + (high - low) * Fraction(k, steps))))


def roots(p: Line, low: Fraction, high: Fraction) -> Iterator[tuple[Fraction, Fraction]]:
    """Each root of p, none of them repeated, strictly between: the least first, exactly or between two numbers that are none."""
    chain = _chain(p, _slope(p))

    def between(a: Fraction, b: Fraction) -> Iterator[tuple[Fraction, Fraction]]:
        inside = _count(chain, a, b) - (_sign(p, b) == 0)
        if inside == 1 and b - a <= _FINEST and _sign(p, a) and _sign(p, b):
            yield a, b
        elif inside:
            middle = (a + b) / 2
            yield from between(a, middle)
            if _sign(p, middle) == 0:
                yield middle, middle
            yield from between(middle, b)

    return between(low, high)
