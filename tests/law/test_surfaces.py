"""Laws of several surfaces, and of a boundary curve, from files and from Python: what is read, said, refused and written back."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import pytest
import sympy as sp

import duhem
from duhem.errors import InputError
from duhem.law.criterion_file import criterion_text, reads
from duhem.law.curve_law import ParametricCriterion
from duhem.law.domain import POSITIVE, Domain
from duhem.law.formula_law import Criterion, YieldSurface, criterion

HEAD = '[criterion]\nname = "x"\n'
CAPPED = (
    HEAD
    + """
[define]
r = "norm(sigma_a, sigma_b)"
[parameters]
mu = { positive = true }
[[surface]]
g = "r - mu*abs(sigma_n)"
[[surface]]
g = "abs(sigma_a) - abs(sigma_n)"
flow = ["sigma_a", "sigma_b"]
[[surface]]
g = "abs(sigma_b) - abs(sigma_n)"
potential = "sigma_b**2"
"""
)


def test_surfaces_are_read_with_their_flows_and_written_back() -> None:
    law = reads(CAPPED)
    assert isinstance(law, Criterion)
    a, b, n = (law.symbols()[name] for name in ("sigma_a", "sigma_b", "sigma_n"))
    assert [s.flow for s in law.surfaces] == [None, (a, b), (0, 2 * b)]
    assert law.g == sp.Max(*(s.g for s in law.surfaces)) and law.surfaces[1].g == sp.Abs(a) - sp.Abs(n)
    assert not law.associated and law.flow is None
    again = reads(criterion_text(law))
    assert isinstance(again, Criterion) and (again.surfaces, again.g) == (law.surfaces, law.g)
    assert pickle.loads(pickle.dumps(law)) == law and hash(pickle.loads(pickle.dumps(law))) == hash(law)
    fixed = law.fix({"mu": "0.3"})
    assert [s.potential for s in fixed.surfaces] == [None, None, "sigma_b**2"] and fixed.surfaces[2].flow == (0, 2 * b)


def test_a_function_may_return_surfaces() -> None:
    @criterion(name="capped-cone", parameters={"c": Domain(low=0, high=1)})
    def capped(sigma_a: Any, sigma_b: Any, sigma_n: Any, mu: Any, c: Any) -> Any:
        """A cone with a cap."""
        return YieldSurface(sp.sqrt(sigma_a**2 + sigma_b**2) + mu * sigma_n), YieldSurface(sigma_a - c, flow=(1, c * sigma_b))

    stated = (YieldSurface("sqrt(sigma_a**2 + sigma_b**2) + mu*sigma_n"), YieldSurface("sigma_a - c", ("1", "c*sigma_b")))
    assert capped == Criterion(
        "capped-cone", parameters={"mu": POSITIVE, "c": Domain(low=0, high=1)}, surfaces=stated, summary="A cone with a cap."
    )

    @criterion(name="one-surface", pressure=None)
    def one(sigma_a: Any, sigma_b: Any) -> Any:
        return YieldSurface(sigma_a**2 + sigma_b**2 - 1, potential="sigma_a**2")

    assert one.surfaces[0].flow == (2 * one.symbols()["sigma_a"], 0)


@pytest.mark.parametrize(
    ("returned", "flow", "said"),
    [
        (lambda a, b: [YieldSurface(a - 1), b - 1], None, "is no surface"),
        (lambda a, b: [a - 1, b - 1], None, "is no formula"),
        (lambda a, b: [], None, "is no formula"),
        (lambda a, b: (YieldSurface(a - 1), YieldSurface(b - 1)), ("a", "b"), "takes g and flow from its surfaces"),
    ],
)
def test_what_a_function_may_not_return(returned: Any, flow: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        criterion(name="x", forces=("a", "b"), pressure=None, flow=flow)(returned)


def test_python_takes_surfaces_as_files_do() -> None:
    mu = duhem.load("coulomb").parameters["mu"]
    plain = Criterion("x", "norm(sigma_a, sigma_b) - mu*abs(sigma_n)", {"mu": mu})
    cone = YieldSurface("norm(sigma_a, sigma_b) - mu*abs(sigma_n)")
    both = Criterion("x", parameters={"mu": mu}, surfaces=(cone, YieldSurface("sigma_a")))
    assert both.associated and both.g == sp.Max(plain.g, both.symbols()["sigma_a"])
    for wrong, what in [
        (lambda: Criterion("x"), "there is no g"),
        (lambda: replace(both, g=plain.g), "takes g and flow from its surfaces"),
        (lambda: Criterion("x", surfaces=("sigma_a",)), "is no surface"),
        (lambda: Criterion("x", surfaces=(YieldSurface("sigma_a", ("1",)),)), "1 components for 2 forces"),
        (lambda: Criterion("x", surfaces=(YieldSurface("sigma_a"), YieldSurface("sigma_n"))), "does not depend on any force"),
        (lambda: Criterion("x", surfaces=(YieldSurface("sigma_a", ("1", "0"), "sigma_a**2"),)), "both given"),
    ]:
        with pytest.raises(InputError, match=what):
            wrong()


@pytest.mark.parametrize(
    ("text", "place", "what"),
    [
        ('g = "sigma_a"\n[[surface]]\ng = "sigma_b"', "3:1", "[[surface]] and g are both given"),
        ('[[surface]]\ng = "sigma_a"\n[flow]\ndirection = ["1", "0"]', "5:1", "[[surface]] and [flow] are both given"),
        ('[surface]\ng = "sigma_a"', "3:1", "surface is no list of tables"),
        ('[[surface]]\ng = "sigma_a"\n[[surface]]\nflow = ["1", "0"]', "5:1", "[[surface]] has no g"),
        ('[[surface]]\ng = "sigma_a"\n[[surface]]\ng = "sigma_b + bad"', "6:16", "unknown name 'bad'"),
        ('[[surface]]\ng = "sigma_a"\nflow = ["1"]', "5:1", "1 components for 2 forces"),
        ('[[surface]]\ng = "sigma_a"\nflow = ["1", "0"]\npotential = "sigma_a"', "6:1", "flow and potential are both given"),
        ('[[surface]]\ng = "sigma_a"\nslip = ["1", "0"]', "5:1", "unknown key 'slip'"),
        ('[[surface]]\ng = "sigma_n"', "4:1", "g does not depend on any force"),
        ('g = "sigma_a"\n[boundary]\nT = ["cos(phi)", "sin(phi)"]', "3:1", "[boundary] and g are both given"),
        ('[boundary]\nT = ["cos(phi)", "sin(phi)"]\n[flow]\ndirection = ["1", "0"]', "5:1", "[boundary] and [flow] are both given"),
        ('[boundary]\nT = ["cos(phi)", "sin(2*phi)"]', "4:18", "otherwise than as cos(phi) and sin(phi)"),
        ('[boundary]\nT = ["cos(phi)"]', "4:1", "T has 1 components for 2 forces"),
        ('[boundary]\nangle = "t"', "3:1", "[boundary] has no T"),
        ('[boundary]\nangle = "sigma_b"\nT = ["1", "1"]', "4:1", "'sigma_b' is declared twice"),
        ('[boundary]\nangle = "t"\nT = ["cos(t)", "sin(t) + q"]', "5:26", "unknown name 'q'"),
        ('pressure = false\n[boundary]\nT = ["cos(phi)", "sin(phi)"]', "4:1", "two forces and a pressure"),
        ('[boundary]\nT = ["cos(phi)", "sin(phi)"]\nd = ["cos(phi)", "sin(phi)"]', "5:1", "unknown key 'd'"),
    ],
)
def test_a_fault_is_told_with_its_place(text: str, place: str, what: str) -> None:
    with pytest.raises(InputError) as fault:
        reads(HEAD + text, "law.toml")
    assert what in fault.value.what
    line, column = place.split(":")
    assert fault.value.where == f"law.toml:{line}:{column}" and fault.value.remedy


def test_a_curve_is_written_and_read_back() -> None:
    wedge = duhem.load("wedge")
    assert isinstance(wedge, ParametricCriterion)
    again = reads(criterion_text(wedge))
    assert isinstance(again, ParametricCriterion)
    assert again == replace(wedge, instead="", derivation="") and again.summary == wedge.summary


def test_a_curve_may_have_local_names_and_an_angle_of_its_own() -> None:
    law = reads(
        HEAD
        + """
[define]
rho = "1 + e*cos(t)"
[parameters]
e = { min = 0, max = 0.5 }
[boundary]
angle = "t"
T = ["rho*cos(t)", "rho*sin(t)"]
"""
    )
    assert isinstance(law, ParametricCriterion) and law.flow is None
    t, e = law.symbols()["t"], law.symbols()["e"]
    assert law.boundary[1] == (1 + e * sp.cos(t)) * sp.sin(t)


def test_what_needs_a_formula_says_that_a_curve_has_none() -> None:
    law = reads(HEAD + '[boundary]\nT = ["cos(phi)", "sin(phi)"]')
    for ask in (lambda: duhem.derive(law), lambda: duhem.project(law, [1.0, 0.0], -1.0, 1.0)):
        with pytest.raises(InputError, match="has no formula g, only a boundary curve"):
            ask()


def test_a_step_of_associated_surfaces_is_their_projection_and_others_have_none() -> None:
    tension = (
        '[criterion]\nname = "x"\nforces = ["s", "t"]\npressure = false\n[[surface]]\ng = "s - 1"\n[[surface]]\ng = "abs(t) + s - 1"\n'
    )
    found = duhem.project(reads(tension), [5.0, 2.0], None, 1.0)
    assert found.stress[0] == pytest.approx([1.0, 0.0], abs=1e-9)
    with pytest.raises(InputError, match="its own flow direction"):
        duhem.project(reads(tension + 'potential = "abs(t)"\n'), [5.0, 2.0], None, 1.0)


@pytest.mark.slow
def test_the_derivation_has_one_multiplier_a_surface() -> None:
    law = reads(CAPPED)
    derived = duhem.derive(law)
    one, two, three = derived.names.multipliers
    a, b = law.force_symbols()
    rates = derived["flow"].rhs
    assert rates[0].coeff(two) == a and rates[1].coeff(three) == 2 * b and {one, two} <= rates[0].free_symbols
    assert "dissipation_potential" not in derived
    assert derived["step_complementarity"].relation.free_symbols >= set(derived.names.steps)
    assert "lambda" in derived.text() and r"\dot\lambda_{2}" in derived.latex()
