"""One point at a time: what the judge says of a point that is plainly right, and which points it has to look at itself.

The conditions and formulas are those of :mod:`duhem.projection.residuals`.  Every threshold beyond which that looks closer is halved
here, and a point that passes none of them, or has a residual of more than half of what is accurate, is left to it: so both say the
same of every point, whatever the last digits of either.  Compiled with the functions of one law, whose names stand
below without a body, as :mod:`duhem.projection.newton_kernel` is.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy import sqrt

from duhem.projection.corner_kernel import CORNER, cornered
from duhem.projection.newton_step import below, grown, length

__all__ = ["INLINED", "SLIP", "STICK", "UNJUDGED", "judge"]

D = DATA = 0  # how many forces and data the law has


def level(v: Any, x: int, q: Any) -> float:
    """h at row ``x`` of ``v``."""
    raise NotImplementedError


def gradient(v: Any, x: int, q: Any, slopes: int) -> None:
    """dh/ds there into the row ``slopes``."""
    raise NotImplementedError


def bounded(v: Any, x: int, q: Any, b: Any) -> tuple[float, float]:
    """h there and a bound of its rounding; ``b`` bounds what ``q`` is off by."""
    raise NotImplementedError


def resized(data: Any, n: int, size: float, q: Any) -> None:
    """The data of point ``n`` in units of another size."""
    raise NotImplementedError


INLINED = ("balance", "below", "bounded", "gradient", "length", "placed", "resized", "slid", "stuck", "turned_share", "unit_of")
"""Functions that every slip goes through, most of them once."""

# -- compiled from here ----------------------------------------------------------------------------------------

STICK, SLIP, UNJUDGED = 0, 1, -1
ROUNDING, NOISE, HIDDEN, SUSPECT, SHORT, ACCURACY = 4e-15, 0.5e-13, 0.5e-9, 0.5e-9, 20.0, 0.5e-7
ENDS = 2.0**-1017, 2.0**1020
RAISE, ASIDE = 4e-7, (0.3, 0.03, 0.003)  # as of known points beside a stress
# Rows of v: stress over its unit, gradient of h; trial, stress, k slip and lambda k n in the metric over their size; a known point;
# a way across the slip, the slip's direction; room.
S, SLOPE, AIM, POINT, MOVED, PULL, TAU, WAY, NORMAL, HERE, ROWS = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10


def judge(
    trial: Any, part: Any, data: Any, offs: Any, constants: Any, constants_off: Any, stiffness: Any, of_slip: Any, of_stress: Any,
    to_stress: Any, beside: Any, tips: Any, ways: Any, reaches: Any, blur: float, good: float, certain: float, degree: float, convex: bool,
    stress: Any, slip: Any, multiplier: Any, dissipation: Any, status: Any, found: Any,
) -> None:  # fmt: skip
    """Dissipation, status (``UNJUDGED`` where it is left open) and residuals, a row of ``found`` each, of every point.

    Lengths are taken over powers of two, ``unit`` of a stress and ``size`` of all of the metric; ``per`` is 1/size.  ``part`` (N,)
    the pressures as parts of the one at which the ``tips`` of K are known, ``ways`` and ``reaches`` their directions and lengths in
    the metric; ``beside`` ways off a point, where the normals of a corner are looked for; the matrices as in
    :class:`duhem.projection.metric.Metric`.
    """
    v, a, q, b = np.empty((ROWS, D)), np.empty((CORNER, 2 * D + 1)), np.empty(DATA + len(constants)), np.empty(DATA + len(constants))
    for k in range(len(constants)):
        q[DATA + k], b[DATA + k] = constants[k], constants_off[k]
    for n in range(trial.shape[0]):
        work, moved = 0.0, multiplier[n] != 0.0
        for i in range(D):
            work += stress[n, i] * slip[n, i]
            moved = moved or slip[n, i] != 0.0 or stress[n, i] != trial[n, i]
        dissipation[n] = work
        for k in range(5):
            found[k, n] = 0.0
        unit = unit_of(stress, n)
        status[n] = UNJUDGED
        if not moved:
            if stuck(v, data, offs, n, unit, stress, q, b):
                status[n] = STICK
        elif slid(v, a, n, unit, trial, part, data, offs, q, b, stiffness, of_slip, of_stress, to_stress, beside, tips, ways, reaches,
                  blur, good, certain, degree, convex, stress, slip, multiplier, found):  # fmt: skip
            status[n] = SLIP


def unit_of(stress: Any, n: int) -> float:
    """The power of two below the largest component, 1 of a zero."""
    big = 0.0
    for i in range(D):
        big = max(big, abs(stress[n, i]))
    return below(big) if isfinite(big) and big > 0.0 else 1.0


def placed(v: Any, data: Any, offs: Any, n: int, unit: float, stress: Any, q: Any, b: Any) -> None:
    """The stress and the data over their unit, with what the data are off by."""
    per = 1.0 / unit  # exact, and a product is sooner done
    for i in range(D):
        v[S, i] = stress[n, i] * per
    resized(data, n, unit, q)
    resized(offs, n, unit, b)


def stuck(v: Any, data: Any, offs: Any, n: int, unit: float, stress: Any, q: Any, b: Any) -> bool:
    """Whether the stress lies in K for sure."""
    placed(v, data, offs, n, unit, stress, q, b)
    value, hidden = bounded(v, S, q, b)
    return isfinite(value) and value < -2.0 * hidden


def slid(
    v: Any, a: Any, n: int, unit: float, trial: Any, part: Any, data: Any, offs: Any, q: Any, b: Any, stiffness: Any, of_slip: Any,
    of_stress: Any, to_stress: Any, beside: Any, tips: Any, ways: Any, reaches: Any, blur: float, good: float, certain: float,
    degree: float, convex: bool, stress: Any, slip: Any, multiplier: Any, found: Any,
) -> bool:  # fmt: skip
    """Whether the residuals of a slip are plainly fine; they are written down."""
    placed(v, data, offs, n, unit, stress, q, b)
    value, hidden = bounded(v, S, q, b)
    gradient(v, S, q, SLOPE)
    size = 0.0
    for i in range(D):
        v[AIM, i] = v[POINT, i] = v[MOVED, i] = v[PULL, i] = 0.0
        for k in range(D):
            v[AIM, i] += trial[n, k] * of_stress[k, i]
            v[POINT, i] += stress[n, k] * of_stress[k, i]
            v[MOVED, i] += slip[n, k] * of_slip[k, i]
            v[PULL, i] += v[SLOPE, k] * of_slip[k, i]
        size = max(size, abs(v[AIM, i]), abs(v[POINT, i]))
    steep = length(v, PULL)
    if not (size > 0.0 and isfinite(size) and steep > 0.0 and isfinite(steep)):
        return False
    size = below(size)
    per, far = 1.0 / size, unit / size
    gap = turned = 0.0
    given = multiplier[n]
    if degree != 1.0:
        own = grown(length(v, MOVED) / steep, unit, 1.0 - degree)
        if not ENDS[0] < own < ENDS[1]:
            return False
        given = grown(given, unit, degree - 1.0)
    given *= per
    for i in range(D):
        v[AIM, i], v[POINT, i], v[MOVED, i] = v[AIM, i] * per, v[POINT, i] * per, v[MOVED, i] * per
        v[PULL, i] *= given
        rest, across = v[AIM, i] - v[MOVED, i] - v[POINT, i], v[MOVED, i] - v[PULL, i]
        gap += rest * rest
        turned += across * across
    gap, turned = sqrt(gap), sqrt(turned)
    distance, room, aim = length(v, MOVED), length(v, POINT), length(v, AIM)
    if not (room > 0.0 and distance > 0.0 and given >= 0.0):
        return False
    whole = distance + room
    hidden *= far / (steep * room)
    if not (hidden <= NOISE or hidden * max(distance / room, 1.0) <= HIDDEN):
        return False
    depth = abs(value) / steep * far
    shallow = depth + gap + hidden * room + blur * whole
    if not (2.0 * shallow <= good * distance or distance > SHORT * room):
        return False
    astray, off = turned, turned_share(v, n, slip, of_slip, per, turned, whole, room)
    if not (off <= SUSPECT and (2.0 * turned <= good * distance or distance > SHORT * room)):
        off = cornered(v, a, q, beside, of_slip, to_stress, given, size / unit, distance, room, good)
        astray = off * room
    if not (off <= SUSPECT and 2.0 * (shallow + astray) <= certain * room):  # else a component of it may be off
        return False
    found[3, n] = max(off, balance(v, n, trial, stress, slip, stiffness, of_stress, gap, aim, room, unit, per))
    if value > 0.0:
        inner = 0.0
        for i in range(D):
            inner += abs(v[SLOPE, i]) * abs(v[S, i])
        found[0, n] = depth / room if 2.0 * depth <= ROUNDING * room else value / inner
    found[2, n] = min(distance, depth) / room
    found[4, n] = excess(v, n, part, tips, ways, reaches, data, q, per, whole, room)
    for k in range(5):
        if not found[k, n] <= ACCURACY:
            return False
    return convex or not raised(v, data, q, n, to_stress, size, distance, room)


def turned_share(v: Any, n: int, slip: Any, of_slip: Any, per: float, turned: float, whole: float, room: float) -> float:
    """What the slip is off the normal by, as a share of slip and stress where it is rounding, else of the stress."""
    rounding = 0.0
    for i in range(D):
        one = 0.0
        for k in range(D):
            one += abs(slip[n, k]) * abs(of_slip[k, i])
        rounding += (one * per) * (one * per)
    return turned / (whole if 2.0 * turned <= ROUNDING * sqrt(rounding) else room)


def balance(
    v: Any, n: int, trial: Any, stress: Any, slip: Any, stiffness: Any, of_stress: Any, gap: float, aim: float, room: float, unit: float,
    per: float,
) -> float:  # fmt: skip
    """How far trial, k slip and stress are from adding up, in the metric and, beyond their rounding, component by component."""
    widest = away = 0.0
    for i in range(D):
        back = sum_ = 0.0
        for k in range(D):
            back += slip[n, k] * stiffness[k, i]
            sum_ += abs(slip[n, k]) * abs(stiffness[k, i])
        missed = trial[n, i] - back - stress[n, i]
        much = max(abs(missed) - ROUNDING * (sum_ + abs(trial[n, i]) + abs(stress[n, i])), 0.0)
        if not isfinite(missed):
            return np.inf
        v[TAU, i] = much if missed > 0.0 else -much
        widest = max(widest, much)
    if widest > 0.0:
        for i in range(D):
            one = 0.0
            for k in range(D):
                one += v[TAU, k] * of_stress[k, i]
            away += (one * per) * (one * per)
    return max(gap / (aim + room), widest / unit, sqrt(away) / room)


def excess(
    v: Any, n: int, part: Any, tips: Any, ways: Any, reaches: Any, data: Any, q: Any, per: float, whole: float, room: float
) -> float:
    """The largest (sigma_tr - sigma) . k^-1 (tau - sigma) over the known points tau that lie in K at this pressure, relative."""
    worst = work = 0.0
    for i in range(D):
        work += v[POINT, i] * v[MOVED, i]
    for j in range(tips.shape[0]):
        away = part[n] * (reaches[j] * per)
        along = 0.0
        for i in range(D):
            along += v[MOVED, i] * ways[j, i]
        over = away * along - work
        if over > 0.0:
            relative = over / (whole * (away + room))
            if relative > worst:
                big = 0.0
                for i in range(D):
                    big = max(big, abs(part[n] * tips[j, i]))
                if not isfinite(big):
                    return np.inf
                unit = below(big) if big > 0.0 else 1.0
                for i in range(D):
                    v[TAU, i] = part[n] * tips[j, i] / unit
                resized(data, n, unit, q)
                high = level(v, TAU, q)
                if not high > 0.0 or (relative > ACCURACY and not high > 1e-6):  # near the boundary: not for a filter to say
                    worst = relative
    return worst


def raised(v: Any, data: Any, q: Any, n: int, to_stress: Any, size: float, distance: float, room: float) -> bool:
    """Whether K goes beyond the plane through the stress across the slip, somewhere close to it, or may."""
    for i in range(D):
        v[NORMAL, i] = v[MOVED, i] / distance
    for axis in range(D if D > 2 else D - 1):
        across = 0.0
        for i in range(D):
            v[WAY, i] = (1.0 if i == axis else 0.0) - v[NORMAL, axis] * v[NORMAL, i]
            if D == 2:
                v[WAY, i] = v[NORMAL, 0] if i == 1 else -v[NORMAL, 1]
            across += v[WAY, i] * v[WAY, i]
        across = sqrt(across) if across > 0.0 else 1.0
        for sense in (-1.0, 1.0):
            for share in ASIDE:
                big = 0.0
                for i in range(D):
                    v[HERE, i] = v[POINT, i] + share * room * sense * v[WAY, i] / across + RAISE * room * v[NORMAL, i]
                for i in range(D):
                    one = 0.0
                    for k in range(D):
                        one += v[HERE, k] * to_stress[k, i]
                    v[TAU, i] = size * one
                    big = max(big, abs(v[TAU, i]))
                if not (isfinite(big) and big > 0.0):
                    return True
                unit = below(big)
                for i in range(D):
                    v[TAU, i] /= unit
                resized(data, n, unit, q)
                if not level(v, TAU, q) > 0.0:
                    return True
    return False
