"""What is known before any rule: where a parameter lies, by its range, and the facts of a part of a formula."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, reduce
from operator import or_
from typing import Any, NamedTuple

from duhem.proof.kernel.term import NotWritten

__all__ = ["ANY", "NEGATIVE", "POSITIVE", "ZERO", "Bounds", "Facts", "Sign", "exact", "of_sum", "signs_of_product"]

Sign = int  # which of < 0, = 0, > 0 are possible; 0 for a part with no value
NEGATIVE, ZERO, POSITIVE = 1, 2, 4
ANY = NEGATIVE | ZERO | POSITIVE


class Bounds(NamedTuple):
    """Where a parameter lies; None is no end, ``open`` leaves the lower end out, ``open_high`` the upper one."""

    low: Fraction | None
    high: Fraction | None
    open: bool = False
    open_high: bool = False

    @classmethod
    def read(cls, entry: Mapping[str, Any]) -> Bounds:
        """``{"value": v}``, ``{"positive": true, "max": …}`` or ``{"min": …, "max": …}``, numbers as text."""
        ends = {key: None if end is None else exact(end) for key, end in entry.items() if key != "positive"}
        match sorted(entry):
            case ["value"] if ends["value"] is not None:
                return cls(ends["value"], ends["value"])
            case ["positive"] | ["max", "positive"] if entry["positive"] is True:
                return cls(Fraction(0), ends.get("max"), True)
            case [] | ["max"] | ["min"] | ["max", "min"]:
                return cls(ends.get("min"), ends.get("max"))
        raise NotWritten("a domain is none")

    @property
    def single(self) -> bool:
        """Whether it is one value."""
        return self.low is not None and self.low == self.high

    def sign(self) -> Sign:
        """The signs in it."""
        low, high = -1 if self.low is None else self.low.numerator, 1 if self.high is None else self.high.numerator
        zero = (low < 0 or (low == 0 and not self.open)) and (high > 0 or (high == 0 and not self.open_high))
        return (NEGATIVE if low < 0 else 0) | (POSITIVE if high > 0 else 0) | (ZERO if zero else 0)

    def holds(self, x: Fraction) -> bool:
        """Whether ``x`` lies in it."""
        return self.covers(Bounds(x, x))

    def covers(self, other: Bounds) -> bool:
        """Whether all of another lies in it."""
        return other == other.above(self.low, self.open).below(self.high, self.open_high)

    def above(self, end: Fraction | None, left_out: bool) -> Bounds:
        """What of it is >= ``end``, or > it; all of it where that is none."""
        known = end is None or (self.low is not None and (self.low, self.open) >= (end, left_out))
        return self if known else self._replace(low=end, open=left_out)

    def below(self, end: Fraction | None, left_out: bool) -> Bounds:
        """What of it is <= ``end``, or < it; all of it where that is none."""
        known = end is None or (self.high is not None and (-self.high, self.open_high) >= (-end, left_out))
        return self if known else self._replace(high=end, open_high=left_out)


def exact(text: object) -> Fraction:
    """The number in ``text``; no exponents, for a few letters of them make a number that fills the memory."""
    if not isinstance(text, str) or "e" in text.lower():
        raise NotWritten("a number is not given as text")
    return Fraction(text)


# -- facts -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Facts:
    """What is shown of a part: ``defined`` everywhere, its ``sign``, its curvature in the forces."""

    defined: bool = False
    sign: Sign = ANY
    convex: bool = False
    concave: bool = False
    quasiconvex: bool = False

    @property
    def affine(self) -> bool:
        """Convex and concave."""
        return self.convex and self.concave

    @property
    def nonnegative(self) -> bool:
        """>= 0 everywhere."""
        return not self.sign & NEGATIVE

    @property
    def convex_in_size(self) -> bool:
        """Whether |x| is convex."""
        return self.affine or (self.convex and self.nonnegative) or (self.concave and not self.sign & POSITIVE)

    def negated(self) -> Facts:
        """Of -x."""
        return Facts(self.defined, signs_of_product(self.sign, NEGATIVE), self.concave, self.convex, self.concave)


def of_sum(moving: Sequence[Facts], constants: Sequence[Facts] = ()) -> Facts:
    """Of a sum of parts, ``constants`` among them that depend on no force."""
    parts = (*moving, *constants)
    signs = [known.sign for known in parts if known.sign != ZERO]
    together = reduce(or_, signs or [ZERO])
    if together & NEGATIVE and together & POSITIVE:
        together = ANY
    elif any(not sign & ZERO for sign in signs):
        together &= ~ZERO
    convex, concave = all(known.convex for known in moving), all(known.concave for known in moving)
    quasi = convex or (len(moving) == 1 and moving[0].quasiconvex)
    return Facts(all(known.defined for known in parts), together, convex, concave, quasi)


@cache
def signs_of_product(a: Sign, b: Sign) -> Sign:
    """The signs that a product of one of ``a`` and one of ``b`` may have."""
    parts = {NEGATIVE: -1, ZERO: 0, POSITIVE: 1}
    found = {s * t for i, s in parts.items() for j, t in parts.items() if a & i and b & j}
    return sum(i for i, s in parts.items() if s in found)
