"""A certificate read and checked: the statement rebuilt from the law's text, every proof confirmed by a rule or not at all."""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import sha256
from typing import Any, NamedTuple

from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.curve import StatedCurve
from duhem.proof.kernel.domain import Bounds, StatedLaw, exact, inhabited, without_more
from duhem.proof.kernel.term import UNREADABLE, NotWritten, in_words

__all__ = ["CLAIMS", "NO_RULE", "OVER", "SCHEMA", "Rechecked", "digest", "recheck", "stated"]

SCHEMA = "duhem certificate 1"
NO_RULE = "no rule for this argument"
OVER = "over"  # the word of evidence for wider domains of parameters
CLAIMS = ("origin", "convexity", "smoothness", "normality", "dissipation", "duality", "state_laws")


class Rechecked(NamedTuple):
    """One claim of a certificate: what it says and whether the kernel ``confirmed`` it; ``reason`` where it did not."""

    claim: str
    verdict: str
    trust: str
    confirmed: bool
    reason: str


def digest(document: Mapping[str, Any]) -> str:
    """The hash of a certificate's content: what is in it but the hash, as JSON with sorted keys and no blanks."""
    content = {key: value for key, value in document.items() if key != "sha256"}
    return sha256(json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True).encode()).hexdigest()


def stated(law: Mapping[str, Any], over: Mapping[str, Any] | None = None) -> StatedLaw | StatedCurve:
    """The ``law`` of a certificate: by a formula, or by a boundary curve.

    ``over`` has wider domains of some of its parameters: what holds over these holds over its own.  NotWritten where one is not wider.
    """
    if over:
        own = law["parameters"]
        if not set(over) <= set(own) or not all(Bounds.read(domain).covers(Bounds.read(own[name])) for name, domain in over.items()):
            raise NotWritten("a proof is for parameters that are not all of the law's")
        law = {**law, "parameters": {**own, **over}}
    return StatedCurve.read(law) if "boundary" in law else StatedLaw.read(law)


def _row(claim: Mapping[str, Any]) -> Mapping[str, Any]:
    return without_more(claim, {"claim", "verdict", "trust", "method", "rule", "evidence"})


def _objection(claim: str, rule: str, settled: frozenset[str], law: Mapping[str, Any], evidence: Any) -> str:
    try:
        whole = stated(law, evidence.get(OVER))
    except UNREADABLE as fault:
        return f"its evidence cannot be read: {in_words(fault)}"
    return objection(claim, rule, settled, whole, evidence)


def recheck(document: Mapping[str, Any]) -> tuple[Rechecked, ...]:
    """Every claim of a certificate.  Raises NotWritten where it is none: another schema, hash or law, or an empty domain."""
    try:
        without_more(document, {"schema", "law", "inhabited", "claims", "sha256"})
        if document["schema"] != SCHEMA:
            raise NotWritten(f"its schema is not {SCHEMA!r}")
        if document["sha256"] != digest(document):
            raise NotWritten("its hash, sha256, is not that of its content: something was changed after it was made")
        law = stated(document["law"])
        if not inhabited(law.parameters, law.constraints, {name: exact(value) for name, value in document["inhabited"].items()}):
            raise NotWritten("no point of the parameters' domain is given")
        said = [(c["claim"], c["verdict"], c["trust"], c["rule"], c["evidence"]) for c in map(_row, document["claims"])]
        if not all(isinstance(text, str) for claim, verdict, _, rule, _ in said for text in (claim, verdict, "" if rule is None else rule)):
            raise NotWritten("a claim, verdict or rule is no text")
    except UNREADABLE as fault:
        raise NotWritten(f"{'' if isinstance(fault, NotWritten) else 'it is no certificate: '}{in_words(fault)}") from None
    if not said or not isinstance(document["claims"], list | tuple):
        raise NotWritten("it has no list of claims")
    if len({claim for claim, *_ in said}) < len(said) or not {claim for claim, *_ in said} <= set(CLAIMS):
        raise NotWritten("a claim is stated twice or is none")
    settled, rows = set[str](), list[Rechecked]()
    for claim, verdict, trust, rule, evidence in sorted(said, key=lambda c: CLAIMS.index(c[0])):
        reason = "only proofs are checked"
        if verdict == "proved":
            reason = NO_RULE if rule is None else _objection(claim, rule, frozenset(settled), document["law"], evidence)
        if not reason:
            settled.add(claim)
        rows.append(Rechecked(claim, verdict, trust, not reason, reason))
    return tuple(rows)
