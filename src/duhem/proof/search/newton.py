"""Common zeros of two formulas in a plane, to many digits."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression import fold, mpmath_

__all__ = ["common_zero"]


def common_zero(
    system: Sequence[sp.Expr], slopes: Sequence[sp.Expr], unknowns: Sequence[sp.Symbol], start: Sequence[float], digits: int
) -> tuple[Fraction, ...] | None:
    """The zero that Newton's method comes to, to about ``digits`` decimals; None where it comes to none.

    ``slopes`` are the derivatives of the formulas, row by row.
    """
    context = mpmath_.kept_digits(digits)
    rows = mpmath_.table(context)

    def evaluated(exprs: Any, point: Sequence[Any]) -> list[Any]:
        at = dict(zip(unknowns, point, strict=True))

        def leaf(node: Any) -> Any:
            return at[node] if node in at else mpmath_.evaluate(node, {}, digits) if not node.is_Rational else context.mpf(node.p) / node.q

        return [fold(e, rows, leaf) for e in exprs]

    point = [context.mpf(c) for c in start]
    for _ in range(60):
        f = evaluated(system, point)
        a, b, c, d = evaluated(slopes, point)
        det = a * d - b * c
        if det == 0 or not context.isfinite(det):
            return None
        step = [(d * f[0] - b * f[1]) / det, (a * f[1] - c * f[0]) / det]
        point = [p - s for p, s in zip(point, step, strict=True)]
        if not all(context.isfinite(p) for p in point):
            return None
        if max(abs(s) for s in step) < context.mpf(10) ** (4 - digits):
            whole = 10 ** (digits - 4)
            return tuple(Fraction(int(context.nint(p * whole)), whole) for p in point)
    return None
