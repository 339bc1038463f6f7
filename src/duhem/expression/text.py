"""A formula in the vocabulary of criterion files; :func:`duhem.expression.parse.parse_expression` reads it back as it was.

SymPy multiplies a number into a single sum: -(a + b)*c would be read as (-a - b)*c, and 1/(2*(a + b)) as 1/(2*a + 2*b).  So the
sign of such a product stands before brackets, and its divisors stand one by one.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import sympy as sp
from sympy.core.relational import Relational
from sympy.printing.str import StrPrinter

from duhem.errors import InputError
from duhem.expression.build import settled
from duhem.expression.number import MOST_DIGITS, reckoned
from duhem.expression.parse import parse_expression, parse_relation
from duhem.expression.vocabulary import Where, nested

__all__ = ["faithful", "formula"]


def formula(expr: sp.Basic) -> str:
    """``expr`` as text: ``norm(sigma_a/mu_a, sigma_b/mu_b) + sigma_n``."""
    return str(_Printer().doprint(reckoned(expr)))


@lru_cache(maxsize=512)
def faithful(expr: sp.Basic, known: tuple[sp.Symbol, ...]) -> str:
    """The text of a formula or comparison over the symbols ``known``, for whoever reads it instead of the expression.

    It is read back here: InputError where that would be another formula.  What cannot be read at all, as its length or a part
    without a value forbids it, no reader takes for another one.
    """
    text, names = formula(expr), {x.name: x for x in known}
    try:
        read = parse_relation(text, names) if isinstance(expr, Relational) else parse_expression(text, names)
        same = _sides(read) == _sides(expr)
    except InputError:
        same = True
    if not same:
        raise InputError(f"{text[:60]!r} is read as another formula than the expression it was made of", remedy="give the formula as text")
    return text


def _sides(expr: sp.Basic) -> tuple[Any, ...]:
    """What a formula is when it is built anew; of a comparison its sign and both sides."""
    return (expr.rel_op, settled(expr.lhs), settled(expr.rhs)) if isinstance(expr, Relational) else (settled(expr),)


class _Printer(StrPrinter):
    def _print_Add(self, expr: sp.Add, order: Any = None) -> str:
        first, *rest = self._as_ordered_terms(expr, order=order)
        text = self._print(first)
        for term in rest:
            part = self._product(term) if term.is_Mul else f"({self._print(term)})" if term.is_Add else self._print(term)
            text += f" - {part[1:]}" if part.startswith("-") else f" + {part}"
        return str(text)

    def _print_Mul(self, expr: sp.Mul) -> str:
        text = self._product(expr)
        return f"-({text[1:]})" if text.startswith("-(") and any(x.is_Add for x in expr.args) else text

    def _product(self, expr: sp.Mul) -> str:
        """The product with its sign, if it has one, for all of it."""
        number = expr.args[0]
        under = [x for x in expr.args if x.is_Pow and x.exp.as_coeff_Mul()[0] < 0]
        if not (number.is_Rational and number.q != 1 and len(under) == 1 and under[0].base.is_Add and under[0].exp == -1):
            return str(super()._print_Mul(expr))
        over = [x for x in expr.args if x is not under[0]]
        text = self._print(number) if len(over) == 1 else super()._print_Mul(sp.Mul(*over, evaluate=False))
        return f"{text}/({self._print(under[0].base)})"

    def _word(self, name: str, args: Any) -> str:
        return f"{name}({', '.join(self._print(a) for a in args)})"

    def _print_Function(self, expr: sp.Function) -> str:
        return self._word(type(expr).__name__.lower(), expr.args)

    def _print_Where(self, expr: Where) -> str:
        return self._word("where", expr.args) if expr.sign_of is None else self._word("sign", [expr.sign_of])

    def _print_LatticeOp(self, expr: sp.Basic) -> str:
        return nested(type(expr).__name__.lower(), [self._print(x) for x in sorted(expr.args, key=sp.default_sort_key)])

    def _print_Integer(self, x: sp.Integer) -> str:
        return _digits(x.p)

    def _print_Rational(self, x: sp.Rational) -> str:
        return f"{_digits(x.p)}/{_digits(x.q)}"

    def _print_Exp1(self, _: sp.Expr) -> str:
        return "exp(1)"


def _digits(n: int) -> str:
    """A whole number; one with more digits than are read at once as a sum of shorter ones: 0.1234567**64 is a quotient of two such."""
    if abs(n) < 10**MOST_DIGITS:
        return str(n)
    high, low = divmod(abs(n), 10**MOST_DIGITS)
    return f"{'-' if n < 0 else ''}({_digits(high)}*1e{MOST_DIGITS} + {low})"
