"""Chunks of points: what the judge says of those that are plainly right, and which points it has to look at itself.

The conditions and formulas are those of :mod:`duhem.projection.residuals`.  Every threshold beyond which that looks closer is halved
here, and a point that passes none of them, or has a residual of more than half of what is accurate, is left to it: so both say the
same of every point, whatever the last digits of either.  Compiled with the functions of one law, whose names stand
below without a body, as :mod:`duhem.projection.newton_kernel` is.

Short loops over the points of a chunk run on vectors: they have no branch, and pass on what they find in rows of ``seen``.  Corners
and known points are looked at one by one, where a slip asks for it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy import sqrt

from duhem.projection.newton_step import below, grown
from duhem.projection.slip_kernel import CORNER, cornered, edged, excess, raised

__all__ = ["FARTHEST", "LOW", "SLIP", "STICK", "UNJUDGED", "judge"]

D = 0  # how many forces the law has
KINKS = PAIRS = 0  # how many kinks, and eigenvalues that may be double
CONVEX = 0  # whether K is known to be convex
CORNERS = 1  # whether it may have corners or tips


def known(p: float, q: Any, b: Any) -> Any:
    """The data at a pressure and what they are off by, from constants and what these are off by."""
    raise NotImplementedError


def sized(data: Any, size: float) -> Any:
    """The data in units of another size."""
    raise NotImplementedError


def bounded(v: Any, x: int, q: Any, b: Any) -> tuple[float, float]:
    """h at row ``x`` of ``v`` and a bound of its rounding; ``b`` bounds what ``q`` is off by."""
    raise NotImplementedError


def unstressed(v: Any, x: int, q: Any, b: Any) -> tuple[float, float]:
    """The same of no stress."""
    raise NotImplementedError


def level(v: Any, x: int, q: Any) -> float:
    """h there, without a bound."""
    raise NotImplementedError


def gradient(v: Any, x: int, q: Any, slopes: int) -> None:
    """dh/ds there into the row ``slopes``."""
    raise NotImplementedError


def unpacked(numbers: Any) -> Any:
    """What stands in ``numbers``: five of them, four tuples, and the lengths of ways to known points."""
    raise NotImplementedError


def room(d: int, chunk: int) -> tuple[tuple[int, int], ...]:
    """The sizes of the four arrays in which a chunk of points is worked out, in so many forces."""
    return (ROOMS, d), (CORNER, 2 * d + 1), (3 * chunk, d), (7 * d + 28, chunk)


# -- compiled from here ----------------------------------------------------------------------------------------

STICK, SLIP, UNJUDGED = 0, 1, -1
ROUNDING, NOISE, HIDDEN_SHARE, SUSPECT, SHORT, ACCURACY = 4e-15, 0.5e-13, 0.5e-9, 0.5e-9, 20.0, 0.5e-7
ENDS = 2.0**-1017, 2.0**1020
LOW = 0.01  # of what h changes by over a stress: where it rises by less from no stress, its rise from inside K is taken
FARTHEST = 8.0  # sizes of a stress: the place inside K is no farther out
CHUNK = 128  # points: so few that their rows stay in the nearest cache
# Rows of seen: of every point its unit, level, what rounding hides of it and how far it is up from no stress; of the slips the same,
# then pressure and multiplier, the length of the gradient, the unit of lengths and the lengths over it, what is off in them, residuals,
# whether a known point may be beyond, what to think of it, and by how much h rises from a point inside K and over which length; by
# components trial, stress and slip, then aim, stress, k slip and lambda k n in the metric.
EVERY = 0
UNIT, LEVEL, HIDDEN, RISE, PRESSURE, GIVEN, STEEP, SIZE, AIM, ROOM, DISTANCE, GAP, TURNED = 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16
SHALLOW, OFF, BALANCE, FEASIBLE, COMPLETE, OVER, WORK, FAR, STATE, HEIGHT, REACH, TRIAL = 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28
STRESS, SLIPPED, AIMS, POINTS, MOVES, PULLS, ROWS = D + 28, 2 * D + 28, 3 * D + 28, 4 * D + 28, 5 * D + 28, 6 * D + 28, 7 * D + 28
LEFT, PLAIN, BENT = 0.0, 1.0, 2.0
S, POINT, MOVED, ROOMS = 0, 3, 4, 10  # rows of v, for one slip


def hypot(a: float, b: float) -> float:
    """On vectors; nan where the square of both is out of range and one of them is not 0."""
    square = a * a + b * b
    fine = ((square > 2.0**-960) & (square < np.inf)) | ((a == 0.0) & (b == 0.0))
    return float(sqrt(square if fine else np.nan))


def judge(
    trial: Any, pressure: Any, numbers: Any, rows: Any, stress: Any, slip: Any, multiplier: Any, dissipation: Any, status: Any, found: Any
) -> None:
    """Dissipation, status (``UNJUDGED`` where it is left open) and residuals, an array of ``found`` each, of every point.

    They are full of zeros, and those of points that stick are left so.  ``numbers`` and ``rows`` hold what a law, its parameters and the
    stiffness settle (:func:`unpacked`): the constants of the ``pressed`` data, then those of h, and what they are off by;
    ``largest`` the pressure at which the ``tips`` of K are known, ``ways`` and ``reaches`` their directions and lengths in
    the metric; ``beside`` ways off a point, where the normals of a corner are looked for; the matrices as in
    :class:`duhem.projection.increment.Metric`.  Lengths are taken over powers of two, ``unit`` of a stress and ``size`` of all of the
    metric; ``per`` is 1/size.
    """
    largest, blur, good, certain, degree, pressed, pressed_off, constants, constants_off, reaches = unpacked(numbers)
    stiffness, of_slip, of_stress, to_stress = rows[:D], rows[D : 2 * D], rows[2 * D : 3 * D], rows[3 * D : 4 * D]
    first = 4 * D + reaches.shape[0]
    tips, ways, beside = rows[4 * D : first], rows[first : first + reaches.shape[0]], rows[first + reaches.shape[0] :]
    v, a = np.empty((ROOMS, D)), np.empty((CORNER, 2 * D + 1))
    at, seen, which = np.empty((D, 3 * CHUNK)).T, np.zeros((ROWS, CHUNK)), np.empty(CHUNK + 1, np.int64)
    flat_trial, flat_stress, flat_slip = trial.reshape(-1), stress.reshape(-1), slip.reshape(-1)  # of a known stride
    for begin in range(0, pressure.shape[0], CHUNK):
        stop = min(begin + CHUNK, pressure.shape[0])
        here, each = slice(begin, stop), slice(D * begin, D * stop)
        chunk(
            flat_trial[each], pressure[here], largest, pressed, pressed_off, constants, constants_off, stiffness, of_slip, of_stress,
            to_stress, beside, tips, ways, reaches, blur, good, certain, degree, flat_stress[each], flat_slip[each], multiplier[here],
            dissipation[here], status[here], (found[0][here], found[1][here], found[2][here], found[3][here], found[4][here]),
            v, a, at, seen, which,
        )  # fmt: skip


def chunk(
    trial: Any, pressure: Any, largest: float, pressed: Any, pressed_off: Any, constants: Any, constants_off: Any, stiffness: Any,
    of_slip: Any, of_stress: Any, to_stress: Any, beside: Any, tips: Any, ways: Any, reaches: Any, blur: float, good: float,
    certain: float, degree: float, stress: Any, slip: Any, multiplier: Any, dissipation: Any, status: Any, found: Any,
    v: Any, a: Any, at: Any, seen: Any, which: Any,
) -> None:  # fmt: skip
    """The same of a chunk of points, with room for what is worked out: few points go through it without a compiler."""
    levels(pressure, pressed, pressed_off, constants, constants_off, stress, at, seen)
    count = sorted_(trial, stress, slip, multiplier, seen, dissipation, status, which)
    taken(count, which, trial, pressure, stress, slip, multiplier, at, seen)
    seen_in_metric(count, pressed, pressed_off, constants, of_slip, of_stress, at, seen)
    if degree != 1.0:
        regrown(count, degree, seen)
    lengths(count, seen)
    heights(count, largest, pressed, pressed_off, constants, of_stress, tips, at, seen)
    shares(count, blur, good, certain, of_slip, at, seen)
    looked(count, stiffness, of_stress, seen)
    tried(count, largest, ways, reaches, seen)
    for j in range(count):
        n, state = which[j], seen[STATE, j]
        if state == LEFT:
            continue
        other = 0.0
        if state == BENT or seen[OVER, j] > 0.0 or CONVEX == 0:
            fine, other = one_slip(
                j, v, a, at, seen, largest, pressed, pressed_off, constants, of_slip, to_stress, beside, tips, ways, reaches, good,
                certain,
            )  # fmt: skip
            if not fine:
                continue
        off = max(seen[OFF, j], seen[BALANCE, j])
        if off <= ACCURACY and seen[FEASIBLE, j] <= ACCURACY and seen[COMPLETE, j] <= ACCURACY and other <= ACCURACY:
            status[n] = SLIP
            found[0][n], found[2][n], found[3][n] = seen[FEASIBLE, j], seen[COMPLETE, j], off
            if other != 0.0:
                found[4][n] = other


def levels(pressure: Any, pressed: Any, pressed_off: Any, constants: Any, constants_off: Any, stress: Any, at: Any, seen: Any) -> None:
    """Unit and level of every point, and its stress over the unit."""
    for x in range(pressure.shape[0]):
        big = 0.0
        for i in range(D):
            at[x, i] = stress[D * x + i]
            big = max(big, abs(at[x, i]))
        unit = below(big) if (big > 0.0) & (big < np.inf) else 1.0
        per = 1.0 / unit  # exact, and a product is sooner done
        for i in range(D):
            at[x, i] *= per
        seen[EVERY, x] = unit
    for x in range(pressure.shape[0]):
        unit = seen[EVERY, x]
        data, offs = known(pressure[x], pressed, pressed_off)
        q, b = sized(data, unit) + constants, sized(offs, unit) + constants_off
        seen[EVERY + 1, x], seen[EVERY + 2, x] = bounded(at, x, q, b)
        seen[EVERY + 3, x] = -unstressed(at, x, q, b)[0]


def sorted_(trial: Any, stress: Any, slip: Any, multiplier: Any, seen: Any, dissipation: Any, status: Any, which: Any) -> int:
    """Dissipation of every point and status of those that stick for sure; how many moved, and which."""
    for x in range(multiplier.shape[0]):
        work = stress[D * x] * slip[D * x]
        for i in range(1, D):
            work += stress[D * x + i] * slip[D * x + i]
        dissipation[x] = work
    for x in range(multiplier.shape[0]):
        moved = multiplier[x] != 0.0
        for i in range(D):
            moved = moved | (slip[D * x + i] != 0.0) | (stress[D * x + i] != trial[D * x + i])
        seen[STATE, x] = 1.0 if moved else 0.0
    for x in range(multiplier.shape[0]):
        value, hidden = seen[EVERY + 1, x], seen[EVERY + 2, x]
        within = (value > -np.inf) & (value < -2.0 * hidden) & (seen[STATE, x] == 0.0)
        status[x] = STICK if within else UNJUDGED
    count = 0
    for x in range(multiplier.shape[0]):
        which[count] = x
        count += 1 if seen[STATE, x] > 0.0 else 0
    return count


def taken(count: int, which: Any, trial: Any, pressure: Any, stress: Any, slip: Any, multiplier: Any, at: Any, seen: Any) -> None:
    """The slips side by side."""
    for j in range(count):
        x = which[j]
        for i in range(D):
            at[CHUNK + j, i] = at[x, i]
            seen[TRIAL + i, j], seen[STRESS + i, j], seen[SLIPPED + i, j] = trial[D * x + i], stress[D * x + i], slip[D * x + i]
        seen[UNIT, j], seen[LEVEL, j], seen[HIDDEN, j] = seen[EVERY, x], seen[EVERY + 1, x], seen[EVERY + 2, x]
        seen[RISE, j], seen[PRESSURE, j], seen[GIVEN, j] = seen[EVERY + 3, x], pressure[x], multiplier[x]


def seen_in_metric(
    count: int, pressed: Any, pressed_off: Any, constants: Any, of_slip: Any, of_stress: Any, at: Any, seen: Any
) -> None:  # fmt: skip
    """Gradients, and all vectors in the metric."""
    for j in range(count):
        data, _ = known(seen[PRESSURE, j], pressed, pressed_off)
        gradient(at, CHUNK + j, sized(data, seen[UNIT, j]) + constants, 2 * CHUNK + j)
    for j in range(count):
        size = steep = 0.0
        for i in range(D):
            aim = point = moved = pull = 0.0
            for k in range(D):
                aim += seen[TRIAL + k, j] * of_stress[k, i]
                point += seen[STRESS + k, j] * of_stress[k, i]
                moved += seen[SLIPPED + k, j] * of_slip[k, i]
                pull += at[2 * CHUNK + j, k] * of_slip[k, i]
            seen[AIMS + i, j], seen[POINTS + i, j], seen[MOVES + i, j], seen[PULLS + i, j] = aim, point, moved, pull
            size = max(size, abs(aim), abs(point))
            steep += pull * pull
        seen[SIZE, j], seen[STEEP, j] = size, sqrt(steep)


def regrown(count: int, degree: float, seen: Any) -> None:
    """Multipliers of h for those of g; nan where these may be beyond doubles."""
    for j in range(count):
        unit, moved = seen[UNIT, j], 0.0
        for i in range(D):
            moved += seen[MOVES + i, j] * seen[MOVES + i, j]
        own = grown(sqrt(moved) / seen[STEEP, j], unit, 1.0 - degree)
        seen[GIVEN, j] = grown(seen[GIVEN, j], unit, degree - 1.0) if ENDS[0] < own < ENDS[1] else np.nan


def lengths(count: int, seen: Any) -> None:
    """All over one power of two, and the lengths of it; what trial, k slip and stress leave, and how far the slip is off the normal."""
    for j in range(count):
        size, steep = seen[SIZE, j], seen[STEEP, j]
        fine = (size > 0.0) & (size < np.inf) & (steep > 0.0) & (steep < np.inf)
        size = below(size) if fine else 1.0
        per = 1.0 / size
        given = seen[GIVEN, j] * per
        gap = turned = distance = room = aim = 0.0
        for i in range(D):
            a, p, m = seen[AIMS + i, j] * per, seen[POINTS + i, j] * per, seen[MOVES + i, j] * per
            rest, across = a - m - p, m - seen[PULLS + i, j] * given
            seen[POINTS + i, j], seen[MOVES + i, j] = p, m
            gap += rest * rest
            turned += across * across
            distance += m * m
            room += p * p
            aim += a * a
        seen[SIZE, j], seen[GIVEN, j] = size, given if fine else np.nan
        seen[GAP, j], seen[TURNED, j], seen[AIM, j] = sqrt(gap), sqrt(turned), sqrt(aim)
        seen[DISTANCE, j], seen[ROOM, j] = sqrt(distance), sqrt(room)


def heights(
    count: int, largest: float, pressed: Any, pressed_off: Any, constants: Any, of_stress: Any, tips: Any, at: Any, seen: Any
) -> None:  # fmt: skip
    """By how much h rises from no stress to each stress; from another point of K where that is on its boundary, or nearly."""
    for j in range(count):
        height = inner = 0.0
        for i in range(D):
            part = at[2 * CHUNK + j, i] * at[CHUNK + j, i]
            height += part
            inner += abs(part)
        height = height if (KINKS == 0) | (height <= seen[RISE, j]) else seen[RISE, j]  # a piece that is as high may be flatter
        seen[HEIGHT, j], seen[REACH, j] = height if height > LOW * inner else np.nan, seen[ROOM, j]
    for j in range(count):
        if not seen[HEIGHT, j] > 0.0:
            data, _ = known(seen[PRESSURE, j], pressed, pressed_off)
            part, q = seen[PRESSURE, j] / largest if largest != 0.0 else 1.0, sized(data, seen[UNIT, j]) + constants
            from_within(j, part, q, of_stress, tips, at, seen)


def from_within(j: int, part: float, q: Any, of_stress: Any, tips: Any, at: Any, seen: Any) -> None:
    """The same from a mean of the known points of K on the axes, not with equal weights: a formula may have no value in the middle."""
    unit, size, steep, height, square = seen[UNIT, j], seen[SIZE, j], seen[STEEP, j], 0.0, 0.0
    for i in range(D):
        at[j, i] = 0.0
        for t in range(2 * D + 1):
            at[j, i] += t * min(max(part * tips[t, i] / unit, -FARTHEST), FARTHEST) / (D * (2 * D + 1))
        height += at[2 * CHUNK + j, i] * (at[CHUNK + j, i] - at[j, i])
    for i in range(D):
        one = 0.0
        for k in range(D):
            one += (at[CHUNK + j, k] - at[j, k]) * of_stress[k, i]
        square += one * one
    rise, reach = -level(at, j, q), sqrt(square) * (unit / size)
    if rise > 0.0 and height > 0.0 and reach > 0.0:
        bend = 2.0 * max(height - rise, 0.0) * (unit / size) / steep * seen[DISTANCE, j] / (reach * reach)  # as of a parabola
        seen[HEIGHT, j] = min(height, rise) if KINKS > 0 else height
        seen[REACH, j] = reach * sqrt(1.0 + bend)


def shares(count: int, blur: float, good: float, certain: float, of_slip: Any, at: Any, seen: Any) -> None:
    """Residuals of the level and of the slip's direction, and whether the slip is plainly right."""
    for j in range(count):
        distance, room, turned, steep = seen[DISTANCE, j], seen[ROOM, j], seen[TURNED, j], seen[STEEP, j]
        size, value = seen[SIZE, j], seen[LEVEL, j]
        per, far, whole = 1.0 / size, seen[UNIT, j] / size, distance + room
        a_level = far / (steep * room)
        hidden, depth = seen[HIDDEN, j] * a_level, abs(value) * a_level * room
        height, rounding, inner = seen[HEIGHT, j], 0.0, 0.0
        for i in range(D):
            one = 0.0
            for k in range(D):
                one += abs(seen[SLIPPED + k, j]) * abs(of_slip[k, i])
            rounding += (one * per) * (one * per)
            inner += abs(at[2 * CHUNK + j, i] * at[CHUNK + j, i])
        shallow = (abs(value) + seen[HIDDEN, j]) / height * seen[REACH, j] + seen[GAP, j] + blur * whole
        off = turned / (whole if 2.0 * turned <= ROUNDING * sqrt(rounding) else room)
        long = distance > SHORT * room
        sound = (room > 0.0) & (distance > 0.0) & (height > 0.0) & (seen[GIVEN, j] >= 0.0)
        sound = sound & ((hidden <= NOISE) | (hidden * max(distance / room, 1.0) <= HIDDEN_SHARE))
        sound = sound & ((2.0 * shallow <= good * distance) | long)
        straight = (off <= SUSPECT) & ((2.0 * turned <= good * distance) | long)
        plain = 2.0 * (shallow + turned) <= certain * room  # else a component of it may be off
        beyond = depth / room if 2.0 * depth <= ROUNDING * room else value / inner
        seen[STATE, j] = (PLAIN if plain else LEFT) if sound & straight else (BENT if sound else LEFT)
        seen[OFF, j], seen[SHALLOW, j] = off, shallow
        seen[FEASIBLE, j], seen[COMPLETE, j] = beyond if value > 0.0 else 0.0, min(distance, depth) / room


def looked(count: int, stiffness: Any, of_stress: Any, seen: Any) -> None:
    """How far trial, k slip and stress are from adding up, in the metric and, beyond their rounding, component by component."""
    for j in range(count):
        per, widest, away, fine = 1.0 / seen[SIZE, j], 0.0, 0.0, True
        for i in range(D):
            back = total = 0.0
            for k in range(D):
                back += seen[SLIPPED + k, j] * stiffness[k, i]
                total += abs(seen[SLIPPED + k, j]) * abs(stiffness[k, i])
            missed = seen[TRIAL + i, j] - back - seen[STRESS + i, j]
            much = max(abs(missed) - ROUNDING * (total + abs(seen[TRIAL + i, j]) + abs(seen[STRESS + i, j])), 0.0)
            fine = fine & (abs(missed) < np.inf)
            seen[AIMS + i, j] = much if missed > 0.0 else -much
            widest = max(widest, much)
        for i in range(D):
            one = 0.0
            for k in range(D):
                one += seen[AIMS + k, j] * of_stress[k, i]
            away += (one * per) * (one * per)
        room = seen[ROOM, j]
        off = max(seen[GAP, j] / (seen[AIM, j] + room), widest / seen[UNIT, j], sqrt(away) / room)
        seen[BALANCE, j] = off if fine else np.inf


def tried(count: int, largest: float, ways: Any, reaches: Any, seen: Any) -> None:
    """Whether one of the known points of K may lie beyond the plane through the stress across the slip."""
    for j in range(count):
        part = seen[PRESSURE, j] / largest if largest != 0.0 else 1.0
        work = 0.0
        for i in range(D):
            work += seen[POINTS + i, j] * seen[MOVES + i, j]
        seen[OVER, j], seen[WORK, j], seen[FAR, j] = 0.0, work, part / seen[SIZE, j]
    for t in range(reaches.shape[0]):
        reach = reaches[t]
        for j in range(count):
            along = 0.0
            for i in range(D):
                along += seen[MOVES + i, j] * ways[t, i]
            within = seen[FAR, j] * reach * along <= seen[WORK, j]
            seen[OVER, j] = seen[OVER, j] if within else 1.0


def one_slip(
    j: int, v: Any, a: Any, at: Any, seen: Any, largest: float, pressed: Any, pressed_off: Any, constants: Any, of_slip: Any,
    to_stress: Any, beside: Any, tips: Any, ways: Any, reaches: Any, good: float, certain: float,
) -> tuple[bool, float]:  # fmt: skip
    """Whether corners and known points let a slip pass, and the residual of the latter; what it is off the cone is written down."""
    unit, size, distance, room = seen[UNIT, j], seen[SIZE, j], seen[DISTANCE, j], seen[ROOM, j]
    pressure, over = seen[PRESSURE, j], 0.0
    data, _ = known(pressure, pressed, pressed_off)
    for i in range(D):
        v[S, i], v[POINT, i], v[MOVED, i] = at[CHUNK + j, i], seen[POINTS + i, j], seen[MOVES + i, j]
    if seen[STATE, j] == BENT:
        q, off = sized(data, unit) + constants, np.inf
        if PAIRS > 0:
            off = edged(v, a, q, of_slip, seen[GIVEN, j], size / unit, distance, room, good)
        if CORNERS > 0 and not off <= SUSPECT:
            off = cornered(v, a, q, beside, of_slip, to_stress, seen[GIVEN, j], size / unit, distance, room, good)
        if not (off <= SUSPECT and 2.0 * (seen[SHALLOW, j] + off * room) <= certain * room):
            return False, 0.0
        seen[OFF, j] = off
    if seen[OVER, j] > 0.0:
        part = pressure / largest if largest != 0.0 else 1.0
        over = excess(v, POINT, MOVED, part, tips, ways, reaches, data, constants, 1.0 / size, distance + room, room)
    return CONVEX == 1 or not raised(v, POINT, MOVED, data, constants, to_stress, size, distance, room), over
