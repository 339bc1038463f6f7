"""What a campaign found, counted line by line: verdicts, methods, time, the rows that deserve a look and what repeats them.

It is shown as text, as a sheet and as plain values; its picture is of :mod:`duhem.screening.plane`.
"""

from __future__ import annotations

import json
import shlex
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import path
from typing import Any, ClassVar

from duhem.screening.campaign import Campaign, Claimed, VerdictLine, counted
from duhem.show.page import PAGE, Page, tied
from duhem.show.printing import Sheet, Shown, plain, sheet, text

__all__ = ["AGAINST", "Counts", "Summary", "alone", "as_dict", "as_sheet", "as_text"]

AGAINST = ("refuted", "flagged", "failed", "xpassed", "wrong")
_OPEN = ("undecided", "tested")
_NAMED = 3  # rows of a kind
_REASONS = 50  # that are counted each by itself
_WORDS = 160  # characters of one
_QUIET = ("proved", "by_construction", "not_applicable", "ok", "passed", "xfailed", "none")
_ORDER = (
    "proved", "refuted", "tested", "undecided", "ok", "flagged", "wrong", "passed", "failed", "xfailed", "xpassed",
    "by_construction", "not_applicable", "none",
)  # fmt: skip
_MOST = 12  # methods and reasons that are listed
_CLAIMS = 20  # that are listed each by itself, whatever was found


@dataclass(frozen=True, repr=False)
class Summary(Shown):
    """Of ``rows`` rows: how many lines have which (claim, verdict), and (claim, method) with the number of lines, seconds and the most.

    ``errors`` counts rows by reason; ``slowest`` are a few lines of such rows, ``open`` of what is undecided or only tested,
    ``against`` of failed checks and of flagged or wrong increments, ``failed`` of rows without a verdict; ``commands`` what repeats each of
    them alone, by its number, but for rows without values to be asked with.  ``table`` is where the lines are, or None; ``lines`` holds
    them where there is no table.  ``stood`` says that the table was there, whole, and nothing was asked.
    """

    printed_by: ClassVar[str] = "duhem.screening.plane"  # the picture; what else shows it stands below

    rows: int
    seconds: float
    verdicts: Mapping[tuple[str, str], int]
    methods: Mapping[tuple[str, str], tuple[int, float, float]]
    errors: Mapping[str, int]
    slowest: tuple[VerdictLine, ...]
    open: tuple[VerdictLine, ...]
    against: tuple[VerdictLine, ...]
    failed: tuple[VerdictLine, ...]
    commands: Mapping[int, str]
    table: str | None = None
    lines: tuple[VerdictLine, ...] = ()
    stood: bool = False

    def __repr__(self) -> str:
        said = Counter[str]()
        for (_, verdict), count in self.verdicts.items():
            said[verdict] += count
        return f"<Summary of {counted(self.rows, 'row')}: {', '.join(f'{count} {verdict}' for verdict, count in said.items()) or 'none'}>"

    def plot(self, file: Any = None, *, axes: Sequence[str] | None = None) -> Any:
        """Draw verdicts over one or two parameters, a panel a claim, into ``file``, a name or stream; matplotlib's axes (extra ``plot``).

        ``axes`` names the parameters; left out, those that vary.  Raises InputError where these are none or more than two, or no row has
        such a number, MissingExtraError without matplotlib.
        """
        from duhem.show.printing import draw

        return draw(self, file, axes=axes)

    @property
    def refuted(self) -> int:
        """How many lines speak against their law or what was tested: refuted claims, failed checks, flagged or wrong increments."""
        return sum(count for (_, verdict), count in self.verdicts.items() if verdict in AGAINST)


class Counts:
    """Counts lines as they pass; as much memory for many as for few."""

    def __init__(self, campaign: Campaign) -> None:
        self.campaign = campaign
        self._verdicts = Counter[tuple[str, str]]()
        self._methods = dict[tuple[str, str], tuple[int, float, float]]()
        self._errors = Counter[str]()
        self._slowest = list[VerdictLine]()  # of each row the slowest line
        self._open, self._against, self._failed = list[VerdictLine](), list[VerdictLine](), list[VerdictLine]()
        self._seconds, self._last = 0.0, 0

    def passing(self, lines: Iterator[VerdictLine]) -> Iterator[VerdictLine]:
        for line in lines:
            self._take(line)
            yield line

    def _take(self, line: VerdictLine) -> None:
        self._seconds += line.seconds
        self._verdicts[line.claim, line.counts_as] += 1
        if line.method is not None:
            count, total, most = self._methods.get((line.claim, line.method), (0, 0.0, 0.0))
            self._methods[line.claim, line.method] = count + 1, total + line.seconds, max(most, line.seconds)
        if line.error is not None:
            if line.row != self._last:
                self._errors[self._reason(line.error)] += 1
                _keep(self._failed, line)
        elif line.verdict in _OPEN:
            _keep(self._open, line)
        elif line.verdict in AGAINST[1:]:  # what is refuted is of the law, and the table has it
            _keep(self._against, line)
        if len(self._slowest) < _NAMED or line.seconds > self._slowest[-1].seconds:
            self._keep_slowest(line)
        self._last = line.row

    def _keep_slowest(self, line: VerdictLine) -> None:
        """Among the slowest, at most one line a row; of lines alike the first."""
        others = [each for each in self._slowest if each.row != line.row]
        if len(others) == len(self._slowest) or all(each.seconds < line.seconds for each in self._slowest if each.row == line.row):
            self._slowest = sorted([*others, line], key=lambda each: -each.seconds)[:_NAMED]

    def _reason(self, error: str) -> str:
        """An error by its first words; no more of them are told apart than are of use."""
        reason = error if len(error) <= _WORDS else f"{error[:_WORDS]} ..."
        return reason if reason in self._errors or len(self._errors) < _REASONS else "other reasons"

    def summary(self, table: str | None = None, lines: tuple[VerdictLine, ...] = (), stood: bool = False) -> Summary:
        named = {line.row for line in (*self._slowest, *self._open, *self._against, *self._failed)}
        return Summary(
            rows=len(self.campaign),
            seconds=self._seconds,
            verdicts=dict(self._verdicts),
            methods=dict(self._methods),
            errors=dict(self._errors),
            slowest=tuple(self._slowest),
            open=tuple(self._open),
            against=tuple(self._against),
            failed=tuple(self._failed),
            commands={number: alone(self.campaign, number) for number in sorted(named) if not self.campaign.row(number).fault},
            table=table,
            lines=lines,
            stood=stood,
        )


def _keep(lines: list[VerdictLine], line: VerdictLine) -> None:
    """Among the first few of its kind."""
    if len(lines) < _NAMED:
        lines.append(line)


def alone(campaign: Campaign, number: int) -> str:
    """The command that asks one row alone; for a law that is a value in a program, the call."""
    inquiry = campaign.inquiry
    if not isinstance(inquiry, Claimed):
        command = ["duhem", "campaign", *campaign.inputs[:1], f"--row={number}", *inquiry.options]
        return shlex.join(command) if campaign.inputs else f"row {number} alone"
    row, claims = campaign.row(number), inquiry.names
    if row.name.value is not None and row.name.path is None:
        return f"duhem.verify({row.name.shown!r}, {json.dumps(dict(row.values))}, claims={list(claims)!r})"
    law = row.name.shown if row.name.path is None else path.relpath(row.name.path)
    fixed = [f"--set={name}={value}" for name, value in row.values.items()]
    effort = [f"--effort={inquiry.effort}"] if inquiry.effort != "normal" else []
    return shlex.join(["duhem", "verify", law, *fixed, "--claims", ",".join(claims), *effort])


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
        once = f": {written(summary.commands[line.row])}" if line.row in summary.commands else ", which has no values of parameters"
        yield f"{why}: row {line.row}, {line.claim}, {line.seconds:.3f} s{once}"
