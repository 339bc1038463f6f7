"""A set at or beside a threshold, its function under a map that keeps the sign: the set stays what it was.

Every method that looks at gradients and curvatures of g sees another g: flat on the boundary, with a seam along it, far
from convex, huge or tiny beside it.
"""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction

from tests.campaigns.false_proofs.trap import Trap, beside, interval, known, margin, written

__all__ = ["MAPS", "THRESHOLDS", "mapped"]

F = Fraction

# phi with sign(phi(f)) = sign(f)
MAPS = (
    "2*F", "max(F, 2*F)", "min(F, 2*F)", "F**3", "F**5 + F", "F*exp(F)", "tanh(F)", "atan(F)", "exp(F) - 1", "1 - exp(-F)",
    "F/(1 + abs(F))", "F*(1 + F**2)", "where(F > 0, 2*F, F)", "where(F >= 0, F**3, F)", "where(F < 0, F, F**2)", "F*abs(F)",
    "F/sqrt(1 + F**2)", "pos(F) - 2*neg(F)", "pos(F)**2 - neg(F)", "F + abs(F)/2", "max(F, F**3)", "min(F, F**3)", "F*(2 + sin(F))",
    "exp(2*F) - exp(F)", "log(1 + pos(F)) - neg(F)", "sqrt(1 + pos(F)) - 1 - neg(F)", "sqrt(pos(F)) - neg(F)**2", "F*norm(F, 1)",
    "log(3 + tanh(F)) - log(3)", "F*(1 + a**2)", "F*exp(b)", "F*(2 + sin(a))", "k*F", "F/k", "k*F + k*F**3", "F**3/(1 + F**2)",
    "sinh(F)", "F*cosh(F)", "asin(F/(1 + abs(F)))", "pi/2 - acos(F/(1 + abs(F)))", "atan2(F, 1)", "atan2(F, 1 + F**2)", "sign(F)",
    "sign(F)*F**2", "sign(F)*log10(1 + abs(F))", "log10(3 + tanh(F)) - log10(3)", "where(F > 0 or F < -1, F, F**3)",
    "where(F > 0 and F < 1, F**2, F)",
)  # fmt: skip


def quartic(rng: random.Random) -> Trap:
    """a^4 + c a^2 b^2 + b^4 <= N^4, c > -2: convex if and only if 0 <= c <= 6.

    P is homogeneous of even degree, so its sets are convex if and only if it is.  On (1, t) det P'' = 24 c (1 + t^4) +
    (144 - 12 c^2) t^2: 24 c at t = 0, and at least its value 12 (6 - c)(c + 2) at t = 1, times t^2, for c >= 0.
    """
    gap = beside(rng)
    upper = rng.random() < 0.6
    c = 6 + gap if upper else gap
    convex = 0 <= c <= 6
    how = rng.choice(["number", "value", "interval"])
    word, parameters = (written(c), {}) if how == "number" else ("c", {"c": f'{{ value = "{c}" }}'})
    if how == "interval":
        parameters = {"c": interval(F(3), c) if upper else interval(c, F(3))}
    size = rng.choice(["1", "p**4"])
    return Trap("quartic", f"a**4 + b**4 + {word}*a**2*b**2 - {size}", known("osd") | known(*_split("cn", convex)), parameters)


def waves(rng: random.Random) -> Trap:
    """The gauge r (1 + e cos k theta): gamma'' + gamma = 1 - (k^2 - 1) e cos k theta, convex if and only if |e| <= 1/(k^2 - 1)."""
    k = rng.choice([2, 3, 4])
    e = F(rng.choice([1, -1]), k * k - 1) * (1 + beside(rng))
    form = {2: "a**2 - b**2", 3: "a**3 - 3*a*b**2", 4: "a**4 - 6*a**2*b**2 + b**4"}[k]
    g = f"norm(a, b)**{k} + {written(e)}*({form}) - abs(p)*norm(a, b)**{k - 1}"
    return Trap("waves", g, known("osd") | known(*_split("cn", abs(e) <= F(1, k * k - 1))))


def limacon(rng: random.Random) -> Trap:
    """r <= N (1 + e cos theta), |e| < 1: the curvature has the sign of 1 + 2 e^2 + 3 e cos theta, convex if and only if |e| <= 1/2."""
    e = F(rng.choice([1, -1]), 2) * (1 + beside(rng))
    return Trap("limacon", f"norm(a, b)**2 - abs(p)*(norm(a, b) + {written(e)}*a)", known("osd") | known(*_split("cn", abs(e) <= F(1, 2))))


def shifted(rng: random.Random) -> Trap:
    """An ellipse about (s N, 0) with half-axis h N along a: 0 in K, and then dissipative, if and only if |s| <= h.

    Where 0 is outside, the point of K next to it has the outward normal -sigma.
    """
    h, w = F(rng.randint(1, 6), 3), F(rng.randint(1, 6), 3)
    s = h * (1 + beside(rng)) * rng.choice([1, -1])
    x, y = f"(a - {written(s)}*abs(p))/{written(h)}", f"b/{written(w)}"
    g = rng.choice([f"norm({x}, {y}) - abs(p)", f"({x})**2 + ({y})**2 - p**2"])
    return Trap("shifted", g, known("csn") | known(*_split("od", abs(s) <= h)))


def seam(rng: random.Random) -> Trap:
    """|sigma| - e |a| <= N, |e| < 1: the normal on a = 0+ is (-e, 1), so the corner at (0, N) points inward
    for e > 0 and outward for e < 0."""
    e = beside(rng)
    truth = known("od") | known(*_split("cn", e <= 0)) | known(*_split("s", e == 0))
    return Trap("seam", f"norm(a, b) - {written(e)}*abs(a) - abs(p)", truth)


def powers(rng: random.Random) -> Trap:
    """|a|^q + |b|^q <= 1: convex if and only if q >= 1, C^1 if and only if q > 1."""
    q = 1 + beside(rng)
    parameters = {"q": rng.choice([f'{{ value = "{q}" }}', interval(q, F(3))])}
    truth = known("od") | known(*_split("cn", q >= 1)) | known(*_split("s", q > 1))
    return Trap("powers", "abs(a)**q + abs(b)**q - 1", truth, parameters, pressure=None)


def union(rng: random.Random) -> Trap:
    """The unit disc and the disc of radius 1/2 + m about (1/2, 0), which it holds if and only if m <= 0; else inward corners."""
    m = beside(rng)
    g = f"min(norm(a, b) - 1, norm(a - 1/2, b) - {written(F(1, 2) + m)})"
    return Trap("union", g, known("od") | known(*_split("cns", m <= 0)), pressure=None)


def cut(rng: random.Random) -> Trap:
    """The unit disc where a <= 1 + m: corners if and only if m < 0."""
    m = beside(rng)
    return Trap("cut", f"max(norm(a, b) - 1, a - {written(1 + m)})", known("ocnd") | known(*_split("s", m >= 0)), pressure=None)


def ring(rng: random.Random) -> Trap:
    """(|sigma|^2 - 1)^2 <= m: a ring, or a circle: without the origin, not convex."""
    m = rng.choice([F(0), margin(rng)])
    return Trap("ring", f"(a**2 + b**2 - 1)**2 - {written(m)}", known("", "ocn" if m == 0 else "ocnd"), pressure=None)


def _split(claims: str, holds: bool) -> tuple[str, str]:
    return (claims, "") if holds else ("", claims)


THRESHOLDS = (quartic, waves, limacon, shifted, seam, powers, union, cut, ring)


def mapped(rng: random.Random, place: int) -> Trap:
    """A threshold law under one map, or two; every map meets every law in turn."""
    base = THRESHOLDS[place % len(THRESHOLDS)](rng)
    word = MAPS[(place // len(THRESHOLDS) + place) % len(MAPS)]
    g = word.replace("F", f"({base.g})")
    if rng.random() < 0.15:
        g = rng.choice(MAPS).replace("F", f"({g})") if len(g) < 300 else g
    parameters = dict(base.parameters) | ({"k": "{ positive = true }"} if "k" in g else {})
    return replace(base, kind=f"{base.kind} under {word}", g=g, parameters=parameters)
