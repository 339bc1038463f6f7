"""Directions along which K does not end, in either sense: the pressure axis of a metal, for one.

Along them the projection keeps the trial stress, and taking them out first keeps the digits that a large pressure part
would cost.  They are found numerically, as the directions orthogonal to every gradient of a sample, along which the level does
not change from the origin either: a sample may miss the short sides of a slender K.  Whoever uses them checks the result
on the formula itself.
"""

from __future__ import annotations

import numpy as np

from duhem.projection.result import Array
from duhem.projection.whitened_body import Body, Index

__all__ = ["lineality"]

_SAMPLES = 64
_ALIKE = 1e-9
_SIZES = (-8.0, -1.0, 1.0, 8.0)


def lineality(body: Body) -> Array:
    """An orthonormal basis (d, r) of those directions, in whitened space; r = 0 for a bounded K."""
    d, n = len(body.root), len(body.size)
    at = np.arange(_SAMPLES * d) % n
    x = np.random.default_rng(0).standard_normal((len(at), d)) * 10.0 ** np.linspace(-2, 2, len(at))[:, None]
    normal = body.piece(x, at, second=False).normal
    sound = np.all(np.isfinite(normal), axis=1)
    if sound.sum() < len(at) // 2:
        return np.zeros((d, 0))
    _, values, directions = np.linalg.svd(np.linalg.qr(normal[sound], mode="r"))
    endless = np.asarray(directions[values <= _ALIKE * values[0]].T)
    return endless if not endless.size or _constant(body, endless, at) else np.zeros((d, 0))


def _constant(body: Body, endless: Array, at: Index) -> bool:
    """Whether the level at the origin is that a few sizes of K away, along each direction and all of them together."""
    d, r = endless.shape
    ways = np.vstack([np.zeros(r), np.eye(r), np.ones(r)]) @ endless.T @ body.root.T
    who, origin = np.repeat(at, len(ways)), np.zeros((len(at), d))
    start = np.repeat(body.level(origin, at), len(ways))
    return all(
        bool((np.abs(body.level(np.tile(size * ways, (len(at), 1)), who) - start) <= _ALIKE * (1.0 + np.abs(start))).all())
        for size in _SIZES
    )
