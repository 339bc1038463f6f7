"""What a benchmark leaves behind: rows with errors and times, targets, what was left out; failures are rows like others."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any

from duhem.benchmark.study import Study

__all__ = ["Measurement", "Spread", "Target", "WorkPrecision"]


@dataclass(frozen=True)
class Spread:
    """Seconds of ``repeats`` runs in the same process."""

    least: float
    median: float
    most: float
    repeats: int

    @classmethod
    def of(cls, seconds: list[float], share: float = 1.0) -> Spread:
        """From the runs, each multiplied by ``share``."""
        ordered = sorted(s * share for s in seconds)
        middle = len(ordered) // 2
        median = ordered[middle] if len(ordered) % 2 else 0.5 * (ordered[middle - 1] + ordered[middle])
        return cls(ordered[0], median, ordered[-1], len(ordered))


@dataclass(frozen=True)
class Measurement:
    """One method at one setting.

    ``error`` by quantity, relative, the largest; ``seconds`` an increment, a path (by the wall clock) or a point (by
    the processor's), as the scene has it;
    ``flagged`` how many answers the method itself calls inaccurate or failed; ``failure`` why there is no answer;
    ``first`` the seconds of the first call of all, what it compiles included, where it was taken.
    """

    scene: str
    method: str
    setting: str
    error: dict[str, float] = field(default_factory=dict)
    seconds: Spread | None = None
    flagged: int = 0
    failure: str | None = None
    note: str = ""
    first: float | None = None

    @classmethod
    def failing(cls, scene: str, method: str, setting: str, fault: Exception) -> Measurement:
        """No answer: whatever a method raises is its result."""
        return cls(scene, method, setting, failure=f"{type(fault).__name__}: {fault}")


@dataclass(frozen=True)
class Target:
    """A ratio taken within one run, what it is to be, and whether it is; ``holds`` None where it could not be taken."""

    what: str
    value: float | None
    relation: str
    bound: float
    reason: str = ""

    @property
    def holds(self) -> bool | None:
        if self.value is None:
            return None
        return self.value <= self.bound if self.relation == "<=" else self.value >= self.bound


@dataclass(frozen=True, kw_only=True)
class WorkPrecision(Study):
    """The rows in the order taken; ``reference`` the reference's own error by scene, or why there is none."""

    repeats: int
    rows: tuple[Measurement, ...]
    targets: tuple[Target, ...]
    reference: dict[str, float | str]

    @property
    def failed(self) -> bool:
        return bool(self.rows) and all(row.failure is not None for row in self.rows)

    def measured(self) -> dict[str, Any]:
        plain = {
            "repeats": self.repeats,
            "interrupted": self.interrupted,
            "reference": self.reference,
            "rows": [asdict(row) for row in self.rows],
            "targets": [asdict(target) | {"holds": target.holds} for target in self.targets],
        }
        return {key: _finite(value) for key, value in plain.items()}


def _finite(value: Any) -> Any:
    match value:
        case dict():
            return {key: _finite(inner) for key, inner in value.items()}
        case list() | tuple():
            return [_finite(inner) for inner in value]
        case float():
            return value if math.isfinite(value) else None
    return value
