"""What is measured: one law with numbers in place, at one stiffness."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from duhem.benchmark.reference import Closest
from duhem.errors import InputError
from duhem.expression.numpy_ import compiled
from duhem.expression.rays import Rays
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Increment
from duhem.projection.result import Array
from duhem.projection.validation import increment

__all__ = ["Specimen"]

_RADII = np.ldexp(1.0, np.arange(-1070, 1021))


@dataclass(frozen=True)
class Specimen:
    """A law with numbers in place and the stiffness (d, d) in Pa/m it is measured at.

    ``law`` has its parameters at the doubles that the methods read, taken exactly; ``declared`` as they were given.
    """

    declared: Criterion
    law: Criterion
    stiffness: Array

    @classmethod
    def of(cls, law: Criterion, stiffness: Sequence[float] | None = None) -> Specimen:
        """``law`` with every parameter at a double, taken exactly, as the methods will read it; k = diag(1, 2, ...) if left out.

        Raises InputError for a parameter without value and for a law with a flow of its own.
        """
        if missing := [name for name, domain in law.parameters.items() if domain.value is None]:
            remedy = f"give {' '.join(f'--set {name}=VALUE' for name in missing)}"
            raise InputError(f"no value is given for {', '.join(missing)}", where=law.name, remedy=remedy)
        d = len(law.forces)
        k = np.diag(np.arange(1.0, d + 1) if stiffness is None else np.asarray(stiffness, dtype=np.float64))
        trial = np.zeros((1, d))
        asked = increment(law, trial, None if law.pressure is None else -1.0, k, None)
        exact = {name: Domain.fixed(Fraction(value)) for name, value in asked.parameters.items()}
        return cls(law, replace(law, parameters=exact), k)  # same signs, so the symbols stay

    @property
    def pressure(self) -> float | None:
        """The pressure sigma_n = -1 of the plain cases, in the unit of the parameters; None for a law without."""
        return None if self.law.pressure is None else -1.0

    def question(self, trial: Array, pressure: Array | float | None, stiffness: Array | None = None) -> Increment:
        """The checked increments."""
        return increment(self.law, trial, pressure, self.stiffness if stiffness is None else stiffness, None)

    def reference(self, stiffness: Array | None = None, digits: int = 50) -> Closest:
        """The closest point in many digits."""
        question = self.question(np.zeros((1, len(self.law.forces))), self.pressure, stiffness)
        symbol = None if self.law.pressure is None else self.law.symbols()[self.law.pressure]
        return Closest(question.g, self.law.force_symbols(), symbol, question.stiffness.tolist(), digits)

    def radius(self, direction: Array, pressure: float | None) -> float:
        """How far K reaches along ``direction`` from the origin, in doubles; 0 where the origin is outside, inf where it never ends."""
        question = self.question(np.zeros((1, len(self.law.forces))), self.pressure)
        names = [*self.law.force_symbols(), *([] if pressure is None else [self.law.symbols()[self.law.pressure or ""]])]
        g = compiled(question.g, names)

        def level(points: Array) -> Array:
            return g(*np.moveaxis(points, -1, 0), *([] if pressure is None else [pressure]))

        (last,), (first,) = Rays(level, np.zeros(len(direction)), direction[None]).left(_RADII)
        return 0.0 if last < _RADII[0] else float("inf") if last == first else float(last)

    def width(self) -> float:
        """How far K reaches along the axes, either way: the median of where it ends, 1 where it does nowhere."""
        axes = np.eye(len(self.law.forces))
        reach = [self.radius(way, self.pressure) for axis in axes for way in (axis, -axis)]
        return float(np.median([r for r in reach if 0.0 < r < 1e300] or [1.0]))

    def describe(self) -> str:
        """The law's parameters and the stiffness in words."""
        values = ", ".join(f"{name} = {float(domain.value):g}" for name, domain in self.law.parameters.items() if domain.value is not None)
        k = ", ".join(f"{x:g}" for x in np.diagonal(self.stiffness))
        return f"{values + '; ' if values else ''}stiffness {k}"
