"""Angles as algebra: cos(k atan2(q, p)) = Re (p + i q)^k / |(p, q)|^k, and sin with Im; what is left of atan2 in its cases.

With atan(q/p) in place of atan2(q, p) the right-hand side is the continuous extension of the left across p = 0 for even k, which
is how a formula in the polar angle is meant.  With q/p = b/(|(a, b)| + a), the tangent of half the polar angle, it is
Re (a + i b)^(k/2) / |(a, b)|^(k/2).
"""

from __future__ import annotations

import sympy as sp

from duhem.expression import Atan2, Norm

__all__ = ["algebraic_angles"]

_MOST_TURNS = 32
_Wave = tuple[sp.Expr, sp.Expr]  # cosine and sine


def algebraic_angles(expr: sp.Expr) -> sp.Expr:
    """``expr`` with the waves of whole multiples of an angle as quotients of polynomials and norms.

    Of atan(u) even multiples only, and by themselves; of atan2 all, with a phase too.  Any other atan2 is opened.
    """
    if not expr.has(sp.atan, Atan2):
        return expr
    swap = {node: wave for node in expr.atoms(sp.cos, sp.sin) if (wave := _algebra(node)) is not None}
    found = expr.xreplace(swap)
    return found.replace(Atan2, lambda y, x: Atan2(y, x).opened()) if found.has(Atan2) else found


def _algebra(node: sp.Expr) -> sp.Expr | None:
    terms = sp.Add.make_args(sp.expand_mul(node.args[0]))
    turns = {term: wave for term in terms if (wave := _wave(term, alone=len(terms) == 1)) is not None}
    if len(turns) != 1:
        return None
    ((turn, (c, s)),) = turns.items()
    phase = sp.Add(*(term for term in terms if term != turn))
    if isinstance(node, sp.cos):
        return c * sp.cos(phase) - s * sp.sin(phase)
    return s * sp.cos(phase) + c * sp.sin(phase)


def _wave(term: sp.Expr, alone: bool) -> _Wave | None:
    k, rest = term.as_coeff_Mul()
    if not k.is_Integer or abs(k) > _MOST_TURNS:
        return None
    if isinstance(rest, Atan2):
        q, p = rest.args
        return _power(p, q, int(k), sp.sqrt(p**2 + q**2))
    if isinstance(rest, sp.atan) and k % 2 == 0 and alone:
        q, p = sp.fraction(sp.together(rest.args[0]))
        for norm in p.atoms(Norm):
            a = p - norm
            if sp.expand(norm.rewrite(sp.Pow) ** 2 - a**2 - q**2) == 0:  # tan of half the angle of (a, q)
                return _power(a, q, int(k) // 2, norm)
        return _power(p, q, int(k), sp.sqrt(p**2 + q**2))
    return None


def _power(p: sp.Expr, q: sp.Expr, k: int, size: sp.Expr) -> _Wave:
    """Cosine and sine of k times the angle of (p, q), whose norm is ``size``."""
    turned, sense = sp.expand((p + sp.I * q) ** abs(k)), 1 if k >= 0 else -1
    return sp.re(turned) / size ** abs(k), sense * sp.im(turned) / size ** abs(k)
