"""The wedge micro-model as a derivation: from Coulomb's law on the sides to asymmetric coefficients, nothing stored.

Source: Antoni, Ligier, Saffré, Pastor (2007), section 2.2, Eqs. (3)-(18).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import sympy as sp

from duhem.derivation import Derivation, Equation
from duhem.derivation.equation import Names
from duhem.errors import DuhemError
from duhem.expression import symbol
from duhem.law.catalogue import load_formula
from duhem.micromodel.facets import DELTA, F_0, HEIGHT, K_N, MU, SLOPE, U, apparent, averages, height, sliding, spring_force
from duhem.micromodel.proofs import asymmetry, load, proofs
from duhem.omitted import LeftOut
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["derive"]

_H = sp.Function("H")
_PERIOD = symbol("L", positive=True)
_PLUS, _MINUS = symbol("mu_a_plus"), symbol("mu_a_minus")
_LATEX = {
    SLOPE["alpha"]: r"(\tan\alpha)",
    SLOPE["beta"]: r"(\tan\beta)",
    MU["alpha"]: r"\mu_\alpha",
    MU["beta"]: r"\mu_\beta",
    HEIGHT: "h",
    K_N: "k_n",
    DELTA: r"\delta",
    F_0: "F_0",
    U: "u_{t_a}",
    _PERIOD: "L",
    sp.Symbol("mean_F_n"): r"\overline{F_n}",
    sp.Symbol("mean_F_t"): r"\overline{F_t}",
    symbol("mean_L", positive=True): r"\overline{L}",
    _PLUS: r"\mu_a^{+}",
    _MINUS: r"\mu_a^{-}",
}


def derive() -> Derivation:
    """Numbered equations from the facet law to Eq. (18), each computed; DuhemError if a proof fails.

    The result is the one-dimensional law (1) with the coefficients mu_a_plus, mu_a_minus.
    """
    found = proofs()
    if open_ := [name for name, evidence in found.items() if evidence.verdict is not Verdict.PROVED]:
        raise DuhemError(f"the micro-model's {', '.join(open_)} could not be proved")
    names = Names.of(load_formula("antoni2007-1d"))
    left_out = (
        LeftOut("flexural stiffness of the springs", "taken as infinite: the springs only contract and release"),
        LeftOut("oblique slip", "the law wedge has its boundary curve; here slip is along t_a"),
    )
    return Derivation("the wedge micro-model", tuple(_equations(found)), left_out, replace(names, latex=names.latex | _LATEX))


def _equations(found: Mapping[str, Evidence]) -> Iterator[Equation]:
    yield from _sides()
    yield from _averages()
    yield from _asymmetry(found)


def _sides() -> Iterator[Equation]:
    section = "One side of a wedge"
    x, t = symbol("x"), symbol("t")
    normal, tangential = symbol("F_n", negative=True), symbol("F_t")
    coulomb = sp.Eq(tangential + t * normal, -x * (normal - t * tangential), evaluate=False)
    yield Equation("3", "coulomb", coulomb, "Coulomb's law on a side of slope t with local coefficient x, slip along +t_a", section)
    h = apparent(x, t, +1)
    yield Equation("6", "apparent_coefficient", sp.Eq(_H(x, t), h, evaluate=False), "-F_t/F_n solved from (3), with t = tan y", section)
    _same(apparent(x, t, -1), h.subs(x, -x))
    note = "slip along -t_a reverses the sign of the local coefficient"
    yield Equation("D1", "apparent_coefficient_reversed", sp.Eq(_H(-x, t), apparent(x, t, -1), evaluate=False), note, section)
    for number, side in (("4", "alpha"), ("16", "beta")):
        relation = sp.StrictGreaterThan(sliding(side), 0, evaluate=False)
        yield Equation(number, f"sliding_{side}", relation, f"springs slide up Gamma_{side}", section)


def _averages() -> Iterator[Equation]:
    section = "Averages over a period"
    period = sp.Eq(_PERIOD, HEIGHT * (1 / SLOPE["alpha"] + 1 / SLOPE["beta"]), evaluate=False)
    yield Equation("D2", "period", period, "horizontal length of one wedge", section)
    u_n, force = symbol("u_n"), symbol("F_n", negative=True)
    for side in ("alpha", "beta"):
        relation = sp.Eq(u_n, height(side), evaluate=False)
        yield Equation("8", f"height_{side}", relation, f"height of a spring's end on Gamma_{side}", section)
    relation = sp.Eq(force, spring_force("alpha").subs(height("alpha"), u_n), evaluate=False)
    note = "force of a spring on the wedge, F_0 = -k_n (delta - h); the paper prints -(F_0 + k_n u_n), from which (10) does not follow"
    yield Equation("9", "spring_force", relation, note, section)
    plus, minus = averages(+1), averages(-1)
    mean_normal, mean_tangential = sp.Symbol("mean_F_n"), sp.Symbol("mean_F_t")
    yield Equation("10", "mean_normal_force", sp.Eq(mean_normal, sp.expand(plus.normal)), "integral (7) over both sides", section)
    relation = sp.Eq(mean_tangential, -_PLUS * mean_normal, evaluate=False)
    yield Equation("12", "mean_tangential_force", relation, "integral (11) is proportional to (7), slip along +t_a", section)
    ta, tb, ma, mb = SLOPE["alpha"], SLOPE["beta"], MU["alpha"], MU["beta"]
    upward = (_H(ma, ta) * tb + _H(mb, -tb) * ta) / (ta + tb)
    downward = (_H(mb, tb) * ta + _H(ma, -ta) * tb) / (ta + tb)
    for number, name, written, mean, way, form in (
        ("13", "mu_a_plus", _PLUS, plus, "+t_a", upward),
        ("15", "mu_a_minus", _MINUS, minus, "-t_a", downward),
    ):
        _same(form.replace(_H, lambda x, t: (x + t) / (1 - x * t)), mean.coefficient)
        note = f"apparent coefficient for slip along {way}"
        yield Equation(number, f"{name}_by_sides", sp.Eq(written, form, evaluate=False), f"{note}, in terms of (6)", section)
        yield Equation(f"{number}'", name, sp.Eq(written, mean.coefficient, evaluate=False), f"{note}, ratio of (11) to (7)", section)


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
