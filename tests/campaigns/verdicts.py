"""Laws of known truth, generated from a seed, and what duhem says of them.

The truth is decided here, in exact rational arithmetic, from the geometry of each family: real roots counted for
curves, vertices and areas for polygons, a distance for ellipses.  Nothing of duhem takes part in it.

    python -m tests.campaigns.verdicts --count 500 --seed 1
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import islice, pairwise
from typing import Any

import sympy as sp

from duhem import POSITIVE, Criterion, Domain, Verdict, Verification, verify
from tests.oracles.reevaluation import confirmed

__all__ = ["FAMILIES", "Outcome", "Trial", "judge", "nonnegative_on_the_line", "trials"]

F = Fraction
T = sp.Symbol("t", real=True)
N = "abs(sigma_n)"


@dataclass(frozen=True)
class Trial:
    """A law with the claims whose truth is known; ``margin`` says how close to a threshold it was made."""

    family: str
    law: Criterion
    truth: Mapping[str, bool]
    margin: str = "generic"


# -- exact arithmetic of one variable ---------------------------------------------------------------------------------


def _poly(expr: Any) -> sp.Poly:
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


# -- random rationals -------------------------------------------------------------------------------------------------


def _some(rng: random.Random, size: int = 6, parts: int = 4) -> Fraction:
    return F(rng.randint(-size * parts, size * parts), parts)


def _scale(rng: random.Random) -> Fraction:
    return F(rng.randint(1, 12), rng.randint(1, 6))


def _matrix(rng: random.Random) -> tuple[Fraction, Fraction, Fraction, Fraction]:
    while True:
        m = tuple(F(rng.randint(-5, 5), rng.randint(1, 3)) for _ in range(4))
        if abs(m[0] * m[3] - m[1] * m[2]) > F(1, 4):
            return m  # type: ignore[return-value]


def _direction(rng: random.Random) -> tuple[Fraction, Fraction]:
    """A rational point of the unit circle."""
    t = F(rng.randint(-9, 9), rng.randint(1, 7))
    return (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)


def _n(x: Fraction) -> str:
    return f"({x})"


def _linear(row: Sequence[Fraction]) -> str:
    return f"({_n(row[0])}*sigma_a + {_n(row[1])}*sigma_b)"


def _near(rng: random.Random) -> tuple[Fraction, str]:
    """A factor at or beside 1."""
    return rng.choice([
        (F(1), "exact"), (F(1), "exact"), (1 + F(1, 10**9), "above 1e-9"), (1 - F(1, 10**9), "below 1e-9"),
        (1 + F(1, 10**4), "above 1e-4"), (1 - F(1, 10**4), "below 1e-4"),
    ])  # fmt: skip


_SMOOTH_STAR = {"origin": True, "smoothness": True, "dissipation": True}


def _star(family: str, name: str, g: str, convex: bool, margin: str, parameters: Mapping[str, Domain] | None = None) -> Trial:
    truth = _SMOOTH_STAR | {"convexity": convex, "normality": convex}
    return Trial(family, Criterion(name=name, g=g, parameters=parameters or {}), truth, margin)


# -- quartics ---------------------------------------------------------------------------------------------------------


def _form_text(p: Mapping[int, Fraction], degree: int) -> str:
    """sum p_k sigma_a^(degree - k) sigma_b^k."""
    return " + ".join(f"{_n(c)}*sigma_a**{degree - k}*sigma_b**{k}" for k, c in p.items() if c) or "0"


def _form(p: sp.Expr, degree: int, m: Sequence[Fraction]) -> tuple[dict[int, Fraction], sp.Expr]:
    """The form p(x, y) after the linear map m: its coefficients, and P in x, y."""
    x, y = sp.symbols("x y", real=True)
    a, b, c, d = (sp.Rational(v.numerator, v.denominator) for v in m)
    moved = sp.Poly(sp.expand(p.subs({x: a * x + b * y, y: c * x + d * y}, simultaneous=True)), x, y)
    return {k: F(int(v.p), int(v.q)) for k in range(degree + 1) if (v := moved.coeff_monomial(x ** (degree - k) * y**k))}, moved.as_expr()


def _bend(p: sp.Expr, q: sp.Expr) -> sp.Expr:
    """P_xx Q_y R_y - ... with all three the same: the second derivative of P along its level curve, times |grad Q|^2."""
    x, y = sp.symbols("x y", real=True)
    qx, qy = q.diff(x), q.diff(y)
    return sp.expand(p.diff(x, 2) * qy**2 - 2 * p.diff(x, y) * qx * qy + p.diff(y, 2) * qx**2)


def _on_line(p: sp.Expr) -> sp.Poly:
    x, y = sp.symbols("x y", real=True)
    return _poly(sp.expand(p.subs({x: 1, y: T}, simultaneous=True)))


def quartic(rng: random.Random, name: str) -> Trial:
    """P <= (mu N)^4 with P a positive definite quartic form: convex if and only if its curvature form, of degree 8, is >= 0."""
    x, y = sp.symbols("x y", real=True)
    while True:
        margin, p = "generic", sp.S.Zero
        if rng.random() < 0.5:
            edge, (factor, margin) = rng.choice([F(6), F(6), F(0)]), _near(rng)
            c = edge * factor if edge else factor - 1
            p = x**4 + sp.Rational(c.numerator, c.denominator) * x**2 * y**2 + y**4
        else:
            u, v = (sum(sp.Rational(rng.randint(-6, 6), rng.randint(1, 3)) * z for z in (x**2, x * y, y**2)) for _ in range(2))
            p = sp.expand(u**2 + v**2 + rng.randint(0, 6) * (x**2 + y**2) ** 2)
        coefficients, moved = _form(p, 4, _matrix(rng))
        line = _on_line(moved)
        if positive_form(line, 4):
            break
    convex = nonnegative_on_the_line(_on_line(_bend(moved, moved)))
    size = rng.choice(["(mu*abs(sigma_n))", "abs(sigma_n)", "(3/7*abs(sigma_n))"])
    g = f"{_form_text(coefficients, 4)} - {size}**4"
    return _star("quartic form", name, g, convex, margin, {"mu": POSITIVE} if "mu" in size else None)


_DEGREES = (8, 6, 4, 2)


def even_quartic(rng: random.Random, name: str) -> Trial:
    """P + Q N^2 <= N^4 with P a positive definite quartic form and Q a quadratic one.

    On the ray (1, t) the boundary lies at u = x^2, the one positive root of P(1, t) u^2 + Q(1, t) u = 1.  Its curvature
    there has the sign of k8 u^3 + k6 u^2 + k4 u + k2, which can only change at real zeros of the resultant: one exact
    sample a cell.
    """
    x, y, u = sp.symbols("x y u", real=True)
    while True:
        m = _matrix(rng)
        c = F(rng.randint(-6, 30), 4)
        p4, four = _form(x**4 + sp.Rational(c.numerator, c.denominator) * x**2 * y**2 + y**4, 4, m)
        rows = [sp.Rational(rng.randint(-8, 8), rng.randint(1, 3)) for _ in range(3)]
        p2, two = _form(rows[0] * x**2 + rows[1] * x * y + rows[2] * y**2, 2, (F(1), F(0), F(0), F(1)))
        if not p2 or not positive_form(_on_line(four), 4):
            continue
        level = sp.Poly(_on_line(four).as_expr() * u**2 + _on_line(two).as_expr() * u - 1, u, T)
        whole = sp.Poly(_bend(four + two, four + two), x, y)
        by_degree = {d: _on_line(sum(k * x**i * y**j for (i, j), k in whole.terms() if i + j == d)) for d in _DEGREES}
        bend = sp.Poly(sum(by_degree[d].as_expr() * u ** ((d - 2) // 2) for d in _DEGREES), u, T)
        between = _poly(level.resultant(bend).as_expr())
        if not between.is_zero:
            break
    convex = all(_sign_on_boundary(_on_line(four), _on_line(two), by_degree, sample) >= 0 for sample in _samples(between))
    g = f"{_form_text(p4, 4)} + ({_form_text(p2, 2)})*{N}**2 - {N}**4"
    return _star("even quartic", name, g, convex, "generic")


def _samples(p: sp.Poly) -> list[sp.Rational]:
    """A rational point in every cell between neighbouring real roots of p, and beyond the last ones."""
    spans = sorted(span for span, _ in p.intervals(eps=sp.Rational(1, 10**6))) if p.degree() > 0 else []
    if not spans:
        return [sp.S.Zero]
    inner = [(a[1] + b[0]) / 2 for a, b in pairwise(spans)]
    found = [spans[0][0] - 1, *inner, spans[-1][1] + 1]
    return [t for t in found if p.eval(t) != 0]


def _sign_on_boundary(p: sp.Poly, q: sp.Poly, bend: Mapping[int, sp.Poly], t: sp.Rational) -> int:
    """Exact sign of k8 u^3 + k6 u^2 + k4 u + k2 at u = (-q + sqrt(q^2 + 4 p))/(2 p), as alpha + beta sqrt(...) by Horner."""
    a, b = p.eval(t), q.eval(t)
    radicand = b**2 + 4 * a
    real, root = -b / (2 * a), 1 / (2 * a)
    alpha, beta = sp.S.Zero, sp.S.Zero
    for d in _DEGREES:
        alpha, beta = alpha * real + beta * root * radicand + bend[d].eval(t), alpha * root + beta * real
    return _sign_with_root(alpha, beta, radicand)


def _sign_with_root(alpha: sp.Rational, beta: sp.Rational, radicand: sp.Rational) -> int:
    """Exact sign of alpha + beta sqrt(radicand), radicand > 0."""
    if alpha * beta >= 0:
        return int(sp.sign(alpha + beta))
    return int(sp.sign(alpha) * sp.sign(alpha**2 - beta**2 * radicand))


# -- Fourier series in the polar angle --------------------------------------------------------------------------------

Series = dict[int, tuple[Fraction, Fraction]]  # k: (coefficient of cos k theta, of sin k theta)


def _half_angle(series: Series, weight: Callable[[int], Fraction] = lambda k: F(1)) -> sp.Poly:
    """(1 + t^2)^n sum weight(k) (a_k cos k theta + b_k sin k theta), t = tan(theta/2), n the highest k."""
    n = max(series)
    total = _poly(0)
    for k, (a, b) in series.items():
        turned = sp.expand((1 + sp.I * T) ** (2 * k))
        real, imaginary = _poly(sp.re(turned)), _poly(sp.im(turned))
        w = weight(k)
        term = real * sp.Rational(*(a * w).as_integer_ratio()) + imaginary * sp.Rational(*(b * w).as_integer_ratio())
        total += term * _poly(1 + T**2) ** (n - k)
    return total


def _dot(series: Series) -> Series:
    """Derivative by theta."""
    return {k: (k * b, -k * a) for k, (a, b) in series.items()}


def _rotated(series: Series, c: Fraction, s: Fraction) -> Series:
    """The series in theta - phi, with (c, s) = (cos phi, sin phi)."""
    found, ck, sk = {}, F(1), F(0)
    for k in range(max(series) + 1):
        if k in series:
            a, b = series[k]
            found[k] = (a * ck - b * sk, a * sk + b * ck)
        ck, sk = ck * c - sk * s, ck * s + sk * c
    return found


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
    factor, margin = _near(rng)
    if kind < 0.3:  # one harmonic at its own threshold
        k = rng.randint(2, 5)
        found: Series = {0: (F(1), F(0)), k: (rng.choice([1, -1]) * threshold(k) * factor, F(0))}
        return _rotated(found, *_direction(rng)), margin
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
            factor, margin = _near(rng)
            series = _rotated({k: (a * factor if k else a, b) for k, (a, b) in _touching(rng).items()}, *_direction(rng))
        else:
            series, margin = _series(rng, lambda k: F(1, k * k - 1))
        series = {k: c for k, c in series.items() if k == 0 or any(c)}
        if positive_on_the_line(_half_angle(series)) and _positive_at_pi(series):
            break
    convex = nonnegative_on_the_line(_half_angle(series, lambda k: F(1 - k * k)))
    r = "norm(sigma_a, sigma_b)"
    if rng.random() < 0.5:
        g = " + ".join([r] + [f"{_term(k, *c)}/{r}**{k - 1}" for k, c in series.items() if k]) + f" - {N}"
    else:
        n = max(max(series), 1)
        g = " + ".join([f"{r}**{n}"] + [f"{_term(k, *c)}*{r}**{n - k}" for k, c in series.items() if k]) + f" - {N}*{r}**{n - 1}"
    return _star("gauge series", name, g, convex, margin)


def _positive_at_pi(series: Series) -> bool:
    return sum((a * (-1) ** k for k, (a, _) in series.items()), F(0)) > 0


def radius(rng: random.Random, name: str) -> Trial:
    """r <= N rho(theta), rho a short series: convex if and only if rho^2 + 2 rho'^2 - rho rho'' >= 0."""
    while True:
        series, margin = _series(rng, lambda k: F(1, k * k + 1))
        series = {k: c for k, c in series.items() if k == 0 or any(c)}
        if positive_on_the_line(_half_angle(series)) and _positive_at_pi(series):
            break
    rho = _half_angle(series)
    n = max(series)
    first, second = _dot(series), _dot(_dot(series))
    pad = {n: (F(0), F(0)), **{k: c for k, c in first.items()}}, {n: (F(0), F(0)), **{k: c for k, c in second.items()}}
    rho1, rho2 = _half_angle(pad[0]), _half_angle(pad[1])
    convex = nonnegative_on_the_line(rho**2 + 2 * rho1**2 - rho * rho2)
    r = "norm(sigma_a, sigma_b)"
    waves = " + ".join([f"{r}**{n}"] + [f"{_term(k, *c)}*{r}**{n - k}" for k, c in series.items() if k])
    return _star("radius series", name, f"{r}**{n + 1} - {N}*({waves})", convex, margin)


# -- ellipses ---------------------------------------------------------------------------------------------------------


def ellipse(rng: random.Random, name: str) -> Trial:
    """|L (sigma - c N)| <= N: always convex and smooth; 0 in K, and then dissipative, if and only if |L c| <= 1."""
    a, b, c, d = _matrix(rng)
    det = a * d - b * c
    cosine, sine = _direction(rng)
    factor, margin = _near(rng) if rng.random() < 0.5 else (F(rng.randint(0, 30), 20), "generic")
    lx, ly = cosine * factor, sine * factor
    centre = ((d * lx - b * ly) / det, (a * ly - c * lx) / det)
    shifted = [f"({_n(p)}*(sigma_a - {_n(centre[0])}*{N}) + {_n(q)}*(sigma_b - {_n(centre[1])}*{N}))" for p, q in ((a, b), (c, d))]
    g = rng.choice([f"norm({shifted[0]}, {shifted[1]}) - {N}", f"{shifted[0]}**2 + {shifted[1]}**2 - {N}**2"])
    inside = factor <= 1
    truth = {"origin": inside, "convexity": True, "smoothness": True, "normality": True, "dissipation": inside}
    return Trial("shifted ellipse", Criterion(name=name, g=g), truth, margin)


# -- piecewise laws ---------------------------------------------------------------------------------------------------


def quadrants(rng: random.Random, name: str) -> Trial:
    """A quarter of a p-norm ball in each quadrant, p in {1, 2, 4}, each with intercepts of its own.

    Convex exactly where the quarters meet on every half-axis (they reach it at a right angle or leaning inward);
    then smooth if no quarter is straight.
    """
    joined = rng.random() < 0.5
    ends = [_scale(rng) for _ in range(4)]  # +a, +b, -a, -b
    quarter: list[tuple[Fraction, Fraction, int]] = []
    for k in range(4):
        along_a, along_b = (ends[0] if k in (0, 3) else ends[2]), (ends[1] if k in (0, 1) else ends[3])
        if not joined and rng.random() < 0.4:
            change = rng.choice([F(2), F(1, 2), 1 + F(1, 100), 1 - F(1, 100)])
            along_a, along_b = (along_a * change, along_b) if rng.random() < 0.5 else (along_a, along_b * change)
        quarter.append((along_a, along_b, rng.choice([2, 2, 2, 4, 1])))

    def text(a: Fraction, b: Fraction, p: int) -> str:
        if p == 1:
            return f"abs(sigma_a)/{_n(a)} + abs(sigma_b)/{_n(b)}"
        if p == 2:
            return f"norm(sigma_a/{_n(a)}, sigma_b/{_n(b)})"
        return f"((sigma_a/{_n(a)})**4 + (sigma_b/{_n(b)})**4)**(1/4)"

    one, two, three, four = (text(*q) for q in quarter)
    g = f"where(sigma_a >= 0, where(sigma_b >= 0, {one}, {four}), where(sigma_b >= 0, {two}, {three})) - {N}"
    on_a = quarter[0][0] == quarter[3][0] and quarter[1][0] == quarter[2][0]
    meet = on_a and quarter[0][1] == quarter[1][1] and quarter[3][1] == quarter[2][1]
    truth = {"origin": True, "convexity": meet, "normality": meet, "smoothness": meet and all(q[2] > 1 for q in quarter)}
    return Trial("quadrants", Criterion(name=name, g=g), truth | ({"dissipation": True} if meet else {}), "continuous" if meet else "jump")


Point = tuple[Fraction, Fraction]
HalfPlane = tuple[Fraction, Fraction, Fraction]  # a x + b y <= d


def _clip(polygon: Sequence[Point], half: HalfPlane) -> list[Point]:
    """The part of a convex polygon in a half-plane (Sutherland and Hodgman 1974)."""
    a, b, d = half
    kept: list[Point] = []
    for p, q in zip(polygon, [*polygon[1:], *polygon[:1]], strict=True):
        hp, hq = a * p[0] + b * p[1] - d, a * q[0] + b * q[1] - d
        if hp <= 0:
            kept.append(p)
        if hp * hq < 0:
            s = hp / (hp - hq)
            kept.append((p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])))
    return list(dict.fromkeys(kept))


def _area(polygon: Sequence[Point]) -> Fraction:
    return sum((p[0] * q[1] - p[1] * q[0] for p, q in zip(polygon, [*polygon[1:], *polygon[:1]], strict=True)), F(0)) / 2


def _left_turn(p: Point, q: Point, r: Point) -> bool:
    return (q[0] - p[0]) * (r[1] - p[1]) > (q[1] - p[1]) * (r[0] - p[0])


def _hull(points: Sequence[Point]) -> list[Point]:
    """Convex hull, counter-clockwise (Andrew 1979)."""

    def half(ordered: Sequence[Point]) -> list[Point]:
        chain: list[Point] = []
        for p in ordered:
            while len(chain) > 1 and not _left_turn(chain[-2], chain[-1], p):
                chain.pop()
            chain.append(p)
        return chain[:-1]

    ordered = sorted(set(points))
    return half(ordered) + half(ordered[::-1])


_HUGE = [(F(-1000), F(-1000)), (F(1000), F(-1000)), (F(1000), F(1000)), (F(-1000), F(1000))]


def _polygon(halves: Sequence[HalfPlane]) -> list[Point]:
    found = _HUGE
    for half in halves:
        found = _clip(found, half)
    return found


def _halves(rng: random.Random, count: int, offset: Callable[[], Fraction]) -> list[HalfPlane]:
    while True:
        found = [(F(rng.randint(-4, 4)), F(rng.randint(-4, 4)), offset()) for _ in range(count)]
        found = [h for h in found if h[0] or h[1]]
        polygon = _polygon(found)
        if len(polygon) > 2 and max(max(abs(c) for c in p) for p in polygon) < 900 and _area(polygon) > F(1, 20):
            return found


def _forms(halves: Sequence[HalfPlane]) -> str:
    return f"max({', '.join(f'{_linear(h[:2])} - {_n(h[2])}*{N}' for h in halves)})"


def polygon(rng: random.Random, name: str) -> Trial:
    """Finitely many half-planes: convex with corners; 0 in K, and then dissipative, if and only if no offset is negative."""
    shifted = rng.random() < 0.4
    halves = _halves(rng, rng.randint(4, 6), lambda: F(rng.randint(-1 if shifted else 1, 6), 2))
    inside = all(h[2] >= 0 for h in halves)
    truth = {"origin": inside, "convexity": True, "smoothness": False, "normality": True, "dissipation": inside}
    return Trial("polygon", Criterion(name=name, g=_forms(halves)), truth, "origin inside" if inside else "origin outside")


def union(rng: random.Random, name: str) -> Trial:
    """Two polygons around the origin: convex if and only if their hull has no greater area than their union."""
    if rng.random() < 0.4:  # one polygon cut twice, so that the union may be whole again
        base = _halves(rng, 4, lambda: F(rng.randint(1, 6), 2))
        a, b = rng.choice([(F(1), F(0)), (F(1), F(2)), (F(0), F(1))])
        one = [*base, (a, b, F(rng.randint(1, 3), 4))]
        two = [*base, (-a, -b, F(rng.randint(1, 3), 4))]
        if rng.random() < 0.3:
            two[-1] = (-a - F(1, 10), -b, two[-1][2])
    else:
        one, two = (_halves(rng, 4, lambda: F(rng.randint(1, 6), 2)) for _ in range(2))
    p, q = _polygon(one), _polygon(two)
    both = _polygon([*one, *two])
    convex = _area(_hull([*p, *q])) == _area(p) + _area(q) - _area(both)
    truth = {"origin": True, "convexity": convex, "normality": convex, "smoothness": False, "dissipation": True}
    law = Criterion(name=name, g=f"min({_forms(one)}, {_forms(two)})")
    return Trial("union of polygons", law, truth, "convex" if convex else "not convex")


def two_ellipses(rng: random.Random, name: str) -> Trial:
    """The larger or the lesser of two centred ellipse gauges: one nested in the other, or crossing at four corners."""
    first = _matrix(rng)
    kind = rng.choice(["nested", "touching", "free"])
    (c, s), grow = _direction(rng), F(rng.randint(11, 20), 10)
    if kind == "free":
        second = _matrix(rng)
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
    gauges = [f"norm({_linear(m[:2])}, {_linear(m[2:])})" for m in (first, second)]
    truth = {"origin": True, "convexity": convex, "normality": convex, "smoothness": nested, "dissipation": True}
    return Trial("two ellipses", Criterion(name=name, g=f"{word}({gauges[0]}, {gauges[1]}) - {N}"), truth, f"{word}, {kind}")


FAMILIES: Mapping[str, Callable[[random.Random, str], Trial]] = {
    "quartic form": quartic, "even quartic": even_quartic, "gauge series": gauge, "radius series": radius, "shifted ellipse": ellipse,
    "quadrants": quadrants, "polygon": polygon, "union of polygons": union, "two ellipses": two_ellipses,
}  # fmt: skip


def trials(count: int, seed: int) -> Iterator[Trial]:
    """``count`` laws, the families in turn; each law depends on the seed and its own place only."""

    def endless() -> Iterator[Trial]:
        place = 0
        while True:
            for family, make in FAMILIES.items():
                yield make(random.Random(f"{seed}/{family}/{place}"), f"{family.replace(' ', '-')}-{place}")
            place += 1

    return islice(endless(), count)


# -- what duhem says --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Outcome:
    """One law's result: per claim ``right``, ``open`` or a sentence saying what is wrong."""

    trial: Trial
    claims: Mapping[str, str]
    seconds: float
    said: Mapping[str, str] = field(default_factory=dict)

    @property
    def wrong(self) -> dict[str, str]:
        """Claims answered against the truth, or refuted by a witness that does not hold."""
        return {c: text for c, text in self.claims.items() if text not in ("right", "open")}


def _compared(trial: Trial, found: Verification, claim: str) -> str:
    result, true = found[claim], trial.truth[claim]
    if result.verdict is Verdict.PROVED:
        return "right" if true else f"proved by {result.method} although false"
    if result.verdict is Verdict.REFUTED:
        assert result.witness is not None
        if true:
            holds = "holds here too: is the truth right?" if confirmed(trial.law, claim, result.witness) else "does not re-evaluate"
            return f"refuted by {result.method} although true; the witness {holds}"
        return "right" if confirmed(trial.law, claim, result.witness) else f"the witness of {result.method} does not re-evaluate"
    return "open"


def judge(trial: Trial) -> Outcome:
    """Verify the trial's law and compare every claim of known truth; re-evaluate every witness."""
    start = time.perf_counter()
    found = verify(trial.law, claims=trial.truth)
    seconds = time.perf_counter() - start
    said = {r.claim: f"{r.verdict.value} ({r.method})" for r in found.results}
    return Outcome(trial, {claim: _compared(trial, found, claim) for claim in trial.truth}, seconds, said)


def _table(outcomes: Sequence[Outcome]) -> str:
    head = f"{'family':18} {'laws':>5} {'claims':>7} {'right':>6} {'open':>5} {'open %':>7} {'wrong':>6} {'slowest s':>10} {'total s':>8}"
    lines = [head, "-" * len(head)]
    for family in [*FAMILIES, "all"]:
        mine = [o for o in outcomes if family in ("all", o.trial.family)]
        marks = [text for o in mine for text in o.claims.values()]
        right, left_open = marks.count("right"), marks.count("open")
        slowest, total = max((o.seconds for o in mine), default=0.0), sum(o.seconds for o in mine)
        share = 100 * left_open / len(marks) if marks else 0.0
        counts = f"{len(mine):5} {len(marks):7} {right:6} {left_open:5} {share:7.1f} {len(marks) - right - left_open:6}"
        lines.append(f"{family:18} {counts} {slowest:10.2f} {total:8.1f}")
    return "\n".join(lines)


def _open_by_claim(outcomes: Sequence[Outcome]) -> str:
    counts: dict[str, int] = {}
    for o in outcomes:
        for claim, text in o.claims.items():
            if text == "open":
                key = f"{o.trial.family}, {claim} {'true' if o.trial.truth[claim] else 'false'}, {o.trial.margin}"
                counts[key] = counts.get(key, 0) + 1
    return "\n".join(f"  {n:4} open: {key}" for key, n in sorted(counts.items(), key=lambda item: -item[1]))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign and print its table; 1 if anything is wrong."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--slow", type=float, default=10.0, help="name laws that take longer than this many seconds")
    asked = parser.parse_args(arguments)
    outcomes = []
    for trial in trials(asked.count, asked.seed):
        outcome = judge(trial)
        outcomes.append(outcome)
        for claim, text in outcome.wrong.items():
            print(f"WRONG {trial.law.name} {claim}: {text}\n      g = {trial.law.g}", flush=True)
        if outcome.seconds > asked.slow:
            print(f"slow  {trial.law.name}: {outcome.seconds:.1f} s, {dict(outcome.said)}\n      g = {trial.law.g}", flush=True)
    print(_table(outcomes))
    print(_open_by_claim(outcomes))
    return int(any(o.wrong for o in outcomes))


if __name__ == "__main__":
    sys.exit(main())
