"""Rates that are the gradient of a potential: proved where it is convex and least at 0, and nowhere else."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem import Criterion, Domain, InputError, Verdict
from tests.proof.laws_with_state import AT_LEAST_0, refused, viscous

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
    for rule in ("euler", "homogeneity", "potential", "power-share"):
        assert refused(given, "dissipation", rule, {"share": "0", "rest": "0"}, settled=("origin",))
    dissipates = "cosh" in potential  # a sinh(a) is >= 0, whatever the potential is at zero force
    assert (not refused(given, "dissipation", "boundary-power", settled=("origin",))) is dissipates
    assert duhem.verify(given, claims=[claim])[claim].verdict is not Verdict.PROVED


@pytest.mark.parametrize(
    ("potential", "least", "dissipates"),
    [
        ("exp(-A*(1 - sqrt(abs(a)))) - exp(-A) + b**2", True, False),  # of glassy polymers; it has no slope at 0
        ("exp(-A*(1 + sqrt(abs(a)))) - exp(-A) + b**2", False, False),
        ("1 - exp(-A*a**2 - b**2)", True, True),
        ("exp(-A*a**2 - b**2) - 1", False, False),
        ("a**2 + b**2/(1 + b**2) + a**2*exp(-b)", True, False),  # it falls along some rays
        ("A*pos(norm(a, b) - 2*a)**3 - a**3", False, False),
        ("A*(pos(a)**3 - 2*pos(a)**2 + a**2 + b**2)", False, False),
    ],
)
def test_a_potential_that_is_not_convex_is_read_on_each_side_of_zero_force(potential: str, least: bool, dissipates: bool) -> None:
    """What is shown is looked at in floats, slopes by differences along rays."""
    given = viscous(potential)
    told = [not refused(given, claim, rule) for claim, rule in (("origin", "evaluation"), ("dissipation", "boundary-power"))]
    assert told == [least, dissipates]
    x, words = np.random.default_rng(5).standard_normal((2, 2000)) * 2, {"exp": np.exp, "abs": np.abs, "sqrt": np.sqrt, "where": np.where}
    words |= {"norm": np.hypot, "pos": lambda y: np.maximum(y, 0)}
    near, far = (eval(potential, {**words, "A": 1.5, "a": r * x[0], "b": r * x[1]}) for r in (1.0, 1.0001))
    assert not least or bool(np.all(near >= 0))
    assert not dissipates or bool(np.all(far >= near - 1e-12))


@pytest.mark.parametrize(
    ("potential", "domain", "smooth", "dissipates"),
    [
        ("A*abs(a)**(3/2)*(2 + sin(b))", {"a": ("1/2", 2), "b": (1, "3/2")}, True, True),
        ("A*abs(a)**(3/2)*(2 + sin(4*b))", {"a": ("1/2", 2), "b": (1, "3/2")}, True, False),
        ("A*abs(a - 1)*(2 + sin(b))", {"a": ("1/2", 2), "b": (1, "3/2")}, False, False),  # a kink, and it falls before that
        ("A*(a + abs(a - 1)/2)*(2 + sin(b/2))", {"a": ("1/2", 2), "b": (1, "3/2")}, False, True),
        (
            "A*(cosh(a) - 1)*b**2",
            {"a": (-1, 2), "b": (1, "3/2")},
            True,
            None,
        ),  # where a is 0 and force . rate is small, in no part too small
        ("-A*a**2*b**2", {"a": ("1/2", 2), "b": (1, "3/2")}, True, False),
        ("A*a**2*b**2", {"a": ("1/2", 2)}, False, False),  # b has no range
    ],
)
def test_a_potential_is_read_in_ranges_of_the_forces(potential: str, domain: Any, smooth: bool, dissipates: bool | None) -> None:
    sides = {name: Domain.between(*ends) for name, ends in domain.items()}
    given = Criterion("ranges", potential, {"A": Domain.between(1, 2)}, ("a", "b"), None, domain=sides, viscous=True)
    assert (not refused(given, "smoothness", "slope-in-a-box")) is smooth
    assert dissipates is None or (not refused(given, "dissipation", "power-in-a-box")) is dissipates
    assert refused(given, "convexity", "curvature-in-a-box")
    ends = [[float(Fraction(end)) for end in domain.get(name, (-1, 1))] for name in "ab"]
    a, b = (np.linspace(low, high, 41)[:, None] for low, high in ends)
    near, far = (eval(potential, {"abs": np.abs, "sin": np.sin, "cosh": np.cosh, "A": 1, "a": r * a, "b": r * b.T}) for r in (1, 1 + 1e-6))
    assert not dissipates or bool(np.all(far >= near))


def test_what_refutes_a_potential_says_what_k_is() -> None:
    """Such a law has none of its own: its claims are about what lies above the graph of Phi*."""
    found = duhem.verify(viscous("A*a**2 - b**2"), claims=["convexity", "normality", "dissipation", "duality"])
    refuted = {result.claim: result.detail for result in found if result.verdict is Verdict.REFUTED}
    assert {*refuted} >= {"convexity", "normality"} and all(said.startswith("with K = {Phi* <= z}: ") for said in refuted.values())
    assert "none is looked for of the conjugate" in found["duality"].detail


@pytest.mark.long
def test_a_potential_without_a_value_is_not_refuted_there() -> None:
    bent = viscous("a**2 + b**2 + where(a < 0, -10, 1)*(log(a) - log(a) + 0*a) - 4*neg(a)**2 + sqrt(a)*0")
    found = duhem.verify(bent, claims=["convexity"], effort="quick")["convexity"]
    assert found.witness is None or all(sp.Rational(point["a"]) >= 0 for point in found.witness.points.values())


@pytest.mark.slow
def test_rates_without_a_value_dissipate_nothing() -> None:
    """grad (a^2 + b^2)^n is infinite at 0 for n < 1/2."""
    given = Criterion("steep", "(a**2 + b**2)**n - 1", {"n": AT_LEAST_0}, ("a", "b"), None, viscous=True)
    assert duhem.verify(given, claims=["dissipation"])["dissipation"].verdict is not Verdict.PROVED
    assert refused(given, "dissipation", "boundary-power")


@pytest.mark.parametrize("rule", ["boundary-power", "euler", "homogeneity", "fenchel"])
def test_a_potential_of_which_no_gradient_is_known_is_objected_to(rule: str) -> None:
    given = viscous("A*(a**2 + b**2)*(4 + atan2(b, 1 + a**2))")  # the power that the epigraph is asked for needs its gradient
    assert refused(given, "dissipation", rule, settled=("origin", "convexity", "normality"))
