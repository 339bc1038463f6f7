"""The closest point by a loop that is made for one law and compiled by numba: once a law, then kept on disk.

The functions of the law are its scaled formula and its jets as text (:mod:`duhem.expression.scalar_jets`); the loop is the source of
:mod:`duhem.projection.newton_kernel` and of the step it takes.  Points that the loop leaves are the search's.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.scalar_jets import ScalarJets, scalar_jets
from duhem.projection import newton_kernel, newton_step
from duhem.projection.in_blocks import in_blocks
from duhem.projection.increment import Increment
from duhem.projection.kept_code import compiled_text
from duhem.projection.module_text import module_text
from duhem.projection.newton_kernel import LEFT
from duhem.projection.result import Solution
from duhem.projection.scaled_formula import ScaledFormula, scaled
from duhem.projection.whitened_body import whitening

__all__ = ["kernel_text", "solved"]

_BLOCK = 4_096  # so few that threads share batches of some ten thousand


def solved(increment: Increment, threads: int | None = None) -> tuple[Solution, NDArray[np.intp]]:
    """The solution, and the points of it that are left to the search.  MissingExtraError without numba."""
    law = increment.law
    symbol = law.symbols()[law.pressure] if law.pressure else None
    formula = scaled(increment.g, law.force_symbols(), symbol)
    n, d = increment.trial.shape
    every = np.arange(n)
    found = Solution(np.empty((n, d)), np.zeros((n, d)), np.zeros(n), np.zeros(n, dtype=bool))
    try:
        jets = scalar_jets(formula.expr, law.force_symbols(), tuple(formula.data))
        run = compiled_text(kernel_text(formula, jets, d), "solve")
    except InputError:  # a word without derivatives as text
        return found, every
    state = np.empty(n, dtype=np.int8)
    mean, root = whitening(increment)
    root, inverse = np.ascontiguousarray(root), np.ascontiguousarray(np.linalg.inv(root))

    def fill(block: slice) -> None:
        trial = np.ascontiguousarray(increment.trial[block])
        values = formula.values(increment.pressure[block], np.ones(len(trial)))
        data = np.stack([values[q] for q in formula.data], axis=1) if values else np.zeros((len(trial), 0))
        out = found.stress[block], found.slip[block], found.multiplier[block], state[block]
        run(trial, np.ascontiguousarray(data), np.array(jets.constants), root, inverse, formula.degree, *out)

    in_blocks(n, _BLOCK, fill, threads)
    with np.errstate(over="ignore", invalid="ignore"):
        found.slip[:] /= mean
        found.multiplier[:] /= mean
    return found, every[state == LEFT]


def kernel_text(formula: ScaledFormula, jets: ScalarJets, d: int) -> str:
    """The module that is compiled for one law in ``d`` forces, whatever its parameters but for exponents and whole numbers."""
    return module_text(formula, d, jets.kinks, (jets.level, jets.piece), (newton_step, newton_kernel))
