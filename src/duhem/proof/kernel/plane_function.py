"""Positively homogeneous functions of the plane, r^k F(v), as values: multiplied, added, raised to powers and bent.

Rays are told by a multiple v of tan(theta/2), and F is read at the point of a ray whose distance is a polynomial N = k + v^2, so that r is
one too.  F is a polynomial in v times powers of polynomials that are > 0; their coefficients and exponents are made of constants of a law.
Of degree 1, r h(theta) = F is convex where h + h'' >= 0 as a measure of the angle (R. Schneider 2014, Convex Bodies, section 1.7).  With
h = F/N and v = sqrt(k) tan(theta/2) that has the sign of N F'' - N' F' + 2 F: that is the bend of F.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.polynomial import ONE, Polynomial, in_powers, negated, number_in, slope, times, total
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.square_roots import root_of, roots_in
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
    far: int = 1  # k
    rooted = False  # whether square roots may stand in polynomials as further variables

    @property
    def distance(self) -> Polynomial:
        """N, how far from 0 the points of the rays are."""
        return {(): Fraction(self.far), ((RAY, 2),): Fraction(1)}

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
        """Polynomials and exponents of which a polynomial > 0 is the product: N as often as it divides it, and the rest."""
        count = 0
        while (less := self._without_distance(poly)) is not None:
            poly, count = less, count + 1
        return [(self.distance, {(): Fraction(count)}), (poly, ONE)]

    def _without_distance(self, poly: Polynomial) -> Polynomial | None:
        """Divided by N; None where that leaves a rest."""
        left, found = in_powers(poly, RAY), Polynomial()
        while len(left) > 2:
            top = left.pop()
            left[-2] = total(left[-2], times({(): Fraction(-self.far)}, top))
            found = total(found, times(top, {((RAY, len(left) - 2),) if len(left) > 2 else (): Fraction(1)}))
        return None if any(left) else found

    def shortened(self, value: PlaneFunction) -> PlaneFunction:
        """The same function, its polynomial as short as it is seen to be."""
        return value._replace(poly=self.plain(value.poly))

    def bend(self, value: PlaneFunction) -> Polynomial:
        """D^2 (N F'' - N' F' + 2 F)/W, which has the sign of h + h''."""
        found = derivatives(value, self.along)
        plainly = times(value.poly, times(found.over, found.over))
        turned = times(slope(self.distance, RAY), times(found.first, found.over))
        return self.plain(total(times(self.distance, found.second), negated(turned), times({(): Fraction(2)}, plainly)))

    def added(self, values: Sequence[PlaneFunction]) -> PlaneFunction:
        """The sum, with square roots as further variables where they differ."""
        try:
            return self.shortened(added(values))
        except NotWritten:
            if not self.rooted:
                raise
            return self.shortened(added(list(map(self._with_roots, values))))

    def _with_roots(self, value: PlaneFunction) -> PlaneFunction:
        """The same function, its powers of a half as polynomials."""
        poly, left = value.poly, dict[Base, Polynomial]()
        for base, e in value.powers.items():
            if dict(base) != self.distance and (root := _root_of_power(dict(base), number_in(e))) is not None:
                poly = times(poly, root)
            else:
                left[base] = e
        return self.shortened(value._replace(poly=poly, powers=left))

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
        roots = self.rooted and n is not None and n > 0 and n.denominator == 2
        positive = bool(value.poly) and self.above(value.poly, strict=True)
        if not value.poly or not (positive or (roots and self.above(value.poly))):
            raise NotWritten("what is divided by or under a root may be <= 0")
        found, left = ONE, raised_to(value.powers, exponent)
        for base, own in self.factors(value.poly):
            share = times(own, exponent)
            apart = base == self.distance or (positive and number_in(base) is None)
            if (root := _without_variable(base, number_in(share))) is None and self.rooted and not apart:
                root = _root_of_power(base, number_in(share))
            if root is None and not (positive or apart):
                raise NotWritten("what is under a root may be 0")
            found, left = (times(found, root), left) if root is not None else (found, widened(left, base, share))
        whole = value.whole and (n is None or n > 0)
        return self.shortened(PlaneFunction(value.degree * (n or 0), found, left, whole))

    def root(self, value: PlaneFunction) -> PlaneFunction:
        """F^(1/k) of degree 1, for F > 0 of degree k, as a product of powers alone."""
        powers = value.powers
        for base, own in self.factors(value.poly):
            powers = widened(powers, base, own)
        return PlaneFunction(Fraction(1), ONE, raised_to(powers, {(): 1 / value.degree}))


def _without_variable(base: Polynomial, e: Fraction | None) -> Polynomial | None:
    """base^e for a product of constants, e a whole number."""
    if len(base) != 1 or e is None or e.denominator > 1 or abs(e) > MOST_POWER:
        return None
    ((m, c),) = base.items()
    return None if any(RAY.name in x.names() for x, _ in m) else {tuple((x, n * int(e)) for x, n in m): c ** int(e)}


def _root_of_power(base: Polynomial, e: Fraction | None) -> Polynomial | None:
    """base^e, an odd power of its square root, as a polynomial, or any of that of a number; None where e is too large or something else."""
    half = Fraction(1, 3) if e is None else 2 * e
    if half.denominator > 1 or abs(half) > 2 * MOST_POWER or (half % 2 == 0 and number_in(base) is None):
        return None
    if any(RAY.name in w.names() for w in roots_in(base)):
        raise NotWritten("a root stands under a root")
    ((root, scale),) = root_of(base).items()
    return {tuple((x, k * int(half)) for x, k in root): scale ** int(half)}


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
