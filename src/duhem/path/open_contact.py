"""Exact steps on which contact is lost or regained: the pressure vanishes at an end of the step, or all along it.

Where sigma_n = 0 the set K is the origin alone: stress is zero and everything slips.  Towards it the slipping stress settles faster
and faster, on a scale of |sigma_n|; away from it, from zero stress, K grows in proportion at first and the implicit step is the motion
itself.  So the last or first 2^-30 of such a step is an implicit one, of which stress and slip are exact and the sums off by no more
than the square of that share; the rest is the equation's (:mod:`duhem.path.slip_equation`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from duhem.errors import DuhemError, InputError
from duhem.path.plan import Plan
from duhem.path.slip_equation import Drive
from duhem.path.straight_step import Move, Pair
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Status

__all__ = ["OpenContact"]

_BIT = 2.0**-30
Inner = Callable[[Array, Drive, Pair, Sequence[float]], list[Move]]


class OpenContact:
    """Steps of ``plan`` at whose ends the pressure may vanish.  InputError where K then is more than the origin."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        increment = plan.increment
        self.prepared = Projector.of(increment.law, increment.stiffness, increment.parameters, plan.projection)
        sides = np.concatenate([np.eye(len(increment.law.forces)), -np.eye(len(increment.law.forces))])
        found = self.prepared.at(replace(increment, trial=sides, pressure=np.zeros(len(sides))))
        if found.stress.any():
            raise InputError(
                f"K of {increment.law.name} is neither the origin nor round where the pressure vanishes",
                where=f"pressure[{int(np.flatnonzero(increment.pressure == 0.0)[0])}]",
                remedy='use method="implicit"',
            )

    def moves(self, inner: Inner, stress: Array, drive: Drive, loads: Pair, parts: Sequence[float]) -> list[Move]:
        """As :func:`duhem.path.slip_equation.moves`, which is ``inner``, where a load is zero."""
        if loads == (0.0, 0.0):
            du = drive(1.0)[0]
            if not np.array_equal(drive(0.5)[0] * 2.0, du):
                raise InputError("open contact on an arc", where="path", remedy='use method="implicit", or chords=True')
            return [self._bit(stress, part * du, 0.0, part) for part in parts]
        first, last = (_BIT, 1.0) if loads[0] == 0.0 else (0.0, 1.0 - _BIT)
        at = (loads[1] * _BIT, loads[1]) if loads[0] == 0.0 else (loads[0], loads[0] * _BIT)
        begun = Move(tuple(stress.tolist()), 0.0, 0.0, 0.0, 0.0)
        if first > 0.0:
            begun = self._bit(stress, drive(first)[0], at[0], first)
        start = drive(first)[0]

        def between(tau: float) -> tuple[Array, Array]:
            u, rate = drive(first + (last - first) * tau)
            return u - start, (last - first) * rate

        inside = [part for part in parts if first < part < last]
        whole = inner(np.array(begun.stress), between, at, [*((part - first) / (last - first) for part in inside), 1.0])
        reached = [_after(begun, move, last - first) for move in whole]
        end = reached[-1]
        if last < 1.0:
            end = _after(end, self._bit(np.array(end.stress), drive(1.0)[0] - drive(last)[0], 0.0, 1.0 - last), 1.0)
        early = [self._bit(stress, drive(part)[0], part * loads[1], part) for part in parts if part <= first]
        return [*early, *reached[:-1], *(end for part in parts if part >= last)]

    def _bit(self, stress: Array, du: Array, pressure: float, part: float) -> Move:
        """An implicit step over a ``part`` of the whole that ends under ``pressure``, the stress going straight."""
        increment = self.plan.increment
        trial = stress + self.plan.stiffness @ du
        found = self.prepared.at(replace(increment, trial=trial[None], pressure=np.array([pressure])))
        if found.status[0] > Status.SLIP and found.status[0] != Status.OUTSIDE:
            raise DuhemError("the closest point where contact opens or closes was not found", remedy='use method="implicit"')
        end, slip = found.stress[0], found.slip[0]
        mean = 0.5 * (stress + end)
        free = part if not found.multiplier[0] > 0.0 else 0.0
        return Move(tuple(end.tolist()), float(found.multiplier[0]), float(mean @ slip), float(mean @ du), free)


def _after(before: Move, move: Move, share: float) -> Move:
    """Two moves in turn; what is free in the second is a part of ``share`` of the step."""
    return Move(
        move.stress,
        before.multiplier + move.multiplier,
        before.dissipation + move.dissipation,
        before.work + move.work,
        before.free + share * move.free,
    )
