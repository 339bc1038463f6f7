"""Reports for programs: as a dictionary for JSON, and as the XML that readers of JUnit take."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from duhem.show.junit import JUnitCase, JUnitSuite, Outcome, as_xml
from duhem.show.page import PAGE, Page
from duhem.show.printing import plain, sheet, text
from duhem.show.sheet import Sheet
from duhem.testing.failures.report import Failure, Report

__all__ = ["as_dict", "as_junit", "as_sheet", "as_text"]


@plain.register(Report)
def as_dict(report: Report) -> dict[str, Any]:
    """Everything a report holds, with what shows each failure again; numbers that are not finite as None."""
    return {
        "law": report.law,
        "ok": report.ok,
        "passed": list(report.passed),
        "failures": [_failure(f) for f in report.failures],
        "explained": [_failure(f) for f in report.explained],
        "expected": dict(report.expected),
        "unexpected": dict(report.unexpected),
        "left_out": dict(report.left_out),
        "increments": report.points,
        "flagged": report.flagged,
        "most_flagged": report.most_flagged,
        "undefined": report.undefined,
        "unmeasured": report.unmeasured,
        "tried": {name: dict(counts) for name, counts in report.tried.items()},
        "examples": report.examples,
        "seed": report.seed,
        "visited": dict(report.visited),
        "decades": {name: list(ends) for name, ends in report.decades.items()},
    }


@text.register(Report)
def as_text(report: Report, page: Page = PAGE) -> str:
    """What ``str`` gives: lines of code to see a failure again stay as they are, however wide."""
    return str(report)


@sheet.register(Report)
def as_sheet(report: Report) -> Sheet:
    """A row a check; then what is likely wrong, and why checks were left out or expected to fail."""
    outcomes = dict.fromkeys(report.passed, "passed") | dict.fromkeys(report.left_out, "left out")
    outcomes |= dict.fromkeys(sorted(report.failed), "failed") | dict.fromkeys(report.expected, "failed, as expected")
    outcomes |= dict.fromkeys(report.unexpected, "passed, and was expected to fail")
    reasons = {**report.left_out, **report.expected, **report.unexpected}
    return Sheet(
        report.counted(),
        head=("check", "outcome"),
        rows=tuple(outcomes.items()),
        notes=(
            ("Failures", tuple(f"{f.check.name}: {f.diagnosis or f.message}" for f in report.failures)),
            ("Reasons", tuple(f"{name}: {why}" for name, why in reasons.items())),
            ("Tested", report.tested()),
        ),
    )


def _failure(failure: Failure) -> dict[str, Any]:
    found = failure.departure
    return {
        "check": failure.check.name,
        "statement": failure.check.statement,
        "formula": failure.check.formula,
        "message": failure.message,
        "diagnosis": failure.diagnosis,
        "explains": list(failure.explains),
        "parameters": dict(failure.case.parameters),
        "departure": None
        if found is None
        else {
            "trial": list(found.trial),
            "pressure": found.pressure,
            "stiffness": [list(row) for row in found.stiffness],
            "returned": [_finite(x) for x in found.returned],
            "closest": None if found.closest is None else list(found.closest),
        },
        "replay": failure.replay(),
    }


def _finite(x: float) -> float | None:
    return x if abs(x) < float("inf") else None


def as_junit(reports: Mapping[str, Report]) -> str:
    """One suite a routine, by its name, and one case a check, and one for what it flags where that is bounded.

    What was visited and drawn stands in properties.
    """
    return as_xml(_suite(name, report) for name, report in reports.items())


def _suite(name: str, report: Report) -> JUnitSuite:
    said = {"law": report.law, "seed": report.seed, "examples": report.examples, "increments": report.points, "flagged": report.flagged}
    properties = {key: str(value) for key, value in said.items()}
    properties |= {} if report.most_flagged is None else {"most_flagged": f"{report.most_flagged:g}"}
    properties |= {f"visited {key}": f"{share:.6g}" for key, share in report.visited.items()}
    cases = [_case(check, report) for check in (*report.passed, *sorted(report.failed), *report.left_out)]
    return JUnitSuite(name, (*cases, *_flagged(report)), properties)


def _flagged(report: Report) -> Iterator[JUnitCase]:
    """The case of what is flagged, where not any share may be."""
    if report.flags_too_many:
        yield JUnitCase("flagged", Outcome.FAILED, report.flags())
    elif report.most_flagged is not None:
        yield JUnitCase("flagged")


def _case(check: str, report: Report) -> JUnitCase:
    if (failure := report.failure_of(check)) is not None:
        cause = next((f.check.name for f in report.failures if check in f.explains), None)
        message = failure.diagnosis or failure.message if cause is None else f"{failure.message}; likely explained by {cause}"
        return JUnitCase(check, Outcome.FAILED, message, str(failure))
    if check in report.unexpected:
        return JUnitCase(check, Outcome.FAILED, f"passed, and was expected to fail: {report.unexpected[check]}")
    if check in report.expected:
        return JUnitCase(check, Outcome.SKIPPED, f"failed, as expected: {report.expected[check]}")
    return JUnitCase(check, Outcome.SKIPPED, report.left_out[check]) if check in report.left_out else JUnitCase(check)
