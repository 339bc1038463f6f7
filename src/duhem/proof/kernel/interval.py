"""Intervals between whole multiples of 2^-96, rounded outward: sums, products, quotients, roots; jets of them along an angle.

R. E. Moore (1966), Interval analysis.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from duhem.proof.kernel.constant_value import Enclosure

__all__ = ["AngleJet", "Enclosure"]


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
