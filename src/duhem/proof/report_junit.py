"""The claims of a law as a JUnit suite: what is proved passes, what is refuted fails with its witness, what is open is skipped."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

from duhem.proof.in_words import sentences, words
from duhem.proof.verdict import Verdict
from duhem.show.junit import JUnitCase, JUnitSuite, Outcome
from duhem.show.page import Page
from duhem.version import __version__

if TYPE_CHECKING:
    from duhem.law.curve_law import Law
    from duhem.proof.verification import ClaimResult, Verification

__all__ = ["complete", "interrupted"]

_OPEN = (Verdict.UNDECIDED, Verdict.TESTED)


def complete(verification: Verification, *, strict: bool = False) -> JUnitSuite:
    """A case a claim; with ``strict`` a claim that is neither proved nor refuted fails, unless it is not applicable."""
    said = {"effort": verification.effort, **{f"remark {i}": remark for i, remark in enumerate(verification.remarks, 1)}}
    return _suite(verification.criterion, verification.results, strict, said)


def interrupted(law: Law, results: Sequence[ClaimResult], effort: str = "normal", *, strict: bool = False) -> JUnitSuite:
    """The claims decided so far, in a suite that says so."""
    return _suite(law, results, strict, {"effort": effort, "interrupted": "true"})


def _suite(law: Law, results: Sequence[ClaimResult], strict: bool, said: dict[str, str]) -> JUnitSuite:
    properties = {"duhem": __version__, **{f"parameter {name}": domain.describe() for name, domain in law.parameters.items()}, **said}
    for result in results:
        found = result.to_dict()
        about = {key: found[key] for key in ("verdict", "method", "trust", "scope") if found[key] is not None}
        if result.witness is not None:
            about["witness"] = json.dumps(result.witness.to_dict(), ensure_ascii=False)
        properties |= {f"{result.claim} {key}": value for key, value in about.items()}
    return JUnitSuite(law.name, tuple(_case(result, strict) for result in results), properties)


def _case(result: ClaimResult, strict: bool) -> JUnitCase:
    message = f"{words(result.verdict)}: {result.detail}"
    if result.witness is not None:
        lines = [line for sentence in sentences(result.witness) for line in Page(None).hanging(sentence)]
        return JUnitCase(result.claim, Outcome.FAILED, message, "\n".join(lines), seconds=result.seconds)
    if result.verdict is Verdict.PROVED:
        trust = f", {result.trust}" if result.trust else ""
        return JUnitCase(result.claim, output=f"proved by {result.method}{trust}; {result.scope}: {result.detail}", seconds=result.seconds)
    outcome = Outcome.FAILED if strict and result.verdict in _OPEN else Outcome.SKIPPED
    return JUnitCase(result.claim, outcome, message, seconds=result.seconds)
