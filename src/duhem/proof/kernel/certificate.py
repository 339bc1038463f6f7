"""A certificate read and checked: the statement rebuilt from the law's text, every proof confirmed by a rule or not at all."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from hashlib import sha256
from typing import Any, NamedTuple

from duhem.proof.kernel.claims import BY_CONSTRUCTION, objection
from duhem.proof.kernel.curve import Stated, StatedCurve
from duhem.proof.kernel.domain import Bounds, exact
from duhem.proof.kernel.obligations import numbers
from duhem.proof.kernel.stated_law import StatedLaw, as_object, inhabited, without_more
from duhem.proof.kernel.term import UNREADABLE, NotWritten, in_words

__all__ = [
    "CLAIMS", "COUPLED", "EVIDENCE", "NO_RULE", "OVER", "SCHEMA", "TRUSTS", "VERDICTS", "Rechecked", "check_version", "digest", "law_of",
    "recheck", "stated",
]  # fmt: skip

SCHEMA = "duhem certificate 2"
_RENAMED = {"symbolic": BY_CONSTRUCTION}  # as certificates call it that were written before laws had a state
NO_RULE = "the certificate names no rule for it"
OVER = "over"  # the word of evidence for wider domains of parameters
CLAIMS = ("origin", "convexity", "smoothness", "normality", "dissipation", "duality", "state_laws", "thermal")
COUPLED = ("homogeneity", "bipotential")  # on forces and pressure together
_EVERY = (*CLAIMS, *COUPLED)
VERDICTS = ("proved", "refuted", "tested", "undecided", "not_applicable")
TRUSTS = ("checked", "solver", "prover")  # of a proof; the last two name no rule
EVIDENCE = (
    "across", "along", "convex sums", "directions", "flat", "inside", "inward", "outward", "potential", "rest", "scale", "share", "slips",
    "steep",
)  # fmt: skip


class Rechecked(NamedTuple):
    """One claim of a certificate: what it says and whether the kernel ``confirmed`` it; ``reason`` where it did not.

    ``by_construction``: it holds of every law of the kind, and counts as no proof.
    """

    claim: str
    verdict: str
    trust: str | None
    confirmed: bool
    reason: str
    by_construction: bool = False

    @property
    def outcome(self) -> str:
        """``confirmed``, ``by construction``, ``failed`` or ``no rule`` for what is called proved, ``no proof`` for the rest."""
        if self.verdict != "proved":
            return "no proof"
        if self.by_construction:
            return "by construction"
        return "confirmed" if self.confirmed else "no rule" if self.reason == NO_RULE else "failed"


class _Claim(NamedTuple):
    """A claim as it stands in a certificate."""

    claim: str
    verdict: str
    trust: str | None
    method: str
    rule: str | None
    evidence: Mapping[str, Any]

    @classmethod
    def read(cls, given: Any) -> _Claim:
        """NotWritten where a label is none of those there are, or does not go with the others."""
        row = cls(*(without_more(given, cls._fields)[key] for key in cls._fields))
        for what, label, known in (("claim", row.claim, _EVERY), ("verdict", row.verdict, VERDICTS), ("trust", row.trust, (*TRUSTS, None))):
            if label not in known:
                raise NotWritten(f"the {what} {label!r} is none of: {', '.join(x or 'null' for x in known)}")
        if not isinstance(row.method, str) or not isinstance(row.rule, str | None):
            raise NotWritten(f"the method or rule of {row.claim} is no text")
        without_more(as_object(row.evidence), (*EVIDENCE, OVER))
        if (row.trust is None) == (row.verdict == "proved"):
            raise NotWritten(f"{row.claim} is {row.verdict}, which does not go with the trust {row.trust or 'null'}")
        if row.rule is None and (row.evidence or row.trust == "checked"):
            raise NotWritten(f"{row.claim} has evidence or is called checked, and names no rule")
        return row


def digest(document: Mapping[str, Any]) -> str:
    """The hash of a certificate's content: what is in it but the hash, as JSON with sorted keys and no blanks."""
    content = {key: value for key, value in document.items() if key != "sha256"}
    return sha256(json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True).encode()).hexdigest()


def stated(law: Mapping[str, Any], over: Mapping[str, Any] | None = None) -> Stated:
    """The ``law`` of a certificate: by a formula, or by a boundary curve.

    ``over`` has wider domains of some of its parameters: what holds over these holds over its own.  NotWritten where one is not wider.
    """
    if over:
        own = law["parameters"]
        if not set(over) <= set(own) or not all(Bounds.read(domain).covers(Bounds.read(own[name])) for name, domain in over.items()):
            raise NotWritten("a proof is for parameters that are not all of the law's")
        law = {**law, "parameters": {**own, **over}}
    return StatedCurve.read(law) if "boundary" in law else StatedLaw.read(law)


def _objection(row: _Claim, rule: str, settled: frozenset[str], law: Mapping[str, Any]) -> str:
    try:
        whole = stated(law, row.evidence.get(OVER))
    except UNREADABLE as fault:
        return f"its evidence cannot be read: {in_words(fault)}"
    return objection(row.claim, rule, settled, whole, row.evidence)


def law_of(document: Mapping[str, Any]) -> Stated:
    """The law of a certificate; NotWritten where it was changed, has a number without a value, or admits no parameters."""
    if document["sha256"] != digest(document):
        raise NotWritten("its hash, sha256, is not that of its content: something was changed after it was made")
    law = stated(as_object(document["law"]))
    if not isinstance(document["law"].get("name", ""), str):
        raise NotWritten("the name of the law is no text")
    if refused := next(filter(None, map(numbers, _texts(document["law"]))), ""):
        raise NotWritten(refused)
    if not inhabited(law.parameters, law.constraints, {name: exact(value) for name, value in document["inhabited"].items()}):
        raise NotWritten("no point of the parameters' domain is given")
    return law


def recheck(document: Mapping[str, Any]) -> tuple[Rechecked, ...]:
    """Every claim of a certificate.  Raises NotWritten where it is none: another version, hash or law, unknown labels, an empty domain."""
    try:
        check_version(document["schema"], SCHEMA)
        without_more(document, {"schema", "law", "inhabited", "claims", "sha256"})
        law_of(document)
        if not isinstance(document["claims"], list | tuple) or not document["claims"]:
            raise NotWritten("it has no list of claims")
        said = [_Claim.read(as_object(row)) for row in document["claims"]]
    except UNREADABLE as fault:
        raise NotWritten(f"{'' if isinstance(fault, NotWritten) else 'it is no certificate: '}{in_words(fault)}") from None
    if len({row.claim for row in said}) < len(said):
        raise NotWritten("a claim is stated twice")
    settled, rows = set[str](), list[Rechecked]()
    for row in sorted(said, key=lambda row: _EVERY.index(row.claim)):
        reason = "only proofs are checked"
        rule = _RENAMED.get(row.rule or "", row.rule)
        if row.verdict == "proved":
            reason = NO_RULE if rule is None else _objection(row, rule, frozenset(settled), document["law"])
        if not reason:
            settled.add(row.claim)
        rows.append(Rechecked(row.claim, row.verdict, row.trust, not reason, reason, not reason and rule == BY_CONSTRUCTION))
    return tuple(rows)


def _texts(law: Mapping[str, Any]) -> Iterator[str]:
    """Every formula and comparison in the law of a certificate."""
    yield from law["constraints"]
    yield from (text for _, text in law.get("define", ()))
    if "energy" in law:
        yield law["energy"]
    yield from (text for key in ("rates", "unforced", "heat", "forces_of_rates") for text in law.get(key, {}).values())
    for entry in law.get("surfaces", () if "forces_of_rates" in law else (law,)):
        flow = entry["flow"]
        yield from ([] if flow is None else flow.values() if isinstance(flow, Mapping) else flow)
        yield from ([entry["g"]] if "g" in entry else entry["boundary"])


def check_version(schema: Any, known: str) -> None:
    """NotWritten for another version of the form than the one that is ``known``."""
    if schema == known:
        return
    form, _, version = known.rpartition(" ")
    if isinstance(schema, str) and re.fullmatch(rf"{form} [0-9]{{1,6}}", schema):
        raise NotWritten(f"it is written in version {schema.rpartition(' ')[2]} of its form, and version {version} is read here")
    raise NotWritten(f"its schema is not {known!r}")
