"""What each proof rests on: the kernel is given every one, in the order in which they were made."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from duhem.law.curve_law import Law
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection, rules_of
from duhem.proof.kernel.curve import StatedCurve
from duhem.proof.kernel.domain import StatedLaw
from duhem.proof.kernel.term import NotWritten
from duhem.proof.law_text import law_as_text
from duhem.proof.verdict import Evidence, Proof, Trust, Verdict

__all__ = ["Confirmations", "Standing"]

_SOLVERS = ("smt", "z3")  # in the brackets of a method's name


@dataclass(frozen=True)
class Standing:
    """Of a proof: what it rests on and, where the kernel confirmed it, how."""

    trust: Trust
    proof: Proof | None = None


@dataclass
class Confirmations:
    """The proofs of one law so far, and how each stands."""

    law: Law
    standings: dict[str, Standing] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._stated = _stated(self.law)
        self._asked: tuple[str, Proof | None, frozenset[str]] | None = None  # the last question, and its answer
        self._answer: Proof | None = None

    def of(self, claim: str, evidence: Evidence, rests_on: Iterable[str]) -> Standing | None:
        """How a proof stands, where the claims it may have started from, ``rests_on``, came before; None for no proof."""
        if evidence.verdict is not Verdict.PROVED:
            return None
        if (proof := self._confirmed(claim, evidence.proof, self._checked())) is not None:
            found = Standing(Trust.CHECKED, proof)
        else:
            by_solver = any(s in evidence.method.partition(" (")[2] for s in _SOLVERS)
            own, premises = Trust.SOLVER if by_solver else Trust.PROVER, [name for name in rests_on if name in self.standings]
            if self._confirmed(claim, evidence.proof, frozenset(self.standings)) is not None:  # a consequence of what came before
                own, premises = Trust.CHECKED, list(self.standings)
            found = Standing(Trust.weakest(own, *(self.standings[name].trust for name in premises)))
        self.standings[claim] = found
        return found

    def confirm(self, claim: str, evidence: Evidence) -> bool:
        """Whether the kernel confirms a proof: it asks itself whether what its rule needs is defined, of this claim alone."""
        return self._confirmed(claim, evidence.proof, self._checked()) is not None

    def withdraw(self, claim: str) -> None:
        """The proof turned out to be none."""
        del self.standings[claim]

    def _checked(self) -> frozenset[str]:
        return frozenset(name for name, found in self.standings.items() if found.trust is Trust.CHECKED)

    def _confirmed(self, claim: str, offered: Proof | None, settled: frozenset[str]) -> Proof | None:
        """The proof that the kernel accepts where the claims ``settled`` hold."""
        if self._stated is None:
            return None
        if (claim, offered, settled) != self._asked:
            offers = [*([] if offered is None else [offered]), *(Proof(rule) for rule in rules_of(claim, self._stated))]
            self._answer = next((p for p in offers if not objection(claim, p.rule, settled, self._stated, p.evidence)), None)
            self._asked = (claim, offered, settled)
        return self._answer


def _stated(law: Law) -> StatedLaw | StatedCurve | None:
    """The law as the kernel has it; None where that reads nothing of it."""
    try:
        return stated(law_as_text(law))
    except (NotWritten, OverflowError, RecursionError):
        return None
