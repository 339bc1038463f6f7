"""The report as text or as a sheet: what was asked, what was decided and how, the counterexamples, the conclusion, what was left out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from duhem.law.stated import stated
from duhem.proof.in_words import HEAD, conclusion, row, sentences
from duhem.proof.verdict import ClaimResult, Witness
from duhem.proof.verification import Verification
from duhem.show.page import PAGE, Page
from duhem.show.printing import sheet, text
from duhem.show.sheet import Sheet

if TYPE_CHECKING:
    from duhem.law.curve_law import Law

__all__ = ["as_sheet", "as_sheet_of_claim", "as_sheet_of_witness", "complete", "interrupted"]

_FIELD = len("parameters")


@text.register(Verification)
def complete(verification: Verification, page: Page = PAGE) -> str:
    """The report of a finished run."""
    return page.report(
        [
            [*_head(verification.criterion, page, verification.effort)],
            _table(verification.results, page),
            [*_arguments(verification.results, page)],
            page.items("Conclusion", conclusion(verification)),
            page.items("Left out", verification.left_out),
            page.items("Remarks", verification.remarks),
        ]
    )


@sheet.register(Verification)
def as_sheet(verification: Verification) -> Sheet:
    """The same as a sheet: the law's own with the table of verdicts below, then the arguments, counterexamples and conclusion."""
    law = sheet(verification.criterion)
    refuted = [(f"Counterexample: {r.claim}", tuple(sentences(r.witness))) for r in verification.results if r.witness is not None]
    head, *rows = _rows(verification.results)
    return Sheet(
        title=law.title,
        fields=law.fields + ((("effort", verification.effort),) if verification.effort != "normal" else ()),
        head=head,
        rows=tuple(rows),
        notes=(
            ("Conclusion", conclusion(verification)),
            ("Arguments", tuple(f"{r.claim}: {r.detail}" for r in verification.results)),
            *refuted,
            ("Left out", tuple(map(str, verification.left_out))),
            ("Remarks", verification.remarks),
        ),
    )


@sheet.register(ClaimResult)
def as_sheet_of_claim(result: ClaimResult) -> Sheet:
    """One row of the table by itself, with its argument and what refutes it."""
    head, cells = _rows([result])
    fields = tuple((title.strip(), cell.strip()) for title, cell in zip(head[2:], cells[2:], strict=True) if cell)
    against = () if result.witness is None else sheet(result.witness).notes
    return Sheet(f"{cells[0]}: {cells[1]}", fields, notes=(("Argument", (result.detail,)), *against))


@sheet.register(Witness)
def as_sheet_of_witness(witness: Witness) -> Sheet:
    """What violates the claim, in sentences with every number exact."""
    return Sheet("Counterexample", notes=(("Counterexample", tuple(sentences(witness))),))


def interrupted(law: Law, results: Sequence[ClaimResult], page: Page = PAGE, effort: str = "normal") -> str:
    """The report of a run that was stopped: the claims decided so far, and no conclusion."""
    note = f"Interrupted after {len(results)} claim{'s' * (len(results) != 1)}: nothing is concluded."
    return page.report([[*_head(law, page, effort)], _table(results, page), [*_arguments(results, page)], [note]])


def _head(law: Law, page: Page, effort: str) -> Iterator[str]:
    yield from page.hanging(f"{law.name}: {law.summary}" if law.summary else law.name)
    for title, content in stated(law):
        yield from page.field(title, content, _FIELD)
    if effort != "normal":
        yield from page.field("effort", effort, _FIELD)


def _table(results: Sequence[ClaimResult], page: Page) -> list[str]:
    return page.table(_rows(results), "lllllr", "", rule=True)


def _rows(results: Sequence[ClaimResult]) -> list[tuple[str, ...]]:
    *head, time = HEAD
    return [(*head, f"   {time}"), *map(row, results)]


def _arguments(results: Sequence[ClaimResult], page: Page) -> Iterator[str]:
    """Why each verdict holds, with the counterexample of what is refuted."""
    width = max((len(r.claim) for r in results), default=0)
    for result in results:
        yield from page.field(result.claim, result.detail, width)
        if result.witness is not None:
            for sentence in sentences(result.witness):
                yield from page.item(sentence, " " * (width + 6))
