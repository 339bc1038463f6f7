"""The implicit step, first order: the closest point of K at the end of the step to the stress without slip.

sigma = argmin over K(sigma_n) of (sigma_tr - sigma) . k^-1 (sigma_tr - sigma)/2, sigma_tr = sigma_before + k du (Moreau,
1977, the catching-up algorithm).  Its energy is exact in the sense sigma . du = dpsi + sigma . du_in + du_e . k du_e / 2.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from duhem.path.ledger import Ledger
from duhem.path.prepared_projection import Closest, closest
from duhem.path.run import Plan, energy, inner, times
from duhem.projection.result import Array

__all__ = ["advance", "energies", "single", "stretch", "why"]

_MOST_AHEAD = 4096


def why(plan: Plan) -> str:
    """How the closest point is found."""
    return closest(plan.increment, plan.projection)[1]


def advance(plan: Plan, ledger: Ledger) -> Iterator[int]:
    """Fill the ledger row by row; yields the number of rows done.

    Stretches without slip are taken in blocks: each trial is taken from the row that last slipped,
    as long as no row before it slips.
    """
    at, _ = closest(plan.increment, plan.projection)
    anchor, ahead = ledger.anchor, 1
    while ledger.done < len(plan.path.values):
        if stretch(plan, ledger, at, anchor, ahead):
            anchor, ahead = ledger.done - 1, 1
        else:
            ahead = min(2 * ahead, _MOST_AHEAD)
        yield ledger.done


def stretch(plan: Plan, ledger: Ledger, at: Closest, anchor: int, ahead: int) -> bool:
    """The next rows up to the first that slips, no more than ``ahead``, from the row ``anchor`` that last slipped; whether one does."""
    values, k = plan.path.values, plan.stiffness
    first, last = ledger.done, min(ledger.done + ahead, len(values))
    trial = ledger.stress[anchor] + times(values[first:last] - values[anchor], k)
    stress, slip, multiplier = at(trial, np.arange(first, last))
    slips = np.flatnonzero((slip != 0.0).any(axis=1) | (multiplier > 0.0))
    free = int(slips[0]) if slips.size else last - first
    if free:
        ledger.sticks(plan, first, first + free, trial[:free])
    if slips.size:
        i = first + free
        du = values[i] - values[i - 1]
        lost, work, numerical = map(float, energies(k, stress[free], slip[free], du))
        ledger.step(plan, stress[free], slip[free], (float(multiplier[free]), lost, work, numerical))
    return bool(slips.size)


def energies(k: Array, stress: Array, slip: Array, du: Array) -> tuple[Array, Array, Array]:
    """Dissipation sigma . du_in, work sigma . du and du_e . k du_e / 2 of implicit steps, a row each, in Pa m."""
    return inner(stress, slip), inner(stress, du), energy(du - slip, k)


def single(at: Closest, trial: Array, row: int) -> tuple[Array, Array, float]:
    """The closest point to one trial stress."""
    stress, slip, multiplier = at(trial[None], np.array([row]))
    return stress[0], slip[0], float(multiplier[0])
