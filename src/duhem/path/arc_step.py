"""Exact motion on a disk under a displacement that runs round a circle: Adler's equation.

On |sigma| = a, with isotropic k and u = centre + rho (cos psi, sin psi), the stress lags the velocity by alpha,

    d alpha/d psi = 1 - kappa sin alpha,   kappa = k rho/a,

(R. Adler, 1946, Proc. IRE 34, 351-357).  With tan(alpha/2) = p/q it is linear: d(p, q)/d psi = M (p, q)/2, M = [[-kappa, 1],
[-1, kappa]], M^2 = (kappa^2 - 1) I, so exp(psi M/2) = cosh(s psi/2) + M sinh(s psi/2)/s for kappa > 1, cos and sin for
kappa < 1.  As q^2 + p^2 - 2 kappa p q is constant, the work per turn is a rho ln(|(p, q)|^2)/kappa.
"""

from __future__ import annotations

from math import acos, atan2, cos, exp, hypot, inf, log, log1p, pi, sin, sqrt, tanh

from duhem.path.straight_step import Move, Pair

__all__ = ["on_disk"]

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
