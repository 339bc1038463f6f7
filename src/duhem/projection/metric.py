"""Lengths of slips and stresses by a stiffness: (x . k x)^1/2 and (x . k^-1 x)^1/2."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from duhem.projection.result import ACCURACY, Array
from duhem.projection.stiffness_factors import factors

__all__ = ["ROUNDING", "Metric"]

ROUNDING = 4e-15  # of each number that enters


@dataclass(frozen=True, eq=False)
class Metric:
    """Matrices (d, d): rows times ``of_slip`` or ``of_stress`` have these lengths, ``to_stress`` and ``to_slip`` are the ways back.

    ``blur``: what a difference of stresses may be off by as a share of their lengths; ``steepest``: the most that the components
    of a slip are longer than in the metric, ``tallest`` those of a stress; ``good``: what a slip may be off by in it for all its
    components to be good, ``certain`` what a point may be off by as a share of its stress, or of its slip, for those of either to be.
    """

    of_slip: Array
    of_stress: Array
    to_stress: Array
    to_slip: Array
    blur: float
    steepest: float
    tallest: float
    good: float
    certain: float

    @classmethod
    def of(cls, stiffness: Array) -> Metric:
        """That of k, symmetric and positive definite."""
        return _metric(stiffness.tobytes(), len(stiffness))


@lru_cache(maxsize=64)
def _metric(stiffness: bytes, d: int) -> Metric:
    k = np.frombuffer(stiffness).reshape(d, d)
    lower, inverse = factors(k)
    blur = 2.0 * ROUNDING * float(np.linalg.norm(np.abs(lower.T) @ np.abs(inverse.T), 2))  # of components, which the metric weighs
    steepest = float(np.linalg.norm(inverse, 2))
    tallest = float(np.sqrt(np.max(np.diagonal(k))))
    good = ACCURACY / max(1.0, steepest * float(np.linalg.norm(lower, 2)))
    return Metric(lower, inverse.T, lower.T, inverse, blur, steepest, tallest, good, good / float(np.sqrt(d)))
