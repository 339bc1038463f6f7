"""The wedge micro-model as a derivation: from Coulomb's law on the sides to asymmetric coefficients, nothing stored.

What it claims is proved for every slope, local coefficient, spring bed and distribution of heights.  Each answer is an
:class:`duhem.proof.verdict.Evidence`: an identity by cancelling, a sign by duhem.proof.decide.
Source: Antoni, Ligier, Saffré, Pastor (2007), section 2.2, Eqs. (2)-(20); of the proofs Eqs. (13)-(18) and the remark after (18).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import sympy as sp

from duhem.derivation import Derivation, Equation
from duhem.derivation.equation import Names, columns, equal
from duhem.errors import DuhemError
from duhem.expression import symbol
from duhem.law.catalogue import load_formula
from duhem.micromodel.wedge import (
    DELTA,
    F_0,
    HEIGHT,
    K_F,
    K_N,
    MU,
    PERIOD,
    SLOPE,
    SPANS,
    U,
    apparent,
    averages,
    height,
    mean,
    side_forces,
    sliding,
    spring_force,
)
from duhem.omitted import LeftOut
from duhem.proof.decide import Question, Sense, decide
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["derive"]

# -- proofs ------------------------------------------------------------------------------------------------------------


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
    """Proved if every question is answered with yes."""
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
        (sp.factor((alone - most).subs(on_circle)), Sense.POSITIVE, given),
    )
    questions = [Question(expr, sense, hypotheses) for expr, sense, hypotheses in steps]
    return _decided(questions, "(T.d)(T'.e) exceeds (T.e)(T'.d) already by the side that is climbed", "a step stayed open")


def _parts(t: sp.Expr, u: sp.Symbol) -> tuple[sp.Expr, sp.Expr, sp.Expr, sp.Expr]:
    """R.d, R.e, R'.e, R'.d of a side as :func:`star_shaped` states them."""
    free = 1 - u * t * _C
    turned = u / free + u * t**2 * (1 - _C**2) / (1 + t**2 * _C**2) / free**2  # w^2 = 1 + t^2 (1 - c^2)/(1 + t^2 c^2)
    return t * _C + u * (1 + t**2 * _C**2) / free, -t * _S / free, turned, -(u**2) * t * _S / free**2


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


_H = sp.Function("H")
_PERIOD = symbol("L", positive=True)
_PLUS, _MINUS = symbol("mu_a_plus"), symbol("mu_a_minus")
_LOCAL = {side: symbol(f"mu_ta_{side}") for side in SPANS}
_K_T, _PRESSING, _ALONG = symbol("k_t", positive=True), symbol("N", positive=True), symbol("S")
_BENT, _STRESS = symbol("ue_ta"), symbol("sigma_ta")
_BENT_B, _STRESS_B = symbol("ue_tb"), symbol("sigma_tb")
_LATEX = {
    SLOPE["alpha"]: r"(\tan\alpha)",
    SLOPE["beta"]: r"(\tan\beta)",
    MU["alpha"]: r"\mu_\alpha",
    MU["beta"]: r"\mu_\beta",
    HEIGHT: "h",
    K_N: "k_n",
    K_F: "k_f",
    _K_T: "k_t",
    _BENT: r"u^{\mathrm{e}}_{t_a}",
    _BENT_B: r"u^{\mathrm{e}}_{t_b}",
    _STRESS: r"\sigma_{t_a}",
    _STRESS_B: r"\sigma_{t_b}",
    DELTA: r"\delta",
    F_0: "F_0",
    U: "u_{t_a}",
    _PERIOD: "L",
    sp.Symbol("mean_F_n"): r"\overline{F_n}",
    sp.Symbol("mean_F_t"): r"\overline{F_t}",
    symbol("mean_L", positive=True): r"\overline{L}",
    _PLUS: r"\mu_a^{+}",
    _MINUS: r"\mu_a^{-}",
} | {symbol(f"{name}_{side}"): rf"{written}^{{\{side}}}" for side in SPANS for name, written in (
    ("F_n", "F_n"), ("F_ta", "F_{t_a}"), ("mu_ta", r"\mu_{t_a}"))}  # fmt: skip


def derive() -> Derivation:
    """Numbered equations from the facet law to Eq. (20), each computed; DuhemError if a proof fails.

    The result is the one-dimensional law (1) with the coefficients mu_a_plus, mu_a_minus.
    """
    found = proofs()
    if open_ := [name for name, evidence in found.items() if evidence.verdict is not Verdict.PROVED]:
        raise DuhemError(f"the micro-model's {', '.join(open_)} could not be proved")
    names = Names.of(load_formula("antoni2007-1d"))
    left_out = (
        LeftOut("bending of springs while they slide", "they only contract and release then; they bend before, Eqs. (19) and (20)"),
        LeftOut("oblique slip", "the law wedge has its boundary curve; here slip is along t_a"),
    )
    return Derivation("the wedge micro-model", tuple(_equations(found)), left_out, replace(names, latex=names.latex | _LATEX))


def _equations(found: Mapping[str, Evidence]) -> Iterator[Equation]:
    yield from _sides()
    yield from _averages(found)
    yield from _asymmetry(found)
    yield from _stiffness()


def _sides() -> Iterator[Equation]:
    section = "One side of a wedge"
    x, t = symbol("x"), symbol("t")
    normal, tangential = symbol("F_n", negative=True), symbol("F_t")
    forces = columns((tangential, normal), side_forces(_PRESSING, _ALONG, t))
    note = "force of a spring on a side of slope t, along t_a and n, from N that presses the side and S along its tangent"
    yield Equation("2", "side_forces", forces, note, section)
    coulomb = sp.Eq(tangential + t * normal, -x * (normal - t * tangential), evaluate=False)
    yield Equation("3", "coulomb", coulomb, "Coulomb's law on a side of slope t with local coefficient x, slip along +t_a", section)
    h = apparent(x, t, +1)
    yield Equation("6", "apparent_coefficient", sp.Eq(_H(x, t), h, evaluate=False), "-F_t/F_n solved from (3), with t = tan y", section)
    _same(apparent(x, t, -1), h.subs(x, -x))
    note = "slip along -t_a reverses the sign of the local coefficient"
    yield Equation("D1", "apparent_coefficient_reversed", sp.Eq(_H(-x, t), apparent(x, t, -1), evaluate=False), note, section)
    local = columns(_LOCAL.values(), (_H(MU["alpha"], SLOPE["alpha"]), _H(MU["beta"], -SLOPE["beta"])))
    yield Equation("5", "apparent_coefficients", local, "apparent coefficients of the two sides, slip along +t_a", section)
    for number, side in (("4", "alpha"), ("16", "beta")):
        relation = sp.StrictGreaterThan(sliding(side), 0, evaluate=False)
        yield Equation(number, f"sliding_{side}", relation, f"springs slide up Gamma_{side}", section)


def _integral(stem: str) -> sp.Expr:
    """The mean over a period of the force of that name, as a function of u_ta on either side; not evaluated."""
    spans = {side: tuple(end.xreplace({PERIOD: _PERIOD}) for end in map(sp.sympify, span)) for side, span in SPANS.items()}
    return sp.Add(*(sp.Integral(sp.Function(f"{stem}_{side}")(U), span) for side, span in spans.items())) / _PERIOD


def _averages(found: Mapping[str, Evidence]) -> Iterator[Equation]:
    section = "Averages over a period"
    period = sp.Eq(_PERIOD, PERIOD, evaluate=False)
    yield Equation("D2", "period", period, "horizontal length of one wedge", section)
    mean_normal, mean_tangential = sp.Symbol("mean_F_n"), sp.Symbol("mean_F_t")
    relation = equal(mean_normal, _integral("F_n"))
    yield Equation("7", "mean_normal_integral", relation, "mean normal force, per unit of area of the nominal plane", section)
    u_n, force = symbol("u_n"), symbol("F_n", negative=True)
    for side in ("alpha", "beta"):
        relation = sp.Eq(u_n, height(side), evaluate=False)
        yield Equation("8", f"height_{side}", relation, f"height of a spring's end on Gamma_{side}", section)
    relation = sp.Eq(force, spring_force("alpha").subs(height("alpha"), u_n), evaluate=False)
    note = "force of a spring on the wedge, F_0 = -k_n (delta - h); the paper prints -(F_0 + k_n u_n), from which (10) does not follow"
    yield Equation("9", "spring_force", relation, note, section)
    yield Equation("10", "mean_normal_force", sp.Eq(mean_normal, sp.expand(averages(+1).normal)), "integral (7) over both sides", section)
    relation = equal(mean_tangential, _integral("F_ta"))
    yield Equation("11", "mean_tangential_integral", relation, "mean tangential force, with (3) and (5) on either side", section)
    relation = sp.Eq(mean_tangential, -_PLUS * mean_normal, evaluate=False)
    yield Equation("12", "mean_tangential_force", relation, "integral (11) is proportional to (7), slip along +t_a", section)
    ta, tb, ma, mb = SLOPE["alpha"], SLOPE["beta"], MU["alpha"], MU["beta"]
    upward = (_H(ma, ta) * tb + _H(mb, -tb) * ta) / (ta + tb)
    downward = (_H(mb, tb) * ta + _H(ma, -ta) * tb) / (ta + tb)
    yield from _coefficient("13", _PLUS, +1, upward, section)
    yield _exchange(found["reversal (14)"], section)
    yield from _coefficient("15", _MINUS, -1, downward, section)


def _coefficient(number: str, written: sp.Symbol, direction: int, form: sp.Expr, section: str) -> Iterator[Equation]:
    """By sides, and as the ratio of the averages."""
    ratio, note = averages(direction).coefficient, f"apparent coefficient for slip along {'+' if direction > 0 else '-'}t_a"
    _same(form.replace(_H, lambda x, t: (x + t) / (1 - x * t)), ratio)
    yield Equation(number, f"{written}_by_sides", sp.Eq(written, form, evaluate=False), f"{note}, in terms of (6)", section)
    yield Equation(f"{number}'", f"{written}", sp.Eq(written, ratio, evaluate=False), f"{note}, ratio of (11) to (7)", section)


def _exchange(proof: Evidence, section: str) -> Equation:
    here = (*SLOPE.values(), *MU.values())
    minus, plus = (sp.Function(str(written)) for written in (_MINUS, _PLUS))
    relation = equal(minus(*here), plus(*(here[i] for i in (1, 0, 3, 2))))
    note = f"slip along -t_a is slip along +t_a with alpha and beta exchanged, proved ({proof.method})"
    return Equation("14", "exchange", relation, note, section)


def _stiffness() -> Iterator[Equation]:
    """Before they slide the springs stick and bend: the mean (11) of what they pull with is the tangential stress."""
    section = "Stiffness of the interface"
    pull, bent = K_F * _BENT, (_BENT, _BENT_B)
    relation = columns((symbol(f"F_ta_{side}") for side in SPANS), [pull, pull])
    note = "what springs that stick on the sides pull with as they bend by ue; k_f: flexural stiffness per unit of area, large but finite"
    yield Equation("D8", "bending", relation, note, section)
    stiffness = sp.cancel(mean(dict.fromkeys(SPANS, pull)) / _BENT)
    note = "stiffness of the interface: mean (11) of (D8) for a unit of ue; height and slopes of the wedges cancel"
    yield Equation("D9", "stiffness", equal(_K_T, stiffness), note, section)
    note = "reversible slip along t_a under the tangential stress, before the springs slide"
    yield Equation("19", "elastic_slip", equal(_BENT, _STRESS / _K_T), note, section)
    relation = columns(bent, [stress / _K_T for stress in (_STRESS, _STRESS_B)])
    yield Equation(
        "20", "elastic_slip_in_the_plane", relation, "the same in the plane, the springs bending alike in all directions", section
    )


def _asymmetry(found: Mapping[str, Evidence]) -> Iterator[Equation]:
    section = "Asymmetry"
    relation = sp.Eq(_PLUS - _MINUS, asymmetry(), evaluate=False)
    yield Equation("17", "asymmetry", relation, f"proved ({found['difference (17)'].method}): (13) less (15)", section)
    steeper = sp.And(
        sp.GreaterThan(SLOPE["alpha"], SLOPE["beta"], evaluate=False),
        sp.GreaterThan(MU["alpha"], MU["beta"], evaluate=False),
        evaluate=False,
    )
    relation = sp.Implies(steeper, sp.GreaterThan(_PLUS, _MINUS, evaluate=False), evaluate=False)
    proof = found["implication (18)"]
    yield Equation("18", "implication", relation, f"proved ({proof.method}): {proof.detail}", section)
    key = found["independence of the springs"]
    for number, variable in zip(("D3", "D4", "D5"), (K_N, HEIGHT, F_0), strict=True):
        relation = sp.Eq(sp.Derivative(_PLUS, variable), averages(+1).coefficient.diff(variable), evaluate=False)
        yield Equation(number, f"no_{variable}", relation, f"proved ({key.method}): {key.detail}", section)
    key, sides = found["any distribution of heights"], 1 / SLOPE["alpha"] + 1 / SLOPE["beta"]
    mean_normal, mean_tangential = sp.Symbol("mean_F_n"), sp.Symbol("mean_F_t")
    relation = sp.Eq(mean_normal * symbol("mean_L", positive=True), sides * load(), evaluate=False)
    note = f"for any density p of heights and any force f of a spring at height z, proved ({key.method}): {key.detail}"
    yield Equation("D6", "any_heights_normal", relation, note, section)
    relation = sp.Eq(mean_tangential, -_PLUS * mean_normal, evaluate=False)
    yield Equation("D7", "any_heights", relation, "with the coefficient (13) of a single wedge", section)


def _same(one: sp.Expr, other: sp.Expr) -> None:
    if sp.cancel(sp.together(one - other)) != 0:
        raise DuhemError("two forms of one coefficient of the micro-model differ")
