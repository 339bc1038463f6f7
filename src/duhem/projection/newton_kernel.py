"""One point at a time: the closest point of a convex K by Newton's method from where the way to the trial leaves K.

The source of this module is compiled together with the functions of one law (:mod:`duhem.projection.compiled_newton`), whose names
stand in :mod:`duhem.projection.newton_step` without a body: that is why everything here is plain loops over small arrays.  Units as in
:mod:`duhem.projection.whitened_body`; what is not shown to be optimal here is left to the search that uses half-spaces.

Pieces of the boundary are kept as an active set: Newton's method goes to where those it has meet; a piece that is passed on
the way is added, one whose multiplier is negative is dropped.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy import sqrt

from duhem.projection.apex_kernel import added, apex, copied, overtopped
from duhem.projection.newton_step import (
    BEND,
    BEST,
    DATA,
    FIRST,
    LENGTHS,
    LEVELS,
    MATRICES,
    NAMED,
    NATURAL,
    NORMALS,
    PAIR,
    RAW,
    RAWBEND,
    REST,
    ROWS,
    SLOPES,
    STEP,
    WHITE,
    D,
    S,
    T,
    U,
    X,
    begun,
    bent,
    directed,
    eliminated,
    grown,
    length,
    level,
    piece,
    shared,
    times,
    turn,
    whitened,
)

__all__ = ["LEFT", "SLIP", "STICK", "solve"]

KINKS = PAIRS = 0  # how many kinks the law has, and how many eigenvalues that may be double


# -- compiled from here ----------------------------------------------------------------------------------------

STICK, SLIP, LEFT = 0, 1, 2
ANGLE, LOOSE, DEPTH, TIP, ORIGIN = 1e-12, 1e-10, 1e-14, 1e-14, 1e-12  # as in the search
STEPS, HALVINGS, ROUNDS = 40, 7, 8
SHORT, LONG = 12, 400  # states that are looked at: beside an edge of equal eigenvalues a way that leads nowhere is long
TOUCHING = 1e-4  # an angle of two pieces that have no corner between them
PROGRESS, CLOSE = 0.9, 1e-10  # so close a step that leaves more of the error is the last
PINCHED = 1e8  # bends of a hundred-millionth of the way may be a tip's
SETTLED, ROUNDED = 1e-15, 2e-16  # what is between them a step takes away that is not looked at again; a level of the second is rounding


def solve(
    trial: Any, data: Any, constants: Any, root: Any, inverse: Any, degree: float, stress: Any, slip: Any, multiplier: Any, state: Any
) -> None:
    """Stress, slip and multiplier of each point, and whether it sticks, slips or is left; ``inverse`` is that of ``root``.

    The slip is that of a stiffness of mean 1.
    """
    v, m, a = np.empty((ROWS, D)), np.empty((MATRICES, D, D)), np.empty((2 * D, 2 * D + 1))
    q = np.empty(DATA + len(constants))
    for k in range(len(constants)):
        q[DATA + k] = constants[k]
    held = np.empty((D + 1, KINKS), np.int8)
    for n in range(trial.shape[0]):
        state[n] = solved(trial, data, n, degree, v, m, a, q, held, root, inverse, stress, slip, multiplier)


def solved(
    trial: Any, data: Any, n: int, degree: float, v: Any, m: Any, a: Any, q: Any, held: Any, root: Any, inverse: Any,
    stress: Any, slip: Any, multiplier: Any,
) -> int:  # fmt: skip
    """The same for point ``n``, whose pieces are left in v and m: those that press have ``LENGTHS`` above 0."""
    multiplier[n] = 0.0
    for i in range(D):
        stress[n, i], slip[n, i] = trial[n, i], 0.0
    size = begun(trial, data, n, v, m, q, held)
    if size == 0.0:
        return STICK
    if size < 0.0 or not searched(v, m, a, q, held, root, inverse):
        return LEFT
    weight = 0.0
    for i in range(D):
        stress[n, i] = v[X, i] * size
    for j in range(D):
        c = v[LENGTHS, j]
        if c > 0.0:
            weight += c / v[SLOPES, j]
            for i in range(D):
                for k in range(D):
                    slip[n, i] += c * m[NORMALS, j, k] * inverse[k, i] * size
    multiplier[n] = weight * size if degree == 1.0 else grown(weight, size, 2.0 - degree)
    return SLIP


def searched(v: Any, m: Any, a: Any, q: Any, held: Any, root: Any, inverse: Any) -> bool:
    """True where a stress is found that is optimal, with its normals and multipliers (0 for pieces that do not press)."""
    count, near, meet, most, rough = 0, False, 0, SHORT if PAIRS > 0 else LONG, False
    times(inverse, v, T, S)
    for i in range(D):
        v[X, i] = v[FIRST, i]
    while True:
        count = pressed(v, m, a, q, held, meet, most, root, inverse)
        if PAIRS > 0 and count == 0:
            count = paired(v, m, a, q, held, most, root, inverse)
        if count == 0 and (meet > 0 or not near):
            for i in range(D):
                v[X, i] = v[FIRST, i]
            if meet > 0:
                meet = 0
                continue
            if PAIRS > 0 and most == SHORT:
                most = LONG
                continue
            if KINKS > 0 and isfinite(newton(v, m, a, q, held, 1, NATURAL, LONG, root, inverse)):  # along a seam the piece may change
                count = 1 if optimal(v, m, q, held, 1, root, inverse) else 0  # from step to step
        if near or (count > 0 and not pinched(v, m)):
            break
        if count > 0:
            for i in range(D):
                v[FIRST, i] = v[X, i]
        meet, near = apex(v, m, a, q, held, root, inverse), True
        if meet == 0 or (meet < 0 and count > 0):
            count = D
            break
        if count == 0:
            for i in range(D):
                v[FIRST, i] = v[X, i]
        rough, meet = meet < 0, abs(meet) if abs(meet) > 1 else 0
        for i in range(D):
            v[X, i] = v[FIRST, i]
    if rough and (count == 0 or pinched(v, m)) and apex(v, m, a, q, held, root, inverse) <= 0:
        count = D
    if count == 0:
        return False
    for j in range(count, D):
        v[LENGTHS, j] = 0.0
    snapped(v, q)
    return True


def pressed(v: Any, m: Any, a: Any, q: Any, held: Any, first: int, most: int, root: Any, inverse: Any) -> int:
    """How many pieces press on the optimum, which is then in v; 0 where it is not found.

    Begun with the ``first`` pieces of those held, with 0 on the one that holds.
    """
    count = first if first > 0 else 1
    if KINKS > 0 and first == 0 and not isfinite(piece(v, U, q, NATURAL, held, 0, RAW, m, RAWBEND)):
        piece(v, X, q, NATURAL, held, 0, RAW, m, RAWBEND)  # inside, where scales say which is the greatest
    for turns in range(ROUNDS):
        if not isfinite(newton(v, m, a, q, held, count, NAMED, most, root, inverse)):
            return 0
        least = 0
        for j in range(1, count):
            if v[LENGTHS, j] < v[LENGTHS, least]:
                least = j
        if v[LENGTHS, least] < -ANGLE * (1.0 + length(v, REST)):
            if count == 1:
                return 0
            count -= 1
            copied(held, count, least)
        elif optimal(v, m, q, held, count, root, inverse):
            beside = neighbour(v, m, held, count) if KINKS > 0 and turns < ROUNDS - 1 else -1
            if beside < 0:
                return count
            copied(held, D, beside)
        elif KINKS == 0:  # of a smooth law there is no other piece
            return 0
        elif count == D:
            if not exchanged(v, m, a, held):
                return 0
        elif added(held, count):
            count += 1
        else:
            return 0
    return 0


def paired(v: Any, m: Any, a: Any, q: Any, held: Any, most: int, root: Any, inverse: Any) -> int:
    """The same where two eigenvalues are equal, of whose pair three pieces meet (M. L. Overton 1988, SIAM J. Matrix Anal. Appl. 9)."""
    for k in range(PAIRS):
        for i in range(D):
            v[X, i] = v[FIRST, i]
        if (
            isfinite(newton(v, m, a, q, held, 3, PAIR + k, most, root, inverse))
            and spread(v, m)
            and optimal(v, m, q, held, 3, root, inverse)
        ):
            return 3
    return 0


def neighbour(v: Any, m: Any, held: Any, count: int) -> int:
    """Which of the pieces goes over into the one that holds without a corner, a little before the stress; -1 for none.

    Where two pieces touch each other their levels are alike to rounding long before their normals are.
    """
    slope = length(v, WHITE)
    for j in range(count):
        apart, other = 0.0, False
        for k in range(KINKS):
            other = other or held[j, k] != held[D, k]
        for i in range(D):
            off = v[WHITE, i] / slope - m[NORMALS, j, i]
            apart += off * off
        if other and ANGLE * ANGLE < apart < TOUCHING * TOUCHING:
            return j
    return -1


def exchanged(v: Any, m: Any, a: Any, held: Any) -> bool:
    """The piece that holds in the place of one of D that meet in a corner beyond it; False where the corner is no way back.

    The piece leaves whose multiplier is the first to vanish as that of the new one grows (Goldfarb and Idnani 1983).
    """
    for i in range(D):
        a[i, D] = v[WHITE, i]
        for j in range(D):
            a[i, j] = m[NORMALS, j, i]
    if not eliminated(a, D):
        return False
    leaves, first = D, 0.0
    for j in range(D):
        if a[j, D] > ANGLE and (leaves == D or v[LENGTHS, j] / a[j, D] < first):
            leaves, first = j, v[LENGTHS, j] / a[j, D]
    if leaves == D or not added(held, D):
        return False
    copied(held, D, leaves)
    return True


def optimal(v: Any, m: Any, q: Any, held: Any, count: int, root: Any, inverse: Any) -> bool:
    """Whether the stress satisfies the optimality conditions of a convex K; notes the piece that holds there, also where it does not."""
    balanced = balances(v, m, q, count, root, inverse)
    return (KINKS == 0 or followed(v, m, q, held, count, root, DEPTH * (1.0 + length(v, U)))) and balanced


def balances(v: Any, m: Any, q: Any, count: int, root: Any, inverse: Any) -> bool:
    """Whether the pieces that press meet at the stress, and their normals add up to the way that is left."""
    reach, away, deep = 1.0 + length(v, U), length(v, REST), 0.0
    for j in range(count):
        deep = max(deep, abs(v[LEVELS, j]))
        if not v[LENGTHS, j] >= -ANGLE * (1.0 + away):
            return False
        for b in range(j if D > 1 else 0):  # the smaller the angle at which two meet, the closer their levels; one force has one piece
            apart = 0.0
            for i in range(D):
                off = m[NORMALS, j, i] - m[NORMALS, b, i]
                apart += off * off
            if not abs(v[LEVELS, j] - v[LEVELS, b]) <= DEPTH * reach * min(sqrt(apart), 1.0):
                return False
    turned = turn(v, m, count) / (1.0 + away)
    if not (turned <= min(max(1e-15 * reach * bending(m), ANGLE), LOOSE) and deep <= DEPTH * reach):
        return False
    return not (pinched(v, m) and overtopped(v, q, root, inverse))


def pinched(v: Any, m: Any) -> bool:
    """Whether K bends so much at the stress that it may be beside a tip, which is met less closely by its sides than by itself."""
    return bending(m) > PINCHED * (1.0 + length(v, REST))


def bending(m: Any) -> float:
    """The greatest of the bends."""
    most = 0.0
    for i in range(D):
        for k in range(D):
            most = max(most, abs(m[BEND, i, k]))
    return most


def followed(v: Any, m: Any, q: Any, held: Any, count: int, root: Any, depth: float) -> bool:
    """Whether the piece that holds at the stress, noted here, is one of those held, or meets them there.

    Two surfaces at an angle part by its share of the way: the smaller it is, the closer their levels must be to say that they meet.
    """
    high = piece(v, X, q, NATURAL, held, D, RAW, m, RAWBEND)
    slope, angle = whitened(v, root), 2.0
    for j in range(count):
        apart = 0.0
        for i in range(D):
            off = v[WHITE, i] / slope - m[NORMALS, j, i]
            apart += off * off
        angle = min(angle, sqrt(apart))
    return abs(high) <= depth * slope * (1.0 if angle <= LOOSE else angle)


def snapped(v: Any, q: Any) -> None:
    """Components that are rounding become 0 where only that keeps the point inside, a face through 0, and all of them at a tip there."""
    tip, rounded, big = TIP * (1.0 + length(v, U)), False, 0.0
    for i in range(D):
        big = max(big, abs(v[X, i]))
    for i in range(D):
        v[BEST, i] = v[X, i] if abs(v[X, i]) > tip and big > ORIGIN else 0.0
        rounded = rounded or v[BEST, i] != v[X, i]
    if rounded:
        clean = level(v, BEST, q)
        if (clean == 0.0 and big <= ORIGIN) or (clean <= 0.0 and level(v, X, q) > 0.0):
            for i in range(D):
                v[X, i] = v[BEST, i]


def newton(v: Any, m: Any, a: Any, q: Any, held: Any, count: int, natural: int, most: int, root: Any, inverse: Any) -> float:
    """To where the pieces meet and the rest of the way is a sum of their normals; damped until the error falls.

    The error at the stress where it ends, whose state is left in v and m; inf where there is none.
    """
    before, part, tries, steps, seen = np.inf, 1.0, 0, 0, 0
    while True:
        seen += 1
        error = state_of(v, m, a, q, held, count, natural, root, inverse)
        if error < before:
            slow = not error < PROGRESS * before and error < CLOSE
            if error <= ROUNDED or slow or steps == STEPS or seen >= most or not directed(v, m, a, count, root):
                return error
            for i in range(D):
                v[BEST, i] = v[X, i]
            if error <= SETTLED:
                if length(v, STEP) <= DEPTH * (1.0 + length(v, U)):
                    for i in range(D):
                        v[X, i] += v[STEP, i]
                return error
            before, part, tries, steps = error, 1.0, 0, steps + 1
        elif part == 0.0 or before == np.inf or seen >= most:  # the best there is
            return error
        else:
            tries += 1
            part = 0.0 if tries == HALVINGS else part * (0.5 if part > 0.2 else 0.1)
        for i in range(D):
            v[X, i] = v[BEST, i] + part * v[STEP, i]


def state_of(v: Any, m: Any, a: Any, q: Any, held: Any, count: int, natural: int, root: Any, inverse: Any) -> float:
    """How far the stress is from optimal on these pieces: normals, levels, multipliers, sum of the bends; inf where undefined."""
    times(inverse, v, X, U)
    for i in range(D):
        v[REST, i] = v[S, i] - v[U, i]
        for k in range(D):
            m[BEND, i, k] = 0.0
    deep = 0.0
    for j in range(count):
        high = piece(v, X, q, natural, held, j, RAW, m, RAWBEND + j)
        slope = whitened(v, root)
        if not slope > 0.0 or not isfinite(high):
            return np.inf
        per = 1.0 / slope
        v[SLOPES, j], v[LEVELS, j] = slope, high * per
        deep = max(deep, abs(v[LEVELS, j]))
        for i in range(D):
            m[NORMALS, j, i] = v[WHITE, i] * per
    if not shared(v, m, a, count):
        return np.inf
    for j in range(count):
        if v[LENGTHS, j] > 0.0:
            bent(m, RAWBEND + j, root, v[LENGTHS, j] / v[SLOPES, j])
    turned = turn(v, m, count) / (1.0 + length(v, REST))
    if deep <= ROUNDED * (1.0 + length(v, U)) and deep < turned:  # what is rounding hides no turn that is still to be taken away
        deep = 0.0
    error = sqrt(turned * turned + deep * deep)
    return error if isfinite(error) else np.inf


# -- an edge of K where two eigenvalues are equal: the cone of normals there, of three pieces ---------------------------
# An eigenvalue that is double has a plane of axes n, and K is n . A n <= ... for each of them: any three of these pieces meet in the edge.
# A normal of K there is the sum of theirs by multipliers of any sign, as long as the matrix of two rows that they make in the plane is
# positive definite; then it is also such a sum by three other axes with multipliers above 0.

FLAT_PAIR = 1e-9  # of a matrix of multipliers: its determinant is nothing


def spread(v: Any, m: Any) -> bool:
    """Puts the pieces of three axes with multipliers above 0 in the place of those of two axes and their mean; False where none are."""
    mixed = 0.5 * v[LENGTHS, 2] / v[SLOPES, 2]
    first, second = v[LENGTHS, 0] / v[SLOPES, 0] + mixed, v[LENGTHS, 1] / v[SLOPES, 1] + mixed
    if not (first > 0.0 and second > 0.0 and first * second - mixed * mixed > FLAT_PAIR * first * second):
        return False
    top, aside = sqrt(first), mixed / sqrt(first)
    across = sqrt(second - aside * aside)
    for i in range(3):  # rows of a root of the matrix, turned by thirds of a turn
        c, s = (1.0 if i == 0 else -0.5), (0.0 if i == 0 else sqrt(0.75) if i == 1 else -sqrt(0.75))
        a, b = top * c, aside * c + across * s
        square = a * a + b * b
        one, other, both = (a * a - a * b) / square, (b * b - a * b) / square, 2.0 * a * b / square
        for k in range(D):  # the gradient there, of the three that are known
            m[RAWBEND, i, k] = one * v[SLOPES, 0] * m[NORMALS, 0, k] + other * v[SLOPES, 1] * m[NORMALS, 1, k]
            m[RAWBEND, i, k] += both * v[SLOPES, 2] * m[NORMALS, 2, k]
        m[RAWBEND + 1, 0, i] = one * v[SLOPES, 0] * v[LEVELS, 0] + other * v[SLOPES, 1] * v[LEVELS, 1] + both * v[SLOPES, 2] * v[LEVELS, 2]
        m[RAWBEND + 1, 1, i] = square / 1.5
    for i in range(3):
        steep = 0.0
        for k in range(D):
            steep += m[RAWBEND, i, k] * m[RAWBEND, i, k]
        steep = sqrt(steep)
        for k in range(D):
            m[NORMALS, i, k] = m[RAWBEND, i, k] / steep
        v[SLOPES, i], v[LEVELS, i], v[LENGTHS, i] = steep, m[RAWBEND + 1, 0, i] / steep, m[RAWBEND + 1, 1, i] * steep
    return True
