"""Pieces of formulas as text: decimals, sums, products and linear forms."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from decimal import Decimal

__all__ = ["decimal", "linear", "times", "total"]


def decimal(x: float, digits: int = 6) -> str:
    """A number to so many significant digits, as a formula has it: ``0.00125``, without an exponent."""
    text = f"{Decimal(f'{x:.{digits}g}'):f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def total(terms: Iterable[str]) -> str:
    """The sum of terms, some with a minus sign before them."""
    return " + ".join(terms).replace("+ -", "- ")


def times(*factors: str | tuple[str, int]) -> str:
    """The product of factors, words with their arguments or in brackets; of a pair the power, which is left out where it is 0."""
    pairs = [(factor, 1) if isinstance(factor, str) else factor for factor in factors]
    return "*".join(base if n == 1 else f"{base}**{n}" for base, n in pairs if n)


def linear(row: Sequence[float], forces: Sequence[str]) -> str:
    """A linear form in the forces."""
    return total(f"{decimal(c)}*{f}" for c, f in zip(row, forces, strict=True) if c)
