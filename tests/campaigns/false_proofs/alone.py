"""Every method of proof by itself: no refuter comes before it, no other method hides what it says."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from duhem import Criterion, InputError, Verdict
from duhem.proof.claims import CLAIMS, Consequence, ProofMethod
from duhem.proof.decide import EFFORTS
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import refuters
from duhem.proof.verdict import Evidence
from tests.campaigns.false_proofs.trap import Trap
from tests.oracles.prover.decide import AskedSubject
from tests.oracles.prover.table import PROVERS

__all__ = ["false_proofs_alone", "proofs_alone", "provers"]


def provers(claim: str) -> tuple[ProofMethod[FormulaSubject] | Consequence[FormulaSubject], ...]:
    """The methods that may prove a claim of a law given by a formula without the kernel, those that give a second opinion first."""
    return (
        *(ProofMethod(FormulaSubject, run) for run in PROVERS.get(claim, ())),
        *(
            m
            for m in CLAIMS[claim].methods
            if isinstance(m, ProofMethod | Consequence) and m.takes is FormulaSubject and m.run.__module__ != refuters.__name__
        ),
    )


def proofs_alone(law: Criterion, claim: str, truth: Mapping[str, bool], effort: str = "normal") -> Iterator[str]:
    """Methods that prove ``claim`` of ``law``, each on a subject of its own; claims before it are proved where they are true."""
    settled = {name: Evidence(Verdict.PROVED if truth.get(name) else Verdict.TESTED, "known", "so it is") for name in CLAIMS}
    for method in provers(claim):
        subject = AskedSubject(law, EFFORTS[effort])
        subject.check_defined()
        if replace(CLAIMS[claim], methods=(method,)).examine(subject, settled).verdict is Verdict.PROVED:
            yield f"{method.run.__module__.rpartition('.')[2]}.{method.run.__name__}"


def false_proofs_alone(trap: Trap, effort: str = "normal") -> dict[str, list[str]]:
    """The methods that prove a false claim of a trap, or any but the last claim of what is no law."""
    false = [c for c in CLAIMS if c != "state_laws"] if trap.refused else [c for c, holds in trap.truth.items() if not holds]
    try:
        law = trap.law()
        found = {claim: list(proofs_alone(law, claim, trap.truth, effort)) for claim in false}
    except InputError:
        if trap.refused or trap.refusable:
            return {}
        raise
    return {claim: names for claim, names in found.items() if names}
