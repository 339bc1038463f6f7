"""Convexity of polynomials: v . Hess g v is a sum of squares, if need be times what the domain's conditions say is >= 0.

Helton, Nie (2010), Math. Program. 122, 21; Ahmadi, Parrilo (2013), SIAM J. Optim. 23, 811.  The squares come from a conic
solver and are made exact: what proves it is an identity of fractions.
"""

from __future__ import annotations

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.search.boundary_identities import convex_sums, directions
from duhem.proof.verdict import Evidence, Proof, Verdict

__all__ = ["convexity"]


def convexity(subject: FormulaSubject) -> Evidence | None:
    """K is convex if g is a convex polynomial in the forces."""
    law = subject.law
    if (known := convex_sums(subject).get(law.g.subs(law.settled()))) is None:
        return None
    proof = Proof("composition", {"directions": directions(law), "convex sums": [known]})
    return Evidence(Verdict.PROVED, "sos-convexity", "g is convex: v . Hess g v is a sum of squares, exactly", proof=proof)
