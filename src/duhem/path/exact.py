"""Exact paths, by events: elementary functions where the law's shape has them, a high order method where it has not.

Each step of the path, however long, is one piece: straight with constant or changing pressure, or an arc.  A piece is known
anywhere along the step and not only at its end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import cos, sin

import numpy as np

from duhem.law.shapes import Disk, Interval
from duhem.path.closest import ShapeNumbers, shape_numbers
from duhem.path.elementary_steps import Move, on_ellipse, on_interval
from duhem.path.rows import Ledger, Stepped
from duhem.path.run import Plan, Share
from duhem.path.step_formulas import on_numbers
from duhem.projection.result import Array
from duhem.projection.scaled_formula import level_of
from duhem.projection.variational_samples import beyond_tangents

__all__ = ["Piece", "advance", "elementary", "piece", "why"]

Reached = tuple[Sequence[float], Move]  # the stress, and what was done since the start of the step; free in parts of the whole step
Piece = Callable[[Sequence[float], int, Sequence[float]], list[Reached]]  # stress at the start, row to reach, increasing parts of the step

_FEW = 16  # rows between two answers to whoever watches the run


def elementary(plan: Plan) -> str | None:
    """None where elementary functions do for the whole path, else the reason why not."""
    return _hindered(plan, shape_numbers(Share.alone(plan)))


def _hindered(plan: Plan, shape: ShapeNumbers | None) -> str | None:
    if shape is None:
        return f"{plan.increment.law.name} has no closed form"
    one = isinstance(plan.increment.law.closed_form, Interval)
    load = shape.along(len(plan.path.time))[0]
    if shape.coefficients.min() <= 0.0 or not (one or load.all()):
        return "K has no interior"
    if one:
        pressure = plan.increment.pressure
        return None if plan.path.constant_pressure or _affine(load, pressure) else "the load is not linear in the pressure"
    if not plan.increment.diagonal:
        return "the stiffness couples the forces"
    if not plan.path.constant_pressure:
        return "the pressure changes along the path"
    k = np.diagonal(plan.stiffness)
    if plan.path.arc is not None and not (isinstance(plan.increment.law.closed_form, Disk) and k[0] == k[1]):
        return "the path is an arc, and the disk or the stiffness is not isotropic"
    return None


def _affine(load: Array, pressure: Array) -> bool:
    """Whether the loads lie on one line over the pressures."""
    i, j = int(np.argmin(pressure)), int(np.argmax(pressure))
    line = load[i] + (load[j] - load[i]) * ((pressure - pressure[i]) / (pressure[j] - pressure[i]))
    return bool((np.abs(load - line) <= 1e-14 * np.abs(load).max()).all())


def why(plan: Plan) -> str:
    """What the pieces are integrated by."""
    reason = elementary(plan)
    if reason is None:
        return "Adler's equation on each arc" if plan.path.arc is not None else "elementary functions on each straight piece"
    return f"Dormand-Prince of order 8 with events: {reason}{_not_convex(plan)}"


def _not_convex(plan: Plan) -> str:
    """What is said where points of K lie beyond a tangent of it: the slip is normal all along, and no closest point stands for it."""
    increment, law = plan.increment, plan.increment.law
    loads = np.unique(increment.pressure)[[0, -1]] if law.pressure else None
    found = level_of(increment)
    seen = beyond_tangents(found, len(law.forces), loads)
    return "; K is not convex" if len(seen) else ""


def advance(plan: Plan, ledger: Ledger) -> Iterator[int]:
    """Fill the ledger row by row; yields the number of rows done, after a few of them."""
    along, formulas = piece(plan), on_numbers(len(plan.compliance))
    values, c = plan.path.values.tolist(), plan.compliance.tolist()
    stress: Sequence[float] = ledger.stress[ledger.done - 1].tolist()
    while ledger.done < len(values):
        with np.errstate(over="raise", invalid="raise", divide="raise"):  # or an overflow on the way would pass for rest
            for i in range(ledger.done, min(ledger.done + _FEW, len(values))):
                before = stress
                [(stress, moved)] = along(before, i, (1.0,))
                slip, psi = formulas.slipped(before, stress, values[i - 1], values[i], c)
                rests = moved.free >= 1.0
                slip = [0.0] * len(slip) if rests else slip
                ledger.row(Stepped(values[i], stress, slip, psi, (moved.multiplier, moved.dissipation, moved.work, 0.0), not rests, 0))
        yield ledger.done


def piece(plan: Plan) -> Piece:
    """What moves the stress over the steps of the path."""
    shape = shape_numbers(Share.alone(plan))
    return _by_equation(plan) if shape is None or _hindered(plan, shape) else _by_shape(plan, shape)


def _by_shape(plan: Plan, shape: ShapeNumbers) -> Piece:
    path = plan.path
    values, arc, mu = path.values.tolist(), path.arc, shape.coefficients[0].tolist()
    load, share, centre = (array.tolist() for array in shape.along(len(path.time)))
    k = np.diagonal(plan.stiffness).tolist()

    def interval(stress: Sequence[float], i: int, part: float) -> Reached:
        loads = (load[i - 1], load[i] - (1.0 - part) * (load[i] - load[i - 1]))
        moved = on_interval(stress[0], part * (values[i][0] - values[i - 1][0]), loads, mu, k[0])
        return moved.stress, _shared(moved, part, share[i], 0.0)

    def round_arc(stress: Sequence[float], i: int, part: float) -> Reached:
        assert arc is not None
        start = float(arc.angle[i - 1])
        limit = mu[0] * load[i]
        moved = on_disk((stress[0], stress[1]), arc.radius, start, part * (float(arc.angle[i]) - start), limit, k[0])
        return moved.stress, _shared(moved, part, mu[0] * share[i], 0.0)

    def ellipse(stress: Sequence[float], i: int, part: float) -> Reached:
        (x, y), (a, b), start, end = centre[i], stress, values[i - 1], values[i]
        u, v = part * (end[0] - start[0]), part * (end[1] - start[1])
        moved = on_ellipse((a - x, b - y), (u, v), load[i], mu, (k[0], k[1]))
        made = (moved.stress[0] + x, moved.stress[1] + y) if moved.free < 1.0 else (a + k[0] * u, b + k[1] * v)
        slip = u - (made[0] - a) / k[0], v - (made[1] - b) / k[1]
        return made, _shared(moved, part, share[i], x * slip[0] + y * slip[1], x * u + y * v)

    if isinstance(plan.increment.law.closed_form, Interval):
        return _each(interval)
    if arc is None:
        return _each(ellipse)
    from duhem.path.elementary_steps import on_disk

    return _each(round_arc)


def _each(one: Callable[[Sequence[float], int, float], Reached]) -> Piece:
    """Every part of a step anew from its start: elementary functions do not care how far it is."""
    return lambda stress, i, parts: [one(stress, i, part) for part in parts]


def _shared(moved: Move, part: float, share: float, dissipation: float, work: float = 0.0) -> Move:
    """The multiplier of the law's own g, the energies about the centre made whole, and what was free as part of the whole step."""
    return Move(moved.stress, moved.multiplier * share, moved.dissipation + dissipation, moved.work + work, part * moved.free)


def _by_equation(plan: Plan) -> Piece:
    from duhem.path.slip_equation import Motion, OpenContact, boundary, moves

    path, increment = plan.path, plan.increment
    on = boundary(increment)
    opening = None
    if increment.law.pressure is not None and not increment.pressure.all() and not on.value(np.zeros(len(plan.compliance)), 0.0) < 0.0:
        opening = OpenContact(plan, on)

    def along(stress: Sequence[float], i: int, parts: Sequence[float]) -> list[Reached]:
        du = path.values[i] - path.values[i - 1]
        if (arc := path.arc) is not None:
            start, sweep = float(arc.angle[i - 1]), float(arc.angle[i] - arc.angle[i - 1])
        rate = du.tolist()

        def chord(tau: float) -> Array:
            assert arc is not None
            half = 0.5 * tau * sweep
            way = start + half + 0.5 * np.pi
            return 2.0 * arc.radius * np.sin(half) * np.array([np.cos(way), np.sin(way)])

        def tangent(tau: float) -> list[float]:
            assert arc is not None
            angle = start + tau * sweep
            return [-arc.radius * sweep * sin(angle), arc.radius * sweep * cos(angle)]

        if not du.any() and arc is None and increment.pressure[i] == increment.pressure[i - 1]:
            return [(stress, Move(tuple(stress), 0.0, 0.0, 0.0, part)) for part in parts]
        loads = (float(increment.pressure[i - 1]), float(increment.pressure[i]))
        drive = Motion(lambda tau: tau * du, lambda _: rate) if arc is None else Motion(chord, tangent)
        if opening is not None and 0.0 in loads:
            reached = opening.moves(np.array(stress), drive, loads, parts)
        else:
            reached = moves(on, np.array(stress), drive, loads, parts)
        return [(moved.stress, moved) for moved in reached]

    return along
