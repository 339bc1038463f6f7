"""Polynomials in two variables with integer coefficients (FLINT), and what projects them onto the first."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

import flint
import sympy as sp

from duhem.proof.decide.budget import Budget
from duhem.proof.decide.roots import square_free

__all__ = ["DegenerateError", "Integral", "OpenError", "Poly", "at_rational", "factors", "projection", "true", "univariate"]

_MOST_DEGREE = 400  # of a projection: beyond, it costs more than the other deciders

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


def factors(poly: Poly) -> list[Poly]:
    """The distinct irreducible factors that are no numbers."""
    try:
        return [factor for factor, _ in poly.factor()[1]]
    except OverflowError:  # python-flint 0.9 sorts factors alike in shape by coefficients that it takes for C integers
        raise OpenError("its factors have large coefficients") from None


def projection(curves: Iterable[Poly], pairs: Iterable[tuple[Poly, Poly]], budget: Budget, more: Iterable[Poly] = ()) -> Any:
    """The square-free polynomial in x (``flint.fmpz_poly``) where the roots in y of the curves escape, meet or meet each other's.

    ``more`` are polynomials in x alone.  Raises DegenerateError where one of these is identically 0.
    """
    curves, pairs = list(curves), list(pairs)
    bends = [f for f in curves if f.degrees()[1] > 1]
    bound = sum(_bound(f, f) for f in bends) + sum(_bound(f, h) for f, h in pairs)
    if bound > _MOST_DEGREE:
        raise OpenError(f"the projection may have degree {bound}")
    budget.spend(sum(_price(f, f) for f in bends) + sum(_price(f, h) for f, h in pairs))
    resultants = (f.resultant(h, 1) for f, h in pairs)
    return _joined([*more, *(_leading(f) for f in curves), *(f.discriminant(1) for f in bends), *resultants])


def _bound(one: Poly, two: Poly) -> int:
    """Degree in x of the resultant by y, at most (Sylvester's matrix)."""
    (a, b), (c, d) = one.degrees(), two.degrees()
    return int(a * d + c * b)


def _price(one: Poly, two: Poly) -> int:
    """Steps of the resultant by y: its degree times its size in bits times the cube of the larger degree, as measured."""
    n, m = one.degrees()[1], two.degrees()[1]
    return 10 + int(_bound(one, two) * (m * _bits(one) + n * _bits(two)) * max(n, m) ** 3) // 1000


def _bits(poly: Poly) -> int:
    return max((int(c).bit_length() for c in poly.coeffs()), default=0) + 2


def _leading(poly: Poly) -> Poly:
    """Leading coefficient as a polynomial in y."""
    top = poly.degrees()[1]
    return poly.context().from_dict({(i, 0): c for (i, j), c in poly.to_dict().items() if j == top})


def _joined(polys: list[Poly]) -> Any:
    """The square-free product of polynomials in x alone."""
    total = flint.fmpz_poly([1])
    for poly in polys:
        if poly.is_zero():
            raise DegenerateError
        factor = square_free(univariate({i: c for (i, _), c in poly.to_dict().items()}))
        total *= factor // factor.gcd(total)
    return total


def at_rational(poly: Poly, x: Fraction) -> Any:
    """The polynomial in y over a rational x, times a positive integer."""
    terms: dict[int, int] = defaultdict(int)
    for (i, j), c in poly.to_dict().items():
        terms[j] += int(c) * x.numerator**i * x.denominator ** (poly.degrees()[0] - i)
    return univariate(terms)


def univariate(terms: Mapping[int, Any]) -> Any:
    """The polynomial (``flint.fmpz_poly``) with these coefficients of the powers."""
    return flint.fmpz_poly([terms.get(i, 0) for i in range(max(terms, default=-1) + 1)])
