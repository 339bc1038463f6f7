"""The metric of a stiffness: lengths (x . k x)^1/2 of slips and (x . k^-1 x)^1/2 of stresses, however ill-conditioned k is."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np

from duhem.errors import InputError
from duhem.projection.result import ACCURACY, Array

__all__ = ["ROUNDING", "Metric", "factors", "too_far_apart"]


def too_far_apart(stiffness: Array) -> str | None:
    """None where k over its largest entry has a Cholesky factor in double precision, else why not, with the remedy."""
    relative = stiffness / np.max(np.diagonal(stiffness))
    try:
        np.linalg.cholesky(relative)
    except np.linalg.LinAlgError:
        return "the stiffnesses are too far apart for double precision; measure the forces in units that bring them together"
    return None


def factors(stiffness: Array) -> tuple[Array, Array]:
    """L lower triangular and its inverse, for a symmetric positive definite (d, d) ``stiffness`` in Pa/m.

    slip @ L and stress @ L^-T then have the lengths (slip . k slip)^1/2 and (stress . k^-1 stress)^1/2, in (J/m^2)^1/2.
    k = U D U^T is found exactly, in fractions: in floating point the last pivot keeps no digit once the condition
    exceeds 1e16 (G. H. Golub and C. F. Van Loan, 2013, Matrix Computations, section 4.2).  InputError if k is not
    positive definite.
    """
    d = len(stiffness)
    k = [[Fraction(x) for x in row] for row in np.asarray(stiffness, dtype=np.float64).tolist()]
    unit = [[Fraction(i == j) for j in range(d)] for i in range(d)]
    inverse = [[Fraction(i == j) for j in range(d)] for i in range(d)]
    for j in range(d):
        if k[j][j] <= 0:
            raise InputError("the matrix is not positive definite", where="stiffness", remedy="give a symmetric positive definite one")
        for i in range(j + 1, d):
            share = k[i][j] / k[j][j]
            unit[i][j] = share
            k[i] = [x - share * y for x, y in zip(k[i], k[j], strict=True)]
            inverse[i] = [x - share * y for x, y in zip(inverse[i], inverse[j], strict=True)]
    roots = np.sqrt([float(k[j][j]) for j in range(d)])
    rows = ([[float(x) for x in row] for row in matrix] for matrix in (unit, inverse))
    lower, upper = (np.array(row) for row in rows)
    return lower * roots, upper / roots[:, None]


ROUNDING = 4e-15  # of each number that enters


@dataclass(frozen=True, eq=False)
class Metric:
    """Matrices (d, d): rows times ``of_slip`` or ``of_stress`` have these lengths, ``to_stress`` is the way back.

    ``blur``: what a difference of stresses may be off by as a share of their lengths; ``steepest``: the most that the components
    of a slip are longer than in the metric; ``good``: what a slip may be off by in it for all its components to be good, ``certain``
    what a point may be off by as a share of its stress, or of its slip, for those of either to be.
    """

    of_slip: Array
    of_stress: Array
    to_stress: Array
    blur: float
    steepest: float
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
    good = ACCURACY / max(1.0, steepest * float(np.linalg.norm(lower, 2)))
    return Metric(lower, inverse.T, lower.T, blur, steepest, good, good / float(np.sqrt(d)))
