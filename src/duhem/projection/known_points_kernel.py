"""One point at a time: whether a known point of K speaks against a slip, at the ends of K or close to the stress.

As :mod:`duhem.projection.known_points` and the judge say it, with a margin: what is too close to call is left to them.
Compiled with :mod:`duhem.projection.judge_kernel`, whose rows of ``v`` are used.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy import sqrt

from duhem.projection.newton_step import below

__all__ = ["excess", "raised"]

D = 0  # how many forces the law has


def level(v: Any, x: int, q: Any) -> float:
    """h at row ``x`` of ``v``."""
    raise NotImplementedError


def sized(data: Any, size: float) -> Any:
    """The data in units of another size."""
    raise NotImplementedError


# -- compiled from here ----------------------------------------------------------------------------------------

RAISE, ASIDE = 4e-7, (0.3, 0.03, 0.003)  # as of known points beside a stress
CLEAR = 1e-6  # a level above this is that of a point outside K
DOUBTFUL = 0.5e-7  # of more than this it has to be so clear
SPOT, SENSE, PLUMB, BESIDE_IT = 6, 7, 8, 9  # rows of v: a known point; a way across the slip, the slip's direction; the stress aside


def excess(
    v: Any, point: int, moved: int, part: float, tips: Any, ways: Any, reaches: Any, data: Any, constants: Any, per: float, whole: float,
    room: float,
) -> float:  # fmt: skip
    """The largest (sigma_tr - sigma) . k^-1 (tau - sigma) over the known points tau that lie in K at this pressure, relative."""
    worst = work = 0.0
    for i in range(D):
        work += v[point, i] * v[moved, i]
    for j in range(tips.shape[0]):
        away = part * (reaches[j] * per)
        along = 0.0
        for i in range(D):
            along += v[moved, i] * ways[j, i]
        over = away * along - work
        if over > 0.0:
            relative = over / (whole * (away + room))
            if relative > worst:
                big = 0.0
                for i in range(D):
                    big = max(big, abs(part * tips[j, i]))
                if not isfinite(big):
                    return np.inf
                unit = below(big) if big > 0.0 else 1.0
                for i in range(D):
                    v[SPOT, i] = part * tips[j, i] / unit
                high = level(v, SPOT, sized(data, unit) + constants)
                if not high > 0.0 or (relative > DOUBTFUL and not high > CLEAR):  # near the boundary: not for a filter to say
                    worst = relative
    return worst


def raised(v: Any, point: int, moved: int, data: Any, constants: Any, to_stress: Any, size: float, distance: float, room: float) -> bool:
    """Whether K goes beyond the plane through the stress across the slip, somewhere close to it, or may."""
    for i in range(D):
        v[PLUMB, i] = v[moved, i] / distance
    for axis in range(D if D > 2 else D - 1):
        across = 0.0
        for i in range(D):
            v[SENSE, i] = (1.0 if i == axis else 0.0) - v[PLUMB, axis] * v[PLUMB, i]
            if D == 2:
                v[SENSE, i] = v[PLUMB, 0] if i == 1 else -v[PLUMB, 1]
            across += v[SENSE, i] * v[SENSE, i]
        across = sqrt(across) if across > 0.0 else 1.0
        for sense in (-1.0, 1.0):
            for share in ASIDE:
                big = 0.0
                for i in range(D):
                    v[BESIDE_IT, i] = v[point, i] + share * room * sense * v[SENSE, i] / across + RAISE * room * v[PLUMB, i]
                for i in range(D):
                    one = 0.0
                    for k in range(D):
                        one += v[BESIDE_IT, k] * to_stress[k, i]
                    v[SPOT, i] = size * one
                    big = max(big, abs(v[SPOT, i]))
                if not (isfinite(big) and big > 0.0):
                    return True
                unit = below(big)
                for i in range(D):
                    v[SPOT, i] /= unit
                if not level(v, SPOT, sized(data, unit) + constants) > 0.0:
                    return True
    return False
