"""The equations of one step of Newton's method at one point, in small arrays: compiled with :mod:`duhem.projection.newton_kernel`.

``v`` holds vectors by rows and ``m`` matrices, each in its place; ``a`` is room for equations.
"""

from __future__ import annotations

from math import floor, frexp, isfinite, ldexp
from typing import Any

import numpy as np
from numpy import sqrt

__all__ = [
    "BEND",
    "BEST",
    "CENTRE",
    "FIRST",
    "LENGTHS",
    "LEVELS",
    "MATRICES",
    "NORMALS",
    "RAW",
    "RAWBEND",
    "REST",
    "ROWS",
    "SLOPES",
    "STEP",
    "WHITE",
    "D",
    "S",
    "T",
    "U",
    "X",
    "below",
    "bent",
    "directed", "eliminated", "grown",
    "length",
    "shared",
    "times",
    "turn",
    "whitened",
]  # fmt: skip

D = 0  # how many forces the law has

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
    for j in range(count):
        a[j, count] = 0.0
        for i in range(D):
            a[j, count] += m[NORMALS, j, i] * v[REST, i]
        for k in range(count):
            a[j, k] = 0.0
            for i in range(D):
                a[j, k] += m[NORMALS, j, i] * m[NORMALS, k, i]
    if count == 1:
        v[LENGTHS, 0] = a[0, 1]  # of a unit normal
        return isfinite(a[0, 1])
    if not eliminated(a, count):
        return False
    for j in range(count):
        v[LENGTHS, j] = a[j, count]
    return True


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
