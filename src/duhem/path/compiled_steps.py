"""Implicit steps through numba, for the shapes a law declares: whole stretches of paths without a word of Python in between.

Two loops with one arithmetic.  ``abreast`` takes many points of one law from knot to knot, so that the compiled kernel of the
quarter ellipses sees rows of them; ``alone`` follows one point after the other, each with numbers of its own.  The sums are
those of :mod:`duhem.path.batch_steps`; the closest points differ from NumPy's in the last digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from duhem.projection.compiled import kernels
from duhem.projection.quarter_ellipse import formulas
from duhem.projection.result import Status

__all__ = ["Loops", "made"]

_ROW = 504  # points abreast: as many as the kernel looks at together
_STICK, _SLIP, _FAILED = int(Status.STICK), int(Status.SLIP), int(Status.FAILED)


@dataclass(frozen=True)
class Loops:
    """``abreast`` for points of one law on quarter ellipses, ``quarters`` and ``interval`` for points with constants of their own.

    Arguments: ``values`` (n, m, d) and ``factor`` (n, d), whose product is the displacement; ``load``, ``share`` (n, m) and ``centre``
    (n, m, d) of K, with one row or column where all are alike; stiffness and compliance (d, d).  ``state`` (n, 4 d + 6): stress,
    slip, stress and displacement from which nothing has slipped, then multiplier, psi, dissipation, work, numerical loss and balance;
    ``status``, ``reached`` (n,).  The constants of the shapes, and but for ``abreast`` which of them each point has.  The first knot
    and the one not to reach any more; ``row`` (m,) of each knot in what is kept, -1 for none; and what is kept: stress and slip
    (n, r, d) and the six sums (n, r).  States and what is kept are written to.
    """

    abreast: Callable[..., None]
    quarters: Callable[..., None]
    interval: Callable[..., None]


@cache
def made() -> Loops:
    """The loops, made anew in each process and compiled at their first use (tens of seconds): what is kept of them calls these."""
    import numba

    jit: Callable[[Any], Any] = numba.njit(error_model="numpy", forceinline=True)
    free: Callable[[Any], Any] = numba.njit(error_model="numpy", nogil=True)
    run, single = kernels()

    @jit
    def where(condition: bool, a: float, b: float) -> float:
        return a if condition else b

    product = formulas(jit, where).product

    @jit
    def pick(array: Any, point: int, knot: int) -> Any:
        return array[point if array.shape[0] > 1 else 0, knot if array.shape[1] > 1 else 0]

    @jit
    def added(total: float, x: float) -> float:
        """0 as long as every x is finite."""
        return total + x * 0.0

    # -- many points from knot to knot ---------------------------------------------------------------------------

    @jit
    def pulled(
        s: Any, values: Any, factor: Any, load: Any, centre: Any, k: Any, begin: int, size: int, knot: int, trial: Any, e: Any
    ) -> None:
        """Displacements at the knot into rows 16 and 17, and the trial stresses about the centre."""
        k00, k01, k10, k11 = k[0, 0], k[0, 1], k[1, 0], k[1, 1]
        if values.shape[0] == 1:
            v1, v2 = values[0, knot, 0], values[0, knot, 1]
            for j in range(size):
                s[16, j], s[17, j] = v1, v2
        else:
            for j in range(size):
                s[16, j], s[17, j] = values[begin + j, knot, 0], values[begin + j, knot, 1]
        if factor.shape[0] == 1:
            f1, f2 = factor[0, 0], factor[0, 1]
            for j in range(size):
                s[16, j] *= f1
                s[17, j] *= f2
        else:
            for j in range(size):
                s[16, j] *= factor[begin + j, 0]
                s[17, j] *= factor[begin + j, 1]
        for j in range(size):
            d1, d2 = s[16, j] - s[6, j], s[17, j] - s[7, j]
            s[18, j] = s[4, j] + (d1 * k00 + d2 * k10)
            s[19, j] = s[5, j] + (d1 * k01 + d2 * k11)
        for j in range(size):
            trial[2 * j], trial[2 * j + 1] = s[18, j], s[19, j]
        if load.shape[0] == 1:
            e0 = pick(load, 0, knot)
            for j in range(size):
                e[j] = e0
        else:
            column = knot if load.shape[1] > 1 else 0
            for j in range(size):
                e[j] = load[begin + j, column]
        if centre.shape[0] > 1:
            column = knot if centre.shape[1] > 1 else 0
            for j in range(size):
                trial[2 * j] -= centre[begin + j, column, 0]
                trial[2 * j + 1] -= centre[begin + j, column, 1]
        else:
            column = knot if centre.shape[1] > 1 else 0
            x1, x2 = centre[0, column, 0], centre[0, column, 1]
            if x1 != 0.0 or x2 != 0.0:
                for j in range(size):
                    trial[2 * j] -= x1
                    trial[2 * j + 1] -= x2

    @jit
    def booked(s: Any, share: Any, centre: Any, k: Any, c: Any, begin: int, size: int, knot: int, stress: Any, slip: Any, lam: Any) -> None:
        """What the step adds.  Rows of ``s``: 0 stress, 2 slip, 4 and 6 anchor, 8 the six sums, 14 on its way, 15 slips."""
        k00, k01, k10, k11 = k[0, 0], k[0, 1], k[1, 0], k[1, 1]
        c00, c01, c10, c11 = c[0, 0], c[0, 1], c[1, 0], c[1, 1]
        if share.shape[0] > 1:
            for j in range(size):
                lam[j] *= pick(share, begin + j, knot)
        else:
            alike = pick(share, 0, knot)
            for j in range(size):
                lam[j] *= alike
        if centre.shape[0] > 1:
            column = knot if centre.shape[1] > 1 else 0
            for j in range(size):
                stress[2 * j] += centre[begin + j, column, 0]
                stress[2 * j + 1] += centre[begin + j, column, 1]
        else:
            column = knot if centre.shape[1] > 1 else 0
            x1, x2 = centre[0, column, 0], centre[0, column, 1]
            if x1 != 0.0 or x2 != 0.0:
                for j in range(size):
                    stress[2 * j] += x1
                    stress[2 * j + 1] += x2
        for j in range(size):
            p1, p2, multiplier = slip[2 * j], slip[2 * j + 1], lam[j]
            slips = (p1 != 0.0) | (p2 != 0.0) | (multiplier > 0.0)
            b1, b2, u1, u2, before = s[0, j], s[1, j], s[16, j], s[17, j], s[9, j]
            t1, t2 = where(slips, stress[2 * j], s[18, j]), where(slips, stress[2 * j + 1], s[19, j])
            d1, d2 = u1 - s[20, j], u2 - s[21, j]
            e1, e2, g1, g2 = d1 - p1, d2 - p2, t1 - b1, t2 - b2
            psi = 0.5 * (t1 * (t1 * c00 + t2 * c10) + t2 * (t1 * c01 + t2 * c11))
            gained = (0.5 * (b1 + t1)) * (g1 * c00 + g2 * c10) + (0.5 * (b2 + t2)) * (g1 * c01 + g2 * c11)
            lost = where(slips, t1 * p1 + t2 * p2, 0.0)
            work = where(slips, t1 * d1 + t2 * d2, gained)
            numerical = where(slips, 0.5 * (e1 * (e1 * k00 + e2 * k10) + e2 * (e1 * k01 + e2 * k11)), 0.0)
            balance = s[13, j] + (work - (psi - before) - lost - numerical)
            q1, q2, multiplier = s[2, j] + p1, s[3, j] + p2, s[8, j] + multiplier
            lost, work, numerical = s[10, j] + lost, s[11, j] + work, s[12, j] + numerical
            states = (t1 * 0.0 + t2 * 0.0) + (q1 * 0.0 + q2 * 0.0)
            whole = (states + (multiplier * 0.0 + psi * 0.0)) + ((lost * 0.0 + work * 0.0) + (numerical * 0.0 + balance * 0.0))
            go = (s[14, j] > 0.0) & (whole == 0.0)
            moved = go & slips
            s[4, j], s[5, j] = where(moved, t1, s[4, j]), where(moved, t2, s[5, j])
            s[6, j], s[7, j] = where(moved, u1, s[6, j]), where(moved, u2, s[7, j])
            s[0, j], s[1, j] = where(go, t1, b1), where(go, t2, b2)
            s[2, j], s[3, j] = where(go, q1, s[2, j]), where(go, q2, s[3, j])
            s[8, j], s[9, j] = where(go, multiplier, s[8, j]), where(go, psi, before)
            s[10, j], s[11, j] = where(go, lost, s[10, j]), where(go, work, s[11, j])
            s[12, j], s[13, j] = where(go, numerical, s[12, j]), where(go, balance, s[13, j])
            on = where(go, 1.0, 0.0)
            s[14, j], s[15, j], s[22, j] = on, where(slips, 1.0, 0.0), s[22, j] + on
            s[20, j], s[21, j] = u1, u2

    @free
    def abreast(
        values: Any, factor: Any, load: Any, share: Any, centre: Any, k: Any, c: Any, state: Any, status: Any, reached: Any,
        quarters: Any, first: int, last: int, row: Any, stress: Any, slip: Any, sums: Any,
    ) -> None:  # fmt: skip
        mu, axes, low, ratio, compliance, power, place = quarters
        multiplier, psi, dissipation, work, numerical, balance = sums
        n = state.shape[0]
        s = np.empty((23, _ROW))
        trial, e, near, moved, lam = np.empty((_ROW, 2)), np.empty(_ROW), np.empty((_ROW, 2)), np.empty((_ROW, 2)), np.empty(_ROW)
        for begin in range(0, n, _ROW):
            size = min(_ROW, n - begin)
            for j in range(size):
                for i in range(14):
                    s[i, j] = state[begin + j, i]
                s[14, j], s[15, j], s[22, j] = 1.0, 0.0, 0.0
                for i in range(2):
                    s[20 + i, j] = pick(values, begin + j, first - 1)[i] * factor[begin + j if factor.shape[0] > 1 else 0, i]
            for knot in range(first, last):
                pulled(s, values, factor, load, centre, k, begin, size, knot, trial.reshape(-1), e)
                run(trial[:size], e[:size], mu, axes, low, ratio, compliance, power, place, near[:size], moved[:size], lam[:size])
                booked(s, share, centre, k, c, begin, size, knot, near.reshape(-1), moved.reshape(-1), lam)
                if row[knot] >= 0:
                    r = row[knot]
                    for j in range(size):
                        at, ok = begin + j, s[14, j] > 0.0
                        stress[at, r, 0], stress[at, r, 1] = s[0, j] if ok else np.nan, s[1, j] if ok else np.nan
                        slip[at, r, 0], slip[at, r, 1] = s[2, j] if ok else np.nan, s[3, j] if ok else np.nan
                        multiplier[at, r], psi[at, r] = s[8, j] if ok else np.nan, s[9, j] if ok else np.nan
                        dissipation[at, r], work[at, r] = s[10, j] if ok else np.nan, s[11, j] if ok else np.nan
                        numerical[at, r], balance[at, r] = s[12, j] if ok else np.nan, s[13, j] if ok else np.nan
                        s[13, j] = 0.0
            for j in range(size):
                reached[begin + j] += np.int64(s[22, j])
                status[begin + j] = (_SLIP if s[15, j] > 0.0 else _STICK) if s[14, j] > 0.0 else _FAILED
                for i in range(14):
                    state[begin + j, i] = s[i, j]

    # -- one point after the other ---------------------------------------------------------------------------------

    @jit
    def quarter_of(quarters: Any, member: int) -> Any:
        mu, axes, low, ratio, compliance, power, place = quarters
        own = slice(4 * member, 4 * member + 4)
        return mu[own], axes[own], low[own], ratio[own], compliance[own], power[own], place[own]

    @jit
    def on_quarter(trial: Any, load: Any, own: Any, stress: Any, slip: Any, lam: Any) -> None:
        mu, axes, low, ratio, compliance, power, place = own
        single(0, trial, load, mu, axes, low, ratio, compliance, power, place, stress, slip, lam)

    @jit
    def interval_of(intervals: Any, member: int) -> Any:
        mu, k = intervals
        return mu[member], k

    @jit
    def on_interval(trial: Any, load: Any, own: Any, stress: Any, slip: Any, lam: Any) -> None:
        """As :func:`duhem.projection.quadrants.clamped`."""
        mu, k = own
        t, e = trial[0, 0], load[0]
        m = mu[1] if t < 0.0 else mu[0]
        size = abs(t)
        scale = math.frexp(max(size, e))[1]
        limit, low = product(m, math.ldexp(e, -scale))
        excess = (math.ldexp(size, -scale) - limit) - low
        stress[0, 0], slip[0, 0], lam[0] = t, 0.0, 0.0
        if excess > 0.0 or excess != excess:
            length = math.ldexp(excess, scale) / k
            stress[0, 0], slip[0, 0], lam[0] = math.copysign(m * e, t), math.copysign(length, t), m * length

    def alone(constants_of: Any, at: Any, d: int) -> Callable[..., None]:
        @free
        def along(
            values: Any, factor: Any, load: Any, share: Any, centre: Any, k: Any, c: Any, state: Any, status: Any, reached: Any,
            constants: Any, members: Any, first: int, last: int, row: Any, stress: Any, slip: Any, sums: Any,
        ) -> None:  # fmt: skip
            multiplier, psi, dissipation, work, numerical, balance = sums
            trial, near, moved, e, lam = np.empty((1, d)), np.empty((1, d)), np.empty((1, d)), np.empty(1), np.empty(1)
            pulled, u, before, sum_ = np.empty(d), np.empty(d), np.empty(d), np.empty(6)
            for n in range(state.shape[0]):
                own = constants_of(constants, members[n])
                s, f = state[n], factor[n if factor.shape[0] > 1 else 0]
                knot = first
                before[:] = pick(values, n, first - 1) * f
                while knot < last and status[n] != _FAILED:
                    middle = pick(centre, n, knot)
                    e[0] = pick(load, n, knot)
                    place = pick(values, n, knot)
                    for i in range(d):
                        u[i] = place[i] * f[i]
                    for i in range(d):
                        grown = 0.0
                        for j in range(d):
                            grown += (u[j] - s[3 * d + j]) * k[j, i]
                        pulled[i] = s[2 * d + i] + grown
                        trial[0, i] = pulled[i] - middle[i]
                    at(trial, e, own, near, moved, lam)
                    lam[0] *= pick(share, n, knot)
                    slips = lam[0] > 0.0
                    for i in range(d):
                        slips = slips or moved[0, i] != 0.0
                    lost, pushed, loss, gained, energy = 0.0, 0.0, 0.0, 0.0, 0.0
                    for i in range(d):
                        near[0, i] = near[0, i] + middle[i] if slips else pulled[i]
                    for i in range(d):
                        t, du = near[0, i], u[i] - before[i]
                        lost += t * moved[0, i]
                        pushed += t * du
                        bent, back, strain = 0.0, 0.0, 0.0
                        for j in range(d):
                            bent += (u[j] - before[j] - moved[0, j]) * k[j, i]
                            back += (near[0, j] - s[j]) * c[j, i]
                            strain += near[0, j] * c[j, i]
                        loss += (du - moved[0, i]) * bent
                        gained += (0.5 * (s[i] + t)) * back
                        energy += t * strain
                    energy *= 0.5
                    sum_[0] = s[4 * d] + lam[0]
                    sum_[1] = energy
                    sum_[2] = s[4 * d + 2] + (lost if slips else 0.0)
                    gain = pushed if slips else gained
                    sum_[3] = s[4 * d + 3] + gain
                    sum_[4] = s[4 * d + 4] + (0.5 * loss if slips else 0.0)
                    sum_[5] = s[4 * d + 5] + (gain - (energy - s[4 * d + 1]) - (lost if slips else 0.0) - (0.5 * loss if slips else 0.0))
                    whole = 0.0
                    for i in range(6):
                        whole = added(whole, sum_[i])
                    for i in range(d):
                        whole = added(added(whole, near[0, i]), s[d + i] + moved[0, i])
                    if whole != 0.0:
                        status[n] = _FAILED
                        break
                    for i in range(d):
                        s[i] = near[0, i]
                        s[d + i] += moved[0, i]
                        if slips:
                            s[2 * d + i], s[3 * d + i] = near[0, i], u[i]
                        before[i] = u[i]
                    s[4 * d :] = sum_
                    status[n] = _SLIP if slips else _STICK
                    reached[n] += 1
                    r = row[knot]
                    if r >= 0:
                        stress[n, r], slip[n, r] = s[:d], s[d : 2 * d]
                        multiplier[n, r], psi[n, r], dissipation[n, r] = sum_[0], sum_[1], sum_[2]
                        work[n, r], numerical[n, r], balance[n, r] = sum_[3], sum_[4], sum_[5]
                        s[4 * d + 5] = 0.0
                    knot += 1
                for later in range(knot, last):
                    r = row[later]
                    if r >= 0:
                        stress[n, r], slip[n, r] = np.nan, np.nan
                        multiplier[n, r], psi[n, r], dissipation[n, r] = np.nan, np.nan, np.nan
                        work[n, r], numerical[n, r], balance[n, r] = np.nan, np.nan, np.nan

        return along

    return Loops(abreast, alone(quarter_of, on_quarter, 2), alone(interval_of, on_interval, 1))
