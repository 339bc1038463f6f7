"""What a routine was found to be: the checks it passed, and the failures; as text, as a sheet, and for programs as JSON and JUnit's XML."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from duhem.show.junit import JUnitCase, JUnitSuite, Outcome, as_xml
from duhem.show.page import PAGE
from duhem.show.printing import Sheet, Shown, finite, plain, sheet, text
from duhem.testing.failures.failure import Failure, write_replays

__all__ = ["FAILED", "MET", "PASSED", "SKIPPED", "UNMET", "Report", "as_dict", "as_junit"]

PASSED, FAILED, SKIPPED, MET, UNMET = "passed", "failed", "skipped", "failed, as expected", "passed, but was expected to fail"


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
    ``visited``: shares of the drawn increments (:class:`duhem.testing.checks.registry.Visited`), and ``decades`` the first and last
    power of ten of what was drawn, in ``examples`` cases by ``seed``.  ``tried``: by the name of a
    check, how many of what it looked at more than the increments, such as the pairs of stresses of convexity; ``needs``: by that name,
    what it lacked where these are 0.  ``most_flagged``: the share that may be flagged, None for any.
    ``ended`` is what ended the run before its end, "" where nothing did; the report then has what was found so far.  ``interrupted``:
    this was an interrupt, not a routine that does not come back.  ``unfinished`` is the increment that was not answered, if a check
    asked for it.
    """

    printed_by: ClassVar[str] = __name__

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
    ended: str = ""
    interrupted: bool = False
    unfinished: Failure | None = None

    @property
    def ok(self) -> bool:
        return not self.failures and not self.unexpected and not self.flags_too_many and not self.ended

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

    def cause_of(self, check: str) -> str:
        """The failed check that explains another one, "" where none does."""
        return next((f.check.name for f in self.failures if check in f.explains), "")

    def outcomes(self) -> dict[str, tuple[str, str]]:
        """How each check came out, and why, in words."""
        found = {name: (PASSED, "") for name in self.passed} | {name: (SKIPPED, why) for name, why in self.left_out.items()}
        for name in sorted(self.failed - {*self.expected}):
            failure, cause = self.failure_of(name), self.cause_of(name)
            assert failure is not None
            found[name] = FAILED, f"{failure.message}; likely explained by {cause}" if cause else failure.diagnosis or failure.message
        found |= {name: (MET, why) for name, why in self.expected.items()}
        return found | {name: (UNMET, why) for name, why in self.unexpected.items()}

    def write_replays(self, folder: str | Path) -> tuple[Path, ...]:
        """One test file a cause and for ``unfinished`` (:meth:`Failure.replay`), in a folder that is made where there is none."""
        return write_replays((*self.failures, *([] if self.unfinished is None else [self.unfinished])), folder)

    def counted(self) -> str:
        """How many checks came out in which way, and how many increments were asked for, in words."""
        counts = f"{len(self.passed)} checks passed, {len(self.failed)} failed"
        counts += f", {len(self.left_out)} skipped" if self.left_out else ""
        unsaid = f", {self.undefined} not judged because g has no value there" if self.undefined else ""
        unsaid += f", {self.unmeasured} not judged because squares of the stresses overflow or underflow" if self.unmeasured else ""
        return f"{self.law}: {counts}; {self.flags()}{unsaid}"

    def flags(self) -> str:
        """How many increments the routine flags, in words, and where these are too many that they are."""
        if self.flags_too_many:
            return f"flags {self.flagged} of {self.points} increments as not solved, more than the allowed fraction {self.most_flagged:g}"
        return f"{self.points} increments, {self.flagged} flagged"

    def tested(self) -> tuple[str, ...]:
        """Of each check that passed on what it tried, how many these were: no more was tested."""
        return tuple(filter(None, (self._tested(name, self.tried.get(name, {})) for name in self.passed)))

    def _tested(self, name: str, tried: Mapping[str, int]) -> str:
        told = " and ".join(f"{n} {what}" for what, n in tried.items() if n)
        lacking = "".join(f", and on no {what}" for what, n in tried.items() if not n)
        need = f", which need {self.needs[name]}" if lacking and name in self.needs else ""
        return f"{name} was tested only on {told}{lacking}{need}; duhem verify searches for a proof" if told else ""

    def __repr__(self) -> str:
        return f"<Report of {self.counted()}>"

    def ranges(self) -> tuple[str, ...]:
        """What was visited: the shares of increments, and the decades of what was drawn."""
        if not self.visited:
            return ()
        shares = ", ".join(f"{what} {share:.3g}" for what, share in self.visited.items())
        return f"visited: {shares}", "decades: " + ", ".join(f"{what} 1e{low} to 1e{high}" for what, (low, high) in self.decades.items())

    def __str__(self) -> str:
        said = [self.counted(), *([f"ended before its end: {self.ended}"] if self.ended else [])]
        said += map(str, (*([] if self.unfinished is None else [self.unfinished]), *self.failures))
        said += [f"{name} {UNMET}: {why}" for name, why in self.unexpected.items()]
        said += [f"{name} {MET}: {why}" for name, why in self.expected.items()]
        said += [f"skipped {name}: {why}" for name, why in self.left_out.items()]
        return "\n".join([*said, *self.tested(), *self.ranges()])


@plain.register(Report)
def as_dict(report: Report) -> dict[str, Any]:
    """Return everything a report holds, with what shows each failure again; a number that is not finite is None."""
    told = {name: part for name, part in vars(report).items() if name not in ("points", "interrupted", "needs", "unfinished")}
    told |= {name: [*map(_failure, told[name])] for name in ("failures", "explained")}
    return {**finite(told), "ok": report.ok, "increments": report.points}


def _failure(failure: Failure) -> dict[str, Any]:
    shown = ("trial", "pressure", "stiffness", "returned", "closest")
    departure = None if failure.departure is None else {name: getattr(failure.departure, name) for name in shown}
    said = {name: getattr(failure, name) for name in ("message", "diagnosis", "where", "explains")}
    said |= {name: getattr(failure.check, name) for name in ("statement", "formula")}
    return {"check": failure.check.name, **said, "parameters": failure.case.parameters, "departure": departure, "replay": failure.replay()}


text.register(Report, lambda report, page=PAGE: str(report))  # lines of code to see a failure again stay as they are, however wide


@sheet.register(Report)
def as_sheet(report: Report) -> Sheet:
    """Return a sheet with a row a check; then what is likely wrong, and why checks were left out or expected to fail."""
    reasons = {**report.left_out, **report.expected, **report.unexpected}
    return Sheet(
        report.counted(),
        head=("check", "outcome"),
        rows=tuple((name, how) for name, (how, _) in report.outcomes().items()),
        notes=(
            ("Ended before its end", (report.ended,) if report.ended else ()),
            ("Failures", tuple(f"{f.check.name}: {f.diagnosis or f.message}" for f in report.failures)),
            ("Reasons", tuple(f"{name}: {why}" for name, why in reasons.items())),
            ("Tested", report.tested()),
        ),
    )


def as_junit(reports: Mapping[str, Report]) -> str:
    """Return JUnit's XML: a suite a routine, by its name, with a case a check, and one for what it flags where that is bounded.

    A run that ended before its end has one more case, which fails.  What was visited and drawn stands in properties.
    """
    return as_xml(_suite(name, report) for name, report in reports.items())


def _suite(name: str, report: Report) -> JUnitSuite:
    said = {"law": report.law, "seed": report.seed, "examples": report.examples, "increments": report.points, "flagged": report.flagged}
    properties = {key: str(value) for key, value in said.items()}
    properties |= {} if report.most_flagged is None else {"most_flagged": f"{report.most_flagged:g}"}
    properties |= {f"visited {key}": f"{share:.6g}" for key, share in report.visited.items()}
    cases = [_case(check, report) for check in (*report.passed, *sorted(report.failed), *report.left_out)]
    return JUnitSuite(name, (*cases, *_of_the_run(report)), properties)


def _of_the_run(report: Report) -> Iterator[JUnitCase]:
    """Yield the case of a run that ended before its end, and that of what is flagged, where the share of it is bounded."""
    if report.ended:
        yield JUnitCase("ended", Outcome.FAILED, report.ended, "" if report.unfinished is None else str(report.unfinished))
    if report.flags_too_many:
        yield JUnitCase("flagged", Outcome.FAILED, report.flags())
    elif report.most_flagged is not None:
        yield JUnitCase("flagged")


_AS_JUNIT = {PASSED: Outcome.PASSED, SKIPPED: Outcome.SKIPPED, FAILED: Outcome.FAILED, MET: Outcome.SKIPPED, UNMET: Outcome.FAILED}


def _case(check: str, report: Report) -> JUnitCase:
    how, why = report.outcomes()[check]
    said = why if how in (PASSED, SKIPPED, FAILED) else f"{how}: {why}"
    return JUnitCase(check, _AS_JUNIT[how], said, str(report.failure_of(check) or ""))
