"""Directions along which K does not end, in either sense: the pressure axis of a metal, for one.

Along them the projection keeps the trial stress, and taking them out first keeps the digits that a large pressure part
would cost.  They are found numerically, as the directions orthogonal to every gradient of a sample; whoever uses them
checks the result on the formula itself.
"""

from __future__ import annotations

import numpy as np

from duhem.projection.body import Body
from duhem.projection.result import Array

__all__ = ["lineality"]

_SAMPLES = 64
_ALIKE = 1e-9


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
    return np.asarray(directions[values <= _ALIKE * values[0]].T)
