"""What the kernel must not take for a proof about a law with a state, nor for the text of one."""

from __future__ import annotations

from typing import Any

import pytest

import duhem
from duhem import Domain, InputError
from duhem.law.criterion_file import reads
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import digest
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.state import energy_differentiable
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import within
from duhem.proof.kernel.term import NotWritten
from tests.proof.laws_with_state import (
    ABOVE_0,
    BELOW_0,
    FILE,
    ONE,
    PRAGER,
    QUADRATIC,
    RECOVERS,
    RECOVERY,
    SHARE,
    armstrong_frederick,
    kinematic,
    law,
    refused,
)


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


@pytest.mark.parametrize("kinked", ["abs(alpha)", "pos(alpha)", "max(alpha, 2*alpha)", "norm(alpha)", "where(alpha > 0, 2*alpha, alpha)"])
def test_an_energy_with_a_kink_gives_no_one_force(kinked: str) -> None:
    energy = f"{QUADRATIC} + C/2*alpha**2 + {kinked}"
    for claim, rule, evidence in (
        ("state_laws", "composition", {}),
        ("dissipation", "power-share", SHARE),
        ("dissipation", "boundary-power", {}),
    ):
        assert refused(armstrong_frederick(), claim, rule, evidence, energy=energy)


@pytest.mark.parametrize("kinked", ["abs(alpha)", "pos(alpha)", "-3*neg(alpha)", "pos(-alpha)", "1/(9 - alpha**2)", "sqrt(9 - alpha**2)"])
@pytest.mark.parametrize(("least", "most"), [("0", "2"), ("-2", "0"), ("-2", "2"), ("0", "3")])
def test_an_energy_has_one_force_in_the_range_of_its_variable(kinked: str, least: str, most: str) -> None:
    """A kink at the end of the range is none in it; a tip outside of it is none, and one at its end is."""
    stored = law_as_text(kinematic())
    text = {**stored, "energy": f"{QUADRATIC} + C/2*alpha**2 + {kinked}"}
    text["parameters"] = {**stored["parameters"], "alpha": {"min": least, "max": most}}
    inside = (least, most) != ("-2", "2") if "9" not in kinked else most != "3"
    assert (energy_differentiable(StatedLaw.read(text)) == "") is inside


def test_a_kink_in_the_temperature_is_not_concave() -> None:
    variables = {**law_as_text(kinematic())["variables"], "T": {"temperature": True}}
    parameters = {**law_as_text(kinematic())["parameters"], "T": {"positive": True}}
    for heat, right in (("-C*T*(log(T) - 1)", True), ("-T**2", True), ("abs(T - 300)", False), ("T**2", False), ("-abs(T - 300)", False)):
        energy = f"{QUADRATIC} + C/2*alpha**2 + {heat}"
        said = refused(kinematic(), "state_laws", "composition", energy=energy, variables=variables, parameters=parameters)
        assert (said == "") is right, (heat, said)


VARIABLES = {"u": {"observable": True, "force": "sigma"}, "u_in": {"force": "sigma"}, "alpha": {"force": "Y"}}


def test_a_variable_that_the_energy_names_has_a_force() -> None:
    with pytest.raises(InputError, match="the energy depends on w, which has no force"):
        reads(ONE.replace("(0)", "C/2*w**2") + "w = {}\n")
    with pytest.raises(NotWritten):
        StatedLaw.read(law_as_text(kinematic()) | {"energy": f"{QUADRATIC} + C/2*w**2", "variables": {**VARIABLES, "w": {}}})


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
