"""Values in double precision, with Python's own arithmetic: quick, and enough to tell what is too large or not real."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression.elementary import ELEMENTARY
from duhem.expression.fold import Table, fold
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where, deviator

__all__ = ["TABLE", "approximate", "value_at"]


def approximate(expr: sp.Expr) -> float:
    """The value of a constant in double precision; InputError if it is not real and finite."""
    try:
        value = value_at(expr, {})
    except (OverflowError, ValueError, ZeroDivisionError, TypeError):
        value = math.nan
    if isinstance(value, complex) or not math.isfinite(value):
        raise InputError("the value is not real and finite, or too large", remedy="keep every part of the formula real and finite")
    return float(value)


def value_at(expr: sp.Expr, point: Mapping[sp.Symbol, float]) -> float:
    """The value where the symbols have those of ``point``; what Python raises where there is none."""

    def leaf(node: Any) -> float:
        return point[node] if node in point else float(node)

    return fold(expr, TABLE, leaf)


def _power(_: sp.Basic, base: float, exponent: float) -> float:
    result = base**exponent
    if isinstance(result, complex):
        raise ValueError("not real")
    return result


def _atan2(_: sp.Basic, y: float, x: float) -> float:
    if x == 0 == y:
        raise ValueError("no angle")
    return math.atan2(y + 0.0, x)  # -0 is 0


def _eigmax(_: sp.Basic, *entries: float) -> float:
    mean, second, third = deviator(*entries)
    turn = 1.5 * math.sqrt(3) * third / second**1.5 if second else 0.0
    return mean + 2 * math.sqrt(second / 3) * math.cos(math.acos(min(max(turn, -1.0), 1.0)) / 3)


TABLE: Table[float] = {
    sp.Add: lambda _, *a: math.fsum(a),
    sp.Mul: lambda _, *a: math.prod(a),
    sp.Pow: _power,
    sp.Abs: lambda _, a: abs(a),
    **{word.node: lambda _, a, name=name: getattr(math, name)(a) for name, word in ELEMENTARY.items()},
    Atan2: _atan2,
    sp.Min: lambda _, *a: min(a),
    sp.Max: lambda _, *a: max(a),
    Pos: lambda _, a: max(a, 0.0),
    Neg: lambda _, a: max(-a, 0.0),
    Norm: lambda _, *a: math.hypot(*a),
    EigMax: _eigmax,
    Where: lambda _, condition, a, b: a if condition else b,
    **{kind: lambda _, a, b, holds=holds: float(holds(a, b)) for kind, holds in COMPARISONS.items()},
}
