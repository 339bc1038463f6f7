"""Dissipation, residuals and statuses by one loop that is made for a law: compiled by numba, once a law, or run on plain numbers.

The loop (:mod:`duhem.projection.judge_kernel`) says that a point is plainly right, or leaves it to the judge.  Its text is one: many
points take it compiled, where that is asked for, and few take it one by one as Python runs it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.error_bounds import bounded
from duhem.expression.jets import KINKED
from duhem.expression.scalar_bounds import scalar_bounds
from duhem.expression.scalar_jets import scalar_jets
from duhem.expression.vocabulary import Norm
from duhem.projection import judge_kernel, slip_kernel
from duhem.projection.code_cache import CompiledText, compiled_text, only_read
from duhem.projection.in_blocks import in_blocks, keep_freed_memory
from duhem.projection.increment import Increment, Metric
from duhem.projection.judge_kernel import UNJUDGED
from duhem.projection.module_text import module_text, over_unit
from duhem.projection.newton_step import below, eliminated, grown, length
from duhem.projection.normal_cones import beside
from duhem.projection.plain_numbers import FAULTS, interpreted, zeros
from duhem.projection.residuals import Judge, Told
from duhem.projection.result import Array, Residuals, Solution
from duhem.projection.row_by_row import unit
from duhem.projection.scaled_formula import Level, ScaledFormula
from duhem.projection.variational_samples import Variational

__all__ = ["Look", "compiled_look", "plain_look", "told", "told_one_by_one"]

_BLOCK = 16_384  # fewer are judged before a second thread has begun: ten thousand points took twice as long in shares

Numbers = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class _Loop:
    """The loop of a formula as text; the constants of its data and its own, each with what they are off by."""

    text: str
    constants: tuple[Numbers, Numbers, Numbers, Numbers]


def told(increment: Increment, solution: Solution, judge: Judge, threads: int | None = None) -> Told:
    """What the loop says; nothing for a word that it lacks and a K without the origin.  MissingExtraError without numba."""
    n, loop = len(solution.multiplier), _text(judge.level, increment.law.force_symbols(), judge.known.convex)
    if loop is None or not judge.known.around_origin:
        return Told.nothing(n)
    run = _compiled(loop)
    packed = _packed(loop, judge.level, increment.stiffness, judge.known)
    keep_freed_memory(n)
    dissipation, status, residuals = _room(n)

    def fill(block: slice) -> None:
        given = only_read(increment.trial[block]), only_read(increment.pressure[block])
        got = map(np.ascontiguousarray, (solution.stress[block], solution.slip[block], solution.multiplier[block]))
        run(*given, *packed, *got, dissipation[block], status[block], tuple(residuals[:, block]))

    in_blocks(n, _BLOCK, fill, threads)
    status[solution.failed] = UNJUDGED
    return Told(dissipation, status, Residuals(*residuals), np.flatnonzero(status == UNJUDGED))


def _room(n: int) -> tuple[Array, NDArray[np.int8], Array]:
    """Room for dissipation, status and residuals (5, n) of n points.

    The loop is given the rows of the residuals one by one: a row is contiguous, a block of rows is not, and each kind is compiled for.
    """
    return np.empty(n), np.empty(n, dtype=np.int8), np.zeros((5, n))  # a page of zeros costs nothing till written


def told_one_by_one(increment: Increment, solution: Solution, judge: Judge) -> Told:
    """The same without a compiler, for few points."""
    said = Told.nothing(len(solution.multiplier))
    look = plain_look(judge.level, increment.law.force_symbols(), increment.stiffness, judge.known)
    if look is None:
        return said
    residuals = [getattr(said.residuals, f.name) for f in fields(Residuals)]
    given = increment.trial, increment.pressure, solution.stress, solution.slip, solution.multiplier
    for i, point in enumerate(zip(*(array.tolist() for array in given), strict=True)):
        said.dissipation[i], status, off = look(*point)
        said.status[i] = UNJUDGED if solution.failed[i] else status
        for values, value in zip(residuals, off, strict=True):
            values[i] = value
    return replace(said, left=np.flatnonzero(said.status == UNJUDGED))


Look = Callable[[Any, Any, Any, Any, Any], tuple[float, int, Sequence[float]]]
"""Dissipation, status and residuals of one answer: (trial, pressure, stress, slip, multiplier), plain numbers, or arrays of one point."""


def plain_look(level: Level, forces: tuple[sp.Symbol, ...], stiffness: Array, known: Variational) -> Look | None:
    """What the loop says of one answer on plain numbers.

    None for a word that the loop lacks and a K without the origin.
    """
    loop, d = _text(level, forces, known.convex), len(forces)
    if loop is None or not known.around_origin:
        return None
    run = interpreted(loop.text, "chunk", CHUNK=1)
    seen = _seen(known.tips.tobytes(), known.metric.of_stress.tobytes(), d)
    tables = [x.tolist() for x in (*_matrices(stiffness, known.metric), beside(d), *seen)]
    constants = *loop.constants, *tables, *_figures(level, known.metric)
    sizes = judge_kernel.room(d, 1)

    def look(trial: Sequence[float], pressure: float, stress: Sequence[float], slip: Sequence[float], multiplier: float) -> Any:
        work, status, off = [0.0], [UNJUDGED], tuple([0.0] for _ in range(5))
        room = [zeros(*size) for size in sizes], [0, 0]
        try:
            run(trial, [pressure], known.largest, *constants, stress, slip, [multiplier], work, status, off, *room[0], room[1])
        except FAULTS:
            status[0] = UNJUDGED
        return work[0], status[0], [each[0] for each in off]

    return look


def compiled_look(level: Level, forces: tuple[sp.Symbol, ...], stiffness: Array, known: Variational) -> Look | None:
    """The same of arrays that are only read, compiled; MissingExtraError without numba."""
    loop, d = _text(level, forces, known.convex), len(forces)
    if loop is None or not known.around_origin:
        return None
    numbers, rows = _packed(loop, level, stiffness, known)
    compiled, nothing = _compiled(loop), (np.zeros((1, d)), np.zeros(1))
    work, status, off = _room(1)
    run = compiled.specialised(*map(only_read, nothing), numbers, rows, np.zeros((1, d)), *nothing, work, status, tuple(off))

    def look(trial: Array, pressure: Array, stress: Array, slip: Array, multiplier: Array) -> Any:
        work, status, off = _room(1)
        run(trial, pressure, numbers, rows, stress, slip, multiplier, work, status, tuple(off))
        return work.item(), status.item(), off[:, 0]

    return look


def _compiled(loop: _Loop) -> CompiledText:
    return compiled_text(loop.text, "judge")


def _matrices(stiffness: Array, metric: Metric) -> tuple[Array, ...]:
    return stiffness, metric.of_slip, metric.of_stress, metric.to_stress


def _packed(loop: _Loop, level: Level, stiffness: Array, known: Variational) -> tuple[Array, Array]:
    """``numbers`` and ``rows`` of the compiled loop: all that it takes beside points and their answers."""
    tips, ways, reaches = _seen(known.tips.tobytes(), known.metric.of_stress.tobytes(), len(stiffness))
    figures = known.largest, *_figures(level, known.metric)
    numbers = np.array([*figures, *(x for constants in loop.constants for x in constants), *reaches])
    return only_read(numbers), only_read(np.vstack([*_matrices(stiffness, known.metric), tips, ways, beside(len(stiffness))]))


def _unpacked(constants: tuple[Numbers, Numbers, Numbers, Numbers]) -> str:
    """The text of the function that takes ``numbers`` apart again."""
    first, parts = 5, list[str]()
    for numbers in constants:
        parts.append(f"({''.join(f'numbers[{first + k}], ' for k in range(len(numbers)))})")
        first += len(numbers)
    figures = ", ".join(f"numbers[{k}]" for k in range(5))
    return f"def unpacked(numbers):\n    return {figures}, {', '.join(parts)}, numbers[{first}:]"


def _figures(level: Level, metric: Metric) -> tuple[float, float, float, float]:
    return metric.blur, metric.good, metric.certain, level.scaled.degree


@lru_cache(maxsize=256)
def _seen(tips: bytes, of_stress: bytes, d: int) -> tuple[Array, Array, Array]:
    """Points (n, d) with their directions and lengths in the metric."""
    points = np.frombuffer(tips).reshape(-1, d)
    with np.errstate(all="ignore"):  # the origin has no way
        ways, reaches = map(np.nan_to_num, unit(points @ np.frombuffer(of_stress).reshape(d, d)))
    return points, only_read(ways), only_read(reaches)


@lru_cache(maxsize=256)
def _text(level: Level, forces: tuple[sp.Symbol, ...], convex: bool) -> _Loop | None:
    formula, others = level.scaled, tuple(level.scaled.data)
    try:
        jets = scalar_jets(formula.expr, forces, others)
        bounds = scalar_bounds(formula.expr, forces, others, len(others) + len(jets.constants))
        first = len(others) + len(jets.constants) + len(bounds.constants)
        start = scalar_bounds(formula.unstressed(forces), (), others, first, "unstressed")
        data = _data(formula)
    except InputError:  # a word without text
        return None
    sources = (below, grown, length, eliminated, slip_kernel, judge_kernel)
    own = jets.constants + bounds.constants + start.constants, (0.0,) * len(jets.constants) + bounds.off + start.off
    constants = (*data[1:], *own)
    functions = jets.level, jets.gradient, jets.pair_piece, bounds.text, start.text, data[0], _unpacked(constants)
    rest = formula.expr.replace(Norm, lambda *_: sp.Dummy(real=True))  # with a tip where norms are 0 and forces are left to hold them up
    corners = rest.has(*KINKED) or not rest.free_symbols.isdisjoint(forces)
    known = {"CONVEX": int(convex), "CORNERS": int(corners)}
    return _Loop(module_text(formula, len(forces), jets, functions, sources, ("judge", "chunk"), **known), constants)


def _data(formula: ScaledFormula) -> tuple[str, Numbers, Numbers]:
    """``known`` and ``sized`` as text, the data at a pressure and over a unit; the constants in them and what these are off by."""
    functions: list[str] = []
    entries: list[str] = []
    constants, off = Numbers(), Numbers()
    for k, datum in enumerate(formula.data.values()):
        if formula.pressure is not None and datum.expr.has(formula.pressure):
            found = scalar_bounds(datum.expr, (), (formula.pressure,), 1 + len(constants), f"datum{k}")
            functions.append(found.text)
            entries.append(f"datum{k}(0, 0, q, b)")
            constants, off = constants + found.constants, off + found.off
        else:
            entries.append(f"(q[{1 + len(constants)}], b[{1 + len(constants)}])")
            value, bound = bounded(datum.expr, ())([], [])
            constants, off = (*constants, float(value)), (*off, float(bound))
    lines = [f"    v{k}, b{k} = {entry}" for k, entry in enumerate(entries)]
    values, bounds = ("".join(f"{name}{k}, " for k in range(len(entries))) for name in "vb")
    known = ["def known(p, q, b):", "    q, b = (p,) + q, (0.0,) + b", *lines, f"    return ({values}), ({bounds})"]
    over = "".join(f"{over_unit(f'data[{k}]', datum.weight)}, " for k, datum in enumerate(formula.data.values()))
    return "\n\n\n".join([*functions, "\n".join(known), f"def sized(data, size):\n    return ({over})"]), constants, off
