"""Changes of units: which weights of forces and parameters leave the sign of g unchanged (Buckingham 1914).

A weight w scales each symbol x to t^(w_x) x.  Every sum, maximum, norm or comparison needs equal weights on its parts;
functions and symbolic exponents need weight 0.  The admissible weights are the null space of these linear conditions.

``ROLES`` says what units mean to each word.  Two walks read it: the one here leaves every weight open and collects the
conditions (:mod:`duhem.law.law_sheet` solves them for the units of parameters), :mod:`duhem.projection.scaled_formula` knows that
forces weigh 1 and rebuilds the formula as it goes; what else they do with a role is their own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal

import sympy as sp

from duhem.errors import InputError
from duhem.expression.elementary import ELEMENTARY
from duhem.expression.fold import Table, fold
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where

__all__ = ["ROLES", "Conditions", "Weight", "combined", "degree", "removable", "weighing"]

Weight = dict[sp.Symbol, sp.Rational]
Role = Literal["alike", "kept", "pure", "angle", "placed", "compared", "chosen", "product", "power"]

# alike: parts of one unit, which is the result's; kept: the result has the unit of its one part; pure: numbers to numbers;
# angle: parts of one unit, a number; placed: parts of one unit, each in its place, which is the result's;
# compared: parts of one unit, a truth value;
# chosen: a condition and two of one unit, which is the result's.
ROLES: Mapping[type, Role] = {
    **dict.fromkeys((sp.Add, sp.Max, sp.Min, Norm), "alike"),
    **dict.fromkeys((sp.Abs, Pos, Neg), "kept"),
    **dict.fromkeys((word.node for word in ELEMENTARY.values()), "pure"),
    Atan2: "angle",
    EigMax: "placed",
    **dict.fromkeys(COMPARISONS, "compared"),
    Where: "chosen",
    sp.Mul: "product",
    sp.Pow: "power",
}


def weighing(rows: Mapping[Role, Callable[..., Any]]) -> Table[Any]:
    """A table with the row of its role for every word."""
    return {kind: rows[role] for kind, role in ROLES.items()}


class Conditions:
    """Collects the linear conditions while a tree is weighed; a weight of None is that of 0, which fits every sum."""

    def __init__(self) -> None:
        self.rows: list[Weight] = []
        alike: dict[Role, Callable[..., Any]] = dict.fromkeys(("alike", "kept", "placed", "compared"), self._equal)
        others: dict[Role, Callable[..., Any]] = {"pure": self.pure, "angle": self._angle, "product": self._product, "power": self.power}
        self._table = weighing(alike | others | {"chosen": lambda node, _, a, b: self._equal(node, a, b)})

    def weigh(self, expr: sp.Basic) -> Weight | None:
        """The weight of a formula; what must vanish so that it has one is added to the ``rows``."""
        return fold(expr, self._table, lambda node: None if node.is_zero else {node: sp.S.One} if node.is_Symbol else {})

    def _equal(self, _: sp.Basic, *parts: Weight | None) -> Weight | None:
        real = [p for p in parts if p is not None]
        for part in real[1:]:
            self.rows.append(combined([(sp.S.One, real[0]), (sp.S.NegativeOne, part)]))
        return real[0] if real else None

    def pure(self, _: sp.Basic, part: Weight | None) -> Weight:
        """No weight, for what takes a pure number."""
        if part is not None:
            self.rows.append(part)
        return {}

    def _angle(self, node: sp.Basic, *parts: Weight | None) -> Weight:
        self._equal(node, *parts)
        return {}

    def _product(self, _: sp.Basic, *parts: Weight | None) -> Weight | None:
        real = [(sp.S.One, p) for p in parts if p is not None]
        return combined(real) if len(real) == len(parts) else None

    def power(self, node: Any, base: Weight | None, exponent: Weight | None) -> Weight | None:
        """A power whose exponent is no rational number is one of a pure number."""
        if base is None:
            return None
        if node.exp.is_Rational:
            return combined([(node.exp, base)])
        self.pure(node, exponent)
        return self.pure(node, base)


def combined(parts: Iterable[tuple[sp.Expr, Weight]]) -> Weight:
    """The sum of weights times factors."""
    total: Weight = {}
    for factor, part in parts:
        for x, w in part.items():
            total[x] = total.get(x, sp.S.Zero) + factor * w
    return {x: w for x, w in total.items() if w != 0}


def removable(expressions: Iterable[sp.Expr], relations: Iterable[sp.Basic], candidates: Sequence[sp.Symbol]) -> list[sp.Symbol]:
    """Candidates (positive, else unconstrained) that a change of units can set to 1 together, first come first served."""
    conditions = Conditions()
    try:
        for expr in [*expressions, *relations]:
            conditions.weigh(expr)
    except InputError:
        return []
    symbols = sorted(set().union(*(r.keys() for r in conditions.rows), candidates, *(e.free_symbols for e in expressions)), key=str)
    if not symbols:
        return []
    matrix = sp.Matrix([[row.get(x, 0) for x in symbols] for row in conditions.rows] or [[0] * len(symbols)])
    changes = sp.Matrix([[v[symbols.index(x)] for x in candidates] for v in matrix.nullspace()])
    return [candidates[i] for i in changes.rref()[1]]  # whose columns are independent of those before


def degree(expr: sp.Expr, forces: Sequence[sp.Symbol]) -> sp.Rational | None:
    """Degree of positive homogeneity in the forces jointly; None where there is none to see."""
    conditions = Conditions()
    try:
        weight = conditions.weigh(expr)
    except InputError:
        return None
    ones = set(forces)

    def total(w: Weight) -> sp.Rational:
        return sp.Add(*(c for x, c in w.items() if x in ones))

    if weight is None or any(total(row) != 0 for row in conditions.rows):
        return None
    return total(weight)
