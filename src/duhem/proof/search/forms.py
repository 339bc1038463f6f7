"""Polynomials as numbers by exponents: sums, products, values in floats, and the zeros of a form that is nowhere negative.

Each square in a sum of squares for such a form vanishes at its zeros.  They are sought as zeros of the gradient from many starts
(Levenberg 1944, Marquardt 1963).  Nothing is certain of what is found.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import product as pairs
from typing import Any

__all__ = ["Exponents", "Polynomial", "added", "on_spheres", "times", "touching_points", "values_at"]

Exponents = tuple[int, ...]
Polynomial = Mapping[Exponents, Fraction]
_TRIED, _STEPS, _ENOUGH = 40, 80, 1e-12  # random points for each start; how often a start is improved; a gradient taken for 0
_MOST = 40_000_000  # entries of second derivatives, all starts together


def added(*polynomials: Polynomial) -> Polynomial:
    """Their sum."""
    total: dict[Exponents, Fraction] = {}
    for p in polynomials:
        for m, c in p.items():
            total[m] = total.get(m, Fraction(0)) + c
    return {m: c for m, c in total.items() if c}


def times(p: Polynomial, q: Polynomial) -> Polynomial:
    """Their product."""
    total: dict[Exponents, Fraction] = {}
    for (m, c), (n, d) in pairs(p.items(), q.items()):
        k = tuple(map(int.__add__, m, n))
        total[k] = total.get(k, Fraction(0)) + c * d
    return {m: c for m, c in total.items() if c}


def _slope(p: Polynomial, i: int) -> Polynomial:
    return {(*m[:i], m[i] - 1, *m[i + 1 :]): c * m[i] for m, c in p.items() if m[i]}


def values_at(x: Any, *forms: Polynomial) -> Any:
    """The forms at each row of x, a column each."""
    import numpy as np

    monomials = list(dict.fromkeys(m for p in forms for m in p))
    powers = np.array(monomials).reshape(len(monomials), x.shape[1])
    table = x[:, :, None] ** np.arange(powers.max(initial=0) + 1)
    values = np.ones((len(x), len(monomials)))
    for i in range(x.shape[1]):
        values *= table[:, i, powers[:, i]]
    return values @ np.array([[float(p.get(m, 0)) for p in forms] for m in monomials])


def on_spheres(n: int, spheres: Sequence[Sequence[int]], count: int) -> Any:
    """Random points of n variables (fixed seed), those of each sphere of unit length."""
    import numpy as np

    x = np.random.default_rng(7).standard_normal((count, n))
    for s in spheres:
        x[:, s] /= np.linalg.norm(x[:, s], axis=1, keepdims=True)
    return x


def touching_points(form: Polynomial, spheres: Sequence[Sequence[int]], starts: int) -> Any:
    """Zeros of the form as rows, the variables of each of ``spheres``, in which it is homogeneous, having unit length."""
    import numpy as np

    n = len(next(iter(form)))
    if starts * n * n * len(form) > _MOST:
        return np.empty((0, n))
    slopes = [_slope(form, i) for i in range(n)]
    bends = [_slope(p, j) for p in slopes for j in range(n)]
    lengths: list[Polynomial] = [{tuple(2 * (i == j) for i in range(n)): Fraction(1) for j in s} for s in spheres]
    gaps, derivatives = [*slopes, *lengths], [*bends, *(_slope(p, j) for p in lengths for j in range(n))]
    level = np.array([0.0] * n + [1.0] * len(spheres))
    x = on_spheres(n, spheres, _TRIED * starts)
    x = x[np.argsort(values_at(x, form)[:, 0], kind="stable")[:starts]]
    gap, damping = values_at(x, *gaps) - level, np.full(len(x), 1e-2)
    for _ in range(_STEPS):
        size = (gap**2).sum(axis=1)
        if (size < _ENOUGH**2).all():
            break
        left, sizes, axes = np.linalg.svd(values_at(x, *derivatives).reshape(len(x), len(gaps), n), full_matrices=False)
        parts = np.einsum("pgk,pg->pk", left, gap) * sizes / (sizes**2 + (damping * sizes[:, 0] ** 2)[:, None] + 1e-300)
        tried = x - np.einsum("pkv,pk->pv", axes, parts)
        new_gap = values_at(tried, *gaps) - level
        better = (new_gap**2).sum(axis=1) < size
        x, gap = np.where(better[:, None], tried, x), np.where(better[:, None], new_gap, gap)
        damping = np.clip(np.where(better, damping / 10, damping * 5), 1e-16, 1e6)
    return x[np.abs(gap).max(axis=1) < _ENOUGH * max(1.0, max(abs(float(c)) for c in form.values()))]
