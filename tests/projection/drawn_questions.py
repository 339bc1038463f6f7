"""Laws with formulas of every kind, drawn stiffnesses and spoilt answers, as the tests of loops and filters put their questions."""

from dataclasses import replace
from typing import Any

import numpy as np

import duhem
from duhem import Criterion
from duhem.projection.result import Solution

__all__ = ["LAWS", "drawn", "spoilt"]

LAWS: dict[str, dict[str, float]] = {
    "antoni2007": {"mu_a_plus": 0.3, "mu_a_minus": 0.2, "mu_b_plus": 0.1, "mu_b_minus": 0.4}, "coulomb": {"mu": 0.3},
    "superellipse": {"mu_a": 0.3, "mu_b": 0.2, "p": 4}, "limacon": {"mu": 0.3, "e": 0.4}, "hosford": {"yield_stress": 0.3, "m": 8},
    "drucker1949": {"k": 0.3, "c": 2}, "von-mises": {"yield_stress": 0.3}, "box": {"mu_a": 0.3, "mu_b": 0.2},
    "tresca": {"yield_stress": 0.3}, "regularised": {"mu": 0.3, "c": 0.1}, "capped": {"mu": 0.3, "tau_max": 0.2},
    "matchstick": {"mu_a": 0.3, "mu_b": 0.25}, "antoni2007-1d": {"mu_plus": 0.3, "mu_minus": 0.1}, "polygon": {"mu": 0.3},
}  # fmt: skip


def drawn(name: str, seed: int, full: bool) -> tuple[Criterion, np.random.Generator, Any]:
    """A law, what draws its stresses, and a stiffness: diagonal, or ``full`` and drawn too."""
    law = duhem.load(name)
    rng, d = np.random.default_rng(seed), len(law.forces)
    if not full:
        return law, rng, np.array([1.0, 2.0, 1.5])[:d]
    root = rng.normal(size=(d, d))
    return law, rng, root @ root.T + 0.3 * np.eye(d)


def spoilt(how: str, size: float, got: Solution) -> Solution:
    """A solution with one thing wrong in it, by ``size`` where that says how much."""
    stress, slip, multiplier = got.stress.copy(), got.slip.copy(), got.multiplier.copy()
    match how:
        case "stress out":
            stress *= 1.0 + size
        case "stress in":
            stress *= 1.0 - size
        case "slip turned":
            slip = slip + size * np.roll(slip, 1, axis=1) * np.where(np.arange(slip.shape[1]) % 2, 1.0, -1.0)
        case "slip longer":
            slip *= 1.0 + size
        case "multiplier":
            multiplier *= 1.0 + size
        case "negative":
            multiplier, slip = -multiplier, -slip
        case "stick that slips":
            stress, slip, multiplier = stress + size * np.abs(stress), 0.0 * slip, 0.0 * multiplier
        case "stick":
            slip, multiplier = 0.0 * slip, 0.0 * multiplier
        case "nan":
            slip[:, 0] = np.nan
        case "inf":
            stress[:, 0] = np.inf
        case _:
            slip[:] = np.nan
    return replace(got, stress=stress, slip=slip, multiplier=multiplier)
