"""A criterion next to its boundary in as many digits as that takes, at points given as sums of two doubles.

Pairs of doubles for many points at once; balls, one point after the other, where the formula holds words that pairs lack, or the
numbers leave their range.  The parameters are the doubles that the methods read, taken exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from duhem.expression.double_double import Pair, PairProgram, added, paired, product
from duhem.expression.error_bounds import BoundedProgram, bounded
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Increment, at_doubles
from duhem.projection.result import Array
from duhem.projection.scaled_formula import scaled

__all__ = ["CloseLook", "as_pairs", "close_look", "pushed_back"]

_BITS = 1600  # of balls: four of 400 bits follow a power, a difference and what cancels
_STEP = -400  # of differences, as a power of two, in sizes of the stress
_FINER = 2.0**-44  # what pairs are off by as a share of what doubles are: 2^-50 an operation, with room
_TELLING = 2.0**-30  # of a value: it has digits enough
_NOTHING = 2.0**-80  # of a stress: what is closer to the boundary than this is on it
_LEAST = 2.0**-1074
_SIZES = 2.0**-100, 2.0**100  # of stresses that pairs are tried for


def as_pairs(stress: Array, size: Array) -> list[Pair]:
    """Stresses (N, d) in units of ``size`` (N,), a pair for each force."""
    return [Pair(x, np.zeros(len(x))) for x in (stress / size[:, None]).T]


def pushed_back(trial: Array, slip: Array, stiffness: Array, size: Array) -> list[Pair]:
    """trial - k slip (N, d) in units of ``size`` (N,), a pair for each force, good to some 30 digits of the trial."""
    exponent = int(np.frexp(np.max(np.diagonal(stiffness)))[1])
    k, moved = np.ldexp(stiffness, -exponent), np.ldexp(slip / size[:, None], exponent)
    found = as_pairs(trial, size)
    for i, row in enumerate(k):
        for j in np.flatnonzero(row):
            part = product(Pair(row[j], 0.0), Pair(moved[:, j], 0.0))
            found[i] = added(found[i], Pair(-part.high, -part.low))
    return found


@dataclass(frozen=True, eq=False)
class CloseLook:
    """``g`` over the forces and, for a law that has one, the pressure; of a degree as a scaled formula has one."""

    forces: int
    pressed: bool
    degree: float
    pairs: PairProgram | None
    doubles: BoundedProgram | None
    balls: Callable[..., Any]

    def level(self, points: Sequence[Pair], pressure: Array, size: Array, steep: Array | float = 1.0) -> tuple[Array, Array]:
        """g/R^degree at ``points`` times R = ``size`` (N,), and a bound of what it is off by; nan and inf where nobody knows.

        ``steep``: by how much g changes over the stress, where that may be little: then a small g is not next to the boundary.
        """
        nothing = np.broadcast_to(_NOTHING * np.fmin(steep, 1.0), len(size))
        value, bound = np.full(len(size), np.nan), np.full(len(size), np.inf)
        near = (size >= _SIZES[0]) & (size <= _SIZES[1])
        if self.pairs is not None and self.doubles is not None and near.any():
            with np.errstate(all="ignore"):
                tail = [Pair(pressure, np.zeros(len(size)))] if self.pressed else []
                real = [*(Pair(p.high * size, p.low * size) for p in points), *tail]
                told, sound = self.pairs(real, len(size))
                rounding = self.doubles([p.high for p in real], [0.0] * len(real))[1]
                unit = size**-self.degree
                value, bound = (np.where(near & sound, x * unit, y) for x, y in ((told.high, value), (_FINER * rounding, bound)))
        for i in np.flatnonzero(~((bound <= _TELLING * np.abs(value)) | (bound <= nothing))).tolist():
            value[i], bound[i] = self._enclosed([_ball(p, i) for p in points], float(pressure[i]), float(size[i]))
        return value, bound

    def holds(self, stress: Array, pressure: float) -> bool:
        """Whether one stress (d,) is shown to lie inside K."""
        import flint

        with _precision():
            found = self.balls(*map(flint.arb, stress.tolist()), *([flint.arb(pressure)] if self.pressed else []))
        return bool(found < 0)

    def slopes(self, points: Sequence[Pair], pressure: Array, size: Array) -> Array:
        """R^(1 - degree) dg/dsigma (N, d) there, by differences in many digits; nan where there are none."""
        found = np.empty((len(size), self.forces))
        for i in range(len(size)):
            found[i] = self._slope([_ball(p, i) for p in points], float(pressure[i]), float(size[i]))
        return found

    def _enclosed(self, s: list[Any], pressure: float, size: float) -> tuple[float, float]:
        with _precision():
            value = self.ball(s, pressure, size)
            middle, radius = float(value.mid()), float(value.rad())
            if middle == 0.0 and not value.is_zero():  # below doubles it may have a sign
                return (_LEAST, 0.0) if value > 0 else (-_LEAST, 0.0) if value < 0 else (0.0, max(radius, _LEAST))
            if np.isfinite(middle) and np.isfinite(radius):
                return middle, radius
            return (np.inf, 0.0) if value > 0 else (-np.inf, 0.0) if value < 0 else (np.nan, np.inf)  # beyond doubles it has a sign

    def _slope(self, s: list[Any], pressure: float, size: float) -> list[float]:
        import flint

        with _precision():
            step = flint.arb(2) ** _STEP
            here = self.ball(s, pressure, size)
            each = [(self.ball([*s[:i], x + step, *s[i + 1 :]], pressure, size) - here) / step for i, x in enumerate(s)]
            return [float(x.mid()) if x.is_finite() and x.rad() < 2.0**-40 * (1 + abs(x.mid())) else np.nan for x in each]

    def ball(self, s: Sequence[Any], pressure: float, size: float) -> Any:
        """g(R s)/R^degree at balls, in the working precision; R = ``size``."""
        import flint

        unit = flint.arb(size)
        found = self.balls(*(unit * x for x in s), *([flint.arb(pressure)] if self.pressed else []))
        return found / unit ** flint.arb(self.degree)


def _precision() -> Any:
    from duhem.expression import balls

    return balls.precision(_BITS)


def _ball(pair: Pair, i: int) -> Any:
    import flint

    with _precision():
        return flint.arb(float(pair.high[i])) + flint.arb(float(pair.low[i]))


def close_look(increment: Increment) -> CloseLook:
    """The law of an increment at its parameters."""
    return _close_look(increment.law, tuple(increment.parameters.items()))


@lru_cache(maxsize=256)
def _close_look(law: Criterion, parameters: tuple[tuple[str, float], ...]) -> CloseLook:
    from duhem.expression import balls

    g, forces = at_doubles(law, dict(parameters)), law.force_symbols()
    pressure = law.symbols()[law.pressure] if law.pressure else None
    names = forces if pressure is None else (*forces, pressure)
    degree = scaled(g, forces, pressure).degree
    pairs = paired(g, names)
    doubles = None if pairs is None else bounded(g, names)
    return CloseLook(len(forces), pressure is not None, degree, pairs, doubles, balls.compiled(g, names))
