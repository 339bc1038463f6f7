"""The last resort: what was looked at without finding a violation.  It proves nothing and says so."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Verdict

if TYPE_CHECKING:
    from duhem.proof.search.boundary_points import BoundaryScout

__all__ = ["chords", "dissipation", "normality"]


def chords(subject: FormulaSubject) -> Evidence | None:
    """Between how many boundary points, of how many parameter choices, chords were tried in vain; None where none were."""
    from duhem.proof.search.long_chords import looked_between  # numpy, only when something was looked for

    return _tested("no chord was found to leave K between", looked_between(subject))


def dissipation(subject: FormulaSubject) -> Evidence | None:
    """At how many boundary points, of how many parameter choices, the slip was looked at in vain; None where none were found."""
    return _flow(subject, "the power is negative", lambda scout: scout.seem_to_dissipate_less_than_0())


def normality(subject: FormulaSubject) -> Evidence | None:
    """Of an associated law it is the convexity of K."""
    if subject.problem.associated:
        return chords(subject)
    return _flow(subject, "the slip leans towards another point of K", lambda scout: scout.seem_to_lean_inward())


def _flow(subject: FormulaSubject, violation: str, seem: Callable[[BoundaryScout], int]) -> Evidence | None:
    from duhem.proof.search.boundary_points import scouts

    looked = [scout for scout in scouts(subject, 12) if scout.found > 0]
    if doubtful := next(((count, scout.found) for scout in looked if (count := seem(scout))), None):
        count, found = doubtful
        detail = f"in floats {violation} at {count} of {found} boundary points of a parameter choice, which no exact witness confirms"
        return Evidence(Verdict.UNDECIDED, "sampling", detail)
    return _tested("no violation at", [scout.found for scout in looked])


def _tested(what: str, found: Sequence[int]) -> Evidence | None:
    if not found:
        return None
    choices = "1 parameter choice" if len(found) == 1 else f"{len(found)} parameter choices"
    return Evidence(Verdict.TESTED, "sampling", f"{what} {sum(found)} boundary points of {choices} (fixed seeds); nothing is proved")
