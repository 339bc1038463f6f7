"""A criterion at stresses of any size, in units of their own: the sign of g, its slope, and how sure they are.

With sigma = R s, R a power of two, g(sigma, sigma_n) = R^degree h(s) (:mod:`duhem.projection.scaled_formula`): no power of a stress
leaves the range of doubles.  Values are those of h, slopes dh/ds, so that their quotient is a length in units of R.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.error_bounds import BoundedProgram, bounded
from duhem.expression.jets import Choices, Jet, JetProgram, formula, program
from duhem.expression.numpy_ import Program
from duhem.projection.increment import Increment
from duhem.projection.result import Array
from duhem.projection.row_by_row import widest
from duhem.projection.scaled_formula import ScaledFormula, grown, power_of_two, scaled

__all__ = ["Level", "level", "level_of"]


@dataclass(frozen=True, eq=False)
class Level:
    """One law with numbers for parameters; ``level`` makes one a formula, so that what is cached by it is found again."""

    scaled: ScaledFormula
    forces: int
    value: Program
    bounds: BoundedProgram
    jets: JetProgram
    unstressed: Program

    def __call__(self, *values: Array) -> Array:
        """h over arrays of the forces and the pressure, like a program of the formula, each point in units of its own."""
        stress = np.stack(np.broadcast_arrays(*values), axis=-1)[..., : self.forces].reshape(-1, self.forces)
        size = power_of_two(widest(stress))
        pressure = np.broadcast_to(values[-1], values[0].shape).reshape(-1)
        data = self.scaled.values(pressure, size)
        return self.value(*(stress / size[:, None]).T, *data.values()).reshape(values[0].shape)

    def limit(self, stress: Array, pressure: Array, size: Array) -> Array:
        """h at stresses (N, d), or its limit where it is 0/0; R = ``size`` (N,)."""
        return self.value(*(stress / size[:, None]).T, *self.scaled.values(pressure, size).values())

    def rise(self, pressure: Array, size: Array) -> Array:
        """-h at no stress, one or (N,), R = ``size`` (N,): of a convex h no piece that holds at a stress rises less on the way there."""
        return -self.unstressed(*self.scaled.values(pressure, size).values())

    def bounded(self, stress: Array, pressure: Array, size: Array) -> tuple[Array, Array]:
        """h at stresses (N, d) and a bound of its rounding; R = ``size`` (N,), powers of two."""
        return self.placed(stress, pressure, size).bounded()

    def placed(self, stress: Array, pressure: Array, size: Array) -> Placed:
        """Stresses (N, d) and the data there, in units of R = ``size`` (N,), powers of two."""
        s = np.empty(stress.shape[::-1])
        for row, force in zip(s, stress.T, strict=True):
            np.divide(force, size, out=row)
        return Placed(self, s, tuple(self.scaled.bounded(pressure, size).values()))

    def slopes(self, stress: Array, pressure: Array, size: Array, choices: Choices | None = None) -> tuple[Jet, Choices]:
        """h and its gradient dh/ds (N, d) = R^(1 - degree) dg/dsigma."""
        data = self.scaled.values(pressure, size)
        return self.jets(stress / size[:, None], list(data.values()), choices, second=False)

    def gradient(self, stress: Array, pressure: Array, size: Array) -> Array:
        """dh/ds (N, d) alone; nan where it is infinite, so that no level passes for a small share of it."""
        found = self.slopes(stress, pressure, size)[0].gradient
        assert found is not None
        return np.where(np.isfinite(found), found, np.nan)

    def hessian(self, stress: Array, pressure: Array, size: Array) -> Array:
        """d^2h/ds^2 (N, d, d)."""
        data = self.scaled.values(pressure, size)
        found = self.jets(stress / size[:, None], list(data.values()), None, second=True)[0].hessian
        assert found is not None
        return found

    def multiplier(self, given: Array, size: Array) -> Array:
        """Multipliers of g (N,) as those of h: the slip is that times dh/ds."""
        return given if self.scaled.degree == 1.0 else grown(given, size, self.scaled.degree - 1.0)

    def own(self, multiplier: Array, size: Array) -> Array:
        """The other way."""
        return multiplier if self.scaled.degree == 1.0 else grown(multiplier, size, 1.0 - self.scaled.degree)


@dataclass(frozen=True, eq=False)
class Placed:
    """Points of one level in units of their own: forces ``s`` (d, N), and each of the ``data`` (N,) with a bound of its rounding."""

    level: Level
    s: Array
    data: tuple[tuple[Array, Array | float], ...]

    def of(self, at: NDArray[np.intp]) -> Placed:
        """Some of the points."""
        data = tuple((v.take(at), b if isinstance(b, float) else b.take(at)) for v, b in self.data)
        return Placed(self.level, self.s.take(at, axis=1), data)

    def bounded(self) -> tuple[Array, Array]:
        """h (N,) and a bound of its rounding."""
        return self.level.bounds([*self.s, *(v for v, _ in self.data)], [*[0.0] * len(self.s), *(b for _, b in self.data)])

    def rise(self) -> Array:
        """As of the level."""
        return -self.level.unstressed(*(v for v, _ in self.data))

    def slopes(self) -> Array:
        """dh/ds (d, N)."""
        found = self.level.jets(self.s.T, [v for v, _ in self.data], None, second=False)[0].gradient
        assert found is not None
        return found.T


def level_of(question: Increment) -> Level:
    """The criterion of some increments."""
    return level(question.g, question.law.force_symbols(), question.pressure_symbol)


@lru_cache(maxsize=256)
def level(g: sp.Expr, forces: tuple[sp.Symbol, ...], pressure: sp.Symbol | None) -> Level:
    """``g`` over ``forces`` and ``pressure``, with numbers for parameters."""
    found = scaled(g, forces, pressure)
    names = (*forces, *found.data)
    jets = formula(found.expr, forces, tuple(found.data))
    unstressed = program(found.unstressed(forces), tuple(found.data))
    return Level(found, len(forces), program(found.expr, names), bounded(found.expr, names), jets, unstressed)
