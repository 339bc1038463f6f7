"""K convex."""

from duhem.proof.claims.claim import Claim
from duhem.proof.methods import chords, composition, curve, curve_refutation, implicit, polar, polyhedral, sampling

CLAIM = Claim(
    name="convexity",
    statement="K(sigma_n) = {g <= 0} is convex for every sigma_n < 0",
    theory="""\
The claim is about the set, not about the function: sqrt(|s|) - 1 is not convex and its set is.  Methods, in order:
composition (g is quasiconvex by the rules of disciplined convex programming); a quick look for a chord that leaves K;
polyhedra (K is the intersection of the half-spaces of its faces); polar form (for the gauge gamma of a star-shaped K in
two forces, gamma'' + gamma >= 0 as a measure, jumps of gamma' at seams included); chords across a dent or a kink so
found; implicit form (tangential second derivatives on the boundary); Hessian of g branch by branch.
Refuted only by two points of K whose midpoint is outside, in exact arithmetic.
A boundary curve T bounds a convex set if T' x T'' > 0 and the tangent turns once; refuted by a point inside a triangle of
boundary points that the curve does not wind around.""",
    engines=(
        composition.convexity,
        chords.convexity_by_scouting,
        polyhedral.convexity,
        polar.convexity,
        chords.convexity_at_dents,
        chords.convexity_at_seams,
        implicit.convexity,
        implicit.hessian,
        chords.convexity_by_thorough_scouting,
        sampling.sampled,
    ),
    curve_engines=(curve.convexity, curve_refutation.convexity),
)
