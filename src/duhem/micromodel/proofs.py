"""What the micro-model claims, proved for every slope, local coefficient, spring bed and distribution of heights.

Each answer is an :class:`duhem.proof.verdict.Evidence`: an identity by cancelling, a sign by the deciders of duhem.proof.decide.
Source: Antoni et al. (2007), Eqs. (13)-(18) and the remark after (18).
"""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from duhem.expression import symbol
from duhem.micromodel.facets import DELTA, F_0, HEIGHT, K_N, MU, SLOPE, apparent, averages, sliding
from duhem.micromodel.oblique import star_shaped
from duhem.proof.decide import Question, Sense, decide
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["asymmetry", "difference", "heights_cancel", "implication", "independence", "load", "proofs", "reversal"]


def proofs() -> Mapping[str, Evidence]:
    """Every statement by name."""
    return {
        "reversal (14)": reversal(),
        "difference (17)": difference(),
        "implication (18)": implication(),
        "independence of the springs": independence(),
        "any distribution of heights": heights_cancel(),
        "oblique limit curve star-shaped": star_shaped(),
    }


def asymmetry() -> sp.Expr:
    """mu_a_plus - mu_a_minus as the paper prints it (Eq. 17); :func:`difference` shows that it is so."""
    ta, tb, ma, mb = SLOPE["alpha"], SLOPE["beta"], MU["alpha"], MU["beta"]
    return 2 * ta * tb / (ta + tb) * _bracket() / ((1 - ma**2 * ta**2) * (1 - mb**2 * tb**2))


def _bracket() -> sp.Expr:
    ta, tb, ma, mb = SLOPE["alpha"], SLOPE["beta"], MU["alpha"], MU["beta"]
    return (ma**2 - mb**2) + ma**2 * mb**2 * (ta**2 - tb**2) + (ma**2 * ta**2 - mb**2 * tb**2)


def reversal() -> Evidence:
    """Slip along -t_a on a profile is slip along +t_a on the profile with alpha and beta exchanged (Eq. 14)."""
    exchange = {SLOPE["alpha"]: SLOPE["beta"], SLOPE["beta"]: SLOPE["alpha"], MU["alpha"]: MU["beta"], MU["beta"]: MU["alpha"]}
    gap = averages(+1).coefficient.xreplace(exchange) - averages(-1).coefficient
    return _identity(gap, "mu_a_minus is mu_a_plus with alpha and beta exchanged")


def difference() -> Evidence:
    """Eq. (17) as an identity of rational functions."""
    gap = averages(+1).coefficient - averages(-1).coefficient - asymmetry()
    return _identity(gap, "mu_a_plus - mu_a_minus is the right side of Eq. (17)")


def implication() -> Evidence:
    """Eq. (18): tan alpha = tan beta + p and mu_alpha = mu_beta + q with p, q >= 0 leave no negative term in Eq. (17)."""
    p, q = symbol("p", nonnegative=True), symbol("q", nonnegative=True)
    steeper = {SLOPE["alpha"]: SLOPE["beta"] + p, MU["alpha"]: MU["beta"] + q}
    terms = decide(Question(sp.expand(_bracket().subs(steeper, simultaneous=True)), Sense.NONNEGATIVE))
    given = tuple(sliding(side) > 0 for side in SLOPE)
    squares = [1 - MU[side] ** 2 * SLOPE[side] ** 2 for side in SLOPE]
    below = [decide(Question(square, Sense.POSITIVE, given)) for square in squares]
    if terms.holds is not True or any(answer.holds is not True for answer in below):
        return Evidence(Verdict.UNDECIDED, "none", "a sign in Eq. (17) stayed open")
    methods = ", ".join(sorted({terms.method, *(answer.method for answer in below)}))
    return Evidence(Verdict.PROVED, methods, "the bracket of Eq. (17) is >= 0, its denominators > 0 by Eqs. (4), (16)")


def independence() -> Evidence:
    """k_n, h, delta (through F_0) do not occur in the coefficients."""
    springs = {K_N, HEIGHT, DELTA, F_0}
    found = [averages(direction) for direction in (+1, -1)]
    if any(a.coefficient.free_symbols & springs or not a.normal.free_symbols & springs for a in found):
        return Evidence(Verdict.UNDECIDED, "none", "a property of the springs remains")
    return Evidence(Verdict.PROVED, "cancelling", "tangential and normal averages have the common factor F_0 - k_n h/2")


_Z, _DENSITY, _FORCE = symbol("z", positive=True), sp.Function("p"), sp.Function("f")


def load() -> sp.Integral:
    """The double integral of p(h) f(z, h) over all heights h and 0 <= z <= h."""
    return sp.Integral(_DENSITY(HEIGHT) * sp.Integral(_FORCE(_Z, HEIGHT), (_Z, 0, HEIGHT)), (HEIGHT, 0, sp.oo))


def heights_cancel() -> Evidence:
    """For any density p of heights and any force f(z, h) of a spring at height z on an asperity of height h.

    On a side of slope t, du = dz/t turns its share into 1/t times the double integral of p f, the same for both sides.
    """
    every = symbol("u", positive=True)
    common = load()
    for direction in (+1, -1):
        normal = tangential = sp.S.Zero
        for side, signed in (("alpha", SLOPE["alpha"]), ("beta", -SLOPE["beta"])):
            slope = SLOPE[side]
            inner = sp.Integral(_FORCE(every * slope, HEIGHT), (every, 0, HEIGHT / slope)).transform(every * slope, _Z)
            if inner.limits != ((_Z, 0, HEIGHT),) or sp.cancel(inner.function * slope - _FORCE(_Z, HEIGHT)) != 0:
                return Evidence(Verdict.UNDECIDED, "none", "the heights do not factor out")
            normal += common / slope
            tangential -= apparent(MU[side], signed, direction) * common / slope
        if sp.cancel(sp.together(-direction * tangential / normal) - averages(direction).coefficient) != 0:
            return Evidence(Verdict.UNDECIDED, "none", "the heights change the coefficients")
    return Evidence(Verdict.PROVED, "change of variable", "both averages are the same double integral of p f times a function of the shape")


def _identity(gap: sp.Expr, detail: str) -> Evidence:
    if sp.cancel(sp.together(gap)) != 0:
        return Evidence(Verdict.UNDECIDED, "none", "the two sides differ")
    return Evidence(Verdict.PROVED, "identity", detail)
