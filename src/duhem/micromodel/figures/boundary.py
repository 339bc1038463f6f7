"""The boundary of a plane law, found on rays from its formula alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.expression.numpy_ import compiled
from duhem.expression.rays import Rays
from duhem.law.formula_law import Criterion
from duhem.micromodel.figures.value import Array

__all__ = ["boundary"]

_DOUBLINGS = np.arange(-40, 41)  # from |sigma_n|: coefficients from 1e-12 to 1e12


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

    def level(points: Array) -> Array:
        return g(*np.moveaxis(points, -1, 0), pressure, *parameters.values())

    rays = Rays(level, np.zeros(2), np.stack([np.cos(theta), np.sin(theta)], axis=-1))
    last, first = rays.left(abs(pressure) * np.ldexp(1.0, _DOUBLINGS))
    if (last == first).any():
        raise InputError("a ray from 0 does not leave K", where=law.name, remedy="draw a law that is bounded")
    return rays.at(last)
