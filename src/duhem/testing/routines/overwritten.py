"""What a routine has overwritten: arrays that it is only given, by name and increment."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Overwritten", "changed", "overwritten"]

Overwritten = NDArray[np.object_]  # (N,) names with commas, "" where nothing was


def changed(pairs: Mapping[str, tuple[NDArray[Any], NDArray[Any]]]) -> dict[str, NDArray[np.bool_]]:
    """Which rows of an array are no more what they were, of pairs by name; what is the same to the last bit is left out."""
    return {name: _differs(*pair) for name, pair in pairs.items() if pair[0].tobytes() != pair[1].tobytes()}


def overwritten(found: Mapping[str, NDArray[np.bool_]]) -> Overwritten | None:
    """The names of what was changed at each of N increments, of (N,) by name; None where nothing was at all."""
    if not any(each.any() for each in found.values()):
        return None
    rows = np.array(list(found.values())).T
    return np.array([", ".join(name for name, bad in zip(found, row, strict=True) if bad) for row in rows], dtype=object)


def _differs(one: NDArray[Any], other: NDArray[Any]) -> NDArray[np.bool_]:
    """Which rows are not the same in each entry; a nan is the same as another."""
    unlike = (one != other) & ~(np.isnan(one) & np.isnan(other))
    return np.asarray(unlike.reshape(len(one), -1).any(axis=1))
