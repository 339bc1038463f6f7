"""Newton's method at one point, in small arrays: the equations of its steps, and where it begins.

``v`` holds vectors by rows and ``m`` matrices, each in its place; ``a`` is room for equations.  Compiled with
:mod:`duhem.projection.newton_kernel`; names without a body are those of one law.
"""

from __future__ import annotations

from math import floor, frexp, isfinite, ldexp
from typing import Any

import numpy as np
from numpy import sqrt

__all__ = [
    "BEND", "BEST", "CENTRE", "FIRST", "LENGTHS", "LEVELS", "MATRICES", "NAMED", "NATURAL", "NORMALS", "PAIR", "RAW", "RAWBEND", "REST",
    "ROWS", "SLOPES", "STEP", "WHITE", "D", "S", "T", "U", "X", "askew", "begun", "below", "bent", "directed", "eliminated", "gram",
    "grown", "length", "shared", "times", "turn", "whitened",
]  # fmt: skip

D = DATA = 0  # how many forces the law has, and how many data


def level(v: Any, x: int, q: Any) -> float:
    """h at row ``x`` of ``v``."""
    raise NotImplementedError


def piece(v: Any, x: int, q: Any, natural: int, choices: Any, c: int, slopes: int, m: Any, bends: int) -> float:
    """h there on a smooth piece, with derivatives: one ``NAMED`` by the row ``c`` of ``choices``, the ``NATURAL`` one, or of a ``PAIR``."""
    raise NotImplementedError


def resized(data: Any, n: int, size: float, q: Any) -> None:
    """The data of point ``n`` in units of another size."""
    raise NotImplementedError


# -- compiled from here ----------------------------------------------------------------------------------------

# Rows of v: trial, whitened trial, where the search begins, stress, whitened stress, the best stress, the rest of the way, Newton's
# step, a gradient and its whitened one; lengths of the gradients, levels and multipliers of the pieces; a point inside K.
T, S, FIRST, X, U, BEST, REST, STEP, RAW, WHITE, SLOPES, LEVELS, LENGTHS, CENTRE, ROWS = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14
NORMALS, BEND, RAWBEND, MATRICES = 0, 1, 2, 2 + D  # matrices of m: normals by rows, the sum of the bends, a Hessian a piece


def bent(m: Any, own: int, root: Any, factor: float) -> None:
    """Adds the Hessian ``own``, whitened, to the bends."""
    for i in range(D):
        for k in range(i + 1):
            total = 0.0
            for b in range(D):
                if root[b, i] != 0.0:
                    for c in range(D):
                        total += root[b, i] * m[own, b, c] * root[c, k]
            m[BEND, i, k] += total * factor
            m[BEND, k, i] = m[BEND, i, k]


def turn(v: Any, m: Any, count: int) -> float:
    """The length of the rest of the way without what the normals carry."""
    total = 0.0
    for i in range(D):
        pull = v[REST, i]
        for j in range(count):
            pull -= v[LENGTHS, j] * m[NORMALS, j, i]
        total += pull * pull
    return float(sqrt(total))


def directed(v: Any, m: Any, a: Any, count: int, root: Any) -> bool:
    """Newton's step; False where its equations have no solution."""
    if not (bordered(v, m, a, count) or general(v, m, a, count)):
        return False
    size = D + count
    for i in range(D):
        v[STEP, i] = 0.0
        for k in range(D):
            v[STEP, i] += root[i, k] * a[k, size]
    return True


def general(v: Any, m: Any, a: Any, count: int) -> bool:
    """All equations at once; the step in the last column of ``a``."""
    size, away = D + count, 1.0 + length(v, REST)
    for i in range(D):
        a[i, size] = v[REST, i]
        for j in range(count):
            a[i, size] -= v[LENGTHS, j] * m[NORMALS, j, i]
            a[i, D + j] = m[NORMALS, j, i] * away
            a[D + j, i] = m[NORMALS, j, i]
        for k in range(D):
            a[i, k] = m[BEND, i, k] + (1.0 if i == k else 0.0)
    for j in range(count):
        a[D + j, size] = -v[LEVELS, j]
        for k in range(count):
            a[D + j, D + k] = -1e-14 if j == k else 0.0
    return eliminated(a, size)


def bordered(v: Any, m: Any, a: Any, count: int) -> bool:
    """The same for one piece whose bends and the identity add up to a positive definite matrix L E L^T, with fewer divisions."""
    if count > 1:
        return False
    rest, own = D + 1, D  # columns: the rest of the way, then the normal, both through the inverse of the matrix
    for i in range(D):  # L below the diagonal, 1/E on it, E L^T above
        deep = 1.0 + m[BEND, i, i]
        for k in range(i):
            full = m[BEND, i, k]
            for b in range(k):
                full -= a[i, b] * a[b, k]
            a[k, i], a[i, k] = full, full * a[k, k]
            deep -= full * a[i, k]
        if not deep > 0.0:
            return False
        a[i, i] = 1.0 / deep
        a[i, own], a[i, rest] = m[NORMALS, 0, i], v[REST, i] - v[LENGTHS, 0] * m[NORMALS, 0, i]
        for k in range(i):
            a[i, own] -= a[i, k] * a[k, own]
            a[i, rest] -= a[i, k] * a[k, rest]
    along, across = v[LEVELS, 0], 0.0
    for i in range(D - 1, -1, -1):
        a[i, own] *= a[i, i]
        a[i, rest] *= a[i, i]
        for k in range(i + 1, D):
            a[i, own] -= a[k, i] * a[k, own]
            a[i, rest] -= a[k, i] * a[k, rest]
        along += m[NORMALS, 0, i] * a[i, rest]
        across += m[NORMALS, 0, i] * a[i, own]
    for i in range(D):
        a[i, rest] -= a[i, own] * (along / across)
    return across > 0.0


def shared(v: Any, m: Any, a: Any, count: int) -> bool:
    """The multipliers that leave the least rest; False where the normals depend on each other."""
    gram(v, m, a, REST, count)
    if count == 1:
        v[LENGTHS, 0] = a[0, 1]  # of a unit normal
        return isfinite(a[0, 1])
    if not eliminated(a, count):
        return False
    for j in range(count):
        v[LENGTHS, j] = a[j, count]
    return True


def gram(v: Any, m: Any, a: Any, row: int, count: int) -> None:
    """The products of the first ``count`` normals with each other; those with a row of ``v`` in the last column."""
    for j in range(count):
        a[j, count] = 0.0
        for i in range(D):
            a[j, count] += m[NORMALS, j, i] * v[row, i]
        for k in range(count):
            a[j, k] = 0.0
            for i in range(D):
                a[j, k] += m[NORMALS, j, i] * m[NORMALS, k, i]


def eliminated(a: Any, size: int) -> bool:
    """Gauss with pivots by rows of one size; the solution in the last column; False where there is none in doubles."""
    for i in range(size):
        widest = 0.0
        for k in range(size):
            widest = max(widest, abs(a[i, k]))
        if not (widest > 0.0 and isfinite(widest)):
            return False
        for k in range(size + 1):
            a[i, k] /= widest
    for i in range(size):
        pivot = i
        for k in range(i + 1, size):
            if abs(a[k, i]) > abs(a[pivot, i]):
                pivot = k
        if not abs(a[pivot, i]) > 1e-15:
            return False
        if pivot != i:
            for k in range(i, size + 1):
                a[i, k], a[pivot, k] = a[pivot, k], a[i, k]
        for r in range(i + 1, size):
            share = a[r, i] / a[i, i]
            for k in range(i, size + 1):
                a[r, k] -= share * a[i, k]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            a[i, size] -= a[i, k] * a[k, size]
        a[i, size] /= a[i, i]
        if not isfinite(a[i, size]):
            return False
    return True


def whitened(v: Any, root: Any) -> float:
    """The length of the gradient in whitened units, and there it itself; nan where that is beyond doubles."""
    total = 0.0
    for i in range(D):
        v[WHITE, i] = 0.0
        for k in range(D):
            v[WHITE, i] += v[RAW, k] * root[k, i]
        total += v[WHITE, i] * v[WHITE, i]
    return float(sqrt(total)) if total < np.inf else np.nan


def times(matrix: Any, v: Any, vector: int, out: int) -> None:
    for i in range(D):
        v[out, i] = 0.0
        for k in range(D):
            v[out, i] += matrix[i, k] * v[vector, k]


def length(v: Any, row: int) -> float:
    total = 0.0
    for i in range(D):
        total += v[row, i] * v[row, i]
    return float(sqrt(total))


def below(size: float) -> float:
    """The power of two below, 2^-1022 at least: without a call, by the bits of the exponent."""
    bits = np.float64(max(size, 2.0**-1022)).view(np.int64)
    return float(np.int64(bits & 0x7FF0000000000000).view(np.float64))


def grown(number: float, size: float, power: float) -> float:
    """number size^power for a power of two, right where that is a double and size^power is none."""
    exponent = power * (frexp(size)[1] - 1)
    whole = floor(exponent)
    return ldexp(number * 2.0 ** (exponent - whole), int(whole))


# -- where the search at one point begins: a point inside K, and where the way from it to the trial leaves K -------------

NAMED, NATURAL, PAIR = 0, 1, 2  # which piece is followed; the pair of the second eigenvalue of the formula is 3
BRACKETS, START = 200, 1e-1  # how often and how closely the way to the trial is cut, relative
NEAR = 2.0**-40  # of the way: where the origin has no value, K is looked for this close to it
THIN = 2.0**-6  # of the way: where so little of it is in K beside the origin, K is met better from elsewhere
WALK, BESIDE = 100, 1e-2  # steps from the trial to K; so close, relative, is there
BETWEEN = 2.0**-20  # of the trial: where it has no value, K is looked for on both sides of it
DEPTHS = 24  # from four trials' lengths down, each a quarter of the one before


def begun(trial: Any, data: Any, n: int, v: Any, m: Any, q: Any, held: Any) -> float:
    """The size of K on the way to the trial, with both, centre and ends of a stretch over the boundary in this unit.

    0 for a stick, -1 if unclear.
    """
    big = 0.0
    for i in range(D):
        big = max(big, abs(trial[n, i]))
        if not isfinite(trial[n, i]):
            return -1.0
    size = below(big) if big > 0.0 else 1.0
    for i in range(D):
        v[T, i] = trial[n, i] / size
    resized(data, n, size, q)
    for k in range(DATA):
        if not isfinite(q[k]):
            return -1.0
    out = level(v, T, q)
    if out <= 0.0 or (not out > 0.0 and between(v, q)):
        return 0.0
    deep = centred(v, m, q, held)
    if not deep < 0.0:
        return -1.0
    share, near = crossed(v, q, deep, out, T, START), 0.0
    if share < THIN and 0.0 < length(v, CENTRE) <= NEAR * length(v, T):
        better = walked(v, m, q, held)
        share = crossed(v, q, better if better < 0.0 else deep, out, T, START)
    for i in range(D):
        v[FIRST, i] = v[CENTRE, i] + share * (v[T, i] - v[CENTRE, i])
        near = max(near, max(abs(v[FIRST, i]), abs(v[CENTRE, i])))
    if not near > 0.0:
        return -1.0
    grown = below(near)
    resized(data, n, size * grown, q)
    for i in range(D):
        v[T, i] /= grown
        v[FIRST, i] /= grown
        v[CENTRE, i] /= grown
        v[U, i] /= grown
    return size * grown


def between(v: Any, q: Any) -> bool:
    """Whether the trial lies between two points of a convex K."""
    for way in range(2):
        for i in range(D):
            v[BEST, i] = v[T, i] + (BETWEEN if way == 0 else -BETWEEN) * askew(i)
        if not level(v, BEST, q) <= 0.0:
            return False
    return True


def askew(i: int) -> float:
    """A component of a direction off all symmetries."""
    return (1.0 if i % 2 == 0 else -1.0) / (1.5 + i * i)


def centred(v: Any, m: Any, q: Any, held: Any) -> float:
    """The level at an inner point of K, noted as its centre: the origin wherever it is inside.  Not below 0 where none is found."""
    for i in range(D):
        v[CENTRE, i] = 0.0
    deep = level(v, CENTRE, q)
    if not deep < 0.0:
        for i in range(D):
            v[CENTRE, i] = NEAR * v[T, i]
        deep = level(v, CENTRE, q)
    if not deep < 0.0:
        deep = walked(v, m, q, held)
    return deep


def walked(v: Any, m: Any, q: Any, held: Any) -> float:
    """The same where the origin is none: inwards from where a walk down the slopes comes to K, and from the origin.

    Each step ends where the level would be 0 if it were straight, and so comes nearer to a convex K (B. T. Polyak 1969).  Ways in are
    the last slope and, into a narrow cone, the mean of all; where nothing is found the axes and their diagonal.
    """
    for i in range(D):
        v[X, i], v[STEP, i], v[REST, i], v[BEST, i] = v[T, i], 0.0, 0.0, 0.0
    for _ in range(WALK):
        high = piece(v, X, q, NATURAL, held, D, RAW, m, RAWBEND)
        steep = length(v, RAW)
        if not (steep > 0.0 and isfinite(steep) and isfinite(high)):
            break
        for i in range(D):
            v[REST, i] = -v[RAW, i] / steep
            v[STEP, i] += v[REST, i]
        if high <= BESIDE * steep * length(v, X):
            break
        for i in range(D):
            v[X, i] += v[REST, i] * (high / steep)
    mean = length(v, STEP)
    for i in range(D):
        v[STEP, i] /= mean if mean > 0.0 else 1.0
    deep = inwards(v, q, X, REST, 0.0)
    deep = inwards(v, q, X, STEP, deep)
    deep = inwards(v, q, BEST, STEP, deep)
    for axis in range(2 * D + 2):
        if not deep < 0.0:
            for i in range(D):
                v[STEP, i] = (1.0 if axis % 2 == 0 else -1.0) * (1.0 if axis >= 2 * D or 2 * i == axis - axis % 2 else 0.0)
            deep = inwards(v, q, BEST, STEP, deep)
    return deep


def inwards(v: Any, q: Any, start: int, way: int, deep: float) -> float:
    """The least level along a way, if it is less than ``deep``; its place is the centre then."""
    far = 4.0
    for _ in range(DEPTHS):
        for i in range(D):
            v[U, i] = v[start, i] + far * v[way, i]
        found = level(v, U, q)
        if found < deep:
            deep = found
            for i in range(D):
                v[CENTRE, i] = v[U, i]
        far *= 0.25
    return deep


def crossed(v: Any, q: Any, deep: float, out: float, end: int, close: float) -> float:
    """The share of the way from the centre to row ``end`` that lies in K, ``close`` or a little less; a point beyond K is noted.

    Regula falsi; the level at an end that stays is halved (M. Dowell and P. Jarratt 1971), and every third step halves the way.
    """
    low, high, stayed = 0.0, 1.0, 0
    for k in range(BRACKETS):
        middle = (deep * high - out * low) / (deep - out)
        if k % 3 == 2 or not low < middle < high:
            middle = 0.5 * (low + high)
        for i in range(D):
            v[X, i] = v[CENTRE, i] + middle * (v[end, i] - v[CENTRE, i])
        found = level(v, X, q)
        if found <= 0.0:
            low, deep = middle, found
            out *= 0.5 if stayed > 0 else 1.0
            stayed = 1
            if found == 0.0:
                break
        else:
            high, out = middle, (found if isfinite(found) else 1e300)
            deep *= 0.5 if stayed < 0 else 1.0
            stayed = -1
        if high - low <= close * low:
            break
    for i in range(D):
        v[U, i] = v[CENTRE, i] + high * (v[end, i] - v[CENTRE, i])
    return low
