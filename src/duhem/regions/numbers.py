"""Plain numbers for what floating point finds: the simplest fraction between two, the roots of short polynomials close to one."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from math import isqrt

import mpmath
import sympy as sp

from duhem.proof.kernel.real_root import RealRoot
from duhem.proof.kernel.signs import sign_at
from duhem.proof.kernel.term import NotWritten

__all__ = ["closest_fractions", "narrowed", "simplest", "square_root_near", "written_root"]

_MOST_COEFFICIENT, _ALIKE = 300, 1e-6


def simplest(low: Fraction, high: Fraction) -> Fraction:
    """The fraction strictly between that has the least denominator, and among these the least size (Stern 1858, Brocot 1861)."""
    if low < 0 < high:
        return Fraction(0)
    if high <= 0:
        return -simplest(-high, -low)
    whole = low // 1
    if whole + 1 < high:
        return Fraction(whole + 1)
    if low == whole:
        return whole + Fraction(1, 1 / (high - whole) // 1 + 1)
    return whole + 1 / simplest(1 / (high - whole), 1 / (low - whole))


def closest_fractions(x: float) -> list[Fraction]:
    """Fractions close to x, the simplest first."""
    return [*dict.fromkeys(Fraction(x).limit_denominator(n) for n in (1, 2, 3, 4, 8, 16, 64))]


def square_root_near(low: Fraction, high: Fraction) -> RealRoot | None:
    """The root of a polynomial of degree 2 with small coefficients between, if there is one (H. Ferguson, D. Bailey 1992: PSLQ)."""
    found = mpmath.findpoly(float((low + high) / 2), 2, maxcoeff=_MOST_COEFFICIENT, tol=_ALIKE)
    if found is None or len(found) < 3 or isqrt(max(under := found[1] ** 2 - 4 * found[0] * found[2], 0)) ** 2 == under:
        return None  # a fraction, or not real
    return narrowed(tuple(found[::-1]), 2 * low - high, 2 * high - low)


def narrowed(poly: tuple[int, ...], low: Fraction, high: Fraction, bits: int = 40) -> RealRoot | None:
    """The root of a polynomial between two fractions, enclosed to so many binary digits; None where it has not one there."""
    if sign_at(poly, low) * sign_at(poly, high) >= 0:
        return None
    while high - low > Fraction(1, 2**bits):  # SymPy's refine_root did not end for some
        middle = simplest(low + (high - low) / 4, high - (high - low) / 4)
        if (here := sign_at(poly, middle)) == 0:
            return RealRoot.of(middle)
        low, high = (middle, high) if here == sign_at(poly, low) else (low, middle)
    with suppress(NotWritten):
        return RealRoot.read({"polynomial": [str(c) for c in poly], "enclosure": [str(low), str(high)]})
    return None


def written_root(root: RealRoot) -> str:
    """A number as a formula: a fraction, or by a square root as ``3*sqrt(3)/4``; what has neither is not asked."""
    if root.exact:
        return str(root.low)
    c, b, a = root.poly
    sign = 1 if 2 * a * root.low + b > 0 else -1
    part, shift = str(sign * sp.sqrt(b * b - 4 * a * c) / (2 * a)), Fraction(-b, 2 * a)
    return f"{shift} {'-' if part[0] == '-' else '+'} {part.removeprefix('-')}" if shift else part
