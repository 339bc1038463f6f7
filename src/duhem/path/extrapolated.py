"""Second order: two half steps and a whole one, extrapolated (Richardson, 1911), then put back into K.

sigma = P(2 sigma_halves - sigma_whole), with P the closest point, which takes off what the extrapolation left outside.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from duhem.path.implicit import energies, single
from duhem.path.ledger import Ledger
from duhem.path.prepared_projection import closest
from duhem.path.run import Plan, times
from duhem.projection.result import Array

__all__ = ["advance", "sums_of", "why"]

_MOST_AHEAD = 4096


def why(plan: Plan) -> str:
    """How the closest point is found."""
    return f"{closest(plan.increment, plan.projection)[1]}, extrapolated from whole and half steps"


def advance(plan: Plan, ledger: Ledger) -> Iterator[int]:
    """Fill the ledger row by row; yields the number of rows done.

    Multiplier, dissipation and work are extrapolated alike, but never below zero: where the two estimates of a
    dissipation are so far apart that this would happen, that of the half steps stands.  The balance of energy holds to
    the order of the method.
    """
    fine = plan.path.refined(2)
    u, k, c, m = fine.values, plan.stiffness, plan.compliance, len(plan.path.values)
    pressure = np.zeros(len(u)) if fine.pressure is None else fine.pressure
    at, _ = closest(replace(plan.increment, trial=times(u, k), pressure=pressure), plan.projection)
    ahead, anchor = 1, ledger.anchor
    while ledger.done < m:
        first, last = ledger.done, min(ledger.done + ahead, m)
        start = 2 * (first - 1)
        trial = ledger.stress[anchor] + times(u[start + 1 : 2 * last - 1] - u[2 * anchor], k)
        _, slip, multiplier = at(trial, np.arange(start + 1, 2 * last - 1))
        slips = np.flatnonzero((slip != 0.0).any(axis=1) | (multiplier > 0.0))
        free = int(slips[0]) // 2 if slips.size else last - first
        if free:
            ledger.sticks(plan, first, first + free, trial[1 : 2 * free : 2])
        if slips.size:
            row = 2 * ledger.done
            before = ledger.stress[ledger.done - 1]
            d1, d2 = u[row - 1] - u[row - 2], u[row] - u[row - 1]
            du = u[row] - u[row - 2]
            whole, slip0, lambda0 = single(at, before + times(du, k), row)
            middle, slip1, lambda1 = single(at, before + times(d1, k), row - 1)
            halves, slip2, lambda2 = single(at, middle + times(d2, k), row)
            stress, _, _ = single(at, 2.0 * halves - whole, row)
            one = np.array([lambda0, *energies(k, whole, slip0, du)])
            two = np.array([lambda1 + lambda2, 0.0, 0.0, 0.0])
            two[1:] = np.add(energies(k, middle, slip1, d1), energies(k, halves, slip2, d2))
            gains = sums_of(one, two).tolist()
            ledger.step(plan, stress, du - times(stress - before, c), (gains[0], gains[1], gains[2], gains[3]))
            anchor = ledger.done - 1
        ahead = 1 if slips.size else min(2 * ahead, _MOST_AHEAD)
        yield ledger.done


def sums_of(one: Array, two: Array) -> Array:
    """Multiplier, dissipation, work and loss (4, ...) extrapolated from one step and two; no less than zero but for the work."""
    sums = np.where(2.0 * two >= one, 2.0 * two - one, two)
    sums[2] = 2.0 * two[2] - one[2]  # work has either sign
    return sums
