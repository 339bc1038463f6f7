"""Boundary C^1."""

from duhem.proof.claims.claim import CHEAP, DEAR, Claim, Finder, ProofMethod
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import convex_sums, corners, curve_signs, implicit

CLAIM = Claim(
    name="smoothness",
    statement="the boundary of K(sigma_n), sigma_n < 0, is C^1 in the forces: the outward unit normal is continuous along g = 0",
    theory="""\
Where the boundary is C^1 the slip direction is a function of the stress; at a corner it is only confined to a cone.
A kink of abs, pos or neg under an even power, or inside a Euclidean norm, disappears when the function vanishes on it:
that is why Eq. (35) is C^1 across its quadrant seams though its four branches differ.  The tip at zero force, where
g is not differentiable, lies inside K for sigma_n < 0 and does not touch the boundary.
Refuted by a corner held in a box, with two normals that are provably not parallel, or by an exact point from which open cones
about two opposite directions leave K.
A boundary curve is C^1 where it is simple (convex, or T x T' > 0), analytic in its angle and T' is never 0.""",
    methods=(
        CHEAP,
        Finder(FormulaSubject, convex_sums.smoothness),
        ProofMethod(FormulaSubject, corners.smoothness_at_sharp_points),
        ProofMethod(FormulaSubject, corners.smoothness),
        DEAR,
        ProofMethod(FormulaSubject, implicit.smoothness),
        ProofMethod(CurveSubject, curve_signs.smoothness),
    ),
    refuters=(ProofMethod(FormulaSubject, corners.smoothness_at_sharp_points), ProofMethod(FormulaSubject, corners.smoothness)),
)
