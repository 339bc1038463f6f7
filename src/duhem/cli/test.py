"""``duhem test``: a slip increment put to every check."""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from random import Random
from time import monotonic
from typing import TYPE_CHECKING, Any

import click

from duhem.cli.arguments import check_names, read_fixed_formula, read_number, read_routine, settings_option
from duhem.cli.exit_code import FAILED, HELD, INTERRUPTED, REFUTED
from duhem.cli.output import Progress, say
from duhem.errors import InputError

if TYPE_CHECKING:
    from duhem.law.formula_law import Criterion
    from duhem.testing.report import Report
    from duhem.testing.run import ConformanceRun

__all__ = ["test"]

_EXAMPLES = {"dev": 30, "ci": 100, "deep": 2000}


@click.command()
@click.argument("subject", metavar="LAW|MODULE:CALLABLE")
@click.option("--law", metavar="LAW", help="The law that MODULE:CALLABLE is a routine for.")
@settings_option
@click.option(
    "--profile",
    type=click.Choice([*_EXAMPLES]),
    default="dev",
    show_default=True,
    help="How many cases are drawn: 30, 100 with seed 0 (the same each time), or 2000.",
)
@click.option("--examples", type=click.IntRange(1), metavar="N", help="Another number of cases than the profile's.")
@click.option("--seed", type=click.IntRange(0), metavar="S", help="Draw the cases of this seed again.")
@click.option("--accuracy", metavar="A", help="Relative error in stress that the routine promises; 1e-9 if left out.")
@click.option("--checks", metavar="A,B", help="Only these checks.")
@click.option(
    "--expect", metavar="CHECK=REASON", multiple=True, help="A check known to fail, and why; that it passes is an error. Repeatable."
)
@click.option("--shrink", metavar="SECONDS", default="10", show_default=True, help="How long each failing case is made smaller, at most.")
@click.option("--replay", metavar="FOLDER", help="Also write each failure to FOLDER as a test file.")
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "json", "junit"]),
    default="text",
    show_default=True,
    help="For people, for programs, or for what reads JUnit's XML.",
)
def test(
    subject: str,
    law: str | None,
    settings: Sequence[str],
    profile: str,
    examples: int | None,
    seed: int | None,
    accuracy: str | None,
    checks: str | None,
    expect: Sequence[str],
    shrink: str,
    replay: str | None,
    form: str,
) -> int:
    """Put a routine for the slip increment to every check, or duhem's own: each method that takes LAW.

    MODULE:CALLABLE is update(trial (N, d), pressure (N,), stiffness (d, d), **parameters) -> stress (N, d), with --law the law
    that it is for; the module is looked for in the working folder too.  Increments are drawn by Hypothesis on, beside and far
    off the boundary, failing ones shrunk; each likely cause is told once.

    Exit codes: 0 every check passed; 1 a check failed; 2 usage or file error; 4 a solver answered nothing; 130 interrupted,
    after printing what was found.
    """
    asked = {
        "law": law,
        "set": settings,
        "profile": profile,
        "examples": examples,
        "accuracy": accuracy,
        "checks": checks,
        "expect": expect,
    }
    drawn = seed if seed is not None else 0 if profile == "ci" else Random().getrandbits(32)
    about = _About(subject, asked, examples or _EXAMPLES[profile], drawn)
    expected = _expected(expect)
    named = None if checks is None else tuple(dict.fromkeys(name.strip() for name in checks.split(",") if name.strip()))
    seconds = read_number(shrink, "--shrink")
    held_to = None if accuracy is None else read_number(accuracy, "--accuracy")
    if held_to is not None and held_to <= 0.0:
        raise InputError("the accuracy is not positive", where="--accuracy", remedy="give a relative error, for example 1e-9")
    about.check_names(named, expected)
    routines = about.routines(law, settings, held_to)
    interrupted = about.carry_out(routines, named, expected, seconds)
    say(about.told(form))
    if replay is not None:
        for report in about.reports.values():
            report.write_replays(replay)
    return INTERRUPTED if interrupted else about.code()


def _expected(given: Sequence[str]) -> dict[str, str]:
    expected = {}
    for one in given:
        name, equals, reason = (part.strip() for part in one.partition("="))
        if not (name and equals and reason):
            raise InputError(
                "this is not of the form CHECK=REASON", where=f"--expect {one}", remedy="write for example --expect slope='no tangent yet'"
            )
        expected[name] = reason
    return expected


@dataclass
class _About:
    """One call of the command: what is tested, and what has been found."""

    subject: str
    asked: Mapping[str, Any]
    examples: int
    seed: int
    reports: dict[str, Report] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    without: dict[str, str] = field(default_factory=dict)

    def check_names(self, named: Sequence[str] | None, expected: Mapping[str, str]) -> None:
        from duhem.testing.conformance import every_check

        known = [c.name for c in every_check()]
        check_names("check", named or (), known, "checks are", "--checks")
        if named == ():
            raise InputError("no check is named", where="--checks", remedy=f"checks are: {', '.join(known)}")
        check_names("check", expected, known, "checks are", "--expect")

    def routines(self, law: str | None, settings: Sequence[str], accuracy: float | None) -> dict[str, tuple[Criterion, Any, float]]:
        """By the name they are shown under: law, routine and the accuracy it is held to."""
        from duhem.testing.conformance import ACCURACY
        from duhem.testing.own_solvers import PROMISED, own_solvers

        if law is not None:
            return {self.subject: (read_fixed_formula(law, settings), read_routine(self.subject), accuracy or ACCURACY)}
        if self._is_routine():
            raise InputError(f"{self.subject} is a routine", where="--law", remedy="say which law it is for, as --law coulomb")
        known, found = read_fixed_formula(self.subject, settings), {}
        for method, routine in own_solvers(known):
            if isinstance(routine, str):
                self.without[method] = routine
            else:
                found[f"{known.name} {method}"] = known, routine, accuracy or PROMISED.get(method, ACCURACY)
        return found

    def _is_routine(self) -> bool:
        if ":" not in self.subject:
            return False
        from duhem.law.curve_law import Law

        return not isinstance(read_routine(self.subject), Law)

    def carry_out(
        self,
        routines: Mapping[str, tuple[Criterion, Any, float]],
        named: Sequence[str] | None,
        expected: Mapping[str, str],
        seconds: float,
    ) -> bool:
        """Test them one after the other; whether somebody interrupted."""
        from duhem.testing.conformance import check, checks_for
        from duhem.testing.run import ConformanceRun

        with Progress("testing") as progress:
            for name, (law, routine, accuracy) in routines.items():
                begun = monotonic()

                def seen(run: ConformanceRun, name: str = name, begun: float = begun) -> None:
                    rate = run.examples / max(monotonic() - begun, 1e-9)
                    shares = run.visited.shares
                    slip = f", slip {shares['slip']:.0%}" if shares else ""
                    progress.show(f"{name}: {run.examples} of {self.examples}, {rate:.0f}/s{slip}, {len(run.found)} failed")

                run = ConformanceRun(
                    law,
                    routine,
                    None,
                    checks_for(law) if named is None else [check(c) for c in named],
                    stiffness=None,
                    pressure=None,
                    accuracy=accuracy,
                    max_examples=self.examples,
                    rows=30,
                    seconds=seconds,
                    seed=self.seed,
                    expected=expected,
                    on_case=seen,
                    given=self.asked["law"] or self.subject,
                )
                try:
                    run.to_the_end()
                except KeyboardInterrupt:
                    self._keep(name, run, begun)
                    return True
                self._keep(name, run, begun)
        return False

    def _keep(self, name: str, run: ConformanceRun, begun: float) -> None:
        self.seconds[name] = monotonic() - begun
        self.reports[name] = run.report()

    def code(self) -> int:
        if not all(report.ok for report in self.reports.values()):
            return REFUTED
        silent = not self.reports or any(r.points and r.flagged == r.points for r in self.reports.values())
        return FAILED if silent else HELD

    # -- what is printed -----------------------------------------------------------------------------------------------

    def told(self, form: str) -> str:
        from duhem.testing.report_formats import as_dict, as_junit

        if form == "junit":
            return as_junit(self.reports)
        if form == "json":
            each = {name: {**as_dict(report), "again": self.again()} for name, report in self.reports.items()}
            return json.dumps({"routines": each, "left_out": self.without}, indent=2, ensure_ascii=False)
        parts = [self._text(name, report) for name, report in self.reports.items()]
        return "\n\n".join([*parts, *(f"{method} left out: {why}" for method, why in self.without.items())])

    def _text(self, name: str, report: Report) -> str:
        lines = [f"{name}", str(report)]
        if report.visited:
            lines.append("visited: " + ", ".join(f"{what} {share:.3g}" for what, share in report.visited.items()))
            lines.append("decades: " + ", ".join(f"{what} 1e{low} to 1e{high}" for what, (low, high) in report.decades.items()))
        seconds = self.seconds[name]
        lines.append(f"{report.examples} examples in {seconds:.1f} s, {report.examples / max(seconds, 1e-9):.0f} a second")
        lines.append(f"again: {self.again()}")
        return "\n".join(lines)

    def again(self) -> str:
        """The command line that draws the same cases."""
        words = ["duhem", "test", self.subject]
        for name, value in {**self.asked, "seed": self.seed}.items():
            for each in value if isinstance(value, tuple | list) else [] if value is None else [value]:
                words += [f"--{name}", str(each)]
        return shlex.join(words)
