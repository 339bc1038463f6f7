"""The dissipation potential in closed form, by the rules of the polar gauge (Rockafellar 1970, sections 13-15)."""

from __future__ import annotations

import sympy as sp

from duhem.derivation.support_function import support_function
from duhem.expression.text import formula
from duhem.proof.decide import Question, Sense, decide
from duhem.proof.facts.case import Case
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["duality"]


def duality(case: Case) -> Evidence | None:
    """Phi is the support function of K: each step is a theorem, its positivity hypotheses decided over the whole domain."""
    found = support_function(case.law)
    if found is None:
        reason = "the rules of the polar gauge give this law no closed-form dissipation potential"
        return Evidence(Verdict.NOT_APPLICABLE, "polar-gauge", reason)
    swap = {}
    if case.law.pressure is not None and case.problem.magnitude is not None:
        swap[case.law.symbols()[case.law.pressure]] = -case.problem.magnitude
    for needed in found.requires:
        if decide(Question(sp.sympify(needed).xreplace(swap), Sense.POSITIVE, case.problem.given)).holds is not True:
            return None
    return Evidence(Verdict.PROVED, "polar-gauge", f"Phi(d) = {formula(found.potential)}; " + "; ".join(found.steps))
