"""One implicit step of a law with a state, one point at a time: the equations of :mod:`duhem.path.state_step` as plain loops.

The source below the mark is compiled together with the functions of one law (:mod:`duhem.path.compiled_state`), whose names stand here
without a body.  The observables, and a temperature if there is one, are prescribed; a point that comes to a bound of a variable, or
that Newton's method does not solve at once, is left to :mod:`duhem.path.state_step`, whose thresholds are used.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy import inf, nan

from duhem.path.state_step import GOAL, HALVINGS, KKT, MOST, ROUNDED, SPOILT, UNTRUE
from duhem.projection.newton_step import eliminated

__all__ = ["LEFT", "NUMBERS", "advance"]

TINY = float(np.finfo(np.float64).tiny)
NUMBERS = {
    "KKT": KKT,
    "GOAL": GOAL,
    "HALVINGS": HALVINGS,
    "MOST": MOST,
    "ROUNDED": ROUNDED,
    "SPOILT": SPOILT,
    "TINY": TINY,
    "UNTRUE": UNTRUE,
}
"""What the loops take from here by name, beside the sizes of a law."""

D = Z = SEEN = INNER = S = W = 1  # forces, variables, observables, internal variables, criteria; the most variables of a formula
OTHERS = CONSTANTS = KINKS = 1  # numbers beside the variables, fractions of all formulas, and the most kinks of one
TIMED = 0  # whether there are rates without a multiplier


def stored(at: Any, q: Any, v: Any) -> float:
    """psi at the variables ``at``."""
    raise NotImplementedError


def energy(at: Any, q: Any, v: Any, m: Any, choices: Any, f: Any, h: Any) -> float:
    """psi, its slope and its second derivatives."""
    raise NotImplementedError


def criterion(s: int, moving: bool, y: Any, q: Any, v: Any, m: Any, choices: Any, slope: Any, flows: Any, turn: Any) -> float:
    """g_s at ``y``, the forces and then the variables, its slope and, where it is ``moving``, the flow and its derivatives."""
    raise NotImplementedError


def rates(y: Any, q: Any, v: Any, m: Any, choices: Any, rate: Any, change: Any) -> None:
    """The rates without a multiplier at ``y``, and their derivatives."""
    raise NotImplementedError


# -- compiled from here ------------------------------------------------------------------------------------------------

SOLVED, LEFT = 0, 1


def advance(
    base: Any, given: Any, dt: float, others: Any, constants: Any, order: Any, low: Any, high: Any, chi: Any, multiplier: Any, psi: Any,
    forces: Any, observed: Any, entropy: Any, flow: Any, numerical: Any, worst: Any, state: Any,
) -> None:  # fmt: skip
    """Each point's step: the numbers of :class:`duhem.path.state_step.Advanced`, and whether it is left."""
    v, m, choices, q = np.empty((2, W)), np.empty((1, W, W)), np.empty((1, KINKS), np.int8), np.empty(OTHERS + CONSTANTS)
    at, start, f, h, y, both = np.empty(Z), np.empty(Z), np.empty(Z), np.empty((Z, Z)), np.empty(D + Z), np.empty((D, INNER))
    slope, flows, turn = np.empty((S + 1, D + Z)), np.empty((S + 1, INNER)), np.empty((S + 1, INNER, D + Z))
    rate, change, total, by = np.empty(INNER), np.empty((INNER, D + Z)), np.empty((INNER, D + Z)), np.empty((INNER, INNER))
    held, active, g, known = np.empty(S + 1), np.empty(S + 1, np.int8), np.empty(S + 1), np.empty(S + 1)
    r, size, now, much = np.empty(INNER + S), np.empty(INNER + S), np.empty(INNER + S), np.empty(INNER + S)
    point, made, moved, a = np.empty(Z + S), np.empty(Z), np.empty(INNER), np.empty((INNER + S, INNER + S + 1))
    cleared(f, h, slope, flows, turn)
    for j in range(CONSTANTS):
        q[OTHERS + j] = constants[j]
    for n in range(base.shape[0]):
        for j in range(OTHERS):
            q[j] = others[n, j]
        for i in range(Z):
            start[i] = base[n, i]
            at[i] = base[n, i]
        for i in range(SEEN):
            at[i] = given[n, i]
        if given.shape[1] > SEEN:
            at[Z - 1] = given[n, SEEN]
        psi[n] = ended(
            at, start, held, active, dt, order, low, high, q, v, m, choices, f, h, y, both, slope, flows, turn, rate, change, total, made,
            moved, by, g, known, r, size, a, now, much, point,
        )  # fmt: skip
        state[n] = SOLVED if isfinite(psi[n]) else LEFT
        worst[n] = largest(r, size)
        numerical[n] = stored(start, q, v) - psi[n]
        for i in range(Z):
            chi[n, i] = at[i]
            numerical[n] += f[i] * (at[i] - start[i])
        for k in range(D):
            forces[n, k] = y[k]
        for i in range(SEEN):
            observed[n, i] = f[i]
        for i in range(INNER):
            flow[n, i] = moved[i]
        for s in range(S):
            multiplier[n, s] = held[s]
        entropy[n] = 0.0
        for i in range(SEEN + INNER, Z):
            entropy[n] -= f[i]


def cleared(f: Any, h: Any, slope: Any, flows: Any, turn: Any) -> None:
    """Zeros where the formulas write nothing."""
    for i in range(Z):
        f[i] = 0.0
        for j in range(Z):
            h[i, j] = 0.0
    for s in range(S):
        for z in range(D + Z):
            slope[s, z] = 0.0
            for i in range(INNER):
                turn[s, i, z] = 0.0
        for i in range(INNER):
            flows[s, i] = 0.0


def ended(
    at: Any, start: Any, held: Any, active: Any, dt: float, order: Any, low: Any, high: Any, q: Any, v: Any, m: Any, choices: Any, f: Any,
    h: Any, y: Any, both: Any, slope: Any, flows: Any, turn: Any, rate: Any, change: Any, total: Any, made: Any, moved: Any, by: Any,
    g: Any, known: Any, r: Any, size: Any, a: Any, now: Any, much: Any, point: Any,
) -> float:  # fmt: skip
    """The end of a step, in ``at``, whose psi is returned; nan where all conditions are not met."""
    psi, step, w, then, before, most, place = nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0
    tries, halved, count, trial, near, still, done = 0, 0, 0, False, False, False, False
    for i in range(Z):
        point[i] = at[i]
    for s in range(S):
        held[s], active[s], point[Z + s] = 0.0, 0, 0.0
    while tries < MOST:
        if count > 0:  # a step of Newton's method from ``point``, or back there
            for i in range(INNER):
                at[SEEN + i] = point[SEEN + i] + step * a[i, count]
            place = INNER
            for s in range(S):
                held[s] = point[Z + s]
                if active[s] == 1:
                    held[s] += step * a[place, count]
                    place += 1
        psi = equations(
            at, start, held, active, dt, order, q, v, m, choices, f, h, y, both, slope, flows, turn, rate, change, total, made, moved, by,
            g, known, r, size,
        )  # fmt: skip
        if trial:
            then, before = 0.0, 0.0
            for i in range(INNER + S):
                w = max(size[i], much[i])
                then += (r[i] / w) * (r[i] / w)
                before += (now[i] / w) * (now[i] / w)
            if not then < (0.5 if near else 1.0) * before:
                halved += 1
                if near:  # where little is left, whole steps are taken or none
                    step, trial, still = 0.0, False, True
                elif halved == HALVINGS:
                    return nan
                else:
                    step *= 0.5
                continue
            still = False
        trial, count = False, 0
        tries += 1
        error = largest(r, size)
        if error <= GOAL or (error <= KKT and still):
            done = True
            for s in range(S):
                if held[s] < 0.0:
                    held[s], active[s], done = 0.0, 0, False
            place, most = -1, KKT
            for s in range(S):
                if active[s] == 0 and not g[s] <= 0.0:
                    w = g[s] / known[s] if isfinite(g[s]) and isfinite(known[s]) else inf
                    if w > most:
                        place, most = s, w
            if place >= 0:
                active[place], done = 1, False
            if done:
                break
            still = False
            continue
        near, count = error <= KKT, INNER
        for s in range(S):
            count += active[s]
            point[Z + s] = held[s]
        towards(a, active, by, flows, slope, both, r)
        if not eliminated(a, count):
            return nan
        for i in range(Z):
            point[i] = at[i]
        for i in range(INNER + S):
            now[i], much[i] = r[i], size[i]
        step, halved, trial = 1.0, 0, True
    for i in range(INNER):
        if not low[i] <= at[SEEN + i] <= high[i]:
            return nan
    if not done or (TIMED == 1 and untrue(at, start, order, y, f, moved)):
        return nan
    return psi


def equations(
    at: Any, start: Any, held: Any, active: Any, dt: float, order: Any, q: Any, v: Any, m: Any, choices: Any, f: Any, h: Any, y: Any,
    both: Any, slope: Any, flows: Any, turn: Any, rate: Any, change: Any, total: Any, made: Any, moved: Any, by: Any, g: Any, known: Any,
    r: Any, size: Any,
) -> float:  # fmt: skip
    """psi; the residuals, what they are small against, and the derivatives of those of alpha by alpha, into ``by``."""
    psi = energy(at, q, v, m, choices, f, h)
    for i in range(Z):
        made[i] = 0.0
        for j in range(Z):
            made[i] += abs(h[i, j]) * abs(at[j])
        y[D + i] = at[i]
    for k in range(D):
        y[k] = 0.0 - f[SEEN + order[k]]
        for j in range(INNER):
            both[k, j] = -h[SEEN + order[k], SEEN + j]
    for s in range(S):
        g[s] = criterion(s, active[s] == 1, y, q, v, m, choices, slope, flows, turn)
    if TIMED == 1:
        rates(y, q, v, m, choices, rate, change)
    share = dt if TIMED == 1 and dt > 0.0 else 0.0
    for i in range(INNER):
        steps = share * rate[i] if share > 0.0 else 0.0
        moved[i], size[i] = steps, abs(steps)
        for z in range(D + Z):
            total[i, z] = share * change[i, z] if share > 0.0 else 0.0
        for s in range(S):
            if active[s] == 1:
                moved[i] += held[s] * flows[s, i]
                size[i] += abs(held[s]) * abs(flows[s, i])
                for z in range(D + Z):
                    total[i, z] += held[s] * turn[s, i, z]
        size[i] = max(max(size[i], abs(at[SEEN + i])), abs(start[SEEN + i]))
        for k in range(D):
            size[i] += abs(total[i, k]) * (ROUNDED / KKT * made[SEEN + order[k]])
        bend = abs(h[SEEN + i, SEEN + i])
        if bend > 0.0:
            size[i] += ROUNDED / KKT * made[SEEN + i] / bend
        size[i] += TINY
        r[i] = at[SEEN + i] - start[SEEN + i] - moved[i]
        for j in range(INNER):
            by[i, j] = -total[i, D + SEEN + j]
        for k in range(D):
            if total[i, k] != 0.0:
                for j in range(INNER):
                    by[i, j] -= total[i, k] * both[k, j]
        by[i, i] += 1.0
    for s in range(S):
        within, weighed, rounding = 0.0, 0.0, 0.0
        for k in range(D):
            within += slope[s, k] * y[k]
            weighed += abs(slope[s, k]) * abs(y[k])
            rounding += abs(slope[s, k]) * (ROUNDED / KKT * made[SEEN + order[k]])
        known[s] = max(weighed, abs(g[s] - within)) + rounding
        r[INNER + s] = g[s] if active[s] == 1 else held[s]
        size[INNER + s] = known[s] + TINY if active[s] == 1 else 1.0
    return psi


def towards(a: Any, active: Any, by: Any, flows: Any, slope: Any, both: Any, r: Any) -> None:
    """The linear equations of a step of Newton's method in alpha and the multipliers of active criteria."""
    count = INNER
    for s in range(S):
        count += active[s]
    for i in range(INNER):
        for j in range(INNER):
            a[i, j] = by[i, j]
        a[i, count] = -r[i]
    place = INNER
    for s in range(S):
        if active[s] == 1:
            for i in range(INNER):
                a[i, place] = -flows[s, i]
                a[place, i] = slope[s, D + SEEN + i]
            for k in range(D):
                for i in range(INNER):
                    a[place, i] += slope[s, k] * both[k, i]
            for j in range(INNER, count):
                a[place, j] = 0.0
            a[place, count] = -r[INNER + s]
            place += 1


def largest(r: Any, size: Any) -> float:
    """The worst residual, relative; infinite where one has no value."""
    worst = 0.0
    for i in range(INNER + S):
        error = abs(r[i]) / size[i]
        if not isfinite(error):
            return inf
        worst = max(worst, error)
    return worst


def untrue(at: Any, start: Any, order: Any, y: Any, f: Any, moved: Any) -> bool:
    """Whether rates without a multiplier dissipate another energy than the change of the variables does."""
    energies, apart, rounding = 0.0, 0.0, 0.0
    for k in range(D):
        place = order[k]
        change = at[SEEN + place] - start[SEEN + place]
        energies += abs(y[k]) * (abs(change) + abs(moved[place]))
        apart += abs(y[k]) * abs(change - moved[place])
        rounding += abs(y[k]) * abs(at[SEEN + place])
    for i in range(SEEN):
        energies += abs(f[i] * (at[i] - start[i]))
    return not apart <= UNTRUE * energies + SPOILT * rounding
