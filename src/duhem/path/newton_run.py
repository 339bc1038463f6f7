"""One path by compiled implicit steps of any law: long stretches by the law's loop, then judged together.

What the loop leaves, and what the judge does not take as it is, is one step of the search, from which the loop goes on.  Steps do not
depend on where a stretch begins.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from duhem.errors import InputError
from duhem.path import newton_steps
from duhem.path.implicit import energies, stretch
from duhem.path.ledger import Ledger
from duhem.path.prepared_projection import LOST, Answer, closest
from duhem.path.run import Plan, inner, times
from duhem.projection.compiled_newton import Loop
from duhem.projection.newton_kernel import LEFT, SLIP
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Projection, Solution

__all__ = ["advance"]

_MOST, _FEW = 65_536, 64  # steps without looking up; after one that the loop did not take


def advance(plan: Plan, ledger: Ledger) -> Iterator[int]:
    """As :func:`duhem.path.implicit.advance`, in long stretches.  InputError for what has no compiled loop."""
    question, m = plan.increment, len(plan.path.values)
    prepared = Projector.of(question.law, question.stiffness, question.parameters, plan.projection)
    loop = Loop.of(question, "along", newton_steps) if prepared.method.name == "newton" else None
    if loop is None:
        why = f"projection by {prepared.method.name} has none" if prepared.method.name != "newton" else "a word has no derivative as text"
        raise InputError(f"there is no compiled path: {why}", where="compiled", remedy="leave compiled out")
    at, _ = closest(question, plan.projection)
    anchor, ahead = ledger.anchor, _MOST
    while ledger.done < m:
        first, last = ledger.done, min(ledger.done + ahead, m)
        anchor = _booked(plan, ledger, _taken(plan, ledger, prepared, loop, anchor, last), anchor)
        ahead = min(2 * ahead, _MOST)
        if ledger.done == first:  # one step by the search, which ends the run if it finds nothing
            anchor, ahead = first if stretch(plan, ledger, at, anchor, 1) else anchor, _FEW
        yield ledger.done


def _taken(plan: Plan, ledger: Ledger, prepared: Projector, loop: Loop, anchor: int, last: int) -> Answer:
    """What the loop finds from the next row to before ``last``, as far as the judge takes it as it is; nothing slips where it sticks."""
    rows = slice(ledger.done, last)
    n, d = last - ledger.done, plan.path.values.shape[1]
    pressure = plan.increment.pressure[rows]
    trial, stress, slip = (np.empty((n, d)) for _ in range(3))
    multiplier, state = np.empty(n), np.empty(n, dtype=np.int8)
    begun = ledger.stress[anchor].copy(), plan.path.values[anchor].copy()
    given = np.array(plan.path.values[rows], order="C"), np.array(plan.stiffness, order="C"), *begun, loop.data(pressure)
    loop.run(*given, loop.constants, loop.root, loop.inverse, loop.formula.degree, trial, stress, slip, multiplier, state)
    n = _first(state == LEFT)
    slips = state[:n] == SLIP
    solution = Solution(stress[:n], slip[:n] / loop.mean, multiplier[:n] / loop.mean, np.zeros(n, dtype=np.bool_))
    found = _judged(plan, prepared, solution, trial[:n], pressure[:n])
    other = (found.stress != solution.stress).any(axis=1) | (((found.slip != 0.0).any(axis=1) | (found.multiplier > 0.0)) != slips)
    n = _first(other | np.isin(found.status, LOST))
    return found.stress[:n], found.slip[:n], found.multiplier[:n]


def _judged(plan: Plan, prepared: Projector, solution: Solution, trial: Array, pressure: Array) -> Projection:
    """The solution as any other answer of the method."""
    question = replace(prepared.setting, trial=trial, pressure=pressure, convexity=plan.increment.convexity)
    given = replace(prepared.method, solve=lambda asked, options: solution, again=None)
    return replace(prepared, method=given).at(question, compiled=True, threads=1)


def _booked(plan: Plan, ledger: Ledger, taken: Answer, anchor: int) -> int:
    """Put the steps into the ledger; the row that last slipped."""
    stress, slip, multiplier = taken
    first, n = ledger.done, len(stress)
    if not n:
        return anchor
    du = np.diff(plan.path.values[first - 1 : first + n], axis=0)
    slips = (slip != 0.0).any(axis=1) | (multiplier > 0.0)
    before = np.vstack([ledger.stress[first - 1], stress[:-1]])
    gained = inner(0.5 * (before + stress), times(stress - before, plan.compliance))
    dissipation, work, numerical = energies(plan.stiffness, stress, slip, du)
    gains = multiplier, np.where(slips, dissipation, 0.0), np.where(slips, work, gained), np.where(slips, numerical, 0.0)
    ledger.rows(plan, stress, slip, gains)
    return first + int(np.flatnonzero(slips)[-1]) if slips.any() else anchor


def _first(where: np.ndarray) -> int:
    """The first row where it holds; how many there are if there is none."""
    return int(np.argmax(where)) if where.any() else len(where)
