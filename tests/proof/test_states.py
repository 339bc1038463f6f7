"""Laws with a state: what their energy and their dissipation are shown to be, and what is said beside the verdicts."""

from __future__ import annotations

from itertools import product

import pytest

import duhem
from duhem import Criterion, Domain, InputError, Verdict, YieldSurface
from duhem.law.criterion_file import reads
from duhem.law.state import Variable
from tests.long import mostly_long
from tests.proof.laws_with_state import (
    ABOVE_0,
    ALONG,
    AT_LEAST_0,
    BELOW_0,
    ONE,
    PRAGER,
    QUADRATIC,
    RECOVERS,
    RECOVERY,
    SLIP,
    armstrong_frederick,
    isotropic,
    kinematic,
    law,
    refused,
    violated,
)

PROVED, REFUTED = Verdict.PROVED, Verdict.REFUTED
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


def test_the_conclusion_names_the_state_laws() -> None:
    said = duhem.verify(isotropic(Domain.fixed(-1)), claims=["origin", "state_laws"]).to_text()
    assert "generalized standard: no (state_laws refuted)" in said


HEAT = "T = { temperature = true, min = 0, max = 2 }\n"


@pytest.mark.parametrize(
    "heat",
    [
        "30*pos(T - 1) - T**2",
        "30*abs(T - 1) - T**2",
        "30*max(T, 1)",
        "abs(T - 1) - pos(T - 1)",
        "100*(abs(T - 1) - pos(T - 1)) - T**2",
    ],
)
def test_kinks_in_the_temperature_that_cancel(heat: str) -> None:
    assert duhem.verify(reads(ONE.replace("(0)", heat) + HEAT), claims=["state_laws"])["state_laws"].verdict is not PROVED


@pytest.mark.parametrize("heat", ["abs(T - 300) - pos(T - 300)", "100*(abs(T - 300) - pos(T - 300)) - T**2", "-neg(T)"])
def test_a_kink_beyond_the_range_of_the_temperature_is_none(heat: str) -> None:
    assert duhem.verify(reads(ONE.replace("(0)", heat) + HEAT), claims=["state_laws"])["state_laws"].verdict is PROVED


def test_rates_of_their_own_make_no_generalized_standard_law() -> None:
    skew = law(PRAGER, f"{QUADRATIC} + C/2*alpha**2", rates={"u_in": "sigma + 5*Y", "alpha": "Y - 5*sigma"}, C=ABOVE_0)
    assert duhem.verify(skew).generalized_standard is None


JUMPS = ("where(u - u_in > 0, 1, 0)", "abs(u - u_in)", "sqrt(u)", "u**(4/3) - u_in**(4/3)", "log(u_in)")
SHAPES = "associated", "surfaces", "slips"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("more", "shape"), mostly_long(product(JUMPS, SHAPES), *product(JUMPS, SHAPES[:2]), (JUMPS[0], "slips"), (JUMPS[-1], "slips"))
)
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


@pytest.mark.slow
@pytest.mark.parametrize("energy", ["k/2*(u + u_in)**2", "k/2*(u - 2*u_in)**2", f"{QUADRATIC} + u"])
def test_no_dissipation_is_proved_where_the_stress_is_two(energy: str) -> None:
    given = Criterion(
        "two", "abs(sigma) - R", {"R": ABOVE_0, "k": ABOVE_0}, ("sigma",), None, energy=energy, variables=SLIP
    )  # fmt: skip
    assert duhem.verify(given, claims=["dissipation"])["dissipation"].verdict is not PROVED
    assert "one force" in refused(given, "dissipation", "fenchel", settled=("origin", "normality"))


def test_a_force_without_a_value_is_said_to_be_the_energys() -> None:
    flow = (ALONG, f"{ALONG} - gamma*alpha")
    variables = SLIP | {"alpha": Variable("Y", domain=AT_LEAST_0)}
    given = law(PRAGER, f"{QUADRATIC} + C*log(alpha)", flow=flow, variables=variables, C=ABOVE_0, gamma=AT_LEAST_0)
    with pytest.raises(InputError, match="with the forces that the energy gives, g divides by alpha"):
        duhem.verify(given, claims=["dissipation"])


def said_of(given: Criterion | str, *claims: str) -> str:
    return " ".join(duhem.verify(given, claims=list(claims)).remarks)


@pytest.mark.slow
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


def test_an_energy_that_is_concave_in_the_temperature_is_convex_in_the_others_alone() -> None:
    text = ONE.replace("(0)", "C*v**2*w**2 - T**2").replace('["sigma"]', '["sigma", "V", "W"]')
    text += 'v = { force = "V" }\nw = { force = "W" }\nT = { temperature = true, positive = true }\n'
    assert "separately convex: in each variable but the temperature alone" in said_of(reads(text), "state_laws")


def test_a_potential_at_a_frozen_state_names_it() -> None:
    assert "every frozen value of theta, on which it depends" in said_of("rate-and-state", "convexity")


def test_a_law_of_which_every_variable_is_fixed_is_examined() -> None:
    fixed = duhem.load("slip-softening").fix({"u": 0, "u_in": 0, "alpha": 1})
    assert duhem.verify(fixed, claims=["state_laws"])["state_laws"].verdict is not PROVED
