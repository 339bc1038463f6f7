"""One point at a time: whether a slip lies in the cone of the normals of K close to its stress, where pieces of K meet.

As :func:`duhem.projection.normal_cones.off_cone` says it, for one length of boundary and where the corner has few sides.
Compiled with :mod:`duhem.projection.judge_kernel`.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy import sqrt

from duhem.projection.newton_step import eliminated, length

__all__ = ["CORNER", "cornered"]

D = 0  # how many forces the law has


def level(v: Any, x: int, q: Any) -> float:
    """h at row ``x`` of ``v``."""
    raise NotImplementedError


def gradient(v: Any, x: int, q: Any, slopes: int) -> None:
    """dh/ds there into the row ``slopes``."""
    raise NotImplementedError


# -- compiled from here ----------------------------------------------------------------------------------------

MOST = 6  # sides of a corner
CORNER = 2 * MOST  # rows of a: unit normals, lengths of their gradients, heights of their sides over the stress; then room for equations
BESIDE, ALIKE, CLOSE, OPPOSED = 1e-13, 1e-12, 2.0, -0.8
AT, K_SLIP, ON, RAW, FALL, NORMAL_ROW = 0, 4, 6, 7, 8, 9  # rows of v, as the judge has them: stress, k slip, and four that are free


def cornered(
    v: Any, a: Any, q: Any, beside: Any, of_slip: Any, to_stress: Any, multiplier: float, size: float, distance: float, room: float,
    good: float,
) -> float:  # fmt: skip
    """Distance of the slip from the cone, and of the multiplier from its own, relative; inf where it is not for a filter to say.

    ``size`` is that of lengths in units of the level; ``distance`` and ``room`` the lengths of slip and stress.
    """
    if not 2.0 * BESIDE * room <= good * distance:
        return np.inf
    count = sides(v, a, q, beside, of_slip, to_stress, size, room)
    best = np.inf
    for chosen in range(1, 1 << count):
        meet = solved(v, a, count, chosen, False)  # where the sides meet, which may be far off at a sharp corner
        if 2.0 * meet * room <= good * distance and isfinite(solved(v, a, count, chosen, True)):
            rest, total = left_over(v, a, count, chosen)
            amount = abs(total / multiplier - 1.0)
            if 2.0 * rest <= good * distance and 2.0 * amount <= good:
                best = min(best, max(rest / room, amount, meet, BESIDE))
    return best


def sides(v: Any, a: Any, q: Any, beside: Any, of_slip: Any, to_stress: Any, size: float, room: float) -> int:
    """How many different normals K has around the stress; 0 if too many, or nearly opposed."""
    count = 0
    for w in range(beside.shape[0]):
        far = 0.0
        for i in range(D):
            far += beside[w, i] * beside[w, i]
            v[ON, i] = v[AT, i]
            for k in range(D):
                v[ON, i] += BESIDE * room * beside[w, k] * to_stress[k, i] * size
        high = level(v, ON, q)
        steep = normal_at(v, q, of_slip)
        fall = high / steep / size
        if not (steep > 0.0 and abs(fall) <= CLOSE * BESIDE * room * sqrt(far)):
            continue
        for i in range(D):
            v[FALL, i] = v[NORMAL_ROW, i]
            for k in range(D):
                v[ON, i] -= fall * v[NORMAL_ROW, k] * to_stress[k, i] * size
        steep = normal_at(v, q, of_slip)
        if not steep > 0.0:
            continue
        least, most = products(v, a, count)
        if most >= 1.0 - ALIKE:
            continue
        if count == MOST or least < OPPOSED:  # K may be thin
            return 0
        for i in range(D):
            a[count, i] = v[NORMAL_ROW, i]
        a[count, D], a[count, D + 1] = steep, 0.0
        for k in range(D):
            a[count, D + 1] += v[NORMAL_ROW, k] * (BESIDE * beside[w, k] - fall / room * v[FALL, k])
        count += 1
    return count


def normal_at(v: Any, q: Any, of_slip: Any) -> float:
    """The unit normal in the metric, and the length of the gradient in it."""
    gradient(v, ON, q, RAW)
    for i in range(D):
        v[NORMAL_ROW, i] = 0.0
        for k in range(D):
            v[NORMAL_ROW, i] += v[RAW, k] * of_slip[k, i]
    steep = length(v, NORMAL_ROW)
    for i in range(D):
        v[NORMAL_ROW, i] /= steep
    return steep


def products(v: Any, a: Any, count: int) -> tuple[float, float]:
    """The least and the largest product of the normal with those there are."""
    least, most = 1.0, -1.0
    for j in range(count):
        along = 0.0
        for i in range(D):
            along += a[j, i] * v[NORMAL_ROW, i]
        least, most = min(least, along), max(most, along)
    return least, most


def solved(v: Any, a: Any, count: int, chosen: int, slip: bool) -> float:
    """The weights of the chosen normals with whose sum each of them has the product that it has with k slip, or else the height of
    its side; the length of that sum, inf where there is none."""
    size = 0
    for j in range(count):
        size += (chosen >> j) & 1
    if size > D:
        return np.inf
    row = MOST
    for j in range(count):
        if (chosen >> j) & 1:
            a[row, size] = 0.0 if slip else a[j, D + 1]
            for i in range(D):
                a[row, size] += a[j, i] * v[K_SLIP, i] if slip else 0.0
            column = 0
            for k in range(count):
                if (chosen >> k) & 1:
                    a[row, column] = 0.0
                    for i in range(D):
                        a[row, column] += a[j, i] * a[k, i]
                    column += 1
            row += 1
    if not eliminated(from_row(a, MOST), size):
        return np.inf
    total = 0.0
    for i in range(D):
        one, row = 0.0, MOST
        for j in range(count):
            if (chosen >> j) & 1:
                one += a[row, size] * a[j, i]
                row += 1
        total += one * one
    return float(sqrt(total))


def left_over(v: Any, a: Any, count: int, chosen: int) -> tuple[float, float]:
    """What the weights that were solved for, none of them negative, leave of k slip, and the multiplier they make."""
    size = 0
    for j in range(count):
        size += (chosen >> j) & 1
    total, rest, row = 0.0, 0.0, MOST
    for j in range(count):
        if (chosen >> j) & 1:
            a[row, size] = max(a[row, size], 0.0)
            total += a[row, size] / a[j, D]
            row += 1
    for i in range(D):
        one, row = v[K_SLIP, i], MOST
        for j in range(count):
            if (chosen >> j) & 1:
                one -= a[row, size] * a[j, i]
                row += 1
        rest += one * one
    return float(sqrt(rest)), total


def from_row(a: Any, first: int) -> Any:
    """The rows of ``a`` from the first one on."""
    return a[first:]
