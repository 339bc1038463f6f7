"""Contact and friction as one law: the bipotential proved, refuted and left open; wrong ones refuted by exact points."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import Any

import pytest
import sympy as sp

import duhem
from duhem import Criterion, Domain, ParametricCriterion, Verdict
from duhem.errors import InputError
from duhem.expression.parse import parse_expression
from duhem.proof.certificate import law_as_text
from duhem.proof.claims import COUPLED, EVERY
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.kernel.certificate import digest, stated
from duhem.proof.kernel.claims import objection
from duhem.proof.methods.coupled import homogeneity_along_rays
from duhem.proof.verdict import Evidence, Trust
from duhem.proof.verification import Confirmations, Coupled, Standing
from tests.long import mostly_long

ABOVE_0 = Domain(positive=True)
CLOSED = {
    "coulomb": "mu*norm(d_a, d_b)",
    "orthotropic": "norm(d_a*mu_a, d_b*mu_b)",
    "shifted-ellipse": "d_a*shift + norm(d_a*mu_a, d_b*mu_b)",
    "antoni2007-1d": "mu_minus*neg(d_t) + mu_plus*pos(d_t)",
    "box": "mu_a*abs(d_a) + mu_b*abs(d_b)",
    "antoni2007": "norm(mu_a_minus*neg(d_a) + mu_a_plus*pos(d_a), mu_b_minus*neg(d_b) + mu_b_plus*pos(d_b))",
    "superellipse": "((mu_a*abs(d_a))**(p/(p - 1)) + (mu_b*abs(d_b))**(p/(p - 1)))**((p - 1)/p)",
}


def friction(g: str, flow: Any = None, domain: Any = None, **parameters: Domain) -> Criterion:
    return Criterion("made", g, parameters, ("a", "b"), flow=flow, domain=domain or {})


def asked(law: Any, **given: Any) -> duhem.Verification:
    return duhem.verify(law, given, claims="origin", coupled=True)


@pytest.mark.parametrize("name", mostly_long(CLOSED, "coulomb", "shifted-ellipse", "superellipse"))
def test_a_law_with_a_gauge_has_the_bipotential(name: str) -> None:
    found = asked(name)
    assert found["homogeneity"].verdict is found["bipotential"].verdict is Verdict.PROVED
    assert found["homogeneity"].trust is found["bipotential"].trust is Trust.CHECKED
    coupled = found.coupled
    assert coupled is not None and coupled.support_function == CLOSED[name] and f"v_n = {CLOSED[name]} " in (coupled.dilatancy or "")
    assert found.to_dict()["coupled"] == {
        "bipotential": "proved",
        "trust": "checked",
        "support_function": CLOSED[name],
        "finite_where_zero": (),
        "dilatancy": coupled.dilatancy,
    }
    rechecked = duhem.recheck(found.certificate())
    assert all(rechecked[claim].confirmed for claim in (*COUPLED, "convexity", "normality", "duality"))


def test_fixed_values_stand_in_the_closed_form() -> None:
    coupled = asked("coulomb", mu="1/2").coupled
    assert coupled is not None and coupled.support_function == "norm(d_a, d_b)/2"


def test_without_a_closed_form_it_is_the_support_function_by_definition() -> None:
    found = asked("limacon", e="1/4")
    assert (found["bipotential"].verdict, found["bipotential"].method) == (Verdict.PROVED, "support-function")
    assert found.coupled is not None and found.coupled.support_function is found.coupled.dilatancy is None


@pytest.mark.parametrize(("flow", "method"), [(None, "support-function"), (("cos(phi)", "sin(phi)"), "one-normal")])
def test_a_boundary_curve_is_a_gauge_by_definition(flow: Any, method: str) -> None:
    disk = ParametricCriterion("disk", ("mu*cos(phi)", "mu*sin(phi)"), {"mu": ABOVE_0}, flow=flow)
    assert (asked(disk)["bipotential"].verdict, asked(disk)["bipotential"].method) == (Verdict.PROVED, method)


def test_a_flow_of_its_own_is_the_only_one_where_the_boundary_is_smooth() -> None:
    found = asked(friction("a**2 + b**2 - m**2*sigma_n**2", ("3*a", "3*b"), m=ABOVE_0))
    assert (found["bipotential"].verdict, found["bipotential"].method) == (Verdict.PROVED, "one-normal")
    law = law_as_text(found.criterion)
    settled = frozenset(EVERY) - {"bipotential", "smoothness"}
    assert "smoothness" in objection("bipotential", "one-normal", settled, stated(law), {})
    assert all(
        "does not show it" in objection("bipotential", rule, settled, stated(law), {}) for rule in ("support-function", "polar-gauge")
    )


def test_a_certificate_without_a_premise_is_not_confirmed() -> None:
    whole = asked("coulomb").certificate()
    for premise in ("homogeneity", "origin", "convexity", "normality", "duality"):
        document = {**whole, "claims": [row for row in whole["claims"] if row["claim"] != premise]}
        row = duhem.recheck({**document, "sha256": digest(document)})["bipotential"]
        assert not row.confirmed and premise in row.reason


# -- K that is not proportional to the pressure ------------------------------------------------------------------------

GAUGES = [
    "norm(a, b) + m*sigma_n",
    "max(a**3, -a*b**2) - m*abs(sigma_n)**3",
    "max(abs(a) - m*abs(sigma_n), b**2 - sigma_n**2)",
    "(abs(a)**m + 2*abs(b)**m)**(1/m) - abs(sigma_n)",
    "m*sigma_n*(a/2 + norm(a, b)) + norm(a, b)**2",
    "norm(a + m*sigma_n, b) - 2*m*abs(sigma_n)",
]
NO_GAUGES = [
    "norm(a, b) + m*sigma_n - 1",  # cohesion
    "norm(a, b) - m*sigma_n**2",
    "norm(a, b) - min(m*abs(sigma_n), 1)",  # a cap
    "norm(a, b, 1) - m*abs(sigma_n) - 1",  # a regularised tip
    "norm(a, b) - m*sqrt(sigma_n**2 + 1)",  # a regularised pressure
    "norm(a, b) - m*(1 - exp(-abs(sigma_n)))",
    "max(norm(a, b) - m*abs(sigma_n), abs(a) - 1)",
    "norm(a, b) - where(abs(sigma_n) < 200, 85/100*abs(sigma_n), 50 + 60/100*abs(sigma_n))*m",
    "(abs(a)**m + abs(b)**m)**(1/(2*m)) - abs(sigma_n)",
]


def scales(law: Criterion) -> bool:
    return objection("homogeneity", "degrees", frozenset(), stated(law_as_text(law)), {}) == ""


@pytest.mark.parametrize("g", GAUGES)
def test_a_gauge_is_seen(g: str) -> None:
    law = friction(g, m=ABOVE_0)
    assert scales(law) and homogeneity_along_rays(FormulaSubject(law)) is None


@pytest.mark.parametrize("g", NO_GAUGES)
def test_what_is_no_gauge_is_refuted_by_a_point_and_a_multiple_of_it(g: str) -> None:
    law = friction(g, m=ABOVE_0)
    assert not scales(law)
    found = homogeneity_along_rays(FormulaSubject(law))
    assert found is not None and found.witness is not None
    witness = found.witness
    points = {role: {name: sp.Rational(x) for name, x in point.items()} for role, point in witness.points.items()}
    inside, outside = points["inside"], points["outside"]
    factor = outside["sigma_n"] / inside["sigma_n"]
    assert factor > 0 and outside == {name: factor * x for name, x in inside.items()}
    at = {name: sp.Rational(x) for name, x in witness.parameters.items()}
    signs = [sp.sign(law.g.subs({law.symbols()[n]: x for n, x in {**point, **at}.items()}).n(30)) for point in (inside, outside)]
    assert signs == [-1, 1]


def test_exponents_that_differ_are_no_gauge_and_ranges_cut_one() -> None:
    assert not scales(friction("(abs(a)**m + abs(b)**n)**(1/m) - abs(sigma_n)", m=ABOVE_0, n=ABOVE_0))
    assert not scales(friction("norm(a, b) - m*abs(sigma_n)", domain={"sigma_n": Domain.between(-2, -1)}, m=ABOVE_0))
    assert not scales(friction("norm(a, b) - m*abs(sigma_n)", domain={"a": Domain.between(-2, 1)}, m=ABOVE_0))


@pytest.mark.parametrize("name", ["cohesive", "capped", "regularised"])
def test_a_law_without_a_gauge_says_so(name: str) -> None:
    found = asked(name)
    assert found["homogeneity"].verdict is Verdict.REFUTED and found["bipotential"].verdict is Verdict.NOT_APPLICABLE
    assert "the law has none" in found["bipotential"].detail
    assert found.coupled is not None and found.coupled.support_function is found.coupled.dilatancy is None


def test_of_a_law_without_pressure_and_of_rates_nothing_is_said() -> None:
    found = asked("von-mises")
    assert [found[claim].verdict for claim in COUPLED] == [Verdict.NOT_APPLICABLE] * 2 and "no pressure" in found["homogeneity"].detail
    norton = Criterion("norton", "norm(a, b)**2/abs(sigma_n)", {}, ("a", "b"), viscous=True)
    text = stated(law_as_text(norton))
    assert all(
        objection(claim, rule, frozenset(EVERY), text, {}) for claim, rule in (("homogeneity", "degrees"), ("bipotential", "one-normal"))
    )


# -- what is not the law's bipotential ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "law",
    [friction("norm(a/2, b) - m*abs(sigma_n)", ("a", "b"), m=ABOVE_0), friction("a**4 + 9*a**2*b**2 + b**4 - (m*sigma_n)**4", m=ABOVE_0)],
)
def test_a_slip_that_is_not_normal_refutes_it_at_an_exact_point(law: Criterion) -> None:
    found = asked(law)["bipotential"]
    assert (
        found.verdict is Verdict.REFUTED
        and found.witness is not None
        and "b > sigma . d - p v_n on the law itself" in found.witness.statement
    )
    at = {law.symbols()[name]: sp.Rational(x) for name, x in found.witness.parameters.items()}
    points = {role: {law.symbols()[name]: sp.Rational(x) for name, x in point.items()} for role, point in found.witness.points.items()}
    signs = {role: law.g.subs({**point, **at}) for role, point in points.items()}
    assert signs["inside"] <= 0 < signs["outside"] and signs["tau"] <= 0
    forces = law.force_symbols()
    flow = law.flow or [sp.diff(law.g, x) for x in forces]
    for role in ("inside", "outside"):  # between which the boundary is
        slip = [component.subs({**points[role], **at}) for component in flow]
        assert sum(d * (points["tau"][x] - points[role][x]) for d, x in zip(slip, forces, strict=True)) > 0


State = dict[str, Fraction]


def states(mu: Fraction) -> Iterator[tuple[State, bool]]:
    """States in the cone of Coulomb's law with v_n >= 0, exact, and whether the law has them."""
    ways = [(Fraction(3, 5), Fraction(4, 5)), (Fraction(-1), Fraction(0)), (Fraction(5, 13), Fraction(-12, 13))]
    sizes = (Fraction(0), Fraction(1), Fraction(2))
    for (x, y), (dx, dy), p, share, rate, v in product(ways, ways, sizes, (Fraction(1, 2), Fraction(1)), sizes, sizes):
        state = {"a": share * mu * p * x, "b": share * mu * p * y, "p": p, "d_a": rate * dx, "d_b": rate * dy, "v": v}
        normal = rate == 0 or p == 0 or (share == 1 and (x, y) == (dx, dy))
        yield state, normal and p * v == 0


def counterexample(excess: Callable[[State], Fraction], mu: Fraction, law: Callable[[State, bool], bool]) -> tuple[State, Fraction] | None:
    """A state at which b - pairing < 0, or is 0 off the law, or > 0 on it."""
    for state, own in states(mu):
        if (found := excess(state)) < 0 or (found == 0) is not law(state, own):
            return state, found
    return None


def support(text: str, **values: Any) -> Callable[[State], Fraction]:
    """Phi_1 at a state, exactly: the slips that occur have rational lengths."""
    names = {name: sp.Symbol(name, real=True) for name in ("d_a", "d_b", *values)}
    formula = parse_expression(text, names, where="test")

    def at(state: State) -> Fraction:
        exact = formula.subs({names[n]: sp.Rational(x) for n, x in {**values, "d_a": state["d_a"], "d_b": state["d_b"]}.items()})
        number = sp.nsimplify(sp.sqrtdenest(exact.doit()))
        assert number.is_Rational
        return Fraction(int(number.p), int(number.q))

    return at


def power(s: State) -> Fraction:
    return s["a"] * s["d_a"] + s["b"] * s["d_b"]


@pytest.mark.slow
def test_wrong_bipotentials_are_refuted_by_exact_states() -> None:
    mu = Fraction(1, 2)
    coupled = asked("coulomb").coupled
    assert coupled is not None and coupled.support_function is not None
    phi, of_law = support(coupled.support_function, mu=mu), lambda _, own: own
    right = counterexample(lambda s: s["p"] * phi(s) - power(s) + s["p"] * s["v"], mu, of_law)
    assert right is None  # b >= pairing everywhere, with equality exactly on the law

    sign = counterexample(lambda s: s["p"] * phi(s) - power(s) - s["p"] * s["v"], mu, of_law)
    assert sign is not None and sign[1] < 0 < sign[0]["p"] * sign[0]["v"]  # sigma . d + p v_n

    line, larger = support("mu*abs(d_a)", mu=mu), support("2*mu*norm(d_a, d_b)", mu=mu)  # of other laws
    below = counterexample(lambda s: s["p"] * line(s) - power(s) + s["p"] * s["v"], mu, of_law)
    above = counterexample(lambda s: s["p"] * larger(s) - power(s) + s["p"] * s["v"], mu, of_law)
    assert below is not None and below[1] < 0  # less than the pairing
    assert above is not None and above[1] > 0 == above[0]["p"] * above[0]["v"]  # more than it on the law

    def dilates(s: State, _: bool) -> bool:  # normal to the cone of all (sigma, p): v_n = Phi_1(d) wherever p > 0
        return s["v"] == phi(s) and power(s) == s["p"] * phi(s)

    cone = counterexample(lambda s: s["p"] * phi(s) - power(s) + s["p"] * s["v"], mu, dilates)
    assert cone is not None
    slips = [s for s, _ in states(mu) if dilates(s, True) and s["p"] > 0 and phi(s) > 0]
    assert slips and all(s["p"] * phi(s) - power(s) + s["p"] * s["v"] == s["p"] * phi(s) > 0 for s in slips)


# -- honest trust, and nothing where nobody asked ----------------------------------------------------------------------


@pytest.mark.parametrize("weak", ["homogeneity", "origin", "convexity", "normality"])
def test_a_premise_that_the_kernel_did_not_confirm_leaves_it_open(weak: str) -> None:
    law = duhem.load("coulomb")
    kernel, subject = Confirmations(law), FormulaSubject(law)
    settled = {name: Evidence(Verdict.PROVED, "known", "so it is") for name in (*EVERY,)}
    kernel.standings.update({name: Standing(Trust.CHECKED) for name in settled if name != "bipotential"})
    assert EVERY["bipotential"].examine(subject, settled, kernel).verdict is Verdict.PROVED
    kernel.standings[weak] = Standing(Trust.SOLVER)
    found = EVERY["bipotential"].examine(subject, settled, kernel)
    assert found.verdict is Verdict.UNDECIDED and "not all of them are confirmed by the kernel" in found.detail
    settled[weak] = replace(settled[weak], verdict=Verdict.UNDECIDED)
    del kernel.standings[weak]
    assert f"not proved: {weak} (undecided)" in EVERY["bipotential"].examine(subject, settled, kernel).detail


def test_a_doubtful_closed_form_is_not_used() -> None:
    law = duhem.load("coulomb")
    kernel, subject = Confirmations(law), FormulaSubject(law)
    settled = {name: Evidence(Verdict.PROVED, "known", "so it is") for name in (*EVERY,)}
    kernel.standings.update({name: Standing(Trust.CHECKED) for name in settled} | {"duality": Standing(Trust.PROVER)})
    found = EVERY["bipotential"].examine(subject, settled, kernel)
    assert (found.verdict, found.method) == (Verdict.PROVED, "support-function") and "mu" not in found.detail


@pytest.mark.parametrize(("claim", "trust"), [("duality", Trust.PROVER), ("homogeneity", None)])
def test_no_dilatancy_is_told_by_a_closed_form_that_the_kernel_did_not_confirm(claim: str, trust: Trust | None) -> None:
    found, subject = asked("coulomb"), FormulaSubject(duhem.load("coulomb"))
    results = [*found.results, *found.rests_on]
    assert Coupled.of(subject, results) == found.coupled
    weaker = Coupled.of(subject, [replace(r, trust=trust) if r.claim == claim else r for r in results])
    assert weaker.support_function is weaker.dilatancy is None and weaker.bipotential == "proved"


def test_nobody_who_did_not_ask_is_told() -> None:
    found = duhem.verify("coulomb")
    assert found.coupled is None and "coupled" not in found.to_dict() and "Coupled" not in found.to_text()
    assert not {r.claim for r in found} & {*COUPLED} and not {row["claim"] for row in found.certificate()["claims"]} & {*COUPLED}
    with pytest.raises(InputError, match="was not selected"):
        _ = found["bipotential"]


Run = Callable[..., tuple[int, str, str]]


@pytest.mark.slow
def test_the_command_decides_it_and_ends_by_it(run: Run) -> None:
    code, told, _ = run("verify", "coulomb", "--claims", "origin", "--coupled")
    assert code == 0 and "bipotential  proved   checked  polar-gauge" in told and "\nCoupled\n" in told
    code, told, _ = run("verify", "coulomb", "--claims", "origin")
    assert code == 0 and "oupled" not in told and "bipotential" not in told and "homogeneity" not in told
    given = ("verify", "rotated-flow", "--claims", "origin", "--coupled")
    assert run(*given)[0] == 1 and run(*given, "--expect", "bipotential=refuted")[0] == 0
    assert run("verify", "coulomb", "--claims", "origin", "--expect", "bipotential=proved")[0] == 2  # nobody asked
    both = ("verify", "coulomb", "cohesive", "--claims", "origin", "--coupled", "--format", "json")
    code, told, _ = run(*both, "--expect", "homogeneity=refuted")
    assert code == 1 and [one["coupled"]["bipotential"] for one in json.loads(told)] == ["proved", "not_applicable"]


def test_both_claims_are_explained(run: Run) -> None:
    for claim in COUPLED:
        code, told, _ = run("explain", claim)
        assert code == 0 and COUPLED[claim].statement in " ".join(told.split())


def test_it_is_told_as_text_sheet_and_page() -> None:
    found = asked("coulomb")
    told = "open the contact with v_n = mu*norm(d_a, d_b)"
    assert told in " ".join(found.to_text().split()) and told in found.to_html()
