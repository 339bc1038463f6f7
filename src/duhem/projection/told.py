"""What is known of the points of a solution so far, and which of them are still to be judged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array, Residuals

__all__ = ["Told"]


@dataclass(frozen=True, eq=False)
class Told:
    """``dissipation`` (N,), ``status`` and ``residuals`` are good but for the points ``left``, None for all of them."""

    dissipation: Array
    status: NDArray[np.int8]
    residuals: Residuals
    left: NDArray[np.intp] | None

    @classmethod
    def nothing(cls, n: int) -> Told:
        """Room for what is to be said of n points."""
        return cls(np.empty(n), np.empty(n, dtype=np.int8), Residuals(*(np.zeros(n) for _ in range(5))), None)
