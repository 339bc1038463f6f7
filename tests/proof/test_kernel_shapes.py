"""The kernel's rules one by one, each with the smallest proof that it confirms and neighbours of which it confirms nothing."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import pytest

from duhem.proof.kernel.boundary import rises_outward, with_convex_sums
from duhem.proof.kernel.claims import RULES, objection, rules_of
from duhem.proof.kernel.curvature import facts, over
from duhem.proof.kernel.curve import StatedCurve
from duhem.proof.kernel.domain import StatedDomain, StatedLaw
from duhem.proof.kernel.pieces import CHOICES, below, chooses, pieces
from duhem.proof.kernel.piecewise import greatest_of, least_of_greatest, measured, polyhedra
from duhem.proof.kernel.polyhedron import Face, corners, is_bounded, union_is_convex, within
from duhem.proof.kernel.refutation import shown
from duhem.proof.kernel.regularity import smooth_near_the_boundary
from duhem.proof.kernel.star import StarGauge
from duhem.proof.kernel.term import NotWritten, parse

F = Fraction
PARAMETERS = {
    "m": {"positive": True}, "e": {"min": "0", "max": "1/2"}, "q": {"min": "-1", "max": "1"}, "p": {"min": "1", "max": "4"},
    "k": {"min": "-2", "max": "-1/2"},
}  # fmt: skip


def law(g: str, forces: Sequence[str] = ("a", "b"), flow: Any = None, **more: Any) -> StatedLaw:
    given = {"forces": forces, "pressure": "s", "parameters": PARAMETERS, "constraints": [], "g": g, "flow": flow}
    return StatedLaw.read(given | more)


def domain(g: str = "a") -> StatedDomain:
    return over(law(g))


def confirmed(claim: str, rule: str, stated: StatedLaw, evidence: Any = None, settled: str = "") -> bool:
    return not objection(claim, rule, frozenset(settled.split()), stated, evidence or {})


# -- rules that need no evidence -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rule", "g", "right"),
    [
        ("origin evaluation", "norm(a, b) - m", True), ("origin evaluation", "norm(a, b)", True),
        ("origin evaluation", "norm(a, b) - e", True),
        ("origin evaluation", "norm(a, b) - q", False), ("origin evaluation", "norm(a, b) + m", False),
        ("origin evaluation", "norm(a, b) + e", False),
        ("origin evaluation", "norm(a, b)/norm(a, b) - 2", False), ("origin evaluation", "a/e - m", False),
        ("origin evaluation", "a + s", True),
        ("convexity composition", "norm(a, b) - m", True), ("convexity composition", "norm(a, b)/e - 1", False),
        ("convexity composition", "a*b - 1", False), ("convexity composition", "tanh(norm(a, b)) - 1", True),
        ("convexity composition", "(norm(a, b) - m)**3", True), ("convexity composition", "max(a*b, a*b*2)", False),
        ("smoothness composition", "norm(a, b) - m", True), ("smoothness composition", "norm(a, b) - e", False),
        ("smoothness composition", "abs(a) + abs(b) - m", False), ("smoothness composition", "a**2 + b**2 - m", True),
        ("smoothness composition", "a**2 + b**2 + m", False), ("smoothness composition", "a**3 + b - m", False),
        ("smoothness composition", "a**2 + b**2 - 1 + 0/e", False), ("smoothness euler", "a**3 + a*b**2 - m", True),
        ("smoothness euler", "abs(a) + abs(b) - m", False), ("smoothness euler", "a**2 + b**2 - m + 0/e", False),
        ("smoothness euler", "a**2 + b - m", True), ("dissipation homogeneity", "a**2 - b**2 - m", True),
        ("dissipation homogeneity", "a**2 - b**2 - e", False), ("dissipation homogeneity", "a**2 - b**2 - m + 0/e", False),
        ("convexity polyhedral", "min(max(abs(a), abs(b)), max(abs(a), abs(b)) - 1) - m", False),
        ("convexity polyhedral", "max(abs(a), abs(b)) - m", True), ("convexity polyhedral", "max(abs(a), abs(b)) - m + 0/e", False),
        ("convexity polyhedral", "min(max(abs(a), abs(b)) - 1, max(abs(a) - 1, abs(b) - 2))", True),
        ("origin polar-form", "norm(a, b) + a**2/norm(a, b) - 1", True), ("origin polar-form", "norm(a, b) - 1", False),
        ("state_laws symbolic", "a", True), ("state_laws symbolic", "norm(a, b)/e - q", True),
    ],
)  # fmt: skip
def test_a_rule_without_evidence(rule: str, g: str, right: bool) -> None:
    assert confirmed(*rule.split(), law(g)) is right


@pytest.mark.parametrize(
    ("rule", "g", "right"),
    [
        ("convexity polar-curvature", "norm(a, b) + a**2/norm(a, b) - 1", True),
        ("convexity polar-curvature", "norm(a, b) + 3*a**2/norm(a, b) - 1", False),
        ("smoothness polar-seams", "norm(a, b) + a**2/norm(a, b) - 1", True), ("smoothness polar-seams", "norm(a, b) + abs(a) - 1", False),
        ("dissipation euler", "norm(a, b) + 3*a**2/norm(a, b) - 1", True), ("dissipation euler", "norm(a, b) - e", False),
        ("smoothness polar-seams", "norm(a, pos(b)) + a**2/norm(a, b) + neg(b) - 1", False), ("dissipation fenchel", "a*b", True),
        ("normality normality-rule", "a*b", True), ("normality parallel", "a*b", True),
    ],
)  # fmt: skip
def test_a_rule_that_rests_on_others(rule: str, g: str, right: bool) -> None:
    claim, name = rule.split()
    needed = RULES[claim, name][0]
    assert needed and confirmed(claim, name, law(g), None, " ".join(needed)) is right
    for missing in needed:
        assert not confirmed(claim, name, law(g), None, " ".join(needed - {missing}))


def test_laws_on_a_line() -> None:
    signs = (
        ("abs(a) - m", True),
        ("abs(a) - e", False),
        ("a**2 - m + 0/e", False),
        ("max(a, -2*a) - 1", True),
        ("abs(a - 3*m) - m", False),
    )
    for g, right in signs:
        assert confirmed("smoothness", "one-dimensional", law(g, ["a"]), None, "convexity") is right
        assert not confirmed("smoothness", "one-dimensional", law(g, ["a"]))
        assert not confirmed("smoothness", "one-dimensional", law(g), None, "convexity")
    assert confirmed("smoothness", "one-dimensional", law("abs(a - 3*m) - m", ["a"]), {"inside": {"a": "3*m"}}, "convexity")
    for d in ("a", "abc"):
        assert confirmed("state_laws", "symbolic", law("a", list(d)))


def test_flows_of_their_own_are_not_associated() -> None:
    for rule in ("normality normality-rule", "dissipation homogeneity"):
        assert confirmed(*rule.split(), law("norm(a, b) - m"), None, "convexity")
        assert not confirmed(*rule.split(), law("norm(a, b) - m", flow=["a", "b"]), None, "convexity")
    gauge = "norm(a, b) + a**2/norm(a, b) - 1"
    assert confirmed("dissipation", "euler", law(gauge), None, "origin")
    assert not confirmed("dissipation", "euler", law(gauge, flow=["a", "b"]), None, "origin")
    assert confirmed("dissipation", "potential", law("norm(a, b) - 1", flow={"potential": "norm(a, b)"}), {"share": "1"})
    assert not confirmed("dissipation", "potential", law("norm(a, b) - 1", flow={"potential": "-norm(a, b)"}), {"share": "1"})
    assert not confirmed("dissipation", "potential", law("norm(a, b) - 1", flow=["a", "b"]), {"share": "1"})


def test_why_a_rule_does_not_prove() -> None:
    stated = law("norm(a, b) - m")
    assert objection("origin", "magic", frozenset(), stated, {}) == "no rule 'magic' for this claim"
    assert objection("dissipation", "fenchel", frozenset({"origin"}), stated, {}) == "it rests on normality, not confirmed"
    assert objection("origin", "polar-form", frozenset(), stated, {}) == "the rule 'polar-form' does not show it"
    assert objection("smoothness", "regular-value", frozenset(), stated, {}) == "its evidence cannot be read (KeyError)"
    assert rules_of("origin", stated) == ("evaluation", "polar-form") and rules_of("beauty", stated) == ()
    given = {"forces": ["a", "b"], "pressure": "s", "angle": "phi", "boundary": ["cos(phi)", "sin(phi)"], "flow": None, "constraints": []}
    curve = StatedCurve.read(given | {"parameters": {}})
    assert rules_of("origin", curve) == ("winding",) and objection("origin", "evaluation", frozenset(), curve, {}) != ""
    duality = {"potential": "norm(x, y)*m", "slips": {"a": "x", "b": "y"}}
    assert confirmed("duality", "polar-gauge", stated, duality) and not confirmed(
        "duality", "polar-gauge", stated, {"slips": {"a": "x", "b": "y"}}
    )
    assert not confirmed("duality", "polar-gauge", law("norm(a, b) - m", domain={"a": {"min": "0"}}), duality)
    assert confirmed("duality", "polar-gauge", law("norm(a, b) - m", domain={"s": {"min": "-1"}}), duality)


def judged(g: str) -> tuple[bool, bool] | None:
    try:
        gauge = StarGauge(law(g))
        return gauge.convex(), gauge.smooth()
    except NotWritten:
        return None


@pytest.mark.parametrize("side", ["a > 0", "a >= 0", "b > 0", "b >= 0", "4*a > 3*b", "4*a <= 3*b"])
def test_a_gauge_that_jumps_on_one_ray_is_none(side: str) -> None:
    for kink in ("pos(a)", "neg(a)") if "b" in side else ("pos(b)", "neg(b)"):
        assert judged(f"where({side}, norm(a, b), norm(a, b) + {kink}) - 1") is None
    left, right = side.split(" ")[0], side.split(" ")[2]
    even = f"({left} - {right})**2/norm(a, b)/{75 if '*' in side else 3}"
    assert judged(f"where({side}, norm(a, b), norm(a, b) + {even}) - 1") == (True, True)


@pytest.mark.parametrize(
    ("g", "expected"),
    [
        ("abs(a) + abs(b) - 1", (True, False)), ("norm(a, b) - abs(a)/2 - 1", (False, False)),
        ("pos(a) + 2*neg(a) + abs(b) - 1", (True, False)),
        ("max(abs(a), abs(b), norm(a, b)/1.2) - 1", (True, False)), ("min(norm(a, b), 2*abs(a) + 2*abs(b)) - 1", (True, True)),
        ("norm(pos(a), neg(a)/2, b) - m", (True, True)), ("sqrt(a**2 + abs(a*b)/2 + b**2) - m", (True, False)),
        ("(abs(a)**3 + abs(b)**3)**(1/3) - 1", (True, True)),
        ("a**2 + b**2 - m*norm(a, b)*(2 + a/norm(a, b))/3", (True, True)), ("a**2 + b**2 - m*norm(a, b) - m*a", None),
        ("norm(a, b) - a*b/norm(a, b) - m", (False, True)),
        ("norm(a, b)*(1 + a/norm(a, b)/2) - 1", (True, True)), ("norm(a, b)*(1 + a**2/norm(a, b)**2)**(1/2) - m", (True, True)),
        ("norm(a, b)*(1 + a**2/norm(a, b)**2)**-1 - m", (False, True)), ("norm(a, 0) + norm(b) - m", (True, False)),
        ("norm(a - b, a + b, -a) - e", None),
    ],
)  # fmt: skip
def test_gauges(g: str, expected: tuple[bool, bool] | None) -> None:
    assert judged(g) == expected


# -- identities ----------------------------------------------------------------------------------------------------------


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


def test_a_boundary_must_curve_inward_around_a_point_inside() -> None:
    evidence = {"outward": [RISES], "inward": [CURVES], "directions": ["v", "w"]}
    for change in ({"inward": []}, {"inward": [RISES]}, {"directions": ["v"]}, {"directions": ["v", "v"]}, {"directions": ["a", "w"]}):
        assert not confirmed("convexity", "implicit-curvature", law(DISC), evidence | change)
    saddle = identity(["2"], [(["the goal"], ["1"], ONE)], [("the boundary", "2")])
    assert confirmed("dissipation", "boundary-power", law("a**2 - b**2 - 1"), {"outward": [saddle]})
    assert not confirmed("convexity", "implicit-curvature", law("a**2 - b**2 - 1"), evidence)
    assert not rises_outward(law("a**2 + b**2 - 1 + 0/e"), [RISES])
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
    stated = law("a**4 + 6*a**2*b**2 + b**4 - 1")
    bend = identity(["the goal"], [([], ["a*v", "b*w"], [["12", "12"], ["12", "12"]]), ([], ["a*w", "b*v"], [["12", "12"], ["12", "12"]])])
    assert not facts(stated.g, over(stated)).convex
    assert facts(stated.g, with_convex_sums(stated, ["v", "w"], [bend])).convex
    for wrong in (law("a**4 + 7*a**2*b**2 + b**4 - 1"), law("a**4 + 6*a**2*b**2 + b**4 - 1 + 0/e")):
        known = facts(wrong.g, with_convex_sums(wrong, ["v", "w"], [bend]))
        assert not (known.convex and known.defined)
    square = law("a**2 - 2*a*b + b**2")
    above = identity(["the goal"], [([], ["a", "b"], [["1", "-1"], ["-1", "1"]])])
    assert not facts(square.g, over(square)).nonnegative and facts(square.g, with_convex_sums(square, ["v", "w"], [above])).nonnegative


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


# -- kinks ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "smooth"),
    [
        ("a**2 + b**2 - m", True), ("norm(a, b) - m", True), ("norm(a, b) - e", False), ("norm(a, b) + a - m", False),
        ("norm(a, b) + a", False), ("abs(a) - m", False),
        ("a*abs(a) + b - m", True), ("b*abs(a) - m", False), ("abs(a)**2 + b", True), ("abs(a)**(3/2) - m", True),
        ("abs(a)**p + b", False), ("abs(a)**(p + 1) + b", True),
        ("pos(a)**2 + neg(b)**3 - m", True), ("pos(a)*neg(b) - m", False), ("pos(a)*pos(a) - m", True), ("pos(a)*abs(a) + b", True),
        ("pos(a)*pos(a - b) - m", False),
        ("norm(pos(a), b) - m", True), ("norm(pos(a), b) + pos(a) - m", False), ("norm(abs(a), abs(b)) - m", True),
        ("norm(abs(a - b), a) - m", True), ("norm(abs(a) + 1, b) - m", False),
        ("sqrt(a**2 + 1) - m", True), ("sqrt(a**2 + b**2) - m", True), ("sqrt(a**2 + b**2) - q", False), ("exp(abs(a)) - m", False),
        ("exp(a*abs(a)) - m", True),
        ("sin(a) + cosh(b) - m", True), ("tanh(pos(a))**2 - m", True), ("tanh(pos(a)) - m", False), ("cos(abs(a))**2 - m", False),
        ("atan(abs(a))*a - m", True),
        ("max(a, b) - m", False), ("where(a > 0, a, b) - m", False), ("where(m > 0, a, b) - m", False), ("log(1 + a**2) - m", False),
        ("abs(m)*a - 1", True), ("abs(k) - a", True),
        ("abs(a - b)*(b - a) + b", True), ("abs(a - b)*(a + b) + b", False), ("abs(2*a)*a + b", True), ("(a**2 + b**2)**(3/2) - m", True),
        ("(a**2 + b**2)**(-1/2) - m", False),
        ("(abs(a) + abs(b))**2 - m", False), ("abs(a*b)*(a*b + 0) + b", True), ("sinh(abs(a))*tanh(a) - m", True),
        ("a**1 + b - m", True), ("abs(a)**0*b - m", False),
        ("abs(a)**1 - m", False),
    ],
)  # fmt: skip
def test_where_kinks_cancel(text: str, smooth: bool) -> None:
    assert smooth_near_the_boundary(parse(text), domain(text)) is smooth


def found(text: str, words: Sequence[str] | None = None) -> set[tuple[str, ...]]:
    """The pieces and their sides, multiplied out."""
    here = domain()
    made = pieces(parse(text), here) if words is None else pieces(parse(text), here, words)
    return {tuple(str(sorted(here.polynomial(x).items())) for x in (value, *sides)) for value, sides in made}


def expected(*made: Sequence[str]) -> set[tuple[str, ...]]:
    here = domain()
    return {tuple(str(sorted(here.polynomial(parse(x)).items())) for x in piece) for piece in made}


def test_pieces() -> None:
    assert found("a + b") == expected(["a + b"]) and found("abs(m)*a") == expected(["m*a"])
    assert found("abs(a) + b") == expected(["a + b", "a"], ["b - a", "-a"]) and found("pos(a)") == expected(["a", "a"], ["0", "-a"])
    assert found("neg(a)") == expected(["-a", "-a"], ["0", "a"]) and found("max(a, b)") == expected(["a", "a - b"], ["b", "b - a"])
    assert found("min(a, b)") == expected(["a", "b - a"], ["b", "a - b"]) and found("max(a, b, 1)") >= expected(["1", "1 - a", "1 - b"])
    assert found("abs(abs(a) - 1)") == expected(
        ["a - 1", "a", "a - 1"], ["1 - a", "a", "1 - a"], ["-a - 1", "-a", "-a - 1"], ["a + 1", "-a", "a + 1"]
    )
    chosen = "where(a > b, a**2, b)"
    assert (
        found(chosen, CHOICES) == expected(["a**2", "a - b"], ["b", "b - a"])
        and chooses(parse(chosen), domain())
        and not chooses(parse("abs(a)"), domain())
    )
    assert chooses(parse("where(m > 0, a, b)"), domain()) and not chooses(parse("where(m > 0, 1, 2)*a"), domain())
    with pytest.raises(NotWritten):
        found(" + ".join(f"abs(a - {i})" for i in range(7)))
    assert len(found(" + ".join(f"{2**i}*abs(a - {i})" for i in range(6)))) == 64
    here = domain()
    smaller = [
        ("abs(a) + b", {"a + b", "b - a"}), ("pos(a) + neg(b)", {"a - b", "a", "-b", "0"}), ("max(a, b) - 1", {"a - 1", "b - 1"}),
        ("min(a, b)", {"min(a, b)"}),
    ]  # fmt: skip
    for text, least in smaller:
        made = {str(sorted(here.polynomial(t).items())) for t in below(parse(text))}
        assert made == {str(sorted(here.polynomial(parse(t)).items())) for t in least}


# -- polyhedra -----------------------------------------------------------------------------------------------------------


def face(*numbers: int | F) -> Face:
    *row, limit = (F(x) for x in numbers)
    return tuple(row), limit


SQUARE = [face(1, 0, 1), face(-1, 0, 1), face(0, 1, 1), face(0, -1, 1)]


def test_corners_and_bounds() -> None:
    assert sorted(corners(SQUARE, 2)) == [(-1, -1), (-1, 1), (1, -1), (1, 1)] and is_bounded(SQUARE, 2) and not is_bounded(SQUARE[:3], 2)
    assert sorted(corners([*SQUARE, face(1, 1, 1)], 2)) == [(-1, -1), (-1, 1), (0, 1), (1, -1), (1, 0)] and corners(SQUARE[:2], 2) == []
    assert not is_bounded(SQUARE[:2], 2) and is_bounded([face(1, 0, -1), face(-1, 0, -1), face(0, 1, 1), face(0, -1, 1)], 2)
    assert is_bounded([face(1, 0, 0), face(-1, -1, 0), face(0, 1, 1)], 2) and not is_bounded(
        [face(1, 0, 0), face(-1, -1, 0), face(0, -1, 1)], 2
    )
    tetrahedron = [face(-1, 0, 0, 0), face(0, -1, 0, 0), face(0, 0, -1, 0), face(1, 1, 1, 1)]
    assert (
        len(corners(tetrahedron, 3)) == 4
        and is_bounded(tetrahedron, 3)
        and not is_bounded(tetrahedron[:3], 3)
        and within((F(0),) * 3, tetrahedron)
    )
    assert sorted(corners([face(2, 1), face(-3, 1)], 1)) == [(F(-1, 3),), (F(1, 2),)] and is_bounded([face(2, 1), face(-3, 1)], 1)
    assert not is_bounded([face(2, 1)], 1) and not within((F(2), F(0)), SQUARE) and within((F(1), F(-1)), SQUARE)


def test_unions_of_squares() -> None:
    def moved(x: F | int, y: F | int = 0) -> list[Face]:
        return [(row, limit + row[0] * F(x) + row[1] * F(y)) for row, limit in SQUARE]

    cases: list[tuple[list[list[Face]], bool]] = [
        ([], True), ([moved(1)], True), ([moved(2)], True), ([moved(F(2001, 1000))], False), ([moved(1, F(1, 1000))], False),
        ([moved(1, 1)], False), ([moved(2), moved(4)], True), ([moved(2), moved(0, 2)], False), ([SQUARE], True),
        ([moved(2), moved(0, 2), moved(2, 2)], True),
    ]  # fmt: skip
    for others, convex in cases:
        assert union_is_convex([SQUARE, *others], 2) is convex
    assert not union_is_convex([SQUARE[:3]], 2) and union_is_convex([[face(1, 0, -2), face(-1, 0, 1), *SQUARE[2:]], SQUARE], 2)


def test_piecewise_affine_formulas() -> None:
    here = domain()
    cases = [
        ("abs(a) + b", ["a + b", "b - a"]), ("pos(a)", ["a", "0"]), ("neg(a)", ["0", "-a"]), ("m*abs(a)", ["m*a", "-m*a"]),
        ("max(a, abs(b))", ["a", "b", "-b"]), ("q", ["q"]),
    ]  # fmt: skip
    for text, arms in cases:
        assert [here.polynomial(arm) for arm in greatest_of(parse(text), here)] == [here.polynomial(parse(arm)) for arm in arms]
    assert [len(cell) for cell in least_of_greatest(parse("min(a, abs(b)) + abs(a)"), here)] == [2, 4]
    assert [len(cell) for cell in least_of_greatest(parse("max(min(a, b), min(a, 1), b)"), here)] == [3, 3, 3, 3] and len(
        least_of_greatest(parse("k*abs(a)"), here)[0]
    ) == 1
    with pytest.raises(ValueError, match="unpack"):
        greatest_of(parse("min(a, b)"), here)
    with pytest.raises(NotWritten):
        least_of_greatest(parse(" + ".join(["abs(a)"] * 7)), here)
    assert measured([parse("3*m"), parse("0"), parse("-m/2")], parse("2*m"), here) == (F(3, 2), 0, F(-1, 4))
    with pytest.raises(NotWritten):
        measured([parse("q")], parse("m"), here)
    cells, far, steep = polyhedra(parse("max(2*m*abs(a), m*b) - 3*p"), ("a", "b"), here)
    assert here.polynomial(far) == here.polynomial(parse("3*p")) and here.polynomial(steep) == here.polynomial(parse("2*m"))
    assert sorted(cells[0]) == sorted([((F(1), F(0)), F(1)), ((F(-1), F(0)), F(1)), ((F(0), F(1, 2)), F(1))])
    for text in ("max(abs(a), abs(b)) - q", "max(abs(a), abs(b))", "max(abs(a), q*abs(b)) - 1"):
        with pytest.raises(NotWritten):
            polyhedra(parse(text), ("a", "b"), here)
