"""Pieces of formulas as text: decimals, sums, powers and linear forms."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from decimal import Decimal

__all__ = ["decimal", "linear", "power", "total"]


def decimal(x: float, digits: int = 6) -> str:
    """A number to so many significant digits, as a formula has it: ``0.00125``, without an exponent."""
    text = f"{Decimal(f'{x:.{digits}g}'):f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def total(terms: Iterable[str]) -> str:
    """The sum of terms, some with a minus sign before them."""
    return " + ".join(terms).replace("+ -", "- ")


def power(base: str, n: int) -> str:
    """``base``, a word with its arguments or in brackets, to the power n >= 1."""
    return base if n == 1 else f"{base}**{n}"


def linear(row: Sequence[float], forces: Sequence[str]) -> str:
    """A linear form in the forces, without what is next to nothing beside the rest of it."""
    return total(f"{decimal(c)}*{f}" for c, f in zip(row, forces, strict=True) if abs(c) > 1e-7 * max(map(abs, row)))
