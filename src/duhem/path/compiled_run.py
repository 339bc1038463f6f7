"""Compiled implicit steps put to use: for a share of many points and for one path, on declared shapes and by any law's own loop.

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
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.law.shapes import Interval
from duhem.path.closest import LOST, ClosestPoints, ShapeNumbers, shape_by
from duhem.path.compiled_run import loops
from duhem.path.history import SUMS, Histories
from duhem.path.integrators import steps, stretch
from duhem.path.ledger import Ledger, States
from duhem.path.loading import Paths, Which
from duhem.path.run import Plan, Share, columns
from duhem.path.step_formulas import booked
from duhem.projection.compiled_newton import Loop
from duhem.projection.declared_ranges import beyond
from duhem.projection.increment import Convexity, Increment
from duhem.projection.newton_kernel import KINKS, LEFT, SLIP, solved
from duhem.projection.newton_step import DATA, MATRICES, ROWS, D
from duhem.projection.projector import Projector
from duhem.projection.quadrants import Quarters, stacked
from duhem.projection.result import Array, Projection, Solution, Status

__all__ = ["advance", "fill", "looped", "reason"]

_STEPS = 65_536  # of one path without looking up, so that it can be interrupted
_FEW = 64  # steps after one that the loop did not take


def advance(plan: Plan, ledger: Ledger) -> Iterator[int]:
    """As the implicit integrator's, in long stretches.  InputError for what has no compiled loop."""
    share = Share.alone(plan)
    shape = shape_by(share, plan.projection)
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
    states.keep(out, np.arange(len(share)), 0)
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
    """An array (..., d) of d <= 2 components, with zeros for the second where there is one."""
    return array if array.shape[-1] == 2 else np.concatenate([array, np.zeros_like(array)], axis=-1)


def _run(share: Share, shape: ShapeNumbers, state: Array, ends: tuple[Any, Any], knots: tuple[int, int], row: Any, out: Any) -> None:
    paths, member, d = share.paths, share.members[0], share.paths.values.shape[2]
    k, c = np.zeros((2, 2)), np.zeros((2, 2))
    k[:d, :d], c[:d, :d] = member.stiffness, share.compliance
    along = paths.values, paths.factor[:, None], shape.load, shape.share, shape.centre
    driven = *map(np.ascontiguousarray, along), k, c, state, *ends
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


def _loop(member: Increment, projection: str) -> tuple[Projector, Loop] | str:
    """The judge of a law with numbers in place and the loop that is made for it, or in words why there is none."""
    prepared = Projector.of(member.law, member.stiffness, member.parameters, projection)
    if prepared.method.name != "newton":
        return f"projection by {prepared.method.name} has none"
    loop = Loop.of(prepared.setting, "along", sys.modules[__name__])
    return "a word has no derivative as text" if loop is None else (prepared, loop)


def looped(share: Share, projection: str, out: Histories) -> Which | None:
    """The histories of the points whose paths the loop of their law takes to the end, and which others are left; None without a loop."""
    paths, m, left = share.paths, len(share.paths.time), np.ones(len(share), dtype=np.bool_)
    for i, member in enumerate(share.members):
        if isinstance(made := _loop(member, projection), str):
            return None
        mine, each = np.flatnonzero(share.own == i), max(1, _STEPS // m)
        for some in (mine[first : first + each] for first in range(0, len(mine), each)):
            stress, u = share.stress[some], paths.at(0, some)
            found, taken = _taken(*made, member.convexity, paths, some, (stress, u), (1, m))
            whole = np.flatnonzero(taken == m - 1)
            if not whole.size:
                continue
            rows = whole[:, None] * (m - 1) + np.arange(m - 1)
            ledger = Ledger.begun(m, u[whole], stress[whole], share.compliance)
            along = paths.at(np.tile(np.arange(m), len(whole)), np.repeat(some[whole], m))
            _book(ledger, member.stiffness, stress[whole], along.reshape(len(whole), m, -1), found, rows)
            sound = ledger.sound().all(axis=1) & ~beyond(member.law, found.stress).reshape(-1, m - 1)[whole].any(axis=1)
            ledger.keep(out, some[whole])
            left[some[whole[sound]]] = False
    return np.flatnonzero(left)


def _by_loop(plan: Plan, ledger: Ledger) -> Iterator[int]:
    """One path by the loop that is made for its law."""
    if isinstance(made := _loop(plan.increment, plan.projection), str):
        raise _missing(made)
    both, paths, one = steps("implicit", plan), Share.alone(plan).paths, np.zeros(1, dtype=np.intp)
    values, m = plan.path.values, len(plan.path.values)
    anchor, ahead = ledger.anchor, _STEPS
    while ledger.done < m:
        first, last = ledger.done, min(ledger.done + ahead, m)
        begun = ledger.stress[anchor : anchor + 1], values[anchor : anchor + 1]
        found, taken = _taken(*made, plan.increment.convexity, paths, one, begun, (first, last))
        if n := int(taken[0]):
            slips = _book(ledger, plan.stiffness, ledger.stress[first - 1], values[first - 1 : first + n], found, np.arange(n))
            anchor = first + int(np.flatnonzero(slips)[-1]) if slips.any() else anchor
        ahead = min(2 * ahead, _STEPS)
        if not n:  # one step by the search, which ends the run if it finds nothing
            anchor, ahead = first if stretch(plan, ledger, both, anchor, 1) else anchor, _FEW
        yield ledger.done


def _book(ledger: Ledger, k: Array, stress: Array, values: Array, found: ClosestPoints, rows: Which) -> NDArray[np.bool_]:
    """Put what was found at ``rows`` (..., m) into the ledger, from the stress and along the m + 1 displacements; which of them slip."""
    slips, near = found.slips()[rows], found.stress[rows]
    before, trial = columns(np.concatenate([stress[..., None, :], near[..., :-1, :]], axis=-2)), columns(near)
    slip, multiplier = columns(found.slip[rows]), found.multiplier[rows].ravel()
    end, begin, matrices = columns(values[..., 1:, :]), columns(values[..., :-1, :]), (k[:, :, None], ledger.compliance[:, :, None])
    _, _, added = booked(before, trial, trial, slip, multiplier, slips.ravel(), end, begin, *matrices)
    ledger.rows(near, found.slip[rows], np.reshape(added, (4, *slips.shape)))
    return slips


def _taken(
    prepared: Projector, loop: Loop, known: Convexity | None, paths: Paths, which: Which, begun: tuple[Array, Array], knots: tuple[int, int]
) -> tuple[ClosestPoints, Which]:
    """What the loop finds of points from the first of ``knots`` to before the last, from where they last slipped, point by point.

    How many knots of each the judge takes as they are; nothing slips where it sticks.
    """
    n, m = len(which), knots[1] - knots[0]
    every, point = np.tile(np.arange(*knots), n), np.repeat(which, m)
    values, pressure = paths.at(every, point), paths.pressure_at(every, point)
    trial, stress, slip = (np.empty_like(values) for _ in range(3))
    multiplier, state = np.empty(n * m), np.empty(n * m, dtype=np.int8)
    k, data = np.array(prepared.setting.stiffness, order="C"), loop.data(pressure)
    for i in range(n):
        own = slice(i * m, (i + 1) * m)
        given = values[own], k, begun[0][i].copy(), begun[1][i].copy(), data[own], loop.constants, loop.root, loop.inverse
        loop.run(*given, loop.formula.degree, trial[own], stress[own], slip[own], multiplier[own], state[own])
    seen = np.flatnonzero(state != LEFT)
    solution = Solution(stress[seen], slip[seen] / loop.mean, multiplier[seen] / loop.mean, np.zeros(len(seen), dtype=np.bool_))
    judged = _judged(prepared, known, solution, trial[seen], pressure[seen])
    found = ClosestPoints(stress, slip, multiplier, state)
    found.stress[seen], found.slip[seen], found.multiplier[seen] = judged.stress, judged.slip, judged.multiplier
    good = np.zeros((n, m), dtype=np.bool_)
    same = (judged.stress == solution.stress).all(axis=1) & (found.slips()[seen] == (state[seen] == SLIP))
    good.reshape(-1)[seen] = same & ~np.isin(judged.status, LOST)
    return found, np.where(good.all(axis=1), m, np.argmin(good, axis=1))


def _judged(prepared: Projector, known: Convexity | None, solution: Solution, trial: Array, pressure: Array) -> Projection:
    """The solution as any other answer of the method."""
    question = replace(prepared.setting, trial=trial, pressure=pressure, convexity=known)
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
