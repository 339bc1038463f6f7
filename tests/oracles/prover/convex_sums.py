"""Convexity of polynomials: v . Hess g v is a sum of squares, if need be times what the domain's conditions say is >= 0.

Helton, Nie (2010), Math. Program. 122, 21; Ahmadi, Parrilo (2013), SIAM J. Optim. 23, 811.  The squares come from a conic
solver and are made exact: what proves it is an identity of fractions.
"""

from __future__ import annotations

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.search.boundary_identities import composed_of_sums, convex_sums
from duhem.proof.verdict import Evidence, Proof, Verdict
from tests.oracles.prover.curvature import curvature
from tests.oracles.prover.star import star_form

__all__ = ["convexity"]


def convexity(subject: FormulaSubject) -> Evidence | None:
    """K is convex if g is quasiconvex by composition, polynomials in it being convex by sums of squares.

    Where the polar form applies it says more, dents included.  Forces that drop out of the simple problem count as constants here:
    along them g does not change, so that K is convex if its slices are.
    """
    law = subject.law
    if (len(subject.simple.forces) == 2 and star_form(subject) is not None) or not (sums := convex_sums(subject)):
        return None
    shape = curvature(law.g.subs(law.settled()), subject, {f: len(why) > 1 for f, why in sums.items()})
    if not shape.quasiconvex:
        return None
    kind = "convex" if shape.convex else "quasiconvex"
    proof = Proof("composition", composed_of_sums(subject))
    return Evidence(Verdict.PROVED, "sos-convexity", f"g is {kind}: " + "; ".join(shape.rules), proof=proof)
