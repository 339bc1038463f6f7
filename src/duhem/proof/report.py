"""A verification told: verdicts as rows, witnesses in sentences and the conclusion, as text, sheet, chapters of a page or JUnit suite."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from duhem.law.frozen_mapping import FrozenMapping
from duhem.law.law_sheet import number_in_short, number_in_words, units_in_words
from duhem.law.law_sheet import stated as stated_law
from duhem.omitted import LeftOut
from duhem.proof.claims import EVERY
from duhem.proof.verdict import ClaimResult, Trust, Verdict, Witness
from duhem.proof.verification import Verification
from duhem.show.document import Block, Chapter, Columns, Paragraph, Sentences, Titled
from duhem.show.junit import JUnitCase, JUnitSuite, Outcome
from duhem.show.page import PAGE, Page, tied
from duhem.show.printing import Sheet, sheet, text
from duhem.version import __version__

__all__ = [
    "as_sheet", "as_sheet_of_claim", "as_sheet_of_witness", "as_suite", "as_text", "certified", "decided", "left_aside", "sentences",
    "stated",
]  # fmt: skip

_HEAD = ("claim", "verdict", "trust", "method", "scope", "time")
_FIELD = len("parameters")
_RATES = "the rates without a multiplier are not shown to derive from a potential"
_RESTS_ON = {
    Trust.CHECKED: "the kernel, a small program that uses no other part of duhem, confirmed the proof from the formula of the law",
    Trust.SOLVER: "one step of the proof relied on an SMT result that nothing else has checked; this version makes no such proof",
    Trust.PROVER: "the kernel has no rule for this argument, so the proof relies on the method that is named",
}


@text.register(Verification)
def as_text(verification: Verification, page: Page = PAGE) -> str:
    """What was asked, what was decided and how, the counterexamples, the conclusion, what was left out."""
    law, results = verification.criterion, verification.results
    head = page.hanging(f"{law.name}: {law.summary}" if law.summary else law.name)
    about = [line for field in (*stated_law(law), *_effort(verification)) for line in page.field(*field, _FIELD)]
    *titles, time = _HEAD
    table = page.table([(*titles, f"   {time}"), *map(_row, results)], "lllllr", "", rule=True)
    end = [
        page.items("Trust", _trusts(results)),
        page.items("Conclusion", _conclusion(verification)),
        page.items("Coupled", _coupled(verification)),
        page.items("Omitted", verification.left_out),
        page.items("Remarks", verification.remarks),
    ]
    if verification.interrupted:
        end = [[f"Interrupted after {len(results)} claim{'s' * (len(results) != 1)}: there is no conclusion."]]
    return page.report([[*head, *about], table, [*_arguments(results, page)], *end])


def _arguments(results: Sequence[ClaimResult], page: Page) -> Iterator[str]:
    """Why each verdict holds, with the counterexample of what is refuted."""
    width = max((len(r.claim) for r in results), default=0)
    for result in results:
        yield from page.field(result.claim, result.detail, width)
        for sentence in _opening(result):
            yield from page.item(sentence, " " * (width + 4))
        for sentence in sentences(result.witness):
            yield from page.item(sentence, " " * (width + 6))


@sheet.register(Verification)
def as_sheet(verification: Verification) -> Sheet:
    """The same as a sheet: the law's own with the table of verdicts below, then the arguments, counterexamples and conclusion."""
    law, results = sheet(verification.criterion), verification.results
    notes = (
        ("Trust", _trusts(verification.results)),
        ("Conclusion", _conclusion(verification)),
        *((("Coupled", said),) if (said := _coupled(verification)) else ()),
        ("Arguments", tuple(f"{r.claim}: {r.detail}" for r in results)),
        *((f"Open: {r.claim}", _opening(r)) for r in results if r.unsettled is not None),
        *((f"Counterexample: {r.claim}", sentences(r.witness)) for r in results if r.witness is not None),
        ("Omitted", tuple(map(str, verification.left_out))),
        ("Remarks", verification.remarks),
    )
    *titles, time = _HEAD
    return Sheet(law.title, law.fields + _effort(verification), (*titles, f"   {time}"), tuple(map(_row, results)), notes)


@sheet.register(ClaimResult)
def as_sheet_of_claim(result: ClaimResult) -> Sheet:
    """One row of the table by itself, with its argument and what refutes it."""
    cells = _row(result)
    fields = tuple((title, cell) for title, cell in zip(_HEAD[2:], cells[2:], strict=True) if cell)
    against = () if result.witness is None else sheet(result.witness).notes
    left = (("Open", _opening(result)),) if result.unsettled is not None else ()
    return Sheet(f"{cells[0]}: {cells[1]}", fields, notes=(("Argument", (result.detail,)), *left, *against))


@sheet.register(Witness)
def as_sheet_of_witness(witness: Witness) -> Sheet:
    """What violates the claim, in sentences with every number exact."""
    return Sheet("Counterexample", notes=(("Counterexample", sentences(witness)),))


def as_suite(verification: Verification, *, strict: bool = False, expected: Mapping[str, str] = FrozenMapping()) -> JUnitSuite:
    """A case a claim: proved passes, refuted fails with its witness, open is skipped.

    With ``strict`` a claim that is neither proved nor refuted fails, unless it is not applicable.  A claim with an ``expected``
    verdict passes with that one, and fails with every other.
    """
    law = verification.criterion
    said = {f"remark {i}": remark for i, remark in enumerate(verification.remarks, 1)}
    if verification.interrupted:
        said["interrupted"] = "true"
    parameters = {f"parameter {name}": domain.describe() for name, domain in law.parameters.items()}
    properties = {"duhem": __version__, **parameters, "effort": verification.effort, **said}
    for result in verification.results:
        found = result.to_dict()
        about = {key: found[key] for key in ("verdict", "method", "trust", "scope") if found[key] is not None}
        if result.witness is not None:
            about["witness"] = json.dumps(result.witness.to_dict(), ensure_ascii=False)
        properties |= {f"{result.claim} {key}": value for key, value in about.items()}
    return JUnitSuite(law.name, tuple(_case(result, strict, expected.get(result.claim)) for result in verification.results), properties)


def _case(result: ClaimResult, strict: bool, due: str | None) -> JUnitCase:
    if result.verdict == (due or Verdict.PROVED):
        trust = f", {result.trust}" if result.trust else ""
        said = f"{_word(result.verdict)} by {result.method}{trust}; {result.scope}: {result.detail}"
        return JUnitCase(result.claim, output=said, seconds=result.seconds)
    failed = due is not None or result.verdict is Verdict.REFUTED or (strict and result.verdict is not Verdict.NOT_APPLICABLE)
    outcome = Outcome.FAILED if failed else Outcome.SKIPPED
    lines = [line for sentence in (*_opening(result), *sentences(result.witness)) for line in Page(None).hanging(sentence)]
    return JUnitCase(result.claim, outcome, f"{_word(result.verdict)}: {result.detail}", "\n".join(lines), seconds=result.seconds)


# -- chapters of a page ---------------------------------------------------------------------------------------------


def stated(verification: Verification) -> Chapter:
    """The law as it was verified, the units of its parameters, and the effort where it was another than usual."""
    units = units_in_words(verification.criterion)
    about = sheet(verification.criterion).fields + ((("units", units),) if units else ())
    return Chapter("The law", (Titled(about + _effort(verification)),))


def decided(verification: Verification) -> tuple[Chapter, ...]:
    """The conclusion with the table of verdicts, and the argument for each with the witness of what is refuted."""
    answers = zip(_conclusion(verification), (verification.generalized_standard, verification.dissipative), strict=True)
    kind = {True: Verdict.PROVED, False: Verdict.REFUTED, None: Verdict.UNDECIDED}
    said = [Paragraph(sentence, f"answer {kind[answer].value}") for sentence, answer in answers]
    kinds = tuple(result.verdict.value for result in verification.results)
    table = Columns(_HEAD, tuple(map(_row, verification.results)), kinds, _HEAD.index("verdict"))
    why = []
    for result in verification.results:
        against = tuple(Sentences(said) for said in (_opening(result), sentences(result.witness)) if said)
        argument: tuple[Block, ...] = (Paragraph(EVERY[result.claim].statement, "statement"), Paragraph(result.detail), *against)
        why.append(Chapter(result.claim, argument))
    trusts = tuple(map(Paragraph, _trusts(verification.results)))
    together = (Sentences(_coupled(verification)),) if verification.coupled else ()
    return Chapter("Verdicts", (*said, table, *trusts, *together)), Chapter("Why", tuple(why))


def left_aside(verification: Verification, more: Iterable[LeftOut] = ()) -> tuple[Chapter, ...]:
    """Remarks, and what was not examined, or else ``more`` that was not done, with the reason."""
    left = tuple(dict.fromkeys(map(str, (*verification.left_out, *more))))
    found = (("Remarks", verification.remarks), ("Omitted", left))
    return tuple(Chapter(title, (Sentences(said),)) for title, said in found if said)


def certified(document: Mapping[str, Any]) -> Chapter:
    """What a certificate holds: its hash, and the rule by which the kernel confirms each claim, or why it does not."""
    rows = tuple(
        (c["claim"], _word(c["verdict"]), c["rule"] or "", f"{c['trust']}: {_RESTS_ON[c['trust']]}" if c["trust"] else "")
        for c in document["claims"]
    )
    about = [("schema", document["schema"]), ("sha256", document["sha256"])]
    if document["inhabited"]:
        about.append(("not empty at", ", ".join(f"{name} = {value}" for name, value in document["inhabited"].items())))
    how = Paragraph("duhem verify LAW --certificate FILE writes the certificate; duhem recheck FILE checks it again with the kernel alone.")
    return Chapter("Certificate", (Titled(tuple(about)), Columns(("claim", "verdict", "rule of the kernel", "trust"), rows), how))


# -- in words -------------------------------------------------------------------------------------------------------


def _word(verdict: str) -> str:
    return str(verdict).replace("_", " ")


def _effort(verification: Verification) -> tuple[tuple[str, str], ...]:
    return (("effort", verification.effort),) if verification.effort != "normal" else ()


def _row(result: ClaimResult) -> tuple[str, ...]:
    """One result below the head; numbers of the scope are tied, and long fractions short: what a law states has them whole."""
    parts = (part.partition(" = ") for part in result.scope.split(", "))
    scope = ", ".join(tied(f"{name} {number_in_short(value)}") if equal else name for name, equal, value in parts)
    return result.claim, _word(result.verdict), result.trust or "", result.method, scope, f"{result.seconds:.2f} s"


def sentences(witness: Witness | None) -> tuple[str, ...]:
    """Parameters, points, enclosed values and measures of a witness, and last how to read them."""
    if witness is None:
        return ()
    return (
        *((f"counterexample at {_coordinates(witness.parameters)}",) if witness.parameters else ()),
        *(f"{role}: {_coordinates(point)}" for role, point in witness.points.items()),
        *(f"{name} = {low}" if low == high else f"{name} in [{low}, {high}]" for name, (low, high) in witness.values.items()),
        *(f"{name.replace('_', ' ')} {measure:.6g}" for name, measure in witness.measures.items()),
        witness.statement,
    )


def _opening(result: ClaimResult) -> tuple[str, ...]:
    """What is open, and what to try."""
    return () if result.unsettled is None else result.unsettled.sentences()


def _coordinates(point: Mapping[str, str]) -> str:
    return ", ".join(tied(f"{name} {number_in_words(value)}") for name, value in point.items())


def _trusts(results: Iterable[ClaimResult]) -> tuple[str, ...]:
    """A sentence for each trust level that a result has: what one relies on."""
    found = {result.trust for result in results}
    return tuple(f"{trust}: {meaning}" for trust, meaning in _RESTS_ON.items() if trust in found)


def _conclusion(verification: Verification) -> tuple[str, str]:
    """Whether the law is generalized standard, and dissipative, and why."""
    found = {r.claim: r for r in verification.results}
    standard = _answer("generalized standard", verification.generalized_standard, found, verification.of_standard)
    if verification.vacuous and "dissipation" in found:
        return standard, "dissipative: the claim says nothing here (the only boundary point of K is zero force, see the remarks)"
    return standard, _answer("dissipative", verification.dissipative, found, verification.of_dissipative)


def _coupled(verification: Verification) -> tuple[str, ...]:
    """What holds in forces and pressure together, if that was asked for."""
    if (found := verification.coupled) is None:
        return ()
    said = f"contact with friction as one law has the bipotential b: {_word(found.bipotential)}"
    where = "".join(f", finite only where {form} = 0" for form in found.finite_where_zero)
    closed = f"the support function of K at {verification.criterion.pressure} = -1 is Phi_1(d) = {found.support_function}{where}"
    return (said, closed, found.dilatancy) if found.dilatancy else (said,)


def _answer(title: str, answer: bool | None, found: Mapping[str, ClaimResult], claims: Sequence[str]) -> str:
    verdicts = {claim: result.verdict for claim, result in found.items()}
    if answer:
        resting = {trust: [c for c in claims if found[c].trust is trust] for trust in Trust if trust is not Trust.CHECKED}
        trusts = [f"{trust} for {_and(those)}" for trust, those in resting.items() if those]
        reason = f"{_and(claims)} proved" + (f"; trust: {', '.join(trusts)}" if trusts else "")
    elif answer is False:
        reason = f"{_and([c for c in claims if verdicts.get(c) is Verdict.REFUTED])} refuted"
    else:
        open_claims = [c for c in claims if verdicts.get(c) != Verdict.PROVED]
        reason = "; ".join(f"{c} {_word(verdicts.get(c, 'not examined'))}" for c in open_claims) or _RATES
    word = {True: "yes", False: "no", None: "not decided"}[answer]
    return f"{title}: {word} ({reason})"


def _and(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
