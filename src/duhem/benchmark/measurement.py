"""What a benchmark leaves behind: rows with errors and times by a clock, ratios that are targets; failures are rows like others.

Whatever it measures, it says the law, the machine, and what was left out, in one frame of text.
"""

from __future__ import annotations

import platform
import tracemalloc
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from statistics import median
from time import perf_counter
from typing import Any, ClassVar, TypeVar

from duhem.benchmark.reference import ReferenceIncrement, distance
from duhem.omitted import LeftOut
from duhem.projection.in_blocks import cores
from duhem.projection.result import Array
from duhem.show.page import Page
from duhem.show.printing import finite
from duhem.version import distribution

__all__ = [
    "LIMIT",
    "Measurement",
    "Spread",
    "Study",
    "Target",
    "WorkPrecision",
    "at_most",
    "largest_errors",
    "measured",
    "memory",
    "ratio",
    "report",
    "timed",
]

# -- whatever is measured ----------------------------------------------------------------------------------------------


_PACKAGES = (
    "numpy", "scipy", "sympy", "mpmath", "cvxpy-base", "clarabel", "numba", "cvxopt", "ecos", "moreau", "osqp", "qoco", "scs", "jax",
    "jaxmat", "qpax", "proxsuite",
)  # fmt: skip


def machine() -> dict[str, Any]:
    """Processor, system, versions."""
    return {
        "processor": _processor(),
        "processors_usable": cores(),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {name.removesuffix("-base"): found for name in _PACKAGES if (found := distribution(name)) is not None},
    }


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as stream:
            for line in stream:
                if line.startswith("model name"):
                    return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


@dataclass(frozen=True, kw_only=True)
class Study(ABC):
    """``subject``: parameters and stiffness in words; ``machine`` as :func:`duhem.benchmark.measurement.machine` has it."""

    law: str
    subject: str
    machine: dict[str, Any] = field(default_factory=machine)
    left_out: tuple[LeftOut, ...]
    interrupted: bool

    @property
    @abstractmethod
    def failed(self) -> bool:
        """Whether nothing at all gave an answer."""

    @abstractmethod
    def measured(self) -> dict[str, Any]:
        """What is its own, for JSON."""

    def to_dict(self) -> dict[str, Any]:
        """For JSON; a number that is not finite is null."""
        head = {"law": self.law, "subject": self.subject, "machine": self.machine}
        return dict(finite(head | self.measured() | {"left_out": [part.to_dict() for part in self.left_out]}))


def report(study: Study, facts: Sequence[str], parts: Sequence[Sequence[str]], page: Page) -> str:
    """Law and ``facts``, the parts, then what was left out and whether the run was stopped."""
    head = [*page.hanging(f"{study.law}: {study.subject}"), *(line for fact in facts for line in page.hanging(fact, rest=""))]
    stopped = ["Interrupted: this is what was done."] if study.interrupted else []
    return page.report([head, *parts, page.items("Omitted", study.left_out), stopped])


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
