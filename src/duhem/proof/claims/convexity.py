"""K convex."""

from duhem.proof.claims.claim import CHEAP, DEAR, Claim, Finder, ProofMethod
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import chords, convex_sums, curve_refutation, curve_signs, implicit, sampling

CLAIM = Claim(
    name="convexity",
    statement="K(sigma_n) = {g <= 0} is convex for every sigma_n < 0",
    theory="""\
The claim is about the set, not about the function: sqrt(|s|) - 1 is not convex and its set is.  Methods, in order:
the kernel's rules, which are composition (g is quasiconvex by the rules of disciplined convex programming), polyhedra (K is the
polyhedron of its faces), the gauge gamma of a star-shaped K in two forces (gamma'' + gamma >= 0 as a measure, jumps of gamma' at
seams included) and fans (one formula in each cone between rays); sums of squares (v . Hess g v of a polynomial g, unless there is
such a gauge); a chord across the deepest dent of a polynomial law; a chord from where a ball lies farthest along a load; a quick
look for a chord that leaves K, then for one between exact points of its faces, edges and whiskers, or from an edge to a place beside
it; the kernel's rules with more steps; chords across a dent or a kink of the gauge; implicit form (tangential second
derivatives on the boundary); Hessian of g branch by branch;
chords across dents at places without second derivatives.
Refuted only by two points of K whose midpoint is outside, in exact arithmetic.
A boundary curve T bounds a convex set if T' x T'' > 0 and the tangent turns once; refuted by a point inside a triangle of
boundary points that the curve does not wind around.""",
    methods=(
        CHEAP,
        ProofMethod(FormulaSubject, chords.convexity_at_clear_dents),
        Finder(FormulaSubject, convex_sums.convexity),
        ProofMethod(FormulaSubject, chords.convexity_at_deepest_dents),
        ProofMethod(FormulaSubject, chords.convexity_at_far_points),
        ProofMethod(FormulaSubject, chords.convexity_by_scouting),
        ProofMethod(FormulaSubject, chords.convexity_between_exact_rays),
        ProofMethod(FormulaSubject, chords.convexity_beside_edges),
        DEAR,
        ProofMethod(FormulaSubject, chords.convexity_at_dents),
        ProofMethod(FormulaSubject, chords.convexity_at_seams),
        ProofMethod(FormulaSubject, implicit.convexity),
        ProofMethod(FormulaSubject, implicit.hessian),
        ProofMethod(FormulaSubject, chords.convexity_at_narrow_dents),
        ProofMethod(FormulaSubject, chords.convexity_by_thorough_scouting),
        ProofMethod(FormulaSubject, sampling.chords),
        ProofMethod(CurveSubject, curve_signs.convexity),
        ProofMethod(CurveSubject, curve_refutation.convexity),
    ),
    refuters=(
        ProofMethod(FormulaSubject, chords.convexity_by_scouting),
        ProofMethod(FormulaSubject, chords.convexity_at_seams),
    ),
)
