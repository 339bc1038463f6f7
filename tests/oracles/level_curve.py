"""Curvature of the level curves of forms in two variables, exactly: from the form to polynomials on the real line."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from tests.oracles.real_line import T, poly

__all__ = ["DEGREES", "curvature_form", "on_line", "sign_on_boundary"]


DEGREES = (8, 6, 4, 2)


def curvature_form(p: sp.Expr, q: sp.Expr) -> sp.Expr:
    """P_xx Q_y R_y - ... with all three the same: the second derivative of P along its level curve, times |grad Q|^2."""
    x, y = sp.symbols("x y", real=True)
    qx, qy = q.diff(x), q.diff(y)
    return sp.expand(p.diff(x, 2) * qy**2 - 2 * p.diff(x, y) * qx * qy + p.diff(y, 2) * qx**2)


def on_line(p: sp.Expr) -> sp.Poly:
    """p(1, t) of p(x, y)."""
    x, y = sp.symbols("x y", real=True)
    return poly(sp.expand(p.subs({x: 1, y: T}, simultaneous=True)))


def sign_on_boundary(p: sp.Poly, q: sp.Poly, bend: Mapping[int, sp.Poly], t: sp.Rational) -> int:
    """Exact sign of k8 u^3 + k6 u^2 + k4 u + k2 at u = (-q + sqrt(q^2 + 4 p))/(2 p), as alpha + beta sqrt(...) by Horner."""
    a, b = p.eval(t), q.eval(t)
    radicand = b**2 + 4 * a
    real, root = -b / (2 * a), 1 / (2 * a)
    alpha, beta = sp.S.Zero, sp.S.Zero
    for d in DEGREES:
        alpha, beta = alpha * real + beta * root * radicand + bend[d].eval(t), alpha * root + beta * real
    return _sign_with_root(alpha, beta, radicand)


def _sign_with_root(alpha: sp.Rational, beta: sp.Rational, radicand: sp.Rational) -> int:
    """Exact sign of alpha + beta sqrt(radicand), radicand > 0."""
    if alpha * beta >= 0:
        return int(sp.sign(alpha + beta))
    return int(sp.sign(alpha) * sp.sign(alpha**2 - beta**2 * radicand))
