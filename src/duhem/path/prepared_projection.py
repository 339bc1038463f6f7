"""The closest point of K at the knots of a path, prepared once: what K needs of the pressure is known before the first step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from duhem.errors import DuhemError
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Disk, Interval, Quadrants
from duhem.projection import closed_form, compiled, quadrants
from duhem.projection.coefficients import coefficients, of_pressure
from duhem.projection.increment import Increment
from duhem.projection.projector import Projector
from duhem.projection.result import NOT_CLOSEST, NOT_SHOWN, Array, Status

__all__ = ["LOST", "Answer", "Closest", "Numbers", "closest", "named", "numbers", "on_interval", "on_quarters", "shape_name"]

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
    k, load, share = increment.stiffness, shape.load, shape.share
    if isinstance(increment.law.closed_form, Interval):
        plus, minus = shape.coefficients
        return lambda trial, rows: on_interval(trial, plus, minus, load[rows], share[rows], k), shape_name(increment.law)
    quarters = quadrants.Quarters.of(shape.coefficients, k)
    centre = shape.centre if shape.centre.any() else None

    def at(trial: Array, rows: Rows) -> Answer:
        return on_quarters(trial, quarters, load[rows], share[rows], None if centre is None else centre[rows])

    return at, shape_name(increment.law)


def shape_name(law: Criterion) -> str:
    """How the closest point of a declared shape is found."""
    match law.closed_form:
        case Interval():
            return "closed form on an interval"
        case Disk():
            return "closed form on a disk"
    return "closed form on four quarter ellipses"


def on_quarters(
    trial: Array,
    quarters: quadrants.Quarters,
    load: Array,
    share: Array,
    centre: Array | None,
    own: Rows | None = None,
    fast: bool = False,
) -> Answer:
    """Closest points on quarter ellipses of each row's ``load`` about its ``centre``, if that is not zero for all.

    ``own`` (n,) is which of several stacked quarters each row has; ``fast`` asks compiled code, for one of them.
    """
    stress, slip, multiplier = np.empty(trial.shape), np.empty(trial.shape), np.empty(len(trial))
    about = trial if centre is None else trial - centre
    if fast and own is None:
        compiled.project(about, load, quarters, stress, slip, multiplier)
    else:
        quadrants.project(about, load, quarters, stress, slip, multiplier, own)
    if centre is not None:
        stress = np.where((multiplier > 0.0)[:, None], stress + centre, trial)
    return stress, slip, multiplier * share


def on_interval(trial: Array, plus: Array | float, minus: Array | float, load: Array, share: Array, k: Array) -> Answer:
    """Closest points of one force between - ``minus`` and ``plus`` times each row's ``load``."""
    mu = np.where(trial[:, 0] < 0.0, minus, plus)
    stress, slip, multiplier = quadrants.clamped(trial[:, 0], mu, load, float(k[0, 0]))
    return stress[:, None], slip[:, None], multiplier * share


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
