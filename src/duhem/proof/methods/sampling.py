"""The last resort: what was looked at without finding a violation.  It proves nothing and says so."""

from __future__ import annotations

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["sampled"]


def sampled(subject: FormulaSubject) -> Evidence | None:
    """Called after every scout came back empty: at how many boundary points, of how many parameter choices, they looked.

    Where no boundary point was found nothing was tested.
    """
    from duhem.proof.search.boundary_points import BoundaryScout  # numpy, only when something is looked for

    found = [n for n in (BoundaryScout(subject, parameters).found for parameters in subject.choices(12)) if n > 0]
    if not found:
        return None
    choices = "1 parameter choice" if len(found) == 1 else f"{len(found)} parameter choices"
    return Evidence(
        Verdict.TESTED, "sampling", f"no violation at {sum(found)} boundary points of {choices} (fixed seeds); nothing is proved"
    )
