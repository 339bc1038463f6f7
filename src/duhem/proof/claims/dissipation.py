"""Dissipation never negative."""

from functools import partial

from duhem.proof.claims.claim import CHEAP, DEAR, Claim, Finder, ProofMethod
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import curve_refutation, curve_signs, flow, implicit, sampling, shares

CLAIM = Claim(
    name="dissipation",
    statement="force . flow >= 0 at every boundary point",
    theory="""\
The intrinsic dissipation of the law reduces to D = sigma . u_in' (Clausius-Duhem, Antoni et al. 2007, Eqs. 22, 23).
It follows from 0 in K and normality (Fenchel: D = Phi*(sigma) + Phi(u_in') >= 0), but does not need them: a star-shaped K
with associated flow dissipates by Euler's relation, as does any g = A - B of degrees a > b with B > 0, and a non-associated
law may dissipate too.
Where g has a tip, as at an apex, and the formula of the flow no value, the slip is any mean of limits of the flow there (Koiter 1953).
Of several surfaces each flow is asked wherever its surface is 0 in K; then every non-negative combination dissipates too.
Refuted by a boundary point, held between two rational ones, where force . flow < 0 over the whole box.
For a boundary curve T with flow d it is the sign of T . d all around, in balls or by sign rules for all parameters.""",
    methods=(
        CHEAP,
        Finder(FormulaSubject, shares.dissipation_of_potential),
        Finder(FormulaSubject, shares.dissipation),
        ProofMethod(FormulaSubject, flow.dissipation_refuted),
        DEAR,
        ProofMethod(FormulaSubject, implicit.dissipation),
        ProofMethod(FormulaSubject, sampling.dissipation),
        ProofMethod(CurveSubject, curve_signs.dissipation),
        ProofMethod(CurveSubject, curve_refutation.dissipation),
    ),
    needs=("origin", "normality"),
    refuters=(ProofMethod(FormulaSubject, partial(flow.dissipation_refuted, choices=2)),),
)
