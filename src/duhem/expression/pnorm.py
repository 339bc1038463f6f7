"""Norms that SymPy spells as powers, recognised: sqrt(x**2 + y**2), (|x|**p + |y|**p)**(1/p), and |x|**3 as x**2*|x|.

Back ends that must treat a norm as one thing (to keep its powers from overflowing, to see its convexity) fold over
the recognised formula; it has the same value wherever the original has one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy as sp

from duhem.expression.vocabulary import Norm

__all__ = ["PNorm", "recognised"]


class PNorm(sp.Function):
    """``PNorm(p, x, ...)`` = (|x|^p + ...)^(1/p), p > 0; no word of the language, only a node of recognised formulas."""

    is_extended_nonnegative = True

    def _sympystr(self, printer: Any) -> str:
        p, *args = self.args
        return str(printer.doprint(sp.Add(*(sp.Abs(a) ** p for a in args)) ** (1 / p)))


def recognised(expr: sp.Basic) -> sp.Basic:
    """The formula with its norms written as ``Norm`` and ``PNorm``, innermost first."""
    return _throughout(_throughout(expr, sp.Mul, _odd_power), sp.Pow, _norm)


def _throughout(expr: Any, kind: type[sp.Expr], rewrite: Callable[[Any], sp.Expr]) -> Any:
    """The formula with every node of a kind rewritten.  Max and Min are not evaluated anew: SymPy refuses what it cannot compare."""
    args = tuple(_throughout(a, kind, rewrite) for a in expr.args)
    if args != expr.args:
        expr = expr.func(*args, **({"evaluate": False} if isinstance(expr, sp.Max | sp.Min) else {}))
    return rewrite(expr) if isinstance(expr, kind) else expr


def _odd_power(product: sp.Mul) -> sp.Expr:
    factors = product.args
    for size in factors:
        for even in factors:
            if isinstance(size, sp.Abs) and even.is_Pow and even.base == size.args[0] and even.exp.is_even:
                return sp.Mul(PNorm(1, even.base) ** (even.exp + 1), *(f for f in factors if f is not size and f is not even))
    return product


def _norm(node: Any) -> sp.Expr:
    if not node.base.is_Add:
        return node
    p = 1 / node.exp
    bases = [_base(term, p) for term in node.base.args]
    if p == 1 or not p.is_positive or any(x is None for x in bases):
        return node
    return Norm(*bases) if p == 2 else PNorm(p, *bases)


def _base(term: sp.Expr, p: sp.Expr) -> sp.Expr | None:
    """x with |x|^p = term, if the term is a positive number times powers p and -p."""
    number, rest = term.as_independent(*term.free_symbols, as_Add=False)
    if not number.is_positive:
        return None
    x = number ** (1 / p)
    for factor in sp.Mul.make_args(rest):
        if factor == 1:
            continue
        base, exponent = factor.as_base_exp()
        times = exponent / p
        if times not in (1, -1) or not (p.is_even or base.is_extended_nonnegative):
            return None
        x *= base**times
    return x
