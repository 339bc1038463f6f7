"""The shape a law declares, at the parameter values of an increment."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy as sp

from duhem.expression.numpy_ import Program, compiled
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Disk, Interval, Quadrants, Shape
from duhem.projection.increment import Increment
from duhem.projection.result import Array

__all__ = ["Coefficients", "centre", "coefficients", "declared", "in_columns", "of_one_pressure", "of_pressure", "own_entries", "uniform"]


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
    return _coefficients(increment.law, declared(increment), _values(increment))


@lru_cache(maxsize=256)
def _coefficients(law: Criterion, shape: Shape, values: tuple[float, ...]) -> Coefficients:
    def number(entry: object) -> float:
        value = _at(law, entry, values)
        assert isinstance(value, float), entry  # refused by applies
        return value

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
    values = _values(increment)
    value = _at(increment.law, entry, values)
    if isinstance(value, float):
        return lambda pressure: np.broadcast_to(value, pressure.shape)

    def at(pressure: Array) -> Array:
        found = value(pressure, *values)
        found += 0.0  # no -0
        return found

    return at


def of_one_pressure(increment: Increment, entry: object) -> Callable[[float], float]:
    """The same at one pressure, a plain number."""
    values = _values(increment)
    value = _at(increment.law, entry, values)
    if isinstance(value, float):
        return lambda _: value
    found = value.recording.value
    numbers = [np.float64(x) for x in values]
    return lambda pressure: float(found([np.float64(pressure), *numbers])) + 0.0


def uniform(increment: Increment, entry: object) -> float | None:
    """The value of an entry that is the same at every pressure, else None."""
    value = _at(increment.law, entry, _values(increment))
    return value if isinstance(value, float) else None


def _values(increment: Increment) -> tuple[float, ...]:
    return tuple(increment.parameters[name] for name in increment.law.parameters)


@lru_cache(maxsize=4096)
def _at(law: Criterion, entry: object, values: tuple[float, ...]) -> float | Program:
    """The value of an entry at these parameters; where the pressure enters, a program over it and them."""
    symbols, formula = law.symbols(), sp.sympify(entry)
    own = [symbols[name] for name in law.parameters]
    if law.pressure is not None and symbols[law.pressure] in formula.free_symbols:
        return compiled(formula, [symbols[law.pressure], *own])
    return float(compiled(formula, own)(*values)) + 0.0


def in_columns(law: Criterion, entry: object, parameters: Sequence[Array], pressure: Array) -> Array:
    """An entry of the shape where points have parameters of their own, in the law's order: an array of the common shape."""
    found = _program(law, entry)(pressure, *parameters)
    found += 0.0  # no -0
    return found


@lru_cache(maxsize=256)
def _program(law: Criterion, entry: object) -> Program:
    symbols = law.symbols()
    load = sp.Dummy() if law.pressure is None else symbols[law.pressure]
    return compiled(sp.sympify(entry), [load, *(symbols[name] for name in law.parameters)])


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
