"""Changes of units: which weights of forces and parameters leave the sign of g unchanged (Buckingham 1914).

A weight w scales each symbol x to t^(w_x) x.  Every sum, maximum, norm or comparison needs equal weights on its parts;
functions and symbolic exponents need weight 0.  The admissible weights are the null space of these linear conditions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression import Neg, Norm, Pos, Where, fold

__all__ = ["degree", "removable"]

Weight = dict[sp.Symbol, sp.Rational]


@dataclass(frozen=True)
class _Any:
    """The weight of 0, which fits every sum."""


class _Conditions:
    """Collects the linear conditions while a tree is weighed."""

    def __init__(self) -> None:
        self.rows: list[Weight] = []

    def equal(self, parts: Sequence[Any]) -> Any:
        real = [p for p in parts if not isinstance(p, _Any)]
        for part in real[1:]:
            self.rows.append(_combine([(sp.S.One, real[0]), (sp.S.NegativeOne, part)]))
        return real[0] if real else _Any()

    def none(self, part: Any) -> Weight:
        if not isinstance(part, _Any):
            self.rows.append(part)
        return {}

    def weigh(self, expr: sp.Basic) -> Any:
        def same(node: sp.Basic, *parts: Any) -> Any:
            return self.equal(parts)

        def mul(node: sp.Basic, *parts: Any) -> Any:
            return _Any() if any(isinstance(p, _Any) for p in parts) else _combine([(sp.S.One, p) for p in parts])

        def power(node: Any, base: Any, exponent: Any) -> Any:
            if isinstance(base, _Any):
                return base
            if node.exp.is_Rational:
                return _combine([(node.exp, base)])
            self.none(exponent)
            return self.none(base)

        def function(node: sp.Basic, part: Any) -> Any:
            return self.none(part)

        def where(node: sp.Basic, condition: Any, a: Any, b: Any) -> Any:
            return self.equal((a, b))

        def leaf(node: Any) -> Any:
            return _Any() if node.is_zero else {node: sp.S.One} if node.is_Symbol else {}

        functions = (sp.exp, sp.log, sp.sin, sp.cos, sp.tan, sp.tanh, sp.atan)
        alike = (sp.Add, sp.Max, sp.Min, Norm, sp.Abs, Pos, Neg, sp.GreaterThan, sp.StrictGreaterThan, sp.LessThan, sp.StrictLessThan)
        table: dict[type, Callable[..., Any]] = {f: function for f in functions} | {f: same for f in alike}
        table |= {sp.Mul: mul, sp.Pow: power, Where: where}
        return fold(expr, table, leaf)


def _combine(parts: Iterable[tuple[sp.Expr, Weight]]) -> Weight:
    total: Weight = {}
    for factor, part in parts:
        for x, w in part.items():
            total[x] = total.get(x, sp.S.Zero) + factor * w
    return {x: w for x, w in total.items() if w != 0}


def removable(expressions: Iterable[sp.Expr], relations: Iterable[sp.Basic], candidates: Sequence[sp.Symbol]) -> list[sp.Symbol]:
    """Candidates (positive, else unconstrained) that a change of units can set to 1 together, first come first served."""
    conditions = _Conditions()
    try:
        for expr in [*expressions, *relations]:
            conditions.weigh(expr)
    except InputError:
        return []
    symbols = sorted(set().union(*(r.keys() for r in conditions.rows), candidates, *(e.free_symbols for e in expressions)), key=str)
    if not symbols:
        return []
    matrix = sp.Matrix([[row.get(x, 0) for x in symbols] for row in conditions.rows] or [[0] * len(symbols)])
    basis = [list(v) for v in matrix.nullspace()]
    chosen: list[sp.Symbol] = []
    columns: list[list[Any]] = []
    for x in candidates:
        column = [v[symbols.index(x)] for v in basis]
        if sp.Matrix([*columns, column]).rank() == len(columns) + 1:
            chosen.append(x)
            columns.append(column)
    return chosen


def degree(expr: sp.Expr, forces: Sequence[sp.Symbol]) -> sp.Rational | None:
    """Degree of positive homogeneity in the forces jointly; None where there is none to see."""
    conditions = _Conditions()
    try:
        weight = conditions.weigh(expr)
    except InputError:
        return None
    ones = set(forces)

    def total(w: Weight) -> sp.Rational:
        return sp.Add(*(c for x, c in w.items() if x in ones))

    if isinstance(weight, _Any) or any(total(row) != 0 for row in conditions.rows):
        return None
    return total(weight)
