"""The closest points of K to rows of trial stresses, each the trial of one point at one knot, with the numbers of its own.

Rows are many points at a knot of their paths, or one point at knots in turn.  What K needs of the pressure is known before the first step.
They are found by arrays, or of one row of one path on plain numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from operator import add, sub
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import DuhemError
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Disk, Interval, Quadrants
from duhem.path.loading import Knot, Which, in_rows
from duhem.path.run import Share
from duhem.projection import closed_form, compiled, quadrants
from duhem.projection.closed_form import centre, in_columns
from duhem.projection.increment import Increment
from duhem.projection.method import Compiling
from duhem.projection.one_increment import OneIncrement
from duhem.projection.projector import Projector
from duhem.projection.result import NOT_CLOSEST, NOT_SHOWN, Array, Projection, Status
from duhem.projection.row_by_row import widest
from duhem.projection.scaled_formula import level_of, power_of_two

__all__ = [
    "LOST", "Closest", "ClosestPoint", "ClosestPoints", "ShapeNumbers", "closest_by", "closest_point", "outside", "shape_by", "shape_name",
    "shape_numbers", "vouched",
]  # fmt: skip

LOST = (Status.INACCURATE, Status.FAILED)
_TOLERANCE = 1e-12  # how far outside K a given stress may lie, relative to its size: what rounding explains


class ClosestPoints(NamedTuple):
    """The closest points of n rows: ``stress``, ``slip`` (n, d), ``multiplier`` (n,); ``lost`` is the status of what is not found, else 0.

    ``judged`` is the projection that found them, of the last set of parameters where there are several; None for declared shapes.
    """

    stress: Array
    slip: Array
    multiplier: Array
    lost: NDArray[np.int8]
    judged: Projection | None = None

    def slips(self) -> NDArray[np.bool_]:
        """The rows that slip (n,)."""
        return (self.slip != 0.0).any(axis=1) | (self.multiplier > 0.0)


Closest = Callable[[Array, Knot, Which], ClosestPoints]  # trial stresses (n, d), the knots of their rows, and their points in the block


@dataclass(frozen=True, eq=False)
class ShapeNumbers:
    """The declared shape of each point's K along its path: semi-axes coefficient x load about a centre.

    ``coefficients`` (members, 2 or 4); ``load``, ``share`` (n, m) and ``centre`` (n, m, d), with one row or one column where
    all are alike.  ``share`` turns the multiplier of the gauge built from the coefficients into that of the law's g.
    """

    coefficients: Array
    load: Array
    share: Array
    centre: Array

    def along(self, m: int) -> tuple[Array, Array, Array]:
        """Load (m,), share (m,) and centre (m, d) of one point at the m knots of its path."""
        every, point = np.arange(m), np.zeros(m, dtype=np.intp)
        return in_rows(self.load, every, point), in_rows(self.share, every, point), in_rows(self.centre, every, point)


def shape_numbers(block: Share) -> ShapeNumbers | None:
    """The numbers of a block; None where the law declares no shape that fits."""
    first, law = block.members[0], block.members[0].law
    if law.closed_form is None or closed_form.applies(first) is not None:
        return None
    load = np.zeros((1, 1)) if block.paths.pressure is None else block.paths.pressure
    own = block.own if len(block.members) > 1 else np.zeros(1, dtype=np.intp)
    load = np.broadcast_to(load, (max(len(own), len(load)), load.shape[1]))
    parameters = [np.array([member.parameters[name] for member in block.members]) for name in law.parameters]
    at_points = [values[own, None] for values in parameters]
    none = np.zeros(len(block.members))

    def alone(*entries: object) -> Array:
        return np.stack([in_columns(law, entry, parameters, none) for entry in entries], axis=1)

    def along(entry: object) -> Array:
        return in_columns(law, entry, at_points, load)

    scale, empty = np.ones(len(block.members)), np.zeros(len(block.members), dtype=np.bool_)
    match shape := law.closed_form:
        case Interval():
            coefficients = alone(shape.plus, shape.minus)
        case Disk():
            found = alone(shape.coefficient)
            empty = ~(found[:, 0] > 0.0)  # K is a point
            coefficients = np.repeat(np.where(empty[:, None], 1.0, found), 4, axis=1)
            scale = coefficients[:, 0]
        case Quadrants():
            coefficients = alone(shape.a_plus, shape.a_minus, shape.b_plus, shape.b_minus)
    if not first.diagonal and (coefficients == 0.0).any():
        return None
    slope, middles = along(shape.slope), centre(shape)
    return ShapeNumbers(
        coefficients=coefficients,
        load=along(shape.load) * ~empty[own, None],
        share=1.0 / (np.where(slope > 0.0, slope, 1.0) * scale[own, None]),
        centre=np.stack([along(entry) for entry in middles], axis=2) if middles else np.zeros((1, 1, len(law.forces))),
    )


def shape_name(law: Criterion) -> str:
    """How the closest point of a declared shape is found."""
    match law.closed_form:
        case Interval():
            return "closed form on an interval"
        case Disk():
            return "closed form on a disk"
    return "closed form on four quarter ellipses"


def shape_by(block: Share, method: str) -> ShapeNumbers | None:
    """The numbers of the shape by which a method finds the closest points of a block; None where it asks a projection."""
    return shape_numbers(block) if method in ("auto", "closed-form") else None


def closest_by(block: Share, method: str, shape: ShapeNumbers | None, compiled: bool = False) -> tuple[Closest, str]:
    """The closest points of a block's rows by its shape (:func:`shape_by`), and the name of the method."""
    if shape is None:
        return _by_projection(block, method, compiled)
    law = block.members[0].law
    at = _on_intervals(block, shape) if isinstance(law.closed_form, Interval) else _on_quarters(block, shape, compiled)
    return at, shape_name(law)


def vouched(at: Closest) -> Closest:
    """The same of one path: a row that is not found ends the run, with the error that says why."""

    def closest(trial: Array, knot: Knot, which: Which) -> ClosestPoints:
        found = at(trial, knot, which)
        if found.judged is None or not found.lost.any():
            return found
        in_turn = np.argsort(knot)
        slips = np.flatnonzero(found.slips()[in_turn])
        read = in_turn[: slips[0] + 1] if slips.size else in_turn  # a run takes a block no further than its first slip
        if (lost := read[found.lost[read] > 0]).size:
            row, status = int(np.broadcast_to(knot, len(which))[lost[0]]), Status(int(found.lost[lost[0]])).name.lower()
            reason, remedy = found.judged.remark(int(lost[0])), "choose another projection, or smaller steps"
            if reason == NOT_CLOSEST:
                remedy = "verify the convexity of the law, and choose parameters for which K is convex"
            what = f"the closest point under method {found.judged.method} is {status}: {reason}"
            raise DuhemError(what, where=f"step {row}", remedy=remedy)
        return found

    return closest


def outside(block: Share, method: str, stress: Array, knot: Knot, which: Which) -> NDArray[np.bool_]:
    """Which of the stresses (n, d) of a block's rows lie outside K by more than rounding."""
    if len(block.members) == 1 and block.members[0].g is not sp.nan:  # the sign of g tells sooner than the closest point
        value, hidden = level_of(block.members[0]).bounded(stress, block.paths.pressure_at(knot, which), power_of_two(widest(stress)))
        if (value < -hidden).all():
            return np.zeros(len(stress), dtype=np.bool_)
    found = closest_by(block, method, shape_by(block, method))[0](stress, knot, which).stress
    size = np.maximum(np.abs(stress).max(axis=1), np.abs(found).max(axis=1))
    return np.asarray(~(np.abs(found - stress).max(axis=1) <= _TOLERANCE * size))


def _on_quarters(block: Share, shape: ShapeNumbers, fast: bool) -> Closest:
    quarters = quadrants.stacked([quadrants.Quarters.of(mu, block.members[0].stiffness) for mu in shape.coefficients.tolist()])
    moved, several = bool(shape.centre.any()), len(block.members) > 1

    def at(trial: Array, knot: Knot, which: Which) -> ClosestPoints:
        stress, slip, multiplier = np.empty(trial.shape), np.empty(trial.shape), np.empty(len(trial))
        load, middle = in_rows(shape.load, knot, which), in_rows(shape.centre, knot, which) if moved else 0.0
        about = trial - middle if moved else trial
        if fast and not several:
            compiled.project(about, load, quarters, stress, slip, multiplier)
        else:
            quadrants.project(about, load, quarters, stress, slip, multiplier, block.own[which] if several else None)
        if moved:
            stress = np.where((multiplier > 0.0)[:, None], stress + middle, trial)
        return _finite(stress, slip, multiplier * in_rows(shape.share, knot, which))

    return at


def _on_intervals(block: Share, shape: ShapeNumbers) -> Closest:
    plus, minus = shape.coefficients.T
    k = float(block.members[0].stiffness[0, 0])

    def at(trial: Array, knot: Knot, which: Which) -> ClosestPoints:
        own = block.own[which]
        mu = np.where(trial[:, 0] < 0.0, minus[own], plus[own])
        stress, slip, multiplier = quadrants.clamped(trial[:, 0], mu, in_rows(shape.load, knot, which), k)
        return _finite(stress[:, None], slip[:, None], multiplier * in_rows(shape.share, knot, which))

    return at


def _finite(stress: Array, slip: Array, multiplier: Array) -> ClosestPoints:
    return ClosestPoints(stress, slip, multiplier, (~np.isfinite(multiplier)).view(np.int8) * np.int8(Status.FAILED))


def _by_projection(block: Share, method: str, fast: bool) -> tuple[Closest, str]:
    """Through :class:`duhem.projection.projector.Projector`, which judges each answer."""
    prepared = [Projector.of(member.law, member.stiffness, member.parameters, method) for member in block.members]
    options = {"compiled": fast} if issubclass(prepared[0].method.options, Compiling) else {}

    def at(trial: Array, knot: Knot, which: Which) -> ClosestPoints:
        found = ClosestPoints(np.empty_like(trial), np.empty_like(trial), np.empty(len(trial)), np.zeros(len(trial), dtype=np.int8))
        pressure, own = block.paths.pressure_at(knot, which), block.own[which]
        for i, projector in enumerate(prepared):
            if not (mine := np.flatnonzero(own == i)).size:
                continue
            posed, known = np.ascontiguousarray(trial[mine]), block.members[i].convexity
            judged = projector.at(replace(projector.setting, trial=posed, pressure=pressure[mine], convexity=known), **options)
            found.stress[mine], found.slip[mine], found.multiplier[mine] = judged.stress, judged.slip, judged.multiplier
            found.lost[mine] = np.where(np.isin(judged.status, LOST), judged.status, 0)
            found = found._replace(judged=judged)
        return found

    load = block.paths.pressure
    return at, _named(prepared[0], replace(block.members[0], pressure=np.zeros(1) if load is None else load.ravel()))


def _named(projector: Projector, question: Increment) -> str:
    """The method, and what it leaves open under the pressures of a question."""
    known = projector.method.convex or question.convexity is None or question.shown_convex().all()
    return f"projection by {projector.method.name}{'' if known else f'; {NOT_SHOWN}'}"


# -- one row of one path on plain numbers: arrays take longer to call than to compute ---------------------------------
# What has no answer on plain numbers is None, and arrays are asked.

Answer = tuple[Sequence[float], Sequence[float], float]  # stress, slip and multiplier
ClosestPoint = Callable[[Sequence[float], Any], Answer | None]  # of a trial stress at a knot


def closest_point(block: Share, method: str, shape: ShapeNumbers | None, by_arrays: Closest) -> ClosestPoint | None:
    """The closest point of the one point of a block at one of its knots; None where plain numbers do not do.

    What has no answer on them is asked of arrays, and has none where it is lost.
    """
    if shape is None:
        plain = _judged(block, method)
    else:
        plain = (_on_interval if isinstance(block.members[0].law.closed_form, Interval) else _point_on_quarters)(block, shape)
    if plain is None:
        return None
    which = np.zeros(1, dtype=np.intp)

    def at(trial: Sequence[float], knot: int) -> Answer | None:
        if (answer := plain(trial, knot)) is not None:
            return answer
        found = by_arrays(np.array([trial]), knot, which)
        return None if found.lost.any() else (found.stress[0].tolist(), found.slip[0].tolist(), float(found.multiplier[0]))

    return at


def _point_on_quarters(block: Share, shape: ShapeNumbers) -> ClosestPoint | None:
    quarters = quadrants.Quarters.of(shape.coefficients[0].tolist(), block.members[0].stiffness)
    if quarters.flat.any():
        return None
    load, share, centre = (_along(array) for array in (shape.load, shape.share, shape.centre))
    moved = bool(shape.centre.any())

    def at(trial: Sequence[float], knot: int) -> Answer | None:
        middle = centre(knot)
        found = quadrants.plain_closest(quarters, list(map(sub, trial, middle)) if moved else trial, load(knot))
        if found is None or not isfinite(found[2]):
            return None
        stress, slip, multiplier = found
        if moved:
            stress = list(map(add, stress, middle)) if multiplier > 0.0 else list(trial)
        return stress, slip, multiplier * share(knot)

    return at


def _on_interval(block: Share, shape: ShapeNumbers) -> ClosestPoint:
    load, share = _along(shape.load), _along(shape.share)
    (plus, minus), k = shape.coefficients[0].tolist(), float(block.members[0].stiffness[0, 0])

    def at(trial: Sequence[float], knot: int) -> Answer | None:
        found = quadrants.plain_clamped(trial[0], minus if trial[0] < 0.0 else plus, load(knot), k)
        if found is None or not isfinite(found[2]):
            return None
        return found[:1], found[1:2], found[2] * share(knot)

    return at


def _along(array: Array) -> Callable[[int], Any]:
    """Its numbers at a knot, (1, m) or (1, m, d); of one column where all are alike."""
    if array.shape[1] > 1:
        return lambda knot: array[0, knot].tolist()
    always = array[0, 0].tolist()
    return lambda _: always


def _judged(block: Share, method: str) -> ClosestPoint | None:
    """By a method for any law, each answer judged; None without plain numbers, and where K is not shown to be convex."""
    member, pressure = block.members[0], block.paths.pressure
    prepared, known = Projector.of(member.law, member.stiffness, member.parameters, method), member.convexity
    one = OneIncrement(prepared.setting, prepared.method)
    if not (prepared.method.convex or (known is not None and known.loaded)) or not one.made():
        return None
    load = None if pressure is None else _along(pressure)

    def at(trial: Sequence[float], knot: int) -> Answer | None:
        if (numbers := one.numbers(trial, None if load is None else load(knot))) is None or (found := one.answer(*numbers)) is None:
            return None
        return found.stress, found.slip, found.multiplier

    return at
