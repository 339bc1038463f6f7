"""The last resort: what was looked at without finding a violation.  It proves nothing and says so."""

from __future__ import annotations

from collections.abc import Sequence

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["chords", "flow", "normality"]


def chords(subject: FormulaSubject) -> Evidence | None:
    """Between how many boundary points, of how many parameter choices, chords were tried in vain; None where none were."""
    from duhem.proof.search.sampled_chords import looked_between  # numpy, only when something was looked for

    return _tested("no chord was found to leave K between", looked_between(subject))


def flow(subject: FormulaSubject) -> Evidence | None:
    """At how many boundary points, of how many parameter choices, the slip was looked at in vain; None where none were found."""
    from duhem.proof.search.boundary_points import scouts

    return _tested("no violation at", [scout.found for scout in scouts(subject, 12) if scout.found > 0])


def normality(subject: FormulaSubject) -> Evidence | None:
    """Of an associated law it is the convexity of K."""
    return chords(subject) if subject.problem.associated else flow(subject)


def _tested(what: str, found: Sequence[int]) -> Evidence | None:
    if not found:
        return None
    choices = "1 parameter choice" if len(found) == 1 else f"{len(found)} parameter choices"
    return Evidence(Verdict.TESTED, "sampling", f"{what} {sum(found)} boundary points of {choices} (fixed seeds); nothing is proved")
