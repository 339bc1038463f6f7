"""The text report: what was asked, what was decided and how, the counterexamples, the conclusion, what was left out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from decimal import Context
from fractions import Fraction
from textwrap import wrap
from typing import TYPE_CHECKING

from duhem.expression.text import formula
from duhem.law.curve_law import ParametricCriterion
from duhem.proof.verdict import Verdict, Witness

if TYPE_CHECKING:
    from duhem.law.curve_law import Law
    from duhem.proof.verification import ClaimResult, Verification

__all__ = ["complete", "interrupted"]

WIDTH = 96
_TIED = "\N{NO-BREAK SPACE}"  # keeps what belongs together on one line
_DIGITS = Context(prec=8)
_FIELD = len("parameters")
_STANDARD = ("origin", "convexity", "normality")


def complete(verification: Verification) -> str:
    """The report of a finished run."""
    parts = [
        [*_head(verification.criterion)],
        [*_table(verification.results)],
        [*_arguments(verification.results)],
        [*_conclusion(verification)],
        [*_items("Left out", [f"{x.part}: {x.reason}" for x in verification.left_out])],
        [*_items("Remarks", verification.remarks)],
    ]
    return _join(parts)


def interrupted(law: Law, results: Sequence[ClaimResult]) -> str:
    """The report of a run that was stopped: the claims decided so far, and no conclusion."""
    note = f"Interrupted after {len(results)} claim{'s' * (len(results) != 1)}: nothing is concluded."
    return _join([[*_head(law)], [*_table(results)], [*_arguments(results)], [note]])


def _join(parts: Sequence[Sequence[str]]) -> str:
    return "\n\n".join("\n".join(line.rstrip() for line in part) for part in parts if part)


def _head(law: Law) -> Iterator[str]:
    yield from _hanging("", f"{law.name}: {law.summary}" if law.summary else law.name)
    yield from _titled(*_stated(law))
    pressure = f"; pressure {law.pressure} <= 0 in compression, frozen" if law.pressure else "; no pressure"
    yield from _titled("forces", _FIELD, ", ".join(law.forces) + pressure)
    yield from _titled("parameters", _FIELD, ", ".join(_in_domain(n, d.describe()) for n, d in law.parameters.items()) or "none")
    if law.constraints:
        yield from _titled("with", _FIELD, ", ".join(formula(c) for c in law.constraints))
    direction = "normal to the boundary (associated)" if law.flow is None else f"({', '.join(formula(c) for c in law.flow)})"
    yield from _titled("slip", _FIELD, direction)
    if law.source:
        yield from _titled("source", _FIELD, law.source)


def _stated(law: Law) -> tuple[str, int, str]:
    """What bounds K: the formula, or the curve at |pressure| = 1."""
    if isinstance(law, ParametricCriterion):
        return "boundary", _FIELD, f"|{law.pressure}| ({', '.join(formula(x) for x in law.boundary)}), {law.angle} from 0 to 2 pi"
    return "criterion", _FIELD, f"{formula(law.g)} <= 0"


def _in_domain(name: str, domain: str) -> str:
    if domain.startswith("="):
        return f"{name} {_number_in_words(domain[1:].strip())}".replace(" ", _TIED)
    return f"{name} in {domain}" if domain[0] in "[(" else f"{name} {domain}"


def _table(results: Sequence[ClaimResult]) -> Iterator[str]:
    rows = [("claim", "verdict", "method", "scope", "time")]
    rows += [(r.claim, _words(r.verdict), r.method, r.scope, f"{r.seconds:.2f} s") for r in results]
    widths = [max(len(row[i]) for row in rows) for i in range(4)]
    for i, row in enumerate(rows):
        yield "  ".join([*(cell.ljust(width) for cell, width in zip(row[:4], widths, strict=True)), row[4].rjust(7)])
        if i == 0:
            yield "  ".join("-" * width for width in (*widths, 7))


def _arguments(results: Sequence[ClaimResult]) -> Iterator[str]:
    """Why each verdict holds, with the counterexample of what is refuted."""
    width = max((len(r.claim) for r in results), default=0)
    for result in results:
        yield from _titled(result.claim, width, result.detail)
        if result.witness is not None:
            yield from _witness(result.witness, " " * (width + 6))


def _witness(witness: Witness, indent: str) -> Iterator[str]:
    if witness.parameters:
        yield from _hanging(indent, f"counterexample at {_coordinates(witness.parameters)}")
    for role, point in witness.points.items():
        yield from _hanging(indent, f"{role}: {_coordinates(point)}")
    for name, (low, high) in witness.values.items():
        yield from _hanging(indent, f"{name} = {low}" if low == high else f"{name} in [{low}, {high}]")
    for name, measure in witness.measures.items():
        yield from _hanging(indent, f"{name.replace('_', ' ')} {measure:.6g}")
    yield from _hanging(indent, witness.statement)


def _coordinates(point: Mapping[str, str]) -> str:
    return ", ".join(f"{name} {_number_in_words(value)}".replace(" ", _TIED) for name, value in point.items())


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


def _conclusion(verification: Verification) -> Iterator[str]:
    verdicts = {r.claim: r.verdict for r in verification.results}
    yield "Conclusion"
    yield from _answer("generalized standard", verification.generalized_standard, verdicts, _STANDARD)
    yield from _answer("dissipative", verification.dissipative, verdicts, ("dissipation",))


def _answer(title: str, answer: bool | None, verdicts: Mapping[str, Verdict], claims: Sequence[str]) -> Iterator[str]:
    if answer:
        reason = f"{_and(claims)} proved"
    elif answer is False:
        reason = f"{_and([c for c in claims if verdicts.get(c) is Verdict.REFUTED])} refuted"
    else:
        reason = "; ".join(
            f"{c} {_words(verdicts[c]) if c in verdicts else 'not asked for'}" for c in claims if verdicts.get(c) != Verdict.PROVED
        )
    word = {True: "yes", False: "no", None: "not decided"}[answer]
    yield from _hanging("  ", f"{title}: {word} ({reason})")


def _items(title: str, items: Sequence[str]) -> Iterator[str]:
    if items:
        yield title
    for item in items:
        yield from _hanging("  ", item)


def _words(verdict: Verdict) -> str:
    return str(verdict).replace("_", " ")


def _and(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else "a claim"


def _titled(title: str, width: int, text: str) -> Iterator[str]:
    yield from _wrapped(text, f"  {title:<{width}}  ", " " * (width + 4))


def _hanging(indent: str, text: str) -> Iterator[str]:
    yield from _wrapped(text, indent, f"{indent}    ")


def _wrapped(text: str, first: str, rest: str) -> Iterator[str]:
    lines = wrap(text, WIDTH, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False, break_long_words=False)
    return (line.replace(_TIED, " ") for line in lines)
