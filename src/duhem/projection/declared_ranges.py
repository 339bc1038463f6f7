"""The ranges of a law's pressure and forces: a pressure outside is no question to it, and a stress outside no answer.

What a law claims it claims in its ranges alone (``domain`` of :class:`duhem.Criterion`).  The closest point of K that lies in
them is that of K within them too; one that does not is the closest point of nothing that is claimed to be convex.  A trial
stress is no state of the law, and may lie anywhere.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from duhem.law.formula_law import Criterion
from duhem.projection.result import Array

__all__ = ["beyond", "crossed", "refused"]

_ROUNDING = 1e-12  # of the size of a stress: an end of a range may be where K ends too


def refused(law: Criterion, pressure: Array) -> NDArray[np.bool_]:
    """Which of the pressures (N,) lie outside the law's range; a double stands for the number that it is the nearest to."""
    if law.pressure is None or law.pressure not in law.domain:
        return np.zeros(pressure.shape, dtype=np.bool_)
    low, high = law.domain[law.pressure].ends
    out: NDArray[np.bool_] = (pressure < low) | (pressure > high)
    return out


def beyond(law: Criterion, stress: Array, trial: Array | None = None) -> NDArray[np.bool_]:
    """Which of the ``stress`` (N, d) lie outside the ranges by more than rounding, of the ``trial`` (N, d) too; (N,)."""
    return np.asarray(_beyond(law, stress, trial).any(axis=1))


def crossed(law: Criterion, stress: Array) -> str:
    """What the first of the ``stress`` (N, d) that lies beyond a range crosses: ``sigma_a = 12 lies outside its range [-10, 10]``."""
    row, column = np.argwhere(_beyond(law, stress, None))[0]
    force = [name for name in law.forces if name in law.domain][column]
    low, high = law.domain[force].ends
    x = float(stress[row, law.forces.index(force)])
    said = f"{x:g}" if not low <= float(f"{x:g}") <= high else repr(x)  # with digits enough to be outside
    return f"{force} = {said} lies outside its range {law.domain[force].describe()}"


def _beyond(law: Criterion, stress: Array, trial: Array | None) -> NDArray[np.bool_]:
    """The same for each range of a force, (N, ranges)."""
    ranged = [i for i, name in enumerate(law.forces) if name in law.domain]
    if not ranged:
        return np.zeros((len(stress), 0), dtype=np.bool_)
    low, high = np.array([law.domain[law.forces[i]].ends for i in ranged]).T
    size = np.abs(stress).max(axis=1)
    slack = _ROUNDING * size if trial is None else _ROUNDING * size + 4.0 * np.finfo(float).eps * np.abs(trial).max(axis=1)
    own: NDArray[np.bool_] = (stress[:, ranged] < low - slack[:, None]) | (stress[:, ranged] > high + slack[:, None])
    return own
