"""Fourier series in the polar angle with rational coefficients, as polynomials in t = tan(theta/2)."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import sympy as sp

from tests.oracles.real_line import T, poly

__all__ = ["Series", "derivative", "half_angle", "positive_at_pi", "rotated"]

F = Fraction
Series = dict[int, tuple[Fraction, Fraction]]  # k: (coefficient of cos k theta, of sin k theta)


def half_angle(series: Series, weight: Callable[[int], Fraction] = lambda k: F(1)) -> sp.Poly:
    """(1 + t^2)^n sum weight(k) (a_k cos k theta + b_k sin k theta), t = tan(theta/2), n the highest k."""
    n = max(series)
    total = poly(0)
    for k, (a, b) in series.items():
        turned = sp.expand((1 + sp.I * T) ** (2 * k))
        real, imaginary = poly(sp.re(turned)), poly(sp.im(turned))
        w = weight(k)
        term = real * sp.Rational(*(a * w).as_integer_ratio()) + imaginary * sp.Rational(*(b * w).as_integer_ratio())
        total += term * poly(1 + T**2) ** (n - k)
    return total


def derivative(series: Series) -> Series:
    """Derivative by theta."""
    return {k: (k * b, -k * a) for k, (a, b) in series.items()}


def rotated(series: Series, c: Fraction, s: Fraction) -> Series:
    """The series in theta - phi, with (c, s) = (cos phi, sin phi)."""
    found, ck, sk = {}, F(1), F(0)
    for k in range(max(series) + 1):
        if k in series:
            a, b = series[k]
            found[k] = (a * ck - b * sk, a * sk + b * ck)
        ck, sk = ck * c - sk * s, ck * s + sk * c
    return found


def positive_at_pi(series: Series) -> bool:
    """Whether the series is positive at theta = pi, which no t = tan(theta/2) reaches."""
    return sum((a * (-1) ** k for k, (a, _) in series.items()), F(0)) > 0
