"""The closest point by a loop that is made for one law: compiled by numba, once a law, then kept on disk, or run on plain numbers.

The functions of the law are its scaled formula and its jets as text (:mod:`duhem.expression.scalar_jets`); the loop is the source of
:mod:`duhem.projection.newton_kernel`, of the step it takes and of the search for an apex.  Points that the loop leaves are the search's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import ModuleType
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.scalar_jets import ScalarJets, scalar_jets
from duhem.projection import apex_kernel, newton_kernel, newton_step
from duhem.projection.code_cache import CompiledText, compiled_text, only_read
from duhem.projection.in_blocks import evenly, in_blocks
from duhem.projection.increment import Increment
from duhem.projection.method import ClosestPoint
from duhem.projection.module_text import module_text
from duhem.projection.newton_kernel import LEFT
from duhem.projection.plain_numbers import FAULTS, interpreted, zeros
from duhem.projection.result import Array, Solution
from duhem.projection.scaled_formula import ScaledFormula, scaled
from duhem.projection.whitened_body import whitening

__all__ = ["KERNEL", "Loop", "compiled_closest", "kernel_text", "plain_closest", "solved", "solved_one_by_one"]

KERNEL = newton_step, apex_kernel, newton_kernel
"""The modules whose texts are one."""

_BLOCK = 1_024, 4_096  # points, from and to: threads share batches of a few thousand


@dataclass(frozen=True, eq=False)
class Loop:
    """A function and what it takes of the law: numbers of the ``formula``, the stiffness's ``root`` and its inverse.

    What it finds of slips and multipliers is for a stiffness of mean 1, and is divided by ``mean``.
    """

    run: Callable[..., None]
    formula: ScaledFormula
    constants: Array
    root: Array
    inverse: Array
    mean: float

    @classmethod
    def of(
        cls, increment: Increment, entry: str = "solve", *sources: ModuleType, plain: bool = False, goes_on: bool = False
    ) -> Loop | None:
        """``entry`` of the kernel or of further ``sources``; None for a law with a word that has no derivatives as text.

        ``plain``: as Python runs it, on plain numbers, where an operation without a value raises unless it ``goes_on``; else
        MissingExtraError without numba.
        """
        law = increment.law
        if (made := _made(increment.g, law.force_symbols(), increment.pressure_symbol, entry, sources)) is None:
            return None
        text, formula, constants = made
        mean, root = whitening(increment)
        run = interpreted(text, entry, goes_on) if plain else compiled_text(text, entry)
        return cls(run, formula, constants, only_read(root), only_read(np.linalg.inv(root)), mean)

    def data(self, pressure: Array) -> Array:
        """What the formula holds besides the forces at each pressure (n, data)."""
        values = self.formula.values(pressure, np.ones(len(pressure)))
        return np.stack([values[q] for q in self.formula.data], axis=1) if values else np.zeros((len(pressure), 0))

    def data_at_one(self) -> Callable[[float], Array]:
        """The same at one pressure (1, data); once, where no pressure enters."""
        if self.formula.pressure is not None:
            return lambda pressure: only_read(self.data(np.array([pressure])))
        known = only_read(self.data(np.zeros(1)))
        return lambda _: known


def solved(increment: Increment, threads: int | None = None) -> tuple[Solution, NDArray[np.intp]]:
    """The solution, and the points of it that are left to the search.

    MissingExtraError without numba, InputError for a law that has no loop.
    """
    n, d = increment.trial.shape
    every = np.arange(n)
    found = Solution(np.empty((n, d)), np.zeros((n, d)), np.zeros(n), np.zeros(n, dtype=bool))
    loop = Loop.of(increment)
    if loop is None:
        why = "a part of its formula has no derivatives as text"
        raise InputError(f"{increment.law.name} has no compiled loop: {why}", where="compiled", remedy="leave compiled out")
    state = np.empty(n, dtype=np.int8)

    def fill(block: slice) -> None:
        given = only_read(increment.trial[block]), only_read(loop.data(increment.pressure[block]))
        out = found.stress[block], found.slip[block], found.multiplier[block], state[block]
        loop.run(*given, loop.constants, loop.root, loop.inverse, loop.formula.degree, *out)

    least, most = _BLOCK
    in_blocks(n, evenly(n, most, least), fill, threads)
    with np.errstate(over="ignore", invalid="ignore"):
        found.slip[:] /= loop.mean
        found.multiplier[:] /= loop.mean
    return found, every[state == LEFT]


def solved_one_by_one(increment: Increment) -> tuple[Solution, NDArray[np.intp]]:
    """The same without a compiler, for few points."""
    n, d = increment.trial.shape
    found = Solution(increment.trial.copy(), np.zeros((n, d)), np.zeros(n), np.zeros(n, dtype=bool))
    if (closest := plain_closest(increment)) is None:
        return found, np.arange(n)
    left = []
    for i, point in enumerate(zip(increment.trial.tolist(), increment.pressure.tolist(), strict=True)):
        if (answer := closest(*point)) is None:
            left.append(i)
        else:
            found.stress[i], found.slip[i], found.multiplier[i] = answer
    return found, np.array(left, dtype=np.intp)


def plain_closest(increment: Increment) -> ClosestPoint | None:
    """The closest point to one trial on plain numbers, at any point of such an increment; None for a word that the loop lacks."""
    if (loop := Loop.of(increment, plain=True)) is None:
        return None
    numbers, mean, d = (loop.constants.tolist(), loop.root.tolist(), loop.inverse.tolist(), loop.formula.degree), loop.mean, len(loop.root)
    data = loop.data_at_one()

    def closest(trial: Sequence[float], pressure: float) -> Any:
        try:
            return found(loop.run, trial, pressure)
        except FAULTS:  # 0/0 at a tip, a logarithm beyond its range: compiled code goes on
            going_on = Loop.of(increment, plain=True, goes_on=True)
            assert going_on is not None
        try:
            return found(going_on.run, trial, pressure)
        except FAULTS:
            return None

    def found(run: Callable[..., None], trial: Sequence[float], pressure: float) -> Any:
        stress, slip, multiplier, state = zeros(1, d), zeros(1, d), [0.0], [LEFT]
        run([trial], data(pressure).tolist(), *numbers, stress, slip, multiplier, state)
        if state[0] == LEFT:
            return None
        return stress[0], [x / mean for x in slip[0]], multiplier[0] / mean

    return closest


def compiled_closest(increment: Increment) -> ClosestPoint | None:
    """The same compiled, of arrays of one point; MissingExtraError without numba."""
    if (loop := Loop.of(increment)) is None:
        return None
    numbers, mean, d = (loop.constants, loop.root, loop.inverse, loop.formula.degree), loop.mean, len(loop.root)

    def room() -> tuple[Array, Array, Array, NDArray[np.int8]]:
        return np.empty((1, d)), np.empty((1, d)), np.empty(1), np.empty(1, dtype=np.int8)

    assert isinstance(loop.run, CompiledText)
    data = loop.data_at_one()
    run = loop.run.specialised(only_read(np.zeros((1, d))), data(-1.0), *numbers, *room())

    def closest(trial: Array, pressure: Array) -> Any:
        stress, slip, multiplier, state = room()
        run(trial, data(pressure.item()), *numbers, stress, slip, multiplier, state)
        if state.item() == LEFT:
            return None
        if mean != 1.0:
            slip /= mean
            multiplier[0] = multiplier.item() / mean
        return stress, slip, multiplier

    return closest


@lru_cache(maxsize=256)
def _made(
    g: sp.Expr, forces: tuple[sp.Symbol, ...], pressure: sp.Symbol | None, entry: str, sources: tuple[ModuleType, ...]
) -> tuple[str, ScaledFormula, Array] | None:
    """The text to compile, the formula in units of its own size and its constants.

    None for a word without derivatives as text.
    """
    formula = scaled(g, forces, pressure)
    try:
        jets = scalar_jets(formula.expr, forces, tuple(formula.data))
    except InputError:
        return None
    return kernel_text(formula, jets, len(forces), *sources, entry=entry), formula, np.array(jets.constants)


def kernel_text(formula: ScaledFormula, jets: ScalarJets, d: int, *sources: ModuleType, entry: str = "solve") -> str:
    """The module that is compiled for one law in ``d`` forces, whatever its parameters but for exponents and whole numbers."""
    return module_text(formula, d, jets, (jets.level, jets.piece), (*KERNEL, *sources), (entry,))
