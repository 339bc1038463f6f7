"""What a routine returned, as arrays of the shapes that it must have, and where it raises instead.

An increment at which it raises is known from then on, and not asked again, for it may cost a process.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.drawn.case import Case
from duhem.testing.routines.material import shaped
from duhem.testing.routines.routine import Step
from duhem.testing.routines.unfinished import Unfinished

__all__ = ["NoReply", "Raised", "Reply", "named_by"]

_FEW = 8  # increments that are asked one by one once the routine has raised, so that a call costs one process at most
_Answer = TypeVar("_Answer")


class NoReply(Exception):
    """The routine raised, or returned something that is no stress.

    ``row``: the increment at which it does so alone, None where that is not known; ``case``: the case of that increment, as the one
    that is tried, where it is another than the trial of the row; ``together``: it raises at several asked together, and at none alone.
    """

    row: int | None = None
    case: Case | None = None
    together: bool = False


@dataclass
class Raised:
    """What a routine raised, by what tells its increments apart, and how many ``times`` it did."""

    said: dict[Hashable, str] = field(default_factory=dict)
    times: int = 0

    def asked(
        self, ask: Callable[[slice], _Answer], key: Callable[[int], Hashable], count: int, say: Callable[[BaseException], str]
    ) -> _Answer:
        """The answer to so many increments asked together.  Raises NoReply and Unfinished with the row that is to blame alone."""
        together = tuple(map(key, range(count))) if self.said else ()
        for row, each in enumerate(together):
            if each in self.said:
                raise self._at(row, self.said[each])
        if together in self.said:
            raise self._at(None, self.said[together])
        if self.said and 1 < count <= _FEW:
            self._one_by_one(ask, key, count, say)
        try:
            return ask(slice(None))
        except Unfinished as fault:
            fault.locate(ask, count)
            raise
        except (Exception, SystemExit) as fault:
            self.times += 1
            said = say(fault)
            if count == 1:
                self.said[key(0)] = said
                raise self._at(0, said) from fault
        self._one_by_one(ask, key, count, say)
        self.said[tuple(map(key, range(count)))] = said
        raise self._at(None, said)

    def _one_by_one(
        self, ask: Callable[[slice], object], key: Callable[[int], Hashable], count: int, say: Callable[[BaseException], str]
    ) -> None:
        """Raises NoReply at the first increment at which the routine raises alone."""
        for row in range(count):
            try:
                ask(slice(row, row + 1))
            except Unfinished as fault:
                fault.row = row
                raise
            except (Exception, SystemExit) as fault:
                self.times += 1
                self.said[key(row)] = say(fault)
                raise self._at(row, self.said[key(row)]) from fault

    def _at(self, row: int | None, said: str) -> NoReply:
        fault = NoReply(said)
        fault.row, fault.together = row, row is None
        return fault


def named_by(fault: NoReply | Unfinished, case: Case) -> Case:
    """The increment of a case at which the routine gives no answer alone, as the one that is tried."""
    return case.row(fault.row or 0) if fault.case is None else fault.case


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
