"""What a routine returned, as arrays of the shapes that it must have."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks.raised import NoReply
from duhem.testing.routines.material import shaped
from duhem.testing.routines.routine import Step

__all__ = ["Reply"]


@dataclass(frozen=True)
class Reply:
    """What the routine returned for ``trial`` (N, d), as arrays; ``solved`` (N,) as it says itself."""

    trial: Array
    stress: Array
    slip: Array | None
    multiplier: Array | None
    tangent: Array | None
    solved: NDArray[np.bool_]

    def part(self, rows: slice | NDArray[np.intp]) -> Reply:
        """Some of the rows."""
        return Reply(*(None if x is None else x[rows] for x in (getattr(self, name) for name in self.__dataclass_fields__)))  # type: ignore[arg-type]

    @classmethod
    def read(cls, step: Step, trial: Array) -> Reply:
        """What was answered to ``trial`` (N, d).  Raises NoReply where that has not the shapes it must have."""
        n, d = trial.shape
        shapes = {"stress": (n, d), "slip": (n, d), "multiplier": (n,), "tangent": (n, d, d)}
        parts = {name: _array(getattr(step, name), name, shape) for name, shape in shapes.items()}
        solved = np.ones(n, dtype=np.bool_) if step.solved is None else np.array(step.solved, dtype=np.bool_).reshape(n)
        return cls(trial, **parts, solved=solved)  # type: ignore[arg-type]


def _array(given: Any, name: str, shape: tuple[int, ...]) -> Array | None:
    try:
        return shaped(given, name, shape)
    except ValueError as fault:
        raise NoReply(str(fault)) from None
