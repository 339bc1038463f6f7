"""A body with a profile: {Q <= H(t)}, t a load and Q a sum of squares of affine functions of the forces, H a polynomial.

It is {sqrt Q <= sqrt H(t)}, and sqrt Q is a seminorm of (forces, 1): the body is convex where H >= 0 on an interval alone and sqrt H
is concave there, that is H'^2 - 2 H H'' >= 0 where H > 0.  Other loads may leave a part of the line to t.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from fractions import Fraction
from itertools import pairwise

from duhem.proof.kernel.domain import POSITIVE, StatedDomain
from duhem.proof.kernel.polynomial import Polynomial, in_powers, negated, replaced, slope, times, total, written
from duhem.proof.kernel.signs import RAY, Line, nonnegative_on_the_line, on_the_line, parts, roots, sign_at, without_content
from duhem.proof.kernel.term import NotWritten, Term

__all__ = ["convex_by_its_profile"]

_Place = tuple[Fraction, Fraction]  # a root exactly, or between two numbers that are none


def convex_by_its_profile(f: Term, loads: Collection[Term], domain: StatedDomain) -> bool:
    """Whether f is defined and {f <= 0} is convex where the ``loads`` of the law are >= 0."""
    try:
        poly, sides = domain.polynomial(f), [domain.polynomial(load) for load in loads]
        return domain.facts(f).defined and any(_by_load(poly, t, sides, domain) for t in (*sides, *_leading(poly, domain)))
    except NotWritten:
        return False


def _by_load(poly: Polynomial, load: Polynomial, sides: Collection[Polynomial], domain: StatedDomain) -> bool:
    """Whether the body has a profile along this load, and one that makes it convex."""
    try:
        x, place = _solved(load, domain)
        profile = _profile(replaced(poly, x, place), domain)
        along = [side for side in (replaced(side, x, place) for side in sides) if not _moving(side, domain)]
        return any(_concave_root(h, rest) for h, rest in _in_numbers(profile, along, domain))
    except NotWritten:
        return False


def _moving(poly: Polynomial, domain: StatedDomain) -> list[Term]:
    """The forces in a polynomial; NotWritten where they do not enter as such."""
    found = {x: n for m in poly for x, n in m if not domain.constant(x)}
    if any(x.op != "name" for x in found) or any(n < 0 for m in poly for x, n in m if x in found):
        raise NotWritten("it is no polynomial in the forces")
    return sorted(found)


def _leading(poly: Polynomial, domain: StatedDomain) -> Iterator[Polynomial]:
    """The load of whose power the terms of the highest degree are a multiple, if they are; x with the shares of the others in it."""
    forces = _moving(poly, domain)
    degree = max((_degree(m, forces) for m in poly), default=0)
    if degree < 3:
        return
    top = {m: c for m, c in poly.items() if _degree(m, forces) == degree}
    x = next((x for x in forces if any(dict(m).get(x) == degree for m in top)), None)
    if x is None:
        return
    *_, beside, own = in_powers(top, x)
    yield total({((x, 1),): Fraction(1)}, times({(): Fraction(1, degree)}, times(_inverse(own, domain), beside)))


def _degree(m: tuple[tuple[Term, int], ...], forces: Collection[Term]) -> int:
    return sum(n for x, n in m if x in forces)


def _inverse(constant: Polynomial, domain: StatedDomain) -> Polynomial:
    """1/c of a product of constants that are not 0."""
    if len(constant) != 1:
        raise NotWritten("a constant is not to be divided by")
    ((m, c),) = constant.items()
    if any(domain.of(y) & ~POSITIVE for y, _ in m):
        raise NotWritten("a constant may be 0")
    return {tuple((y, -n) for y, n in m): 1 / c}


def _solved(load: Polynomial, domain: StatedDomain) -> tuple[Term, Polynomial]:
    """A force, and what stands for it where the load is t."""
    for x in _moving(load, domain):
        rest, *own = in_powers(load, x)
        if len(own) == 1 and not _moving(own[0], domain):
            return x, times(_inverse(own[0], domain), total({((RAY, 1),): Fraction(1)}, negated(rest)))
    raise NotWritten("the load has no force to be solved for")


def _profile(poly: Polynomial, domain: StatedDomain) -> Polynomial:
    """H: with f = a y^2 + b y + c, a > 0, b affine, 4 a f = (2 a y + b)^2 + 4 a c - b^2; so one force after the other is removed."""
    while forces := _moving(poly, domain):
        y = forces[0]
        free, once, *twice = in_powers(poly, y)
        if len(twice) != 1 or _moving(twice[0], domain) or any(RAY in dict(m) for m in twice[0]):
            raise NotWritten("a force does not enter by its square alone")
        if any(_degree(m, (*forces, RAY)) > 1 for m in once) or domain.facts(written(twice[0])).sign != POSITIVE:
            raise NotWritten("no square of an affine function is left")
        poly = total(times({(): Fraction(4)}, times(twice[0], free)), negated(times(once, once)))
    return negated(poly)


def _in_numbers(profile: Polynomial, sides: Collection[Polynomial], domain: StatedDomain) -> Iterator[tuple[Polynomial, list[Line]]]:
    """The profile and its sides without constants; t is measured in one of them, if need be."""
    if not profile:
        return
    names = {x for m in profile for x, _ in m if x != RAY and domain.of(x) == POSITIVE}
    for unit in (None, *sorted(names)):
        scaled: Polynomial = {tuple(sorted([(RAY, 1), *([] if unit is None else [(unit, 1)])])): Fraction(1)}
        h, *lines = (without_content(replaced(p, RAY, scaled), domain) for p in (profile, *sides) if p)
        read = [on_the_line(p) for p in (h, *lines)]
        if all(p is not None for p in read):
            yield h, [p for p in read[1:] if p is not None]


def _concave_root(h: Polynomial, sides: Collection[Line]) -> bool:
    """Whether sqrt H is concave where H >= 0 and the sides, of degree 1 at most, are >= 0, which is an interval then."""
    first = slope(h, RAY)
    bend = on_the_line(total(times(first, first), times({(): Fraction(-2)}, times(h, slope(first, RAY)))))
    line = on_the_line(h)
    if not line or bend is None:
        return False
    low, high = _between(sides, 1 + max(map(_beyond_roots, (line, bend, *sides))))
    if low >= high:
        return True  # no more than one value of t is left
    ends = [(low, low), *roots(parts(line)[0], low, high), (high, high)]
    zeros = {i for i, (a, b) in enumerate(ends) if 0 < i < len(ends) - 1 or sign_at(line, a) == 0}
    above = [i for i, ((_, a), (b, _)) in enumerate(pairwise(ends)) if sign_at(line, (a + b) / 2) > 0]
    if not above:
        return len(zeros) < 2
    return len(above) == 1 and zeros <= {above[0], above[0] + 1} and nonnegative_on_the_line(bend, ends[above[0]][0], ends[above[0] + 1][1])


def _between(sides: Collection[Line], far: Fraction) -> _Place:
    """Where t lies; beyond ``far`` nothing changes any more."""
    low, high = -far, far
    for side in sides:
        if len(side) == 2:
            at = Fraction(-side[0], side[1])
            low, high = (max(low, at), high) if side[1] > 0 else (low, min(high, at))
    return low, high


def _beyond_roots(p: Line) -> Fraction:
    """Greater than the size of every root (Cauchy's bound)."""
    return 1 + max((Fraction(abs(c), abs(p[-1])) for c in p[:-1]), default=Fraction(0))
