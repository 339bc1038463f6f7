"""Slips next to a corner of K: the closest point of the half-spaces that its pieces give, found one after the other.

A piece of g that is violated at the closest point so far cuts it off; the closest point of all the half-spaces found comes next
(J. E. Kelley, 1960, The cutting-plane method for solving convex programs).  Where K is a polyhedron each piece is met once.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from duhem.expression.pairs import Pair, added
from duhem.projection.close_look import CloseLook, pushed_back
from duhem.projection.result import Array

__all__ = ["slip_over_pieces"]

_PIECES = 6
_ASIDE = 1e-10  # of how far g is violated: slopes are taken this far aside, where no two pieces tie
_LEFT = 1e-12  # of the first violation: less is none


def slip_over_pieces(look: CloseLook, trial: Array, pressure: float, stiffness: Array, size: float) -> tuple[Array, float]:
    """The slip (d,) of one trial (d,) and its multiplier, that of h, R = ``size``; nan where no half-spaces have it."""
    d = len(trial)
    at, pressures = np.array([size]), np.array([pressure])
    normals, heights = np.empty((0, d)), np.empty(0)
    slip, multiplier, least = np.zeros(d), 0.0, np.inf
    for _ in range(_PIECES):
        end = pushed_back(trial[None], slip[None], stiffness, at)
        beyond = float(look.level(end, pressures, at)[0][0])
        least = min(least, _LEFT * abs(beyond))
        if not beyond > least:
            break
        step = _ASIDE * beyond * np.cos(1.0 + np.arange(d))  # along no plane that a formula is likely to hold
        there = [added(x, Pair(np.array([y]), np.zeros(1))) for x, y in zip(end, step, strict=True)]
        normal = look.slopes(there, pressures, at)[0]
        height = (float(look.level(there, pressures, at)[0][0]) - float(normal @ step)) * size + float(normal @ stiffness @ slip)
        normals, heights = np.vstack([normals, normal]), np.append(heights, height)
        weights = _weights(normals @ stiffness @ normals.T, heights)
        slip, multiplier = weights @ normals, float(weights.sum())
    return slip, multiplier


def _weights(gram: Array, heights: Array) -> Array:
    """w >= 0 (M,) with gram w >= heights, and equality where w > 0: what half-spaces push back; nan where there are none."""
    many = len(heights)
    if not (np.isfinite(gram).all() and np.isfinite(heights).all()):
        return np.full(many, np.nan)
    slack = _LEFT * float(np.abs(heights).max())
    for count in range(1, many + 1):
        for chosen in combinations(range(many), count):
            some = list(chosen)
            weights = np.zeros(many)
            weights[some] = np.linalg.lstsq(gram[np.ix_(some, some)], heights[some], rcond=None)[0]
            if (weights >= 0.0).all() and (gram @ weights >= heights - slack).all():
                return weights
    return np.full(many, np.nan)
