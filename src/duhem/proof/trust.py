"""What is proved and what each proof rests on: the kernel's rules are asked first, and are given every proof that others make."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from duhem.law.curve_law import Law
from duhem.proof.certificate import law_as_text
from duhem.proof.decide import ANY_STEPS, Budget
from duhem.proof.kernel.certificate import OVER, stated
from duhem.proof.kernel.claims import needs_of, objection, row_of, rules_of
from duhem.proof.kernel.curve import StatedCurve
from duhem.proof.kernel.domain import StatedLaw
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import NotWritten
from duhem.proof.verdict import ClaimResult, Evidence, Proof, Trust, Verdict

__all__ = ["Confirmations", "Standing"]

_SOLVERS = ("smt", "z3")  # in the brackets of a method's name
_MOST_STEPS = 20_000_000  # for a proof that somebody offers
_OVER_ALL = "over the whole domain of the law, of which this is a part"


@dataclass(frozen=True)
class Standing:
    """What a proof rests on and, where the kernel confirmed it, how.  Where a claim is not proved both are None."""

    trust: Trust | None = None
    proof: Proof | None = None


@dataclass
class Confirmations:
    """The proofs of one law so far, and how each stands.  It is the kernel as the claims ask it; its work draws on the ``whole``."""

    law: Law
    whole: Budget = field(default_factory=lambda: Budget(ANY_STEPS))
    standings: dict[str, Standing] = field(default_factory=dict)
    spent: int = 0

    def __post_init__(self) -> None:
        self._stated = _stated(self.law)
        self._answers: list[tuple[str, Proof, bool, int]] = []  # with the steps that were allowed, where they were too few

    def needs(self, claim: str) -> frozenset[str]:
        """The claims that the kernel's rules for a claim may rest on."""
        return frozenset() if self._stated is None else needs_of(claim, self._stated)

    def rests_on(self, claim: str) -> frozenset[str]:
        """The claims that the rule which proved a claim rests on; none where no rule did."""
        found = self.standings.get(claim)
        return frozenset() if found is None or found.proof is None else self._needed(claim, found.proof)

    def proof(self, claim: str, steps: int) -> Evidence | None:
        """What the first rule proves that needs no evidence, each within so many steps; None where none does."""
        found = next((offer for offer in self._in_order(claim) if self._accepts(claim, offer, steps)), None)
        row = None if found is None or self._stated is None else row_of(claim, found.rule, self._stated)
        return None if found is None or row is None else Evidence(Verdict.PROVED, found.rule, row.sentence, proof=found)

    def confirms(self, claim: str, evidence: Evidence) -> bool:
        """Whether the kernel accepts a proof: it asks itself whether what its rule needs is defined, of this claim alone."""
        found = self._accepted(claim, evidence.proof)
        return found is not None and self._needed(claim, found) <= self._checked()

    def of(self, claim: str, evidence: Evidence, rests_on: Iterable[str]) -> Standing:
        """How a proof stands, where the claims it may have started from, ``rests_on``, came before."""
        self.standings.pop(claim, None)  # a proof may have turned out to be none
        if evidence.verdict is not Verdict.PROVED:
            return Standing()
        proof = self._accepted(claim, evidence.proof)
        if proof is not None:
            own, premises = Trust.CHECKED, self._needed(claim, proof)
        else:
            by_solver = any(s in evidence.method.partition(" (")[2] for s in _SOLVERS)
            own, premises = Trust.SOLVER if by_solver else Trust.PROVER, frozenset(rests_on) & self.standings.keys()
        trust = Trust.weakest(own, *(self.standings[name].trust or Trust.PROVER for name in premises))
        self.standings[claim] = Standing(trust, proof if trust is Trust.CHECKED else None)
        return self.standings[claim]

    def of_a_part(self, claim: str, whole: ClaimResult, law: Law) -> Evidence:
        """A proof that holds over all of a ``law``, said of this one, which has parts of the domains of its parameters."""
        detail, proof = f"{whole.detail} (shown {_OVER_ALL})", whole.proof
        if proof is not None:
            domains = {
                name: domain for name, domain in law_as_text(law)["parameters"].items() if law.parameters[name] != self.law.parameters[name]
            }
            proof = replace(proof, evidence={**proof.evidence, OVER: domains})
        return Evidence(Verdict.PROVED, whole.method, detail, proof=proof)

    def _checked(self) -> frozenset[str]:
        return frozenset(name for name, found in self.standings.items() if found.trust is Trust.CHECKED)

    def _needed(self, claim: str, proof: Proof) -> frozenset[str]:
        row = None if self._stated is None else row_of(claim, proof.rule, self._stated)
        return frozenset() if row is None else row.needed

    def _in_order(self, claim: str) -> Iterator[Proof]:
        """The rules without evidence whose needs are met; first those that rest on nothing but what was checked."""
        offers = [] if self._stated is None else [Proof(rule) for rule in rules_of(claim, self._stated)]
        checked = self._checked()
        yield from (offer for offer in offers if self._needed(claim, offer) <= checked)
        yield from (offer for offer in offers if not self._needed(claim, offer) <= checked)

    def _accepted(self, claim: str, offered: Proof | None) -> Proof | None:
        """The proof that the kernel accepts: the one that is offered, or by a rule that needs no evidence."""
        offers = [*([] if offered is None else [offered]), *self._in_order(claim)]
        return next((offer for offer in offers if self._accepts(claim, offer, _MOST_STEPS)), None)

    def _accepts(self, claim: str, offer: Proof, steps: int) -> bool:
        """Whether the kernel has no objection to a proof, found within so many steps."""
        if self._stated is None:
            return False
        steps = min(steps, self.whole.left)
        for name, proof, holds, allowed in reversed(self._answers):
            if (name, proof) == (claim, offer) and (holds or allowed >= steps):
                return holds
        settled, allowed = frozenset(self.standings), ANY_STEPS
        with within(steps) as purse:
            try:
                asked = _stated(self.law, offer.evidence.get(OVER)) if OVER in offer.evidence else self._stated
                holds = asked is not None and not objection(claim, offer.rule, settled, asked, offer.evidence)
            except TooDearError:
                holds, allowed = False, steps
        self.spent += purse.spent
        self.whole.pays(min(purse.spent, steps))  # the last step may have been too dear
        if holds or self._needed(claim, offer) <= settled:  # else it may still be proved
            self._answers.append((claim, offer, holds, allowed))
        return holds


def _stated(law: Law, over: Mapping[str, Any] | None = None) -> StatedLaw | StatedCurve | None:
    """The law as the kernel has it, perhaps over wider domains; None where that reads nothing of it."""
    try:
        return stated(law_as_text(law), over)
    except (NotWritten, OverflowError, RecursionError):
        return None
