"""What direct evaluation decides: that g is positive at the origin, or has no value there."""

from __future__ import annotations

from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.special_places import undefined_at_zero
from duhem.proof.verdict import Evidence, Verdict
from duhem.proof.witness.rational_points import origin_outside

__all__ = ["origin_refuted", "origin_undefined"]


def origin_refuted(subject: FormulaSubject) -> Evidence | None:
    """Parameters at which g(0) > 0."""
    hint = None if subject.at_origin is None else subject.ask(-subject.at_origin, Sense.NONNEGATIVE).point
    for parameters in subject.choices(40, [hint] if hint else []):
        if (witness := origin_outside(subject, parameters)) is not None:
            return Evidence(Verdict.REFUTED, "witness-point", "zero force is outside K", witness)
    return None


def origin_undefined(subject: FormulaSubject) -> Evidence | None:
    """Why it stays open: g has no value at zero force."""
    said = undefined_at_zero(subject)
    return Evidence(Verdict.UNDECIDED, "none", said) if said else None
