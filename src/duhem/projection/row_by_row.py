"""Products, lengths and shares of many short vectors, a row each."""

from __future__ import annotations

from functools import reduce

import numpy as np

from duhem.projection.result import Array

__all__ = ["dot", "length", "share", "unit", "widest"]


def dot(first: Array, second: Array) -> Array:
    """Scalar products (N,), column by column, as in :func:`widest`."""
    return reduce(np.add, (a * b for a, b in zip(first.T, second.T, strict=True)))


def length(vectors: Array) -> Array:
    """Euclidean lengths (N,)."""
    return np.asarray(np.sqrt(dot(vectors, vectors)))


def unit(vectors: Array) -> tuple[Array, Array]:
    """Directions and lengths, of very small vectors too."""
    size = widest(vectors)
    far = length(vectors / size[:, None])
    return vectors / size[:, None] / far[:, None], far * size


def widest(vectors: Array) -> Array:
    """The largest size of a component, column by column: there are many rows and few columns."""
    return reduce(np.maximum, np.abs(vectors).T)


def share(part: Array, whole: Array) -> Array:
    """part/whole, with 0/0 = 0."""
    return np.where(part == 0.0, 0.0, part / whole)
