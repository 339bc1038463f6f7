"""Pieces of formulas as text: decimals, sums, products and linear forms."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from duhem.expression.vocabulary import nested

__all__ = ["decimal", "greatest", "linear", "times", "total"]


def decimal(x: float, digits: int = 6) -> str:
    """A number to so many significant digits, as a formula has it: ``0.00125``, without an exponent."""
    return np.format_float_positional(x, digits, unique=False, fractional=False, trim="-")


def total(terms: Iterable[str]) -> str:
    """The sum of terms, some with a minus sign before them."""
    return " + ".join(terms).replace("+ -", "- ")


def times(*factors: str | tuple[str, int]) -> str:
    """The product of factors, words with their arguments or in brackets; of a pair the power, which is left out where it is 0."""
    pairs = [(factor, 1) if isinstance(factor, str) else factor for factor in factors]
    return "*".join(base if n == 1 else f"{base}**{n}" for base, n in pairs if n)


def greatest(terms: Iterable[str]) -> str:
    """The greatest of terms, of so many at once as a word may have."""
    found = list(terms)
    return nested("max", found) if len(found) > 1 else found[0]


def linear(row: Sequence[float], forces: Sequence[str]) -> str:
    """A linear form in the forces."""
    return total(f"{decimal(c)}*{f}" for c, f in zip(row, forces, strict=True) if c)
