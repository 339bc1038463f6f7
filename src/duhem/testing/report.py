"""What a routine was found to be: the checks it passed, and the failures, each with a few lines that show it again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from duhem.law.formula_law import Criterion
from duhem.testing.case import Case
from duhem.testing.registry import Check

__all__ = ["Failure", "Report"]


@dataclass(frozen=True)
class Failure:
    """A check that failed: ``case`` is one increment, shrunk; ``measured`` exceeds ``allowed`` there (or is nan)."""

    check: Check
    law: Criterion
    message: str
    case: Case
    measured: float
    allowed: float
    accuracy: float
    routine: str
    open_parameters: tuple[str, ...]

    @property
    def title(self) -> str:
        """The check and its statement."""
        return str(self.check)

    def reproducer(self) -> str:
        """A few lines of Python that show the failure again; ``update`` is the routine."""
        module, _, name = self.routine.rpartition(".")
        there = f"from {module} import {name} as update" if module and "<" not in self.routine else f"update = ...  # {self.routine}"
        free = "" if self.open_parameters == tuple(self.case.parameters) else f", open_parameters={self.open_parameters!r}"
        lines = [
            "from duhem.testing import Case, violation",
            there,
            f"case = {self.case!r}",
            f"print(violation({self.check.name!r}, {self.law.name!r}, update, case, accuracy={self.accuracy!r}{free}))",
        ]
        return "\n".join(lines)

    def __str__(self) -> str:
        return "\n".join(
            [
                f"{self.check.name}: {self.message}",
                f"  {self.check.statement}: {self.check.formula}",
                f"  {self.check.source}",
                f"  allowed: {self.check.tolerance}",
                *(f"  {line}" for line in self._values()),
                "  to see it again:",
                *(f"    {line}" for line in self.reproducer().splitlines()),
            ]
        )

    def _values(self) -> Iterable[str]:
        yield ", ".join(f"{name} = {value!r}" for name, value in self.case.parameters.items())
        pressure = "" if self.case.pressure is None else f", pressure {float(self.case.pressure[0])!r}"
        yield f"trial {self.case.trial[0].tolist()}{pressure}, stiffness {self.case.stiffness.tolist()}"


@dataclass(frozen=True)
class Report:
    """What a routine was found to be: names of checks ``passed``, ``failures``, and ``left_out`` with the reason.

    A check passed only if it judged an answer of the routine (or looks at the law alone).
    ``points`` increments were asked of the routine, of which it flagged ``flagged`` as not solved: they are not judged.
    """

    law: str
    passed: tuple[str, ...]
    failures: tuple[Failure, ...]
    left_out: Mapping[str, str]
    points: int
    flagged: int

    @property
    def ok(self) -> bool:
        return not self.failures

    @property
    def failed(self) -> frozenset[str]:
        """The names of the checks that failed."""
        return frozenset(f.check.name for f in self.failures)

    @property
    def flagged_share(self) -> float:
        return self.flagged / self.points if self.points else 0.0

    def __str__(self) -> str:
        counts = f"{len(self.passed)} checks passed, {len(self.failures)} failed"
        counts += f", {len(self.left_out)} left out" if self.left_out else ""
        head = f"{self.law}: {counts}; {self.points} increments, {self.flagged} flagged"
        return "\n".join([head, *map(str, self.failures), *(f"left out {name}: {why}" for name, why in self.left_out.items())])
