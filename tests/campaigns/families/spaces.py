"""Sets in two to six forces: balls of p-norms, maxima, a ball cut by a strip, functions of principal stresses, meridians.

Every threshold is a rational number, or the square root of one that is compared by its square.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from fractions import Fraction

from duhem import Criterion
from duhem.law.criterion_file import reads
from tests.campaigns.families.trial import Trial, near

__all__ = ["SPACES"]

F = Fraction
FORCES = "abcdef"


def _rows(rng: random.Random, n: int) -> list[tuple[Fraction, ...]]:
    """Triangular with a diagonal that is not zero, its columns in some order: invertible."""
    order = rng.sample(range(n), n)
    drawn = [
        [F(rng.randint(-4, 4), rng.randint(1, 3)) if j < i else F(rng.randint(1, 4), 2) if j == i else F(0) for j in range(n)]
        for i in range(n)
    ]
    return [tuple(row[j] for j in order) for row in drawn]


def _form(row: tuple[Fraction, ...]) -> str:
    return "(" + " + ".join(f"({c})*{x}" for c, x in zip(row, FORCES, strict=False) if c) + ")"


def _law(name: str, n: int, g: str) -> Criterion:
    return Criterion(name=name, g=g, forces=tuple(FORCES[:n]), pressure=None)


def _tensor(name: str, kind: str, g: str) -> Criterion:
    text = f'[criterion]\nname = "{name}"\nstress = {{ name = "s", kind = "{kind}" }}\npressure = false\ng = "{g}"\n'
    return reads(text, name)


def _around_zero(convex: bool) -> dict[str, bool]:
    """What is true of a gauge: where it is not convex it may have cusps, of which no dissipation is asked."""
    return {"origin": True, "convexity": convex, "normality": convex} | ({"dissipation": True} if convex else {})


def powers(rng: random.Random, name: str) -> Trial:
    """sum |l_i|^p_i <= 1 with the l_i independent: convex if and only if every p_i >= 1, and smooth if and only if every p_i > 1.

    With p_1 < 1 the point where only l_1 is not zero is a cusp of K in every other direction.
    """
    n = rng.randint(2, 6)
    factor, margin = near(rng) if rng.random() < 0.4 else (F(1), "generic")
    exponents = [rng.choice([F(1), F(3, 2), F(2), F(3), F(4), F(17, 10)]) for _ in range(n)]
    if margin != "generic":
        exponents[rng.randrange(n)] = factor
    elif rng.random() < 0.3:
        exponents[rng.randrange(n)] = F(rng.randint(1, 9), 10)
    g = " + ".join(f"abs({_form(row)})**({p})" for row, p in zip(_rows(rng, n), exponents, strict=True))
    truth = _around_zero(min(exponents) >= 1) | {"smoothness": min(exponents) > 1}
    return Trial("powers", _law(name, n, f"{g} - 1"), truth, margin)


def norms(rng: random.Random, name: str) -> Trial:
    """(sum |l_i|^p)^(1/p) <= 1: convex if and only if p >= 1, smooth if and only if p > 1."""
    n = rng.randint(2, 6)
    p, margin = near(rng) if rng.random() < 0.4 else (rng.choice([F(1, 2), F(9, 10), F(3, 2), F(2), F(5, 2), F(6), F(8)]), "generic")
    total = " + ".join(f"abs({_form(row)})**({p})" for row in _rows(rng, n))
    return Trial("p-norm", _law(name, n, f"({total})**({1 / p}) - 1"), _around_zero(p >= 1) | {"smoothness": p > 1}, margin)


def maximum(rng: random.Random, name: str) -> Trial:
    """|L(s - c)| <= 1 and l . s <= h: convex; 0 in K, and then dissipative, if and only if |Lc| <= 1 and h >= 0."""
    n = rng.randint(2, 6)
    rows = _rows(rng, n)
    factor, margin = near(rng) if rng.random() < 0.5 else (F(rng.randint(0, 12), 10), "generic")
    shift = [factor, *([F(0)] * (n - 1))] if rng.random() < 0.5 else [F(3, 5) * factor, F(4, 5) * factor, *([F(0)] * (n - 2))]
    ball = ", ".join(f"{_form(row)} - ({d})" for row, d in zip(rows, shift, strict=True))
    cut = _form(rows[-1])
    h = F(rng.randint(0, 9), 10)  # -1 < h < 1: the plane cuts the ball, or half of it where the last of the shifts is not zero
    inside = factor <= 1
    truth = {"origin": inside, "convexity": True, "normality": True, "dissipation": inside}
    return Trial("ball and plane", _law(name, n, f"max(norm({ball}) - 1, {cut} - ({h}))"), truth, margin)


def strip(rng: random.Random, name: str) -> Trial:
    """|Ls| <= 1 without the strip |l_1 + b| < c: not convex if and only if a part is left on both sides, c <= 1 - |b|."""
    n = rng.randint(2, 6)
    rows = _rows(rng, n)
    factor, margin = near(rng) if rng.random() < 0.5 else (F(rng.randint(2, 18), 10), "generic")
    b = rng.choice([1, -1]) * F(rng.randint(1, 8), 10)
    c = (1 - abs(b)) * factor
    convex = factor > 1
    ball = ", ".join(_form(row) for row in rows)
    g = f"max(norm({ball}) - 1, ({c})**2 - ({_form(rows[0])} + ({b}))**2)"
    if c >= 1 + abs(b):  # nothing would be left
        return strip(rng, name)
    return Trial("ball without a strip", _law(name, n, g), {"origin": abs(b) >= c, "convexity": convex}, margin)


def ordered(rng: random.Random, name: str) -> Trial:
    """u s1 + v s2 + w s3 <= 1 of the ordered principal stresses, u > 0 and u + v > 0: convex if and only if u >= v >= w."""
    factor, margin = near(rng) if rng.random() < 0.5 else (F(rng.randint(1, 19), 10), "generic")
    kind = rng.choice(["3d", "principal"])
    if rng.random() < 0.5:  # beside u = v
        v = F(rng.randint(1, 9), 5)
        u, w, convex = v * factor, v - F(rng.randint(0, 9), 3), factor >= 1
    else:  # beside v = w
        w = F(rng.randint(1, 9), 5)
        v, convex = w * factor, factor >= 1
        u = v + F(rng.randint(0, 9), 3)
    g = f"({u})*principal(s, 1) + ({v})*principal(s, 2) + ({w})*principal(s, 3) - 1"
    return Trial(f"ordered stresses, {kind}", _tensor(name, kind, g), _around_zero(convex), margin)


def differences(rng: random.Random, name: str) -> Trial:
    """c sum |s_i - s_j|^m <= 1 of the principal stresses: convex if and only if m >= 1."""
    kind = rng.choice(["3d", "principal"])
    m, margin = near(rng) if rng.random() < 0.3 else (rng.choice([F(4, 5), F(3, 2), F(2), F(6), F(8)]), "generic")
    parts = [f"abs(principal(s, {i}) - principal(s, {j}))**({m})" for i, j in ((1, 2), (2, 3), (1, 3))]
    g = f"{F(rng.randint(1, 6), 3)}*({' + '.join(parts)}) - 1"
    return Trial(f"differences, {kind}", _tensor(name, kind, g), _around_zero(m >= 1), margin)


def section(rng: random.Random, name: str) -> Trial:
    """J2^(3/2) + c J3 <= 1: with k = 2c/(3 sqrt 3) and h = 1 + k cos 3t, 9 h^2 + 3 h h'' - 2 h'^2 = 9 (1 - k cos 3t - 2 k^2).

    Convex if and only if |k| <= 1/2, c^2 <= 27/16.
    """
    kind = rng.choice(["3d", "principal"])
    factor, margin = near(rng) if rng.random() < 0.4 else (F(rng.randint(0, 16), 10), "generic")
    near_edge = F(1299038105676657, 10**15)  # below sqrt(27)/4 by 1e-15
    c = rng.choice([1, -1]) * near_edge * factor
    truth = _around_zero(c * c <= F(27, 16)) | {"smoothness": True}
    if margin == "exact":
        margin = "below 1e-15"
    return Trial(f"section, {kind}", _tensor(name, kind, f"J2(s)**(3/2) + ({c})*J3(s) - 1"), truth, margin)


def meridian(rng: random.Random, name: str) -> Trial:
    """A sqrt(J2) + b I1^2 + a I1 <= 1: convex if and only if b >= 0."""
    kind = rng.choice(["3d", "principal", "plane"])
    b = rng.choice([F(1), F(1, 10), F(0), F(-1, 10), F(1, 10**9), F(-1, 10**9), F(-1, 10**4)])
    a = F(rng.randint(-6, 6), 5)
    if kind == "plane" and b <= 0:  # a plane stress has |I1| <= 2 sqrt(3 J2): no cone of all pressures
        b = abs(b) + F(1, 7)
    g = f"({F(rng.randint(1, 9), 4)})*sqrt(J2(s)) + ({b})*I1(s)**2 + ({a})*I1(s) - 1"
    truth = {"origin": True, "convexity": b >= 0, "normality": b >= 0}
    return Trial(f"meridian, {kind}", _tensor(name, kind, g), truth, f"b = {float(b):g}")


SPACES: Mapping[str, Callable[[random.Random, str], Trial]] = {
    "powers": powers, "p-norm": norms, "ball and plane": maximum, "ball without a strip": strip, "ordered stresses": ordered,
    "differences": differences, "section": section, "meridian": meridian,
}  # fmt: skip
