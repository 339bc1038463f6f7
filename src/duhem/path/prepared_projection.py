"""The closest point of K at the knots of a path, prepared once: what K needs of the pressure is known before the first step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from duhem.errors import DuhemError
from duhem.law.shapes import Disk, Interval, Quadrants
from duhem.projection import closed_form, quadrants
from duhem.projection.coefficients import coefficients, of_pressure
from duhem.projection.increment import Increment
from duhem.projection.projector import Projector
from duhem.projection.result import NOT_CLOSEST, NOT_SHOWN, Array, Status

__all__ = ["LOST", "Answer", "Closest", "Numbers", "closest", "named", "numbers"]

LOST = (Status.INACCURATE, Status.FAILED)

Rows = NDArray[np.intp]
Answer = tuple[Array, Array, Array]  # stress (n, d), slip (n, d), multiplier (n,)
Closest = Callable[[Array, Rows], Answer]


@dataclass(frozen=True, eq=False)
class Numbers:
    """The declared shape of K along a path: semi-axes coefficient x load about centre, the first fixed, the others (m,), (m, d).

    ``share`` (m,) turns the multiplier of the gauge built from the coefficients into that of the law's g.
    """

    coefficients: tuple[float, ...]
    load: Array
    centre: Array
    share: Array


def numbers(increment: Increment) -> Numbers | None:
    """The shape in numbers at each pressure of ``increment``; None where the law declares none that fits."""
    shape = increment.law.closed_form
    if shape is None or closed_form.applies(increment) is not None:
        return None
    pressure = increment.pressure
    once = pressure[:1] if (pressure == pressure[0]).all() else pressure  # constant pressure: K is assembled once

    def along(entry: object) -> Array:
        return np.array(np.broadcast_to(of_pressure(increment, entry)(once), pressure.shape))

    found = coefficients(increment)
    slope = along(shape.slope)
    entries = (shape.centre_a, shape.centre_b) if isinstance(shape, Quadrants) else (0,) * len(increment.law.forces)
    return Numbers(
        coefficients=found.mu,
        load=along(shape.load) * (not found.empty),
        centre=np.stack([along(entry) for entry in entries], axis=1),
        share=1.0 / (np.where(slope > 0.0, slope, 1.0) * found.scale),
    )


def closest(increment: Increment, method: str) -> tuple[Closest, str]:
    """(trial (n, d), row numbers (n,)) -> closest points under the pressure of these rows, and the name of the method."""
    shape = numbers(increment) if method in ("auto", "closed-form") else None
    if shape is None:
        return _by_projection(increment, method)
    kind = increment.law.closed_form
    if isinstance(kind, Interval):
        return _on_interval(shape, increment), "closed form on an interval"
    name = "a disk" if isinstance(kind, Disk) else "four quarter ellipses"
    return _on_quarters(shape, quadrants.Quarters.of(shape.coefficients, increment.stiffness)), f"closed form on {name}"


def _on_quarters(shape: Numbers, quarters: quadrants.Quarters) -> Closest:
    moved = bool(shape.centre.any())

    def at(trial: Array, rows: Rows) -> Answer:
        stress, slip, multiplier = np.empty_like(trial), np.empty_like(trial), np.empty(len(trial))
        centre = shape.centre[rows]
        quadrants.project(trial - centre if moved else trial, shape.load[rows], quarters, stress, slip, multiplier)
        if moved:
            stress = np.where((multiplier > 0.0)[:, None], stress + centre, trial)
        return stress, slip, multiplier * shape.share[rows]

    return at


def _on_interval(shape: Numbers, increment: Increment) -> Closest:
    plus, minus = shape.coefficients
    k = float(increment.stiffness[0, 0])

    def at(trial: Array, rows: Rows) -> Answer:
        mu = np.where(trial[:, 0] < 0.0, minus, plus)
        stress, slip, multiplier = quadrants.clamped(trial[:, 0], mu, shape.load[rows], k)
        return stress[:, None], slip[:, None], multiplier * shape.share[rows]

    return at


def _by_projection(increment: Increment, method: str) -> tuple[Closest, str]:
    """Through :class:`duhem.projection.projector.Projector`, which judges each answer; one that is not found ends the run."""
    prepared = Projector.of(increment.law, increment.stiffness, increment.parameters, method)

    def at(trial: Array, rows: Rows) -> Answer:
        found = prepared.at(replace(prepared.setting, trial=trial, pressure=increment.pressure[rows], convexity=increment.convexity))
        slips = np.flatnonzero((found.slip != 0.0).any(axis=1) | (found.multiplier > 0.0))
        read = slips[0] + 1 if slips.size else len(rows)  # a run takes a block no further than its first slip
        if (lost := np.flatnonzero(np.isin(found.status[:read], LOST))).size:
            row, status = int(rows[lost[0]]), Status(int(found.status[lost[0]])).name.lower()
            what, why = f"the closest point under method {found.method} is {status}", found.remark(int(lost[0]))
            what, remedy = f"{what}: {why}", "take another projection, or smaller steps"
            if why == NOT_CLOSEST:
                remedy = "verify the law's convexity, and take parameters for which it holds"
            raise DuhemError(what, where=f"step {row}", remedy=remedy)
        return found.stress, found.slip, found.multiplier

    return at, named(prepared, increment)


def named(projector: Projector, question: Increment) -> str:
    """The method, and what it leaves open under the pressures of a question."""
    known = projector.method.convex or question.convexity is None or question.shown_convex().all()
    return f"projection by {projector.method.name}{'' if known else f'; {NOT_SHOWN}'}"
