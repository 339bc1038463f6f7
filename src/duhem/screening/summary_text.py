"""A campaign's summary for people and as plain values: verdicts, methods, time, the rows that deserve a look and what repeats them."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from duhem.screening.lines import VerdictLine
from duhem.screening.rows import counted
from duhem.screening.summary import Summary
from duhem.show.page import PAGE, Page, tied
from duhem.show.printing import plain, sheet, text
from duhem.show.sheet import Sheet

__all__ = ["as_dict", "as_sheet", "as_text"]

_QUIET = ("proved", "not_applicable", "ok", "passed", "xfailed", "none")
_ORDER = (
    "proved",
    "refuted",
    "tested",
    "undecided",
    "ok",
    "flagged",
    "wrong",
    "passed",
    "failed",
    "xfailed",
    "xpassed",
    "not_applicable",
    "none",
)
_MOST = 12  # methods and reasons that are listed
_CLAIMS = 20  # that are listed each by itself, whatever was found


@text.register(Summary)
def as_text(summary: Summary, page: Page = PAGE) -> str:
    """The summary; a row is named by its number, which the table has too."""
    return page.report(
        [
            [_title(summary)],
            page.table([*_verdicts(summary)], "lr"),
            page.table([*_methods(summary)], "llr") if summary.methods else [],
            page.items("Without verdict", _reasons(summary)),
            page.items("Rows to look at", _named(summary, tied)),
        ]
    )


@sheet.register(Summary)
def as_sheet(summary: Summary) -> Sheet:
    """The verdicts as a table, a row a claim; methods, reasons and rows to look at as notes."""
    head, *rows = _verdicts(summary)
    methods = tuple(f"{claim}, {method}: {seconds} s, lines: {lines}" for claim, method, lines, seconds, *_ in [*_methods(summary)][1:])
    notes = (("Methods", methods), ("Without verdict", tuple(_reasons(summary))), ("Rows to look at", tuple(_named(summary, str))))
    return Sheet(_title(summary), head=tuple(head), rows=tuple(map(tuple, rows)), notes=notes)


@plain.register(Summary)
def as_dict(summary: Summary) -> dict[str, Any]:
    """Counts and lines; of a line the parameters and the witness as values, where the table has them as JSON text."""
    methods = [
        {"claim": claim, "method": method, "lines": lines, "seconds": seconds, "most": most}
        for (claim, method), (lines, seconds, most) in summary.methods.items()
    ]
    verdicts: dict[str, dict[str, int]] = {}
    for (claim, verdict), count in summary.verdicts.items():
        verdicts.setdefault(claim, {})[verdict] = count
    return {
        "rows": summary.rows,
        "seconds": summary.seconds,
        "table": summary.table,
        "verdicts": verdicts,
        "methods": methods,
        "errors": dict(summary.errors),
        **{name: list(map(_line, getattr(summary, name))) for name in ("slowest", "open", "against", "failed", "lines")},
        "commands": {str(row): command for row, command in summary.commands.items()},
    }


def _line(line: VerdictLine) -> dict[str, Any]:
    witness = None if line.witness is None else json.loads(line.witness)
    return line._asdict() | {"parameters": json.loads(line.parameters), "witness": witness}


def _title(summary: Summary) -> str:
    finished = ", which is finished: nothing left to do" if summary.stood else ""
    table = f"; {summary.table}{finished}" if summary.table else ""
    return f"{counted(summary.rows, 'row')}, {summary.seconds:.1f} s in all{table}"


def _said(verdict: str | None) -> str:
    return "no verdict" if verdict in (None, "none") else str(verdict).replace("_", " ")


def _verdicts(summary: Summary) -> Iterator[Sequence[str]]:
    met = [v for v in _ORDER if any(verdict == v for _, verdict in summary.verdicts)]
    yield ["claim", *map(_said, met)]
    claims = tuple(dict.fromkeys(claim for claim, _ in summary.verdicts))
    told = {claim for claim, verdict in summary.verdicts if verdict not in _QUIET} if len(claims) > _CLAIMS else set(claims)
    for claim in (claim for claim in claims if claim in told):
        yield [claim, *(f"{summary.verdicts.get((claim, v), 0)}" for v in met)]
    if others := [claim for claim in claims if claim not in told]:
        counts = (sum(summary.verdicts.get((claim, v), 0) for claim in others) for v in met)
        yield [f"{len(others)} others" if told else f"{len(others)} names", *(f"{count}" for count in counts)]


def _methods(summary: Summary) -> Iterator[Sequence[str]]:
    yield ["claim", "method", "lines", "seconds", "mean", "most"]
    ordered = sorted(summary.methods.items(), key=lambda item: (-item[1][1], item[0]))
    for (claim, method), (count, total, most) in ordered[:_MOST]:
        yield [claim, method, f"{count}", f"{total:.2f}", f"{total / count:.4f}", f"{most:.4f}"]


def _reasons(summary: Summary) -> Iterator[str]:
    for reason, count in sorted(summary.errors.items(), key=lambda item: (-item[1], item[0]))[:_MOST]:
        yield f"{counted(count, 'row')}: {reason}"


def _named(summary: Summary, written: Callable[[str], str]) -> Iterator[str]:
    """Some rows with the command that repeats each, as ``written`` writes it; what came out is said in the words of the table's head."""
    slowest = [("slowest", line) for line in summary.slowest]
    others = [(_said(line.verdict), line) for line in (*summary.open, *summary.against, *summary.failed)]
    for why, line in slowest + others:
        once = f": {written(summary.commands[line.row])}" if line.row in summary.commands else ", which has no values to be asked with"
        yield f"{why}: row {line.row}, {line.claim}, {line.seconds:.3f} s{once}"
