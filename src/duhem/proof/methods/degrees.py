"""Dissipation by Euler's relation alone, in any number of forces: no gauge, no convexity, no point inside K is needed.

With G_k the part of g of degree k in the forces, sigma . grad g is the sum of k G_k.  Where g = 0 it is the sum of (k - m) G_k as
well, for every m; one of these that is positive shows that g rises outward there.  For g = A - B of degrees a > b it is (a - b) B.
"""

from __future__ import annotations

import sympy as sp

from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.statement.star import by_degree
from duhem.proof.verdict import Evidence, Proof, Verdict

__all__ = ["dissipation"]


def dissipation(subject: FormulaSubject) -> Evidence | None:
    """sigma . grad g > 0 wherever g = 0 but at zero force, where the power is 0; so it is for every limit of such gradients at a kink."""
    problem = subject.simple
    if not subject.problem.associated or (parts := by_degree(problem)) is None or not subject.joined(problem.g):
        return None
    away = sp.StrictGreaterThan(sp.Add(*(x**2 for x in problem.forces)), 0)
    for m in sorted(parts, reverse=True):
        rest = {k: part for k, part in parts.items() if k != m}
        power = sp.Add(*((k - m) * part for k, part in rest.items()))
        answer = subject.ask(power, Sense.POSITIVE, *([away] if power.free_symbols & set(problem.forces) else []))
        if answer.holds is True:
            detail = f"g has parts of degree {', '.join(map(str, sorted(parts)))} in the forces, so sigma . grad g > 0 wherever g = 0"
            return Evidence(Verdict.PROVED, f"homogeneity ({answer.method})", detail, proof=Proof("homogeneity"))
    return None
