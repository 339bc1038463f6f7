"""What direct evaluation decides: the sign of g at the origin."""

from __future__ import annotations

import sympy as sp

from duhem.expression.text import formula
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.undefined import undefined_at_zero
from duhem.proof.verdict import Evidence, Verdict
from duhem.proof.witness.rational_points import origin_outside

__all__ = ["origin", "origin_refuted", "origin_undefined"]


def origin(subject: FormulaSubject) -> Evidence | None:
    """g(0) <= 0 for every pressure and parameter; functions of J2 and J3 are 0 there, by continuity."""
    value = subject.limit_at_origin
    if value is None:
        return None
    answer = subject.ask(-value, Sense.NONNEGATIVE)
    if answer.holds is not True:
        return None
    zero = dict.fromkeys(subject.law.force_symbols(), sp.S.Zero)
    if subject.at_origin is None:
        detail = f"the limit of g at zero force is {formula(value.xreplace(zero))} <= 0"
    else:
        detail = f"g(0) = {formula(subject.law.g.xreplace(zero))} <= 0"
    return Evidence(Verdict.PROVED, f"evaluation ({answer.method})", detail)


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
