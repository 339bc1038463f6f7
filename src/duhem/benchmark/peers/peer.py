"""What the adapters have in common: one option, and how a stress becomes a solution that can be judged."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.projection.increment import Increment
from duhem.projection.level import level
from duhem.projection.method import Options
from duhem.projection.result import Array, Solution
from duhem.projection.scaled_formula import power_of_two

__all__ = ["PeerOptions", "answered"]


@dataclass(frozen=True)
class PeerOptions(Options):
    """``tolerance``: at which the program stops, in its own meaning of the word; left out, the program's default."""

    tolerance: float | None = None

    def __post_init__(self) -> None:
        if self.tolerance is not None and not (math.isfinite(self.tolerance) and self.tolerance > 0.0):
            raise InputError(f"the tolerance {self.tolerance} is not a positive number", where="tolerance", remedy="give one such as 1e-9")


def answered(question: Increment, stress: Array, failed: NDArray[np.bool_]) -> Solution:
    """The stresses (N, d) in Pa with the slip k^-1 (trial - stress) and the multiplier that explains it best.

    Peers return a stress, or multipliers of their own.  With n = dg/dsigma a slip along n has lambda = slip . stress/(n . stress),
    which at a corner of a gauge is the sum over its faces.  A point is ``failed`` where the program says so, or has no number.
    """
    slip: Array = np.asarray(np.linalg.solve(question.stiffness, (question.trial - stress).T).T, dtype=np.float64)
    law = question.law
    level_ = level(question.g, law.force_symbols(), law.symbols()[law.pressure] if law.pressure else None)
    with np.errstate(all="ignore"):
        size = power_of_two(np.abs(stress).max(axis=1, initial=0.0))
        normal = level_.gradient(stress, question.pressure, size)
        share = np.einsum("nd,nd->n", slip, stress) / np.einsum("nd,nd->n", normal, stress)
        multiplier = np.where((slip == 0.0).all(axis=1), 0.0, level_.own(share, size))
    return Solution(stress, slip, multiplier, failed | ~np.isfinite(stress).all(axis=1))
