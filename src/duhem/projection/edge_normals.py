"""How far slips are from the normals of K at edges where two eigenvalues are equal: round ones, which no few normals around tell."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache

import numpy as np

from duhem.errors import InputError
from duhem.expression.scalar_jets import scalar_jets
from duhem.projection import slip_kernel
from duhem.projection.level import Level
from duhem.projection.metric import Metric
from duhem.projection.module_text import module_text
from duhem.projection.newton_step import eliminated, length
from duhem.projection.plain_numbers import FAULTS, interpreted, zeros
from duhem.projection.result import Array

__all__ = ["off_edge"]


def off_edge(
    level: Level, metric: Metric, stress: Array, pressure: Array, size: Array, slip: Array, multiplier: Array, far: Array
) -> Array:
    """Of points (M,) as :class:`duhem.projection.normal_cones.Suspect` has them, one by one; inf where no edge says anything.

    ``far``: what a length of boundary is divided by, in units of the stress.
    """
    best = np.full(len(slip), np.inf)
    if (made := _edged(level)) is None:
        return best
    run, constants = made
    data = np.stack([*level.scaled.values(pressure, size).values(), *(np.full(len(slip), c) for c in constants)], axis=-1)
    of_slip, distance, d = metric.of_slip.tolist(), np.linalg.norm(slip, axis=1), stress.shape[1]
    for i in range(len(slip)):
        v, room = zeros(slip_kernel.NORMAL_ROW + 1, d), zeros(slip_kernel.CORNER, 2 * d + 1)
        v[slip_kernel.AT], v[slip_kernel.K_SLIP] = (stress[i] / size[i]).tolist(), slip[i].tolist()
        numbers = float(multiplier[i]), float(far[i] / size[i]), float(distance[i]), 1.0, np.inf
        with suppress(*FAULTS):
            best[i] = run(v, room, data[i].tolist(), of_slip, *numbers)
    return best


@lru_cache(maxsize=256)
def _edged(level: Level) -> tuple[Callable[..., float], tuple[float, ...]] | None:
    """The function of the law and the constants of its formula; None where these have no text or cannot be double."""
    forces, others = level.bounds.symbols[: level.forces], level.bounds.symbols[level.forces :]
    try:
        jets = scalar_jets(level.scaled.expr, forces, others)
    except InputError:  # a word without text
        return None
    if not jets.pairs:
        return None
    sources = (eliminated, length, slip_kernel)
    text = module_text(level.scaled, level.forces, jets, (jets.pair_piece,), sources, ("edged",))
    return interpreted(text, "edged"), jets.constants
