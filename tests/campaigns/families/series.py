"""Sets whose gauge or whose radius is a short Fourier series in the polar angle."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction

import sympy as sp

from tests.campaigns.families.trial import PRESSURE, Trial, direction, near, star
from tests.oracles.fourier_series import Series, derivative, half_angle, positive_at_pi, rotated
from tests.oracles.real_line import nonnegative_on_the_line, positive_on_the_line

__all__ = ["gauge", "radius"]

F = Fraction


def _touching(rng: random.Random) -> Series:
    """gamma with gamma'' + gamma = |p(e^(i theta))|^2/norm, zero at theta = 0, no first harmonic, mean 1.

    p(z) = (z - 1)(z^2 + alpha z + beta); the first harmonic of |p|^2 vanishes for alpha = 1 + d + d^2, beta = alpha + d.
    """
    d = F(rng.randint(-8, 8), rng.randint(2, 5))
    alpha = F(1) + d + d * d
    beta = alpha + d
    c = [-beta, beta - alpha, alpha - 1, F(1)]
    mean = sum((v * v for v in c), F(0))
    h = {k: 2 * sum((c[i] * c[i + k] for i in range(4 - k)), F(0)) / mean for k in (1, 2, 3)}
    assert h[1] == 0
    return {0: (F(1), F(0)), 2: (h[2] / (1 - 4), F(0)), 3: (h[3] / (1 - 9), F(0))}


def _series(rng: random.Random, threshold: Callable[[int], Fraction]) -> tuple[Series, str]:
    kind = rng.random()
    factor, margin = near(rng)
    if kind < 0.3:  # one harmonic at its own threshold
        k = rng.randint(2, 5)
        found: Series = {0: (F(1), F(0)), k: (rng.choice([1, -1]) * threshold(k) * factor, F(0))}
        return rotated(found, *direction(rng)), margin
    found = {0: (F(1), F(0))}
    top = rng.randint(1, 5)
    for k in range(1, top + 1):
        found[k] = (F(rng.randint(-8, 8), 10 * (k * k + 1)), F(rng.randint(-8, 8), 10 * (k * k + 1)))
    return found, "generic"


def _term(k: int, a: Fraction, b: Fraction) -> str:
    """r^k (a cos k theta + b sin k theta) as a polynomial."""
    x, y = sp.symbols("sigma_a sigma_b", real=True)
    z = sp.expand((x + sp.I * y) ** k)
    wave = sp.expand(sp.Rational(*a.as_integer_ratio()) * sp.re(z) + sp.Rational(*b.as_integer_ratio()) * sp.im(z))
    return f"({wave})"


def gauge(rng: random.Random, name: str) -> Trial:
    """gamma(theta) r <= N, gamma a short series: convex if and only if gamma'' + gamma = sum (1 - k^2)(...) >= 0."""
    while True:
        if rng.random() < 0.3:
            factor, margin = near(rng)
            series = rotated({k: (a * factor if k else a, b) for k, (a, b) in _touching(rng).items()}, *direction(rng))
        else:
            series, margin = _series(rng, lambda k: F(1, k * k - 1))
        series = {k: c for k, c in series.items() if k == 0 or any(c)}
        if positive_on_the_line(half_angle(series)) and positive_at_pi(series):
            break
    convex = nonnegative_on_the_line(half_angle(series, lambda k: F(1 - k * k)))
    r = "norm(sigma_a, sigma_b)"
    if rng.random() < 0.5:
        g = " + ".join([r] + [f"{_term(k, *c)}/{r}**{k - 1}" for k, c in series.items() if k]) + f" - {PRESSURE}"
    else:
        n = max(max(series), 1)
        g = " + ".join([f"{r}**{n}"] + [f"{_term(k, *c)}*{r}**{n - k}" for k, c in series.items() if k]) + f" - {PRESSURE}*{r}**{n - 1}"
    return star("gauge series", name, g, convex, margin)


def radius(rng: random.Random, name: str) -> Trial:
    """r <= N rho(theta), rho a short series: convex if and only if rho^2 + 2 rho'^2 - rho rho'' >= 0."""
    while True:
        series, margin = _series(rng, lambda k: F(1, k * k + 1))
        series = {k: c for k, c in series.items() if k == 0 or any(c)}
        if positive_on_the_line(half_angle(series)) and positive_at_pi(series):
            break
    rho = half_angle(series)
    n = max(series)
    first, second = derivative(series), derivative(derivative(series))
    pad = {n: (F(0), F(0)), **{k: c for k, c in first.items()}}, {n: (F(0), F(0)), **{k: c for k, c in second.items()}}
    rho1, rho2 = half_angle(pad[0]), half_angle(pad[1])
    convex = nonnegative_on_the_line(rho**2 + 2 * rho1**2 - rho * rho2)
    r = "norm(sigma_a, sigma_b)"
    waves = " + ".join([f"{r}**{n}"] + [f"{_term(k, *c)}*{r}**{n - k}" for k, c in series.items() if k])
    return star("radius series", name, f"{r}**{n + 1} - {PRESSURE}*({waves})", convex, margin)
