"""The boundary of K in the plane of two forces: as lines fine enough to be drawn (contours, extra ``plot``), and along rays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.expression.numpy_ import evaluate
from duhem.expression.rays import Rays
from duhem.law.formula_law import Criterion

__all__ = ["outline", "ray_ends"]

Array = NDArray[np.float64]
_GRID = 301
_RADII = 10.0 ** np.linspace(-4.0, 4.0, 161)


def outline(law: Criterion, parameters: Mapping[str, float], pressure: float | None, size: float) -> list[Array]:
    """Lines (n, 2) on which g = 0, in Pa, for a law of two forces whose open parameters are given.

    The view is a little wider than ``size`` > 0, or as wide as K if that is up to eight times it; a line that leaves the
    view ends there.
    """
    from contourpy import contour_generator

    side = np.linspace(-1.0, 1.0, _GRID)
    x, y = np.meshgrid(side, side)
    for factor in (1.15, 2.0, 4.0, 8.0, 1.3):
        reach = factor * size
        level = _level(law, parameters, pressure, reach * x, reach * y)
        if (np.concatenate([level[0], level[-1], level[:, 0], level[:, -1]]) > 0.0).all():  # all of K is in view
            break
    # Scaled, so that sizes at the ends of the doubles' range are drawn like any other.
    scale = float(np.nanmax(np.abs(np.where(np.isfinite(level), level, 0.0)))) or 1.0
    lines: Any = contour_generator(x, y, level / scale).lines(0.0)
    return [reach * line for line in lines]


def ray_ends(law: Criterion, parameters: Mapping[str, float], pressure: Array, forces: Array) -> Array:
    """How many times as far out as ``forces`` (m, 2) K ends on their rays, at ``pressure`` (m,); 1e4 where it does not end before."""
    rays = Rays(lambda p: _level(law, parameters, pressure[:, None], p[..., 0], p[..., 1]), np.zeros(2), forces)
    return rays.left(_RADII)[0]


def _level(law: Criterion, parameters: Mapping[str, float], pressure: Array | float | None, x: Array, y: Array) -> Array:
    """g at the stresses (x, y)."""
    table = law.symbols()
    given: dict[str, Any] = {**dict(zip(law.coordinates, (x, y, pressure), strict=False)), **parameters}
    with np.errstate(all="ignore"):
        return np.broadcast_to(evaluate(law.g, {table[name]: value for name, value in given.items()}), x.shape)
