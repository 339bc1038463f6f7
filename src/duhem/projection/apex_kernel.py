"""Where Newton's method has no way from the boundary: half-spaces to an apex, or to where it has a short way.

From the trial on, the closest point of the half-spaces found so far is drawn back to the boundary, towards a point inside K; the
half-space that supports K there comes next (A. F. Veinott 1967).  Those of a cone all pass through its apex, so that as many as there
are forces end the search.  They enter and leave by the dual method of D. Goldfarb and A. Idnani (1983).  Taken is a point of K
alone on which as many press as there are forces, none of them little or nearly in the span of the others: such a corner is the
closest point of a convex K to rounding, and where K is smooth there is none.  Compiled with :mod:`duhem.projection.newton_kernel`.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy import sqrt

from duhem.projection.newton_step import (
    BEND,
    BEST,
    CENTRE,
    FIRST,
    LENGTHS,
    LEVELS,
    NATURAL,
    NORMALS,
    RAW,
    RAWBEND,
    REST,
    SLOPES,
    STEP,
    WHITE,
    D,
    S,
    T,
    U,
    X,
    askew,
    crossed,
    eliminated,
    gram,
    length,
    level,
    piece,
    times,
    whitened,
)

__all__ = ["added", "apex", "copied", "overtopped"]

KINKS = 0  # how many kinks the law has


# -- compiled from here ----------------------------------------------------------------------------------------

CUTS, ASIDES, EVEN, REACHED = 80, 12, 4e-16, 3e-15  # so far beyond K, relative to 1 + |u|, is in K
SHARES, CLOSER, RAISE = 5, 0.07, 1e-6  # places each way, each at this share of the one before; so much of that over the plane
FLAT, SHARP = 1e-10, 1e-10  # of a normal beside the span of others; how far off an apex may lie, relative to 1 + |u|
EXACT = 1e-12  # the same of the components of a stress: farther off it may be a bend, which Newton's method finds


def apex(v: Any, m: Any, a: Any, q: Any, held: Any, root: Any, inverse: Any) -> int:
    """0 where the closest point is an apex, which is then in v and m with the D normals that press.

    Else a point close to it is, and how many pieces hold where the half-spaces that press touch K, which are the first of those held;
    less than 0 where it is an apex as far as is known, but may be a bend of a smooth K that is thin in the metric.
    """
    count, told, deep = 0, 1, aside(v, q)
    times(inverse, v, T, S)
    for i in range(D):
        v[STEP, i] = v[S, i]
    for _ in range(CUTS):
        times(root, v, STEP, BEST)
        out, share, far = level(v, BEST, q), 1.0, 0.0
        if not out <= 0.0:
            share = crossed(v, q, deep, out if isfinite(out) else 1e300, BEST, EVEN)
        for i in range(D):
            v[X, i] = v[CENTRE, i] + share * (v[BEST, i] - v[CENTRE, i])
            far = max(far, abs(v[BEST, i] - v[X, i]))
        if far <= REACHED * (1.0 + length(v, BEST)):
            far = max(far, EVEN * (1.0 + length(v, BEST)))
            off = cornered(v, m, a, far, inverse) if count == D else np.inf
            if off <= SHARP and not overtopped(v, q, root, inverse):
                if off * stretch(root, inverse) <= EXACT:
                    return 0
                told = -1
            break
        high = piece(v, X, q, NATURAL, held, D, RAW, m, RAWBEND)
        slope = whitened(v, root)
        if not (slope > 0.0 and isfinite(high)):
            break
        times(inverse, v, X, U)
        offset = -high / slope
        for i in range(D):
            v[WHITE, i] /= slope
            offset += v[WHITE, i] * v[U, i]
        count = entered(v, m, a, held, count, offset, slope)
        if count == 0:
            break
    pieces = 0
    for i in range(D):
        v[U, i] = v[BEST, i]
    if KINKS > 0:
        for j in range(count):
            copied(held, j, D)
            if added(held, pieces):
                pieces += 1
    return told * (pieces if pieces > 0 else 1)


def added(held: Any, count: int) -> bool:
    """Whether the piece that holds is none of those held; then it is the next of them."""
    for j in range(count):
        equal = True
        for k in range(KINKS):
            equal = equal and held[j, k] == held[D, k]
        if equal:
            return False
    copied(held, D, count)
    return True


def copied(held: Any, row: int, to: int) -> None:
    """Puts one piece in the place of another."""
    for k in range(KINKS):
        held[to, k] = held[row, k]


def overtopped(v: Any, q: Any, root: Any, inverse: Any) -> bool:
    """Whether K goes beyond the plane through the stress across the rest of the way: with the point inside K, or along the plane.

    Beside a tip of K a formula may have normals that K has not, closer to it than doubles tell: x^2 - y^2 has every one.
    """
    times(inverse, v, CENTRE, STEP)
    away, far, over = length(v, REST), 0.0, 0.0
    for i in range(D):
        far += (v[STEP, i] - v[U, i]) * (v[STEP, i] - v[U, i])
        over += (v[STEP, i] - v[U, i]) * v[REST, i]
    if over > 0.0:
        return True
    for axis in range(D):
        along = v[REST, axis] / away
        across, share = sqrt(max(1.0 - along * along, 0.0)), sqrt(far)
        for way in range(2 * SHARES if across > 0.0 else 0):
            share *= -CLOSER if way % 2 == 0 else -1.0  # both ways, ever closer
            for i in range(D):
                flat = ((1.0 if i == axis else 0.0) - along * v[REST, i] / away) / across
                v[STEP, i] = share * flat + abs(share) * RAISE * v[REST, i] / away
            times(root, v, STEP, RAW)
            for i in range(D):
                v[RAW, i] += v[X, i]
            if level(v, RAW, q) < 0.0:
                return True
    return False


def aside(v: Any, q: Any) -> float:
    """The level at the centre, once it is moved a little off every plane in which the trial is likely to lie: off all symmetries."""
    far = 0.0
    for i in range(D):
        far = max(far, 0.5 * abs(v[FIRST, i] - v[CENTRE, i]))
    for _ in range(ASIDES):
        for i in range(D):
            v[X, i] = v[CENTRE, i] + far * askew(i)
        deep = level(v, X, q)
        if deep < 0.0:
            for i in range(D):
                v[CENTRE, i] = v[X, i]
            return deep
        far *= 0.25
    return level(v, CENTRE, q)


def entered(v: Any, m: Any, a: Any, held: Any, count: int, offset: float, slope: float) -> int:
    """How many half-spaces press once that of the normal ``WHITE`` has come, on the point that is their closest; 0 for none."""
    own, shares, across = 0.0, np.empty(D + 1), np.empty(D)
    for _ in range(2 * D + 2):
        over, square = -offset, 0.0
        gram(v, m, a, WHITE, count)  # the new normal by those that press, and what is across them
        if count > 0 and not eliminated(a, count):
            return 0
        for j in range(count):
            shares[j] = a[j, count]
        for i in range(D):
            across[i] = v[WHITE, i]
            for j in range(count):
                across[i] -= shares[j] * m[NORMALS, j, i]
            square += across[i] * across[i]
            over += v[WHITE, i] * v[STEP, i]
        if not over > 0.0:
            return 0
        free = count < D and square > FLAT * FLAT
        step, leaves = over / square if free else np.inf, -1
        for j in range(count):
            if shares[j] > 0.0 and v[LENGTHS, j] / shares[j] < step:
                step, leaves = v[LENGTHS, j] / shares[j], j
        if not isfinite(step):
            return 0
        own += step
        for j in range(count):
            v[LENGTHS, j] = max(v[LENGTHS, j] - step * shares[j], 0.0)
        if leaves < 0:
            for i in range(D):
                m[NORMALS, count, i] = v[WHITE, i]
            v[LENGTHS, count], v[LEVELS, count], v[SLOPES, count] = own, offset, slope
            copied(held, D, count)
            return count + 1 if settled(v, m, a, count + 1) else 0
        if free:
            for i in range(D):
                v[STEP, i] -= step * across[i]
        count -= 1
        for i in range(D):
            m[NORMALS, leaves, i] = m[NORMALS, count, i]
        v[LENGTHS, leaves], v[LEVELS, leaves], v[SLOPES, leaves] = v[LENGTHS, count], v[LEVELS, count], v[SLOPES, count]
        copied(held, count, leaves)
    return 0


def settled(v: Any, m: Any, a: Any, count: int) -> bool:
    """Brings the point onto the planes that press, and their shares of the way there; twice, as a far trial leaves its rounding."""
    for i in range(D):
        v[STEP, i] = v[S, i]
    for j in range(count):
        v[LENGTHS, j] = 0.0
    for _ in range(2):
        for j in range(count):
            a[j, count] = -v[LEVELS, j]
            for i in range(D):
                a[j, count] += m[NORMALS, j, i] * v[STEP, i]
            for k in range(count):
                a[j, k] = 0.0
                for i in range(D):
                    a[j, k] += m[NORMALS, j, i] * m[NORMALS, k, i]
        if not eliminated(a, count):
            return False
        for j in range(count):
            v[LENGTHS, j] += a[j, count]
            for i in range(D):
                v[STEP, i] -= a[j, count] * m[NORMALS, j, i]
    return True


def stretch(root: Any, inverse: Any) -> float:
    """A bound on the condition number of ``root``: relative errors of lengths in the metric are so much larger in components at most."""
    out, back = 0.0, 0.0
    for i in range(D):
        for k in range(D):
            out += root[i, k] * root[i, k]
            back += inverse[i, k] * inverse[i, k]
    return float(sqrt(out * back))


def cornered(v: Any, m: Any, a: Any, far: float, inverse: Any) -> float:
    """How far off the point may be where the D planes meet, ``far`` from K, relative to 1 + |u|; it is the stress then, without bends.

    With s - u = sum lambda n the closest point of K is behind each plane by |s - u| far/lambda at most.
    """
    volume, least, square = 1.0, np.inf, 0.0
    for i in range(D):
        v[X, i] = v[BEST, i]
        for k in range(D):
            m[BEND, i, k] = 0.0
            a[i, k] = m[NORMALS, i, k]
    times(inverse, v, X, U)
    for i in range(D):
        v[REST, i] = v[S, i] - v[U, i]
        square += v[REST, i] * v[REST, i]
        least = min(least, v[LENGTHS, i])
    for j in range(D):  # what each normal has across those before it
        size = 0.0
        for i in range(D):
            size += a[j, i] * a[j, i]
        volume *= sqrt(size)
        for k in range(j + 1, D):
            along = 0.0
            for i in range(D):
                along += a[j, i] * a[k, i] / size
            for i in range(D):
                a[k, i] -= along * a[j, i]
    sharp = (1.0 + length(v, U)) * least * volume
    return sqrt(square) * far / sharp if sharp > 0.0 else np.inf
