"""Compiled implicit steps put to use: for a share of many points on declared shapes, and for one path of any law.

On a declared shape one path is a share of one point.  Any other law's own loop takes long stretches, which are then judged together:
what the loop leaves, and what the judge does not take as it is, is one step of the search, from which the loop goes on.  Steps do not
depend on where a stretch begins.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from duhem.errors import InputError
from duhem.law.shapes import Interval
from duhem.path.batch import Share
from duhem.path.closest import LOST, Found, ShapeNumbers, shape_numbers
from duhem.path.compiled_steps import loops
from duhem.path.history import SUMS, Histories
from duhem.path.integrators import first_of, gains, stepping, stretch
from duhem.path.ledger import Ledger, States
from duhem.path.run import Plan
from duhem.projection.compiled_newton import Loop
from duhem.projection.newton_kernel import KINKS, LEFT, SLIP, solved
from duhem.projection.newton_start import DATA
from duhem.projection.newton_step import MATRICES, ROWS, D
from duhem.projection.projector import Projector
from duhem.projection.quadrants import Quarters, stacked
from duhem.projection.result import Array, Projection, Solution, Status

__all__ = ["advance", "fill", "reason"]

_STEPS = 65_536  # of one path without looking up, so that it can be interrupted
_FEW = 64  # steps after one that the loop did not take


def advance(plan: Plan, ledger: Ledger) -> Iterator[int]:
    """As the implicit integrator's, in long stretches.  InputError for what has no compiled loop."""
    share = Share.alone(plan)
    shape = shape_numbers(share) if plan.projection in ("auto", "closed-form") else None
    return _by_loop(plan, ledger) if shape is None else _by_shape(plan, ledger, share, shape)


def _missing(why: str) -> InputError:
    return InputError(f"there is no compiled path: {why}", where="compiled", remedy="leave compiled out")


# -- declared shapes -----------------------------------------------------------------------------------------------------


def reason(share: Share, shape: ShapeNumbers) -> str | None:
    """None where the compiled loops apply to a declared shape, else why not."""
    law = share.members[0].law
    if not isinstance(law.closed_form, Interval) and not shape.coefficients.all():
        return "K is flat in a quadrant"
    if any(force in law.domain for force in law.forces):
        return "the law declares a range of stresses"
    return None


def fill(share: Share, shape: ShapeNumbers, out: Histories) -> None:
    """The histories of a share of many points."""
    states, m = States.begun(share), len(share.paths.time)
    row = np.full(m, -1, dtype=np.intp)
    row[out.knots] = np.arange(len(out.knots))
    states.keep(out, 0)
    vectors = states.stress, states.slip, states.anchor_stress, states.anchor
    state = np.concatenate([*map(_two, vectors), *(getattr(states, name)[:, None] for name in SUMS)], axis=1)
    _run(share, shape, state, (states.status, states.reached), (1, m), row, out)
    out.status[:], out.reached[:] = states.status, states.reached


def _by_shape(plan: Plan, ledger: Ledger, share: Share, shape: ShapeNumbers) -> Iterator[int]:
    """One path on a declared shape, as a share of one point whose table is the ledger."""
    if (why := reason(share, shape)) is not None:
        raise _missing(why)
    m, i, anchor = len(plan.path.time), ledger.done - 1, ledger.anchor
    vectors = ledger.stress[i], ledger.slip[i], ledger.stress[anchor], plan.path.values[anchor]
    sums = [0.0 if name == "balance" else getattr(ledger, name)[i] for name in SUMS]
    state = np.concatenate([*map(_two, vectors), sums])[None]
    ends = np.full(1, int(Status.STICK), dtype=np.int8), np.full(1, i, dtype=np.intp)
    table = replace(ledger, **{name: getattr(ledger, name)[None] for name in ("stress", "slip", *SUMS)})
    while ledger.done < m and ends[0][0] != Status.FAILED:
        first, last = ledger.done, min(ledger.done + _STEPS, m)
        _run(share, shape, state, ends, (first, last), np.arange(m), table)
        ledger.done = last
        yield last


def _two(array: Array) -> Array:
    """An array (..., d) of d <= 2 components, with zeros for the second where there is one, in memory row by row."""
    return np.ascontiguousarray(array if array.shape[-1] == 2 else np.concatenate([array, np.zeros_like(array)], axis=-1))


def _run(share: Share, shape: ShapeNumbers, state: Array, ends: tuple[Any, Any], knots: tuple[int, int], row: Any, out: Any) -> None:
    paths, member, d = share.paths, share.members[0], share.paths.values.shape[2]
    k, c = np.zeros((2, 2)), np.zeros((2, 2))
    k[:d, :d], c[:d, :d] = member.stiffness, share.compliance
    along = _two(paths.values), _two(paths.factor[:, None]), np.ascontiguousarray(shape.load), np.ascontiguousarray(shape.share)
    driven = *along, _two(shape.centre), k, c, state, *ends
    kept = share.own, *knots, row, out.stress, out.slip, tuple(getattr(out, name) for name in SUMS)
    made = loops()
    if isinstance(member.law.closed_form, Interval):
        made.interval(*driven, (np.ascontiguousarray(shape.coefficients), float(k[0, 0])), *kept)
        return
    q = stacked([Quarters.of(mu, member.stiffness) for mu in shape.coefficients.tolist()])
    quarters = tuple(map(np.ascontiguousarray, (q.mu, q.axes, q.axes_low, q.ratio, q.compliance, q.power, q.first)))
    alike = len(share.members) == 1 and len(share) > 1 and q.diagonal
    (made.abreast if alike else made.quarters)(*driven, quarters, *kept)


# -- any other law -------------------------------------------------------------------------------------------------------


def _by_loop(plan: Plan, ledger: Ledger) -> Iterator[int]:
    """One path by the loop that is made for its law."""
    question, m = plan.increment, len(plan.path.values)
    prepared = Projector.of(question.law, question.stiffness, question.parameters, plan.projection)
    if prepared.method.name != "newton":
        raise _missing(f"projection by {prepared.method.name} has none")
    if (loop := Loop.of(question, "along", sys.modules[__name__])) is None:
        raise _missing("a word has no derivative as text")
    step = stepping("implicit", plan)
    anchor, ahead = ledger.anchor, _STEPS
    while ledger.done < m:
        first, last = ledger.done, min(ledger.done + ahead, m)
        stress, slip, multiplier, *_ = found = _taken(plan, ledger, prepared, loop, anchor, last)
        if n := len(stress):
            before, du = ledger.stress[first - 1 : first], np.diff(plan.path.values[first - 1 : first + n], axis=0)
            slips, before = found.slips(), np.concatenate([before, stress[:-1]])
            ledger.rows(plan, stress, slip, gains(plan.stiffness, plan.compliance, before, stress, slip, multiplier, slips, du))
            anchor = first + int(np.flatnonzero(slips)[-1]) if slips.any() else anchor
        ahead = min(2 * ahead, _STEPS)
        if not n:  # one step by the search, which ends the run if it finds nothing
            anchor, ahead = first if stretch(plan, ledger, step, anchor, 1) else anchor, _FEW
        yield ledger.done


def _taken(plan: Plan, ledger: Ledger, prepared: Projector, loop: Loop, anchor: int, last: int) -> Found:
    """What the loop finds from the next row to before ``last``, as far as the judge takes it as it is; nothing slips where it sticks."""
    rows = slice(ledger.done, last)
    n, d = last - ledger.done, plan.path.values.shape[1]
    pressure = plan.increment.pressure[rows]
    trial, stress, slip = (np.empty((n, d)) for _ in range(3))
    multiplier, state = np.empty(n), np.empty(n, dtype=np.int8)
    begun = ledger.stress[anchor].copy(), plan.path.values[anchor].copy()
    given = np.array(plan.path.values[rows], order="C"), np.array(plan.stiffness, order="C"), *begun, loop.data(pressure)
    loop.run(*given, loop.constants, loop.root, loop.inverse, loop.formula.degree, trial, stress, slip, multiplier, state)
    n = first_of(state == LEFT)
    slips = state[:n] == SLIP
    solution = Solution(stress[:n], slip[:n] / loop.mean, multiplier[:n] / loop.mean, np.zeros(n, dtype=np.bool_))
    judged = _judged(plan, prepared, solution, trial[:n], pressure[:n])
    found = Found(judged.stress, judged.slip, judged.multiplier, judged.status)
    n = first_of((found.stress != solution.stress).any(axis=1) | (found.slips() != slips) | np.isin(judged.status, LOST))
    return Found(found.stress[:n], found.slip[:n], found.multiplier[:n], found.lost[:n])


def _judged(plan: Plan, prepared: Projector, solution: Solution, trial: Array, pressure: Array) -> Projection:
    """The solution as any other answer of the method."""
    question = replace(prepared.setting, trial=trial, pressure=pressure, convexity=plan.increment.convexity)
    given = replace(prepared.method, solve=lambda asked, options: solution, again=None)
    return replace(prepared, method=given).at(question, compiled=True, threads=1)


# -- compiled from here, with the law's functions and the sources of its loop ------------------------------------------------


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
