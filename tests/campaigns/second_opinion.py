"""The kernel against two others: the provers on SymPy that it has taken the place of, and every search for a counterexample.

A kernel that is its own prover has no other witness.  So of each law of the catalogue and the atlas every proof is given to all
refuters, the dear ones too, and every claim to the provers of ``tests/oracles/prover``.  A refuted proof, or a second opinion that
proves what is refuted, is an error; a proof that only the second opinion has is printed as *only there*: the kernel might learn it.

    python -m tests.campaigns.second_opinion antoni2007 puck
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from duhem import Criterion, Verdict, load, verify
from duhem.law import catalogue
from duhem.law.atlas.entry import groups
from duhem.proof.claims import CLAIMS, ProofMethod
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import ClaimResult
from tests.oracles.prover.decide import AskedSubject
from tests.oracles.prover.table import PROVERS

__all__ = ["Opinion", "opinions"]


@dataclass(frozen=True)
class Opinion:
    """What is said of a claim of a law beside its ``result``: by a ``refuter`` of a proof, or by a ``prover``."""

    law: str
    result: ClaimResult
    refuter: str = ""
    prover: str = ""

    @property
    def wrong(self) -> bool:
        """Whether one of the two must be."""
        return bool(self.refuter) or (bool(self.prover) and self.result.verdict is Verdict.REFUTED)

    def __str__(self) -> str:
        kind = "CONTRADICTION" if self.wrong else "only there" if self.prover and self.result.verdict is not Verdict.PROVED else "agreed"
        other = self.refuter or self.prover or "nobody else"
        return f"{kind} {self.law} {self.result.claim}: {self.result.verdict} by {self.result.method}, {other}"


def opinions(name: str, law: Criterion) -> Iterator[Opinion]:
    """One for every claim but the state laws."""
    for result in verify(law).results:
        if (claim := result.claim) == "state_laws":
            continue
        refuter = prover = ""
        subject = AskedSubject(law)
        subject.check_defined()
        if result.verdict is Verdict.PROVED:
            refuter = _refuted(claim, subject)
        if result.verdict is not Verdict.NOT_APPLICABLE and subject.may_prove(claim):
            prover = _proved(claim, subject)
        yield Opinion(name, result, refuter, prover)


def _refuted(claim: str, subject: FormulaSubject) -> str:
    """Who refutes it; "" for nobody.  It asks every method of the claim."""
    for method in CLAIMS[claim].methods:
        if isinstance(method, ProofMethod) and method.takes is FormulaSubject:
            subject.allow(CLAIMS[claim].steps)
            found = method.run(subject)
            if found is not None and found.witness is not None and subject.may_refute(claim, found.witness.points):
                return found.method
    return ""


def _proved(claim: str, subject: FormulaSubject) -> str:
    for run in PROVERS.get(claim, ()):
        subject.allow(CLAIMS[claim].steps)
        found = run(subject)
        if found is not None and found.verdict is Verdict.PROVED:
            return found.method
    return ""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign, print what is not agreed on and the counts; 1 if there is a contradiction."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("names", nargs="*", help="laws in place of all of the catalogue and the atlas")
    asked = parser.parse_args(arguments)
    counts = {"proofs": 0, "refuted": 0, "proved there too": 0, "only there": 0, "contradictions": 0}
    for name in asked.names or (*catalogue.names(), *(name for group in groups().values() for name in group)):
        law = load(name)
        for one in opinions(name, law) if isinstance(law, Criterion) else ():
            proved = one.result.verdict is Verdict.PROVED
            counts["proofs"] += proved
            counts["refuted"] += bool(one.refuter)
            counts["proved there too"] += proved and bool(one.prover)
            counts["only there"] += not proved and bool(one.prover)
            counts["contradictions"] += one.wrong
            if one.wrong or (one.prover and not proved):
                print(one, flush=True)
    print(", ".join(f"{what}: {count}" for what, count in counts.items()))
    return int(counts["contradictions"] > 0)


if __name__ == "__main__":
    sys.exit(main())
