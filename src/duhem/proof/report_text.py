"""The report as text or as a sheet: what was asked, what was decided and how, the counterexamples, the conclusion, what was left out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from duhem.law.stated import number_in_words, stated
from duhem.proof.verdict import Trust, Verdict, Witness
from duhem.proof.verification import ClaimResult, Verification
from duhem.show.page import PAGE, Page, tied
from duhem.show.printing import sheet, text
from duhem.show.sheet import Sheet

if TYPE_CHECKING:
    from duhem.law.curve_law import Law

__all__ = ["as_sheet", "complete", "interrupted"]

_FIELD = len("parameters")
_STANDARD = ("origin", "convexity", "normality")


@text.register(Verification)
def complete(verification: Verification, page: Page = PAGE) -> str:
    """The report of a finished run."""
    return page.report(
        [
            [*_head(verification.criterion, page, verification.effort)],
            _table(verification.results, page),
            [*_arguments(verification.results, page)],
            page.items("Conclusion", _conclusion(verification)),
            page.items("Left out", verification.left_out),
            page.items("Remarks", verification.remarks),
        ]
    )


@sheet.register(Verification)
def as_sheet(verification: Verification) -> Sheet:
    """The same as a sheet: the law's own with the table of verdicts below, then the arguments, counterexamples and conclusion."""
    law = sheet(verification.criterion)
    refuted = [(f"Counterexample: {r.claim}", tuple(_witness(r.witness))) for r in verification.results if r.witness is not None]
    head, *rows = _rows(verification.results)
    return Sheet(
        title=law.title,
        fields=law.fields + ((("effort", verification.effort),) if verification.effort != "normal" else ()),
        head=head,
        rows=tuple(rows),
        notes=(
            ("Conclusion", _conclusion(verification)),
            ("Arguments", tuple(f"{r.claim}: {r.detail}" for r in verification.results)),
            *refuted,
            ("Left out", tuple(map(str, verification.left_out))),
            ("Remarks", verification.remarks),
        ),
    )


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
    rows: list[tuple[str, ...]] = [("claim", "verdict", "trust", "method", "scope", "   time")]
    return rows + [(r.claim, _words(r.verdict), r.trust or "", r.method, _scope(r.scope), f"{r.seconds:.2f} s") for r in results]


def _scope(scope: str) -> str:
    return ", ".join(tied(part) if " = " in part else part for part in scope.split(", "))


def _arguments(results: Sequence[ClaimResult], page: Page) -> Iterator[str]:
    """Why each verdict holds, with the counterexample of what is refuted."""
    width = max((len(r.claim) for r in results), default=0)
    for result in results:
        yield from page.field(result.claim, result.detail, width)
        if result.witness is not None:
            for sentence in _witness(result.witness):
                yield from page.item(sentence, " " * (width + 6))


def _witness(witness: Witness) -> Iterator[str]:
    if witness.parameters:
        yield f"counterexample at {_coordinates(witness.parameters)}"
    for role, point in witness.points.items():
        yield f"{role}: {_coordinates(point)}"
    for name, (low, high) in witness.values.items():
        yield f"{name} = {low}" if low == high else f"{name} in [{low}, {high}]"
    for name, measure in witness.measures.items():
        yield f"{name.replace('_', ' ')} {measure:.6g}"
    yield witness.statement


def _coordinates(point: Mapping[str, str]) -> str:
    return ", ".join(tied(f"{name} {number_in_words(value)}") for name, value in point.items())


def _conclusion(verification: Verification) -> tuple[str, ...]:
    found = {r.claim: r for r in verification.results}
    standard = _answer("generalized standard", verification.generalized_standard, found, _STANDARD)
    if verification.vacuous and "dissipation" in found:
        return standard, "dissipative: vacuous (no boundary point at which anything could slip: see the remarks)"
    return standard, _answer("dissipative", verification.dissipative, found, ("dissipation",))


def _answer(title: str, answer: bool | None, found: Mapping[str, ClaimResult], claims: Sequence[str]) -> str:
    verdicts = {claim: result.verdict for claim, result in found.items()}
    if answer:
        unchecked = [c for c in claims if found[c].trust is not Trust.CHECKED]
        reason = f"{_and(claims)} proved" + (f", {_and(unchecked)} not checked" if unchecked else "")
    elif answer is False:
        reason = f"{_and([c for c in claims if verdicts.get(c) is Verdict.REFUTED])} refuted"
    else:
        reason = "; ".join(
            f"{c} {_words(verdicts[c]) if c in verdicts else 'not asked for'}" for c in claims if verdicts.get(c) != Verdict.PROVED
        )
    word = {True: "yes", False: "no", None: "not decided"}[answer]
    return f"{title}: {word} ({reason})"


def _words(verdict: Verdict) -> str:
    return str(verdict).replace("_", " ")


def _and(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else "a claim"
