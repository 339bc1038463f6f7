"""Where a ray leaves a set {level <= 0}, in as many digits as asked for (mpmath)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

__all__ = ["reach"]

_NEAREST, _FARTHEST = -13, 40  # powers of two: no end is looked for beyond 1e12


def reach(context: Any, level: Callable[[list[Any]], Any], start: Sequence[Any], way: Sequence[Any], bits: int) -> Any:
    """The t > 0 at which ``start`` + t ``way`` leaves first, from within and to ``bits`` binary digits.

    None if no point of the ray is found inside or none outside.  ``context`` is mpmath or one of its contexts, and carries the
    precision.  t doubles until it is outside, then the last step is halved.
    """

    def inside(t: Any) -> bool:
        return bool(level([c + t * w for c, w in zip(start, way, strict=True)]) <= 0)

    low, high = context.mpf(0), context.ldexp(1, _NEAREST)
    while inside(high):
        low, high = high, 2 * high
        if high > context.ldexp(1, _FARTHEST):
            return None
    for _ in range(bits):
        middle = (low + high) / 2
        low, high = (middle, high) if inside(middle) else (low, middle)
    return low or None
