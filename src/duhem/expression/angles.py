"""Angles written with atan, as algebra: cos(k atan(q/p)) = Re (p + i q)^k / (p^2 + q^2)^(k/2), and sin with Im.

The right-hand side is the continuous extension of the left across p = 0 for even k, which is how a formula in the
polar angle is meant.  With q/p = b/(|(a, b)| + a), the tangent of half the polar angle, it is Re (a + i b)^(k/2) / |(a, b)|^(k/2).
"""

from __future__ import annotations

import sympy as sp

from duhem.expression import Norm

__all__ = ["algebraic_angles"]


def algebraic_angles(expr: sp.Expr) -> sp.Expr:
    """``expr`` with every cos(k atan(u)) and sin(k atan(u)), k an even integer, as a quotient of polynomials and norms."""
    swap = {}
    for node in expr.atoms(sp.cos, sp.sin):
        k, rest = node.args[0].as_coeff_Mul()
        if isinstance(rest, sp.atan) and k.is_Integer and k % 2 == 0:
            swap[node] = _wave(int(k), rest.args[0], sp.re if isinstance(node, sp.cos) else sp.im)
    return expr.xreplace(swap) if swap else expr


def _wave(k: int, ratio: sp.Expr, part: type) -> sp.Expr:
    q, p = sp.fraction(sp.together(ratio))
    for norm in p.atoms(Norm):
        a = p - norm
        if sp.expand(norm.rewrite(sp.Pow) ** 2 - a**2 - q**2) == 0:  # tan of half the angle of (a, q)
            return part(sp.expand((a + sp.I * q) ** (k // 2))) / norm ** (k // 2)
    return part(sp.expand((p + sp.I * q) ** k)) / (p**2 + q**2) ** sp.Rational(k, 2)
