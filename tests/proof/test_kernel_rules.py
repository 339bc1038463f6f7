"""The kernel's rules one by one, each with the smallest proof that it confirms and neighbours of which it confirms nothing."""

from __future__ import annotations

from fractions import Fraction

import pytest

from duhem.proof.kernel.claims import RULES, objection, rules_of
from duhem.proof.kernel.curve import StatedCurve
from duhem.proof.kernel.plane_gauge import StarGauge
from duhem.proof.kernel.polynomial import slope
from duhem.proof.kernel.term import NotWritten, Term, minus, number, product_of, sum_of
from tests.proof.small_laws import confirmed, domain, law

F = Fraction


@pytest.mark.parametrize(
    ("rule", "g", "right"),
    [
        ("origin evaluation", "norm(a, b) - m", True), ("origin evaluation", "norm(a, b)", True),
        ("origin evaluation", "norm(a, b) - e", True),
        ("origin evaluation", "norm(a, b) - q", False), ("origin evaluation", "norm(a, b) + m", False),
        ("origin evaluation", "norm(a, b) + e", False),
        ("origin evaluation", "norm(a, b)/norm(a, b) - 2", True), ("origin evaluation", "a/e - m", False),
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
        ("dissipation homogeneity", "a**2 - b**2 - e", True), ("dissipation homogeneity", "a**2 - b**2 - m + 0/e", False),
        ("origin polar-form", "norm(a, b) + a**2/norm(a, b) - 1", True), ("origin polar-form", "norm(a, b) - 1", False),
        ("state_laws by-construction", "a", True), ("state_laws by-construction", "norm(a, b)/e - q", True),
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


@pytest.mark.parametrize(
    ("g", "flow", "right"),
    [
        ("norm(a, b) - m", "a/norm(a, b); b/norm(a, b)", True),
        ("norm(a, b) - m", "a*norm(a, b)/norm(a, b)**2; b/norm(a, b)", True),
        ("(a**2 + b**2 - m)*m", "2*m*a; 2*m*b", True),
        ("norm(a, b) - m", "a/norm(a, b); -b/norm(a, b)", False),
        ("norm(a, b) - m", "a/norm(a, b); b/norm(a, b) + 1/10**9", False),
        ("norm(a, b) - m", "a/norm(a, b) + 0*sqrt(b - 1); b/norm(a, b)", False),  # no value on a part of the boundary
        ("abs(a) + abs(b) - m", "sign(a); sign(b)", False),  # at a corner that is one gradient, or none
        ("norm(a, b)", "a/norm(a, b); b/norm(a, b)", False),  # K is the tip
        ("(norm(a, b) - m)**3", "3*(norm(a, b) - m)**2*a/norm(a, b); 3*(norm(a, b) - m)**2*b/norm(a, b)", False),  # 0 where g is
        ("a**2 + b**2 - q", "2*a; 2*b", False),  # K may be empty
    ],
)
def test_a_flow_that_is_the_gradient(g: str, flow: str, right: bool) -> None:
    assert confirmed("normality", "gradient", law(g, flow=flow.split("; ")), None, "convexity") is right
    assert not confirmed("normality", "gradient", law(g, flow=flow.split("; ")))
    assert not confirmed("normality", "gradient", law(g), None, "convexity")  # an associated law has no such flow


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
        assert confirmed("state_laws", "by-construction", law("a", list(d)))


@pytest.mark.parametrize("d", [1, 2, 3, 6])
def test_what_the_rule_of_the_state_laws_says_of_every_law(d: int) -> None:
    """psi = (u - w) . k (u - w)/2, k = L L^T: dpsi/du = k (u - w) = -dpsi/dw, and psi is the sum of (L^T (u - w))_j^2/2."""
    u, w = ([Term("name", name=f"{x} {i}") for i in range(d)] for x in "uw")
    here = domain()
    factor = [[Term("name", name=f"l {i} {j}") if i >= j else number(0) for j in range(d)] for i in range(d)]
    lift = list(map(sum_of, u, map(minus, w)))
    stress = [sum_of(*(product_of(factor[i][k], factor[j][k], lift[j]) for j in range(d) for k in range(d))) for i in range(d)]
    rows = [sum_of(*(product_of(factor[i][j], lift[i]) for i in range(d))) for j in range(d)]
    energy = here.polynomial(product_of(number(F(1, 2)), sum_of(*map(product_of, lift, stress))))
    for x, force in [*zip(u, stress, strict=True), *zip(w, map(minus, stress), strict=True)]:
        assert slope(energy, x) == here.polynomial(force)
    assert energy == here.polynomial(product_of(number(F(1, 2)), sum_of(*(product_of(r, r) for r in rows))))


def test_flows_of_their_own_are_not_associated() -> None:
    for rule in ("normality normality-rule", "dissipation homogeneity"):
        assert confirmed(*rule.split(), law("norm(a, b) - m"), None, "convexity")
        assert not confirmed(*rule.split(), law("norm(a, b) - m", flow=["a", "b"]), None, "convexity")
    gauge = "norm(a, b) + a**2/norm(a, b) - 1"
    assert confirmed("dissipation", "homogeneity", law(gauge), None, "origin")
    assert not confirmed("dissipation", "homogeneity", law(gauge, flow=["a", "b"]), None, "origin")
    assert confirmed("dissipation", "potential", law("norm(a, b) - 1", flow={"potential": "norm(a, b)"}), {"share": "1"})
    assert not confirmed("dissipation", "potential", law("norm(a, b) - 1", flow={"potential": "-norm(a, b)"}), {"share": "1"})
    assert not confirmed("dissipation", "potential", law("norm(a, b) - 1", flow=["a", "b"]), {"share": "1"})


def test_why_a_rule_does_not_prove() -> None:
    stated = law("norm(a, b) - m")
    assert objection("origin", "magic", frozenset(), stated, {}) == "no rule 'magic' for this claim"
    assert objection("dissipation", "fenchel", frozenset({"origin"}), stated, {}) == "it rests on normality, not confirmed"
    assert objection("origin", "polar-form", frozenset(), stated, {}) == "the rule 'polar-form' does not show it"
    assert objection("smoothness", "regular-value", frozenset(), stated, {}) == "its evidence cannot be read: 'outward' is not there"
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
        ("norm(a, b)*(1 + a/norm(a, b)/2) - 1", (True, True)), ("norm(a, b)*(2 + a/norm(a, b))**(m - m) - 1", (True, True)),
        ("norm(a, b)*(1 + a**2/norm(a, b)**2)**(1/2) - m", (True, True)),
        ("norm(a, b)*(1 + a**2/norm(a, b)**2)**-1 - m", (False, True)), ("norm(a, 0) + norm(b) - m", (True, False)),
        ("norm(a - b, a + b, -a) - e", None),
    ],
)  # fmt: skip
def test_gauges(g: str, expected: tuple[bool, bool] | None) -> None:
    assert judged(g) == expected
