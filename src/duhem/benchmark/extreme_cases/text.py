"""The extreme cases as tables: for each axis decades down, methods across, and what was silently wrong."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

from duhem.benchmark.extreme_cases.cases import AXES
from duhem.benchmark.extreme_cases.stress import ExtremeCases, Tally

__all__ = ["text"]

WIDTH = 110
LEGEND = (
    "Cells: accurate digits of the stress / of the slip, the fewest of the points, at most 16. F: flagged (status inaccurate or",
    "failed, or an error raised). X: numbers that are not finite. O: outside K. !stress, !slip: silently wrong, that is fewer than",
    "6 digits of it and no flag.",
)


def text(result: ExtremeCases) -> str:
    """Axis by axis, then a summary for each method, refusals, and what was left out."""
    lines = [
        f"{result.law}: {result.subject}",
        f"reference: the optimality conditions in many digits, its own error {result.reference:.0e}",
    ]
    lines += ["", *LEGEND]
    for axis, meaning in AXES.items():
        rows = [row for row in result.rows if row.axis == axis]
        if rows:
            lines += ["", f"{axis}: {meaning}", *_axis(rows, result.methods)]
    lines += ["", "Summary", *_summary(result)]
    if result.refusals:
        held = sum(r.held for r in result.refusals)
        lines += ["", f"Input that cannot be used: {held} of {len(result.refusals)} refused with argument and index named"]
        for refusal in result.refusals:
            if not refusal.held:
                lines += wrap(
                    f"{refusal.method}, {refusal.what} ({refusal.place}): {refusal.answer}",
                    WIDTH,
                    initial_indent="  ",
                    subsequent_indent="    ",
                )
    if failures := {(row.method, row.failure) for row in result.rows if row.failure is not None}:
        lines += ["", "Errors raised"]
        for method, failure in sorted(failures, key=str):
            lines += wrap(f"{method}: {failure}", WIDTH, initial_indent="  ", subsequent_indent="    ")
    if result.left_out:
        lines += ["", "Left out"]
        for part in result.left_out:
            lines += wrap(f"{part.part}: {part.reason}", WIDTH, initial_indent="  ", subsequent_indent="    ")
    if result.interrupted:
        lines += ["", "Interrupted: this is what was done."]
    return "\n".join(lines)


def _axis(rows: Sequence[Tally], methods: Sequence[str]) -> Iterator[str]:
    labels = list(dict.fromkeys(row.label for row in rows))
    body = [("", *methods)]
    for label in labels:
        mine = {row.method: row for row in rows if row.label == label}
        body.append((label, *(_cell(mine[m]) if m in mine else "" for m in methods)))
    yield from _table(body)


def _cell(row: Tally) -> str:
    if row.failure is not None:
        return "- / -  F"
    marks = [
        "F" if row.flagged else "",
        "X" if row.finite < row.points else "",
        "O" if row.feasible < row.finite else "",
        " !stress" if row.wrong_stress else "",
        " !slip" if row.wrong_slip else "",
    ]
    return f"{row.stress_digits:4.1f} / {row.slip_digits:4.1f} {''.join(marks).lstrip()}".rstrip()


def _summary(result: ExtremeCases) -> Iterator[str]:
    body: list[tuple[str, ...]] = [("method", "points", "finite", "in K", "flagged", "silently wrong: stress", "slip")]
    for method in result.methods:
        rows = [row for row in result.rows if row.method == method]
        counts = [sum(getattr(row, name) for row in rows) for name in ("points", "finite", "feasible", "flagged")]
        wrong = result.silently_wrong[method]
        body.append((method, *map(str, counts), *map(str, wrong)))
    yield from _table(body)


def _table(rows: Sequence[tuple[str, ...]]) -> Iterator[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield ("  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))).rstrip()
