"""Where a ray leaves a set {level <= 0}, in as many digits as asked for (mpmath)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

__all__ = ["reach"]

_LAG = 1.4142135623730951  # of two steps one may be wasted
_NEAREST, _FARTHEST = -13, 40  # powers of two: no end is looked for beyond 1e12


def reach(context: Any, level: Callable[[list[Any]], Any], start: Sequence[Any], way: Sequence[Any], bits: int) -> Any:
    """The t > 0 at which ``start`` + t ``way`` leaves first, from within and to ``bits`` binary digits.

    None if no point of the ray is found inside or none outside.  ``context`` is mpmath or one of its contexts, and carries the
    precision.  t doubles until it is outside; the last step is closed by false position (Illinois), or halved where that lags
    behind half as many halvings, as at a kink, and where the level is undefined.
    """

    def at(t: Any) -> Any:
        return level([c + t * w for c, w in zip(start, way, strict=True)])

    low, f_low = context.mpf(0), context.nan
    high = context.ldexp(1, _NEAREST)
    while (f_high := at(high)) <= 0:
        low, f_low, high = high, f_high, 2 * high
        if high > context.ldexp(1, _FARTHEST):
            return None
    least = max(context.ldexp(high - low, -bits), 2 * context.eps * high)  # the context may have fewer digits than are asked for
    allowed, before = 16 * (high - low), None
    while high - low > least:
        t, rise = (low + high) / 2, f_high - f_low
        if high - low <= allowed and context.isfinite(rise):
            t = min(max(low - (high - low) * f_low / rise - least / 2, low + least), high - least)  # within, not on the very end
        inside, allowed = bool((value := at(t)) <= 0), allowed / _LAG
        if inside:
            low, f_low, f_high = t, value, f_high / 2 if before is True else f_high
        else:
            high, f_high, f_low = t, value, f_low / 2 if before is False else f_low
        before = inside
    return low or None
