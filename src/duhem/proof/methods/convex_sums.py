"""Evidence for a composition that has polynomials in it: v . Hess g v is a sum of squares, if need be times what is >= 0 in the domain.

Helton, Nie (2010), Math. Program. 122, 21; Ahmadi, Parrilo (2013), SIAM J. Optim. 23, 811.  The squares come from a conic
solver and are made exact: what proves it is an identity of fractions.
"""

from __future__ import annotations

from collections.abc import Iterator

from duhem.expression.text import formula
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.search.boundary_identities import composed_of_sums, convex_sums
from duhem.proof.verdict import Evidence, Proof, Verdict

__all__ = ["convexity", "smoothness"]


def convexity(subject: FormulaSubject) -> Iterator[Evidence]:
    """K is convex if g is quasiconvex by composition, polynomials in it being convex by sums of squares.

    Where the law has a gauge in the plane that says more, dents included.
    """
    if (len(subject.simple.forces) == 2 and subject.star is not None) or not convex_sums(subject):
        return
    detail = f"g is quasiconvex by composition, in it by sums of squares: {', '.join(map(formula, convex_sums(subject)))}"
    yield Evidence(Verdict.PROVED, "sos-convexity", detail, proof=Proof("composition", composed_of_sums(subject)))


def smoothness(subject: FormulaSubject) -> Iterator[Evidence]:
    """The boundary is C^1 if g is C^1 near it and convex so, and negative somewhere: at the origin, or at the centre of K."""
    sums, support = composed_of_sums(subject), subject.support
    centre = {} if support is None else {x: formula(c) for x, c in zip(subject.law.forces, support.centre, strict=True)}
    inside = {"inside": centre} if support is not None and any(support.centre) else {}
    told = "g is C^1 wherever g = 0, and grad g != 0 there because g is convex"
    if inside:
        detail = f"{told} and negative at ({', '.join(centre.values())})"
        yield Evidence(Verdict.PROVED, "composition", detail, proof=Proof("composition", {**inside, **sums}))
    if sums:
        yield Evidence(Verdict.PROVED, "sos-convexity", f"{told}, by sums of squares, and negative at 0", proof=Proof("composition", sums))
        detail = "g is C^1 wherever g = 0, and sigma . grad g > 0 there by Euler's relation, so that grad g != 0"
        yield Evidence(Verdict.PROVED, "euler", detail, proof=Proof("euler", sums))
