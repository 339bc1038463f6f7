"""The closest point on the four-quadrant ellipse in as many digits as asked for, by a route of its own.

The secular equation |sigma(t)|_gauge = e of sigma(t) = (k^-1 + t D^-2)^-1 k^-1 sigma_tr, t = lambda/e, is solved by Newton's
method on e/gauge - 1 (J. J. Moré and D. C. Sorensen, 1983, SIAM J. Sci. Stat. Comput. 4, 553-572) for the coefficients of each
quadrant; the one whose result lies in that quadrant is the answer.  Numbers come in as floats, taken exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from mpmath import MPContext

Pair = tuple[Any, Any]


@dataclass(frozen=True)
class Exact:
    """The answer: stress, slip and multiplier of the gauge; ``slips`` whether the trial lies outside."""

    stress: Pair
    slip: Pair
    multiplier: Any
    slips: bool


@cache
def _context(digits: int) -> MPContext:
    mp = MPContext()
    mp.dps = digits
    return mp


def closest(trial: Sequence[float], load: float, mu: Sequence[float], k: Sequence[Sequence[float]], digits: int = 160) -> Exact:
    """Closest point to ``trial`` in the metric of k^-1 for mu = (a_plus, a_minus, b_plus, b_minus)."""
    mp = _context(digits)
    t = (mp.mpf(trial[0]), mp.mpf(trial[1]))
    e = mp.mpf(load)
    zero = mp.mpf(0)

    def coefficients(signs: Pair) -> Pair:
        return mp.mpf(float(mu[0 if signs[0] >= 0 else 1])), mp.mpf(float(mu[2 if signs[1] >= 0 else 3]))

    m = coefficients(t)
    if (t[0] / m[0]) ** 2 + (t[1] / m[1]) ** 2 <= e * e:
        return Exact(t, (zero, zero), zero, False)
    k11, k12, k22 = (mp.mpf(float(x)) for x in (k[0][0], k[0][1], k[1][1]))
    det = k11 * k22 - k12 * k12
    h = (k22 / det, -k12 / det, k11 / det)
    force = (h[0] * t[0] + h[1] * t[1], h[1] * t[0] + h[2] * t[1])
    if e == 0:  # K is one point
        signs = force
        m = coefficients(signs)
        return Exact((zero, zero), force, mp.sqrt((m[0] * force[0]) ** 2 + (m[1] * force[1]) ** 2), True)
    for signs in ((a, b) for a in (1, -1) for b in (1, -1)):
        m = coefficients(signs)
        found = _secular(mp, h, force, m, e)
        if found is None:
            continue
        sigma, lam = found
        if signs[0] * sigma[0] >= 0 and signs[1] * sigma[1] >= 0:
            slip = (lam / e * sigma[0] / m[0] ** 2, lam / e * sigma[1] / m[1] ** 2)
            return Exact(sigma, slip, lam, True)
    raise AssertionError("no quadrant holds its own result")


def _secular(mp: Any, h: tuple[Any, Any, Any], force: Pair, m: Pair, e: Any) -> tuple[Pair, Any] | None:
    g = (1 / m[0] ** 2, 1 / m[1] ** 2)

    def solve(t: Any, rhs: Pair) -> Pair:
        a, b, d = h[0] + t * g[0], h[1], h[2] + t * g[1]
        det = a * d - b * b
        return (d * rhs[0] - b * rhs[1]) / det, (a * rhs[1] - b * rhs[0]) / det

    def gauge(s: Pair) -> Any:
        return mp.sqrt(g[0] * s[0] ** 2 + g[1] * s[1] ** 2)

    t = mp.mpf(0)
    sigma = solve(t, force)
    if gauge(sigma) <= e:
        return None  # the trial lies inside the ellipse of this quadrant
    for _ in range(1000):
        size = gauge(sigma)
        back = (g[0] * sigma[0], g[1] * sigma[1])
        change = solve(t, back)
        step = (size / e - 1) * size**2 / (back[0] * change[0] + back[1] * change[1])
        t += step
        sigma = solve(t, force)
        if abs(step) <= abs(t) * mp.mpf(10) ** -60:
            return sigma, t * e
    raise AssertionError("the secular equation was not solved")
