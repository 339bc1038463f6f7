"""The boundary of K as lines in the plane of two forces, fine enough to be drawn (matplotlib's contours, extra ``plot``)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.expression.numpy_ import evaluate
from duhem.law.formula_law import Criterion

__all__ = ["outline"]

Array = NDArray[np.float64]
_GRID = 301


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


def _level(law: Criterion, parameters: Mapping[str, float], pressure: float | None, x: Array, y: Array) -> Array:
    """g at the stresses (x, y)."""
    table = law.symbols()
    known: dict[Any, Any] = {table[force]: place for force, place in zip(law.forces, (x, y), strict=True)}
    known |= {table[name]: value for name, value in parameters.items()}
    if law.pressure:
        known[table[law.pressure]] = pressure
    with np.errstate(all="ignore"):
        return np.broadcast_to(evaluate(law.g, known), x.shape)
