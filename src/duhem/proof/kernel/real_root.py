"""A real algebraic number: the root of a polynomial between two fractions, or one fraction."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from duhem.proof.kernel.domain import exact
from duhem.proof.kernel.polynomial import Polynomial
from duhem.proof.kernel.signs import Line, divided_by, line, roots_between, sign_at
from duhem.proof.kernel.stated_law import as_list, without_more
from duhem.proof.kernel.term import NotWritten

__all__ = ["RealRoot"]

_MOST_DEGREE = 24


class RealRoot(NamedTuple):
    """The one root of ``poly`` in (low, high), at which it changes its sign; the number ``low`` where that is ``high``."""

    poly: Line
    low: Fraction
    high: Fraction

    @classmethod
    def of(cls, x: Fraction) -> RealRoot:
        """A fraction."""
        return cls((-x.numerator, x.denominator), x, x)

    @classmethod
    def read(cls, given: Mapping[str, Any]) -> RealRoot:
        """``{"value": "1/2"}``, or ``{"polynomial": ["-2", "0", "1"], "enclosure": ["1", "3/2"]}``, the coefficient of 1 first."""
        if "value" in given:
            return cls.of(exact(without_more(given, {"value"})["value"]))
        low, high = map(exact, as_list(without_more(given, {"polynomial", "enclosure"})["enclosure"]))
        poly = line(map(exact, as_list(given["polynomial"])))
        if not 2 < len(poly) <= _MOST_DEGREE + 1 or not low < high or sign_at(poly, low) * sign_at(poly, high) >= 0:
            raise NotWritten("a number is no root of its polynomial between its ends")
        if roots_between(poly, low, high) != 1:
            raise NotWritten("a polynomial has several roots between two ends")
        return cls(poly, low, high)

    def written(self) -> dict[str, Any]:
        """As :meth:`read` takes it."""
        if self.exact:
            return {"value": str(self.low)}
        return {"polynomial": [str(c) for c in self.poly], "enclosure": [str(self.low), str(self.high)]}

    @property
    def exact(self) -> bool:
        """Whether it is known as a fraction."""
        return self.low == self.high

    def below(self, other: RealRoot) -> bool:
        """Whether it is seen to be less than another."""
        return self.high < other.low or (self.high == other.low and not (self.exact and other.exact))

    def reduced(self, poly: Polynomial) -> Polynomial:
        """A polynomial with the same value where the variable is this number: its rest by the polynomial of the number."""
        return poly if self.exact else divided_by(poly, self.poly)[1]
