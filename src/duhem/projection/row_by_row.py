"""Products, lengths and shares of many short vectors, a row each, whose digits do not depend on the other rows."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from duhem.expression.numpy_ import length as components_length
from duhem.projection.result import Array

__all__ = ["any_of", "columns_times", "dot", "length", "products", "share", "spanning", "times", "unit", "widest"]


def columns_times(columns: Iterable[Array], matrix: Array) -> Array:
    """Vectors times a matrix (d, m), as columns (m, N): products with its zeros are left out, and each sum is taken in order."""
    given = list(columns)
    found = np.empty((matrix.shape[1], len(given[0])))
    for into, weights in zip(found, matrix.T.tolist(), strict=True):
        (first, weight), *others = [(x, w) for x, w in zip(given, weights, strict=True) if w != 0.0] or [(given[0], 0.0)]
        np.multiply(weight, first, out=into)
        for x, w in others:
            into += w * x
    return found


def dot(first: Array, second: Array) -> Array:
    """Scalar products (N,), column by column, as in :func:`widest`."""
    return reduce(np.add, (first * second).T)


def length(vectors: Array) -> Array:
    """Euclidean lengths (N,), of vectors whose squares are beyond doubles too."""
    return np.asarray(components_length(*vectors.T))


def times(vectors: Array, matrix: Array) -> Array:
    """Rows (N, d) times a matrix (d, m): a library's product sums in an order that changes with N."""
    return np.ascontiguousarray(columns_times(vectors.T, matrix).T)


def products(first: Array, second: Array) -> Array:
    """Scalar products (N, M) of rows (N, d) with rows (M, d)."""
    return reduce(np.add, (a[:, None] * b for a, b in zip(first.T, second.T, strict=True)))


def unit(vectors: Array) -> tuple[Array, Array]:
    """Directions and lengths, of very small vectors too."""
    size = widest(vectors)
    far = length(vectors / size[:, None])
    return vectors / size[:, None] / far[:, None], far * size


def any_of(rows: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether one of each row (N, d) holds; rows as long as a word are looked at as words."""
    if rows.shape[1] in (1, 2, 4, 8):
        return np.ascontiguousarray(rows).view(f"u{rows.shape[1]}")[:, 0] != 0
    return reduce(np.logical_or, rows.T)


def widest(vectors: Array) -> Array:
    """The largest size of a component, column by column: there are many rows and few columns."""
    return reduce(np.maximum, np.abs(vectors).T)


def share(part: Array, whole: Array) -> Array:
    """part/whole, with 0/0 = 0."""
    return np.where(part == 0.0, 0.0, part / whole)


def spanning(normals: Array, least: float) -> Array:
    """The pseudo-inverses (M, count, d) of matrices whose columns are ``normals`` (M, d, count), unit vectors or nothing.

    A normal no farther than ``least`` from what those before it span has no share.  Normal by normal (T. N. E. Greville, 1960,
    SIAM Review 2, 15-22): for one small matrix a library takes as long as this for a dozen.
    """
    inverse = np.zeros((len(normals), 0, normals.shape[1]))
    for j, normal in enumerate(np.moveaxis(normals, 2, 0)):
        share = np.einsum("mcd,md->mc", inverse, normal)
        rest = normal - np.einsum("mdc,mc->md", normals[:, :, :j], share)
        size = dot(rest, rest)[:, None]
        row = np.where(size > least**2, rest / np.where(size > 0.0, size, 1.0), 0.0)
        inverse = np.concatenate([inverse - share[:, :, None] * row[:, None], row[:, None]], axis=1)
    return inverse
