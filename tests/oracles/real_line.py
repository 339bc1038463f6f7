"""Signs of a polynomial on the whole real line, decided exactly by counting real roots."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import sympy as sp

__all__ = ["T", "nonnegative_on_the_line", "poly", "positive_form", "positive_on_the_line", "samples"]

T = sp.Symbol("t", real=True)


def poly(expr: Any) -> sp.Poly:
    """The expression as a polynomial in t with rational coefficients."""
    return sp.Poly(expr, T, domain="QQ")


def nonnegative_on_the_line(p: sp.Poly) -> bool:
    """p >= 0 on all of R: a positive leading coefficient and no real root of odd multiplicity (Sturm counts)."""
    if p.is_zero:
        return True
    _, factors = p.sqf_list()
    if p.degree() % 2 or p.LC() < 0:
        return False
    return all(k % 2 == 0 or f.count_roots() == 0 for f, k in factors)


def positive_on_the_line(p: sp.Poly) -> bool:
    """p > 0 on all of R."""
    return not p.is_zero and p.degree() % 2 == 0 and p.LC() > 0 and p.count_roots() == 0


def positive_form(p: sp.Poly, degree: int) -> bool:
    """The binary form with p(t) = P(1, t) is positive definite: P > 0 also at (0, 1), where it is the t^degree coefficient."""
    return p.degree() == degree and positive_on_the_line(p)


def samples(p: sp.Poly) -> list[sp.Rational]:
    """A rational point in every cell between neighbouring real roots of p, and beyond the last ones."""
    spans = sorted(span for span, _ in p.intervals(eps=sp.Rational(1, 10**6))) if p.degree() > 0 else []
    if not spans:
        return [sp.S.Zero]
    inner = [(a[1] + b[0]) / 2 for a, b in pairwise(spans)]
    found = [spans[0][0] - 1, *inner, spans[-1][1] + 1]
    return [t for t in found if p.eval(t) != 0]
