"""A finished verification as chapters of a page: the law, the verdicts, why each holds, remarks, what was left out, the certificate."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from duhem.left_out import LeftOut
from duhem.proof.claims import CLAIMS
from duhem.proof.in_words import HEAD, conclusion, row, sentences
from duhem.proof.verdict import Trust, Verdict
from duhem.proof.verification import ClaimResult, Verification
from duhem.show.document import Block, Chapter, Columns, Paragraph, Sentences, Titled
from duhem.show.printing import sheet

__all__ = ["certified", "decided", "left_aside", "stated"]

_RESTS_ON = {
    Trust.CHECKED: "confirmed by the kernel, which reads the law's text and knows no prover",
    Trust.SOLVER: "a solver's word stands for a step of it",
    Trust.PROVER: "the kernel has no rule for its argument",
}


def stated(verification: Verification) -> Chapter:
    """The law as it was verified, and the effort where it was another than usual."""
    effort = (("effort", verification.effort),) if verification.effort != "normal" else ()
    return Chapter("The law", (Titled(sheet(verification.criterion).fields + effort),))


def decided(verification: Verification) -> tuple[Chapter, ...]:
    """The conclusion with the table of verdicts, and the argument for each with the witness of what is refuted."""
    kinds = tuple(result.verdict.value for result in verification.results)
    answers = zip(conclusion(verification), (verification.generalized_standard, verification.dissipative), strict=True)
    said = [Paragraph(sentence, f"answer {_kind(answer)}") for sentence, answer in answers]
    table = Columns(HEAD, tuple(map(row, verification.results)), kinds, HEAD.index("verdict"))
    why = tuple(Chapter(result.claim, tuple(_argument(result))) for result in verification.results)
    return Chapter("Verdicts", (*said, table)), Chapter("Why", why)


def left_aside(verification: Verification, more: Iterable[LeftOut] = ()) -> tuple[Chapter, ...]:
    """Remarks, and what was not examined, or else ``more`` that was not done, with the reason."""
    left = tuple(dict.fromkeys(map(str, (*verification.left_out, *more))))
    found = (("Remarks", verification.remarks), ("Left out", left))
    return tuple(Chapter(title, (Sentences(said),)) for title, said in found if said)


def certified(document: Mapping[str, Any]) -> Chapter:
    """What a certificate holds: its hash, and the rule by which the kernel confirms each claim, or why it does not."""
    trusts = [None if claim["trust"] is None else Trust(claim["trust"]) for claim in document["claims"]]
    rows = tuple(
        (c["claim"], c["verdict"].replace("_", " "), c["rule"] or "", "" if trust is None else f"{trust}: {_RESTS_ON[trust]}")
        for c, trust in zip(document["claims"], trusts, strict=True)
    )
    about = [("schema", document["schema"]), ("sha256", document["sha256"])]
    if document["inhabited"]:
        about.append(("not empty at", ", ".join(f"{name} = {value}" for name, value in document["inhabited"].items())))
    how = Paragraph("Write it with duhem verify LAW --certificate FILE; duhem recheck FILE confirms it with the kernel alone.")
    return Chapter("Certificate", (Titled(tuple(about)), Columns(("claim", "verdict", "rule of the kernel", "rests on"), rows), how))


def _argument(result: ClaimResult) -> Iterator[Block]:
    yield Paragraph(CLAIMS[result.claim].statement, "statement")
    yield Paragraph(result.detail)
    if result.witness is not None:
        yield Sentences(tuple(sentences(result.witness)))


def _kind(answer: bool | None) -> str:
    return {True: Verdict.PROVED, False: Verdict.REFUTED, None: Verdict.UNDECIDED}[answer].value
