"""Whether a quartic of plane stress is convex, exactly, in whole numbers: another way than any of duhem's.

P = p4(x, y) + p2(x, y) t^2 + p0 t^4 in the chart x = 1, with z = t^2 >= 0.  det Hess P is a cubic in z with polynomials in y as
coefficients.  It is >= 0 at z = 0, or P is not convex.  Then the number of its positive roots does not change between the real
roots of its discriminant and of its leading coefficient: a single root that passed 0 would turn the sign at z = 0, two at once
are a double root.  Where there is a positive root, and simple, the determinant is negative on one side of it; where there is
none, Hess P has one signature in that strip, which one point shows.  The strips are dense.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import gcd, lcm

import flint

__all__ = ["convex", "samples"]

Poly = list[int]  # the coefficients of 1, y, y^2, ...


def _trim(p: Sequence[int]) -> Poly:
    q = list(p)
    while q and q[-1] == 0:
        q.pop()
    return q


def _add(*parts: Poly) -> Poly:
    return _trim([sum(p[i] for p in parts if i < len(p)) for i in range(max(map(len, parts), default=0))])


def _mul(*parts: Poly) -> Poly:
    found = [1]
    for p in parts:
        if not p:
            return []
        product = [0] * (len(found) + len(p) - 1)
        for i, a in enumerate(found):
            for j, b in enumerate(p):
                product[i + j] += a * b
        found = product
    return _trim(found)


def _times(k: int, p: Poly) -> Poly:
    return _trim([k * c for c in p])


def _at(p: Poly, y: Fraction) -> Fraction:
    above, below = y.numerator, y.denominator
    value, scale = 0, 1
    for c in reversed(p):
        value, scale = value * above + c * scale, scale * below
    return Fraction(value, max(1, scale // below))


def _primitive(p: Poly) -> Poly:
    common = gcd(*p) if p else 1
    return [c // common for c in p]


def _remainder(a: Poly, b: Poly) -> Poly:
    """Of a by b, times a positive number."""
    rest = (flint.fmpq_poly(a) % flint.fmpq_poly(b)).numer()
    return [int(c) for c in (rest // rest.content()).coeffs()] if rest else []


def _slope(p: Poly) -> Poly:
    return [i * c for i, c in enumerate(p)][1:]


def _chain(p: Poly) -> list[Poly]:
    """Sturm's: each the negative remainder of the two before."""
    chain = [_primitive(p), _primitive(_slope(p))]
    while chain[-1] and len(chain[-1]) > 1:
        rest = _remainder(chain[-2], chain[-1])
        if not rest:
            break
        chain.append([-c for c in rest])
    return [c for c in chain if c]


def _changes(signs: Sequence[int]) -> int:
    left = [s for s in signs if s]
    return sum(a != b for a, b in pairwise(left))


def _signs(chain: Sequence[Poly], y: Fraction) -> list[int]:
    return [(v > 0) - (v < 0) for v in (_at(p, y) for p in chain)]


def samples(p: Poly) -> list[Fraction]:
    """One number in each interval between the distinct real roots of p, and beyond them; none of them a root."""
    if len(p) <= 1:
        return [Fraction(0)]
    chain = _chain(p)
    top = abs(p[-1])
    bound = Fraction(2 ** (max(abs(c) for c in p) // top + 1).bit_length())
    found, todo = [-bound, bound], [(-bound, bound)]
    counts: dict[Fraction, int] = {}

    def count(y: Fraction) -> int:
        if y not in counts:
            counts[y] = _changes(_signs(chain, y))
        return counts[y]

    while todo:
        low, high = todo.pop()
        if count(low) - count(high) < 2:
            continue
        middle = (low + high) / 2
        while _at(p, middle) == 0:
            middle = (low + middle) / 2
        found.append(middle)
        todo += [(low, middle), (middle, high)]
    return sorted(found)


def _positive_roots(cubic: Sequence[Fraction]) -> int:
    """How many distinct roots > 0 there are; 0 is none of them."""
    scale = lcm(*(c.denominator for c in cubic))
    p = _trim([int(c * scale) for c in cubic])
    if len(p) <= 1:
        return 0
    chain = _chain(p)
    return _changes(_signs(chain, Fraction(0))) - _changes([(q[-1] > 0) - (q[-1] < 0) for q in chain])


def convex(coefficients: Sequence[Fraction]) -> bool | None:
    """Of x^4, x^3 y, x^2 y^2, x y^3, y^4, x^2 t^2, x y t^2, y^2 t^2, t^4; None where the discriminant vanishes throughout."""
    scale = lcm(*(Fraction(c).denominator for c in coefficients))
    a, b, c, d, e, f, g, h, k = (int(Fraction(c) * scale) for c in coefficients)
    # second derivatives at x = 1, as polynomials in y: those of p4 and of p2, and the slopes of p2
    p4 = ([12 * a, 6 * b, 2 * c], [3 * b, 4 * c, 3 * d], [2 * c, 6 * d, 12 * e])
    p2, px, py = _trim([f, g, h]), _trim([2 * f, g]), _trim([g, 2 * h])
    xx, xy, yy = ([_trim(q), _trim([s])] for q, s in zip(p4, (2 * f, g, 2 * h), strict=True))  # by powers of z
    tt = [_times(2, p2), _trim([12 * k])]

    def product(one: list[Poly], two: list[Poly]) -> list[Poly]:
        rows: list[Poly] = [[] for _ in range(len(one) + len(two) - 1)]
        for i, u in enumerate(one):
            for j, v in enumerate(two):
                rows[i + j] = _add(rows[i + j], _mul(u, v))
        return rows

    def total(*parts: list[Poly]) -> list[Poly]:
        return [_add(*(p[i] for p in parts if i < len(p))) for i in range(max(map(len, parts)))]

    minor = total(product(xx, yy), product([_times(-1, q) for q in xy], xy))
    mixed = total(product(xx, [_mul(py, py)]), product(xy, [_times(-2, _mul(px, py))]), product(yy, [_mul(px, px)]))
    det = total(product(tt, minor), [[], *(_times(-4, q) for q in mixed)])  # (xt)^2 = 4 z px^2, and so on
    n = len(det) - 1
    while n >= 0 and not det[n]:
        n -= 1
    if n < 0:
        return None
    d0, d1, d2, d3 = [*det[: n + 1], *([[]] * (3 - n))]
    if n == 3:
        disc = _add(
            _times(18, _mul(d3, d2, d1, d0)),
            _times(-4, _mul(d2, d2, d2, d0)),
            _mul(d2, d2, d1, d1),
            _times(-4, _mul(d3, d1, d1, d1)),
            _times(-27, _mul(d3, d3, d0, d0)),
        )
    else:
        disc = _add(_mul(d1, d1), _times(-4, _mul(d2, d0))) if n == 2 else [1]
    if not disc or not d0:
        return None
    if any(_at(d0, y) < 0 for y in samples(d0)):
        return False  # so is the determinant for small z
    for y in samples(_primitive(_mul(disc, det[n]))):
        if _positive_roots([_at(q, y) for q in det[: n + 1]]):
            return False
        hxx, hxy, hyy = (_at(q[0], y) + _at(q[1], y) for q in (xx, xy, yy))
        if not (hxx > 0 and hxx * hyy > hxy * hxy and sum((_at(q, y) for q in det[: n + 1]), Fraction(0)) > 0):
            return False
    return True
