"""Of which flows nothing is said to be tested: a slip that points the wrong way where it was looked at, on whatever face it acts."""

from __future__ import annotations

import pytest

from duhem import Criterion, verify
from duhem.law.domain import Domain
from duhem.law.formula_law import YieldSurface
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.search.boundary_points import scouts
from duhem.proof.search.margins import failures
from tests.long import long_but


def of_surfaces(*surfaces: tuple[str, tuple[str, ...] | None]) -> Criterion:
    stated = tuple(YieldSurface(g, flow=flow) for g, flow in surfaces)
    return Criterion(name="law", surfaces=stated, forces=("a", "b"), pressure=None)


def of_flow(g: str, *flow: str, **ranges: Domain) -> Criterion:
    return Criterion(name="law", g=g, flow=flow, forces=("a", "b"), pressure=None, domain=ranges)


IN = ("-a", "-b")
LEANING = [
    of_surfaces(("a - 1", None), ("a - 1", ("-1", "0"))),  # one surface twice
    of_surfaces(("norm(a, b) - 1", None), ("norm(a, b) - 1", IN)),
    of_surfaces(("norm(a, b) - 1", IN), ("norm(a, b) - 1", None)),
    of_surfaces(("norm(a, b) - 1", None), ("a**2 + b**2 - 1", IN)),
    of_surfaces(("norm(a, b) - 1", None), ("abs(a) - 1", IN)),  # they touch
    of_flow("max(abs(a), abs(b)) - 1", "where(abs(a) >= 1, -a, a)", "where(abs(a) >= 1, -b, b)"),  # turned on the boundary itself
    of_flow("norm(a, b) - 1", "where(norm(a, b) >= 1, -a, a)", "where(norm(a, b) >= 1, -b, b)"),
    of_flow("norm(a, b) - 1", "where(norm(a, b) > 1 - 1/10**12, -a, a)", "where(norm(a, b) > 1 - 1/10**12, -b, b)"),
]


@pytest.mark.slow
@pytest.mark.parametrize("law", long_but([0, 5], LEANING), ids=range(len(LEANING)))
def test_no_violation_is_not_said(law: Criterion) -> None:
    found = verify(law, claims=["normality", "dissipation"])
    assert {r.verdict.value for r in found.results} <= {"undecided", "refuted"}
    for result in found.results:
        assert result.verdict.value == "refuted" or ("in floats" in result.detail and "no exact counterexample confirms" in result.detail)


LEFT_FACE = ("a**2 + b**2 - 1", None)


@pytest.mark.slow
@pytest.mark.parametrize("flow", [("a", "-1"), ("a**3", "-1"), ("-1", "-1"), ("a/100", "-1")])
def test_an_edge_through_the_origin_is_looked_at(flow: tuple[str, ...]) -> None:
    assert verify(of_surfaces(LEFT_FACE, ("-b", flow)), claims="normality")["normality"].verdict.value == "refuted"


@pytest.mark.slow
def test_right_flows_lean_nowhere() -> None:
    for law in (
        of_surfaces(LEFT_FACE, ("-b", ("0", "-1"))),
        of_surfaces(LEFT_FACE, ("a - 1/2", ("1", "0"))),
        of_surfaces(LEFT_FACE, ("a**2 + b**2 - 1", ("a", "b"))),
        of_flow("a**4 + b**4 - 1", "a**3", "b**3"),
        of_flow("max(abs(a), abs(b)) - 1", "where(abs(a) >= abs(b), a, 0)", "where(abs(a) >= abs(b), 0, b)"),
    ):
        (scout,) = scouts(FormulaSubject(law), 1)
        assert scout.found > 300 and failures("normality", scout) == 0 == failures("dissipation", scout)


def test_points_out_of_the_ranges_are_none() -> None:
    law = of_flow("a*b - 1", "-b", "-a", a=Domain(low=0), b=Domain(low=0))
    (scout,) = scouts(FormulaSubject(law), 1)
    assert 0 < scout.found < 360 and scout.boundary.min() >= 0
    assert {r.verdict.value for r in verify(law, claims=["normality", "dissipation"]).results} == {"refuted"}
