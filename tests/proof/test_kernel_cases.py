"""Choices that no force enters: the kernel looks at either law where its condition holds, and at nothing less."""

from __future__ import annotations

from typing import Any

import pytest

from duhem import load, verify
from duhem.law.atlas.entry import ASKED
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.simpler_laws import cases
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import parse
from tests.long import mostly_long

PARAMETERS: dict[str, Any] = {"m": {"positive": True}, "q": {"min": "-1", "max": "2"}, "u": {}}


def law(g: str, *, flow: Any = None, constraints: tuple[str, ...] = ()) -> StatedLaw:
    given = {"forces": ("a", "b"), "pressure": "s", "parameters": PARAMETERS, "constraints": constraints, "g": g, "flow": flow}
    return StatedLaw.read(given)


def confirmed(claim: str, rule: str, stated: StatedLaw) -> bool:
    return not objection(claim, rule, frozenset({"origin", "convexity"} - {claim}), stated, {})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("radius", "right"),
    [
        ("where(-s < 200, -s, 100 - s/2)", True),
        ("where(-s < 200, -s, 100 + s/2)", False),  # < 0 far away
        ("where(-s < 200, 200 + s, -s)", True),  # >= 0 on its side alone
        ("where(-s < 200, 199 + s, -s)", False),
        ("where(-s <= 200, -s, -s - 200)", True),
        ("where(-s < 200, -s, -s - 201)", False),
        ("where(q > 1, q - 1, 1)", True),
        ("where(q >= 1, q - 1, 1)", True),
        ("where(q < 1, q - 1, 1)", False),
        ("where(u > 1, where(u < m, m - 1, u), 2)", True),
        ("where(u > 1, where(u > m, m - 1, u), 2)", False),
        ("where(sqrt(m) < 2, 1, 2)", True),
        ("where(sqrt(u) < 2, 1, 2)", False),  # no value for u < 0
        ("where(log(m) < u/u, 1, 2)", False),
        ("where(u < 0, 1/u**2, 1)", True),
        ("where(u <= 0, 1/u**2, 1)", False),
        ("where(a < 0, 1, 2)", True),  # at the origin that is a number
        ("where(u < 1, 1, 2)*where(u < 2, 1, 2)*where(u < 3, 1, 2)*where(u < 4, 1, 2)", True),
        ("where(u < 1, 1, 2)*where(u < 2, 1, 2)*where(u < 3, 1, 2)*where(u < 4, 1, 2)*where(u < 5, 1, 2)", False),  # too many
    ],
)
def test_the_origin(radius: str, right: bool) -> None:
    assert confirmed("origin", "evaluation", law(f"norm(a, b) - {radius}")) is right


@pytest.mark.parametrize(
    ("g", "right"),
    [
        ("where(u < 0, norm(a, b), abs(a) + abs(b)) - m", True),
        ("where(u < 0, norm(a, b), abs(a) - abs(b)) - m", False),
        ("where(u < 0, norm(a, b), norm(a, b) - u*abs(a)) - m", False),  # the other way round it would be convex
        ("where(u > 0, norm(a, b), norm(a, b) - u*abs(a)) - m", True),
        ("where(a < 0, norm(a, b), abs(a) + abs(b)) - m", False),  # a force chooses
        ("where(u < 0, norm(a, b), where(a < 0, norm(a, b), abs(a) + abs(b))) - m", False),
    ],
)
def test_convexity(g: str, right: bool) -> None:
    assert confirmed("convexity", "composition", law(g)) is right


@pytest.mark.parametrize(("other", "right"), [("1", True), ("0", True), ("-1", False), ("u", True), ("-u", False)])
def test_the_power_of_a_flow(other: str, right: bool) -> None:
    share = f"where(u > 0, {other}, 2)"
    assert confirmed("dissipation", "boundary-power", law("norm(a, b) - m", flow=[f"{share}*a", f"{share}*b"])) is right


def test_every_formula_of_a_law_is_put() -> None:
    surfaces = [{"g": "a - where(u < 0, 1, m)", "flow": ["where(u < 0, 1, m)", "0"]}, {"g": "b - where(u < 0, 2, 1)", "flow": None}]
    given = {"forces": ("a", "b"), "pressure": None, "parameters": PARAMETERS, "constraints": [], "surfaces": surfaces}
    below, above = cases(StatedLaw.read(given))
    assert cases(below) == cases(above) == () and len(below.constraints) == len(above.constraints) == 1
    assert [over(below).polynomial(flow[0]) for _, flow in below.surfaces if flow] == [{(): 1}]
    assert over(above).polynomial(above.g.args[1]) == over(above).polynomial(parse("b - 1"))
    potential = law("norm(a, b) - m", flow={"potential": "where(u < 0, 1, m)*norm(a, b)"})
    below, above = cases(potential)
    assert below.potential != above.potential and below.flow != above.flow and below.g == above.g == potential.g


def test_a_law_without_such_choices_has_no_cases() -> None:
    for g in ("norm(a, b) - m", "where(a < u, a, b) - m", "max(a, u) + b - m"):
        assert cases(law(g)) == ()


PUBLISHED = ("byerlee", "hill48-lankford", "doraivelu", "murrell", "abaqus-hyperbolic", "tresca-plane")


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(PUBLISHED, "byerlee", "hill48-lankford", "doraivelu", "abaqus-hyperbolic"))
def test_published_laws_are_checked(name: str) -> None:
    """Each needs one of the rules above or a sign that is shown by a matrix, by what is multiplied through or over a range."""
    proofs = [r for r in verify(load(name), claims=ASKED).results if r.trust is not None]
    assert len(proofs) >= 4 and {r.trust.value for r in proofs if r.trust} == {"checked"}
