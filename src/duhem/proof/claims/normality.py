"""Flow in the normal cone."""

from collections.abc import Mapping
from functools import partial

from duhem.proof.claims.claim import CHEAP, Claim, Consequence, ProofMethod
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import curve_deviation, curve_refutation, curve_signs, flow, sampling
from duhem.proof.verdict import Evidence, Verdict

_NO_POINT = "a chord leaves K, so K is not convex; no boundary point is confirmed at which grad g leaves the normal cone of K"


def by_convexity(subject: FormulaSubject, settled: Mapping[str, Evidence]) -> Evidence | None:
    """An associated flow is not normal where a chord leaves K; a flow of the law's own on a convex K is compared with grad g."""
    convexity = settled["convexity"]
    if subject.problem.associated and convexity.witness is not None:
        return flow.normality_refuted_by_chord(subject, convexity.witness) or Evidence(Verdict.UNDECIDED, "witness-chord", _NO_POINT)
    return flow.normality(subject) if convexity.verdict is Verdict.PROVED else None


CLAIM = Claim(
    name="normality",
    statement="the flow direction lies in the normal cone of K at every boundary point",
    theory="""\
Normality rule (Moreau 1970; Antoni et al. 2007, Eqs. 28, 36): u_in' in dI_K(sigma), the normal cone of K at sigma in the
tangential plane at frozen sigma_n.  d is in the normal cone at sigma exactly when d . (tau - sigma) <= 0 for all tau in K.
An associated law obeys it by definition when K is convex; when K is not, grad g fails it where a chord leaves K.
A law with a flow of its own obeys it when that flow is a non-negative multiple of grad g on the boundary.
Where K is bounded by several surfaces the slip at a point is a non-negative combination of the flows of those that are 0
there (Koiter 1953): each must be in the normal cone of K wherever its surface is 0 in K.  A surface without a flow slips
along the normals of its own {g <= 0}, which are normals of K, for K lies in that.
Refuted by a boundary point, held between two rational ones, and a point tau of K towards which the flow points.
For a boundary curve the deviation between flow and normal is greatest at an angle found by branch and bound in balls; two
boundary points at exact angles show the violation.""",
    methods=(
        CHEAP,
        Consequence(FormulaSubject, by_convexity),
        ProofMethod(FormulaSubject, flow.normality_refuted),
        ProofMethod(FormulaSubject, sampling.normality),
        ProofMethod(CurveSubject, curve_signs.normality),
        ProofMethod(CurveSubject, curve_deviation.normality),
        ProofMethod(CurveSubject, curve_refutation.normality_of_a_dent),
    ),
    needs=("convexity",),
    refuters=(ProofMethod(FormulaSubject, partial(flow.normality_refuted, choices=2, near=False)),),
)
