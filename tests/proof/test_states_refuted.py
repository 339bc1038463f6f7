"""Claims about a state refuted by one that can be put in by hand, and states that refute nothing."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
import sympy as sp

import duhem
from duhem import Criterion, Domain, Verdict
from duhem.law.criterion_file import reads
from duhem.law.state import Variable
from tests.proof.laws_with_state import ABOVE_0, AT_LEAST_0, ONE, PRAGER, QUADRATIC, SLIP, law, violated

PROVED, REFUTED = Verdict.PROVED, Verdict.REFUTED


@pytest.mark.slow
def test_forces_that_no_state_has_refute_nothing() -> None:
    """An associated law whose K leaves 0 out dissipates less than 0 at forces that this energy never gives together."""
    away = law("(sigma - 2)**2 + (Y - 2)**2 - 1", f"{QUADRATIC} + C/2*alpha**2", C=ABOVE_0)
    assert duhem.verify(away, claims=["dissipation"])["dissipation"].verdict is not REFUTED


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_rates_without_an_energy_are_refuted_by_any_forces() -> None:
    own = {"name": "own", "g": "norm(sigma, Y) - R", "parameters": {"R": ABOVE_0}, "forces": ("sigma", "Y"), "pressure": None}
    spends = Criterion(**own, variables={"alpha": Variable("Y")}, rates={"alpha": "-Y"})
    assert duhem.verify(spends, claims=["dissipation"])["dissipation"].verdict is REFUTED
    tied = Criterion(**own, variables={"alpha": Variable("Y")}, rates={"alpha": "-Y + 100*alpha"})  # Y may be a function of alpha
    assert duhem.verify(tied, claims=["dissipation"])["dissipation"].verdict is not REFUTED


@pytest.mark.slow
@pytest.mark.parametrize(("nothing", "verdict"), [("0*sqrt(alpha - 100)", False), ("log(alpha)*0", False), ("alpha*0", True)])
def test_an_energy_without_a_value_refutes_nothing_there(nothing: str, verdict: bool) -> None:
    """As it is written it has none where alpha < 0, and there alone the rates cost energy."""
    text = ONE.replace("(0)", f"C/2*alpha**2 + {nothing}").replace('["sigma"]', '["sigma", "A"]')
    text += 'alpha = { force = "A", max = 50 }\n[dissipation]\nrates = { alpha = "where(alpha < 0, -A, A)" }\n'
    found = duhem.verify(reads(text), claims=["dissipation"], effort="quick")["dissipation"]
    assert (found.verdict is REFUTED) is verdict


@pytest.mark.parametrize("g", ["5 - a**2 - b - m", "m*(5 + b) - a**2 - 6*b"])
def test_no_energy_is_refuted_where_none_is_stated(g: str) -> None:
    """K is not convex and {g <= 0} may look like an epigraph; the kernel proves nothing of a constraint that may have no value."""
    domains = {"m": ABOVE_0, "e": Domain.between(Fraction(-1, 2), 1)}
    given = Criterion("plain", g, domains, ("a", "b"), None, constraints=("log(e) <= 0",))
    assert duhem.verify(given, claims=["state_laws"])["state_laws"].verdict is Verdict.UNDECIDED


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


@pytest.mark.slow
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


@pytest.mark.slow
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


def maxwell(**changed: Any) -> Criterion:
    return law(PRAGER, f"{QUADRATIC} + C/2*alpha**2", flow=("sigma", "Y"), C=ABOVE_0, **changed)


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize(
    "ranged", ['w = { force = "W", min = 1, max = 2 }', 'w = { force = "W", value = 2 }', 'w = { force = "W", positive = true }']
)
@pytest.mark.parametrize("energy", ["C/2*w**2", "C*log(w)", "abs(w)**3", "C/w"])
def test_any_range_and_any_energy_end_in_verdicts(ranged: str, energy: str) -> None:
    text = ONE.replace("(0)", energy).replace('["sigma"]', '["sigma", "W"]').replace("abs(sigma)", "norm(sigma, W)") + ranged + "\n"
    found = duhem.verify(reads(text), claims=["state_laws", "dissipation"])
    assert energy != "C*log(w)" or found["state_laws"].verdict is not PROVED  # it is concave
