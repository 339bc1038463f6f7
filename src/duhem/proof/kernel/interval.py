"""Intervals between whole multiples of 2^-96, rounded outward: sums, products, quotients, roots; jets of them along an angle.

R. E. Moore (1966), Interval analysis.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import isqrt
from typing import NamedTuple

from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, Sign

__all__ = ["Interval", "Jet"]

_BITS = 96


class Interval(NamedTuple):
    """Every number from ``low`` to ``high``, both in units of 2^-96."""

    low: int
    high: int

    @classmethod
    def between(cls, low: Fraction, high: Fraction) -> Interval:
        """The least that holds both."""
        return cls((low.numerator << _BITS) // low.denominator, -((-high.numerator << _BITS) // high.denominator))

    @property
    def sign(self) -> Sign:
        """The signs in it."""
        below, above = NEGATIVE if self.low < 0 else 0, POSITIVE if self.high > 0 else 0
        return below | above | (ZERO if self.low <= 0 <= self.high else 0)

    def plus(self, other: Interval) -> Interval:
        """x + y."""
        return Interval(self.low + other.low, self.high + other.high)

    def minus(self) -> Interval:
        """-x."""
        return Interval(-self.high, -self.low)

    def times(self, other: Interval) -> Interval:
        """x y."""
        ends = (self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high)
        return Interval(min(ends) >> _BITS, -(-max(ends) >> _BITS))

    def inverse(self) -> Interval:
        """1/x; ZeroDivisionError where x may be 0."""
        if self.sign & ZERO:
            raise ZeroDivisionError("an interval holds 0")
        return Interval((1 << 2 * _BITS) // self.high, -(-(1 << 2 * _BITS) // self.low))

    def root(self) -> Interval:
        """The square root; ValueError where x may be < 0."""
        return Interval(isqrt(self.low << _BITS), isqrt(self.high << _BITS) + 1)


class Jet(NamedTuple):
    """A function of an angle with its first two derivatives, over some angles."""

    value: Interval
    first: Interval
    second: Interval

    def plus(self, other: Jet) -> Jet:
        """f + g."""
        return Jet(*(x.plus(y) for x, y in zip(self, other, strict=True)))

    def times(self, other: Jet) -> Jet:
        """f g, by Leibniz' rule."""
        (f, df, ddf), (g, dg, ddg) = self, other
        cross = df.times(dg)
        return Jet(f.times(g), df.times(g).plus(f.times(dg)), ddf.times(g).plus(cross.plus(cross)).plus(f.times(ddg)))

    def inverse(self) -> Jet:
        """1/f."""
        one = self.value.inverse()
        return self._outer(one, lambda r: r.times(r).minus(), lambda r: r.times(r).times(r).plus(r.times(r).times(r)))

    def root(self) -> Jet:
        """The square root, where f > 0; ZeroDivisionError where f may be 0."""
        r = self.value.root()
        half = r.plus(r).inverse()
        return self._outer(r, lambda _: half, lambda _: half.times(half).times(r.inverse()).minus())

    def _outer(self, value: Interval, first: Callable[[Interval], Interval], second: Callable[[Interval], Interval]) -> Jet:
        """h(f), with h' and h'' given from h's value."""
        slope, bend = first(value), second(value)
        square = self.first.times(self.first)
        return Jet(value, slope.times(self.first), bend.times(square).plus(slope.times(self.second)))
