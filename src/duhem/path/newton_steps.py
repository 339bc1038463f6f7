"""Implicit steps of one path by the loop that is made for a law: each trial stress from where nothing has slipped since.

The source of this module is compiled together with the law's functions and :mod:`duhem.projection.newton_kernel`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from duhem.projection.newton_kernel import KINKS, LEFT, SLIP, solved
from duhem.projection.newton_start import DATA
from duhem.projection.newton_step import MATRICES, ROWS, D

__all__ = ["along"]

# -- compiled from here ----------------------------------------------------------------------------------------


def along(
    values: Any, stiffness: Any, stress_anchor: Any, anchor: Any, data: Any, constants: Any, root: Any, inverse: Any, degree: float,
    trial: Any, stress: Any, slip: Any, multiplier: Any, state: Any,
) -> None:  # fmt: skip
    """The closest points along the displacements ``values`` (n, D), from the stress and displacement that last slipped.

    Trial stresses and what is found are written, up to the first that is left: its state and those after it are LEFT.  Slips and
    multipliers are those of a stiffness of mean 1.  Both anchors (D,) are moved.
    """
    v, m, a = np.empty((ROWS, D)), np.empty((MATRICES, D, D)), np.empty((2 * D, 2 * D + 1))
    q = np.empty(DATA + len(constants))
    for k in range(len(constants)):
        q[DATA + k] = constants[k]
    held = np.empty((D + 1, KINKS), np.int8)
    for n in range(len(state)):
        state[n] = LEFT
    for n in range(len(state)):
        for i in range(D):
            pulled = 0.0
            for j in range(D):
                pulled += (values[n, j] - anchor[j]) * stiffness[j, i]
            trial[n, i] = stress_anchor[i] + pulled
        found = solved(trial, data, n, degree, v, m, a, q, held, root, inverse, stress, slip, multiplier)
        if found == LEFT:
            return
        state[n] = found
        if found == SLIP:
            for i in range(D):
                stress_anchor[i], anchor[i] = stress[n, i], values[n, i]
