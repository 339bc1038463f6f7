"""Polynomials of one variable with constants of a law as coefficients: >= 0 on an interval, over the whole domain.

A constant x between two ends is written as the mean of them with weights 1 and u >= 0 (or as its distance from the one end);
with n its degree, (1 + u)^n P is a polynomial in u whose coefficients are P's Bernstein coefficients.  Where none of them is
< 0, neither is P; where besides their sum is > 0, so is P between the ends.  One constant after another is removed so; the
variable itself is left to Sturm's theorem.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, StatedDomain
from duhem.proof.kernel.line import Line, line
from duhem.proof.kernel.line import nonnegative as nonnegative_on_the_line
from duhem.proof.kernel.polynomial import Polynomial, in_powers, joined, times, total, written
from duhem.proof.kernel.term import NotWritten, Term

__all__ = ["RAY", "nonnegative", "on_the_line", "without_content"]

RAY = Term("name", name="the ray's")  # no name of a law has blanks
_MOST_HALVINGS = 3
_MOST_DEGREE = 80  # about ten seconds of Sturm's theorem
_A_SHARE = 4  # what one is worth in products of terms
Interval = tuple[Fraction, Fraction]


class Reach(NamedTuple):
    """Where a constant lies: from ``near`` to ``far``, or without end to one ``side``; an end that is ``open`` is none of its values."""

    near: Fraction
    near_open: bool
    far: Fraction | None
    far_open: bool = False
    side: int = 1


def without_content(poly: Polynomial, domain: StatedDomain) -> Polynomial:
    """The polynomial without the constants != 0 that divide all of it, its sign kept."""
    for x in {x for m in poly for x, _ in m if x != RAY}:
        least, own = min(dict(m).get(x, 0) for m in poly), domain.of(x)
        if own in (NEGATIVE, POSITIVE):
            turn = Fraction(-1 if own == NEGATIVE and least % 2 else 1)
            poly = {joined(m, ((x, -least),)): c * turn for m, c in poly.items()}
        elif least < 0:
            raise NotWritten("a constant that may be 0 divides")
    return poly


def on_the_line(poly: Polynomial) -> Line | None:
    """A polynomial of the variable alone; None if constants are left in it."""
    coefficients = in_powers(poly, RAY)
    if len(coefficients) > _MOST_DEGREE:
        raise NotWritten("a polynomial is too long")
    return line([c.get((), Fraction(0)) for c in coefficients]) if all(set(c) <= {()} for c in coefficients) else None


def nonnegative(poly: Polynomial, between: Interval, domain: StatedDomain, strict: bool = False) -> bool:
    """Whether P >= 0, or P > 0, where the variable is ``between`` the ends and the constants are what they may be."""
    if between[0] >= 0 and all(n % 2 == 0 for m in poly for x, n in m if x == RAY):  # a polynomial in its square
        poly = {tuple((x, n // 2 if x == RAY else n) for x, n in m): c for m, c in poly.items()}
        between = between[0] ** 2, between[1] ** 2
    if _nonnegative_in_ranges(poly, between, domain, strict):
        return True
    moving = any(x == RAY for m in poly for x, _ in m)  # of a constant the constraints are asked by who asks for its sign
    return bool(moving and domain.law.constraints) and not strict and _nonnegative_with_constraints(poly, between, domain, _MOST_HALVINGS)


def _nonnegative_with_constraints(poly: Polynomial, between: Interval, domain: StatedDomain, halvings: int) -> bool:
    """Whether the shares of a P in the powers of its variable are >= 0 by ranges and constraints together, perhaps in parts of the way."""
    low, high = between
    shares = _shares(in_powers(without_content(poly, domain), RAY), Reach(low, False, high))
    if all(domain.nonnegative(written(share)) for share in shares):
        return True
    middle = (low + high) / 2
    parts = ((low, middle), (middle, high)) if halvings and low < high else ()
    return bool(parts) and all(_nonnegative_with_constraints(poly, part, domain, halvings - 1) for part in parts)


def _nonnegative_in_ranges(poly: Polynomial, between: Interval, domain: StatedDomain, strict: bool) -> bool:
    """The same, each constant being anywhere in its own range."""
    poly = without_content(poly, domain)
    if (plain := on_the_line(poly)) is not None:
        return nonnegative_on_the_line(plain, *between, strict)
    x = min(x for m in poly for x, _ in m if x != RAY)
    coefficients = in_powers(poly, x)
    for reach in _reaches(x, domain):
        domain.spend(_A_SHARE * len(poly) * len(coefficients))
        if not _nonnegative(_shares(coefficients, reach), reach, between, domain, strict):
            return False
    return True


def _nonnegative(shares: list[Polynomial], reach: Reach, between: Interval, domain: StatedDomain, strict: bool) -> bool:
    if not all(_nonnegative_in_ranges(share, between, domain, False) for share in shares):
        return False
    values = [total(*shares)]
    values += [] if reach.near_open else [shares[0]]
    values += [] if reach.far is None or reach.far_open else [shares[-1]]
    return not strict or all(_nonnegative_in_ranges(value, between, domain, True) for value in values)


def _shares(coefficients: list[Polynomial], reach: Reach) -> list[Polynomial]:
    """What the powers of u >= 0 have in (c + d u)^n P((a + b u)/(c + d u)), where (a + b u)/(c + d u) runs from near to far."""
    without_end, degree = reach.far is None, len(coefficients) - 1
    above = (reach.near, Fraction(reach.side) if reach.far is None else reach.far)
    below = (Fraction(1), Fraction(not without_end))
    found: list[Polynomial] = [{} for _ in coefficients]
    for k, c in enumerate(coefficients):
        weights = [Fraction(1)]
        for a, b in [above] * k + [below] * (degree - k):
            weights = [a * p + b * q for p, q in zip([*weights, Fraction(0)], [Fraction(0), *weights], strict=True)]
        for j, weight in enumerate(weights):
            found[j] = total(found[j], times({(): weight}, c))
    return found


def _reaches(x: Term, domain: StatedDomain) -> Iterator[Reach]:
    """Where a constant may lie, what has no end is cut at 0."""
    sign = domain.of(x)
    others = Bounds(None if sign & NEGATIVE else Fraction(0), None if sign & POSITIVE else Fraction(0), not sign & ZERO, not sign & ZERO)
    low, high, low_open, high_open = domain.bounds.get(x.name, others)
    if low is not None and high is not None:
        yield Reach(low, low_open, high, high_open)
    elif low is not None:
        yield Reach(low, low_open, None)
    elif high is not None:
        yield Reach(high, high_open, None, side=-1)
    else:
        yield from (Reach(Fraction(0), False, None, side=side) for side in (1, -1))
