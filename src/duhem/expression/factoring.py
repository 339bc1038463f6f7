"""Factors of a polynomial over the rationals, by FLINT: SymPy's own search for them is by chance, and now and then takes minutes.

Rational coefficients, since python-flint 0.9 takes whole ones for C integers when it sorts factors.
"""

from __future__ import annotations

import sympy as sp

__all__ = ["factor_list", "factored"]


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


def factored(expr: sp.Expr) -> sp.Expr:
    """The expression as a product, quotients put together, where it is a quotient of polynomials in symbols > 0 and roots of them."""
    powers = [p for p in expr.atoms(sp.Pow) if p.base.is_Symbol and p.base.is_positive and p.exp.is_Rational]
    roots = {s: sp.Dummy(s.name, positive=True) for p in powers if (s := p.base)}
    share = {s: sp.ilcm(*(p.exp.q for p in powers if p.base == s), 1) for s in roots}
    whole = {p: roots[p.base] ** (p.exp * share[p.base]) for p in powers} | {s: root ** share[s] for s, root in roots.items()}
    above, below = sp.fraction(sp.together(expr.xreplace(whole)))
    if not (above.is_polynomial(*above.free_symbols) and below.is_polynomial(*below.free_symbols)) or above.is_zero:
        return sp.factor(expr)
    scale, found = sp.S.One, list[sp.Expr]()
    for part, sign in ((above, 1), (below, -1)):
        number, factors = (part, []) if part.is_number else factor_list(sp.expand(part))
        scale *= number**sign
        found += [factor ** (sign * power) for factor, power in factors]
    product = sp.Mul(*found).xreplace({root: s ** sp.Rational(1, share[s]) for s, root in roots.items()})
    return sp.Mul(scale, product, evaluate=False) if scale != 1 and product.is_Add else scale * product
