"""Positively homogeneous functions of the plane, r^k F(v), as values: multiplied, added, raised to powers and bent.

v is a variable that tells the angle theta, such as cos 3 theta.  F is a polynomial in v times powers of polynomials that are > 0; their
coefficients and exponents are made of constants of a law.  Of degree 1, r h(theta) is convex where h + h'' >= 0 as a measure of the angle
(R. Schneider 2014, Convex Bodies, section 1.7).  Up to a positive factor h + h'' is a F'' + b F' + c F, with three polynomials a, b, c that
the choice of v gives: that is the bend of F.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any, ClassVar, NamedTuple

from duhem.proof.kernel.algebraic import root_of, roots_in
from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.polynomial import ONE, Polynomial, negated, number_in, slope, times, total
from duhem.proof.kernel.positivity import RAY
from duhem.proof.kernel.term import NotWritten

__all__ = [
    "MOST_POWER", "Base", "Derivatives", "PlaneFunction", "PlaneVariable", "added", "base_of", "derivatives", "multiplied", "power_of",
    "raised_to", "widened",
]  # fmt: skip

MOST_POWER = 24
Base = tuple[tuple[Any, Fraction], ...]  # a polynomial > 0, as its terms in order


class PlaneFunction(NamedTuple):
    """r^degree times ``poly`` times positive polynomials, each to the power, a polynomial of constants, that ``powers`` gives.

    ``whole`` says that the formula has a value at r = 0 as well: 0 where the degree is above 0.
    """

    degree: Fraction
    poly: Polynomial
    powers: Mapping[Base, Polynomial]
    whole: bool = True


def multiplied(values: Iterable[PlaneFunction]) -> PlaneFunction:
    """The product; a factor of degree 0 is bounded, so that it has a value at r = 0 if another factor is 0 there."""
    values = list(values)
    degree, poly, powers = Fraction(0), ONE, dict[Base, Polynomial]()
    for value in values:
        degree, poly = degree + value.degree, times(poly, value.poly)
        for base, e in value.powers.items():
            powers[base] = total(powers.get(base, {}), e)
    whole = all(v.whole for v in values) or (
        all(v.whole or v.degree == 0 for v in values) and any(v.whole and v.degree > 0 for v in values)
    )
    return PlaneFunction(degree, poly, {base: e for base, e in powers.items() if e}, whole)


def added(values: Sequence[PlaneFunction]) -> PlaneFunction:
    """The sum, the powers that all have in common kept apart; a whole power that one has and another lacks is multiplied out.

    NotWritten where they have different degrees or roots.
    """
    whole = all(v.whole for v in values)
    values = [v for v in values if v.poly] or [v._replace(powers={}) for v in values[:1]]
    if len({v.degree for v in values}) != 1:
        raise NotWritten("different degrees are added")
    shared: dict[Base, Polynomial] = {}
    for base in {base for v in values for base in v.powers}:
        powers = [v.powers.get(base, {}) for v in values]
        apart = [number_in(total(e, negated(powers[0]))) for e in powers]
        known = [n for n in apart if n is not None and n.denominator == 1]
        if len(known) < len(apart):
            raise NotWritten("different roots are added")
        shared[base] = total(powers[0], {(): min(known)})
    poly: Polynomial = {}
    for value in values:
        part = value.poly
        for base, least in shared.items():
            left = number_in(total(value.powers.get(base, {}), negated(least))) or 0
            part = times(part, power_of(dict(base), int(left)))
        poly = total(poly, part)
    return PlaneFunction(values[0].degree, poly, {base: e for base, e in shared.items() if e}, whole)


class Derivatives(NamedTuple):
    """Of F = P W with W a product of powers: with D > 0 the polynomials D, D F'/W and D^2 F''/W."""

    over: Polynomial
    first: Polynomial
    second: Polynomial


def derivatives(value: PlaneFunction, along: Callable[[Polynomial], Polynomial]) -> Derivatives:
    """The derivatives by v; ``along`` differentiates a polynomial.  With W'/W = N/D, D is the product of the bases that vary."""
    poly, d, n = value.poly, ONE, Polynomial()
    for base, e in value.powers.items():
        own = dict(base)
        if rate := along(own):
            n = total(times(n, own), times(times(e, rate), d))
            d = times(d, own)
    once = along(poly)
    spread = total(times(along(n), d), negated(times(n, along(d))), times(n, n))  # D^2 W''/W
    second = total(times(along(once), times(d, d)), times({(): Fraction(2)}, times(once, times(n, d))), times(poly, spread))
    return Derivatives(d, total(times(once, d), times(poly, n)), second)


class PlaneVariable(ABC):
    """A variable v that tells the angle, over some angles and the whole ``domain`` of a law."""

    domain: StatedDomain
    weights: ClassVar[tuple[Polynomial, Polynomial, Polynomial]]  # a, b and c: h + h'' is a positive multiple of a F'' + b F' + c F

    @abstractmethod
    def above(self, poly: Polynomial, strict: bool = False) -> bool:
        """Whether a polynomial in v is >= 0, or > 0, at all of the angles over the whole domain."""

    def plain(self, poly: Polynomial) -> Polynomial:
        """The same polynomial, as short as it is seen to be."""
        return poly

    def along(self, poly: Polynomial) -> Polynomial:
        """Its derivative by v."""
        return slope(poly, RAY)

    def factors(self, poly: Polynomial) -> list[tuple[Polynomial, Polynomial]]:
        """Polynomials and exponents of which a polynomial > 0 is the product."""
        return [(poly, ONE)]

    def rooted(self, poly: Polynomial) -> bool:
        """Whether the square root of a polynomial counts as one more variable of polynomials, and is not kept apart as a power."""
        return False

    def shortened(self, value: PlaneFunction) -> PlaneFunction:
        """The same function, its polynomial as short as it is seen to be."""
        return value._replace(poly=self.plain(value.poly))

    def bend(self, value: PlaneFunction) -> Polynomial:
        """D^2 (a F'' + b F' + c F)/W, which has the sign of h + h''."""
        found, (a, b, c) = derivatives(value, self.along), self.weights
        plainly = times(value.poly, times(found.over, found.over))
        return self.plain(total(times(a, found.second), times(b, times(found.first, found.over)), times(c, plainly)))

    def power(self, value: PlaneFunction, exponent: Polynomial) -> PlaneFunction:
        """The value to a power that is a constant; NotWritten where it is not shown to have one."""
        n = number_in(exponent)
        if n is not None and n.denominator == 1 and 0 <= n <= MOST_POWER:
            return self.shortened(multiplied([value] * int(n))._replace(whole=value.whole))
        return self.positive_power(value, exponent)

    def positive_power(self, value: PlaneFunction, exponent: Polynomial) -> PlaneFunction:
        """The value to a power, for one that is shown to be > 0, or >= 0 under a square root; without a polynomial where that is none."""
        n = number_in(exponent)
        if n is None and value.degree:
            raise NotWritten("an exponent varies")
        roots = n is not None and n > 0 and n.denominator == 2 and n <= MOST_POWER and self.rooted(value.poly)
        if not value.poly or not self.above(value.poly, strict=not roots):
            raise NotWritten("what is divided by or under a root may be <= 0")
        found, left = ONE, dict[Base, Polynomial]()
        for base, own in [*self.factors(value.poly), *((dict(b), e) for b, e in value.powers.items())]:
            share = times(own, exponent)
            half = (number_in(share) or Fraction(0)) * 2 if n is not None else Fraction(0)
            if half.denominator == 1 and abs(half) <= 2 * MOST_POWER and self.rooted(base) and (half % 2 or number_in(base) is not None):
                if any(RAY.name in w.names() for w in roots_in(base)):
                    raise NotWritten("a root stands under a root")
                ((root, scale),) = root_of(base).items()
                found = times(found, {tuple((x, k * int(half)) for x, k in root): scale ** int(half)})
            else:
                left = widened(left, base, share)
        whole = value.whole and (n is None or n > 0)
        return self.shortened(PlaneFunction(value.degree * (n or 0), found, left, whole))

    def root(self, value: PlaneFunction) -> PlaneFunction:
        """F^(1/k) of degree 1, for F > 0 of degree k, as a product of powers alone."""
        powers = widened(value.powers, value.poly, ONE)
        return PlaneFunction(Fraction(1), ONE, raised_to(powers, {(): 1 / value.degree}))


def widened(powers: Mapping[Base, Polynomial], poly: Polynomial, e: Polynomial) -> dict[Base, Polynomial]:
    """The powers times one positive polynomial more, to the power e."""
    base = base_of(poly)
    found = {**powers, base: total(powers.get(base, {}), e)}
    return {b: n for b, n in found.items() if n and dict(b) != ONE}


def raised_to(powers: Mapping[Base, Polynomial], e: Polynomial) -> dict[Base, Polynomial]:
    """Every power times e."""
    return {base: times(n, e) for base, n in powers.items()}


def power_of(poly: Polynomial, n: int) -> Polynomial:
    """poly^n, multiplied out."""
    if n > MOST_POWER:
        raise NotWritten("a power is too high")
    found = ONE
    for _ in range(n):
        found = times(found, poly)
    return found


def base_of(poly: Polynomial) -> Base:
    """A polynomial as a key."""
    return tuple(sorted(poly.items()))
