"""One point at a time: whether a slip is a normal of K at an edge where two eigenvalues are equal.

Such an edge is round: its normals are sums of those of three pieces (:mod:`duhem.projection.newton_pair`), by multipliers that make a
positive semidefinite matrix of two rows, and no few of them say where the others are.  Compiled with
:mod:`duhem.projection.judge_kernel`; as Python runs it for :mod:`duhem.projection.edge_normals`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy import sqrt

from duhem.projection.corner_kernel import AT, K_SLIP, MOST, NORMAL_ROW, RAW, solved
from duhem.projection.newton_step import length

__all__ = ["edged"]

D = PAIRS = 0  # how many forces the law has, and how many eigenvalues that may be double


def pair_piece(v: Any, x: int, q: Any, natural: int, c: int, slopes: int) -> float:
    """h at row ``x`` with a piece of a pair in the place of an eigenvalue, and its gradient into the row ``slopes``."""
    raise NotImplementedError


# -- compiled from here ----------------------------------------------------------------------------------------

FIRST_PAIR = 2


def edged(v: Any, a: Any, q: Any, of_slip: Any, multiplier: float, size: float, distance: float, room: float, good: float) -> float:
    """As :func:`cornered` says it of a corner."""
    best = np.inf
    for k in range(PAIRS):
        meet = 0.0
        for c in range(3):
            high = pair_piece(v, AT, q, FIRST_PAIR + k, c, RAW)
            for i in range(D):
                v[NORMAL_ROW, i] = 0.0
                for j in range(D):
                    v[NORMAL_ROW, i] += v[RAW, j] * of_slip[j, i]
            steep = length(v, NORMAL_ROW)
            if not steep > 0.0:
                return np.inf
            for i in range(D):
                a[c, i] = v[NORMAL_ROW, i] / steep
            a[c, D] = steep
            meet = max(meet, abs(high) / steep / size / room)
        if not (2.0 * meet * room <= good * distance and solved(v, a, 3, 7, True) < np.inf):
            continue
        mixed, total, rest = 0.5 * a[MOST + 2, 3] / a[2, D], 0.0, 0.0
        for c in range(3):
            total += a[MOST + c, 3] / a[c, D]
        first, second = a[MOST, 3] / a[0, D] + mixed, a[MOST + 1, 3] / a[1, D] + mixed
        if not (first >= 0.0 and second >= 0.0 and first * second >= mixed * mixed):
            continue
        for i in range(D):
            one = v[K_SLIP, i] - a[MOST, 3] * a[0, i] - a[MOST + 1, 3] * a[1, i] - a[MOST + 2, 3] * a[2, i]
            rest += one * one
        rest, amount = sqrt(rest), abs(total / multiplier - 1.0)
        if 2.0 * rest <= good * distance and 2.0 * amount <= good:
            best = min(best, max(max(rest / room, amount), meet))
    return best
