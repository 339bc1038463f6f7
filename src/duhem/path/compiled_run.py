"""Compiled implicit steps put to use: for a share of many points, and for one path."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from duhem.errors import InputError
from duhem.law.shapes import Interval
from duhem.path.batch import Share
from duhem.path.batch_projection import ShapeNumbers, shape_numbers
from duhem.path.batch_steps import States
from duhem.path.history import SUMS, Histories
from duhem.path.kept_steps import loops
from duhem.path.ledger import Ledger
from duhem.path.paths import Paths
from duhem.path.run import Plan
from duhem.projection.quadrants import Quarters, stacked
from duhem.projection.result import Array, Status

__all__ = ["advance", "fill", "reason"]

_STEPS = 65_536  # of one path without looking up, so that it can be interrupted


def reason(share: Share, shape: ShapeNumbers | None) -> str | None:
    """None where the compiled loops apply, else why not."""
    law = share.members[0].law
    if shape is None:
        return f"{law.name} declares no closed form"
    if not isinstance(law.closed_form, Interval) and not shape.coefficients.all():
        return "K is flat in a quadrant"
    if any(force in law.domain for force in law.forces):
        return "the law declares a range of stresses"
    return None


def fill(share: Share, shape: ShapeNumbers, out: Histories) -> None:
    """The histories of a share of many points."""
    states, paths = States.begun(share), share.paths
    knots, m = out.knots, len(paths.time)
    row = np.full(m, -1, dtype=np.intp)
    row[knots] = np.arange(len(knots))
    states.keep(out, 0, 0, share.pressure(0))
    state = _packed(states)
    status, reached = np.full(len(share), int(Status.STICK), dtype=np.int8), np.zeros(len(share), dtype=np.intp)
    _run(share, shape, state, (status, reached), (1, m), row, out)
    out.status[:], out.reached[:] = status, reached
    for r, knot in enumerate(knots.tolist()):
        out.displacement[:, r], out.pressure[:, r] = paths.at(knot), share.pressure(knot)
        out.displacement[reached < knot, r] = np.nan


def advance(plan: Plan, ledger: Ledger) -> Iterator[int]:
    """As :func:`duhem.path.implicit.advance`, in long stretches.  InputError for what has no compiled loop."""
    path, increment, m = plan.path, plan.increment, len(plan.path.time)
    pressure = None if path.pressure is None else path.pressure[None]
    one = Paths(path.values[None], np.ones((1, path.values.shape[1])), pressure, path.time)
    share = Share(one, (increment,), np.zeros(1, dtype=np.intp), ledger.stress[:1], plan.compliance)
    shape = shape_numbers(share)
    why = reason(share, shape)
    if shape is None or why is not None:
        raise InputError(f"there is no compiled path: {why}", where="compiled", remedy="leave compiled out")
    begun = States.begun(share)
    anchor, i = ledger.anchor, ledger.done - 1
    for name in ("slip", "stress", *SUMS):
        getattr(begun, name)[0] = getattr(ledger, name)[i]
    begun.balance[0] = 0.0
    begun.anchor_stress[0], begun.anchor[0] = ledger.stress[anchor], path.values[anchor]
    state, ends = _packed(begun), (np.full(1, int(Status.STICK), dtype=np.int8), np.full(1, i, dtype=np.intp))
    rows = _as_of_many(ledger)
    while ledger.done < m and ends[0][0] != Status.FAILED:
        first, last = ledger.done, min(ledger.done + _STEPS, m)
        _run(share, shape, state, ends, (first, last), np.arange(m), rows)
        ledger.done = last
        yield last


def _as_of_many(ledger: Ledger) -> Any:
    """The ledger's arrays as those of one point of many."""
    return replace(ledger, **{name: getattr(ledger, name)[None] for name in ("stress", "slip", *SUMS)})


def _packed(states: States) -> Array:
    """The states as the rows that the loops take."""
    sums = [getattr(states, name)[:, None] for name in SUMS]
    return np.concatenate([states.stress, states.slip, states.anchor_stress, states.anchor, *sums], axis=1)


def _run(share: Share, shape: ShapeNumbers, state: Array, ends: tuple[Any, Any], knots: tuple[int, int], row: Any, out: Any) -> None:
    paths, member = share.paths, share.members[0]
    driven = (
        np.ascontiguousarray(paths.values),
        np.ascontiguousarray(paths.factor),
        np.ascontiguousarray(shape.load),
        np.ascontiguousarray(shape.share),
        np.ascontiguousarray(shape.centre),
        np.ascontiguousarray(member.stiffness),
        np.ascontiguousarray(share.compliance),
        state,
        *ends,
    )
    kept = (*knots, row, out.stress, out.slip, tuple(getattr(out, name) for name in SUMS))
    made = loops()
    if isinstance(member.law.closed_form, Interval):
        k = float(member.stiffness[0, 0])
        made.interval(*driven, (np.ascontiguousarray(shape.coefficients), k), share.own, *kept)
        return
    q = stacked([Quarters.of(mu, member.stiffness) for mu in shape.coefficients.tolist()])
    constants = (q.mu, q.axes, q.axes_low, q.ratio, q.compliance, q.power, q.first)
    quarters = tuple(np.ascontiguousarray(array) for array in constants)
    if len(share.members) == 1 and len(share) > 1 and q.diagonal:
        made.abreast(*driven, quarters, *kept)
    else:
        made.quarters(*driven, quarters, share.own, *kept)
