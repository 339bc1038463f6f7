"""Walks over parameters and boundary points together find violations that no plain choice of the parameters shows."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from duhem import Criterion, Verdict, verify
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.search.boundary_points import scouts
from duhem.proof.search.margins import WALK, failures, highest_at_zero, least_margin

# shear strength that rises with compression across the grain, of the third degree; s6 has no end where the factor of its square is < 0
WOOD = Criterion(
    "wood", "F1*s1 + F11*s1**2 + F2*s2 + F22*s2**2 + F66*s6**2 + 3*F166*s1*s6**2 + 3*F266*s2*s6**2 - 1",
    {"F1": Domain.between(-1, 1), "F11": POSITIVE, "F2": Domain.between(-1, 1), "F22": POSITIVE, "F66": POSITIVE,
     "F166": Domain.between(0, "1/10"), "F266": Domain.between(0)},
    ("s1", "s2", "s6"), None, domain={"s1": Domain.between(-1, 1), "s2": Domain.between(-1, 1)}, constraints=("F266 < F66",),
)  # fmt: skip


def test_the_margin_after_a_walk_is_below_that_of_the_scouts() -> None:
    subject = FormulaSubject(WOOD)
    before, after = (least_margin("convexity", subject, moves) for moves in (0, WALK))
    assert before is not None and after is not None and before.value > 0 > after.value
    known = {str(x): value for x, value in after.scout.parameters.items()}
    assert known["F266"] < known["F66"] and 0 <= known["F166"] <= Fraction(1, 10)


@pytest.mark.long
def test_a_law_that_is_convex_at_the_plain_choices_alone_is_refuted() -> None:
    found = verify(WOOD, claims=["convexity", "normality"])
    assert found["convexity"].verdict is found["normality"].verdict is Verdict.REFUTED


def test_a_margin_that_is_never_negative_stays_so() -> None:
    disk = Criterion("disk", "(a/x)**2 + (b/y)**2 - 1", {"x": POSITIVE, "y": POSITIVE}, ("a", "b"), None)
    for claim in ("convexity", "dissipation"):
        found = least_margin(claim, FormulaSubject(disk), WALK)
        assert found is not None and found.value > 0


def test_a_flow_that_dilates_more_than_k_allows_is_found_far_from_zero_force() -> None:
    cone = Criterion(
        "cone", "norm(a, b, c)*(1 + k*a*b*c/norm(a, b, c)**3) - m*p - f",
        {"k": Domain.between(0, "1/5"), "m": Domain.between("1/2", 1), "f": Domain.between(1, 50), "d": Domain.between("1/5", "104/100")},
        ("a", "b", "c", "p"), None, potential="norm(a, b, c) - d*p",
    )  # fmt: skip
    assert verify(cone, claims=["dissipation"])["dissipation"].verdict is Verdict.REFUTED


@pytest.mark.parametrize("power", ["5/6", "2/3", "9/10"])
def test_a_potential_that_rises_less_than_in_proportion_from_zero_is_refuted(power: str) -> None:
    creep = Criterion(
        "creep", f"g*(exp(-A/h*(1 - (abs(t)/s)**({power}))) - exp(-A/h))", {x: POSITIVE for x in "gAhs"}, ("t",), None, viscous=True
    )
    found = verify(creep, claims=["convexity", "normality"])
    assert found["convexity"].verdict is found["normality"].verdict is Verdict.REFUTED


def test_zero_force_leaves_k_at_ends_of_all_ranges_together() -> None:
    joint = Criterion(
        "joint", "abs(t) - abs(n)*tan(f + r*log(c/abs(n))/132)",
        {"f": Domain.between("35/100", "61/100"), "r": Domain.between(0, 20), "c": Domain.between(50, 200)}, ("t",), "n",
        domain={"n": Domain.between(-50, "-1/10")},
    )  # fmt: skip
    best = {str(x): float(value) for x, value in highest_at_zero(FormulaSubject(joint))[0].items()}
    angle = best["f"] + best["r"] * math.log(best["c"] / best["abs(n)"]) / 132
    assert math.pi / 2 < angle < math.pi  # where tan is < 0
    assert verify(joint, claims=["origin"])["origin"].verdict is Verdict.REFUTED


def test_a_law_that_has_no_value_at_zero_force_has_no_such_choice() -> None:
    no_value = Criterion(
        "angle", "norm(a, b)*(1 + k*cos(2*atan2(b, a))) + k*a/norm(a, b) - 1", {"k": Domain.between(0, 1)}, ("a", "b"), None
    )
    assert highest_at_zero(FormulaSubject(no_value)) == []
    assert verify(no_value, claims=["origin"])["origin"].verdict is Verdict.UNDECIDED


@pytest.mark.parametrize("g", ["b**2/a + a**2/b - m", "b**2/a - k*a + m*a**2", "exp(b) + 1/a - m"])
def test_poles_of_g_are_no_boundary_points(g: str) -> None:
    """By Euler's relation force . grad g is m > 0, and m a^2 > 0, wherever g = 0 of the first two; the third has a pole at a = 0 too."""
    law = Criterion("poles", g, {name: POSITIVE for name in "km" if name in g}, ("a", "b"), None)
    subject = FormulaSubject(law)
    if "exp" not in g:
        assert sum(failures("dissipation", scout) for scout in scouts(subject, 3)) == 0
    found = least_margin("dissipation", subject)
    if found is not None:
        values = {x: float(v) for x, v in found.scout.parameters.items()}
        at = dict(zip(subject.simple.forces, found.scout.boundary[found.place], strict=True))
        assert abs(float(subject.simple.g.subs(values).subs(at).evalf())) < 1e-3
