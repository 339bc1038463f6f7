"""What is <= 0 wherever a formula with kinks is: a maximum is <= 0 exactly where all of its arguments are."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from duhem.expression.vocabulary import KINKS, Neg, Pos

__all__ = ["smooth_below"]

_MOST = 32


def smooth_below(expr: sp.Expr) -> tuple[sp.Expr, ...]:
    """Formulas without a kink that are <= 0 wherever ``expr`` is; none where that is not seen, or they are too many.

    A kink that is added, times something positive, is replaced by each of what it is the greatest of.
    """
    found = tuple(dict.fromkeys(_smaller(expr)))
    return found if len(found) <= _MOST else ()


def _smaller(expr: sp.Expr) -> Iterator[sp.Expr]:
    if not expr.has(*KINKS):
        yield expr
        return
    for term in sp.Add.make_args(expr):
        if values := _values(term):
            for value in values:
                yield from _smaller(expr - term + value)
            return


def _values(term: sp.Expr) -> tuple[sp.Expr, ...]:
    """What a kink, times something positive, is the greatest of; none where the term is no such thing."""
    positive = [f for f in sp.Mul.make_args(term) if f.is_positive]
    rest = [f for f in sp.Mul.make_args(term) if not f.is_positive]
    if len(rest) != 1:
        return ()
    kink, factor = rest[0], sp.Mul(*positive)
    if isinstance(kink, sp.Abs):
        return factor * kink.args[0], -factor * kink.args[0]
    if isinstance(kink, Pos | Neg):
        return kink.slope * factor * kink.args[0], sp.S.Zero
    return tuple(factor * value for value in kink.args) if isinstance(kink, sp.Max) else ()
