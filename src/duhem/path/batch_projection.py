"""The closest points of many points at a knot of their paths, each with the numbers of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from duhem.law.shapes import Interval
from duhem.path.batch import Share
from duhem.path.prepared_projection import LOST, named, numbers, on_interval, on_quarters, shape_name
from duhem.projection import quadrants
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
    pressure = block.paths.pressure
    load = np.zeros((1, 1)) if pressure is None else pressure
    if len(block.members) > 1:
        load = np.broadcast_to(load, (len(block), load.shape[1]))
    parts, coefficients = [], []
    for i, member in enumerate(block.members):
        own = load[block.own == i] if len(block.members) > 1 else load
        found = numbers(replace(member, pressure=np.ascontiguousarray(own).ravel()))
        if found is None:
            return None
        coefficients.append(found.coefficients)
        parts.append((found.load.reshape(own.shape), found.share.reshape(own.shape), found.centre.reshape(*own.shape, -1)))
    if len(parts) == 1:
        return ShapeNumbers(np.array(coefficients), *parts[0])
    whole = tuple(np.empty((len(block), *part.shape[1:])) for part in parts[0])
    for i, part in enumerate(parts):
        for array, own in zip(whole, part, strict=True):
            array[block.own == i] = own
    return ShapeNumbers(np.array(coefficients), *whole)


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
