"""0 in K."""

from duhem.proof.claims.claim import CHEAP, DEAR, Claim, ProofMethod
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import curve_refutation, curve_signs, evaluation

CLAIM = Claim(
    name="origin",
    statement="0 is in K(sigma_n) for every sigma_n < 0",
    theory="""\
The indicator of K, taken as pseudo-potential Phi*, must be least (= 0) at zero force: that is 0 in K, or g(0) <= 0
(Antoni et al. 2007, Eqs. 27, 34).  Then Phi* >= 0 = Phi*(0) and, with normality, the dissipation is never negative.
Decided by evaluating g at the origin and deciding the sign over all parameters; a formula that reads 0/0 there is
taken by closure when its set is star-shaped about 0; else the claim stays open, and it is said where g has no value.
For a law given by a boundary curve T, K holds the points the curve winds around: the turns of T around 0 are counted in
balls, or T . d > 0, so that T turns as often as the flow d does.""",
    methods=(
        CHEAP,
        ProofMethod(FormulaSubject, evaluation.origin_refuted),
        DEAR,
        ProofMethod(FormulaSubject, evaluation.origin_undefined),
        ProofMethod(CurveSubject, curve_signs.origin),
        ProofMethod(CurveSubject, curve_refutation.origin),
    ),
    refuters=(ProofMethod(FormulaSubject, evaluation.origin_refuted),),
)
