"""What lies between the knots of a history: the integrator's own curve, at as many points as a drawing needs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.path.elementary_steps import Move
from duhem.path.exact import Piece, Reached
from duhem.path.history import STATES, History
from duhem.path.integrators import INTEGRATORS
from duhem.path.run import Plan
from duhem.projection.result import Array

__all__ = ["Trajectory", "trajectory"]

_POINTS = 4096  # about how many in all, where nobody says how many a step
_MOST_A_STEP = 48
_NEAR = 1 / 50  # of the range of the stresses: farther apart, two neighbours have rows put between them
_MOST_MORE = 8  # times as many rows, at most, as there are in equal parts
_ROUNDS = 12
_APART = 1e-9  # parts of a step closer than this, as seen from its start, are one


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A history with rows between its knots.

    ``states`` holds all rows; ``knots`` the row numbers of those of the history, which are the same to the last bit;
    ``slips`` whether the law slips on the way to each row (the first: never).  The balance of a row between two knots is
    that since the knot before it.
    """

    states: History
    knots: NDArray[np.intp]
    slips: NDArray[np.bool_]


def trajectory(history: History, samples: int | None = None) -> Trajectory:
    """The states that the law goes through on the way from knot to knot, each step in ``samples`` parts of equal time.

    An exact path is evaluated anew between its knots: stress, slip, multiplier and energies are those of the law there, and
    one more row stands wherever slip begins or ends.  So it is with a prescribed stress.  Implicit and extrapolated steps
    know their knots only, and have no rows in between.  Left out, ``samples`` is what makes about 4,000 rows, at most 48 a step,
    and more rows stand where neighbouring stresses would differ by more than 1/50 of the range of all: a step may be long
    against the way on which the stress settles, at most eight times as many.
    """
    if samples is not None and (isinstance(samples, bool) or not isinstance(samples, int) or samples < 1):
        raise InputError(f"samples = {samples!r}", where="trajectory", remedy="give a whole number >= 1")
    steps = len(history) - 1
    each = samples if samples is not None else min(max(_POINTS // max(steps, 1), 1), _MOST_A_STEP)
    along = None if history.plan is None else _along(history.plan, history.method)
    if history.plan is None or along is None or each == 1:
        return Trajectory(history, np.arange(len(history)), np.diff(history.multiplier, prepend=history.multiplier[0]) > 0.0)
    even = [j / each for j in range(1, each)]
    more = _MOST_MORE * each if samples is None else 0
    rows, knots, slips = [_row(history, 0)], [0], [False]
    for i in range(1, len(history)):
        parts, found = _sampled(along, history, history.plan, i, even, more)
        inner = [_between(history, history.plan, i, part, reached) for part, reached in zip(parts, found[:-1], strict=False)]
        rows += [*inner, _row(history, i)]
        knots.append(len(rows) - 1)
        free = np.diff([0.0, *(moved.free for _, moved in found)])
        slips += (free < 0.5 * np.diff([0.0, *parts, 1.0])).tolist()
    columns: dict[str, Any] = {name: np.array(column) for name, column in zip(_COLUMNS, zip(*rows, strict=True), strict=True)}
    states = replace(history, **columns)
    return Trajectory(states, np.array(knots), np.array(slips))


def _along(plan: Plan, method: str) -> Piece | None:
    """What moves the stress within a step; None where only the knots are known."""
    if method in INTEGRATORS:
        pieces = INTEGRATORS[method].piece
        return None if pieces is None else pieces(plan)
    if plan.path.control == "stress":
        values, c = plan.path.values, plan.compliance

        def elastic(stress: Sequence[float], i: int, parts: Sequence[float]) -> list[Reached]:
            grown = [part * (values[i] - values[i - 1]) for part in parts]
            works = [float((stress + 0.5 * dsigma) @ c @ dsigma) for dsigma in grown]
            return [(stress + dsigma, Move((), 0.0, 0.0, work, part)) for dsigma, work, part in zip(grown, works, parts, strict=True)]

        return elastic
    return None


def _sampled(along: Piece, history: History, plan: Plan, i: int, even: list[float], more: int) -> tuple[list[float], list[Reached]]:
    """Where step i is looked at before its end, and what has been reached there and at its end.

    Where an interval is neither all slip nor all rest, the time it rests is known, so that the change lies that far behind
    its beginning or before its end: one more look at each.  Then up to ``more`` looks between neighbours that are far apart.
    """
    stress, parts = history.stress[i - 1].tolist(), np.array([*even, 1.0])
    found = along(stress, i, parts.tolist())
    starts, free = np.array([0.0, *even]), np.array([0.0, *(moved.free for _, moved in found)])
    rest = np.diff(free)
    mixed = (rest > _APART * free[1:]) & (rest < (parts - starts) * (1.0 - _APART))
    changes = np.sort(np.concatenate([(starts + rest)[mixed], (parts - rest)[mixed]]))
    if changes.size:
        every = np.sort(np.concatenate([parts, changes]))
        parts = np.append(every[:-1][np.diff(every) > _APART * every[1:]], 1.0)
        found = along(stress, i, parts.tolist())
    room = len(parts) + more
    for _ in range(_ROUNDS if more else 0):
        wanted = _wanted(history, plan, i, parts, found, np.append(0.0, changes))[: room - len(parts)]
        if not wanted:
            break
        looks = [*zip(parts.tolist(), found, strict=True), *zip(wanted, along(stress, i, wanted), strict=True)]
        looks.sort(key=lambda look: look[0])
        parts, found = np.array([part for part, _ in looks]), [reached for _, reached in looks]
    return parts[:-1].tolist(), found


def _wanted(history: History, plan: Plan, i: int, parts: Array, found: list[Reached], changes: Array) -> list[float]:
    """Parts of step i between neighbours whose stresses are far apart.

    From each change between rest and slip on, the stress settles over a way that may be any fraction of the step: looks
    stand farther apart the farther they are from it, beginning with the part in which the stress without slip would go
    through the range of all.
    """
    path, seen = plan.path, np.array([history.stress[i - 1], *(stress for stress, _ in found)])
    reach = float(np.ptp(np.concatenate([history.stress, seen]), axis=0).max())
    way = np.array([path.between(i, part)[1] - path.values[i - 1] for part in parts])
    pull = float(np.abs(way @ plan.stiffness).max()) if path.control == "displacement" else 0.0
    scale = reach / pull if pull > reach else 1.0
    wanted = []
    starts, apart = np.append(0.0, parts[:-1]), np.abs(np.diff(seen, axis=0)).max(axis=1)
    for j in np.flatnonzero(apart > _NEAR * reach):
        start, end = float(starts[j]), float(parts[j])
        since = float(changes[changes <= start].max())
        near, far = max(start - since, scale / _MOST_A_STEP), end - since
        count = min(int(np.ceil(apart[j] / (_NEAR * reach))), _MOST_A_STEP)
        if far > 2.0 * near:
            looks = since + np.geomspace(near, far, count + 1)[start >= since + near : -1]
        else:
            looks = np.linspace(start, end, count + 1)[1:-1]
        wanted += [part for part in looks.tolist() if start * (1.0 + 1e-15) < part < end * (1.0 - 1e-15)]
    return wanted


_COLUMNS = ("time", *STATES)


def _row(history: History, i: int) -> tuple[Array | float, ...]:
    return tuple(getattr(history, name)[i] for name in _COLUMNS)


def _between(history: History, plan: Plan, i: int, part: float, reached: Reached) -> tuple[Array | float, ...]:
    """The row at a part of step i."""
    stress, moved = np.array(reached[0]), reached[1]
    path, before = plan.path, i - 1
    time, values, pressure = path.between(i, part)
    strained = plan.compliance @ (stress - history.stress[before])
    if path.control == "stress":
        displacement, slip = history.displacement[before] + strained, history.slip[before]
    else:
        displacement = values
        slip = history.slip[before] + (0.0 if moved.free >= part else values - path.values[before] - strained)
    psi = float(plan.psi(stress))
    return (
        time,
        displacement,
        slip,
        stress,
        pressure,
        history.multiplier[before] + moved.multiplier,
        psi,
        history.dissipation[before] + moved.dissipation,
        history.work[before] + moved.work,
        history.numerical[before],
        moved.work - (psi - history.psi[before]) - moved.dissipation,
    )
