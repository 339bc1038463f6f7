"""The shape a law declares, at the parameter values of an increment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from duhem.closed_form import Disk, Interval, Quadrants, Shape
from duhem.expression.numpy_ import compiled as program
from duhem.projection.increment import Increment
from duhem.projection.result import Array

__all__ = ["Coefficients", "centre", "coefficients", "declared", "of_pressure", "own_entries"]


@dataclass(frozen=True)
class Coefficients:
    """The declared shape at the parameter values: ``mu`` for each sense of each force.

    The shape's own gauge is ``scale`` times norm(sigma/mu).  A disk without size is a point: ``empty``.
    """

    mu: tuple[float, ...]
    scale: float = 1.0
    empty: bool = False


def declared(increment: Increment) -> Shape:
    """The shape, where the law declares one."""
    shape = increment.law.closed_form
    assert shape is not None, increment.law.name
    return shape


def coefficients(increment: Increment) -> Coefficients:
    """The coefficients of the declared shape at the parameter values."""
    shape = declared(increment)
    table = increment.law.symbols()
    values = {table[name]: value for name, value in increment.parameters.items()}

    def number(entry: object) -> float:
        return float(program(sp.sympify(entry), tuple(values))(*values.values()))

    match shape:
        case Interval():
            return Coefficients((number(shape.plus), number(shape.minus)))
        case Disk():
            mu = number(shape.coefficient)
            return Coefficients((mu,) * 4, mu) if mu > 0.0 else Coefficients((1.0,) * 4, empty=True)
        case Quadrants():
            return Coefficients(tuple(map(number, (shape.a_plus, shape.a_minus, shape.b_plus, shape.b_minus))))


def of_pressure(increment: Increment, entry: object) -> Callable[[Array], Array]:
    """An entry of the shape as a function of the pressures (n,)."""
    table = increment.law.symbols()
    values = {table[name]: value for name, value in increment.parameters.items()}
    names = tuple(values) if increment.law.pressure is None else (table[increment.law.pressure], *values)
    run = program(sp.sympify(entry), names)
    fixed = tuple(values.values())

    def at(pressure: Array) -> Array:
        given: tuple[Any, ...] = fixed if increment.law.pressure is None else (pressure, *fixed)
        return np.broadcast_to(run(*given) + 0.0, pressure.shape)  # no -0

    return at


def own_entries(shape: Shape) -> tuple[object, ...]:
    """The entries that must not depend on the pressure."""
    match shape:
        case Interval():
            return shape.plus, shape.minus
        case Disk():
            return (shape.coefficient,)
        case Quadrants():
            return shape.a_plus, shape.a_minus, shape.b_plus, shape.b_minus


def centre(shape: Shape) -> tuple[object, ...]:
    """The centre where it is not the origin, else nothing."""
    if isinstance(shape, Quadrants) and not (sp.sympify(shape.centre_a).is_zero and sp.sympify(shape.centre_b).is_zero):
        return shape.centre_a, shape.centre_b
    return ()
