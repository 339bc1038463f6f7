"""Polynomials with whole coefficients over a common denominator, each monomial packed into one whole number.

x_0^a x_1^b ... is a + b B + ..., so that monomials are multiplied by adding.  Exponents may be negative: as long as all of them
stay below B/2 in size, no two monomials have one number.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import lcm
from typing import NamedTuple

from duhem.proof.kernel.polynomial import Polynomial
from duhem.proof.kernel.term import NotWritten, Term

__all__ = ["Packed", "Packing", "is_zero_sum", "product", "quadratic_form"]

_BASE, _HIGHEST, _MOST_FACTORS = 2**20, 2**12, 64
_MOST_PRODUCTS, _MOST_BITS = 4_000_000, 2**16


class Packed(NamedTuple):
    """``terms``/``below``, below > 0."""

    terms: dict[int, int]
    below: int


class Packing:
    """Which variable has which place."""

    def __init__(self) -> None:
        self._places: dict[Term, int] = {}

    def of(self, poly: Polynomial) -> Packed:
        """The polynomial packed; NotWritten where an exponent or a number is too long."""
        if any(abs(n) > _HIGHEST for m in poly for _, n in m):
            raise NotWritten("an exponent is too high")
        below = lcm(*(c.denominator for c in poly.values()))
        _check_bits(below)
        return Packed({self._key(m): c.numerator * (below // c.denominator) for m, c in poly.items()}, below)

    def _key(self, monomial: Iterable[tuple[Term, int]]) -> int:
        return sum(n * _BASE ** self._places.setdefault(x, len(self._places)) for x, n in monomial)


def _check_bits(*numbers: int) -> None:
    if any(n.bit_length() > _MOST_BITS for n in numbers):
        raise NotWritten("a number is too long")


def _times(one: dict[int, int], two: dict[int, int]) -> dict[int, int]:
    if len(one) * len(two) > _MOST_PRODUCTS:
        raise NotWritten("a product has too many terms")
    found: dict[int, int] = {}
    for m, c in one.items():
        for n, d in two.items():
            found[m + n] = found.get(m + n, 0) + c * d
    return {m: c for m, c in found.items() if c}


def product(factors: Sequence[Packed]) -> Packed:
    """Of all of them; 1 for none."""
    if len(factors) > _MOST_FACTORS:
        raise NotWritten("a product has too many factors")
    terms, below = {0: 1}, 1
    for f in factors:
        terms, below = _times(terms, f.terms), below * f.below
    _check_bits(below, *terms.values())
    return Packed(terms, below)


def quadratic_form(squares: Sequence[Packed], gram: Sequence[Sequence[Fraction]]) -> Packed:
    """z' G z for the polynomials z."""
    below = lcm(*(z.below for z in squares))
    level = [{m: c * (below // z.below) for m, c in z.terms.items()} for z in squares]
    under = lcm(*(g.denominator for row in gram for g in row))
    _check_bits(below, under)
    found: dict[int, int] = {}
    for z, row in zip(level, gram, strict=True):
        combined: dict[int, int] = {}
        for g, other in zip(row, level, strict=True):
            if g:
                scaled = g.numerator * (under // g.denominator)
                for m, c in other.items():
                    combined[m] = combined.get(m, 0) + scaled * c
        for m, c in _times(z, combined).items():
            found[m] = found.get(m, 0) + c
    return Packed(found, below * below * under)


def is_zero_sum(parts: Sequence[Packed]) -> bool:
    """Whether they add up to 0."""
    below = lcm(*(p.below for p in parts))
    found: dict[int, int] = {}
    for p in parts:
        for m, c in p.terms.items():
            found[m] = found.get(m, 0) + c * (below // p.below)
    return not any(found.values())
