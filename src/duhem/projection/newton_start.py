"""Where the search at one point begins: a point inside K, and where the way from it to the trial leaves K.

Compiled with :mod:`duhem.projection.newton_kernel`; names without a body are those of one law.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

from duhem.projection.newton_step import (
    BEST,
    CENTRE,
    FIRST,
    RAW,
    RAWBEND,
    REST,
    STEP,
    D,
    T,
    U,
    X,
    below,
    length,
)  # fmt: skip

__all__ = ["NAMED", "NATURAL", "PAIR", "askew", "begun"]

DATA = 0  # how many data the law has


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
