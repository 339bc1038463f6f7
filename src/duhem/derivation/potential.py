"""A support function in closed form as a value, with what it rests on."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

__all__ = ["SupportFunction"]


@dataclass(frozen=True)
class SupportFunction:
    """The potential and what it rests on.

    ``potential`` is finite exactly where every expression of ``domain`` (linear in ``rates``) vanishes.  ``gauge``, taken
    about ``centre`` and divided by ``radius``, describes K = {gauge <= 1}.  ``maximiser`` is the stress that attains
    the supremum, for d != 0.  ``steps`` are the theorems used, in order.  All of it holds where every expression of
    ``requires`` is positive.
    """

    potential: sp.Expr
    rates: tuple[sp.Symbol, ...]
    domain: tuple[sp.Expr, ...]
    steps: tuple[str, ...]
    maximiser: tuple[sp.Expr, ...] | None
    requires: tuple[sp.Expr, ...]
    gauge: sp.Expr
    centre: tuple[sp.Expr, ...]
    radius: sp.Expr
