"""What the micro-model claims, proved for every slope, local coefficient, spring bed and distribution of heights.

Each answer is an :class:`duhem.proof.verdict.Evidence`: an identity by cancelling, a sign by the deciders of duhem.proof.decide.
Source: Antoni et al. (2007), Eqs. (13)-(18) and the remark after (18).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy as sp

from duhem.expression import symbol
from duhem.micromodel.facets import DELTA, F_0, HEIGHT, K_N, MU, SLOPE, apparent, averages, sliding
from duhem.proof.decide import Question, Sense, decide
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["asymmetry", "difference", "heights_cancel", "implication", "independence", "load", "proofs", "reversal", "star_shaped"]

_X, _Y, _U, _V = (symbol(name, positive=True) for name in ("x", "y", "u", "v"))
_C, _S = symbol("c", nonnegative=True), symbol("s")


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
    given = tuple(sliding(side) > 0 for side in SLOPE)
    questions = [Question(sp.expand(_bracket().subs(steeper, simultaneous=True)), Sense.NONNEGATIVE)]
    questions += [Question(1 - MU[side] ** 2 * SLOPE[side] ** 2, Sense.POSITIVE, given) for side in SLOPE]
    detail = "the bracket of Eq. (17) is >= 0, its denominators > 0 by Eqs. (4), (16)"
    return _decided(questions, detail, "a sign in Eq. (17) stayed open")


def independence() -> Evidence:
    """k_n, h, delta (through F_0) do not occur in the coefficients."""
    springs = {K_N, HEIGHT, DELTA, F_0}
    found = [averages(direction) for direction in (+1, -1)]
    if any(a.coefficient.free_symbols & springs or not a.normal.free_symbols & springs for a in found):
        return _open("a property of the springs remains")
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
                return _open("the heights do not factor out")
            normal += common / slope
            tangential -= apparent(MU[side], signed, direction) * common / slope
        if sp.cancel(sp.together(-direction * tangential / normal) - averages(direction).coefficient) != 0:
            return _open("the heights change the coefficients")
    return Evidence(Verdict.PROVED, "change of variable", "both averages are the same double integral of p f times a function of the shape")


def _identity(gap: sp.Expr, detail: str) -> Evidence:
    if sp.cancel(sp.together(gap)) != 0:
        return _open("the two sides differ")
    return Evidence(Verdict.PROVED, "identity", detail)


def _decided(questions: Sequence[Question], detail: str, otherwise: str) -> Evidence:
    """Proved by the deciders if every question is answered with yes."""
    answers = [decide(question) for question in questions]
    if any(answer.holds is not True for answer in answers):
        return _open(otherwise)
    return Evidence(Verdict.PROVED, ", ".join(sorted({answer.method for answer in answers})), detail)


def _open(why: str) -> Evidence:
    return Evidence(Verdict.UNDECIDED, "none", why)


def star_shaped() -> Evidence:
    """The oblique limit curve runs around zero in polar order, T x T' > 0, for every profile with both sides sliding (Eqs. 4, 16).

    In the frame d = (cos phi, sin phi), e = (-sin phi, cos phi), with a side of slope t, u = w mu, w^2 = (1 + t^2)/(1 + t^2 c^2),
    D = 1 - u t c, c = cos phi, s = sin phi, the traction R of the side and its derivative R' by phi are

        R.d = t c + u (1 + t^2 c^2)/D,   R.e = -t s/D,   R'.e = u (w^2 - u t c)/D^2,   R'.d = -u^2 t s/D^2.

    T x T' = (T.d)(T'.e) - (T.e)(T'.d).  With x = tan alpha and y = tan beta as slopes x, -y and weights y, x the terms t c cancel in
    T.d, and (T.e)(T'.d) = x^2 y^2 s^2 (1/D_1 - 1/D_2)(u_1^2/D_1^2 - u_2^2/D_2^2) up to the factor 1/(x + y)^2.  For c >= 0 it is less
    than what the side alpha alone gives to (T.d)(T'.e); for c < 0 the sides change places (phi -> pi - phi).
    """
    if not all(_vanishes(gap) for gap in _identities()):
        return _open("an identity of the frame fails")
    alpha, beta = _parts(_X, _U), _parts(-_Y, _V)
    product = (_Y * alpha[1] + _X * beta[1]) * (_Y * alpha[3] + _X * beta[3])  # (T.e)(T'.d)
    ahead, behind = 1 / (1 - _U * _X * _C), 1 / (1 + _V * _Y * _C)
    most = _X**2 * _Y**2 * _S**2 * (ahead - behind) * _U**2 * ahead**2
    below = most - _X**2 * _Y**2 * _S**2 * (ahead - behind) * _V**2 * behind**2
    if not _vanishes(product - below):
        return _open("the product (T.e)(T'.d) has another form")
    alone = (_Y * (alpha[0] - _X * _C)) * (_Y * alpha[2])
    given = (_U * _X * _C < 1, _C <= 1)
    on_circle = {_S**2: 1 - _C**2}
    steps = (
        (1 - (1 + _X**2) * _C**2 / (1 + _X**2 * _C**2), Sense.NONNEGATIVE, (_C <= 1,)),  # w c <= 1, so u x c <= mu x < 1
        (ahead - behind, Sense.NONNEGATIVE, given),  # what is left out of (T.e)(T'.d) is negative
        (beta[0] + _Y * _C, Sense.NONNEGATIVE, given),  # what is left out of (T.d)(T'.e) is not
        (beta[2], Sense.NONNEGATIVE, given),
        (alpha[0] - _X * _C, Sense.POSITIVE, given),
        (alpha[2], Sense.POSITIVE, given),
        ((alone - most).subs(on_circle), Sense.POSITIVE, given),
    )
    questions = [Question(sp.together(expr), sense, hypotheses) for expr, sense, hypotheses in steps]
    return _decided(questions, "(T.d)(T'.e) exceeds (T.e)(T'.d) already by the side that is climbed", "a step stayed open")


def _parts(t: sp.Expr, u: sp.Symbol) -> tuple[sp.Expr, sp.Expr, sp.Expr, sp.Expr]:
    """R.d, R.e, R'.e, R'.d of a side as :func:`star_shaped` states them."""
    free = 1 - u * t * _C
    w2 = (1 + t**2) / (1 + t**2 * _C**2)
    return t * _C + u * (1 + t**2 * _C**2) / free, -t * _S / free, u * (w2 - u * t * _C) / free**2, -(u**2) * t * _S / free**2


def _identities() -> list[sp.Expr]:
    """What must vanish for those to be right, from R = (t + u c, u s)/D and u' = u t^2 c s/(1 + t^2 c^2)."""
    t, u = symbol("t"), _U
    mu = symbol("mu", positive=True)
    w = sp.sqrt((1 + t**2) / (1 + t**2 * _C**2))
    growth = t**2 * _C * _S / (1 + t**2 * _C**2)
    traction = ((t + u * _C) / (1 - u * t * _C), u * _S / (1 - u * t * _C))
    turned = [_C * sp.diff(r, _S) - _S * sp.diff(r, _C) + u * growth * sp.diff(r, u) for r in traction]

    def along(v: Sequence[sp.Expr]) -> sp.Expr:
        return v[0] * _C + v[1] * _S

    def across(v: Sequence[sp.Expr]) -> sp.Expr:
        return v[1] * _C - v[0] * _S

    found = (along(traction), across(traction), across(turned), along(turned))
    slope_of_u = sp.cancel(sp.together(-_S * sp.diff(sp.log(mu * w), _C))) - growth
    return [slope_of_u, *(a - b for a, b in zip(found, _parts(t, u), strict=True))]


def _vanishes(expr: sp.Expr) -> bool:
    """Whether an expression is 0 on c^2 + s^2 = 1."""
    numerator, _ = sp.fraction(sp.cancel(sp.together(expr)))
    return bool(sp.expand(sp.rem(sp.expand(numerator), _S**2 + _C**2 - 1, _S)) == 0)
