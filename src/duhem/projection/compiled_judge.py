"""Dissipation, residuals and statuses by one loop that is made for a law and compiled by numba: once a law, then kept on disk.

The loop (:mod:`duhem.projection.judge_kernel`) says that a point is plainly right, or leaves it to the judge.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.expression.scalar_bounds import scalar_bounds
from duhem.expression.scalar_jets import scalar_jets
from duhem.projection import corner_kernel, judge_kernel
from duhem.projection.allocation import keep_freed_memory
from duhem.projection.in_blocks import in_blocks
from duhem.projection.increment import Increment
from duhem.projection.judge_kernel import UNJUDGED
from duhem.projection.kept_code import compiled_text
from duhem.projection.level import Level
from duhem.projection.module_text import module_text
from duhem.projection.newton_step import below, eliminated, grown, length
from duhem.projection.normal_cones import beside
from duhem.projection.residuals import Judge
from duhem.projection.result import Array, Residuals, Solution
from duhem.projection.row_by_row import unit
from duhem.projection.told import Told

__all__ = ["told"]

_BLOCK = 16_384


@dataclass(frozen=True, eq=False)
class _Loop:
    """The compiled loop of a formula with its constants, and what these are off by."""

    run: Callable[..., None]
    constants: Array
    off: Array


def told(increment: Increment, solution: Solution, judge: Judge, threads: int | None = None) -> Told:
    """What the loop says; nothing for a law with a word that it lacks.  MissingExtraError without numba."""
    formula = judge.level.scaled
    loop = _loop(judge.level, increment.law.force_symbols())
    if loop is None:
        return Told.nothing(len(solution.multiplier))
    n, metric = len(solution.multiplier), judge.metric
    keep_freed_memory(n)
    dissipation, status, residuals = np.empty(n), np.empty(n, dtype=np.int8), np.empty((5, n))
    with np.errstate(all="ignore"):  # the origin has no way
        ways, reaches = map(np.nan_to_num, unit(judge.known.reaches))
    matrices = [np.ascontiguousarray(m) for m in (increment.stiffness, metric.of_slip, metric.of_stress, metric.to_stress)]
    around = beside(increment.trial.shape[1])
    figures = metric.blur, metric.good, metric.certain, formula.degree, judge.known.convex

    def fill(block: slice) -> None:
        pressure = increment.pressure[block]
        part = np.ones(pressure.size) if judge.known.largest == 0.0 else pressure / judge.known.largest
        known = formula.bounded(pressure, np.ones(pressure.size)).values()
        data, offs = np.zeros((2, pressure.size, len(known)))
        for k, (value, off) in enumerate(known):
            data[:, k], offs[:, k] = value, off
        got = solution.stress[block], solution.slip[block], solution.multiplier[block]
        given = (np.ascontiguousarray(increment.trial[block]), part, data, offs, loop.constants, loop.off)
        tips = around, np.ascontiguousarray(judge.known.tips), np.ascontiguousarray(ways), reaches
        loop.run(*given, *matrices, *tips, *figures, *got, dissipation[block], status[block], residuals[:, block])

    in_blocks(n, _BLOCK, fill, threads)
    status[solution.failed] = UNJUDGED
    return Told(dissipation, status, Residuals(*residuals), np.flatnonzero(status == UNJUDGED))


@lru_cache(maxsize=256)
def _loop(level: Level, forces: tuple[sp.Symbol, ...]) -> _Loop | None:
    formula, others = level.scaled, tuple(level.scaled.data)
    try:
        jets = scalar_jets(formula.expr, forces, others)
        bounds = scalar_bounds(formula.expr, forces, others, len(others) + len(jets.constants))
    except InputError:  # a word without text
        return None
    functions = jets.level, jets.gradient, bounds.text
    text = module_text(formula, len(forces), jets.kinks, functions, (below, grown, length, eliminated, corner_kernel, judge_kernel))
    none = (0.0,) * len(jets.constants)
    return _Loop(
        compiled_text(text, "judge", judge_kernel.INLINED), np.array(jets.constants + bounds.constants), np.array(none + bounds.off)
    )
