"""The checked question of a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from duhem.path.loading import Path
from duhem.projection.increment import Increment
from duhem.projection.result import Array

__all__ = ["Problem", "times"]


@dataclass(frozen=True, eq=False)
class Problem:
    """A law with numbers in place, and the path.

    ``increment`` is the checked question, its trial stresses being those without slip; ``projection`` the method of the
    closest point.  Displacements in m, stresses in Pa, stiffness in Pa/m.
    """

    increment: Increment
    path: Path
    projection: str
    compliance: Array

    @property
    def stiffness(self) -> Array:
        return self.increment.stiffness

    def psi(self, stress: Array) -> Array:
        """sigma . k^-1 sigma / 2 of each row, in Pa m."""
        return np.asarray(0.5 * (stress * times(stress, self.compliance)).sum(axis=-1))


def times(rows: Array, matrix: Array) -> Array:
    """rows @ matrix, each row by itself: no row's rounding depends on how many there are."""
    return np.asarray(sum(rows[..., j, None] * matrix[j] for j in range(len(matrix))))
