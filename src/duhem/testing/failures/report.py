"""What a routine was found to be: the checks it passed, and the failures, each with a few lines that show it again."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from duhem.law.formula_law import Criterion
from duhem.show.place import write
from duhem.show.shown import Shown
from duhem.testing.checks.registry import Check
from duhem.testing.drawn.case import Case
from duhem.testing.failures.departure import Departure
from duhem.testing.failures.replay import lines_again, test_file, test_name
from duhem.testing.routines.origin import Origin

__all__ = ["Failure", "Report", "write_replays"]


@dataclass(frozen=True)
class Failure:
    """A check that failed: ``case`` is one increment, shrunk; ``measured`` exceeds ``allowed`` there (or is nan).

    ``departure`` is what the routine returned and the closest point; ``diagnoses`` what it does instead, by name, the likeliest
    first, where that is known (:mod:`duhem.testing.failures.diagnosis`);
    ``explains`` the checks that failed too, likely for the same reason.  ``law`` is None for a routine tested without one.
    ``drawn`` are the arguments of the run that draws all increments again, as Python, "" where these cannot be written; ``alone``: one
    increment may show it by itself, as it need not where a routine keeps something between calls.
    """

    check: Check
    law: Criterion | None
    message: str
    case: Case
    measured: float
    allowed: float
    accuracy: float
    routine: str
    open_parameters: tuple[str, ...]
    explains: tuple[str, ...] = ()
    departure: Departure | None = None
    diagnoses: Mapping[str, str] = field(default_factory=dict)
    origin: Origin = field(default_factory=Origin)
    drawn: str = ""
    alone: bool = True

    @property
    def title(self) -> str:
        """The check and its statement."""
        return str(self.check)

    @property
    def increment(self) -> str:
        """The increment of the case with its parameters, in round numbers."""
        return "; ".join(text for name, text in self._increment() if name in ("law", "increment"))

    @property
    def diagnosis(self) -> str:
        """What the routine likely does instead; '' where nothing is known that gives its answers."""
        return next(iter(self.diagnoses.values()), "")

    def reproducer(self) -> str:
        """A few lines of Python that print the failure again; ``...`` stands for a routine or a law that has no name to import."""
        told = self.check.name, self.routine, self.origin, self.case, self.accuracy, self.open_parameters
        return lines_again(*told, "" if self.alone else self.drawn)

    def replay(self, place: Path | None = None) -> str:
        """The text of a test file that fails as long as the routine does, for the folder ``place``, from which it finds the routine.

        By one increment, and by the run that found it where that one passes: what a routine keeps of other calls shows only after them.
        Where the routine or the law has no name that a file can import, as one of ``__main__`` or a closure, it is a stub
        that says so.
        """
        case = self.case if self.alone else None
        told = self.title, self.check.name, self.routine, self.origin, case, self.accuracy, self.open_parameters
        return test_file(*told, place, self.drawn)

    def __str__(self) -> str:
        said = [f"  {name:<11} {text}" for name, text in self._said()]
        shown = [] if self.check.whole else ["  to see it again:", *(f"    {line}" for line in self.reproducer().splitlines())]
        return "\n".join([self.title, *said, *shown])

    def _said(self) -> Iterator[tuple[str, str]]:
        if self.diagnosis:
            yield "likely", self.diagnosis
        if not self.check.whole:
            yield from self._increment()
        yield "violated", f"{self.check.formula}: {self.message}"
        yield "tolerance", self.check.tolerance
        yield "source", self.check.source
        if self.explains:
            yield "explains", f"{', '.join(self.explains)}, which failed too"

    def _increment(self) -> Iterator[tuple[str, str]]:
        values = [f"{name} = {value:.6g}" for name, value in self.case.parameters.items()]
        if self.law is not None or values:
            yield "law", ", ".join(([] if self.law is None else [self.law.name]) + values)
        case, found = self.case, self.departure
        pressure = None if case.pressure is None else float(case.pressure[0])
        of_tensors = None if self.law is None or self.law.stress is None else self.law.stress.unit_stiffness
        yield "increment", _increment(case.trial[0].tolist(), pressure, case.stiffness.tolist(), of_tensors)
        if found is None or self.check.law_only:
            return
        if (found.trial, found.pressure, found.stiffness) != (tuple(case.trial[0]), pressure, tuple(map(tuple, case.stiffness.tolist()))):
            yield "at", f"{_increment(found.trial, found.pressure, found.stiffness, of_tensors)}, which the check asks too"
        yield "returned", _vector(found.returned)
        if found.closest is not None and found.difference is not None:
            yield "closest", _vector(found.closest)
            yield "difference", _vector(found.difference) + ("" if found.apart else ", within what is allowed")


def _increment(
    trial: Sequence[float], pressure: float | None, stiffness: Sequence[Sequence[float]], of_tensors: Sequence[float] | None
) -> str:
    load = "" if pressure is None else f", pressure {pressure:.6g}"
    return f"trial {_vector(trial)}{load}, stiffness {_matrix(stiffness, of_tensors or (1.0,) * len(trial))}"


def _vector(values: Sequence[float]) -> str:
    return f"[{', '.join(f'{x:.6g}' for x in values)}]"


def _matrix(rows: Sequence[Sequence[float]], one: Sequence[float]) -> str:
    """A multiple of ``one``, which is what a single number says, as that number, a diagonal as such."""
    diagonal = [row[i] for i, row in enumerate(rows)]
    if any(x for i, row in enumerate(rows) for j, x in enumerate(row) if i != j):
        return f"[{', '.join(map(_vector, rows))}]"
    shares = {x / unit for x, unit in zip(diagonal, one, strict=True)}
    return f"{shares.pop():.6g}" if len(shares) == 1 else f"diag {_vector(diagonal)}"


def write_replays(failures: Iterable[Failure], folder: str | Path) -> tuple[Path, ...]:
    """One test file each, in a folder that is made where there is none."""
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    written = []
    for failure in failures:
        written.append(place / test_name(failure.routine, failure.check.name))
        write(str(written[-1]), failure.replay(place.resolve()))
    return tuple(written)


@dataclass(frozen=True, repr=False)
class Report(Shown):
    """What a routine was found to be: names of checks ``passed``, ``failures``, and ``left_out`` with the reason.

    A check passed only if it judged an answer of the routine (or looks at the law alone).
    ``points`` increments were asked of the routine, of which it flagged ``flagged`` as not solved: they are not judged.
    At ``undefined`` increments g has no value where a check needs it, which does not judge them; of ``unmeasured`` ones no check does,
    since squares of their stresses leave double precision.

    ``failures`` are likely causes, the likeliest first; ``explained`` are those of the checks that a cause explains.
    ``expected``: the checks that failed as was expected, with the reason given, or with the expected one that explains them;
    ``unexpected``: those that passed though they were expected to fail, and no other that was expected and failed explains them.
    ``visited``: shares of the drawn increments (:class:`duhem.testing.checks.visited.Visited`), and ``decades`` the first and last
    power of ten of what was drawn, in ``examples`` cases by ``seed``.  ``tried``: by the name of a
    check, how many of what it looked at more than the increments, such as the pairs of stresses of convexity; ``needs``: by that name,
    what it lacked where these are 0.  ``most_flagged``: the share that may be flagged, None for any.
    """

    printed_by: ClassVar[str] = "duhem.testing.failures.report_formats"

    law: str
    passed: tuple[str, ...]
    failures: tuple[Failure, ...]
    left_out: Mapping[str, str]
    points: int
    flagged: int
    explained: tuple[Failure, ...] = ()
    expected: Mapping[str, str] = field(default_factory=dict)
    unexpected: Mapping[str, str] = field(default_factory=dict)
    visited: Mapping[str, float] = field(default_factory=dict)
    decades: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    examples: int = 0
    seed: int | None = None
    undefined: int = 0
    unmeasured: int = 0
    tried: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    needs: Mapping[str, str] = field(default_factory=dict)
    most_flagged: float | None = None

    @property
    def ok(self) -> bool:
        return not self.failures and not self.unexpected and not self.flags_too_many

    @property
    def flags_too_many(self) -> bool:
        """Whether a larger share of the increments is flagged than may be."""
        return self.most_flagged is not None and self.flagged_share > self.most_flagged

    @property
    def failed(self) -> frozenset[str]:
        """The names of the checks that failed, those that a cause explains and those expected to fail among them."""
        return frozenset(f.check.name for f in (*self.failures, *self.explained)) | frozenset(self.expected)

    @property
    def flagged_share(self) -> float:
        return self.flagged / self.points if self.points else 0.0

    def failure_of(self, check: str) -> Failure | None:
        """The failure of a check by its name, a cause or explained; None where it did not fail, or was expected to."""
        return next((f for f in (*self.failures, *self.explained) if f.check.name == check), None)

    def write_replays(self, folder: str | Path) -> tuple[Path, ...]:
        """One test file a cause (:meth:`Failure.replay`), written to a folder that is made where there is none."""
        return write_replays(self.failures, folder)

    def counted(self) -> str:
        """How many checks came out in which way, and how many increments were asked for, in words."""
        counts = f"{len(self.passed)} checks passed, {len(self.failed)} failed"
        counts += f", {len(self.left_out)} left out" if self.left_out else ""
        unsaid = f", {self.undefined} not judged where g has no value" if self.undefined else ""
        unsaid += f", {self.unmeasured} drawn and not judged where squares leave double precision" if self.unmeasured else ""
        return f"{self.law}: {counts}; {self.flags()}{unsaid}"

    def flags(self) -> str:
        """How many increments the routine flags, in words, and where these are too many that they are."""
        if self.flags_too_many:
            return f"flags {self.flagged} of {self.points} increments as not solved, more than a share {self.most_flagged:g}"
        return f"{self.points} increments, {self.flagged} flagged"

    def tested(self) -> tuple[str, ...]:
        """Of each check that passed on what it tried, how many these were: no more was tested."""
        return tuple(filter(None, (self._tested(name, self.tried.get(name, {})) for name in self.passed)))

    def _tested(self, name: str, tried: Mapping[str, int]) -> str:
        told = " and ".join(f"{n} {what}" for what, n in tried.items() if n)
        lacking = "".join(f", and on no {what}" for what, n in tried.items() if not n)
        need = f", which need {self.needs[name]}" if lacking and name in self.needs else ""
        return f"{name} was tested on {told} alone{lacking}{need}; duhem verify seeks a proof" if told else ""

    def __repr__(self) -> str:
        return f"<Report of {self.counted()}>"

    def __str__(self) -> str:
        return "\n".join(
            [
                self.counted(),
                *map(str, self.failures),
                *(f"{name} passed, and was expected to fail: {why}" for name, why in self.unexpected.items()),
                *(f"{name} failed, as expected: {why}" for name, why in self.expected.items()),
                *(f"left out {name}: {why}" for name, why in self.left_out.items()),
                *self.tested(),
            ]
        )
