"""Dissipation potential in closed form."""

from duhem.proof.claims.claim import Claim, ProofMethod
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import curve_signs, polar_gauge

CLAIM = Claim(
    name="duality",
    statement="the dissipation potential in closed form is the support function of K",
    theory="""\
The potential dual to the indicator of K is its support function Phi(d) = sup of sigma . d over K (Legendre-Fenchel);
for K = radius {gauge <= 1} it is the radius times the polar gauge (Rockafellar 1970, Theorems 14.5, 15.3).  For Eq. (35):
Phi(d) = |sigma_n| sqrt((mu_a^+- d_a)^2 + (mu_b^+- d_b)^2), each sign that of d_i, and Phi** = Phi.
Where the rules give no closed form the claim has no content.""",
    methods=(
        ProofMethod(FormulaSubject, polar_gauge.duality),
        ProofMethod(CurveSubject, curve_signs.duality),
    ),
)
