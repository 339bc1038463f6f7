"""Stresses from a free energy."""

from duhem.proof.claims.claim import CHEAP, Claim

CLAIM = Claim(
    name="state_laws",
    statement="sigma = dpsi/du = -dpsi/du_in, psi convex",
    theory="""\
The free energy psi_C = (u - u_in) . k (u - u_in)/2 (Antoni et al. 2007, Eq. 30), here with any symmetric positive
semidefinite stiffness k, gives the stress by differentiation with respect to u and, with the opposite sign, to u_in
(Eqs. 25, 31).  It is convex in (u, u_in) jointly: a sum of squares of linear functions.""",
    methods=(CHEAP,),
)
