"""The dissipation potential in closed form, by the rules of the polar gauge (Rockafellar 1970, sections 13-15)."""

from __future__ import annotations

import sympy as sp

from duhem.expression.text import formula
from duhem.proof.decide import Question, Sense
from duhem.proof.decide.needs import obligations
from duhem.proof.facts.definedness import met_for_all
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Proof, Verdict

__all__ = ["duality"]


def duality(subject: FormulaSubject) -> Evidence | None:
    """Phi is the support function of K: each step is a theorem, its positivity hypotheses decided over the whole domain."""
    if bounded := [name for name in subject.law.forces if name in subject.law.domain]:
        reason = f"the claims are asked in a range of {', '.join(bounded)}, and no closed form is known of a part of K"
        return Evidence(Verdict.NOT_APPLICABLE, "polar-gauge", reason)
    found = subject.support
    if found is None:
        reason = "the rules of the polar gauge give this law no closed-form dissipation potential"
        return Evidence(Verdict.NOT_APPLICABLE, "polar-gauge", reason)
    swap = subject.problem.compressed
    # What the potential divides by must not vanish for any admitted parameters, whatever the rules that gave it have asked.
    asked = [o for o in obligations(found.potential.xreplace(swap)) if not o.symbols() & set(found.rates)]
    if not all(met_for_all(subject, subject.problem, o) for o in asked):
        return None
    for needed in found.requires:
        if subject.decided(Question(sp.sympify(needed).xreplace(swap), Sense.POSITIVE, subject.problem.given)).holds is not True:
            return None
    slips = {f: x.name for f, x in zip(subject.law.forces, found.rates, strict=True)}
    told = {"potential": formula(found.potential), "slips": slips, "flat": [formula(form) for form in found.domain]}
    proof = Proof("polar-gauge", {key: value for key, value in told.items() if value})
    return Evidence(Verdict.PROVED, "polar-gauge", f"Phi(d) = {formula(found.potential)}; " + "; ".join(found.steps), proof=proof)
