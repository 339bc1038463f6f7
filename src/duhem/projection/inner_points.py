"""A point well inside K for every point of an increment: the origin wherever it is inside, as it is for admissible laws."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.projection.whitened_body import Body, Index

__all__ = ["inner_points"]

_MARGIN = 1e-11  # in sizes of K
_MAGNITUDES = 4.0 ** np.arange(2, -22, -1)
_DIRECTIONS = 48
_MOST_DIAGONAL = 6  # forces
_BLOCK = 1024  # points: two dozen samples of each at a time stay in the cache


def inner_points(body: Body, at: Index) -> tuple[Array, NDArray[np.bool_]]:
    """Centres (M, d) in units of the size, and where there is none: K has no inner point that sampling finds."""
    d = len(body.root)
    centre = np.zeros((len(at), d))
    outside = ~_inner(body, centre, at)
    for directions in (_any_directions, _diagonals):
        if (who := np.flatnonzero(outside)).size:
            centre[who] = _mean_of_samples(body, at[who], directions(d))
            outside[who] = ~_inner(body, centre[who], at[who])
    return centre, outside


def _any_directions(d: int) -> Array:
    """By chance and along the axes (W, d)."""
    return np.concatenate([np.random.default_rng(0).standard_normal((_DIRECTIONS, d)), np.eye(d), -np.eye(d)])


def _diagonals(d: int) -> Array:
    """All sums of axes, both ways: a cone about the hydrostatic axis fills too little of six dimensions to be met by chance."""
    few = min(d, _MOST_DIAGONAL)
    sums = np.array([w for w in product((0.0, 1.0), repeat=few) if sum(w) > 1])
    sums = np.hstack([sums, np.zeros((len(sums), d - few))]) if sums.size else np.zeros((0, d))
    return np.concatenate([sums, -sums])


def _inner(body: Body, x: Array, at: Index) -> NDArray[np.bool_]:
    d = len(body.root)
    inside = body.level(x, at) < 0  # at = 0 it may be rounding alone
    for e in np.concatenate([np.eye(d), -np.eye(d)]):
        inside &= body.level(x + _MARGIN * e, at) <= 0
    return inside


def _mean_of_samples(body: Body, at: Index, directions: Array) -> Array:
    """The mean of the sampled points that lie in K: inside it, K being convex.  Of each ray it is the farthest that counts."""
    d, many = len(body.root), len(_MAGNITUDES)
    mean = np.zeros((len(at), d))
    for start in range(0, len(at), _BLOCK):
        block = at[start : start + _BLOCK]
        total, count, row = np.zeros((len(block), d)), np.zeros(len(block)), np.repeat(block, many)
        for direction in directions:
            ray = _MAGNITUDES[:, None] * direction / np.linalg.norm(direction)
            inside = (body.level(np.tile(ray, (len(block), 1)), row) <= 0).reshape(-1, many)
            seen = inside.any(axis=1)
            total[seen] += ray[np.argmax(inside[seen], axis=1)]
            count += seen
        mean[start : start + _BLOCK] = total / np.maximum(count, 1)[:, None]
    return mean
