"""The kernel's identities on the boundary, each with the smallest proof that it confirms and neighbours of which it confirms nothing."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import pytest

from duhem.proof.kernel.boundary import is_steep, rises_outward, shown, with_convex_sums
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import parse
from tests.proof.small_laws import confirmed, domain, law

F = Fraction


def identity(strict: Sequence[str], sums: Sequence[Any] = (), multiples: Sequence[tuple[str, str]] = ()) -> dict[str, Any]:
    squares = [{"times": list(t), "of": list(z), "gram": [list(row) for row in gram]} for t, z, gram in sums]
    return {"strict": list(strict), "sums": squares, "multiples": [{"of": of, "by": by} for of, by in multiples]}


ONE = [["1"]]
DISC = "a**2 + b**2 - 1"
RISES = identity(["2"], [(["the goal"], ["1"], ONE)], [("the boundary", "2")])  # 2 - 2 (a^2 + b^2) + 2 g = 0
CURVES = identity(["the goal"], [([], ["v", "w"], [["2", "0"], ["0", "2"]])])


@pytest.mark.parametrize(
    ("outward", "right"),
    [
        ([RISES], True), ([identity([], []), RISES], True), ([], False),
        ([identity(["2"], [(["the goal"], ["1"], ONE), ([], ["a", "b"], [["0"] * 2] * 2)], [("the boundary", "2")])], True),
       
        ([identity(["1"], [(["the goal"], ["1"], ONE)], [("the boundary", "2")])], False),
        ([identity(["2"], [(["the goal"], ["1"], [["-1"]])], [("the boundary", "2")])], False),
        ([identity(["2"], [(["the goal"], ["1"], ONE)])], False),
        ([identity(["2"], [(["the goal"], ["1"], ONE)], [("the boundary", "-2")])], False), ([identity(["the goal"], [], [])], False),
        ([identity(["2"], [(["-a**2 - b**2"], ["1"], [["2"]])], [("the boundary", "2")])], False),  # that is no condition
        ([identity(["2"], [(["-2*a**2 - 2*b**2"], ["1"], ONE)], [(DISC, "2")])], True),  # conditions by their formulas
        ([identity(["2"], [(["the goal"], ["1"], ONE)], [("a**2 + b**2 - 2", "2")])], False),
        ([identity(["2", "m"], [(["the goal", "m"], ["1"], ONE)], [("the boundary", "2*m")])], True),
        ([identity(["2", "q"], [(["the goal", "q"], ["1"], ONE)], [("the boundary", "2*q")])], False),  # q may be < 0
        ([identity(["2", "e"], [(["the goal", "e"], ["1"], ONE)], [("the boundary", "2*e")])], False),  # e may be 0
        ([identity(["2"], [(["the goal"], ["1", "1"], ONE)], [("the boundary", "2")])], False),
        ([identity(["2"], [(["the goal"], ["1"], [["1", "0"]])], [("the boundary", "2")])], False),
        ([identity(["2"], [(["the goal"], ["1/2", "1/2"], [["1", "1"], ["1", "1"]])], [("the boundary", "2")])], True),
        ([identity(["2"], [(["the goal"], ["1", "1"], [["0", "1"], ["0", "0"]])], [("the boundary", "2")])], False),  # not symmetric
        ([identity(["2"], [(["the goal"], ["1", "1"], [["0", "1/2"], ["1/2", "0"]])], [("the boundary", "2")])], False),  # not semidefinite
        ([identity(["2"], [(["the goal"], ["1/(1 - 2*e)*(1 - 2*e)"], ONE)], [("the boundary", "2")])], False),  # undefined for e = 1/2
    ],
)  # fmt: skip
def test_identities_on_a_disc(outward: list[Any], right: bool) -> None:
    evidence = {"outward": outward, "inward": [CURVES], "directions": ["v", "w"]}
    for claim, rule in (("smoothness", "regular-value"), ("dissipation", "boundary-power"), ("convexity", "implicit-curvature")):
        assert confirmed(claim, rule, law(DISC), evidence) is right


def test_a_boundary_that_does_not_rise_outward_is_smooth_where_the_gradient_is_not_zero() -> None:
    steep = identity(["4"], [(["the goal"], ["1"], ONE)], [("the boundary", "4")])  # 4 - 4 ((a - 2)^2 + b^2) + 4 g = 0
    beside, crossing = law("(a - 2)**2 + b**2 - 1"), law("(a - 2)**2 - b**2")
    assert confirmed("smoothness", "regular-value", beside, {"steep": [steep]}) and is_steep(beside, [steep])
    for evidence in ({"steep": []}, {"steep": [RISES]}, {"outward": [steep]}, {"outward": [RISES]}):
        assert not confirmed("smoothness", "regular-value", beside, evidence)
    for other in (
        crossing,
        law("(a - 2)**2 + b**2"),
        law("(a - 2)**2 + b**2 - 2"),
        law("abs((a - 2)**2 + b**2 - 1)"),
        law("norm(a - 2, b) - 1"),
    ):
        assert not confirmed("smoothness", "regular-value", other, {"steep": [steep]})
    cut = law("max((a - 2)**2 + b**2 - 1, a - 5/2)")
    assert is_steep(cut, [steep, identity(["1"], [(["the goal"], ["1"], ONE)])])
    assert not is_steep(cut, [steep]) and not confirmed(
        "smoothness", "regular-value", cut, {"steep": [steep, identity(["1"], [(["the goal"], ["1"], ONE)])]}
    )


def test_a_boundary_must_curve_inward_around_a_point_inside() -> None:
    evidence = {"outward": [RISES], "inward": [CURVES], "directions": ["v", "w"]}
    for change in ({"inward": []}, {"inward": [RISES]}, {"directions": ["v"]}, {"directions": ["v", "v"]}, {"directions": ["a", "w"]}):
        assert not confirmed("convexity", "implicit-curvature", law(DISC), evidence | change)
    saddle = identity(["2"], [(["the goal"], ["1"], ONE)], [("the boundary", "2")])
    assert confirmed("dissipation", "boundary-power", law("a**2 - b**2 - 1"), {"outward": [saddle]})
    assert not confirmed("convexity", "implicit-curvature", law("a**2 - b**2 - 1"), evidence)
    assert rises_outward(law(DISC), [RISES])
    for undefined in ("0/e", "0/a", "0*sqrt(a)"):  # no rule reads such a law: 0 times it is multiplied out
        assert not confirmed("convexity", "implicit-curvature", law(f"{DISC} + {undefined}"), evidence)
        assert not confirmed("smoothness", "regular-value", law(f"{DISC} + {undefined}"), evidence)
    assert confirmed("convexity", "implicit-curvature", law("a**2 - 1", ["a"]), {"outward": [RISES]})
    assert not confirmed("convexity", "implicit-curvature", law("1 - a**2", ["a"]), {"outward": [RISES]})


def test_every_piece_must_rise() -> None:
    cut = identity(["1/2"], [(["the goal"], ["1"], ONE)], [("the boundary", "1")])  # on a = 1/2: 1/2 - a + (a - 1/2) = 0
    stated = law(f"max({DISC}, a - 1/2)")
    assert confirmed("dissipation", "boundary-power", stated, {"outward": [cut, RISES]})
    assert not confirmed("dissipation", "boundary-power", stated, {"outward": [RISES]})
    assert not confirmed("dissipation", "boundary-power", stated, {"outward": [cut]})
    assert not confirmed("smoothness", "regular-value", stated, {"outward": [cut, RISES]})
    beside = law(f"max({DISC}, a**2 - 2*b)")  # rises only where a^2 + b^2 >= 0 is used, on the side where it is the greatest
    assert not confirmed("dissipation", "boundary-power", beside, {"outward": [RISES]})


@pytest.mark.parametrize(
    ("flow", "along", "across", "right"),
    [
        (["m*a", "m*b"], [identity(["2*m"], [(["the goal"], ["1"], ONE)], [("the boundary", "2*m")])], [], True),
        (["m*a", "m*b"], [], [], False),
        (["-a", "-b"], [RISES], [], False), (["a", "2*b"], [RISES], [], False), (["a", "b"], [RISES], [], True),
        (["a*e/e", "b"], [RISES], [], False),
        (["a", f"b + {DISC}"], [identity(["2"], [(["the goal"], ["1"], ONE)], [("the boundary", "2 + 2*b")])],
         [identity(["the goal"], [], [("the boundary", "2*a")]), identity(["the goal"], [], [("the boundary", "-2*a")])], True),
        (["a", f"b + {DISC}"], [identity(["2"], [(["the goal"], ["1"], ONE)], [("the boundary", "2 + 2*b")])],
         [identity(["the goal"], [], [("the boundary", "2*a")])], False),
        (["a", f"b + {DISC}"], [identity(["2"], [(["the goal"], ["1"], ONE)], [("the boundary", "2 + 2*b")])],
         [identity(["the goal"], [], [("the boundary", "-2*a")])], False),
    ],
)  # fmt: skip
def test_flows_along_the_normal(flow: list[str], along: list[Any], across: list[Any], right: bool) -> None:
    assert confirmed("normality", "parallel", law(DISC, flow=flow), {"along": along, "across": across}, "convexity") is right


@pytest.mark.parametrize(
    ("flow", "right"),
    [
        (["a", "b"], True), (["a - b", "a + b"], True), (["-a", "b"], False), (["a**3", "b/m"], True), (["a", "b/e"], False),
        (["k*a", "k*b"], False),
        (["0", "0"], True), (["a + 1", "b"], False), (["abs(a)", "b"], False), (["where(a > 0, 1, -1)", "b"], True),
        (["where(a > 0, -1, 1)", "b"], False),
        (["where(a > 0, 1, -1/e)", "b"], False),
    ],
)  # fmt: skip
def test_the_power_of_a_flow(flow: list[str], right: bool) -> None:
    on_sides = identity(["the goal"], [(["side 0"], ["1"], ONE), ([], ["b"], ONE)])  # the goal is -(|a| + b^2) > 0
    assert confirmed("dissipation", "boundary-power", law(DISC, flow=flow), {"outward": [on_sides]}) is right


def test_faces_of_their_own() -> None:
    """Beyond the other surfaces nothing need hold: on a = 1 the flow (1, -b) turns back where |b| > 1."""
    surfaces = [{"g": "a - 1", "flow": ["1", "-b"]}, {"g": "abs(b) - 1", "flow": ["0", "b"]}]
    given = {"forces": ["a", "b"], "pressure": "s", "parameters": {}, "constraints": []}
    goal = identity(["the goal"], [(["1 - b", "b + 1"], ["1"], ONE)], [("the boundary", "1")])  # b^2 - a + (1 - b^2) + (a - 1) = 0
    for taken, right in ((surfaces, True), (surfaces[:1], False)):
        stated = StatedLaw.read(given | {"surfaces": taken})
        assert confirmed("dissipation", "boundary-power", stated, {"outward": [goal]}) is right
    assert not confirmed("dissipation", "boundary-power", StatedLaw.read(given | {"surfaces": surfaces}), {"outward": []})


def test_convex_sums_are_taken_as_such() -> None:
    stated = law("a**4 + a**3 + a**2 + b**4 - 1")
    bend = identity(["the goal"], [([], ["a*v", "v"], [["12", "3"], ["3", "2"]]), ([], ["b*w"], [["12"]])])
    assert not over(stated).facts(stated.g).convex
    assert with_convex_sums(stated, ["v", "w"], [bend]).facts(stated.g).convex
    assert not over(stated).facts(stated.g).convex and not with_convex_sums(stated, ["v", "w"], []).facts(stated.g).convex
    for wrong in (law("a**4 + 2*a**3 + a**2 + b**4 - 1"), law("a**4 + a**3 + a**2 + b**4 - 1 + 0/e")):
        known = with_convex_sums(wrong, ["v", "w"], [bend]).facts(wrong.g)
        assert not (known.convex and known.defined)
    square = law("a**4 - 2*a**2*b**2 + b**4")
    above = identity(["the goal"], [([], ["a**2", "b**2"], [["1", "-1"], ["-1", "1"]])])
    assert not over(square).facts(square.g).nonnegative and with_convex_sums(square, ["v", "w"], [above]).facts(square.g).nonnegative


def test_what_is_shown_by_an_identity() -> None:
    here = domain()
    goal, x = here.polynomial(parse("a + 1")), here.polynomial(parse("a"))
    speaks = identity(["1"], [(["the goal"], ["1"], ONE), (["x"], ["1"], ONE)])  # 1 - (a + 1) + a = 0
    assert shown(goal, ">", {"x": (x, ">=")}, [speaks], here) and shown(goal, ">", {"x": (x, ">")}, [speaks], here)
    assert not shown(goal, ">", {"x": (x, "==")}, [speaks], here)
    weakly = identity(["the goal"], [(["x"], ["1"], ONE)])
    assert shown(x, ">=", {"x": (x, ">=")}, [weakly], here) and not shown(x, ">", {"x": (x, ">=")}, [weakly], here)
    assert shown(x, ">", {"x": (x, ">")}, [identity(["x"], [(["the goal"], ["1"], ONE)])], here)
    assert not shown(x, ">", {"x": (x, ">=")}, [identity(["x"], [(["the goal"], ["1"], ONE)])], here)
