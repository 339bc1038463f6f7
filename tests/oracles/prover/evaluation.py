"""The sign of g at the origin, evaluated."""

from __future__ import annotations

import sympy as sp

from duhem.expression.text import formula
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Verdict
from tests.oracles.prover.deviator import limit_at_origin

__all__ = ["origin"]


def origin(subject: FormulaSubject) -> Evidence | None:
    """g(0) <= 0 for every pressure and parameter; functions of J2 and J3 are 0 there, by continuity."""
    value = limit_at_origin(subject)
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
