"""Coordinates in which the fit moves: the logarithm of a positive parameter, any other parameter as it is.

A positive parameter then stays positive without a bound, and a change of unit is a shift.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.law.domain import Domain

__all__ = ["Coordinates"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Coordinates:
    """Parameters theta (p,) to coordinates x (p,) and back, over their ``domains``."""

    domains: tuple[Domain, ...]

    @property
    def logarithmic(self) -> NDArray[np.bool_]:
        """Which parameters are moved by their logarithm (p,)."""
        return np.array([domain.positive for domain in self.domains], dtype=np.bool_)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Least and greatest coordinate; infinite where the domain has no end there."""
        low = [-np.inf if d.positive or d.low is None else float(d.low) for d in self.domains]
        high = [np.inf if d.high is None else np.log(float(d.high)) if d.positive else float(d.high) for d in self.domains]
        return np.array(low), np.array(high)

    @property
    def unbounded(self) -> bool:
        """Whether no coordinate has a bound."""
        low, high = self.bounds
        return bool(np.all(np.isinf(low)) and np.all(np.isinf(high)))

    def inward(self, theta: Sequence[float] | Array) -> Array:
        """The coordinates of ``theta``."""
        values, logs = np.asarray(theta, dtype=np.float64), self.logarithmic
        return np.where(logs, np.log(np.where(logs, values, 1.0)), values)

    def outward(self, x: Array) -> Array:
        """The parameters at ``x``."""
        logs = self.logarithmic
        with np.errstate(over="ignore"):  # an interval may be endless
            return np.where(logs, np.exp(np.where(logs, x, 0.0)), x)

    def stretch(self, theta: Array) -> Array:
        """d theta / d x (p,)."""
        return np.where(self.logarithmic, theta, 1.0)
