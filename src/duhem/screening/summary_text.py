"""A campaign's summary for people: verdicts, methods, time, and the rows that deserve a look with what repeats them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from duhem.screening.summary import Summary
from duhem.show.page import PAGE, Page, tied
from duhem.show.printing import text

__all__ = ["as_text"]

_ORDER = ("proved", "refuted", "tested", "undecided", "not_applicable", "ok", "flagged", "none")
_MOST = 12  # methods and reasons that are listed


@text.register(Summary)
def as_text(summary: Summary, page: Page = PAGE) -> str:
    """The summary; a row is named by its number, which the table has too."""
    return page.report(
        [
            [f"{summary.rows} rows, {summary.seconds:.1f} s in all" + (f"; {summary.table}" if summary.table else "")],
            page.table([*_verdicts(summary)], "lr"),
            page.table([*_methods(summary)], "llr") if summary.methods else [],
            page.items("Without verdict", _reasons(summary)),
            page.items("Rows to look at", _named(summary)),
        ]
    )


def _verdicts(summary: Summary) -> Iterator[Sequence[str]]:
    met = [v for v in _ORDER if any(verdict == v for _, verdict in summary.verdicts)]
    yield ["claim", *(v.replace("_", " ") if v != "none" else "no verdict" for v in met)]
    for claim in dict.fromkeys(claim for claim, _ in summary.verdicts):
        yield [claim, *(f"{summary.verdicts.get((claim, v), 0)}" for v in met)]


def _methods(summary: Summary) -> Iterator[Sequence[str]]:
    yield ["claim", "method", "lines", "seconds", "mean", "most"]
    ordered = sorted(summary.methods.items(), key=lambda item: (-item[1][1], item[0]))
    for (claim, method), (count, total, most) in ordered[:_MOST]:
        yield [claim, method, f"{count}", f"{total:.2f}", f"{total / count:.4f}", f"{most:.4f}"]


def _reasons(summary: Summary) -> Iterator[str]:
    for reason, count in sorted(summary.errors.items(), key=lambda item: (-item[1], item[0]))[:_MOST]:
        yield f"{count} {'row' if count == 1 else 'rows'}: {reason}"


def _named(summary: Summary) -> Iterator[str]:
    for why, lines in (("slowest", summary.slowest), ("open", summary.open), ("failed", summary.failed)):
        for line in lines:
            once = f": {tied(summary.commands[line.row])}" if line.row in summary.commands else ", which has no values to be asked with"
            yield f"{why}: row {line.row}, {line.claim}, {line.seconds:.3f} s{once}"
