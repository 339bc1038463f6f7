"""Plain numbers for what floating point finds: the simplest fraction between two, the roots of short polynomials close to one."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import gcd, isqrt

import sympy as sp

from duhem.proof.kernel.real_root import RealRoot
from duhem.proof.kernel.signs import sign_at
from duhem.proof.kernel.term import NotWritten

__all__ = ["closest_fractions", "narrowed", "simplest", "square_root_near", "written_root"]

_MOST_COEFFICIENT = 200


def simplest(low: Fraction, high: Fraction) -> Fraction:
    """The fraction strictly between that has the least denominator, and among these the least size (Stern 1858, Brocot 1861)."""
    if low < 0 < high:
        return Fraction(0)
    if high <= 0:
        return -simplest(-high, -low)
    whole = low.numerator // low.denominator
    if whole + 1 < high:
        return Fraction(whole + 1)
    rest = high - whole
    above = None if low == whole else 1 / (low - whole)
    inverse = 1 / rest
    further = Fraction(inverse.numerator // inverse.denominator + 1) if above is None else simplest(inverse, above)
    return whole + 1 / further


def closest_fractions(x: float, most: int = 64) -> Iterator[Fraction]:
    """Fractions close to x, the simplest first."""
    seen = set[Fraction]()
    for n in (1, 2, 3, 4, 8, 16, most):
        near = Fraction(x).limit_denominator(n)
        if near not in seen:
            seen.add(near)
            yield near


def square_root_near(low: Fraction, high: Fraction) -> RealRoot | None:
    """The root of the shortest polynomial of degree 2 with small coefficients that has one between, if there is such a polynomial."""
    middle, width = (low + high) / 2, high - low
    x = float(middle)
    found: tuple[int, int, int, int] | None = None
    for b in sorted(range(-_MOST_COEFFICIENT, _MOST_COEFFICIENT + 1), key=abs):
        for a in range(1, _MOST_COEFFICIENT + 1) if found is None or abs(b) < found[0] else ():
            c = -round(a * x * x + b * x)
            if abs(c) > 10 * _MOST_COEFFICIENT or abs(a * x * x + b * x + c) > 1e-6:
                continue
            size = abs(a) + abs(b) + abs(c)
            if (found is None or size < found[0]) and gcd(a, b, c) == 1 and _crosses((c, b, a), low - width, high + width):
                found = size, c, b, a
    if found is None or isqrt(max(found[2] ** 2 - 4 * found[1] * found[3], 0)) ** 2 == found[2] ** 2 - 4 * found[1] * found[3]:
        return None
    return narrowed(found[1:], low - width, high + width)


def _crosses(poly: tuple[int, ...], low: Fraction, high: Fraction) -> bool:
    return sign_at(poly, low) * sign_at(poly, high) < 0


def narrowed(poly: tuple[int, ...], low: Fraction, high: Fraction, bits: int = 40) -> RealRoot | None:
    """The root of a polynomial between two fractions, enclosed to so many binary digits; None where it has not one there."""
    if not _crosses(poly, low, high):
        return None
    while high - low > Fraction(1, 2**bits):
        middle = simplest(low + (high - low) / 4, high - (high - low) / 4)
        if sign_at(poly, middle) == 0:
            return RealRoot.of(middle)
        low, high = (middle, high) if _crosses(poly, middle, high) else (low, middle)
    try:
        return RealRoot.read({"polynomial": [str(c) for c in poly], "enclosure": [str(low), str(high)]})
    except NotWritten:
        return None


def written_root(root: RealRoot) -> str:
    """A number as a formula: a fraction, or by a square root as ``3*sqrt(3)/4``; what has neither is not asked."""
    if root.exact:
        return str(root.low)
    c, b, a = root.poly
    sign = 1 if 2 * a * root.low + b > 0 else -1
    part, shift = str(sign * sp.sqrt(b * b - 4 * a * c) / (2 * a)), Fraction(-b, 2 * a)
    return f"{shift} {'-' if part[0] == '-' else '+'} {part.removeprefix('-')}" if shift else part
