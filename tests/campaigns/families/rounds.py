"""Sets bounded by arcs: an ellipse, two of them, and a quarter of a p-norm ball in each quadrant."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction

from duhem import Criterion
from tests.campaigns.families.trial import PRESSURE, Trial, direction, linear, matrix, near, scale, written

__all__ = ["ellipse", "quadrants", "two_ellipses"]

F = Fraction


def ellipse(rng: random.Random, name: str) -> Trial:
    """|L (sigma - c N)| <= N: always convex and smooth; 0 in K, and then dissipative, if and only if |L c| <= 1."""
    a, b, c, d = matrix(rng)
    det = a * d - b * c
    cosine, sine = direction(rng)
    factor, margin = near(rng) if rng.random() < 0.5 else (F(rng.randint(0, 30), 20), "generic")
    lx, ly = cosine * factor, sine * factor
    centre = ((d * lx - b * ly) / det, (a * ly - c * lx) / det)
    shifted = [
        f"({written(p)}*(sigma_a - {written(centre[0])}*{PRESSURE}) + {written(q)}*(sigma_b - {written(centre[1])}*{PRESSURE}))"
        for p, q in ((a, b), (c, d))
    ]
    g = rng.choice([f"norm({shifted[0]}, {shifted[1]}) - {PRESSURE}", f"{shifted[0]}**2 + {shifted[1]}**2 - {PRESSURE}**2"])
    inside = factor <= 1
    truth = {"origin": inside, "convexity": True, "smoothness": True, "normality": True, "dissipation": inside}
    return Trial("shifted ellipse", Criterion(name=name, g=g), truth, margin)


def quadrants(rng: random.Random, name: str) -> Trial:
    """A quarter of a p-norm ball in each quadrant, p in {1, 2, 4}, each with intercepts of its own.

    Convex exactly where the quarters meet on every half-axis (they reach it at a right angle or leaning inward);
    then smooth if no quarter is straight.
    """
    joined = rng.random() < 0.5
    ends = [scale(rng) for _ in range(4)]  # +a, +b, -a, -b
    quarter: list[tuple[Fraction, Fraction, int]] = []
    for k in range(4):
        along_a, along_b = (ends[0] if k in (0, 3) else ends[2]), (ends[1] if k in (0, 1) else ends[3])
        if not joined and rng.random() < 0.4:
            change = rng.choice([F(2), F(1, 2), 1 + F(1, 100), 1 - F(1, 100)])
            along_a, along_b = (along_a * change, along_b) if rng.random() < 0.5 else (along_a, along_b * change)
        quarter.append((along_a, along_b, rng.choice([2, 2, 2, 4, 1])))

    def text(a: Fraction, b: Fraction, p: int) -> str:
        if p == 1:
            return f"abs(sigma_a)/{written(a)} + abs(sigma_b)/{written(b)}"
        if p == 2:
            return f"norm(sigma_a/{written(a)}, sigma_b/{written(b)})"
        return f"((sigma_a/{written(a)})**4 + (sigma_b/{written(b)})**4)**(1/4)"

    one, two, three, four = (text(*q) for q in quarter)
    g = f"where(sigma_a >= 0, where(sigma_b >= 0, {one}, {four}), where(sigma_b >= 0, {two}, {three})) - {PRESSURE}"
    on_a = quarter[0][0] == quarter[3][0] and quarter[1][0] == quarter[2][0]
    meet = on_a and quarter[0][1] == quarter[1][1] and quarter[3][1] == quarter[2][1]
    truth = {"origin": True, "convexity": meet, "normality": meet, "smoothness": meet and all(q[2] > 1 for q in quarter)}
    return Trial("quadrants", Criterion(name=name, g=g), truth | ({"dissipation": True} if meet else {}), "continuous" if meet else "jump")


def two_ellipses(rng: random.Random, name: str) -> Trial:
    """The larger or the lesser of two centred ellipse gauges: one nested in the other, or crossing at four corners."""
    first = matrix(rng)
    kind = rng.choice(["nested", "touching", "free"])
    (c, s), grow = direction(rng), F(rng.randint(11, 20), 10)
    if kind == "free":
        second = matrix(rng)
    else:  # stretch the first along one direction, or along both
        along, across = grow, F(1) if kind == "touching" else grow
        u, v, w = along * c * c + across * s * s, (along - across) * c * s, along * s * s + across * c * c
        a, b, d, e = first
        second = (a * u + b * v, a * v + b * w, d * u + e * v, d * v + e * w)

    def square(m: Sequence[Fraction]) -> tuple[Fraction, Fraction, Fraction]:
        return m[0] ** 2 + m[2] ** 2, m[0] * m[1] + m[2] * m[3], m[1] ** 2 + m[3] ** 2

    gap = [x - y for x, y in zip(square(first), square(second), strict=True)]
    nested = gap[0] * gap[2] - gap[1] ** 2 >= 0
    word = rng.choice(["max", "min"])
    convex = word == "max" or nested
    gauges = [f"norm({linear(m[:2])}, {linear(m[2:])})" for m in (first, second)]
    truth = {"origin": True, "convexity": convex, "normality": convex, "smoothness": nested, "dissipation": True}
    return Trial("two ellipses", Criterion(name=name, g=f"{word}({gauges[0]}, {gauges[1]}) - {PRESSURE}"), truth, f"{word}, {kind}")
