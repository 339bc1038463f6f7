"""The boundary of a plane law, found on rays from its formula alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.expression.numpy_ import compiled
from duhem.law.formula_law import Criterion
from duhem.micromodel.figures.value import Array

__all__ = ["boundary"]

_DOUBLINGS = 40  # up and down from |sigma_n|: coefficients from 1e-12 to 1e12
_HALVINGS = 64  # of an interval that ends at most twice as far out as it begins: more than a double holds


def boundary(law: Criterion, parameters: Mapping[str, float], angle: ArrayLike, pressure: float = -1.0) -> Array:
    """Points (n, 2) where the rays at ``angle`` (n,), in rad from the first force, leave K(sigma_n = ``pressure``).

    K has to be star-shaped about 0, which lies inside.  InputError for parameters outside their domain and for a ray
    along which g does not become positive.
    """
    fixed = law.fix(parameters)
    table = fixed.symbols()
    names = [*fixed.forces, str(fixed.pressure), *parameters]
    g = compiled(fixed.g, [table[name] for name in names])
    theta = np.asarray(angle, dtype=np.float64)
    ray = np.stack([np.cos(theta), np.sin(theta)], axis=-1)

    def outside(radius: Array) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        return g(*(radius[:, None] * ray).T, pressure, *parameters.values()) > 0.0

    high = np.full(theta.shape, abs(pressure) * 2.0**-_DOUBLINGS)
    for _ in range(2 * _DOUBLINGS):
        high = np.where(outside(high), high, 2.0 * high)
    if not outside(high).all():
        raise InputError("a ray from 0 does not leave K", where=law.name, remedy="draw a law that is bounded")
    low = 0.5 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        out = outside(middle)
        low, high = np.where(out, low, middle), np.where(out, middle, high)
    return 0.5 * (low + high)[:, None] * ray
