"""No stress as the closest point, looked at in the size of K: beside a trial far away K itself may be lost in rounding.

What is closest to a trial t is closest to every r t, 0 < r <= 1, where it is no stress.  So such an answer is judged once more beside a
trial brought near, in units of each size that the data of g have: no stress is inside K by no more than rounding, and the slip along
a normal that K has there.
"""

from __future__ import annotations

import numpy as np

from duhem.projection.increment import Increment
from duhem.projection.level import Level
from duhem.projection.metric import ROUNDING, Metric
from duhem.projection.normal_cones import Suspect, off_cone
from duhem.projection.result import Array, Solution
from duhem.projection.row_by_row import length, unit, widest
from duhem.projection.scaled_formula import power_of_two

__all__ = ["off_no_stress"]

_NEAR = 2.0**10  # sizes of K: so far is a trial brought


def off_no_stress(increment: Increment, level: Level, metric: Metric, got: Solution) -> tuple[Array, Array]:
    """How far slips beside no stress (M,) are from the boundary and from the normals of K, as shares of its size; 0 where nothing is known.

    The points of ``increment`` and ``got`` are those alone.  A point is taken for inside K where g is below zero by more than its rounding.
    """
    trial, pressure, stress = increment.trial, increment.pressure, got.stress
    inside, off = np.zeros(len(trial)), np.zeros(len(trial))
    for datum, value in level.scaled.values(pressure, np.ones(len(trial))).items():
        weight = float(level.scaled.data[datum].weight)
        own = np.abs(value) ** (1.0 / weight) if weight else np.zeros(len(trial))
        at = np.flatnonzero((own > 0.0) & (own < widest(trial)))
        if not at.size:
            continue
        size = power_of_two(own[at])
        g, hidden = level.bounded(stress[at], pressure[at], size)
        steep = length(level.gradient(stress[at], pressure[at], size) @ metric.of_slip)
        way, far = unit(got.slip[at] @ metric.of_slip)
        reach = size * length(unit(trial[at])[0] @ metric.of_stress)
        depth = np.where(steep > 0.0, np.minimum(-g / steep * (size / reach), 1.0), 1.0)
        inside[at] = np.maximum(inside[at], np.where(g < -hidden, depth, 0.0))
        moved = way * np.minimum(far / reach, _NEAR)[:, None]
        multiplier = level.multiplier(got.multiplier[at], size) / np.maximum(reach, far / _NEAR)
        rounding = ROUNDING * length(moved)
        tip = np.ones(at.size, dtype=np.bool_)
        there = Suspect(stress[at], pressure[at], size, moved, multiplier, reach, rounding, tip)
        off[at] = np.maximum(off[at], np.where(inside[at] > 0.0, 0.0, off_cone(level, metric, there)))
    return inside, off
