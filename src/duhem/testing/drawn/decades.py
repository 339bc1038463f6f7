"""Numbers by decades, of two digits each: none like another, and all of them short to read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

from hypothesis import strategies as st

__all__ = ["MANTISSAS", "Strategy", "decades", "scaled", "table"]

Strategy: TypeAlias = st.SearchStrategy[Any]

MANTISSAS = (1.0, *(round(10.0 ** ((j * 0.6180339887498949) % 1.0), 1) for j in range(1, 12)))  # none like another


def scaled(mantissa: float, power: int) -> float:
    """The double nearest to m 10^k: of 4.1 and -1 it is 0.41, not what a product rounds to."""
    return float(f"{mantissa!r}e{power}")


def table(values: Sequence[Any]) -> Strategy:
    """One of ``values`` by its place: a single draw, and it shrinks towards the first."""
    return st.integers(0, len(values) - 1).map(values.__getitem__)


def decades(low: int, high: int, *, signed: bool = False) -> Strategy:
    """Floats m 10^k, low <= k <= high, 1 <= m < 10, each decade as likely as the next; it shrinks to 1 or the nearest."""
    powers = sorted(range(low, high + 1), key=abs)
    return table([s * scaled(m, k) for m in MANTISSAS for k in powers for s in ((1.0, -1.0) if signed else (1.0,))])
