"""What duhem and its kernel say of a trap, against what is true of it."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection

from duhem import Criterion, InputError, Verdict, Verification, Witness, verify
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import CLAIMS
from duhem.proof.kernel.claims import objection, rules_of
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten
from tests.campaigns.false_proofs.alone import false_proofs_alone
from tests.campaigns.false_proofs.trap import Trap
from tests.oracles.reevaluation import OpenError, confirmed

__all__ = ["Answered", "judge", "judge_alone", "judge_apart"]


@dataclass(frozen=True)
class Answered:
    """``claims``: ``right``, ``open`` or what is wrong, a claim each.  ``failed``: the law as a whole crashed, or hung."""

    claims: Mapping[str, str] = field(default_factory=dict)
    failed: str = ""
    seconds: float = 0.0

    @property
    def wrong(self) -> dict[str, str]:
        """Claims answered against the truth."""
        return {claim: text for claim, text in self.claims.items() if text not in ("right", "open")}


def judge(trap: Trap) -> Answered:
    """Verify the law; every claim of known truth, or of a law that should have been refused, is compared."""
    start = time.perf_counter()
    wanted = [c for c in CLAIMS if c != "state_laws"] if trap.refused else list(trap.truth)
    try:
        law = trap.law()
        found = verify(law, claims=wanted)
    except InputError as fault:
        right = trap.refused or trap.refusable
        return Answered({"law": "right" if right else f"refused: {fault}"}, seconds=time.perf_counter() - start)
    said = {claim: _compared(trap, law, found, claim) for claim in wanted} | ({"law": "open"} if trap.refused else {})
    for claim in kernel_confirms(law):
        if claim in wanted and (trap.refused or not trap.truth[claim]):
            said[claim] = f"confirmed by the kernel although {'no law' if trap.refused else 'false'}"
    return Answered(said, seconds=time.perf_counter() - start)


def kernel_confirms(law: Criterion) -> tuple[str, ...]:
    """The claims that a rule of the kernel confirms without being given any evidence."""
    settled: list[str] = []
    try:
        stated = StatedLaw.read(law_as_text(law))
    except NotWritten:
        return ()
    for claim in CLAIMS:
        if any(not objection(claim, rule, frozenset(settled), stated, {}) for rule in rules_of(claim, stated)):
            settled.append(claim)
    return tuple(settled)


def _compared(trap: Trap, law: Criterion, found: Verification, claim: str) -> str:
    result = found[claim]
    if trap.refused:
        return f"proved by {result.method}, {result.trust}, although it is no law" if result.verdict is Verdict.PROVED else "open"
    true = trap.truth[claim]
    if result.verdict is Verdict.PROVED:
        return "right" if true else f"proved by {result.method}, {result.trust}, although false"
    if result.verdict is Verdict.REFUTED:
        assert result.witness is not None
        if true:
            return f"refuted by {result.method} although true"
        return "right" if _holds(law, claim, result.witness) else f"the witness of {result.method} does not re-evaluate"
    return "open"


def _holds(law: Criterion, claim: str, witness: Witness) -> bool:
    """Whether the second arithmetic confirms the witness, or has no opinion.  It goes round a corner in steps too coarse for these."""
    if claim == "smoothness":
        return True
    try:
        return confirmed(law, claim, witness)
    except (NotImplementedError, OpenError):
        return True


def judge_alone(trap: Trap) -> Answered:
    """Every method of a false claim, asked by itself."""
    start = time.perf_counter()
    found = false_proofs_alone(trap)
    false = [claim for claim, holds in trap.truth.items() if not holds]
    wrong = {claim: f"proved by {', '.join(names)} alone although false" for claim, names in found.items()}
    return Answered({claim: "open" for claim in false} | wrong, seconds=time.perf_counter() - start)


def judge_apart(trap: Trap, how: Callable[[Trap], Answered] = judge, seconds: int = 60) -> Answered:
    """The same in a process of its own, ended when it has used so much processor time."""
    here, there = get_context("fork").Pipe(duplex=False)
    process = get_context("fork").Process(target=_report, args=(trap, how, there, seconds))
    start = time.perf_counter()
    process.start()
    there.close()
    try:
        found: Answered = here.recv() if here.poll(20 * seconds) else Answered(failed="hang")
    except EOFError:
        found = Answered(failed="hang")
    if found.failed == "hang":
        process.kill()
    process.join()
    return found if found.claims or found.seconds else Answered(failed=found.failed, seconds=time.perf_counter() - start)


def _report(trap: Trap, how: Callable[[Trap], Answered], there: Connection, seconds: int) -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    try:
        there.send(how(trap))
    except Exception as fault:
        there.send(Answered(failed=f"{type(fault).__name__}: {fault}"))
