"""One increment from the numbers that a finite-element program has: stiffness, pressure and parameters in, stress and tangent out.

Written as :mod:`duhem.projection.newton_kernel` is, and translated together with it (:mod:`duhem.export.source_files`); names without a
body stand for what is made for one law.  What is not shown to be optimal, and what is no question, leaves nan behind, so that an
answer without its status is none.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy import nan, sqrt

from duhem.projection.apex_kernel import apex
from duhem.projection.newton_kernel import LEFT, SLIP, STICK, solved
from duhem.projection.newton_step import (
    BEND,
    BEST,
    LENGTHS,
    MATRICES,
    NAMED,
    NATURAL,
    NORMALS,
    RAW,
    RAWBEND,
    ROWS,
    WHITE,
    D,
    U,
    X,
    eliminated,
    length,
    level,
    piece,
    resized,
    whitened,
)  # fmt: skip

__all__ = ["INVALID", "OUTSIDE", "UNKNOWN", "increment"]

KINKS = DATA = PARAMETERS = CONSTANTS = NUMBERS = CONDITIONS = 0  # how many the law has, of each
CLOSES = 0  # 1 where K is proved to be the point 0 at the pressure 0
QUARTERS = SHAPE = 0  # 1 if K is four quarter ellipses; where their coefficients and their load begin in what is stated
DEGREE = 1.0  # of g in the forces


def placed(q: Any, w: Any) -> None:
    """The fractions of the formula behind data and parameters in ``q``, those of the law's statements in ``w``."""
    raise NotImplementedError


def stated(q: Any, out: Any) -> None:
    """From pressure and parameters: the data of h, then 1 for each of the declared ranges and constraints that holds."""
    raise NotImplementedError


def on_grid(x: float, mx: float, y: float, my: float, e: float, seen: Any) -> None:
    """Formulas of :mod:`duhem.projection.quarter_ellipse` into ``seen``: p_1, l_1, p_2, l_2 and F."""
    raise NotImplementedError


def direction(px: float, py: float, ly: float, e: float, r: float, seen: Any) -> None:
    """w_1 and w_2."""
    raise NotImplementedError


def multiplier(f: float, wx: float, wy: float, e: float, r: float, seen: Any) -> None:
    """z = c_1 lambda."""
    raise NotImplementedError


def beyond(stress: Any, slack: float) -> bool:
    """Whether a stress lies outside a range that the law declares for it."""
    raise NotImplementedError


# -- compiled from here ----------------------------------------------------------------------------------------

INVALID, OUTSIDE, UNKNOWN = 3, 4, 5  # after STICK, SLIP and LEFT
ALIKE, ROUNDING = 8.881784197001252e-16, 1e-12  # four roundings; of a stress, as an end of a range may be where K ends too
WIDE, DIGITS = 2.0**200, 2.0**-20  # of ranges and of what plain doubles tell, as SAFE and NEAR are of the closed form
ASIDE, ARC, CLEAR, SEAM = 1e-6, 1e-3, 1e-2, 1e-5  # of the size of K; of a radius; of a bend; normals this close are those of a seam


def increment(trial: Any, pressure: float, stiffness: Any, parameters: Any, stress: Any, slip: Any, dissipation: Any, tangent: Any) -> int:
    """The stress of K nearest to the trial in the energy of the stiffness, with its derivative by the displacement."""
    v, m, a = np.empty((ROWS, D)), np.empty((MATRICES, D, D)), np.empty((2 * D, 2 * D + 1))
    root, inverse, k = np.empty((D, D)), np.empty((D, D)), np.empty((D, D))
    q, w, out = np.empty(DATA + PARAMETERS + CONSTANTS + 1), np.empty(1 + PARAMETERS + NUMBERS), np.empty(SHAPE + 5)
    held, data = np.empty((D + 1, KINKS + 1), np.int8), np.empty((1, DATA + 1))
    start, found, slips, multipliers, seen = np.empty((1, D)), np.empty((1, D)), np.empty((1, D)), np.empty(1), np.empty(5)
    sound = isfinite(pressure)
    w[0] = pressure
    for j in range(PARAMETERS):
        w[1 + j] = parameters[j]
        q[DATA + j] = parameters[j]
        sound = sound and isfinite(parameters[j])
    for i in range(D):  # all is read before anything is written: the places may be the same
        start[0, i] = trial[i]
        sound = sound and isfinite(trial[i])
        for j in range(D):
            k[i, j] = stiffness[i * D + j]
    nothing(stress, slip, dissipation, tangent)
    placed(q, w)
    stated(w, out)
    for j in range(CONDITIONS):
        sound = sound and out[DATA + j] == 1.0
    mean = whitening(k, root, inverse)
    if not (sound and mean > 0.0):
        return INVALID
    for j in range(DATA):
        data[0, j] = out[j]
    pointed = CLOSES == 1 and pressure == 0.0
    state = LEFT
    if QUARTERS == 1:
        state = on_quarters(start, k, data, out, v, m, q, held, found, slips, seen)
    straight = state != LEFT
    if straight:
        mean = 1.0
    elif pointed:
        state = ended(start, inverse, found, slips)
    else:
        state = solved(start, data, 0, DEGREE, v, m, a, q, held, root, inverse, found, slips, multipliers)
    if state == LEFT:
        return LEFT
    work, most, far = 0.0, 0.0, 0.0
    for i in range(D):
        slips[0, i] /= mean
        work += found[0, i] * slips[0, i]
        most, far = max(most, abs(found[0, i])), max(far, abs(start[0, i]))
    if not isfinite(work):
        return LEFT
    for i in range(D):
        stress[i], slip[i] = found[0, i], slips[0, i]
    dissipation[0] = work
    for i in range(D):
        for j in range(D):
            tangent[i * D + j] = seen[i] * seen[j] if straight and state == SLIP else 0.0 if pointed else k[i, j]
    if state == SLIP and not (straight or pointed):
        told = known(v, m, q, held, root) or apex(v, m, a, q, held, root, inverse) <= 0  # a tip on an axis of K seems smooth from there
        if not (told and slipping(v, m, a, root, mean, tangent)):
            state = UNKNOWN
            for i in range(D * D):
                tangent[i] = nan
    return OUTSIDE if beyond(stress, ROUNDING * most + ALIKE * far) else state


def on_quarters(
    start: Any, k: Any, data: Any, out: Any, v: Any, m: Any, q: Any, held: Any, found: Any, slips: Any, seen: Any
) -> int:  # fmt: skip
    """Find the closest point of four quarter ellipses under a diagonal stiffness; v v^T is d sigma/d u if ``seen`` has the vector v.

    LEFT where that takes more digits, a number is out of range, or the answer is not on the boundary and along its normal.
    """
    ma, mb, e = out[SHAPE + (1 if start[0, 0] < 0.0 else 0)], out[SHAPE + (3 if start[0, 1] < 0.0 else 2)], out[SHAPE + 4]
    ca, cb, far = ma * ma / k[0, 0], mb * mb / k[1, 1], abs(start[0, 0]) + abs(start[0, 1])
    usual = k[0, 1] == 0.0 and k[1, 0] == 0.0 and min(min(ma, mb), min(ca, cb)) > 1.0 / WIDE and max(max(ma, mb), max(ca, cb)) < WIDE
    if not (usual and 1.0 / WIDE < e < WIDE and far < WIDE):
        return LEFT
    i = 0 if ca <= cb else 1
    j = 1 - i
    mx, my, small, r = ma if i == 0 else mb, mb if i == 0 else ma, min(ca, cb), min(ca, cb) / max(ca, cb)
    on_grid(abs(start[0, i]), mx, abs(start[0, j]), my, e, seen)
    px, py, ly, f = seen[0], seen[2], seen[3], seen[4]
    resized(data, 0, 1.0, q)
    for b in range(D):
        found[0, b], slips[0, b], v[X, b] = start[0, b], 0.0, start[0, b]
    if not (abs(f) > DIGITS * e * e and abs(px - (1.0 - r) * e) > DIGITS * e):
        return LEFT
    if f < 0.0:
        return STICK if level(v, X, q) < 0.0 else LEFT
    direction(px, py, ly, e, r, seen)
    wx, wy = seen[0], seen[1]
    multiplier(f, wx, wy, e, r, seen)
    away = seen[0] * small
    wx, wy = wx if start[0, i] >= 0.0 else -wx, wy if start[0, j] >= 0.0 else -wy
    found[0, i], found[0, j] = mx * e * wx, my * e * wy
    slips[0, i], slips[0, j] = away * (wx / mx), away * (wy / my)
    whole = sqrt(mx * wy * (mx * wy) / k[i, i] + my * wx * (my * wx) / k[j, j] + away / e)
    seen[i], seen[j] = -mx * wy / whole, my * wx / whole
    for b in range(D):
        v[X, b] = found[0, b]
    high = piece(v, X, q, NATURAL, held, D, RAW, m, RAWBEND)
    steep, ab, ba = abs(v[RAW, 0] * v[X, 0]) + abs(v[RAW, 1] * v[X, 1]), v[RAW, 0] * slips[0, 1], v[RAW, 1] * slips[0, 0]
    fine = abs(high) <= ROUNDING * steep and abs(ab - ba) <= ROUNDING * (abs(ab) + abs(ba))
    return SLIP if fine and v[RAW, 0] * slips[0, 0] >= 0.0 and v[RAW, 1] * slips[0, 1] >= 0.0 else LEFT


def ended(start: Any, inverse: Any, found: Any, slips: Any) -> int:
    """Everything slips but the origin; the slip is that of a stiffness of mean 1."""
    state = STICK
    for i in range(D):
        found[0, i], slips[0, i] = 0.0, 0.0
        if start[0, i] != 0.0:
            state = SLIP
    for b in range(D):
        along = 0.0
        for i in range(D):
            along += inverse[b, i] * start[0, i]
        for i in range(D):
            slips[0, i] += inverse[b, i] * along
    return state


def nothing(stress: Any, slip: Any, dissipation: Any, tangent: Any) -> None:
    """No answer yet."""
    dissipation[0] = nan
    for i in range(D):
        stress[i], slip[i] = nan, nan
        for j in range(D):
            tangent[i * D + j] = nan


def whitening(k: Any, root: Any, inverse: Any) -> float:
    """kappa, the mean eigenvalue of k = kappa L L^T, with L and its inverse; 0 where k is not symmetric and positive definite."""
    mean = 0.0
    for i in range(D):
        mean += k[i, i] / D
    if not isfinite(mean):
        return 0.0
    for i in range(D):
        for j in range(i):
            if not abs(k[i, j] - k[j, i]) <= ALIKE * sqrt(k[i, i]) * sqrt(k[j, j]):
                return 0.0
            k[j, i] = k[i, j]
        for j in range(i + 1):
            left = k[i, j] / mean
            for b in range(j):
                left -= root[i, b] * root[j, b]
            if i == j and not (left > 0.0 and isfinite(left)):
                return 0.0
            root[i, j] = sqrt(left) if i == j else left / root[j, j]
            root[j, i] = root[i, j] if i == j else 0.0
    for j in range(D):
        for i in range(D):
            left = 1.0 if i == j else 0.0
            for b in range(j, i):
                left -= root[i, b] * inverse[b, j]
            inverse[i, j] = left / root[i, i] if i >= j else 0.0
    return mean


def slipping(v: Any, m: Any, a: Any, root: Any, mean: float, tangent: Any) -> bool:
    """d sigma/d u in the directions that the pressing normals leave free (Simo and Taylor 1985), symmetric; False where there is none."""
    free, found = np.empty((D, D)), np.empty((D, D))
    count = completed(v, m, free)
    size = D - count
    for i in range(D):
        for j in range(D):
            found[i, j] = 0.0
    for c in range(size):
        for r in range(size):
            a[r, size] = 1.0 if r == c else 0.0
            for b in range(size):
                a[r, b] = 1.0 if r == b else 0.0
                for i in range(D):
                    for j in range(D):
                        a[r, b] += free[count + r, i] * m[BEND, i, j] * free[count + b, j]
        if not eliminated(a, size):
            return False
        for i in range(D):
            for j in range(D):
                for r in range(size):
                    found[i, j] += free[count + c, i] * a[r, size] * free[count + r, j]
    for i in range(D):
        for j in range(D):
            total = 0.0
            for b in range(D):
                for c in range(D):
                    total += root[i, b] * (0.5 * found[b, c] + 0.5 * found[c, b]) * root[j, c]
            tangent[i * D + j] = mean * total
    return True


def known(v: Any, m: Any, q: Any, held: Any, root: Any) -> bool:
    """Whether the stress moves as the pieces that press say, which hold beside it then and bend as their Hessians do.

    At the tip of a pyramid more pieces may meet than press, and where a root within the formula is 0 its second derivatives are none.
    In a direction that the normals leave free, either is seen both ways; on a seam between two curvatures, one way alone.
    """
    free, load = np.empty((D, D)), 0.0
    count = completed(v, m, free)
    for j in range(D):
        load += v[LENGTHS, j]
    for r in range(count, D):
        bend, step = 0.0, ASIDE * (1.0 + length(v, U))
        for i in range(D):
            for k in range(D):
                bend += free[r, i] * m[BEND, i, k] * free[r, k]
        if abs(bend) * step > ARC * load:
            step = ARC * load / abs(bend)
        if not (fits(v, m, q, held, root, free, count, r, step) or fits(v, m, q, held, root, free, count, r, -step)):
            return False
    return True


def fits(v: Any, m: Any, q: Any, held: Any, root: Any, free: Any, count: int, r: int, step: float) -> bool:
    """Whether, one step along row ``r`` of ``free``, the normals that press have turned as they should, and the one there is theirs."""
    there, turned, load, closest = np.empty(D), np.empty(D), 0.0, 2.0
    for i in range(D):
        v[BEST, i] = v[X, i]
        for k in range(D):
            v[BEST, i] += root[i, k] * free[r, k] * step
        turned[i] = 0.0
    piece(v, BEST, q, NATURAL, held, D, RAW, m, RAWBEND)
    slope = whitened(v, root)
    for i in range(D):
        there[i] = v[WHITE, i] / slope
    for j in range(D):
        c = v[LENGTHS, j]
        if c > 0.0:
            load += c
            piece(v, BEST, q, NAMED, held, j, RAW, m, RAWBEND)
            slope = whitened(v, root)
            apart = 0.0
            for b in range(count, D):
                own, other = 0.0, 0.0
                for i in range(D):
                    own += free[b, i] * (v[WHITE, i] / slope - m[NORMALS, j, i])
                    other += free[b, i] * (there[i] - v[WHITE, i] / slope)
                turned[b] += c * own
                apart += other * other
            closest = min(closest, sqrt(apart))
    off, most = 0.0, 1.0
    for b in range(count, D):
        bend = 0.0
        for i in range(D):
            for k in range(D):
                bend += free[b, i] * m[BEND, i, k] * free[r, k]
        wrong = turned[b] / step - bend
        off += wrong * wrong
        most = max(most, abs(bend))
    return closest <= SEAM and sqrt(off) + load * closest / abs(step) <= CLEAR * most


def completed(v: Any, m: Any, free: Any) -> int:
    """How many normals press; they and what is free of them are the rows of an orthonormal ``free``."""
    count = 0
    for j in range(D):
        if v[LENGTHS, j] > 0.0:
            for i in range(D):
                free[count, i] = m[NORMALS, j, i]
            straightened(free, count)
            count += 1
    for r in range(count, D):
        best, most = 0, -1.0
        for axis in range(D):
            left = 1.0
            for b in range(r):
                left -= free[b, axis] * free[b, axis]
            if left > most:
                best, most = axis, left
        for i in range(D):
            free[r, i] = 1.0 if i == best else 0.0
        straightened(free, r)
    return count


def straightened(free: Any, row: int) -> None:
    """A row, orthogonal to those before and of length 1; twice, against rounding."""
    for _ in range(2):
        for b in range(row):
            along = 0.0
            for i in range(D):
                along += free[b, i] * free[row, i]
            for i in range(D):
                free[row, i] -= along * free[b, i]
        size = 0.0
        for i in range(D):
            size += free[row, i] * free[row, i]
        for i in range(D):
            free[row, i] /= sqrt(size)
