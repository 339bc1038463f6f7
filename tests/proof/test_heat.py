"""Heat between an interface and bodies: proved where every conductance is >= 0, refuted by temperatures that can be put in by hand."""

from __future__ import annotations

from functools import partial
from typing import Any

import pytest
import sympy as sp

import duhem
from duhem import Criterion, Domain, InputError, Verdict
from duhem.law.criterion_file import criterion_text, reads
from duhem.law.state import Variable
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten
from duhem.screening.campaign import Campaign, Claimed, Given, LawName, asked
from tests.proof.laws_with_state import misread, refused

BRAKE = """\
[criterion]
name = "brake"
forces = ["sigma"]
g = "abs(sigma) - mu*abs(sigma_n)*(1 - a*(T - T0))"
[parameters]
mu = { positive = true }
a = { value = 0 }
T0 = { positive = true }
k = { positive = true }
c = { positive = true }
h1 = { min = 0 }
h2 = { min = 0 }
[energy]
psi = "k/2*(u - u_in)**2 - c*(T*log(T/T0) - T + T0)"
[variables]
u = { observable = true, force = "sigma" }
u_in = { force = "sigma" }
T = { temperature = true, positive = true }
[heat]
bodies = { T1 = "h1", T2 = "h2" }
"""


unproved = partial(refused, claim="thermal", rule="conductances")


def with_conductance(h: str) -> Criterion:
    law = reads(BRAKE.replace('T1 = "h1"', f'T1 = "{h}"'))
    assert isinstance(law, Criterion)
    return law


@pytest.mark.parametrize(
    "h", ["h1", "h1*abs(sigma_n)**(19/20)", "h1*sqrt(T*T1)", "h1*(T - T1)**2/T2", "h1/T1", "exp(T)", "0", "pos(T1 - T)", "h1*log(1 + T)"]
)
def test_heat_flows_downhill(h: str) -> None:
    found = duhem.verify(with_conductance(h), claims=["thermal"])
    assert (found["thermal"].verdict, found["thermal"].method, str(found["thermal"].trust)) == (Verdict.PROVED, "conductances", "checked")
    assert duhem.recheck(found.certificate())["thermal"].confirmed


@pytest.mark.parametrize(
    "h", ["-h1", "h1 - 1", "h1*(T1 - T)", "h1*log(T)", "h1*(T1 - T)*(T2 - T)", "-1/T1", "h1*(1 - abs(sigma_n))", "1 - u**2"]
)
def test_heat_that_flows_uphill(h: str) -> None:
    law = with_conductance(h)
    found = duhem.verify(law, claims=["thermal"])["thermal"]
    assert found.verdict is Verdict.REFUTED and found.witness is not None and found.trust is None
    (state,) = (dict(point) for point in found.witness.points.values())
    here = {law.symbols()[x]: sp.Rational(v) for x, v in {**found.witness.parameters, **state}.items()}
    t, t1, t2 = (here[law.symbols()[x]] for x in ("T", "T1", "T2"))
    assert min(t, t1, t2) > 0
    flows = [(body, law.heat[name].subs(here) * (body - t)) for name, body in (("T1", t1), ("T2", t2))]
    assert sum(flow / body * (body - t) for body, flow in flows).evalf() < 0
    assert unproved(with_conductance("h1"), heat={"T1": h, "T2": "h2"})


@pytest.mark.parametrize("h", ["sqrt(T - 1) - sqrt(T - 1) + h1", "h1*log(T - 1)**2", "h1/(T - T1)**2", "h1/u**2", "0/h1"])
def test_a_conductance_has_a_value_at_all_temperatures(h: str) -> None:
    assert unproved(with_conductance("h1"), heat={"T1": h, "T2": "h2"})
    assert unproved(with_conductance("h1"), heat={}) and not unproved(with_conductance("h1"))


@pytest.mark.parametrize(
    "changed",
    [
        {"heat": {"T1": "h1", "T3": "h2"}},
        {"heat": {"T1": "sigma**2"}},
        {"heat": {"T1": "h1 > 0"}},
        {"heat": {"T": "h1"}},
        {"heat": {"h1": "h1"}},  # it may be 0
        {"heat": ["h1"]},
        {"variables": {"u": {"observable": True, "force": "sigma"}, "u_in": {"force": "sigma"}}, "energy": "k*(u - u_in)**2"},
    ],
)
def test_texts_in_which_no_heat_can_flow(changed: dict[str, Any]) -> None:
    with pytest.raises(NotWritten):
        StatedLaw.read(law_as_text(with_conductance("h1")) | changed)


def test_a_temperature_that_is_never_above_0_is_refused() -> None:
    given = law_as_text(with_conductance("h1"))
    with pytest.raises(NotWritten, match="no temperature"):
        StatedLaw.read(given | {"parameters": {**given["parameters"], "T": {"min": None, "max": "0"}}})


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('bodies = { T1 = "h1", T2 = "h2" }', "bodies = 3", "[heat] has no table of bodies"),
        ('bodies = { T1 = "h1", T2 = "h2" }', "", "[heat] has no table of bodies"),
        ("bodies =", "walls =", "unknown key 'walls'"),
        ('T1 = "h1"', "T1 = 3", "T1 is not a text"),
        ('T1 = "h1"', 'T1 = "h3"', "h3"),
        ('T1 = "h1"', 'T1 = "sigma**2"', "the conductance to T1 uses ['sigma']"),
        ('T1 = "h1"', 'T = "h1"', "'T' is declared twice"),
        ('T1 = "h1"', 'mu = "h1"', "'mu' is declared twice"),
        ("T = { temperature = true, positive = true }", 'T = { force = "sigma" }', "T"),
        ("T = { temperature = true, positive = true }", "T = { temperature = true, max = 0 }", "the temperature T is never > 0"),
    ],
)
def test_what_is_wrong_in_a_file_is_said(before: str, after: str, said: str) -> None:
    assert said in misread(BRAKE, before, after)


def test_a_law_in_python_declares_bodies_by_their_conductances() -> None:
    own = {
        "name": "own",
        "g": "abs(s) - R",
        "parameters": {"R": Domain(positive=True), "h": Domain.between(0)},
        "forces": ("s",),
        "pressure": None,
    }
    law = Criterion(**own, variables={"T": Variable(temperature=True)}, heat={"T1": "h"})
    assert law.parameters["T1"].positive and str(law.fix({"T1": 300}).heat["T1"]) == "h"
    assert duhem.verify(law.fix({"T1": 300}), claims=["thermal"])["thermal"].verdict is Verdict.PROVED
    for wrong in ({"heat": {"T1": "h"}}, {"heat": {"T": "h"}, "variables": {"T": Variable(temperature=True)}}):
        with pytest.raises(InputError):
            Criterion(**own, **wrong)


def test_a_law_with_heat_is_written_as_a_file_that_says_it() -> None:
    law = with_conductance("h1*sqrt(T)")
    again = reads(criterion_text(law))
    assert again == law and dict(again.heat) == dict(law.heat) and list(again.parameters) == list(law.parameters)
    with pytest.raises(InputError, match="no file states the temperature T1 of a body"):
        criterion_text(law.fix({"T1": 300}))


@pytest.mark.slow
def test_only_a_law_with_heat_makes_the_claim() -> None:
    heated, plain = with_conductance("h1"), reads(BRAKE.partition("[heat]")[0])
    assert "thermal" in [r.claim for r in duhem.verify(heated, effort="quick")]
    found = duhem.verify(plain, effort="quick")
    assert "thermal" not in [r.claim for r in found]
    assert ["the law has no [heat]" in x.reason for x in found.left_out if "thermal" in x.part] == [True]
    for law in ("antoni2007", "wedge", plain):
        asked_for = duhem.verify(law, claims=["thermal"])["thermal"]
        assert asked_for.verdict is Verdict.NOT_APPLICABLE and "no [heat]" in asked_for.detail
    row = Campaign((Given(((LawName("coulomb"), ()),)),), Claimed(("origin", "thermal")))
    assert {line.claim: line.verdict for line in asked(row, 1)} == {"origin": "proved", "thermal": "not_applicable"}
