"""Intervals between whole multiples of 2^-96, rounded outward: sums, products, quotients, roots; jets of them along an angle.

R. E. Moore (1966), Interval analysis.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import isqrt
from typing import NamedTuple

from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, Sign

__all__ = ["BITS", "AngleJet", "Enclosure"]

BITS = 96


class Enclosure(NamedTuple):
    """Every number from ``low`` to ``high``, both in units of 2^-96."""

    low: int
    high: int

    @classmethod
    def between(cls, low: Fraction, high: Fraction) -> Enclosure:
        """The least that holds both."""
        return cls((low.numerator << BITS) // low.denominator, -((-high.numerator << BITS) // high.denominator))

    @property
    def sign(self) -> Sign:
        """The signs in it."""
        below, above = NEGATIVE if self.low < 0 else 0, POSITIVE if self.high > 0 else 0
        return below | above | (ZERO if self.low <= 0 <= self.high else 0)

    def plus(self, other: Enclosure) -> Enclosure:
        """x + y."""
        return Enclosure(self.low + other.low, self.high + other.high)

    def minus(self) -> Enclosure:
        """-x."""
        return Enclosure(-self.high, -self.low)

    def times(self, other: Enclosure) -> Enclosure:
        """x y."""
        ends = (self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high)
        return Enclosure(min(ends) >> BITS, -(-max(ends) >> BITS))

    def inverse(self) -> Enclosure:
        """1/x; ZeroDivisionError where x may be 0."""
        if self.sign & ZERO:
            raise ZeroDivisionError("an interval holds 0")
        return Enclosure((1 << 2 * BITS) // self.high, -(-(1 << 2 * BITS) // self.low))

    def root(self) -> Enclosure:
        """The square root; ValueError where x may be < 0."""
        return Enclosure(isqrt(self.low << BITS), isqrt(self.high << BITS) + 1)


class AngleJet(NamedTuple):
    """A function of an angle with its first two derivatives, over some angles."""

    value: Enclosure
    first: Enclosure
    second: Enclosure

    def plus(self, other: AngleJet) -> AngleJet:
        """f + g."""
        return AngleJet(*map(Enclosure.plus, self, other))

    def times(self, other: AngleJet) -> AngleJet:
        """f g, by Leibniz' rule."""
        (f, df, ddf), (g, dg, ddg) = self, other
        cross = df.times(dg)
        return AngleJet(f.times(g), df.times(g).plus(f.times(dg)), ddf.times(g).plus(cross.plus(cross)).plus(f.times(ddg)))

    def inverse(self) -> AngleJet:
        """1/f."""
        one = self.value.inverse()
        return self._outer(one, lambda r: r.times(r).minus(), lambda r: r.times(r).times(r).plus(r.times(r).times(r)))

    def root(self) -> AngleJet:
        """The square root, where f > 0; ZeroDivisionError where f may be 0."""
        r = self.value.root()
        half = r.plus(r).inverse()
        return self._outer(r, lambda _: half, lambda _: half.times(half).times(r.inverse()).minus())

    def _outer(self, value: Enclosure, first: Callable[[Enclosure], Enclosure], second: Callable[[Enclosure], Enclosure]) -> AngleJet:
        """h(f), with h' and h'' given from h's value."""
        slope, bend = first(value), second(value)
        square = self.first.times(self.first)
        return AngleJet(value, slope.times(self.first), bend.times(square).plus(slope.times(self.second)))
