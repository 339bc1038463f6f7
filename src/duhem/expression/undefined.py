"""What a root of -1, a logarithm of 0 or a quotient by 0 becomes in SymPy where values are put in: no real number."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp
from sympy.core.relational import Relational

__all__ = ["UNDEFINED", "defined_at", "holds_at"]

UNDEFINED = (sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I)


def defined_at(expr: sp.Expr, place: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr | None:
    """The expression with values, or other expressions, put in; None where part of it has no value there."""
    try:
        value = expr.xreplace(place)
    except (ValueError, TypeError):  # SymPy compares something with nan
        return None
    return None if value.has(*UNDEFINED) else value


def holds_at(relation: sp.Basic, place: Mapping[sp.Symbol, sp.Expr]) -> bool:
    """Whether a relation holds with values put in; it does not hold where a part of it has no value."""
    try:
        found = relation.subs(place)
        return (found.func(*found.args) if isinstance(found, Relational) else found) in (sp.true, True)  # 1 <= 1 may be kept as it stands
    except (ValueError, TypeError):  # SymPy compares nothing with what is no real number
        return False
