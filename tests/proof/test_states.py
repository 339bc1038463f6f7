"""Laws with a state: what their energy and their dissipation are shown to be, or refuted by a state that can be put in by hand."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
import sympy as sp

import duhem
from duhem import Criterion, Domain, InputError, Verdict, YieldSurface
from duhem.law.criterion_file import criterion_text, reads
from duhem.law.state import Variable
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import digest
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.domain import StatedLaw
from duhem.proof.kernel.steps import within
from duhem.proof.kernel.term import NotWritten

PROVED, REFUTED = Verdict.PROVED, Verdict.REFUTED
AT_LEAST_0, ABOVE_0 = Domain.between(0, None), Domain(low=Domain.between(0, None).low, positive=True)
BELOW_0 = Domain.between(-2, -1)
SLIP = {"u": Variable("sigma", observable=True), "u_in": Variable("sigma")}
QUADRATIC = "k/2*(u - u_in)**2"
PRAGER = "norm(sigma + Y) - R"
ALONG = "(sigma + Y)/norm(sigma + Y)"


def law(g: str, energy: str, *, flow: Any = None, variables: Any = None, rates: Any = None, **parameters: Domain) -> Criterion:
    """In sigma and Y, whose variables are the slip and alpha."""
    state = SLIP | ({"alpha": Variable("Y")} if variables is None else variables)
    domains, rates = {"R": ABOVE_0, "k": ABOVE_0, **parameters}, rates or {}
    return Criterion("made", g, domains, ("sigma", "Y"), None, flow=flow, energy=energy, variables=state, rates=rates)


def kinematic(**parameters: Domain) -> Criterion:
    return law(PRAGER, f"{QUADRATIC} + C/2*alpha**2", **{"C": ABOVE_0, **parameters})


def armstrong_frederick(rates: Any = None, **parameters: Domain) -> Criterion:
    domains = {"C": ABOVE_0, "gamma": AT_LEAST_0, **parameters}
    return law(PRAGER, f"{QUADRATIC} + C/2*alpha**2", flow=(ALONG, f"{ALONG} - gamma*alpha"), rates=rates, **domains)


def isotropic(hardening: Domain) -> Criterion:
    variables = SLIP | {"alpha": Variable("A", domain=AT_LEAST_0)}
    energy = f"{QUADRATIC} + H/2*alpha**2"
    parameters = {"mu": ABOVE_0, "H": hardening, "k": ABOVE_0}
    return Criterion("isotropic", "abs(sigma) + A - mu*abs(sigma_n)", parameters, ("sigma", "A"), energy=energy, variables=variables)


ADHESION = Criterion(
    "adhesion",
    "norm(a, b) - mu*abs(sigma_n)",
    dict.fromkeys(("mu", "C", "w"), ABOVE_0),
    ("a", "b", "B"),
    energy="beta**2*C*((u - u_in)**2 + (v - v_in)**2)/2 - w*beta",
    variables={
        "u": Variable("a", observable=True),
        "v": Variable("b", observable=True),
        "u_in": Variable("a"),
        "v_in": Variable("b"),
        "beta": Variable("B", domain=Domain.between(0, 1)),
    },
)
RECOVERY = "c/C*abs(Y)**(m - 1)*Y"
RECOVERS = {"c": ABOVE_0, "m": Domain.between(1, None)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("given", "state_laws", "dissipation", "standard"),
    [
        pytest.param(isotropic(AT_LEAST_0), PROVED, PROVED, True, id="isotropic"),
        pytest.param(isotropic(Domain.between(-1, 0)), REFUTED, PROVED, False, id="softening"),
        pytest.param(kinematic(), PROVED, PROVED, True, id="Prager"),
        pytest.param(kinematic(C=BELOW_0), REFUTED, PROVED, False, id="Prager turned"),
        pytest.param(armstrong_frederick(), PROVED, PROVED, False, id="Armstrong and Frederick"),
        pytest.param(armstrong_frederick(gamma=BELOW_0), PROVED, REFUTED, False, id="recall turned"),
        pytest.param(armstrong_frederick(C=BELOW_0, gamma=Domain.between(1, 2)), REFUTED, REFUTED, False, id="energy turned"),
        pytest.param(armstrong_frederick({"alpha": RECOVERY}, **RECOVERS), PROVED, PROVED, False, id="static recovery"),
        pytest.param(armstrong_frederick({"alpha": f"-{RECOVERY}"}, **RECOVERS), PROVED, REFUTED, False, id="recovery turned"),
        pytest.param(ADHESION, REFUTED, PROVED, False, id="adhesion"),
    ],
)
def test_verdicts(given: Criterion, state_laws: Verdict, dissipation: Verdict, standard: bool) -> None:
    found = duhem.verify(given)
    assert (found["state_laws"].verdict, found["dissipation"].verdict) == (state_laws, dissipation)
    assert found.generalized_standard is standard and found.dissipative is (dissipation is PROVED)
    assert all(str(result.trust) == "checked" for result in found if result.verdict is PROVED)
    for result in found:
        if result.verdict is REFUTED and result.claim in ("state_laws", "dissipation"):
            violated(given, result.claim, result.witness)
    rechecked = duhem.recheck(found.certificate())
    assert rechecked.ok


def violated(given: Criterion, claim: str, witness: Any) -> None:
    """The state of a witness, put in by hand with SymPy alone: the energy sags, or the power of flow or rates is negative there."""
    table = given.symbols()

    def at(point: dict[str, str]) -> dict[Any, Any]:
        return {table.get(x, sp.Symbol(x)): sp.Rational(v) for x, v in {**witness.parameters, **point}.items()}

    if claim == "state_laws":
        p, q, middle = (witness.points[role] for role in ("p", "q", "midpoint"))
        heights = [given.energy.subs(at({x: v for x, v in point.items() if x in table})) for point in (p, q, middle)]
        assert all(Fraction(middle[x]) == (Fraction(p[x]) + Fraction(q[x])) / 2 for x in middle)
        assert 2 * heights[2] > heights[0] + heights[1]
        return
    forces = {own.force: -given.energy.diff(table[x]) for x, own in given.variables.items() if own.internal}
    here = at(next(iter(witness.points.values())))
    for force, own in forces.items():
        here.setdefault(table[force], own.subs(here))
    flow = {f: d for f, d in zip(given.forces, given.flow, strict=True)}
    rates = {given.variables[x].force: r for x, r in given.rates.items()}
    powers = [sum(here[table[f]] * x.subs(here) for f, x in each.items()) for each in (flow, rates) if each]
    assert any(power.doit() < 0 for power in powers)


# -- what the kernel must not take ------------------------------------------------------------------------------------


def refused(given: Criterion, claim: str, rule: str, evidence: Any = None, settled: Any = (), **changed: Any) -> str:
    stated = StatedLaw.read(law_as_text(given) | changed)
    with within(20_000_000):
        return objection(claim, rule, frozenset(settled), stated, evidence or {})


SHARE = {"share": "1", "rest": "R + gamma*C*alpha**2"}


def test_a_share_of_g_and_its_rest() -> None:
    assert refused(armstrong_frederick(), "dissipation", "power-share", SHARE) == ""
    assert refused(armstrong_frederick(), "dissipation", "power-share", SHARE | {"rest": "R + 2*gamma*C*alpha**2"})
    assert refused(armstrong_frederick(gamma=Domain()), "dissipation", "power-share", SHARE)
    assert refused(armstrong_frederick(C=Domain()), "dissipation", "power-share", SHARE)


@pytest.mark.parametrize(
    "energy",
    [
        f"{QUADRATIC} - C/2*alpha**2",
        f"{QUADRATIC} + C/2*alpha**2 - u_in**2",  # -dpsi/du_in is not the stress
        f"{QUADRATIC} + C/2*alpha**2 + u",
        "k/2*(u + u_in)**2 + C/2*alpha**2",
        f"{QUADRATIC} + C/4*alpha**3",
        f"{QUADRATIC} + C*u*alpha - C*u_in*alpha",
        f"{QUADRATIC} + C*log(alpha)",
        f"{QUADRATIC} + C*sqrt(alpha**2 - 1)",
    ],
)
def test_no_other_energy_is_convex_with_forces_that_agree(energy: str) -> None:
    assert refused(kinematic(), "state_laws", "composition", energy=energy)
    assert refused(kinematic(), "state_laws", "by-construction", energy=energy)


def test_a_law_with_an_energy_is_asked_about_it() -> None:
    assert refused(kinematic(), "state_laws", "composition") == ""
    assert refused(kinematic(), "state_laws", "by-construction")


def test_the_default_energy_holds_by_construction_only_where_no_other_force_needs_one() -> None:
    plain = Criterion("plain", "abs(sigma) - R", {"R": ABOVE_0}, ("sigma",), None)
    frozen = Criterion("frozen", "abs(sigma) - R*(1 + w**2)", {"R": ABOVE_0}, ("sigma",), None, variables=SLIP | {"w": Variable()})
    for given in (plain, frozen):
        found = duhem.verify(given, claims=["state_laws"])["state_laws"]
        assert (found.verdict, found.method) == (PROVED, "by-construction") and "by construction" in found.detail
    silent = law(PRAGER, "0")
    silent = Criterion("silent", silent.g, silent.parameters, silent.forces, None, variables=silent.variables)
    found = duhem.verify(silent, claims=["state_laws"])["state_laws"]
    assert found.verdict is Verdict.NOT_APPLICABLE and "nothing says how Y follows from alpha" in found.detail
    assert refused(silent, "state_laws", "by-construction")


@pytest.mark.parametrize("g", ["5 - a**2 - b - m", "m*(5 + b) - a**2 - 6*b"])
def test_no_energy_is_refuted_where_none_is_stated(g: str) -> None:
    """K is not convex and {g <= 0} may look like an epigraph; the kernel proves nothing of a constraint that may have no value."""
    domains = {"m": ABOVE_0, "e": Domain.between(Fraction(-1, 2), 1)}
    given = Criterion("plain", g, domains, ("a", "b"), None, constraints=("log(e) <= 0",))
    assert duhem.verify(given, claims=["state_laws"])["state_laws"].verdict is Verdict.UNDECIDED


def test_the_conclusion_names_the_state_laws() -> None:
    said = duhem.verify(isotropic(Domain.fixed(-1)), claims=["origin", "state_laws"]).to_text()
    assert "generalized standard: no (state_laws refuted)" in said


def test_a_fixed_variable_is_still_one() -> None:
    """Forces are derivatives by it; put in as a number they would be 0."""
    fixed = {**law_as_text(armstrong_frederick(gamma=BELOW_0))["parameters"], "alpha": {"value": "3"}}
    assert refused(armstrong_frederick(), "dissipation", "power-share", SHARE, parameters=fixed)
    assert refused(armstrong_frederick(), "dissipation", "boundary-power", parameters=fixed)
    energy = f"{QUADRATIC} + C/2*alpha**2 - u_in**2"
    known = {**law_as_text(kinematic())["parameters"], "u": {"value": "1"}, "u_in": {"value": "2"}}
    assert refused(kinematic(), "state_laws", "composition", parameters=known, energy=energy)


def test_a_potential_of_the_forces_says_nothing_in_the_state() -> None:
    given = law_as_text(armstrong_frederick(gamma=BELOW_0))
    flow = {"potential": "norm(sigma + Y) + gamma/2*Y**2"}
    for rule, evidence in (("potential", {"share": "1"}), ("power-share", SHARE), ("boundary-power", {}), ("homogeneity", {})):
        assert refused(armstrong_frederick(), "dissipation", rule, evidence, flow=flow, parameters=given["parameters"])


def test_rates_are_asked_beside_every_proof_of_dissipation() -> None:
    turned = armstrong_frederick({"alpha": f"-{RECOVERY}"}, **RECOVERS)
    assert refused(turned, "dissipation", "power-share", SHARE).startswith("the rates without a multiplier")
    settled = ("origin", "normality")
    associated = law(PRAGER, f"{QUADRATIC} + C/2*alpha**2", rates={"alpha": "-Y"}, C=ABOVE_0)
    assert refused(associated, "dissipation", "fenchel", settled=settled).startswith("the rates without a multiplier")
    assert refused(kinematic(), "dissipation", "fenchel", settled=settled) == ""
    assert refused(armstrong_frederick({"alpha": "Y/(alpha - 1)"}), "dissipation", "power-share", SHARE)


@pytest.mark.parametrize(
    "changed",
    [
        {"variables": {"alpha": {"force": "Y"}, "u_in": {"force": "Y"}}},
        {"variables": {"alpha": {"force": "Y"}}},  # nothing has the force sigma
        {"variables": {"alpha": {"force": "Y"}, "u_in": {"force": "sigma"}, "T": {"temperature": True, "force": "Y"}}},
        {"variables": {"alpha": {"force": "Y"}, "u_in": {"force": "sigma"}, "u": {"observable": True}}},
        {"variables": {"alpha": {"force": "Y"}, "u_in": {"force": "tau"}}},
        {"variables": {"alpha": {"force": "Y", "kind": "internal"}, "u_in": {"force": "sigma"}}},
        {"variables": {"alpha": {"force": "Y"}, "u_in": {"force": "sigma"}, "w": {}}},  # w is declared nowhere
        {"energy": "sigma**2"},
        {"energy": "u < 1"},
        {"rates": {"u": "1"}},
        {"rates": {"beta": "1"}},
        {"rates": {"alpha": "Z"}},
    ],
)
def test_texts_that_are_no_state(changed: dict[str, Any]) -> None:
    with pytest.raises((NotWritten, KeyError)):
        StatedLaw.read(law_as_text(kinematic()) | changed)


# -- criterion files ---------------------------------------------------------------------------------------------------

FILE = """\
[criterion]
name = "hardening"
forces = ["sigma", "X"]
pressure = false
g = "norm(sigma + X) - R"

[parameters]
R = { positive = true }
C = { positive = true }
gamma = { min = 0 }
k = { positive = true }

[energy]
psi = "k/2*(u - u_in)**2 + C/2*alpha**2"

[variables]
u = { observable = true, force = "sigma" }
w = {}
alpha = { force = "X", min = -1, max = 1 }
u_in = { force = "sigma" }

[flow]
direction = ["1", "(sigma + X)/norm(sigma + X) - gamma*alpha", "(sigma + X)/norm(sigma + X)"]

[dissipation]
rates = { alpha = "X/C" }
"""


def test_a_file_states_all_of_it() -> None:
    read = reads(FILE)
    assert list(read.variables) == ["u", "w", "alpha", "u_in"] and read.parameters["alpha"] == Domain.between(-1, 1)
    assert [str(d) for d in read.flow or ()] == ["(X + sigma)/Abs(X + sigma)", "-alpha*gamma + (X + sigma)/Abs(X + sigma)"]
    assert {x: str(r) for x, r in read.unforced.items()} == {"w": "1"} and {x: str(r) for x, r in read.rates.items()} == {"alpha": "X/C"}
    assert law_as_text(read)["energy"] == "k/2*(u - u_in)**2 + C/2*alpha**2"
    assert read.fix({"C": 2}).within({"gamma": Domain.between(0, 1)}).energy == read.fix({"C": 2}).energy


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('u_in = { force = "sigma" }\n', "", "no internal variable has the force sigma"),
        ('force = "X", min', 'force = "Z", min', "the force 'Z' of alpha is not declared"),
        ("w = {}", 'w = { force = "X" }', "X is the force of two internal variables, w and alpha"),
        ("w = {}", "w = { temperature = true, observable = true }", "w is an observable and the temperature"),
        ("w = {}", 'w = { temperature = true, force = "X" }', "the temperature w has a force"),
        ("w = {}", "w = { observable = true }", "the observable w has no force"),
        ("w = {}", "w = { colour = 1 }", "unknown key 'colour' of w"),
        ("w = {}", "w = 3", "w is not a table"),
        ("w = {}", "R = {}", "'R' is declared twice"),
        ('"1", ', "", "the flow direction has 2 components for 3 rates; give one expression for each of w, alpha, u_in"),
        ("u_in)**2 + ", "u_in)**2 + sigma + ", "the energy uses ['sigma']"),
        ('alpha = "X/C"', 'u = "X/C"', "'u' has a rate and is no internal variable"),
        ('psi = "k', 'phi = "k', "unknown key 'phi'"),
        (
            'rates = { alpha = "X/C" }',
            'forces_of_rates = { sigma = "tanh(u_in_rate)" }',
            "forces as functions of the rates are not examined",
        ),
        ("pressure = false", 'pressure = false\nconstraints = ["alpha < C"]', "the constraint alpha < C relates alpha"),
    ],
)
def test_what_does_not_fit_is_named(before: str, after: str, said: str) -> None:
    assert before in FILE
    with pytest.raises(InputError) as fault:
        reads(FILE.replace(before, after))
    assert said in str(fault.value)


@pytest.mark.parametrize("kinked", ["abs(alpha)", "pos(alpha)", "max(alpha, 2*alpha)", "norm(alpha)", "where(alpha > 0, 2*alpha, alpha)"])
def test_an_energy_with_a_kink_gives_no_one_force(kinked: str) -> None:
    energy = f"{QUADRATIC} + C/2*alpha**2 + {kinked}"
    for claim, rule, evidence in (
        ("state_laws", "composition", {}),
        ("dissipation", "power-share", SHARE),
        ("dissipation", "boundary-power", {}),
    ):
        assert refused(armstrong_frederick(), claim, rule, evidence, energy=energy)


def test_a_kink_in_the_temperature_is_not_concave() -> None:
    variables = {**law_as_text(kinematic())["variables"], "T": {"temperature": True}}
    parameters = {**law_as_text(kinematic())["parameters"], "T": {"positive": True}}
    for heat, right in (("-C*T*(log(T) - 1)", True), ("-T**2", True), ("abs(T - 300)", False), ("T**2", False), ("-abs(T - 300)", False)):
        energy = f"{QUADRATIC} + C/2*alpha**2 + {heat}"
        said = refused(kinematic(), "state_laws", "composition", energy=energy, variables=variables, parameters=parameters)
        assert (said == "") is right, (heat, said)


def test_forces_that_no_state_has_refute_nothing() -> None:
    """An associated law whose K leaves 0 out dissipates less than 0 at forces that this energy never gives together."""
    away = law("(sigma - 2)**2 + (Y - 2)**2 - 1", f"{QUADRATIC} + C/2*alpha**2", C=ABOVE_0)
    assert duhem.verify(away, claims=["dissipation"])["dissipation"].verdict is not REFUTED


@pytest.mark.parametrize(
    ("given", "turned"),
    [
        pytest.param({"rates": {"alpha": "-Y"}}, "Y", id="associated"),
        pytest.param({"rates": {"u_in": "-sigma*(1 + alpha**2)"}}, "sigma", id="in a force that an observable gives"),
        pytest.param({"rates": {"u_in": "u_in - u"}}, "sigma", id="in displacements"),
    ],
)
def test_rates_of_associated_laws_are_refuted_by_a_state(given: Any, turned: str) -> None:
    """A state with all its variables, whose forces are in K and whose rates cost energy; the rates turned dissipate."""
    energy = f"{QUADRATIC} + C/2*alpha**2"
    made = law(PRAGER, energy, C=ABOVE_0, **given)
    found = duhem.verify(made, claims=["dissipation"])["dissipation"]
    assert found.verdict is REFUTED and found.witness is not None
    (state,) = (dict(point) for point in found.witness.points.values())
    table = made.symbols()
    here = {table[x]: sp.Rational(v) for x, v in {**found.witness.parameters, **state}.items()}
    forces = {f: -made.energy.diff(table[x]).subs(here) for f, x in (("sigma", "u_in"), ("Y", "alpha"))}
    assert {f: str(v) for f, v in forces.items()} == {f: state[f] for f in forces} and made.g.subs(here) <= 0
    assert sum(forces[made.variables[x].force or ""] * rate.subs(here) for x, rate in made.rates.items()) < 0
    other = law(PRAGER, energy, rates={x: f"-({r})" for x, r in given["rates"].items()}, C=ABOVE_0)
    assert duhem.verify(other, claims=["dissipation"])["dissipation"].verdict is not REFUTED


@pytest.mark.parametrize(("flow", "verdict"), [("Y - gamma*alpha", PROVED), ("Y + gamma*alpha", REFUTED), ("-Y", REFUTED)])
@pytest.mark.parametrize("observed", [True, False])
def test_a_criterion_of_forces_that_no_observable_moves(flow: str, verdict: Verdict, observed: bool) -> None:
    """Y = -C alpha everywhere: Y (Y - gamma alpha) = C^2 alpha^2 + gamma C alpha^2."""
    own = {"gamma": AT_LEAST_0, "R": ABOVE_0, "C": ABOVE_0, "k": ABOVE_0}
    energy = f"C/2*alpha**2{f' + {QUADRATIC}' * observed}"
    variables = {"alpha": Variable("Y")} | (SLIP if observed else {})
    forces, slips = (("Y", "sigma"), (flow, "0")) if observed else (("Y",), (flow,))
    given = Criterion("bound", "abs(Y) - R", own, forces, None, flow=slips, energy=energy, variables=variables)
    found = duhem.verify(given, claims=["dissipation"])["dissipation"]
    assert found.verdict is verdict and (verdict is REFUTED or str(found.trust) == "checked")
    if found.witness is not None:
        violated(given, "dissipation", found.witness)


def test_rates_without_an_energy_are_refuted_by_any_forces() -> None:
    own = {"name": "own", "g": "norm(sigma, Y) - R", "parameters": {"R": ABOVE_0}, "forces": ("sigma", "Y"), "pressure": None}
    spends = Criterion(**own, variables={"alpha": Variable("Y")}, rates={"alpha": "-Y"})
    assert duhem.verify(spends, claims=["dissipation"])["dissipation"].verdict is REFUTED
    tied = Criterion(**own, variables={"alpha": Variable("Y")}, rates={"alpha": "-Y + 100*alpha"})  # Y may be a function of alpha
    assert duhem.verify(tied, claims=["dissipation"])["dissipation"].verdict is not REFUTED


@pytest.mark.parametrize(("nothing", "verdict"), [("0*sqrt(alpha - 100)", False), ("log(alpha)*0", False), ("alpha*0", True)])
def test_an_energy_without_a_value_refutes_nothing_there(nothing: str, verdict: bool) -> None:
    """As it is written it has none where alpha < 0, and there alone the rates cost energy."""
    text = ONE.replace("(0)", f"C/2*alpha**2 + {nothing}").replace('["sigma"]', '["sigma", "A"]')
    text += 'alpha = { force = "A", max = 50 }\n[dissipation]\nrates = { alpha = "where(alpha < 0, -A, A)" }\n'
    found = duhem.verify(reads(text), claims=["dissipation"], effort="quick")["dissipation"]
    assert (found.verdict is REFUTED) is verdict


def test_a_potential_without_a_value_is_not_refuted_there() -> None:
    bent = viscous("a**2 + b**2 + where(a < 0, -10, 1)*(log(a) - log(a) + 0*a) - 4*neg(a)**2 + sqrt(a)*0")
    found = duhem.verify(bent, claims=["convexity"], effort="quick")["convexity"]
    assert found.witness is None or all(sp.Rational(point["a"]) >= 0 for point in found.witness.points.values())


@pytest.mark.parametrize(
    "energy", [f"{QUADRATIC} + C*u", "k/2*(u + u_in)**2", f"{QUADRATIC} + C/2*u_in**2", "k/2*(u - alpha)**2 + C/2*u_in**2", "C/2*u**2"]
)
def test_an_energy_that_gives_two_forces_for_one(energy: str) -> None:
    """A term of u alone, a sign turned, a slip that is stored, a force declared for the wrong variable: all of them convex."""
    given = law(PRAGER, f"{energy} + C/2*alpha**2", C=ABOVE_0)
    found = duhem.verify(given, claims=["state_laws"])["state_laws"]
    assert found.verdict is REFUTED and found.witness is not None and "dpsi/du + dpsi/du_in" in found.witness.values
    table, (state,) = given.symbols(), found.witness.points.values()
    here = {table[x]: sp.Rational(v) for x, v in {**found.witness.parameters, **state}.items()}
    assert (given.energy.diff(table["u"]) + given.energy.diff(table["u_in"])).subs(here) != 0


@pytest.mark.parametrize(("heat", "convex"), [("C*T**2", True), ("C*T*log(T)", True), ("-C*T*(log(T) - 1)", False), ("-C*T**2", False)])
@pytest.mark.parametrize("bounds", ["min = 300, max = 301", "positive = true"])
def test_an_energy_that_is_not_concave_in_the_temperature(heat: str, convex: bool, bounds: str) -> None:
    given = reads(ONE.replace("(0)", heat) + f"T = {{ temperature = true, {bounds} }}\n")
    found = duhem.verify(given, claims=["state_laws"])["state_laws"]
    assert found.verdict is (REFUTED if convex else PROVED)
    if found.witness is not None:
        p, q, middle = ({x: sp.Rational(v) for x, v in found.witness.points[role].items()} for role in ("p", "q", "midpoint"))
        assert {x for x in p if p[x] != q[x]} <= {"T", "z"} and 2 * middle["T"] == p["T"] + q["T"]
        table = given.symbols()
        values = {table[x]: sp.Rational(v) for x, v in found.witness.parameters.items()}
        psi = [given.energy.subs(values | {table[x]: v for x, v in point.items() if x in table}) for point in (p, q, middle)]
        assert float(psi[2] - (psi[0] + psi[1]) / 2) < 0


@pytest.mark.parametrize(
    "energy", ["exp(alpha**9)", "-exp(exp(exp(alpha)))", "C/(alpha - 1)", "1e300*alpha**2 - 1e300*alpha**4", "alpha**301"]
)
def test_energies_beyond_doubles_end_in_verdicts(energy: str) -> None:
    found = duhem.verify(law(PRAGER, f"{QUADRATIC} + {energy}", C=ABOVE_0), claims=["state_laws"], effort="quick")["state_laws"]
    assert found.verdict in (REFUTED, Verdict.UNDECIDED)


@pytest.mark.parametrize(("low", "high"), [("1", "2"), ("1/1000", "1/500"), ("-3", "-3/2")])
def test_ranges_without_0_are_searched(low: str, high: str) -> None:
    variables = SLIP | {"alpha": Variable("Y", domain=Domain.between(Fraction(low), Fraction(high)))}
    made = law(PRAGER, f"{QUADRATIC} - C/2*alpha**2", variables=variables, C=ABOVE_0)
    found = duhem.verify(made, claims=["state_laws"])["state_laws"]
    assert found.verdict is REFUTED
    violated(made, "state_laws", found.witness)
    assert all(Fraction(low) <= Fraction(point["alpha"]) <= Fraction(high) for point in found.witness.points.values())


# -- potentials of rates -----------------------------------------------------------------------------------------------


def viscous(potential: str, forces: tuple[str, ...] = ("a", "b"), **parameters: Domain) -> Criterion:
    return Criterion("viscous", potential, {**dict.fromkeys(("A", "R"), ABOVE_0), **parameters}, forces, None, viscous=True)


N = {"n": Domain.between(1, None)}


@pytest.mark.slow
@pytest.mark.parametrize(
    "potential",
    [
        pytest.param("A/(n + 1)*norm(a, b)**(n + 1)", id="Norton"),
        pytest.param("A/(n + 1)*pos((norm(a, b) - R)/A)**(n + 1)", id="Perzyna"),
        pytest.param("pos(norm(a, b) - R)**2/(2*A)", id="Bingham"),
        pytest.param("A*(cosh(norm(a, b)/R) - 1)", id="Garofalo"),
        pytest.param("A*(a**2 + a*b + b**2)", id="quadratic"),
    ],
)
def test_a_convex_potential_that_is_least_at_0(potential: str) -> None:
    given = viscous(potential, **(N if "n" in potential.replace("norm", "") else {}))
    found = duhem.verify(given, claims=["origin", "convexity", "normality", "dissipation", "state_laws"])
    assert found.generalized_standard and found.dissipative
    assert all(str(result.trust) == "checked" for result in found) and duhem.recheck(found.certificate()).ok
    with pytest.raises(InputError, match="gradient of a potential"):
        duhem.project(given, [1.0, 0.0], None, 1.0, {"A": 1, "R": 1, "n": 2})


@pytest.mark.parametrize(
    ("potential", "claim"),
    [
        ("A*(cosh(a) - 2) + b**2", "origin"),  # below 0 at 0
        ("A*(cosh(a) + 1) + b**2", "origin"),
        ("A*(a - 1)**2 + b**2 - A", "origin"),  # 0 at 0 and less beside it
        ("A*a**2 - b**2", "convexity"),
        ("A*sqrt(norm(a, b))", "convexity"),
        ("A*a**2 + b**3", "convexity"),
    ],
)
def test_no_other_potential_is_taken(potential: str, claim: str) -> None:
    given = viscous(potential)
    for rule in ("evaluation", "polar-form", "composition", "polyhedral", "polar-curvature", "fan"):
        assert refused(given, claim, rule, settled=("origin",) if claim == "convexity" else ())
    for rule in ("euler", "homogeneity", "potential", "power-share", "boundary-power"):
        assert refused(given, "dissipation", rule, {"share": "0", "rest": "0"}, settled=("origin",))
    assert duhem.verify(given, claims=[claim])[claim].verdict is not PROVED


NORTON = """\
[criterion]
name = "norton"
pressure = false
forces = ["s"]
[dissipation]
potential = "A*s**2"
[parameters]
A = { positive = true }
"""


@pytest.mark.parametrize("given", [FILE, FILE.replace("w = {}", "T = { temperature = true, min = 1 }").replace('"1", ', ""), NORTON])
def test_a_law_with_a_state_is_written_as_a_file_that_says_it(given: str) -> None:
    read = reads(given)
    written = criterion_text(read)
    again = reads(written)
    assert again == read and again.variables == read.variables and criterion_text(again) == written
    assert (again.energy, dict(again.rates), dict(again.unforced), again.viscous) == (read.energy, read.rates, read.unforced, read.viscous)


def test_a_potential_of_rates_in_a_file() -> None:
    text = NORTON
    read = reads(text)
    assert read.viscous and law_as_text(read)["viscous"] is True and str(read.g) == "A*s**2"
    with pytest.raises(InputError, match="are both given"):
        reads(text.replace('forces = ["s"]', 'forces = ["s"]\ng = "s"'))
    with pytest.raises(InputError, match="are both given"):
        reads(text + '[flow]\ndirection = ["1"]\n')


# -- what an adversary found ---------------------------------------------------------------------------------------------

ONE = """\
[criterion]
name = "one"
forces = ["sigma"]
pressure = false
g = "abs(sigma) - R"
[parameters]
R = { positive = true }
k = { positive = true }
C = { positive = true }
[energy]
psi = "k/2*(u - u_in)**2 + (0)"
[variables]
u = { observable = true, force = "sigma" }
u_in = { force = "sigma" }
"""
HEAT = "T = { temperature = true, min = 0, max = 2 }\n"


@pytest.mark.parametrize(
    "heat",
    [
        "30*pos(T - 1) - T**2",
        "30*abs(T - 1) - T**2",
        "30*max(T, 1)",
        "abs(T - 300) - pos(T - 300)",
        "100*(abs(T - 300) - pos(T - 300)) - T**2",
    ],
)
def test_kinks_in_the_temperature_that_cancel(heat: str) -> None:
    assert duhem.verify(reads(ONE.replace("(0)", heat) + HEAT), claims=["state_laws"])["state_laws"].verdict is not PROVED


def test_a_variable_that_the_energy_names_has_a_force() -> None:
    with pytest.raises(InputError, match="the energy depends on w, which has no force"):
        reads(ONE.replace("(0)", "C/2*w**2") + "w = {}\n")
    with pytest.raises(NotWritten):
        StatedLaw.read(law_as_text(kinematic()) | {"energy": f"{QUADRATIC} + C/2*w**2", "variables": {**VARIABLES, "w": {}}})


VARIABLES = {"u": {"observable": True, "force": "sigma"}, "u_in": {"force": "sigma"}, "alpha": {"force": "Y"}}


@pytest.mark.parametrize("nothing", ["sqrt(sigma) - sqrt(sigma)", "asin(sigma) - asin(sigma)", "gamma*alpha*(1 - sigma/sigma)"])
def test_a_rate_without_a_value_is_no_rate(nothing: str) -> None:
    given = armstrong_frederick()
    flow = [*law_as_text(given)["flow"]]
    flow[1] += f" + {nothing}"
    assert refused(given, "dissipation", "power-share", SHARE, flow=flow)
    rates = law_as_text(given) | {"rates": {"alpha": f"Y + {nothing}"}}
    with within(20_000_000):
        assert objection("dissipation", "power-share", frozenset(), StatedLaw.read(rates), SHARE)
    written = reads(FILE.replace('alpha = "X/C"', f'alpha = "X + {nothing}"'))
    assert law_as_text(written)["rates"]["alpha"] == f"X + {nothing}"


@pytest.mark.parametrize("energy", ["log(alpha) - log(alpha)", "C*alpha*log(alpha)", "where(alpha > 0, C, 0)"])
def test_an_energy_without_a_value_or_with_a_jump_gives_no_dissipation(energy: str) -> None:
    settled = ("origin", "normality")
    assert refused(kinematic(), "dissipation", "fenchel", settled=settled, energy=f"{QUADRATIC} + C/2*alpha**2 + {energy}")


def test_rates_of_their_own_make_no_generalized_standard_law() -> None:
    skew = law(PRAGER, f"{QUADRATIC} + C/2*alpha**2", rates={"u_in": "sigma + 5*Y", "alpha": "Y - 5*sigma"}, C=ABOVE_0)
    assert duhem.verify(skew).generalized_standard is None


@pytest.mark.parametrize(
    "changed",
    [
        {"variables": {**VARIABLES, "T": {"temperature": True}, "S": {"temperature": True}}, "parameters": {"T": {}, "S": {}}},
        {"variables": {**VARIABLES, "T": {"temperature": 1}}, "parameters": {"T": {}}},
        {"variables": {**VARIABLES, "T": {"temperature": False}}, "parameters": {"T": {}}},
    ],
)
def test_the_kernel_reads_no_state_that_files_refuse(changed: dict[str, Any]) -> None:
    given = law_as_text(kinematic())
    with pytest.raises(NotWritten):
        StatedLaw.read(given | changed | {"parameters": {**given["parameters"], **changed["parameters"]}})


@pytest.mark.parametrize("energy", ["exp(1000000)*alpha**2", "2**(10**9)*alpha**2"])
def test_numbers_beyond_all_measure_in_an_energy(energy: str) -> None:
    found = duhem.verify(kinematic(), claims=["state_laws"]).certificate()
    found["law"]["energy"] = energy
    found["sha256"] = digest(found)
    with pytest.raises(InputError, match="too large"):
        duhem.recheck(found)


def maxwell(**changed: Any) -> Criterion:
    return law(PRAGER, f"{QUADRATIC} + C/2*alpha**2", flow=("sigma", "Y"), C=ABOVE_0, **changed)


@pytest.mark.parametrize(
    "given",
    [
        pytest.param(maxwell(rates={"u_in": "u - u_in"}), id="a rate in the elastic part"),
        pytest.param(
            law("abs(sigma) - R", QUADRATIC, flow=("10*k*(u - u_in) - 9*sigma", "Y"), variables=SLIP | {"w": Variable("Y")}), id="flow"
        ),
    ],
)
def test_forces_and_variables_that_go_together_refute_nothing_apart(given: Criterion) -> None:
    assert duhem.verify(given, claims=["dissipation"])["dissipation"].verdict is not REFUTED


def test_a_displacement_with_a_range_bounds_the_force() -> None:
    text = ONE.replace('force = "sigma" }\nu_in', 'force = "sigma", min = 0 }\nu_in').replace(
        'u_in = { force = "sigma" }', 'u_in = { force = "sigma", max = 0 }'
    )
    given = reads(text + '[flow]\ndirection = ["1"]\n')
    assert duhem.verify(given, claims=["dissipation"])["dissipation"].verdict is not REFUTED


@pytest.mark.parametrize(
    "ranged", ['w = { force = "W", min = 1, max = 2 }', 'w = { force = "W", value = 2 }', 'w = { force = "W", positive = true }']
)
@pytest.mark.parametrize("energy", ["C/2*w**2", "C*log(w)", "abs(w)**3", "C/w"])
def test_any_range_and_any_energy_end_in_verdicts(ranged: str, energy: str) -> None:
    text = ONE.replace("(0)", energy).replace('["sigma"]', '["sigma", "W"]').replace("abs(sigma)", "norm(sigma, W)") + ranged + "\n"
    found = duhem.verify(reads(text), claims=["state_laws", "dissipation"])
    assert energy != "C*log(w)" or found["state_laws"].verdict is not PROVED  # it is concave


# -- a dissipation that rests on an energy --------------------------------------------------------------------------------

JUMPS = ("where(u - u_in > 0, 1, 0)", "abs(u - u_in)", "sqrt(u)", "u**(4/3) - u_in**(4/3)", "log(u_in)")


@pytest.mark.parametrize("more", JUMPS)
@pytest.mark.parametrize("shape", ["associated", "surfaces", "slips"])
def test_no_dissipation_is_proved_of_an_energy_without_forces(more: str, shape: str) -> None:
    """The state has no force there, or two, and what the jump releases is no part of the sum."""
    flow = {"flow": ("sign(sigma)",)} if shape == "slips" else {}
    head = {"surfaces": (YieldSurface("sigma - R"), YieldSurface("-sigma - R"))} if shape == "surfaces" else {"g": "abs(sigma) - R"}
    given = Criterion(
        "jumps", parameters={"R": ABOVE_0, "k": ABOVE_0}, forces=("sigma",), pressure=None, energy=f"{QUADRATIC} + {more}",
        variables=SLIP, **head, **flow,
    )  # fmt: skip
    found = duhem.verify(given, claims=["dissipation"])["dissipation"]
    assert found.verdict is not PROVED and found.verdict is not REFUTED


@pytest.mark.parametrize("energy", ["k/2*(u + u_in)**2", "k/2*(u - 2*u_in)**2", f"{QUADRATIC} + u"])
def test_no_dissipation_is_proved_where_the_stress_is_two(energy: str) -> None:
    given = Criterion(
        "two", "abs(sigma) - R", {"R": ABOVE_0, "k": ABOVE_0}, ("sigma",), None, energy=energy, variables=SLIP
    )  # fmt: skip
    assert duhem.verify(given, claims=["dissipation"])["dissipation"].verdict is not PROVED
    assert "one force" in refused(given, "dissipation", "fenchel", settled=("origin", "normality"))


def test_a_variable_with_a_force_has_no_second_rate() -> None:
    flow = (ALONG, ALONG)
    with pytest.raises(InputError, match="alpha has a force, and a rate beside the flow"):
        Criterion(
            "twice", PRAGER, {"R": ABOVE_0, "k": ABOVE_0, "C": ABOVE_0}, ("sigma", "Y"), None, flow=flow,
            energy=f"{QUADRATIC} + C/2*alpha**2", variables=SLIP | {"alpha": Variable("Y")}, unforced={"alpha": "-1000*Y"},
        )  # fmt: skip
    with pytest.raises(NotWritten):
        StatedLaw.read(law_as_text(armstrong_frederick()) | {"unforced": {"alpha": "-1000*Y"}})


def test_rates_without_a_value_dissipate_nothing() -> None:
    """grad (a^2 + b^2)^n is infinite at 0 for n < 1/2."""
    given = Criterion("steep", "(a**2 + b**2)**n - 1", {"n": AT_LEAST_0}, ("a", "b"), None, viscous=True)
    assert duhem.verify(given, claims=["dissipation"])["dissipation"].verdict is not PROVED
    assert refused(given, "dissipation", "boundary-power")


def test_a_force_without_a_value_is_said_to_be_the_energys() -> None:
    flow = (ALONG, f"{ALONG} - gamma*alpha")
    variables = SLIP | {"alpha": Variable("Y", domain=AT_LEAST_0)}
    given = law(PRAGER, f"{QUADRATIC} + C*log(alpha)", flow=flow, variables=variables, C=ABOVE_0, gamma=AT_LEAST_0)
    with pytest.raises(InputError, match="with the forces that the energy gives, g divides by alpha"):
        duhem.verify(given, claims=["dissipation"])


def test_a_surface_has_no_rate_of_a_variable_without_a_force() -> None:
    text = FILE[: FILE.index("[flow]")].replace('g = "norm(sigma + X) - R"', "")
    two = """
[[surface]]
g = "sigma + X - R"
flow = ["{}", "1", "1"]

[[surface]]
g = "-sigma - X - R"
flow = ["0", "-1", "-1"]
"""
    assert reads(text + two.format("0"), "made").surfaces
    for wrong in ("1", "%%%((", "sqrt(-1)*zzz"):
        with pytest.raises(InputError):
            reads(text + two.format(wrong), "made")


# -- what is said beside the verdicts -------------------------------------------------------------------------------------


def said_of(given: Criterion | str, *claims: str) -> str:
    return " ".join(duhem.verify(given, claims=list(claims)).remarks)


@pytest.mark.parametrize(
    ("given", "separately"),
    [
        (ADHESION, True),
        ("lemaitre-damage", True),
        ("at1-damage", True),
        (isotropic(Domain.fixed(-1)), False),  # concave in alpha
        (kinematic(), False),  # convex in all of them: nothing to say
    ],
)
def test_an_energy_that_is_convex_in_each_variable_alone(given: Criterion | str, separately: bool) -> None:
    assert ("separately convex" in said_of(given, "state_laws")) is separately


def test_a_potential_at_a_frozen_state_names_it() -> None:
    assert "every frozen value of theta, on which it depends" in said_of("rate-and-state", "convexity")


def test_an_observable_may_have_a_force_that_drives_nothing_but_no_name_in_use() -> None:
    variables = {"eps": Variable("sigma", observable=True), "D": Variable("Y", domain=Domain.between(0, 1))}
    head = {"parameters": {"E": ABOVE_0, "Y_0": ABOVE_0}, "forces": ("Y",), "pressure": None, "energy": "(1 - D)*E*eps**2/2"}
    assert Criterion("bar", "Y - Y_0", variables=variables, **head).variables["eps"].force == "sigma"
    for taken in ("E", "D"):
        with pytest.raises(InputError, match="another name too"):
            Criterion("bar", "Y - Y_0", variables=variables | {"eps": Variable(taken, observable=True)}, **head)


def test_a_law_of_which_every_variable_is_fixed_is_examined() -> None:
    fixed = duhem.load("slip-softening").fix({"u": 0, "u_in": 0, "alpha": 1})
    assert duhem.verify(fixed, claims=["state_laws"])["state_laws"].verdict is not PROVED
