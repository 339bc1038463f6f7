"""A formula in the vocabulary of criterion files; :func:`duhem.expression.parse.parse_expression` reads it back."""

from __future__ import annotations

from typing import Any

import sympy as sp
from sympy.printing.str import StrPrinter

from duhem.expression.inert_number import reckoned
from duhem.expression.vocabulary import Where

__all__ = ["formula"]


def formula(expr: sp.Basic) -> str:
    """``expr`` as text: ``norm(sigma_a/mu_a, sigma_b/mu_b) + sigma_n``."""
    return str(_Printer().doprint(reckoned(expr)))


class _Printer(StrPrinter):
    def _word(self, name: str, args: Any) -> str:
        return f"{name}({', '.join(self._print(a) for a in args)})"

    def _print_Function(self, expr: sp.Function) -> str:
        return self._word(type(expr).__name__.lower(), expr.args)

    def _print_Where(self, expr: Where) -> str:
        return self._word("where", expr.args) if expr.sign_of is None else self._word("sign", [expr.sign_of])

    def _print_LatticeOp(self, expr: sp.Basic) -> str:
        return self._word(type(expr).__name__.lower(), sorted(expr.args, key=sp.default_sort_key))

    def _print_Exp1(self, _: sp.Expr) -> str:
        return "exp(1)"
