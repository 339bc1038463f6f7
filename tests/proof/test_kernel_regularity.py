"""Boundaries that the kernel confirms to be C^1 are so, and kinks that do not cancel are not confirmed."""

from __future__ import annotations

import math
from random import Random
from typing import Any

import pytest

from duhem.proof.kernel import regularity
from duhem.proof.kernel.claims import objection, rules_of
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import NEGATIVE
from duhem.proof.kernel.stated_law import StatedLaw
from tests.oracles import drawn_formulas

POSITIVE = {"positive": True}
UNIT = {"min": "0", "max": "1"}


def law(g: str, *, forces: tuple[str, ...] = ("a", "b"), constraints: tuple[str, ...] = (), **parameters: Any) -> StatedLaw:
    given = {"forces": forces, "pressure": "s", "parameters": parameters, "constraints": constraints, "g": g, "flow": None}
    return StatedLaw.read(given)


def confirmed(stated: StatedLaw, rule: str, evidence: dict[str, Any] | None = None) -> bool:
    return not objection("smoothness", rule, frozenset(), stated, evidence or {})


# -- a point inside, for a K that does not hold the origin inside -------------------------------------------------------

SHIFTED = "norm(a + s, b/m) + s"


@pytest.mark.parametrize(
    ("point", "right"),
    [
        ({"a": "-s"}, True),
        ({"a": "-s", "b": "0"}, True),
        ({"a": "-s/10**9"}, True),
        ({}, False),  # on the boundary
        ({"a": "-2*s"}, False),
        ({"a": "-s", "b": "m*s"}, False),
        ({"a": "-s", "b": "m/10**9"}, False),  # not for every pressure
        ({"a": "-s", "b": "0/(m - m)"}, False),
        ({"a": "-s", "b": "b"}, False),
        ({"a": "-s", "b": "unknown"}, False),
        ({"a": "sqrt(s)"}, False),
        ({"a": 1}, False),
        ("a", False),
    ],
)
def test_convex_and_negative_at_a_point(point: Any, right: bool) -> None:
    assert confirmed(law(SHIFTED, m=POSITIVE), "composition", {"inside": point}) is right


@pytest.mark.parametrize(
    ("text", "right"),
    [
        ("pos(norm(a, b) - m)**2", True),
        ("neg(m - norm(a, b))**(3/2)", True),
        ("pos(norm(a, b) + m)**2", False),  # a tip
        ("pos(norm(a, b) - m)", False),  # a kink
        ("neg(norm(a, b) - m)**2", False),
        ("pos(norm(a, b) - m)**2*norm(a, b)", False),  # C^1, and not seen to be so: another part has the tip
    ],
)
def test_a_tip_where_a_positive_part_is_0(text: str, right: bool) -> None:
    stated = law(text, m=POSITIVE)
    assert regularity.smooth_everywhere(stated.g, over(stated)) is right


SECOND, THIRD = "(((a - b)**2 + (b - c)**2 + (c - a)**2)/6)", "((2*a - b - c)*(2*b - c - a)*(2*c - a - b)/27)"
COSINE = f"(3*sqrt(3)/2*{THIRD}/{SECOND}**(3/2))"


@pytest.mark.parametrize(
    ("text", "right"),
    [
        (f"{SECOND}*(2 + m*{COSINE})", True), (f"{SECOND}/(2 + m*{COSINE})**2 + a*b", True), (f"{SECOND}**(3/4)*{COSINE}**2", True),
        (f"{THIRD}*{COSINE} + {SECOND}", True), (f"sqrt({SECOND})*(2 + m*{COSINE})", False),  # of degree 1
        (f"a*{SECOND}*{COSINE}", False),  # C^1, and not seen to be so: it is no function of the deviator alone
        (f"{SECOND}*acos({COSINE})", False),  # singular on the walls of the sector
        (f"{SECOND}*abs({COSINE})", False), (f"{SECOND}*{COSINE}*sqrt(a**2 + b**2 + c**2)", False),
        (f"{COSINE}*{SECOND}/sqrt({SECOND})", False),
    ],
)  # fmt: skip
def test_a_tip_where_a_function_of_the_deviator_is_flat(text: str, right: bool) -> None:
    stated = law(text, forces=("a", "b", "c"), m=UNIT)
    assert regularity.smooth_everywhere(stated.g, over(stated)) is right


@pytest.mark.parametrize("text", [f"{SECOND}*(2 + m*{COSINE})", f"{SECOND}**(3/4)*{COSINE}**2", f"{THIRD}*{COSINE} + {SECOND}"])
def test_its_slopes_fall_to_0_at_the_axis(text: str) -> None:
    stated, rng = law(text, forces=("a", "b", "c"), m=UNIT), Random(5)
    for _ in range(20):
        way = [rng.gauss(0, 1) for _ in range(3)]
        slopes = []
        for near in (1e-2, 1e-4):
            one, two = ({x: 1 + k * near * w for x, w in zip("abc", way, strict=True)} | {"m": 0.7} for k in (1, 1.001))
            slopes.append(abs(drawn_formulas.value(stated.g, two) - drawn_formulas.value(stated.g, one)) / (1e-3 * near))
        assert slopes[1] < slopes[0] / 5


CAPS = [  # K ends at two points of the axis, one of which is zero force
    f"{SECOND}*(2 + m*{COSINE}) + (a + b + c)**2 - (a + b + c)", f"3*{SECOND}/(2 + m*{COSINE})**2 + (a + b + c)*(a + b + c - k)",
    f"{SECOND}*(1 + k + m*{COSINE})**(1/4) + (a + b + c)**2/9 - k*(a + b + c)/3", f"{SECOND}*(2 + m*{COSINE}) + a**2 + b**2 + c**2 - a",
]  # fmt: skip
OTHERS = [
    f"{SECOND}*(2 + m*{COSINE}) + (a + b + c)**2",  # K is zero force alone
    f"{SECOND}*(2 + m*{COSINE}) + (a + b + c)**2 - (m - 1/2)*(a + b + c)",  # so it is for one m
    f"{SECOND}*(2 + m*{COSINE}) + (a + b + c)**2 - sqrt({SECOND})", f"{SECOND}*(m - 1 + {COSINE}) + (a + b + c)**2 - (a + b + c)",
    f"{SECOND}*(2 + m*{COSINE}) - (a + b + c)**2 + (a + b + c)",  # S is < 0 on the axis
    f"{SECOND}*(2 + m*{COSINE}) - (a + b + c)**3 - (a + b + c)", f"{SECOND}*(2 + m*acos({COSINE})) + (a + b + c)**2 - (a + b + c)",
    f"{SECOND}*(2 + m*{COSINE}) + (a + b + c)**2 - (a + b + c)*(2 + m*{COSINE})",  # without a limit at the axis
    f"{SECOND}*(2 + m*{COSINE}) + abs(a + b + c)*(a + b + c - 1)",
]  # fmt: skip


@pytest.mark.parametrize(("text", "right"), [*((x, True) for x in CAPS), *((x, False) for x in OTHERS)])
def test_a_cap_that_ends_on_the_axis(text: str, right: bool) -> None:
    assert confirmed(law(text, forces=("a", "b", "c"), m=UNIT, k=POSITIVE), "euler") is right


@pytest.mark.parametrize("text", CAPS)
def test_its_gradient_is_not_0_and_turns_slowly(text: str) -> None:
    """Around K, and close to the ends of it on the axis, in floats."""
    g, rng = law(text, forces=("a", "b", "c"), m=UNIT, k=POSITIVE).g, Random(11)

    def at(point: list[float]) -> float:
        return drawn_formulas.value(g, dict(zip("abc", point, strict=True)) | {"m": 0.9, "k": 1.5})

    def normal(way: list[float]) -> list[float]:
        inside, low, high = [0.1, 0.1, 0.1 + 1e-9], 0.0, 50.0
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if at([x + middle * w for x, w in zip(inside, way, strict=True)]) < 0 else (low, middle)
        here = [x + low * w for x, w in zip(inside, way, strict=True)]
        return [(at([x + 1e-6 * (i == j) for j, x in enumerate(here)]) - at(here)) / 1e-6 for i in range(3)]

    for way in [[rng.gauss(0, 1) for _ in range(3)] for _ in range(30)] + [[s + rng.gauss(0, 1e-3) for _ in range(3)] for s in (1, -1) * 8]:
        one, two = normal(way), normal([w + rng.gauss(0, 1e-4) for w in way])
        assert math.hypot(*one) > 0.1 and math.dist(one, two) < 0.02


def test_a_set_without_inside_has_no_normals() -> None:
    assert not confirmed(law("a**2 + b**2"), "composition", {"inside": {"a": "0"}})
    assert not confirmed(law("(a - m)**2 + b**2", m=POSITIVE), "composition", {"inside": {"a": "m"}})
    assert confirmed(law("(a - m)**2 + b**2 - m**2", m=POSITIVE), "composition", {"inside": {"a": "m"}})


# -- Euler's relation --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("stated", "right"),
    [
        (law("a**4 + b**4 + c*a**2*b**2 - s**4", c={}), True),  # whatever c: sigma . grad g = 4 s^4 where g = 0
        (law("a**3*b - a*b**3 - s**4"), True),
        (law("a**4 + b**4 + c*a**2*b**2 - e*s**4", c={}, e=UNIT), False),  # e may be 0: then 0 is on the boundary
        (law("a**4 + a*b**3 + a**2*s**2 - s**4"), False),  # two degrees beside the constant
        (law("a**4 + b**4 + 3*a**2*s**2 - s**4"), True),  # of one sign
        (law("a**4 + b**4 - a**2*s**2 - s**4"), True),  # 2 a^2 s^2 + 4 s^4
        (law("a**4 + b**4 - a**2"), False),  # crosses itself at 0
        (law("abs(a)**3 + (a**2 + b**2)**(3/2) - m", m=POSITIVE), True),
        (law("(a**2 + b**2)**(3/2) - c*a*abs(a)*pos(b)*abs(b) - m", c={}, m=POSITIVE), False),  # 3/2 of 2, and 4
        (law("(a**2 + b**2)**(3/2) - c*a*b*pos(a - b) - m", c={}, m=POSITIVE), False),  # a kink where a = b
        (law("(a**2 + b**2)**(5/2) - c*a*pos(a - b)**4 - m", c={}, m=POSITIVE), True),
        (law("abs(a)*norm(a, b)**2 + b**3 - m", m=POSITIVE), False),  # a kink at a = 0
        (law("a*abs(a) + b*abs(b) - m", m=POSITIVE), True),
        (law("a*abs(b) - m", m=POSITIVE), True),  # it is < 0 where b = 0
        (law("max(a, b)**3 - m", m=POSITIVE), False),
        (law("a**2/norm(a, b) - m", m=POSITIVE), True),  # it tends to -m at 0
        (law("a**2/norm(a, b) - a", m=POSITIVE), False),  # it tends to 0 there
        (law("a**2 + b**2 - m - n", m=POSITIVE, n={"min": "-1"}), False),
        (law("a**2 + b**2 - m - n", m=POSITIVE, n={"min": "-1"}, constraints=("n > -m",)), True),
        (law("a**2 + exp(b) - m", m=POSITIVE), False),  # exp has no degree
        (law("sqrt(abs(a))**4 + b**2 - m", m=POSITIVE), True),  # it is a^2
        (law("(a**2 + b**2 + c**2)**3 - k*a**2*b**2*c**2 - m**6", forces=("a", "b", "c"), k={}, m=POSITIVE), True),
    ],
    ids=lambda value: "" if isinstance(value, bool) else "law",
)
def test_g_grows_along_rays(stated: StatedLaw, right: bool) -> None:
    assert confirmed(stated, "euler") is right


# -- drawn laws against differences ------------------------------------------------------------------------------------

PARTS = (
    "a**2", "b**2", "a*b", "abs(a)", "abs(a)*abs(b)", "pos(a)**2", "neg(b)**2", "pos(a)*neg(b)", "a*abs(a)", "b*abs(a)", "abs(a)**(3/2)",
    "norm(pos(a), b)", "norm(a, 1)", "norm(a, b)", "abs(a - b)**3", "pos(a - b)*abs(b)", "(a**2 + b**2)**2", "exp(a)", "abs(a)*pos(b)**2",
    "norm(a, abs(b - 1))", "abs(a*b)", "pos(a)*pos(b)*a", "sqrt(abs(a))*a", "a**3", "norm(a, b)*pos(a)", "abs(tanh(a))**2", "sin(b)",
)  # fmt: skip


def gradient(g: Any, at: dict[str, float], steps: tuple[float, float]) -> list[float]:
    here = drawn_formulas.value(g, at)
    return [(drawn_formulas.value(g, {**at, x: at[x] + h}) - here) / h for x, h in zip("ab", steps, strict=True)]


def corner(g: Any) -> str | None:
    """A point of the boundary, on a ray where kinks lie, with slopes on two sides that differ, or with no slope."""
    for way in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, 1e-9), (0.3, -0.8), (-0.7, 0.4)):
        ends = [0.0, 0.05]
        while drawn_formulas.value(g, {"a": way[0] * ends[1], "b": way[1] * ends[1]}) <= 0 and ends[1] < 20:
            ends = [ends[1], ends[1] * 1.3]
        if ends[1] >= 20 or drawn_formulas.value(g, {"a": way[0] * ends[0], "b": way[1] * ends[0]}) > 0:
            continue
        for _ in range(60):
            mid = sum(ends) / 2
            ends = [mid, ends[1]] if drawn_formulas.value(g, {"a": way[0] * mid, "b": way[1] * mid}) <= 0 else [ends[0], mid]
        at = {"a": way[0] * ends[0], "b": way[1] * ends[0]}
        slopes = [gradient(g, at, (i * 1e-6, j * 1e-6)) for i in (1, -1) for j in (1, -1)]
        spread = max(abs(u - v) for one in slopes for two in slopes for u, v in zip(one, two, strict=True))
        if spread > 0.05 * (1 + math.hypot(*slopes[0])) or math.hypot(*slopes[0]) < 1e-4:
            return f"{at}: {slopes}"
    return None


def drawn() -> tuple[int, int, str | None]:
    """How many drawn laws are confirmed, how many have a corner, and one that is both."""
    rng, shown, cornered = Random(5), 0, 0
    for _ in range(250):
        g = (
            " + ".join(f"{rng.choice((1, 2, 3, '1/2'))}*{rng.choice(PARTS)}" for _ in range(rng.randint(1, 3)))
            + f" - {rng.choice((1, 2, 3))}"
        )
        stated = law(g)
        holds = any(confirmed(stated, rule) for rule in rules_of("smoothness", stated))
        fault = corner(stated.g)
        if holds and fault:
            return shown, cornered, f"{g}: {fault}"
        shown, cornered = shown + holds, cornered + (fault is not None)
    return shown, cornered, None


@pytest.mark.long
def test_what_is_confirmed_of_drawn_laws_is_smooth() -> None:
    shown, cornered, wrong = drawn()
    assert wrong is None
    assert shown > 20 and cornered > 40  # else nothing was asked


WRONG_RULES = {
    "a tip is never on the boundary": ("_sign_without", lambda g, tip, domain: NEGATIVE),
    "all kinks are one": ("_switch", lambda term, domain: frozenset({("kink", 1)})),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", WRONG_RULES)
def test_a_wrong_rule_is_caught(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(regularity, *WRONG_RULES[name])
    assert drawn()[2] is not None


# -- a root that is never 0, and a slope at the origin ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("under", "right"), [("m", True), ("m**2", True), ("m/(1 + m)", True), ("e", False), ("m - m", False), ("(1 - m)**2", False)]
)
def test_a_root_of_what_is_never_0_has_no_tip(under: str, right: bool) -> None:
    """Where that is 0 the set is a cone with its apex at (1, 0)."""
    stated = law(f"sqrt((a - 1)**2 + b**2 + {under}) + 2*a - 2", m={"positive": True, "max": "1"}, e=UNIT)
    assert confirmed(stated, "composition", {"inside": {"a": "-10"}}) is right


@pytest.mark.parametrize(
    ("g", "right"),
    [
        ("a**2 - m*b", True),
        ("a**2 + b**2 - m*(a + b)", True),
        ("a**2 - e*b", False),  # a line, for e = 0
        ("a**2 + b**2", False),
        ("a**2 + b**2 - e", False),
        ("a**2 + b**2 - 2*m*b + m**2", False),  # a point
        ("a**2 + b**2 - 2*m*b + m**2 - m**2*e", False),
        ("a**2 + b**2 - m*b + s", True),
        ("a**2 + b**2 - m*b + 0/e", False),
        ("abs(a) - m*b", False),
        ("sqrt(a**2 + m) - sqrt(m) - b", True),  # a graph over the other forces
        ("sqrt(a**2 + m) - sqrt(m) - 2*b", True),
        ("sqrt(a**2 + m) - sqrt(m) - e*b", False),  # a line, for e = 0
    ],
)
def test_a_convex_polynomial_that_falls_from_the_origin(g: str, right: bool) -> None:
    assert confirmed(law(g, m=POSITIVE, e=UNIT), "composition") is right


FROM_ZERO = {"n": {"min": "0"}}


@pytest.mark.parametrize(
    ("g", "ranges", "right"),
    [
        ("norm(a, b) - m - n", FROM_ZERO, True),
        ("norm(a, b) - m - n", {}, False),  # a cone with its tip at n = -m
        ("norm(a, b) - m - n", {"n": {"min": "-1"}}, False),
        ("norm(a, b) - n", FROM_ZERO, False),
        ("norm(a, b) - 2*m + m/(1 + n) - n", FROM_ZERO, True),  # convex there alone
        ("norm(a, b) - m + m/(1 + n) - n", FROM_ZERO, False),  # it has a tip at n = 0
        ("norm(a, b) + b - m - n", FROM_ZERO, True),
        ("abs(a) - 2*m + m/(1 + n) - n", FROM_ZERO, True),
        ("abs(a) + b**2 - m - n", FROM_ZERO, False),  # a kink where b**2 = m + n
        ("a**2 + b**2 + 1/(1 + n) + n - 1", FROM_ZERO, False),  # a point: g is 0 at zero force, and no less
    ],
)
def test_a_tip_is_off_the_boundary_where_ranges_give_g_a_sign_there(g: str, ranges: dict[str, Any], right: bool) -> None:
    given = {"forces": ("a", "b", "n"), "pressure": None, "parameters": {"m": POSITIVE}, "constraints": (), "g": g, "flow": None}
    assert confirmed(StatedLaw.read({**given, "domain": ranges}), "composition") is right
