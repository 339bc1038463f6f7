"""The exact sign of a number made of fractions by sums, products, quotients and roots.

Such a number is U/L with algebraic integers U and L, all of whose conjugates are at most u and l, read off its form.  If it is not 0,
neither is the norm of U, a whole number; so |U/L| >= 1/(u^(D - 1) l), D the product of the roots' indices (Burnikel, Funke,
Mehlhorn, Schirra, Schmitt 2001, ESA, LNCS 2161, 254).  What an enclosure shows to be closer to 0 is 0.
"""

from __future__ import annotations

from math import lcm, log2, prod

import sympy as sp

from duhem.expression import Norm
from duhem.expression.balls import certain_sign, enclose, precision

__all__ = ["sign_of_radicals"]

_PRECISIONS = (64, 256, 1024)
_MOST_BITS, _SPARE = 1 << 18, 128
_LARGEST = 1000  # an exponent
_SLACK = 1 + 2.0**-20  # logarithms are rounded up by more than floats lose

Sizes = tuple[float, float]  # the logarithms to base 2 of u and l


def sign_of_radicals(number: sp.Expr) -> int | None:
    """-1, 0 or 1; None for a number of another kind, one that is none, or one for which that would take too many digits."""
    for bits in _PRECISIONS:
        with precision(bits):
            if (sign := certain_sign(enclose(number, {}))) is not None:
                return sign
    roots: dict[sp.Expr, int] = {}
    if (sizes := _sizes(number, roots)) is None:
        return None
    apart = int(sizes[0] * (prod(roots.values()) - 1) + sizes[1]) + 2
    if apart > _MOST_BITS:
        return None
    with precision(apart + int(sizes[0]) + _SPARE):
        value = enclose(number, {})
        if (sign := certain_sign(value)) is not None or not value.is_finite():
            return sign
        return 0 if bool(value.abs_upper() * type(value)(2) ** apart < 1) else None


def _sizes(number: sp.Expr, roots: dict[sp.Expr, int]) -> Sizes | None:
    """Of a number; ``roots`` takes up what roots are taken of, and of which index."""
    if number.is_Rational:
        return _SLACK * log2(max(1, abs(int(number.p)))), _SLACK * log2(int(number.q))
    if isinstance(number, Norm):
        return _sizes(sp.Pow(sp.Add(*(a**2 for a in number.args)), sp.S.Half, evaluate=False), roots)
    if number.is_Pow and number.exp.is_Rational and abs(number.exp.p) <= _LARGEST:
        return _of_power(number, roots)
    if not (number.is_Add or number.is_Mul):
        return None
    parts = [_sizes(part, roots) for part in number.args]
    known = [part for part in parts if part is not None]
    if len(known) < len(parts):
        return None
    below = sum(low for _, low in known)
    if number.is_Mul:
        return _SLACK * sum(high for high, _ in known), _SLACK * below
    return _SLACK * (max(high + below - low for high, low in known) + log2(len(known))), _SLACK * below


def _of_power(number: sp.Expr, roots: dict[sp.Expr, int]) -> Sizes | None:
    if (base := _sizes(number.base, roots)) is None:
        return None
    k, n = int(number.exp.q), abs(int(number.exp.p))
    roots[number.base] = lcm(k, roots.get(number.base, 1))
    u, low = base
    root = (u + (k - 1) * low) / k, low  # the k-th root of U/L is that of U L^(k - 1), over L
    high, below = (_SLACK * n * size for size in root)
    return (below, high) if number.exp.is_negative else (high, below)
