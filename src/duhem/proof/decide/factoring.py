"""Factors of a polynomial over the rationals, by FLINT: SymPy's own search for them is by chance, and now and then takes minutes.

Rational coefficients, since python-flint 0.9 takes whole ones for C integers when it sorts factors.
"""

from __future__ import annotations

import sympy as sp

__all__ = ["factor_list"]


def factor_list(poly: sp.Expr) -> tuple[sp.Rational, list[tuple[sp.Expr, int]]]:
    """A number and the irreducible factors with their powers, with the signs that ``sympy.factor_list`` gives them."""
    import flint

    form = sp.Poly(poly)
    if not (form.domain.is_ZZ or form.domain.is_QQ):
        number, found = sp.factor_list(poly)
        return number, found
    ring = flint.fmpq_mpoly_ctx.get([f"x{i}" for i in range(len(form.gens))], "lex")
    number, parts = ring.from_dict({m: flint.fmpq(c.p, c.q) for m, c in form.terms()}).factor()
    factors = [(sp.Poly({m: sp.Rational(int(c.p), int(c.q)) for m, c in f.to_dict().items()}, *form.gens), int(n)) for f, n in parts]
    factors.sort(key=lambda factor: (len(factor[0].rep.to_list()), factor[1], factor[0].rep.to_list()))
    return sp.Rational(int(number.p), int(number.q)), [(part.as_expr(), power) for part, power in factors]
