"""What a routine has overwritten: arrays that it is only given, by name and increment."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array

__all__ = ["Overwritten", "differs", "overwritten"]

Overwritten = NDArray[np.object_]  # (N,) names with commas, "" where nothing was


def overwritten(changed: Mapping[str, NDArray[np.bool_]]) -> Overwritten | None:
    """The names of what was changed at each of N increments, of (N,) by name; None where nothing was at all."""
    if not any(each.any() for each in changed.values()):
        return None
    rows = np.array(list(changed.values())).T
    return np.array([", ".join(name for name, bad in zip(changed, row, strict=True) if bad) for row in rows], dtype=object)


def differs(one: Array, other: Array) -> NDArray[np.bool_]:
    """Which rows are not the same in each entry; a nan is the same as another."""
    unlike = (one != other) & ~(np.isnan(one) & np.isnan(other))
    return np.asarray(unlike.reshape(len(one), -1).any(axis=1))
