"""A law of known truth, and the rational numbers such laws are drawn with."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from duhem import Criterion, Domain

__all__ = ["PRESSURE", "Trial", "direction", "linear", "matrix", "near", "scale", "star", "written"]

F = Fraction
PRESSURE = "abs(sigma_n)"  # N in the formulas of the docstrings


@dataclass(frozen=True)
class Trial:
    """A law with the claims whose truth is known; ``margin`` says how close to a threshold it was made."""

    family: str
    law: Criterion
    truth: Mapping[str, bool]
    margin: str = "generic"


def scale(rng: random.Random) -> Fraction:
    """A positive number between 1/6 and 12."""
    return F(rng.randint(1, 12), rng.randint(1, 6))


def matrix(rng: random.Random) -> tuple[Fraction, Fraction, Fraction, Fraction]:
    """The rows of an invertible 2 x 2 matrix, one after the other."""
    while True:
        m = tuple(F(rng.randint(-5, 5), rng.randint(1, 3)) for _ in range(4))
        if abs(m[0] * m[3] - m[1] * m[2]) > F(1, 4):
            return m  # type: ignore[return-value]


def direction(rng: random.Random) -> tuple[Fraction, Fraction]:
    """A rational point of the unit circle."""
    t = F(rng.randint(-9, 9), rng.randint(1, 7))
    return (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)


def written(x: Fraction) -> str:
    """The number as a formula has it, a sign and a quotient in brackets."""
    return f"({x})"


def linear(row: Sequence[Fraction]) -> str:
    """The linear form of the forces with this row of coefficients."""
    return f"({written(row[0])}*sigma_a + {written(row[1])}*sigma_b)"


def near(rng: random.Random) -> tuple[Fraction, str]:
    """A factor at or beside 1."""
    return rng.choice([
        (F(1), "exact"), (F(1), "exact"), (1 + F(1, 10**9), "above 1e-9"), (1 - F(1, 10**9), "below 1e-9"),
        (1 + F(1, 10**4), "above 1e-4"), (1 - F(1, 10**4), "below 1e-4"),
    ])  # fmt: skip


_SMOOTH_STAR = {"origin": True, "smoothness": True, "dissipation": True}


def star(family: str, name: str, g: str, convex: bool, margin: str, parameters: Mapping[str, Domain] | None = None) -> Trial:
    """A smooth set around the origin: normality is true where convexity is, every other claim always."""
    truth = _SMOOTH_STAR | {"convexity": convex, "normality": convex}
    return Trial(family, Criterion(name=name, g=g, parameters=parameters or {}), truth, margin)
