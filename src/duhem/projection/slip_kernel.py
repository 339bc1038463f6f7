"""One slip at a time: whether it is along a normal that K has at its stress, and whether a known point of K speaks against it.

As :func:`duhem.projection.normal_cones.off_cone` and the judge say it, with a margin: what is too close to call is left to them.
Compiled with :mod:`duhem.projection.judge_kernel`, whose rows of ``v`` are used.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy import sqrt

from duhem.projection.newton_step import below, eliminated, length

__all__ = ["CORNER", "cornered", "edged", "excess", "raised"]

D = PAIRS = 0  # how many forces the law has, and how many eigenvalues that may be double


def level(v: Any, x: int, q: Any) -> float:
    """h at row ``x`` of ``v``."""
    raise NotImplementedError


def gradient(v: Any, x: int, q: Any, slopes: int) -> None:
    """dh/ds there into the row ``slopes``."""
    raise NotImplementedError


def pair_piece(v: Any, x: int, q: Any, natural: int, c: int, slopes: int) -> float:
    """h at row ``x`` with a piece of a pair in the place of an eigenvalue, and its gradient into the row ``slopes``."""
    raise NotImplementedError


def sized(data: Any, size: float) -> Any:
    """The data in units of another size."""
    raise NotImplementedError


# -- compiled from here ----------------------------------------------------------------------------------------

# -- where pieces of K meet: for one length of boundary and where the corner has few sides ------------------------------

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


# -- where two eigenvalues are equal ------------------------------------------------------------------------------------
# Such an edge is round: its normals are sums of those of three pieces (:func:`duhem.projection.newton_kernel.spread`), by multipliers that
# make a positive semidefinite matrix of two rows, and no few of them say where the others are.

FIRST_PAIR = 2


def edged(v: Any, a: Any, q: Any, of_slip: Any, multiplier: float, size: float, distance: float, room: float, good: float) -> float:
    """As :func:`cornered` says it of a corner, of an edge where two eigenvalues are equal."""
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


# -- known points of K, at its ends or close to the stress --------------------------------------------------------------

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
