"""What a benchmark leaves behind: rows with errors and times by a clock, ratios that are targets; failures are rows like others."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from statistics import median
from time import perf_counter
from typing import Any, ClassVar, TypeVar

from duhem.benchmark.reference import ReferenceIncrement, distance
from duhem.benchmark.study import Study
from duhem.projection.result import Array

__all__ = ["LIMIT", "Measurement", "Spread", "Target", "WorkPrecision", "at_most", "largest_errors", "measured", "memory", "ratio", "timed"]

LIMIT = 6.0  # s: of the runs of one row; no more are begun beyond
Key = TypeVar("Key")


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
        own = [s * share for s in seconds]
        return cls(min(own), median(own), max(own), len(own))


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

    printed_by: ClassVar[str] = "duhem.benchmark.report"

    repeats: int
    rows: tuple[Measurement, ...]
    targets: tuple[Target, ...]
    reference: dict[str, float | str]

    @property
    def failed(self) -> bool:
        return bool(self.rows) and all(row.failure is not None for row in self.rows)

    def measured(self) -> dict[str, Any]:
        return {
            "repeats": self.repeats,
            "interrupted": self.interrupted,
            "reference": self.reference,
            "rows": [asdict(row) for row in self.rows],
            "targets": [asdict(target) | {"holds": target.holds} for target in self.targets],
        }


def timed(
    run: Callable[[], object], repeats: int, share: float = 1.0, limit: float = 1.5, clock: Callable[[], float] = perf_counter
) -> Spread:
    """Seconds of ``run`` times ``share``: up to ``repeats`` runs, fewer (but three, or one long one) past ``limit`` seconds.

    ``clock``: by default the wall's.
    """
    seconds: list[float] = []
    while len(seconds) < repeats and (sum(seconds) < limit or (len(seconds) < 3 and seconds[0] < limit)):
        began = clock()
        run()
        seconds.append(clock() - began)
    return Spread.of(seconds, share)


def measured(
    scene: str,
    name: str,
    setting: str,
    run: Callable[[], object],
    repeats: int,
    count: int,
    clock: Callable[[], float] = perf_counter,
    note: str = "",
) -> Measurement:
    """The row of a run by :func:`timed`, seconds for one of ``count``; a first run compiles what is compiled on first use."""
    try:
        run()
        return Measurement(scene, name, setting, seconds=timed(run, repeats, 1.0 / count, LIMIT, clock), note=note)
    except Exception as fault:
        return Measurement.failing(scene, name, setting, fault)


def memory(scene: str, name: str, setting: str, run: Callable[[], object], *, results: bool) -> Measurement:
    """Bytes that a run takes at its peak, in MB, as an error-free row of its own; without ``results`` those beyond what these keep."""
    tracemalloc.start()
    try:
        kept = run()
        now, peak = tracemalloc.get_traced_memory()
        del kept
    except Exception as fault:
        return Measurement.failing(scene, name, setting, fault)
    finally:
        tracemalloc.stop()
    return Measurement(scene, name, setting, {"megabytes": (peak if results else peak - now) / 1e6})


def largest_errors(found: Sequence[tuple[Array, Array, ReferenceIncrement]]) -> dict[str, float]:
    """The largest relative errors of stresses (d,) and slips (d,) against their references."""
    return {
        "stress": max(distance(stress.tolist(), answer.stress) for stress, _, answer in found),
        "slip": max(distance(slip.tolist(), answer.slip) for _, slip, answer in found),
    }


def ratio(
    what: str,
    over: Key,
    under: Key,
    relation: str,
    bound: float,
    *,
    seconds: Mapping[Key, float],
    absent: Mapping[str, str],
    name: Callable[[Key], str] = str,
) -> Target:
    """One of the ``seconds`` over another; of one that was not measured why, which ``absent`` has by its ``name``."""
    missing = dict.fromkeys(name(key) for key in (over, under) if key not in seconds)
    value = None if missing or seconds[under] == 0.0 else seconds[over] / seconds[under]
    reason = "; ".join(absent.get(each, f"{each} was not measured") for each in missing)
    return Target(what, value, relation, bound, reason or ("" if value is not None else "too short for this clock"))


def at_most(what: str, value: float | None, bound: float, reason: str) -> Target:
    """A number of its own; ``reason`` says why there is none."""
    return Target(what, value, "<=", bound, "" if value is not None else reason)
