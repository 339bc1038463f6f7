"""Real roots of integer polynomials in one variable, in balls that hold one root each (FLINT; Johansson 2017)."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import Any

from duhem.expression.balls import precision
from duhem.expression.number import fraction
from duhem.proof.decide.budget import Budget

__all__ = ["between", "real_roots", "square_free"]


def square_free(poly: Any) -> Any:
    """The polynomial (``flint.fmpz_poly``, not 0) without repeated factors."""
    return poly // poly.gcd(poly.derivative())


def real_roots(poly: Any, bits: int, budget: Budget) -> list[Any]:
    """Disjoint balls in ascending order, one real root of a square-free polynomial in each and none left out."""
    if poly.degree() <= 0:
        return []
    budget.spend(10 + poly.degree() ** 2 * (bits + 100) // 25)
    with precision(bits):
        # Real roots come with an imaginary part that is exactly 0; the others keep clear of the real line.
        found = [root.real for root, _ in poly.complex_roots() if root.imag == 0]
    ordered = sorted(found, key=lambda root: root.mid().fmpq())
    assert all(a < b for a, b in pairwise(ordered))
    return ordered


def between(roots: list[Any]) -> list[Fraction]:
    """One plain rational strictly between each pair of neighbouring roots, and one beyond each end."""
    if not roots:
        return [Fraction(0)]
    ends = [(middle - radius, middle + radius) for middle, radius in map(_exact, roots)]
    inner = [_plain(a[1], b[0]) for a, b in pairwise(ends)]
    return [Fraction(ends[0][0] // 1 - 1), *inner, Fraction(-((-ends[-1][1]) // 1) + 1)]


def _exact(ball: Any) -> tuple[Fraction, Fraction]:
    """Middle and radius: ends rounded to the working precision would merge roots that lie close together."""
    return fraction(ball.mid().fmpq()), fraction(ball.rad().fmpq())


def _plain(low: Fraction, high: Fraction) -> Fraction:
    """A rational of small denominator strictly between, not close to either end."""
    third = (high - low) / 3
    return ((low + high) / 2).limit_denominator(max(1, int(4 / third)))
