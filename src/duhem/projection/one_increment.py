"""One increment on plain numbers: for who asks for one after the other, and for whom arrays take longer to call than to compute.

The closest point and the judge's loop are those of many points, run by Python or compiled.  What they leave, and what is not plainly
a question of one point of finite numbers, goes the way of arrays, which says what is wrong with it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from duhem.projection.compiled_judge import Look, compiled_look, plain_look
from duhem.projection.increment import Increment, Metric
from duhem.projection.judge_kernel import UNJUDGED
from duhem.projection.method import ClosestPoint, Method
from duhem.projection.result import Projection, Residuals, Status
from duhem.projection.scaled_formula import level_of
from duhem.projection.variational_samples import Variational

__all__ = ["OneIncrement", "PointAnswer"]

_STATUSES = tuple(Status)  # sooner than a call of the class
_WHOLE = 2**53  # of a larger integer a double may be another number


class PointAnswer(NamedTuple):
    """Stress and slip (d,), multiplier, dissipation, status and the five residuals of one point."""

    stress: Sequence[float]
    slip: Sequence[float]
    multiplier: float
    dissipation: float
    status: Status
    residuals: Sequence[float]


@dataclass(frozen=True, eq=False)
class OneIncrement:
    """The law, stiffness and parameters of ``setting`` and the ``method``, of which K is known to be convex; ``compiled`` by numba."""

    setting: Increment
    method: Method[Any]
    compiled: bool = False

    def __getstate__(self) -> dict[str, Any]:
        """What is kept for the next call is made anew where it is unpickled."""
        return {"setting": self.setting, "method": self.method, "compiled": self.compiled}

    def made(self) -> bool:
        """Whether there is a way on plain numbers: it is made now, and compiled, and not by the first answer."""
        return self._closest is not None and self._look(-1.0 if self.setting.law.pressure else 0.0) is not None

    def numbers(self, trial: Any, pressure: Any) -> tuple[list[float], float] | None:
        """A trial stress (d,) and a pressure below 0, or 0.0 for a law without one; None where these are anything else."""
        law, stress, load = self.setting.law, _plain(trial), 0.0
        if stress is None or len(stress) != len(law.forces) or (law.pressure is None) != (pressure is None):
            return None
        if law.pressure is not None:
            given = _plain((pressure,))
            if given is None or not given[0] < 0.0:
                return None
            load = given[0]
        return stress, load

    def answer(self, trial: Sequence[float], pressure: float) -> PointAnswer | None:
        """The judged answer to such numbers; None where arrays are to be asked."""
        if self._closest is None or (look := self._look(pressure)) is None:
            return None
        point: Any = trial
        load: Any = pressure
        if self.compiled:
            point, load = np.array([trial]), np.array([pressure])
            point.setflags(write=False)
            load.setflags(write=False)
        if (found := self._closest(point, load)) is None:
            return None
        stress, slip, multiplier = found
        dissipation, status, residuals = look(point, load, stress, slip, multiplier)
        if status == UNJUDGED:
            return None
        if self.compiled:
            stress, slip, multiplier = stress[0], slip[0], multiplier.item()
        return PointAnswer(stress, slip, multiplier, dissipation, _STATUSES[status], residuals)

    def projection(self, found: PointAnswer, why: str) -> Projection:
        """The answer as that of one point among many; ``why`` the method was taken."""
        return Projection(
            stress=np.array([found.stress]),
            slip=np.array([found.slip]),
            multiplier=np.array([found.multiplier]),
            dissipation=np.array([found.dissipation]),
            status=np.array([found.status], dtype=np.int8),
            method=self.method.name,
            why=why,
            residuals=Residuals(*(np.array([off]) for off in found.residuals)),
            forces=self.setting.law.forces,
            compiled=self.compiled,
        )

    @cached_property
    def _closest(self) -> ClosestPoint | None:
        """None for a law with ranges, in which an answer may lie or not, and for a method that solves in a way of its own."""
        plain = self.method.plain if self.method.has_its_own_solve and not self.setting.law.domain else None
        return plain and plain(self.setting, self.compiled)

    @cached_property
    def _looks(self) -> dict[int, Look | None]:
        return {}

    def _look(self, pressure: float) -> Look | None:
        """The judge's loop with the points of K that are known at the power of two within the pressure."""
        exponent = math.frexp(pressure)[1]
        if exponent not in self._looks:
            law, own = self.setting.law, self.setting
            g = level_of(own)
            asked = Increment(law, own.g, own.trial, np.array([pressure]), own.stiffness, own.diagonal, own.parameters)
            known = Variational.of(asked, g, Metric.of(own.stiffness), convex=True)
            made = compiled_look if self.compiled else plain_look
            self._looks[exponent] = made(g, law.force_symbols(), own.stiffness, known)
        return self._looks[exponent]


def _plain(numbers: Any) -> list[float] | None:
    """Finite doubles, from a flat array of doubles or a list of floats and small integers; None for all else."""
    if type(numbers) is np.ndarray:
        if numbers.dtype != np.float64 or numbers.ndim != 1:
            return None
        found = numbers.tolist()
    elif type(numbers) is list or type(numbers) is tuple:
        found = []
        for x in numbers:
            kind = type(x)
            if kind is not float and kind is not np.float64 and not (kind is int and -_WHOLE <= x <= _WHOLE):
                return None
            found.append(float(x))
    else:
        return None
    return found if all(map(math.isfinite, found)) else None
