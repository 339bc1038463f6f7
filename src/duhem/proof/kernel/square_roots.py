"""Polynomials of one variable, of constants and of square roots of such polynomials: differentiated, put at a point, and their signs.

A root is a term x**(1/2) of which the whole powers count; that of a number stands as roots of primes.  It is >= 0 where it is defined.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import reduce

from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.polynomial import Monomial, Polynomial, in_powers, negated, number_in, replaced, slope, times, total, written
from duhem.proof.kernel.signs import RAY, Interval, line, nonnegative, parts
from duhem.proof.kernel.term import NotWritten, Term, number

__all__ = ["Signs", "inner", "plain", "root_of", "roots_in", "slope_along"]

_HALF = number(Fraction(1, 2))
_PRIMES = (2, 3, 5, 7, 11, 13)
_MOST_POWER, _DEEPEST = 40, 3


def root_of(poly: Polynomial) -> Polynomial:
    """Its root, as a polynomial."""
    if (n := number_in(poly)) is not None:
        return _root_of_number(n)
    return {((Term("**", (written(dict(sorted(poly.items()))), _HALF)), 1),): Fraction(1)}


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
        found += [(Term("**", (number(p), _HALF)), 1)] * (n % 2)
    whole = int(left**0.5 + 0.5) if left < 2**50 else 0
    if whole * whole == left:
        left, out = 1, out * whole
    found += [(Term("**", (number(left), _HALF)), 1)] * (left > 1)
    return {tuple(sorted(found)): out}


def roots_in(poly: Polynomial) -> list[Term]:
    """The roots it is written in."""
    return sorted({x for m in poly for x, _ in m if x.op == "**" and x.args[1] == _HALF})


def inner(root: Term, domain: StatedDomain) -> Polynomial:
    """What stands under a root."""
    return plain(domain.polynomial(root.args[0]), domain)


def plain(poly: Polynomial, domain: StatedDomain) -> Polynomial:
    """With roots of numbers as roots of primes, and no root to a higher power than 1; negative powers of other roots stay."""
    for _ in range(2):  # into roots of primes; these once each
        for x in roots_in(poly):
            if (square := _number_under(x, domain)) is not None:
                if square <= 0:
                    raise NotWritten("a root of a number that is not > 0")
                poly = _lowered(poly, x, {(): square}, _root_of_number(square))
    for x in roots_in(poly):
        if any(dict(m).get(x, 0) > 1 for m in poly):
            poly = _lowered(poly, x, inner(x, domain))
    return poly


def _number_under(root: Term, domain: StatedDomain) -> Fraction | None:
    return number_in(domain.polynomial(root.args[0]))


def _lowered(poly: Polynomial, x: Term, square: Polynomial, root: Polynomial | None = None) -> Polynomial:
    """x^n as square^(n // 2) x^(n % 2), for n > 1; of a number, for every n, with what ``root`` says that x is."""
    powers: dict[int, Polynomial] = {}
    for m, c in poly.items():
        powers.setdefault(dict(m).get(x, 0), {})[tuple((y, k) for y, k in m if y != x)] = c
    found = list[Polynomial]()
    for n, part in powers.items():
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
        poly = self.cleared(poly)
        roots = roots_in(poly)
        parts = [*_by_roots(poly, roots)]
        if not roots:
            return nonnegative(poly, self.between, self.domain, strict) if poly else not strict
        if all(nonnegative(part, self.between, self.domain) for _, part in parts):
            if not strict:
                return True
            squares = total(*(plain(times(times(part, part), {own: Fraction(1)}), self.domain) for own, part in parts))
            if nonnegative(squares, self.between, self.domain, True):  # they are not 0 at once
                return True
        return depth > 0 and any(self._by_squares(poly, w, strict, depth) for w in self._moving_first(roots))

    def _moving_first(self, roots: list[Term]) -> list[Term]:
        return sorted(roots, key=lambda w: _number_under(w, self.domain) is not None)

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
        for m, c in self.cleared(poly).items():
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
                return times(root_of({(): c}), side)
        return root_of(square)

    def cleared(self, poly: Polynomial) -> Polynomial:
        """A positive multiple without negative powers of roots."""
        return self.split(poly)[0]

    def split(self, poly: Polynomial) -> tuple[Polynomial, dict[Term, int]]:
        """The same, and to which power each root is then to be multiplied in."""
        poly, powers = plain(poly, self.domain), dict[Term, int]()
        for w in roots_in(poly):
            least = min((dict(m).get(w, 0) for m in poly), default=0)
            if least < -_MOST_POWER:
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


def _by_roots(poly: Polynomial, roots: list[Term]) -> Iterator[tuple[Monomial, Polynomial]]:
    """What each product of roots has, and the square of that product."""
    groups: dict[Monomial, Polynomial] = {}
    for m, c in poly.items():
        own = tuple((x, 2 * n) for x, n in m if x in roots)
        groups.setdefault(own, {})[tuple((x, n) for x, n in m if x not in roots)] = c
    yield from groups.items()
