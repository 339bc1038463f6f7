"""Polynomials in two variables with integer coefficients (FLINT), and what projects them onto the first."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import flint
import sympy as sp

from duhem.positivity.roots import square_free

__all__ = ["DegenerateError", "Integral", "OpenError", "Poly", "at_rational", "joined", "leading", "true"]

Poly = Any  # flint.fmpz_mpoly in (x, y)


class DegenerateError(Exception):
    """The projection along y says nothing here: shear the plane."""


class OpenError(Exception):
    """A sign stayed open, or the means ran out."""


class Integral:
    """SymPy polynomials in x, y as integer polynomials in (x - shear * y, y), up to a positive factor."""

    def __init__(self, x: sp.Symbol, y: sp.Symbol, shear: int = 0) -> None:
        self.x, self.y = x, y
        self.ring = flint.fmpz_mpoly_ctx.get(["x", "y"], "lex")
        first, second = self.ring.gens()
        self.moved = (first + shear * second, second)

    def __call__(self, expr: sp.Expr) -> Poly:
        terms = sp.Poly(expr, self.x, self.y, domain="QQ").terms()
        scale = math.lcm(*(int(c.q) for _, c in terms))
        return self.ring.from_dict({m: int(c.p) * (scale // int(c.q)) for m, c in terms if c}).compose(*self.moved)


def true(value: int, op: str) -> bool:
    """Truth of ``value op 0``."""
    return value >= 0 if op == ">=" else value > 0 if op == ">" else value == 0 if op == "==" else value != 0


def leading(poly: Poly) -> Poly:
    """Leading coefficient as a polynomial in y."""
    top = poly.degrees()[1]
    return poly.context().from_dict({(i, 0): c for (i, j), c in poly.to_dict().items() if j == top})


def joined(polys: list[Poly]) -> Any:
    """The square-free product of polynomials in x alone, as ``flint.fmpz_poly``; DegenerateError if one is 0."""
    total = flint.fmpz_poly([1])
    for poly in polys:
        if poly.is_zero():
            raise DegenerateError
        coefficients = [0] * (poly.degrees()[0] + 1)
        for (i, _), c in poly.to_dict().items():
            coefficients[i] = c
        factor = square_free(flint.fmpz_poly(coefficients))
        total *= factor // factor.gcd(total)
    return total


def at_rational(poly: Poly, x: Fraction) -> Any:
    """The polynomial in y over a rational x, times a positive integer."""
    n, top = poly.degrees()
    coefficients = [0] * (top + 1)
    for (i, j), c in poly.to_dict().items():
        coefficients[j] += c * x.numerator**i * x.denominator ** (n - i)
    return flint.fmpz_poly(coefficients)
