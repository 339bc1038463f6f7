"""Polynomials as numbers by exponents, and the sums of squares that may stand in an identity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import product as pairs
from typing import Any

__all__ = ["Block", "Exponents", "Polynomial", "added", "times"]

Exponents = tuple[int, ...]
Polynomial = Mapping[Exponents, Fraction]


@dataclass(frozen=True)
class Block:
    """The sums of squares of combinations of ``squares``, multiplied by ``factor``; ``name`` tells whoever asks which."""

    name: Any
    factor: Polynomial
    squares: tuple[Polynomial, ...]


def added(*polynomials: Polynomial) -> Polynomial:
    """Their sum."""
    total: dict[Exponents, Fraction] = {}
    for p in polynomials:
        for m, c in p.items():
            total[m] = total.get(m, Fraction(0)) + c
    return {m: c for m, c in total.items() if c}


def times(p: Polynomial, q: Polynomial) -> Polynomial:
    """Their product."""
    total: dict[Exponents, Fraction] = {}
    for (m, c), (n, d) in pairs(p.items(), q.items()):
        k = tuple(map(int.__add__, m, n))
        total[k] = total.get(k, Fraction(0)) + c * d
    return {m: c for m, c in total.items() if c}
