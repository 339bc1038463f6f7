"""What was found, in sentences: verdicts as rows, witnesses with their numbers, the conclusion and what it rests on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from duhem.law.stated import number_in_short, number_in_words
from duhem.proof.verdict import Trust, Verdict, Witness
from duhem.proof.verification import ClaimResult, Verification
from duhem.show.page import tied

__all__ = ["HEAD", "conclusion", "row", "sentences", "words"]

HEAD = ("claim", "verdict", "trust", "method", "scope", "time")
_STANDARD = ("origin", "convexity", "normality")


def words(verdict: Verdict) -> str:
    """The verdict as people write it."""
    return str(verdict).replace("_", " ")


def row(result: ClaimResult) -> tuple[str, ...]:
    """One result below :data:`HEAD`; numbers of the scope are tied, and long fractions short: what a law states has them whole."""
    scope = ", ".join(_part_of_scope(part) for part in result.scope.split(", "))
    return result.claim, words(result.verdict), result.trust or "", result.method, scope, f"{result.seconds:.2f} s"


def _part_of_scope(part: str) -> str:
    name, equal, value = part.partition(" = ")
    return tied(f"{name} {number_in_short(value)}") if equal else part


def sentences(witness: Witness) -> Iterator[str]:
    """Parameters, points, enclosed values and measures of a witness, and last how to read them."""
    if witness.parameters:
        yield f"counterexample at {_coordinates(witness.parameters)}"
    for role, point in witness.points.items():
        yield f"{role}: {_coordinates(point)}"
    for name, (low, high) in witness.values.items():
        yield f"{name} = {low}" if low == high else f"{name} in [{low}, {high}]"
    for name, measure in witness.measures.items():
        yield f"{name.replace('_', ' ')} {measure:.6g}"
    yield witness.statement


def conclusion(verification: Verification) -> tuple[str, ...]:
    """Whether the law is generalized standard, and dissipative, and why."""
    found = {r.claim: r for r in verification.results}
    standard = _answer("generalized standard", verification.generalized_standard, found, _STANDARD)
    if verification.vacuous and "dissipation" in found:
        return standard, "dissipative: vacuous (K has no boundary point other than zero force, where no force does work: see the remarks)"
    return standard, _answer("dissipative", verification.dissipative, found, ("dissipation",))


def _coordinates(point: Mapping[str, str]) -> str:
    return ", ".join(tied(f"{name} {number_in_words(value)}") for name, value in point.items())


def _answer(title: str, answer: bool | None, found: Mapping[str, ClaimResult], claims: Sequence[str]) -> str:
    verdicts = {claim: result.verdict for claim, result in found.items()}
    if answer:
        resting = {trust: [c for c in claims if found[c].trust is trust] for trust in Trust if trust is not Trust.CHECKED}
        trusts = [f"{trust} for {_and(those)}" for trust, those in resting.items() if those]
        reason = f"{_and(claims)} proved" + (f"; trust: {', '.join(trusts)}" if trusts else "")
    elif answer is False:
        reason = f"{_and([c for c in claims if verdicts.get(c) is Verdict.REFUTED])} refuted"
    else:
        reason = "; ".join(
            f"{c} {words(verdicts[c]) if c in verdicts else 'not asked for'}" for c in claims if verdicts.get(c) != Verdict.PROVED
        )
    word = {True: "yes", False: "no", None: "not decided"}[answer]
    return f"{title}: {word} ({reason})"


def _and(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else "a claim"
