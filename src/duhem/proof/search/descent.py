"""A point of K where random points miss it: a set that is small, thin or far from 0."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["lowest"]

_POINTS, _ROUNDS, _AROUND = 4000, 80, 64
_DEEP = 3  # how many rounds are worth while inside


def lowest(value: Callable[[Any], Any], d: int, rng: np.random.Generator, sizes: tuple[float, float]) -> NDArray[np.float64] | None:
    """The lowest of random points, 10 to such powers in size; where that is outside of K, from there downhill, or None."""

    def heights(points: Any) -> Any:
        found = np.asarray(value(points), dtype=float)
        return np.where(np.isfinite(found), found, np.inf)

    points = rng.standard_normal((_POINTS, d)) * 10.0 ** rng.uniform(*sizes, (_POINTS, 1))
    found = heights(points)
    here, height = points[int(np.argmin(found))], float(found.min())
    if not height > 0:
        return here
    width, deeper = float(np.linalg.norm(here)), 0
    for _ in range(_ROUNDS):  # around the lowest so far, ever closer where none is lower
        near = here + width * rng.standard_normal((_AROUND, d))
        found = heights(near)
        if found.min() < height:
            here, height = near[int(np.argmin(found))], float(found.min())
            deeper += height <= 0
            if deeper == _DEEP:
                break
        else:
            width /= 2
    return here if height <= 0 else None
