"""Level sets of quartic forms, alone and with a quadratic one."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from fractions import Fraction

import sympy as sp

from duhem import POSITIVE
from tests.campaigns.families.trial import PRESSURE, Trial, matrix, near, star, written
from tests.oracles.level_curve import DEGREES, curvature_form, on_line, sign_on_boundary
from tests.oracles.real_line import T, nonnegative_on_the_line, poly, positive_form, samples

__all__ = ["even_quartic", "quartic"]

F = Fraction


def _form_text(p: Mapping[int, Fraction], degree: int) -> str:
    """sum p_k sigma_a^(degree - k) sigma_b^k."""
    return " + ".join(f"{written(c)}*sigma_a**{degree - k}*sigma_b**{k}" for k, c in p.items() if c) or "0"


def _form(p: sp.Expr, degree: int, m: Sequence[Fraction]) -> tuple[dict[int, Fraction], sp.Expr]:
    """The form p(x, y) after the linear map m: its coefficients, and P in x, y."""
    x, y = sp.symbols("x y", real=True)
    a, b, c, d = (sp.Rational(v.numerator, v.denominator) for v in m)
    moved = sp.Poly(sp.expand(p.subs({x: a * x + b * y, y: c * x + d * y}, simultaneous=True)), x, y)
    return {k: F(int(v.p), int(v.q)) for k in range(degree + 1) if (v := moved.coeff_monomial(x ** (degree - k) * y**k))}, moved.as_expr()


def quartic(rng: random.Random, name: str) -> Trial:
    """P <= (mu N)^4 with P a positive definite quartic form: convex if and only if its curvature form, of degree 8, is >= 0."""
    x, y = sp.symbols("x y", real=True)
    while True:
        margin, p = "generic", sp.S.Zero
        if rng.random() < 0.5:
            edge, (factor, margin) = rng.choice([F(6), F(6), F(0)]), near(rng)
            c = edge * factor if edge else factor - 1
            p = x**4 + sp.Rational(c.numerator, c.denominator) * x**2 * y**2 + y**4
        else:
            u, v = (sum(sp.Rational(rng.randint(-6, 6), rng.randint(1, 3)) * z for z in (x**2, x * y, y**2)) for _ in range(2))
            p = sp.expand(u**2 + v**2 + rng.randint(0, 6) * (x**2 + y**2) ** 2)
        coefficients, moved = _form(p, 4, matrix(rng))
        line = on_line(moved)
        if positive_form(line, 4):
            break
    convex = nonnegative_on_the_line(on_line(curvature_form(moved, moved)))
    size = rng.choice(["(mu*abs(sigma_n))", "abs(sigma_n)", "(3/7*abs(sigma_n))"])
    g = f"{_form_text(coefficients, 4)} - {size}**4"
    return star("quartic form", name, g, convex, margin, {"mu": POSITIVE} if "mu" in size else None)


def even_quartic(rng: random.Random, name: str) -> Trial:
    """P + Q N^2 <= N^4 with P a positive definite quartic form and Q a quadratic one.

    On the ray (1, t) the boundary lies at u = x^2, the one positive root of P(1, t) u^2 + Q(1, t) u = 1.  Its curvature
    there has the sign of k8 u^3 + k6 u^2 + k4 u + k2, which can only change at real zeros of the resultant: one exact
    sample a cell.
    """
    x, y, u = sp.symbols("x y u", real=True)
    while True:
        m = matrix(rng)
        c = F(rng.randint(-6, 30), 4)
        p4, four = _form(x**4 + sp.Rational(c.numerator, c.denominator) * x**2 * y**2 + y**4, 4, m)
        rows = [sp.Rational(rng.randint(-8, 8), rng.randint(1, 3)) for _ in range(3)]
        p2, two = _form(rows[0] * x**2 + rows[1] * x * y + rows[2] * y**2, 2, (F(1), F(0), F(0), F(1)))
        if not p2 or not positive_form(on_line(four), 4):
            continue
        level = sp.Poly(on_line(four).as_expr() * u**2 + on_line(two).as_expr() * u - 1, u, T)
        whole = sp.Poly(curvature_form(four + two, four + two), x, y)
        by_degree = {d: on_line(sum(k * x**i * y**j for (i, j), k in whole.terms() if i + j == d)) for d in DEGREES}
        bend = sp.Poly(sum(by_degree[d].as_expr() * u ** ((d - 2) // 2) for d in DEGREES), u, T)
        between = poly(level.resultant(bend).as_expr())
        if not between.is_zero:
            break
    convex = all(sign_on_boundary(on_line(four), on_line(two), by_degree, sample) >= 0 for sample in samples(between))
    g = f"{_form_text(p4, 4)} + ({_form_text(p2, 2)})*{PRESSURE}**2 - {PRESSURE}**4"
    return star("even quartic", name, g, convex, "generic")
