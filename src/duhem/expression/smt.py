"""Formulas as z3 terms over the reals: polynomials, quotients, kinks and comparisons.

A quotient is z3's, where x/0 is some number: whoever wants more from a proof states that what divides is not 0.
z3 is imported when the first symbols are named.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce
from operator import mul
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression.elementary import ELEMENTARY
from duhem.expression.fold import Table, fold
from duhem.expression.number import ratio
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where

__all__ = ["LEFT_OUT", "TABLE", "Reals"]


class Reals:
    """Symbols as real constants in a z3 context of their own."""

    def __init__(self, symbols: Iterable[sp.Symbol]) -> None:
        import z3

        self.context = z3.Context()
        self._names = {x: z3.Real(f"x{i}", ctx=self.context) for i, x in enumerate(symbols)}

    def term(self, expr: sp.Basic) -> Any:
        """The formula as a term, a comparison as a proposition; InputError for what real arithmetic does not know."""
        return fold(expr, TABLE, self._leaf)

    def point(self, model: Any) -> dict[sp.Symbol, sp.Rational]:
        """A model's values as rationals; algebraic numbers are approximated to thirty digits."""
        import z3

        point = {}
        for symbol, name in self._names.items():
            value = model.eval(name, model_completion=True)
            if z3.is_algebraic_value(value):
                value = value.approx(30)
            point[symbol] = sp.Rational(value.numerator_as_long(), value.denominator_as_long())
        return point

    def _leaf(self, node: Any) -> Any:
        import z3

        if node in self._names:
            return self._names[node]
        if node in (sp.true, sp.false):
            return z3.BoolVal(bool(node), ctx=self.context)
        if node.is_Rational:
            return z3.RealVal(ratio(node), ctx=self.context)
        raise InputError(f"{node} is outside real arithmetic")


def _sum(_: Any, *terms: Any) -> Any:
    import z3

    return z3.Sum(*terms)


def _power(node: sp.Pow, base: Any, _: Any) -> Any:
    if not node.exp.is_Integer:
        raise InputError(f"{node} is outside real arithmetic")
    raised = reduce(mul, [base] * abs(int(node.exp)))
    return raised if node.exp > 0 else 1 / raised


def _either(condition: Any, a: Any, b: Any) -> Any:
    import z3

    return z3.If(condition, a, b)


TABLE: Table[Any] = {
    sp.Add: _sum,
    sp.Mul: lambda _, *x: reduce(mul, x),
    sp.Pow: _power,
    sp.Abs: lambda _, x: _either(x >= 0, x, -x),
    sp.Min: lambda _, *x: reduce(lambda a, b: _either(b < a, b, a), x),
    sp.Max: lambda _, *x: reduce(lambda a, b: _either(b > a, b, a), x),
    Pos: lambda _, x: _either(x >= 0, x, 0),
    Neg: lambda _, x: _either(x <= 0, -x, 0),
    **{kind: lambda _, a, b, holds=holds: holds(a, b) for kind, holds in COMPARISONS.items()},
}

# Words without a row, and why.
LEFT_OUT: dict[type, str] = dict.fromkeys((Atan2, *(word.node for word in ELEMENTARY.values())), "not algebraic") | {
    EigMax: "a root of a cubic: no polynomial condition names the greatest",
    Norm: "a root: whoever asks names it and gives its defining equation",
    Where: "whoever asks opens its cases first",
}
