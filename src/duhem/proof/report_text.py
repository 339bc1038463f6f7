"""The text report: what was asked, what was decided and how, the counterexamples, the conclusion, what was left out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from decimal import Context
from fractions import Fraction
from typing import TYPE_CHECKING

from duhem.expression.text import formula
from duhem.law.curve_law import ParametricCriterion
from duhem.law.yield_surface import YieldSurface
from duhem.proof.verdict import Trust, Verdict, Witness
from duhem.show.page import PAGE, Page, tied

if TYPE_CHECKING:
    from duhem.law.curve_law import Law
    from duhem.proof.verification import ClaimResult, Verification

__all__ = ["complete", "interrupted"]

_DIGITS = Context(prec=8)
_FIELD = len("parameters")
_STANDARD = ("origin", "convexity", "normality")


def complete(verification: Verification, page: Page = PAGE) -> str:
    """The report of a finished run."""
    return page.report(
        [
            [*_head(verification.criterion, page, verification.effort)],
            _table(verification.results, page),
            [*_arguments(verification.results, page)],
            [*_conclusion(verification, page)],
            page.items("Left out", verification.left_out),
            page.items("Remarks", verification.remarks),
        ]
    )


def interrupted(law: Law, results: Sequence[ClaimResult], page: Page = PAGE, effort: str = "normal") -> str:
    """The report of a run that was stopped: the claims decided so far, and no conclusion."""
    note = f"Interrupted after {len(results)} claim{'s' * (len(results) != 1)}: nothing is concluded."
    return page.report([[*_head(law, page, effort)], _table(results, page), [*_arguments(results, page)], [note]])


def _head(law: Law, page: Page, effort: str) -> Iterator[str]:
    yield from page.hanging(f"{law.name}: {law.summary}" if law.summary else law.name)
    yield from page.field(*_stated(law), _FIELD)
    pressure = f"; pressure {law.pressure} <= 0 in compression, frozen" if law.pressure else "; no pressure"
    yield from page.field("forces", ", ".join(law.forces) + pressure, _FIELD)
    yield from page.field("parameters", ", ".join(_in_domain(n, d.describe()) for n, d in law.parameters.items()) or "none", _FIELD)
    if not isinstance(law, ParametricCriterion) and law.domain:
        yield from page.field("asked for", ", ".join(d.stated(n) for n, d in law.domain.items()), _FIELD)
    if law.constraints:
        yield from page.field("with", ", ".join(formula(c) for c in law.constraints), _FIELD)
    yield from page.field("slip", _direction(law), _FIELD)
    if law.source:
        yield from page.field("source", law.source, _FIELD)
    if effort != "normal":
        yield from page.field("effort", effort, _FIELD)


def _direction(law: Law) -> str:
    if law.associated:
        return "normal to the boundary (associated)"
    if isinstance(law, ParametricCriterion) or not law.surfaces:
        return _slip(law)
    return "any sum of: " + "; ".join(f"{_slip(surface)} where {formula(surface.g)} = 0" for surface in law.surfaces)


def _slip(stated: Law | YieldSurface) -> str:
    if not isinstance(stated, ParametricCriterion) and stated.potential is not None:
        return f"gradient of {' '.join(stated.potential.split())}"
    return "normal" if stated.flow is None else f"({', '.join(formula(c) for c in stated.flow)})"


def _stated(law: Law) -> tuple[str, str]:
    """What bounds K: the formula, or the curve at |pressure| = 1."""
    if isinstance(law, ParametricCriterion):
        return "boundary", f"|{law.pressure}| ({', '.join(formula(x) for x in law.boundary)}), {law.angle} from 0 to 2 pi"
    return "criterion", f"{formula(law.g)} <= 0"


def _in_domain(name: str, domain: str) -> str:
    if domain.startswith("="):
        return tied(f"{name} {_number_in_words(domain[1:].strip())}")
    return f"{name} in {domain}" if domain[0] in "[(" else f"{name} {domain}"


def _table(results: Sequence[ClaimResult], page: Page) -> list[str]:
    rows = [("claim", "verdict", "trust", "method", "scope", "   time")]
    rows += [(r.claim, _words(r.verdict), r.trust or "", r.method, _scope(r.scope), f"{r.seconds:.2f} s") for r in results]
    return page.table(rows, "lllllr", "", rule=True)


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
    return ", ".join(tied(f"{name} {_number_in_words(value)}") for name, value in point.items())


def _number_in_words(exact: str) -> str:
    """A rational in decimals and exactly: ``= 0.15 = 3/20``, or ``~ 0.33333333 = 1/3`` where decimals do not end."""
    try:
        fraction = Fraction(exact)
    except (ValueError, ZeroDivisionError):
        return f"= {exact}"
    if fraction.denominator == 1:
        return f"= {exact}"
    decimal = _DIGITS.divide(*(_DIGITS.create_decimal(x) for x in fraction.as_integer_ratio()))
    return f"{'=' if Fraction(decimal) == fraction else '~'} {decimal} = {exact}"


def _conclusion(verification: Verification, page: Page) -> Iterator[str]:
    found = {r.claim: r for r in verification.results}
    yield "Conclusion"
    yield from page.item(_answer("generalized standard", verification.generalized_standard, found, _STANDARD))
    if verification.vacuous and "dissipation" in found:
        yield from page.item("dissipative: vacuous (no boundary point at which anything could slip: see the remarks)")
    else:
        yield from page.item(_answer("dissipative", verification.dissipative, found, ("dissipation",)))


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
