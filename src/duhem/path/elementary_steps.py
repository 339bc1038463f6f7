"""Exact motion of the stress over one step in elementary functions: straight on quarter ellipses, and round a circle on a disk.

With sigma = e (a cos theta, b sin theta), e > 0 the load, diagonal k and a constant displacement rate u', the slipping
stress obeys

    theta' = V sin(theta_v - theta)/(A sin^2 theta + B cos^2 theta),   A = e a^2/k_a,  B = e b^2/k_b,
    V (cos theta_v, sin theta_v) = (a u'_a, b u'_b),

so that D ln tan(|delta|/2) + (B - A) cos(theta_v + theta) + V tau is constant, delta = theta_v - theta, D = A sin^2 theta_v
+ B cos^2 theta_v; the multiplier is D ln(sin delta_0/sin delta_1) + (B - A)/2 sin(2 theta_v) (theta_1 - theta_0).
For A = B this is Krieg and Krieg (1977), J. Pressure Vessel Technol. 99, 510-515.  A straight step never unloads: in the
metric of k^-1 the speed of the stress does not grow (Moreau, 1977).  Angles are kept as unit vectors, and differences of angles
as tangents of their halves, so that nothing cancels.

On |sigma| = a, with isotropic k and u = centre + rho (cos psi, sin psi), the stress lags the velocity by alpha,

    d alpha/d psi = 1 - kappa sin alpha,   kappa = k rho/a,

(R. Adler, 1946, Proc. IRE 34, 351-357).  With tan(alpha/2) = p/q it is linear: d(p, q)/d psi = M (p, q)/2, M = [[-kappa, 1],
[-1, kappa]], M^2 = (kappa^2 - 1) I, so exp(psi M/2) = cosh(s psi/2) + M sinh(s psi/2)/s for kappa > 1, cos and sin for
kappa < 1.  As q^2 + p^2 - 2 kappa p q is constant, the work per turn is a rho ln(|(p, q)|^2)/kappa.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import acos, atan, atan2, copysign, cos, exp, expm1, frexp, hypot, inf, isfinite, ldexp, log, log1p, pi, sin, sqrt, tanh

__all__ = ["Move", "Pair", "on_disk", "on_ellipse", "on_interval"]

Pair = tuple[float, float]
_MOST_ITERATIONS = 200
_LAST = 1e-12  # a share: Newton's error is squared in each step, so the step after one this small would change nothing


@dataclass(frozen=True)
class Move:
    """What a step did: final stress (relative to the centre), multiplier, and the integrals of |load| lambda and sigma . du.

    ``free`` is the part of the step, from 0 to 1, that passed without slip.
    """

    stress: tuple[float, ...]
    multiplier: float
    dissipation: float
    work: float
    free: float


def on_ellipse(stress: Pair, du: Pair, load: float, coefficients: Sequence[float], k: Pair) -> Move:
    """From ``stress`` in K (about its centre) along ``du``; coefficients (a_plus, a_minus, b_plus, b_minus) > 0, load > 0."""
    if du[0] == du[1] == 0.0:  # even where rounding has put the stress outside
        return Move(stress, 0.0, 0.0, 0.0, 1.0)
    q = (k[0] * du[0], k[1] * du[1])
    free, w = _exit(stress, q, load, coefficients)
    if w is None:
        end = (stress[0] + q[0], stress[1] + q[1])
        return Move(end, 0.0, 0.0, _mean_work(stress, q, du, 1.0), 1.0)
    work = _mean_work(stress, q, du, free)
    left, multiplier, power = 1.0 - free, 0.0, 0.0
    while left > 0.0:
        signs = copysign(1.0, w[0] or du[0]), copysign(1.0, w[1] or du[1])
        a, b = _of_quarter(coefficients, *signs)
        w, used, gained, done = _in_quarter(w, (a * du[0], b * du[1]), load * a * a / k[0], load * b * b / k[1], signs, left)
        multiplier += gained
        power += done
        left -= used
    a, b = _of_quarter(coefficients, *w)
    return Move((a * load * w[0], b * load * w[1]), multiplier, load * multiplier, work + load * power, free)


def _of_quarter(coefficients: Sequence[float], x: float, y: float) -> Pair:
    return coefficients[1] if x < 0.0 else coefficients[0], coefficients[3] if y < 0.0 else coefficients[2]


def _mean_work(stress: Pair, q: Pair, du: Pair, part: float) -> float:
    return part * ((stress[0] + 0.5 * part * q[0]) * du[0] + (stress[1] + 0.5 * part * q[1]) * du[1])


def _exit(s: Pair, q: Pair, e: float, mu: Sequence[float]) -> tuple[float, Pair | None]:
    """Where s + tau q leaves K, 0 <= tau < 1, and the direction (cos theta, sin theta) there; None if it stays inside.

    Each piece starts at its seam: seen in the units of a thin quarter, the start of the step would be far away.
    """
    seams = sorted((tau, i) for i in (0, 1) if q[i] and 0.0 < (tau := -s[i] / q[i]) < 1.0)
    start = 0.0
    for end, i in [*seams, (1.0, -1)]:
        part = end - start
        m, n = _of_quarter(mu, s[0] + 0.5 * part * q[0], s[1] + 0.5 * part * q[1])
        p, r = (s[0] / (m * e), s[1] / (n * e)), (q[0] / (m * e), q[1] / (n * e))
        if hypot(p[0] + part * r[0], p[1] + part * r[1]) > 1.0:
            unit = frexp(max(abs(r[0]), abs(r[1])))[1] - 1  # a power of two, lest the square of a short step underflow
            r = ldexp(r[0], -unit), ldexp(r[1], -unit)
            a, b = r[0] * r[0] + r[1] * r[1], p[0] * r[0] + p[1] * r[1]
            size = hypot(*p)
            c = (size - 1.0) * (size + 1.0)
            square = b * b - a * c
            if not isfinite(square):  # it would pass for rest
                raise OverflowError("the distance to the boundary overflows or underflows")
            root = sqrt(max(square, 0.0))
            way = (root - b) / a if b <= 0.0 else -c / (b + root)
            way = min(max(way, 0.0), ldexp(part, unit))
            tau = start + ldexp(way, -unit)
            x, y = p[0] + way * r[0], p[1] + way * r[1]
            length = hypot(x, y)
            if tau < 1.0:  # at a tangent start too: the straight line leaves the convex set at once
                return tau, (x / length, y / length)
        start, s = end, (0.0 if i == 0 else s[0] + part * q[0], 0.0 if i == 1 else s[1] + part * q[1])
    return 1.0, None


def _in_quarter(w: Pair, v: Pair, big_a: float, big_b: float, signs: Sequence[float], left: float) -> tuple[Pair, float, float, float]:
    """Slip in one quarter for a time ``left`` or up to its end: new w, time used, multiplier, integral of u'.(a cos, b sin)."""
    speed = hypot(*v)
    v = (v[0] / speed, v[1] / speed)
    cross, dot = w[0] * v[1] - w[1] * v[0], w[0] * v[0] + w[1] * v[1]
    if cross == 0.0 or (start := abs(cross) / (1.0 + dot) if dot > 0.0 else (1.0 - dot) / abs(cross)) < 1e-150:
        return w, left, speed * left, speed * left
    sense = copysign(1.0, cross)
    rest = big_b - big_a
    at_v = big_a * v[1] * v[1] + big_b * v[0] * v[0]
    s0, c0 = v[1] * w[0] + v[0] * w[1], v[0] * w[0] - v[1] * w[1]

    def turned(y: float) -> tuple[float, float, Pair, float]:
        """Once ln tan(|delta|/2) has changed by y <= 0: the time this takes, times the speed, and by how much it falls as y grows; w, and
        the tangent of half the angle travelled."""
        h = -start * expm1(y) / (1.0 + start * start * exp(y))
        c = 1.0 / sqrt(1.0 + h * h)
        s = h * c
        time = -at_v * y + 2.0 * rest * sense * s * (s0 * c + sense * c0 * s)
        cos, sin = (c - s) * (c + s), 2.0 * s * c * sense
        new = cos * w[0] - sin * w[1], sin * w[0] + cos * w[1]
        return time, big_a * new[1] * new[1] + big_b * new[0] * new[0], new, h

    axis = (0.0, signs[1]) if signs[0] * signs[1] * sense > 0.0 else (signs[0], 0.0)
    beyond = sense * (axis[0] * v[1] - axis[1] * v[0])
    least = -inf
    total, slowest = speed * left, min(big_a, big_b)
    if beyond > 0.0:
        along = axis[0] * v[0] + axis[1] * v[1]
        seam = beyond / (1.0 + along) if along > 0.0 else (1.0 - along) / beyond
        least = min(log(seam / start), 0.0)
    near = least > -inf and -slowest * least <= 2.0 * total  # it takes -slowest least at least
    if near and (time := max((there := turned(least))[0], 0.0)) <= total:
        y, new, used = least, axis, min(time / speed, left)
    else:
        y = _solved(turned, big_a * w[1] * w[1] + big_b * w[0] * w[0], total, max(least, -total / slowest))
        there = turned(y)
        new, used = _unit(there[2]), left
    travelled = 2.0 * atan(there[3])
    e1 = exp(y)
    fall = -y - log1p(start * start * -expm1(2.0 * y) / (1.0 + start * start * e1 * e1))
    gained = max(at_v * fall + rest * v[0] * v[1] * sense * travelled, 0.0)
    return new, used, gained, gained + 0.5 * rest * (new[1] - w[1]) * (new[1] + w[1])


def _solved(turned: Callable[[float], tuple[float, float, Pair, float]], slope: float, total: float, low: float) -> float:
    """y in [low, 0] at which ``turned`` takes the time ``total``, which falls as y grows, by ``slope`` at 0.  Newton, kept in a bracket."""
    high, y, f = 0.0, 0.0, -total
    for _ in range(_MOST_ITERATIONS):
        new = y + (step := f / slope)
        if abs(step) <= _LAST * abs(new):
            return min(max(new, low), high)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - y) <= 2e-16 * abs(new):
            return new
        y = new
        f, slope, _, _ = turned(y)
        f -= total
        if f > 0.0:
            low = y
        else:
            high = y
    return y


def _unit(w: Pair) -> Pair:
    length = hypot(*w)
    return w[0] / length, w[1] / length


def on_interval(stress: float, du: float, loads: Pair, coefficients: Sequence[float], k: float) -> Move:
    """One force between -minus load and plus load, the load going straight from loads[0] to loads[1]."""
    q, rate = k * du, loads[1] - loads[0]
    limits = [(coefficients[0], 1.0), (coefficients[1], -1.0)]
    for mu, sign in limits:
        gap, closing = mu * loads[0] - sign * stress, sign * q - mu * rate
        if closing > 0.0 and gap < closing:
            free = max(gap, 0.0) / closing
            left = 1.0 - free
            met = loads[0] + free * rate
            slip = left * (sign * du - mu * rate / k)
            mean = mu * 0.5 * (met + loads[1])
            work = free * (stress + 0.5 * free * q) * du + left * sign * mean * du
            return Move((sign * mu * loads[1],), mu * slip, mean * slip, work, free)
    return Move((stress + q,), 0.0, 0.0, (stress + 0.5 * q) * du, 1.0)


_APART = 1e-6  # rad; after slip ends at a tangent, the same point of contact is not met again so soon


def on_disk(stress: Pair, radius: float, start: float, sweep: float, limit: float, k: float) -> Move:
    """From ``stress`` in the disk |sigma| <= ``limit`` along the arc from the angle ``start`` over ``sweep`` (rad, of either sign).

    The multiplier is that of the gauge |sigma|: the length of the slip.
    """
    if sweep < 0.0:  # the mirror image in the first axis
        seen = on_disk((stress[0], -stress[1]), radius, -start, -sweep, limit, k)
        return Move((seen.stress[0], -seen.stress[1]), seen.multiplier, seen.dissipation, seen.work, seen.free)
    psi, end, slipped, free, work = start, start + sweep, 0.0, 0.0, 0.0
    reach, kappa = k * radius, k * radius / limit
    (x, y), released = stress, False
    while psi < end:
        stop = min(_contact((x, y), psi, reach, limit, released), end)
        if stop > psi:
            half = 0.5 * (stop - psi)
            chord, way = 2.0 * reach * sin(half), psi + half + 0.5 * pi
            dx, dy = chord * cos(way), chord * sin(way)
            work += (dx * (2.0 * x + dx) + dy * (2.0 * y + dy)) / (2.0 * k)
            x, y, free, psi = x + dx, y + dy, free + (stop - psi), stop
            if psi >= end:
                break
        alpha = psi + 0.5 * pi - atan2(y, x)
        alpha -= 2.0 * pi * round(alpha / (2.0 * pi))
        alpha = min(max(alpha, -0.5 * pi), 0.5 * pi)
        turn = min(end - psi, _unloading(alpha, kappa))
        lag, grown = _lag(alpha, turn, kappa)
        slipped += radius / kappa * max(grown, 0.0)
        psi, released = (end if turn >= end - psi else psi + turn), True
        angle = psi + 0.5 * pi - lag
        x, y = limit * cos(angle), limit * sin(angle)
    return Move((x, y), slipped, limit * slipped, work + limit * slipped, free / sweep)


def _contact(s: Pair, psi: float, reach: float, limit: float, released: bool) -> float:
    """The angle, from ``psi`` on, at which the stress would leave the disk if it did not slip."""
    outward = s[1] * cos(psi) - s[0] * sin(psi)
    if not released and outward > 0.0 and hypot(*s) >= limit * (1.0 - 1e-14):
        return psi
    x, y = s[0] - reach * cos(psi), s[1] - reach * sin(psi)
    far = hypot(x, y)
    if far == 0.0 or (level := ((limit - far) * (limit + far) - reach * reach) / (2.0 * reach * far)) >= 1.0:
        return inf
    ahead = (atan2(y, x) - acos(max(level, -1.0)) - psi) % (2.0 * pi)
    return psi + ahead + (2.0 * pi if released and ahead < _APART else 0.0)


def _unloading(alpha: float, kappa: float) -> float:
    """How far the arc goes until the lag reaches a right angle, where slip ends; never for kappa >= 1."""
    if kappa >= 1.0:
        return inf
    p, q = sin(0.5 * alpha), cos(0.5 * alpha)
    s = sqrt((1.0 - kappa) * (1.0 + kappa))
    return 2.0 * atan2(s * (q - p), (1.0 - kappa) * (q + p)) / s


def _lag(alpha: float, turn: float, kappa: float) -> Pair:
    """The lag after ``turn``, and the growth of ln |(p, q)|^2."""
    p, q, half = sin(0.5 * alpha), cos(0.5 * alpha), 0.5 * turn
    s = sqrt(abs((kappa - 1.0) * (kappa + 1.0)))
    x = s * half
    if kappa > 1.0:  # relative to cosh, which may be too large to write down
        c, t, size = 1.0, tanh(x) / s, 2.0 * (x + log1p(exp(-2.0 * x)) - log(2.0))
    elif kappa < 1.0:
        c, t, size = cos(x), sin(x) / s, 0.0
    else:
        c, t, size = 1.0, half, 0.0
    p, q = c * p + t * (q - kappa * p), c * q + t * (kappa * q - p)
    return 2.0 * atan2(p, q), size + log(p * p + q * q)
