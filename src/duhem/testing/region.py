"""K(sigma_n) of a law at parameter values, known by the sign of the law's formula alone: nothing here solves an increment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import flint
import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression import mpmath_
from duhem.expression.balls import enclose, precision
from duhem.expression.jets import Choices, Formula, formula
from duhem.expression.numpy_ import Program, compiled
from duhem.law.formula_law import Criterion
from duhem.projection.result import Array
from duhem.projection.scaled_formula import scaled

__all__ = ["Region", "homogeneous"]

_DIGITS = 60
_DOUBLE = 53  # bits
_PARTS = 256
_LEAST = -128  # powers of two; powers of smaller stresses vanish in double precision, and K is the origin alone


@dataclass(frozen=True)
class Region:
    """{g <= 0}, with a number for every parameter.  Arrays: ``stress`` (N, d) and ``pressure`` (N,) in Pa."""

    law: Criterion
    parameters: Mapping[str, float]

    def level(self, stress: Array, pressure: Array) -> Array:
        """g (N,), in double precision; nan where it is undefined."""
        return _programs(self.law)[0](*stress.T, *self._others(pressure))

    def slope(self, stress: Array, pressure: Array, choices: Choices | None = None) -> tuple[Array, Choices]:
        """grad g (N, d) of the smooth piece that holds at each stress, or of the one ``choices`` name, and the piece."""
        jet, taken = _programs(self.law)[1](stress, [np.asarray(x) for x in self._others(pressure)], choices, second=False)
        assert jet.gradient is not None
        return jet.gradient, taken

    def outside(self, stress: Array, pressure: Array) -> NDArray[np.bool_]:
        """Whether g > 0 (N,), in 60 digits: the stresses count as exact."""
        return np.array([self._exactly(s, p) for s, p in zip(stress.tolist(), pressure.tolist(), strict=True)], dtype=np.bool_)

    def rounding(self, stress: Array, pressure: Array) -> Array:
        """A bound (N,) on what evaluating g in doubles may be off by, as the formula is written; 0 where none is known.

        Ball arithmetic with the precision of doubles: F. Johansson (2017), IEEE Trans. Comput. 66, 1281-1292.
        """
        symbols = tuple(self.law.symbols().values())
        fixed = [flint.arb(self.parameters[name]) for name in self.law.parameters]
        rest = pressure[:, None] if self.law.pressure else np.zeros((len(pressure), 0))
        with precision(_DOUBLE):
            rows = [[*map(flint.arb, row), *fixed] for row in np.hstack([stress, rest]).tolist()]
            values = [enclose(self.law.g, dict(zip(symbols, row, strict=True))) for row in rows]
        return np.array([float(value.rad()) if value.is_finite() else 0.0 for value in values])

    def reach(self, way: Array, pressure: Array) -> Array:
        """The largest r (N,) with r ``way`` in K, to the last digit from within; inf where K does not end, 0 without the origin.

        K is taken to be star-shaped about the origin, as a convex one is that contains it.
        """
        exponents = np.arange(_LEAST, 513, 8)
        first, endless = self._first_outside(way, pressure, np.ldexp(np.ones((len(way), 1)), exponents))
        empty = first == 0
        start = exponents[np.maximum(first, 1) - 1]
        low = np.ldexp(1.0, start)
        high = np.ldexp(1.0, start + 8)
        exponents = start[:, None] + np.arange(1, 9)
        low, high = self._narrowed(way, pressure, low, np.ldexp(1.0, exponents))
        for _ in range(7):  # 8 bits each
            inner = low[:, None] + (high - low)[:, None] * (np.arange(1, _PARTS + 1) / _PARTS)
            low, high = self._narrowed(way, pressure, low, inner)
        return np.where(empty, 0.0, np.where(endless, np.inf, low))

    def _narrowed(self, way: Array, pressure: Array, low: Array, ends: Array) -> tuple[Array, Array]:
        first, none = self._first_outside(way, pressure, ends)
        first = np.where(none, ends.shape[1] - 1, first)
        rows = np.arange(len(way))
        return np.where(first == 0, low, ends[rows, np.maximum(first, 1) - 1]), ends[rows, first]

    def _first_outside(self, way: Array, pressure: Array, radii: Array) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        points = (radii[:, :, None] * way[:, None, :]).reshape(-1, way.shape[1])
        inside = (self.level(points, np.repeat(pressure, radii.shape[1])) <= 0.0).reshape(radii.shape)
        return np.argmin(inside, axis=1), np.asarray(inside.all(axis=1))

    def _others(self, pressure: Array) -> list[Any]:
        return [*([pressure] if self.law.pressure else []), *(self.parameters[name] for name in self.law.parameters)]

    def _exactly(self, stress: list[float], pressure: float) -> bool:
        table = self.law.symbols()
        values: dict[sp.Symbol, Any] = {table[name]: value for name, value in self.parameters.items()}
        values |= dict(zip(self.law.force_symbols(), stress, strict=True))
        if self.law.pressure:
            values[table[self.law.pressure]] = pressure
        return not mpmath_.evaluate(self.law.g, values, dps=_DIGITS) <= 0


@lru_cache(maxsize=64)
def _programs(law: Criterion) -> tuple[Program, Formula]:
    names = tuple(law.symbols().values())
    forces = law.force_symbols()
    return compiled(law.g, names), formula(law.g, forces, names[len(forces) :])


@lru_cache(maxsize=64)
def homogeneous(law: Criterion) -> bool:
    """Whether K(c sigma_n) = c K(sigma_n) for all c > 0: no stress but the pressure sets its size."""
    if law.pressure is None:
        return False
    pressure = law.symbols()[law.pressure]
    parts = scaled(law.g, law.force_symbols(), pressure)
    c = sp.Dummy("c", positive=True)
    if any(d.weight.free_symbols for d in parts.data.values()):
        return False
    return all(sp.simplify(d.expr.xreplace({pressure: c * pressure}) - c**d.weight * d.expr) == 0 for d in parts.data.values())
