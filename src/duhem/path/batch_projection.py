"""The closest points of many points at a knot of their paths, each with the numbers of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from duhem.law.shapes import Disk, Interval, Quadrants
from duhem.path.batch import Share
from duhem.path.prepared_projection import LOST, named, on_interval, on_quarters, shape_name
from duhem.projection import closed_form, quadrants
from duhem.projection.coefficients import centre, in_columns
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Status

__all__ = ["BatchClosest", "ShapeNumbers", "closest_points", "shape_numbers"]

Which = NDArray[np.intp]
Found = tuple[Array, Array, Array, NDArray[np.int8]]  # stress (n, d), slip (n, d), multiplier (n,), status where it is lost, else 0
BatchClosest = Callable[[Array, int, Which], Found]


@dataclass(frozen=True, eq=False)
class ShapeNumbers:
    """The declared shape of each point's K along its path.

    ``coefficients`` (members, 2 or 4); ``load``, ``share`` (n, m) and ``centre`` (n, m, d), with one row or one column where
    all are alike, as in :class:`duhem.path.prepared_projection.Numbers`.
    """

    coefficients: Array
    load: Array
    share: Array
    centre: Array


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

    def along(entry: object) -> Array:
        return in_columns(law, entry, at_points, load)

    slope, middles = along(shape.slope), centre(shape)
    return ShapeNumbers(
        coefficients=coefficients,
        load=along(shape.load) * ~empty[own, None],
        share=1.0 / (np.where(slope > 0.0, slope, 1.0) * scale[own, None]),
        centre=np.stack([along(entry) for entry in middles], axis=2) if middles else np.zeros((1, 1, len(law.forces))),
    )


def closest_points(block: Share, method: str, compiled: bool = False) -> tuple[BatchClosest, str]:
    """(trial stresses, knot, numbers of the points in the block) -> their closest points, and the name of the method."""
    shape = shape_numbers(block) if method in ("auto", "closed-form") else None
    if shape is None:
        return _by_projection(block, method, compiled)
    law = block.members[0].law
    at = _on_intervals(block, shape) if isinstance(law.closed_form, Interval) else _on_quarters(block, shape, compiled)
    return at, shape_name(law)


def _at(array: Array, knot: int, which: Which) -> Array:
    column = array[:, knot if array.shape[1] > 1 else 0]
    return column[which] if len(column) > 1 else np.broadcast_to(column, (len(which), *column.shape[1:]))


def _on_quarters(block: Share, shape: ShapeNumbers, fast: bool) -> BatchClosest:
    quarters = quadrants.stacked([quadrants.Quarters.of(mu, block.members[0].stiffness) for mu in shape.coefficients.tolist()])
    moved, several = bool(shape.centre.any()), len(block.members) > 1

    def at(trial: Array, knot: int, which: Which) -> Found:
        load, share = _at(shape.load, knot, which), _at(shape.share, knot, which)
        centre, own = _at(shape.centre, knot, which) if moved else None, block.own[which] if several else None
        return _judged(*on_quarters(trial, quarters, load, share, centre, own, fast))

    return at


def _on_intervals(block: Share, shape: ShapeNumbers) -> BatchClosest:
    plus, minus = shape.coefficients.T
    k = block.members[0].stiffness

    def at(trial: Array, knot: int, which: Which) -> Found:
        own, load, share = block.own[which], _at(shape.load, knot, which), _at(shape.share, knot, which)
        return _judged(*on_interval(trial, plus[own], minus[own], load, share, k))

    return at


def _judged(stress: Array, slip: Array, multiplier: Array) -> Found:
    return stress, slip, multiplier, np.where(np.isfinite(multiplier), 0, Status.FAILED).astype(np.int8)


def _pressures(block: Share) -> Array:
    return np.zeros(1) if block.paths.pressure is None else block.paths.pressure.ravel()


def _by_projection(block: Share, method: str, fast: bool) -> tuple[BatchClosest, str]:
    prepared = [Projector.of(member.law, member.stiffness, member.parameters, method) for member in block.members]
    options = {"compiled": True} if fast and prepared[0].method.name in ("closed-form", "newton") else {}

    def at(trial: Array, knot: int, which: Which) -> Found:
        stress, slip, multiplier = np.empty_like(trial), np.empty_like(trial), np.empty(len(trial))
        lost, pressure = np.zeros(len(trial), dtype=np.int8), block.pressure(knot)[which]
        for i, projector in enumerate(prepared):
            mine = np.flatnonzero(block.own[which] == i)
            if not mine.size:
                continue
            posed, known = np.ascontiguousarray(trial[mine]), block.members[i].convexity
            question = replace(projector.setting, trial=posed, pressure=pressure[mine], convexity=known)
            found = projector.at(question, **options)
            stress[mine], slip[mine], multiplier[mine] = found.stress, found.slip, found.multiplier
            lost[mine] = np.where(np.isin(found.status, LOST), found.status, 0)
        return stress, slip, multiplier, lost

    return at, named(prepared[0], replace(block.members[0], pressure=_pressures(block)))
