"""A verification written down so that the kernel can check it: the law's text, the claims, the rule and evidence of each."""

from __future__ import annotations

from typing import Any, Protocol

from duhem.errors import InputError
from duhem.law.curve_law import Law
from duhem.proof.kernel.certificate import SCHEMA, digest
from duhem.proof.law_text import admitted_values, law_as_text
from duhem.proof.verdict import ClaimResult

__all__ = ["certificate"]


class Verified(Protocol):
    """What is written down of a :class:`duhem.Verification`."""

    @property
    def criterion(self) -> Law: ...
    @property
    def results(self) -> tuple[ClaimResult, ...]: ...
    @property
    def rests_on(self) -> tuple[ClaimResult, ...]: ...


def certificate(verification: Verified) -> dict[str, Any]:
    """The certificate as a JSON object: deterministic, without times, with a hash of its content.

    Each claim has its :class:`~duhem.proof.verdict.Trust` and, where the kernel confirmed it, the rule and its evidence; the
    claims that those asked for rest on are there too.  Raises InputError where no exact parameter values of the domain are found.
    """
    law = verification.criterion
    if (inhabited := admitted_values(law)) is None:
        raise InputError("no exact point of the parameters' domain was found", where=law.name, remedy="fix a parameter with --set")
    claims = [_claim(result) for result in (*verification.rests_on, *verification.results)]
    document = {"schema": SCHEMA, "law": law_as_text(law), "inhabited": dict(inhabited), "claims": claims}
    return document | {"sha256": digest(document)}


def _claim(result: ClaimResult) -> dict[str, Any]:
    return {
        "claim": result.claim,
        "verdict": result.verdict.value,
        "trust": None if result.trust is None else result.trust.value,
        "method": result.method,
        "rule": None if result.proof is None else result.proof.rule,
        "evidence": {} if result.proof is None else dict(result.proof.evidence),
    }
