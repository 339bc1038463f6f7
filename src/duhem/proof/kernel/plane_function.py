"""Positively homogeneous functions of the plane, r^k F(v), as values: multiplied, added, raised to powers and bent.

Rays are told by a multiple v of tan(theta/2), and F is read at the point of a ray whose distance is a polynomial N = k + v^2, so that r is
one too.  F is a polynomial in v times powers of polynomials that are > 0; their coefficients and exponents are made of constants of a law.
Of degree 1, r h(theta) = F is convex where h + h'' >= 0 as a measure of the angle (R. Schneider 2014, Convex Bodies, section 1.7).  With
h = F/N and v = sqrt(k) tan(theta/2) that has the sign of N F'' - N' F' + 2 F: that is the bend of F.

Polynomials may have square roots of such polynomials as further variables: they are differentiated, put at a point, and have signs.
A root is a term x**(1/2) of which the whole powers count; that of a number stands as roots of primes.  It is >= 0 where it is defined.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from typing import Any, NamedTuple

from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.polynomial import ONE, Polynomial, grouped, in_powers, negated, number_in, replaced, slope, times, total, written
from duhem.proof.kernel.signs import RAY, Interval, divided_by, line, nonnegative, parts
from duhem.proof.kernel.term import HALF, NotWritten, Term, number

__all__ = [
    "MOST_POWER", "Base", "PlaneFunction", "PlaneVariable", "Signs", "added", "base_of", "derivatives", "inner", "multiplied", "plain",
    "power_of", "roots_in", "slope_along", "sqrt",
]  # fmt: skip

MOST_POWER = 24
Base = tuple[tuple[Any, Fraction], ...]  # a polynomial > 0, as its terms in order
_PRIMES = (2, 3, 5, 7, 11, 13)
_LOWEST, _DEEPEST = -40, 3  # of powers of a root, and of squarings


class PlaneFunction(NamedTuple):
    """r^degree times ``poly`` times positive polynomials, each to the power, a polynomial of constants, that ``powers`` gives.

    All but r^degree is bounded, so that where the degree is above 0 it tends to 0 at r = 0, whatever the formula divides by there.
    """

    degree: Fraction
    poly: Polynomial
    powers: Mapping[Base, Polynomial]

    def roots(self) -> set[Term]:
        """The roots it is written in."""
        return {w for p in (self.poly, *map(dict, self.powers), *self.powers.values()) for w in roots_in(p)}


def multiplied(values: Iterable[PlaneFunction]) -> PlaneFunction:
    """The product."""
    degree, poly, powers = Fraction(0), ONE, dict[Base, Polynomial]()
    for value in values:
        degree, poly = degree + value.degree, times(poly, value.poly)
        for base, e in value.powers.items():
            powers[base] = total(powers.get(base, {}), e)
    return PlaneFunction(degree, poly, {base: e for base, e in powers.items() if e})


def added(values: Sequence[PlaneFunction]) -> PlaneFunction:
    """The sum, the powers that all have in common kept apart; a whole power that one has and another lacks is multiplied out.

    NotWritten where they have different degrees or roots.
    """
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
    return PlaneFunction(values[0].degree, poly, {base: e for base, e in shared.items() if e})


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
        """The same polynomial, its roots as short as they are seen to be."""
        return plain(poly, self.domain) if self.rooted else poly

    def along(self, poly: Polynomial) -> Polynomial:
        """Its derivative by v."""
        return slope_along(poly, self.domain) if self.rooted else slope(poly, RAY)

    def factors(self, poly: Polynomial) -> list[tuple[Polynomial, Polynomial]]:
        """Polynomials and exponents of which a polynomial > 0 is the product: N as often as it divides it, and the rest."""
        count = 0
        while not (split := divided_by(poly, (self.far, 0, 1)))[1]:
            poly, count = split[0], count + 1
        return [(self.distance, {(): Fraction(count)}), (poly, ONE)]

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
            return self.shortened(multiplied([value] * int(n)))
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
        return self.shortened(PlaneFunction(value.degree * (n or 0), found, left))

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
    ((root, scale),) = sqrt(base).items()
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
    return reduce(times, [poly] * n, ONE)


def base_of(poly: Polynomial) -> Base:
    """A polynomial as a key."""
    return tuple(sorted(poly.items()))


# -- square roots as variables -----------------------------------------------------------------------------------------


def sqrt(poly: Polynomial) -> Polynomial:
    """Its root, as a polynomial."""
    if (n := number_in(poly)) is not None:
        return _root_of_number(n)
    return {((Term("**", (written(dict(sorted(poly.items()))), HALF)), 1),): Fraction(1)}


def _root_of_number(x: Fraction) -> Polynomial:
    """sqrt(a/b) = sqrt(a b)/b, squares taken out."""
    if x < 0:
        raise NotWritten("a root of a number < 0")
    if x == 0:
        return {}
    left, out, found = x.numerator * x.denominator, Fraction(1, x.denominator), list[tuple[Term, int]]()
    for p in _PRIMES:
        n = 0
        while left % p == 0:
            left, n = left // p, n + 1
        out *= p ** (n // 2)
        found += [(Term("**", (number(p), HALF)), 1)] * (n % 2)
    whole = int(left**0.5 + 0.5) if left < 2**50 else 0
    if whole * whole == left:
        left, out = 1, out * whole
    found += [(Term("**", (number(left), HALF)), 1)] * (left > 1)
    return {tuple(sorted(found)): out}


def roots_in(poly: Polynomial) -> list[Term]:
    """The roots it is written in."""
    return sorted({x for m in poly for x, _ in m if x.op == "**" and x.args[1] == HALF})


def inner(root: Term, domain: StatedDomain) -> Polynomial:
    """What stands under a root."""
    return plain(domain.polynomial(root.args[0]), domain)


def plain(poly: Polynomial, domain: StatedDomain) -> Polynomial:
    """With roots of numbers as roots of primes, and no root to a higher power than 1; negative powers of other roots stay."""
    for _ in range(2):  # into roots of primes; these once each
        for x in roots_in(poly):
            if (square := number_in(domain.polynomial(x.args[0]))) is not None:
                if square <= 0:
                    raise NotWritten("a root of a number that is not > 0")
                poly = _lowered(poly, x, {(): square}, _root_of_number(square))
    for x in roots_in(poly):
        if any(dict(m).get(x, 0) > 1 for m in poly):
            poly = _lowered(poly, x, inner(x, domain))
    return poly


def _lowered(poly: Polynomial, x: Term, square: Polynomial, root: Polynomial | None = None) -> Polynomial:
    """x^n as square^(n // 2) x^(n % 2), for n > 1; of a number, for every n, with what ``root`` says that x is."""
    found = list[Polynomial]()
    for power, part in grouped(poly, lambda y: y == x).items():
        n = sum(n for _, n in power)
        half, odd = divmod(n, 2) if n > 1 or root is not None else (0, n)
        if half < 0:
            part, half = times(part, {(): square[()] ** half}), 0
        itself: Polynomial = {((x, odd),): Fraction(1)}
        own = [] if not odd else [itself if root is None else root]
        found.append(reduce(times, [*[square] * half, *own], part))
    return total(*found)


def slope_along(poly: Polynomial, domain: StatedDomain) -> Polynomial:
    """The derivative by the variable: that of a root w of q is q'/(2 w)."""
    found = slope(poly, RAY)
    for w in roots_in(poly):
        rate = slope(inner(w, domain), RAY)
        if rate:
            found = total(found, times(times(slope(poly, w), {((w, -1),): Fraction(1, 2)}), rate))
    return plain(found, domain)


class Signs:
    """Signs of such polynomials where the variable lies ``between`` two ends, over a domain."""

    def __init__(self, domain: StatedDomain, between: Interval) -> None:
        self.domain, self.between = domain, between

    def above(self, poly: Polynomial, strict: bool = False, depth: int = _DEEPEST) -> bool:
        """Whether it is >= 0, or > 0, its roots being >= 0, and those that divide > 0."""
        poly, _ = self.split(poly)
        roots = roots_in(poly)
        parts = [(tuple((w, 2 * n) for w, n in own), part) for own, part in grouped(poly, lambda x: x in roots).items()]
        if not roots:
            return nonnegative(poly, self.between, self.domain, strict) if poly else not strict
        if all(nonnegative(part, self.between, self.domain) for _, part in parts):
            if not strict:
                return True
            squares = total(*(plain(times(times(part, part), {own: Fraction(1)}), self.domain) for own, part in parts))
            if nonnegative(squares, self.between, self.domain, True):  # they are not 0 at once
                return True
        return depth > 0 and any(self._by_squares(poly, w, strict, depth) for w in roots)

    def _by_squares(self, poly: Polynomial, w: Term, strict: bool, depth: int) -> bool:
        """A + B w with A >= 0 and A^2 >= B^2 w^2, or B >= 0 and B^2 w^2 >= A^2."""
        a = {m: c for m, c in poly.items() if w not in dict(m)}
        b = {tuple((x, n) for x, n in m if x != w): c for m, c in poly.items() if w in dict(m)}
        one, two = times(a, a), times(times(b, b), inner(w, self.domain))
        return any(
            self.above(low, False, depth - 1) and self.above(total(more, negated(less)), strict, depth - 1)
            for low, more, less in ((a, one, two), (b, two, one))
        )

    def at(self, poly: Polynomial, place: Fraction) -> Polynomial:
        """A positive multiple of the value where the variable has this; roots that divide are > 0."""
        here: Polynomial = {(): place} if place else {}
        found: Polynomial = {}
        for m, c in self.split(poly)[0].items():
            part: Polynomial = {tuple((x, n) for x, n in m if x.op != "**" or RAY.name not in x.names()): c}
            for w in (x for x, _ in m if x.op == "**" and RAY.name in x.names()):
                part = times(part, self._root(replaced(inner(w, self.domain), RAY, here)))
            found = total(found, part)
        return plain(replaced(found, RAY, here), self.domain)

    def _root(self, square: Polynomial) -> Polynomial:
        """Of c s^2 with a number c > 0 it is sqrt(c) s where s >= 0, and sqrt(c) (-s) where s <= 0."""
        c, s = _as_square(square)
        for side in (s, negated(s)):
            if s and nonnegative(side, self.between, self.domain):
                return times(sqrt({(): c}), side)
        return sqrt(square)

    def split(self, poly: Polynomial) -> tuple[Polynomial, dict[Term, int]]:
        """A positive multiple without negative powers of roots, and to which power each root is then to be multiplied in."""
        poly, powers = plain(poly, self.domain), dict[Term, int]()
        for w in roots_in(poly):
            least = min((dict(m).get(w, 0) for m in poly), default=0)
            if least < _LOWEST:
                raise NotWritten("a power of a root is too low")
            if least < 0:
                powers[w] = least
                poly = plain(times(poly, {((w, -least),): Fraction(1)}), self.domain)
        return poly, powers


def _as_square(poly: Polynomial) -> tuple[Fraction, Polynomial]:
    """c and s with c s^2 = poly, a polynomial in one constant all of whose roots are double; 0 for any other."""
    names = {x for m in poly for x, _ in m}
    if len(names) == 1 and all(n > 0 for m in poly for _, n in m):
        (x,) = names
        coefficients = [part.get((), Fraction(0)) for part in in_powers(poly, x)]
        every, _ = parts(line(coefficients))
        root: Polynomial = {((x, n),) if n else (): Fraction(c) for n, c in enumerate(every) if c}
        share = coefficients[-1] / every[-1] ** 2
        if share > 0 and times({(): share}, times(root, root)) == poly:
            return share, root
    return Fraction(0), {}
