"""The extreme cases as tables: for each axis decades down, methods across, and what was silently wrong."""

from __future__ import annotations

from duhem.benchmark.extreme_cases.cases import AXES
from duhem.benchmark.extreme_cases.stress import ExtremeCases, Tally
from duhem.benchmark.study_text import report
from duhem.show.page import PAGE, Page, tied

__all__ = ["text"]

LEGEND = (
    "Cells: accurate digits of the stress / of the slip, the fewest of the points, at most 16. F: flagged (status inaccurate or "
    "failed, or an error raised). X: numbers that are not finite. O: outside K. !stress, !slip: silently wrong, that is fewer than "
    "6 digits of it and no flag."
)


def text(result: ExtremeCases, page: Page = PAGE) -> str:
    """Axis by axis, then a summary for each method, refusals, and what was left out."""
    facts = [f"reference: the optimality conditions in many digits, its own error {result.reference:.0e}"]
    axes = [_axis(result, axis, meaning, page) for axis, meaning in AXES.items()]
    return report(
        result,
        facts,
        [page.hanging(LEGEND, rest=""), *axes, ["Summary", *_summary(result, page)], _refusals(result, page), _errors(result, page)],
        page,
    )


def _axis(result: ExtremeCases, axis: str, meaning: str, page: Page) -> list[str]:
    rows = {(row.label, row.method): row for row in result.rows if row.axis == axis}
    labels = dict.fromkeys(label for label, _ in rows)
    body = [[label, *(_cell(rows[label, m]) if (label, m) in rows else "" for m in result.methods)] for label in labels]
    return [*page.hanging(f"{axis}: {meaning}"), *page.table([["", *result.methods], *body], "l")] if rows else []


def _cell(row: Tally) -> str:
    if row.failure is not None:
        return tied("- / -") + "  F"
    marks = [
        "F" if row.flagged else "",
        "X" if row.finite < row.points else "",
        "O" if row.feasible < row.finite else "",
        " !stress" if row.wrong_stress else "",
        " !slip" if row.wrong_slip else "",
    ]
    digits = tied(f"{row.stress_digits:4.1f} / {row.slip_digits:4.1f}")
    return f"{digits} {''.join(marks).lstrip()}".rstrip()


def _summary(result: ExtremeCases, page: Page) -> list[str]:
    body: list[tuple[str, ...]] = [("method", "points", "finite", "in K", "flagged", "silently wrong: stress", "slip")]
    for method in result.methods:
        rows = [row for row in result.rows if row.method == method]
        counts = [sum(getattr(row, name) for row in rows) for name in ("points", "finite", "feasible", "flagged")]
        wrong = result.silently_wrong[method]
        body.append((method, *map(str, counts), *map(str, wrong)))
    return page.table(body, "lr")


def _refusals(result: ExtremeCases, page: Page) -> list[str]:
    if not result.refusals:
        return []
    held = sum(r.held for r in result.refusals)
    title = f"Input that cannot be used: {held} of {len(result.refusals)} refused with argument and index named"
    answered = [f"{r.method}, {r.what} ({r.place}): {r.answer}" for r in result.refusals if not r.held]
    return [*page.hanging(title), *(line for sentence in answered for line in page.item(sentence))]


def _errors(result: ExtremeCases, page: Page) -> list[str]:
    raised = {(row.method, row.failure) for row in result.rows if row.failure is not None}
    return page.items("Errors raised", [f"{method}: {failure}" for method, failure in sorted(raised, key=str)])
