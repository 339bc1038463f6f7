"""The last resort: what was looked at without finding a violation.  It proves nothing and says so."""

from __future__ import annotations

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["sampled"]


def sampled(subject: FormulaSubject) -> Evidence | None:
    """Called after every scout came back empty: states how many parameter choices they covered, with their fixed seeds."""
    count = sum(1 for _ in subject.choices(12))
    if count == 0:
        return None
    return Evidence(
        Verdict.TESTED, "sampling", f"no violation at {count} parameter choices (boundary scouts, fixed seeds); nothing is proved"
    )
