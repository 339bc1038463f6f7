"""Support functions that the kernel confirms are suprema, and those beside them are not confirmed."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from itertools import combinations
from random import Random
from typing import Any, NamedTuple

import pytest

from duhem import Criterion, load, verify
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import Term, parse
from duhem.proof.verdict import Trust
from tests.long import long_at, long_but
from tests.oracles import drawn_formulas

SLIPS = {"a": "x", "b": "y", "c": "z"}
POSITIVE = {"positive": True}


def confirmed(g: str, potential: str, forces: str = "ab", flat: tuple[str, ...] = (), **more: Any) -> bool:
    constraints = more.pop("constraints", [])
    law = {"forces": tuple(forces), "pressure": "s", "parameters": more, "constraints": constraints, "g": g, "flow": None}
    evidence = {"potential": potential, "slips": {f: SLIPS[f] for f in forces}, "flat": list(flat)}
    return not objection("duality", "polar-gauge", frozenset(), StatedLaw.read(law), evidence)


# -- drawn laws, their potential from another formula ------------------------------------------------------------------


class Drawn(NamedTuple):
    g: str
    potential: str


def some(rng: Random, most: int = 5) -> Fraction:
    return Fraction(rng.choice((-1, 1)) * rng.randint(1, most), rng.randint(1, 3))


def text(x: Fraction) -> str:
    return f"({x})"


def ellipse(rng: Random) -> Drawn:
    """norm(L (sigma - m)) - r or its square: m . d + r sqrt(d . (L' L)^-1 d)."""
    while True:
        p, q, r, s, ma, mb = (some(rng) for _ in range(6))
        if p * s - q * r:
            break
    rows = [f"{text(u)}*(a - {text(ma)}*abs(s)) + {text(v)}*(b - {text(mb)}*abs(s))" for u, v in ((p, q), (r, s))]
    radius, det = abs(some(rng)), p * s - q * r
    aa, ab, bb = (v * radius**2 / det**2 for v in (q * q + s * s, -(p * q + r * s), p * p + r * r))
    root = f"sqrt({text(aa)}*x**2 + 2*{text(ab)}*x*y + {text(bb)}*y**2)"
    squared = f"({rows[0]})**2 + ({rows[1]})**2 - ({text(radius)}*s)**2"
    g = rng.choice((f"norm({rows[0]}, {rows[1]}) - {text(radius)}*abs(s)", squared))
    return Drawn(g, f"-s*({text(ma)}*x + {text(mb)}*y) - s*{root}")


def two_sided(rng: Random) -> Drawn:
    """A p-norm of two-sided gauges about a centre."""
    up, down, left, right, ma, mb = (abs(some(rng)) for _ in range(6))
    p = rng.choice((Fraction(3, 2), Fraction(3), Fraction(4)))
    q = p / (p - 1)
    one = f"pos(a - {text(ma)}*abs(s))*{text(up)} + neg(a - {text(ma)}*abs(s))*{text(down)}"
    two = f"pos(b + {text(mb)}*abs(s))*{text(left)} + neg(b + {text(mb)}*abs(s))*{text(right)}"
    x, y = f"pos(x)/{text(up)} + neg(x)/{text(down)}", f"pos(y)/{text(left)} + neg(y)/{text(right)}"
    powers = f"(({one})**{text(p)} + ({two})**{text(p)})**(1/{text(p)})", f"(({x})**{text(q)} + ({y})**{text(q)})**(1/{text(q)})"
    pairs = [
        (f"norm({one}, {two})", f"norm({x}, {y})"),
        (f"max({one}, {two})", f"({x} + {y})"),
        (f"({one} + {two})", f"max({x}, {y})"),
        powers,
    ]
    gauge, polar = rng.choice(pairs)
    return Drawn(f"{gauge} + 2*s", f"-s*({text(ma)}*x - {text(mb)}*y) - 2*s*{polar}")


def polygon(rng: Random) -> Drawn:
    """Faces in all directions and the vertices where two meet."""
    while True:
        faces = [((some(rng), some(rng)), abs(some(rng))) for _ in range(rng.randint(3, 5))]
        angles = sorted(math.atan2(b, a) for (a, b), _ in faces)
        if max(v - u for u, v in zip(angles, [*angles[1:], angles[0] + 2 * math.pi], strict=True)) < 3:
            break
    vertices = dict.fromkeys(meeting for one, two in combinations(faces, 2) if (meeting := crossing(one, two, faces)))
    g = ", ".join(f"{text(a)}*a + {text(b)}*b - {text(limit)}*abs(s)" for (a, b), limit in faces)
    return Drawn(f"max({g})", f"-s*max({', '.join(f'{text(u)}*x + {text(v)}*y' for u, v in vertices)})")


def crossing(one: Any, two: Any, faces: Any) -> tuple[Fraction, Fraction] | None:
    ((a, b), m), ((c, d), n) = one, two
    det = a * d - b * c
    if not det:
        return None
    u, v = (m * d - n * b) / det, (a * n - c * m) / det
    return (u, v) if all(p * u + q * v <= limit for (p, q), limit in faces) else None


def supremum(g: Term, way: tuple[float, float], start: tuple[float, float]) -> float:
    """The greatest sigma . d over the boundary, seen from a point inside; with s = -1."""
    best = -math.inf
    for k in range(180):
        u, v = math.cos(k * math.pi / 90), math.sin(k * math.pi / 90)
        low, high = 0.0, 50.0
        for _ in range(30):
            mid = (low + high) / 2
            inside = drawn_formulas.value(g, {"a": start[0] + mid * u, "b": start[1] + mid * v, "s": -1.0}) <= 0
            low, high = (mid, high) if inside else (low, mid)
        best = max(best, (start[0] + low * u) * way[0] + (start[1] + low * v) * way[1])
    return best


FAMILIES = {f.__name__: f for f in (ellipse, two_sided, polygon)}


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_drawn_potentials_are_confirmed_and_what_lies_beside_them_is_not(family: str) -> None:
    rng = Random(family)
    drawn = [FAMILIES[family](rng) for _ in range(3)]
    for g, potential in drawn:
        assert confirmed(g, potential), (g, potential)
    g, potential = drawn[0]
    beside = [
        f"({potential})*1.000000001",
        f"{potential} + s*x/10**9",
        f"{potential} + s*abs(y)/10**9",
        f"-({potential})",
        f"{potential} - s/10**9",
        re.sub(r"\b[xy]\b", lambda found: "y" if found.group() == "x" else "x", potential),
        re.sub(r"\bx\b", "(-x)", potential),
    ]
    for wrong in beside[:5]:
        assert not confirmed(g, wrong), (g, wrong)
    for other in beside[5:]:  # right for a symmetric K only
        at = {"x": 0.3, "y": -0.7, "s": -1.0}
        here, there = (drawn_formulas.value(parse(p), at) for p in (potential, other))
        assert abs(here - there) < 1e-12 or not confirmed(g, other), (g, other)


@pytest.mark.slow
@pytest.mark.parametrize("family", long_but([1], FAMILIES))
def test_what_is_confirmed_is_the_supremum(family: str) -> None:
    rng = Random(family)
    g, potential = FAMILIES[family](rng)
    assert confirmed(g, potential)
    law, value = parse(g), parse(potential)
    ends = [drawn_formulas.value(value, {"x": x, "y": y, "s": -1.0}) for x, y in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))]
    middle = (ends[0] - ends[1]) / 2, (ends[2] - ends[3]) / 2
    if drawn_formulas.value(law, {"a": middle[0], "b": middle[1], "s": -1.0}) >= 0:
        middle = (0.0, 0.0)
    for way in ((0.3, -0.7), (1.0, 0.2), (-0.5, -0.5)):
        found = supremum(law, way, middle)
        expected = drawn_formulas.value(value, {"x": way[0], "y": way[1], "s": -1.0})
        assert -1e-6 < expected - found < 0.05 * (1 + abs(expected)), (g, potential)  # few points miss a corner


# -- ranks, ends of the domain, planes of slips ------------------------------------------------------------------------

UNIT = {"min": "0", "max": "1"}
SIGNED = {"min": "-1", "max": "1"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "potential", "parameters", "right"),
    [
        ("norm(a, a + e*b)**2 + norm(a, e*b)**2 - 1", "sqrt(2*x**2/5 - 2*x*y/(5*e) + 3*y**2/(5*e**2))", {"e": SIGNED}, False),
        ("norm(a, a + e*b)**2 + norm(a, e*b)**2 - 1", "sqrt(2*x**2/5 - 2*x*y/(5*e) + 3*y**2/(5*e**2))", {"e": POSITIVE}, True),
        ("norm(e*a, b) + s", "-s*norm(x/e, y)", {"e": UNIT}, False),
        ("norm(e*a, b) + s", "-s*norm(x/e, y)", {"e": {"min": "1/10", "max": "1"}}, True),
        ("norm(a, b) - e", "e*norm(x, y)", {"e": UNIT}, False),  # K may be a point
        ("norm(a, b, e) + s", "sqrt(s**2 - e**2)*norm(x, y)", {"e": SIGNED}, False),  # |e| may be more than |s|
        ("norm(a, b, m) - m - 1", "sqrt(1 + 2*m)*norm(x, y)", {"m": POSITIVE}, True),
        ("norm(a, b, m) - m - 1", "sqrt(1 + m)*norm(x, y)", {"m": POSITIVE}, False),
        ("norm(a, b, e) - 1", "sqrt(1 - e**2)*norm(x, y)", {"e": SIGNED}, False),  # a point at the ends
        ("norm(a, b, e) - 2", "sqrt(4 - e)*norm(x, y)", {"e": SIGNED}, False),
        ("norm(a - e*s, b/m) + s", "s*e*x - s*norm(x, m*y)", {"e": SIGNED, "m": POSITIVE}, True),
        ("norm(a - e*s, b/m) + s", "-s*e*x - s*norm(x, m*y)", {"e": SIGNED, "m": POSITIVE}, False),
        ("a**2 + a*b + b**2 - s**2", "-s*sqrt((x**2 - x*y + y**2)*4/3)", {}, True),
        ("a**2 + a*b + b**2 - s**2", "-s*sqrt((x**2 + x*y + y**2)*4/3)", {}, False),
        ("m*a**2 + a*b + 2*b**2/m - 1", "sqrt(8*x**2/m - 4*x*y + 4*m*y**2)/sqrt(7)", {"m": POSITIVE}, True),
        ("m*a**2 + a*b + b**2/m/4 - 1", "sqrt(8*x**2/m - 4*x*y + 4*m*y**2)/sqrt(7)", {"m": POSITIVE}, False),  # two lines
        ("a**2 + e*a*b + b**2 - 1", "sqrt((x**2 - e*x*y + y**2)/(1 - e**2/4))", {"e": {"min": "0", "max": "2"}}, False),
        ("a**2 + 3*a*b + b**2 - 1", "sqrt((x**2 - 3*x*y + y**2)/(1 - 9/4))", {}, False),  # a hyperbola
        ("1 - a**2 - b**2", "norm(x, y)", {}, False),
        ("(a**4 + b**4)**(1/4) - 1", "(abs(x)**(4/3) + abs(y)**(4/3))**(3/4)", {}, True),
        ("(a**4 + b**4)**(1/4) - 1", "(abs(x)**(4/3) + abs(y)**(4/3))**(1/4)", {}, False),
        ("a**4/m**4 + b**4 - s**4", "-s*((m*abs(x))**(4/3) + abs(y)**(4/3))**(3/4)", {"m": POSITIVE}, True),
        ("a**4/m**4 + b**4 - s**4", "s*((m*abs(x))**(4/3) + abs(y)**(4/3))**(3/4)", {"m": POSITIVE}, False),
        ("a**4/m**4 + b**4 - s**4", "-s*((m*abs(x))**(4/3) + abs(y)**(4/3))**(3/4)", {"m": {}}, False),
        ("16*pos(a)**3 + 2*abs(a)**3/m + abs(b)**3 - 1", "(abs(x)**(3/2) + abs(y)**(3/2))**(2/3)", {"m": POSITIVE}, False),
        ("abs(a)**p + abs(b)**p - 1", "(abs(x)**(p/(p - 1)) + abs(y)**(p/(p - 1)))**((p - 1)/p)", {"p": {"min": "2"}}, True),
        ("abs(a)**p + abs(b)**p - 1", "(abs(x)**(p/(p - 1)) + abs(y)**(p/(p - 1)))**((p - 1)/p)", {"p": {"min": "1"}}, False),
        ("abs(a)**p + abs(b)**p - 2", "(abs(x)**(p/(p - 1)) + abs(y)**(p/(p - 1)))**((p - 1)/p)", {"p": {"min": "2"}}, False),
        ("abs(a)**p + abs(b)**2 - 1", "norm(x, y)", {"p": {"min": "2"}}, False),
        ("abs(a + e*b) + abs(a) - 1", "max(abs(x - y/e), abs(y)/e)", {"e": POSITIVE}, True),
        ("abs(a + e*b) + abs(a) - 1", "max(abs(x - y/e), abs(y/e))", {"e": {"min": "1/9", "max": "2"}}, True),
        ("abs(a + e*b) + abs(a) - 1", "max(abs(x - y/e), abs(y/e))", {"e": UNIT}, False),  # a strip at e = 0
        ("abs(a + e*b) + abs(a) - 1", "max(abs(x + y/e), abs(y/e))", {"e": POSITIVE}, False),
        ("abs(a + e*b) + abs(a) - 1", "max(abs(x - y/e), 2*abs(y/e))", {"e": POSITIVE}, False),
        ("abs(a + e*b) + abs(2*a) - 1", "max(abs(x - y/e)/2, abs(y/e))", {"e": POSITIVE}, True),
        ("max(pos(a + e*b)/2 + neg(a + e*b), abs(a)) - 1", "2*pos(y/e) + neg(y/e) + abs(x - y/e)", {"e": POSITIVE}, True),
        ("max(pos(a + e*b)/2 + neg(a + e*b), abs(a)) - 1", "2*neg(y/e) + pos(y/e) + abs(x - y/e)", {"e": POSITIVE}, False),
        ("max(pos(a - e*b)/2 + neg(a - e*b), abs(a)) - 1", "2*neg(y/e) + pos(y/e) + abs(x + y/e)", {"e": POSITIVE}, True),
        ("max(abs(a + e*b), abs(a + b)) - 1", "abs((x - y)/(1 - e)) + abs((y - e*x)/(1 - e))", {"e": {"min": "2"}}, True),
        ("max(abs(a + e*b), abs(a + b)) - 1", "abs((x - y)/(1 - e)) + abs((y - e*x)/(1 - e))", {"e": POSITIVE}, False),
        ("(a**3 + b**3)**(1/3) - 1", "(abs(x)**(3/2) + abs(y)**(3/2))**(2/3)", {}, False),  # undefined
        ("(abs(a)**p + abs(b)**p)**(1/p) - 1", "(abs(x)**(p/(p - 1)) + abs(y)**(p/(p - 1)))**((p - 1)/p)", {"p": {"min": "2"}}, True),
        ("(abs(a)**p + abs(b)**p)**(1/p) - 1", "(abs(x)**(p/(p - 1)) + abs(y)**(p/(p - 1)))**((p - 1)/p)", {"p": {"min": "1"}}, False),
        ("(abs(a)**p + abs(b)**p)**(1/p) - 1", "(abs(x)**(p/(p - 1)) + abs(y)**(p/(p - 1)))**((p - 1)/p)", {"p": POSITIVE}, False),
        ("max(a, -a, b, -b) - m", "m*(abs(x) + abs(y))", {"m": POSITIVE}, True),
        ("max(a, -a, b, -b) - m", "m*max(x + y, x - y, y - x)", {"m": POSITIVE}, False),  # a vertex too few
        ("max(a, -a, b, -b) - m", "m*max(x + y, x - y, y - x, -x - y, 2*x)", {"m": POSITIVE}, False),  # one too many
        ("max(a, -a, b, -b) - m", "m*max(x + y, x - y, y - x, -x - y, x/2)", {"m": POSITIVE}, True),  # inside K: it changes nothing
        ("max(a, -a, b) - m", "m*max(x + y, y - x)", {"m": POSITIVE}, False),  # unbounded
        ("max(a, b, -a - b) - m", "m*max(x + y, x - 2*y, y - 2*x)", {"m": POSITIVE}, True),
        ("max(a, b, -a - b) - e", "e*max(x + y, x - 2*y, y - 2*x)", {"e": SIGNED}, False),
        ("min(a, -a, b, -b) - m", "m*(abs(x) + abs(y))", {"m": POSITIVE}, False),
        ("max(abs(a), norm(b)) - m", "m*(abs(x) + abs(y))", {"m": POSITIVE}, True),
        ("norm(pos(a) + 2*neg(a), b) - 1", "norm(pos(x) + neg(x)/2, y)", {}, True),
        ("norm(pos(a) + 2*neg(a), b) - 1", "norm(pos(x) + neg(x)/3, y)", {}, False),
        ("norm(pos(a) + 2*neg(a), b) - 1", "norm(pos(x)/2 + neg(x)/2, y)", {}, False),
        ("max(pos(a) + 2*neg(a), abs(b)) - m", "m*(pos(x) + neg(x)/2 + abs(y))", {"m": POSITIVE}, True),
        ("max(pos(a) + 2*neg(a), abs(b)) - m", "m*(pos(x) + neg(x)/2 + 2*abs(y))", {"m": POSITIVE}, False),
        ("pos(a) + 2*neg(a) + abs(b) - m", "m*max(pos(x) + neg(x)/2, abs(y))", {"m": POSITIVE}, True),
        ("pos(a) + 2*neg(a) + abs(b) - m", "m*max(pos(x) + neg(x)/2, pos(y))", {"m": POSITIVE}, False),
        ("((pos(a) + 2*neg(a))**3 + abs(b)**3)**(1/3) - 1", "((pos(x) + neg(x)/2)**(3/2) + abs(y)**(3/2))**(2/3)", {}, True),
        ("((pos(a) + 2*neg(a))**3 + abs(b)**3)**(1/3) - 1", "((pos(x) + neg(x)/2)**3 + abs(y)**3)**(1/3)", {}, False),
        ("abs(a)**3 + abs(b)**2 - 1", "(abs(x)**(3/2) + abs(y)**(3/2))**(2/3)", {}, False),  # of two exponents
        ("(a**2 + b**2)**(1/3) - 2", "2*norm(x, y)", {}, False),  # no square root
        ("norm(a, b) - 2", "2*(x**2 + y**2)**(1/3)", {}, False),
        ("norm(a, b) - m", "m*norm(x, y) + norm(x, 2*y)", {"m": POSITIVE}, False),  # two roots
        ("norm(a - m, b) - m", "m*x", {"m": POSITIVE}, False),  # none
        ("norm(a - m, b) - m", "m*x + m*norm(x, y)", {"m": POSITIVE}, True),
        ("norm(a - m, b) - m", "m*x*e/e + m*norm(x, y)", {"m": POSITIVE, "e": UNIT}, False),  # undefined for e = 0
        ("a**2 + b**2 - m**2", "m*norm(x, y)*e/e", {"m": POSITIVE, "e": UNIT}, False),
        ("(a**2 + b**2 - m**2)*e/e", "m*norm(x, y)", {"m": POSITIVE, "e": UNIT}, False),
    ],
)
def test_what_must_be_shown_over_the_whole_domain(g: str, potential: str, parameters: dict[str, Any], right: bool) -> None:
    assert confirmed(g, potential, **parameters) is right


@pytest.mark.parametrize(("inside", "right"), [("m + k", True), ("k + m", True), ("m - k", False), ("2*m + k", False)])
def test_constants_of_g_and_of_its_potential_may_stand_in_different_orders(inside: str, right: bool) -> None:
    ranges: dict[str, Any] = {"m": {"min": "1/10", "max": "3/5"}, "k": {"min": "0", "max": "1/2"}, "c": POSITIVE}
    g, potential = (f"min(-s*tan({angle}), c - s)" for angle in ("m + k", inside))
    assert confirmed(f"norm(a, b) - {g}", f"{potential}*norm(x, y)", **ranges) is right


def test_a_constant_inside_is_not_passed_over() -> None:
    for one in ("", " + 1", " - 1", " + m"):
        g, potential = f"norm(abs(a) + abs(b){one}, c) - 3", "3*norm(max(abs(x), abs(y)), z)"
        assert confirmed(g, potential, "abc", m=POSITIVE) is (one == ""), one
        g, potential = f"max(norm(a, b){one}, abs(c)) - 3", f"3*(norm(x, y){one} + abs(z))"
        assert confirmed(g, potential, "abc", m=POSITIVE) is (one == ""), one
        g, potential = "norm(norm(a, b), c) - 3", f"3*norm(x, y, z){one}"
        assert not confirmed(g, potential, "abc", m=POSITIVE) or one == "", one


MISES, ROOT = "norm(a - b, b - c, c - a) - m", "m*norm(x, y, z)/sqrt(3)"
TRESCA, GREATEST = "max(abs(a - b), abs(b - c), abs(c - a)) - m", "m*max(abs(x), abs(y), abs(z))"


@pytest.mark.slow
@pytest.mark.parametrize(("g", "potential"), [(MISES, ROOT), (TRESCA, GREATEST)])
def test_where_the_potential_is_finite_is_part_of_the_claim(g: str, potential: str) -> None:
    assert confirmed(g, potential, "abc", ("x + y + z",), m=POSITIVE)
    for flat in (
        (),
        ("x + y",),
        ("x + y + z/2",),
        ("x + y + z", "x - y"),
        ("0*x",),
        ("x + y + z - 1",),
        ("x*y + z",),
        ("x + y + z + 0/(m - m)",),
    ):
        assert not confirmed(g, potential, "abc", flat, m=POSITIVE), flat
    assert not confirmed(g, f"({potential})*1.000000001", "abc", ("x + y + z",), m=POSITIVE)


@pytest.mark.parametrize(
    "evidence",
    [
        {},
        {"potential": "norm(x, y)"},
        {"potential": "norm(x, y)", "slips": {"a": "x"}},
        {"potential": "norm(x, x)", "slips": {"a": "x", "b": "x"}},
        {"potential": "norm(a, b)", "slips": {"a": "a", "b": "b"}},
        {"potential": "norm(s, y)", "slips": {"a": "s", "b": "y"}},
        {"potential": "norm(m, y)", "slips": {"a": "m", "b": "y"}},
        {"potential": "norm(x, y)", "slips": {"a": "x", "b": "y", "c": "z"}},
        {"potential": "norm(x, y", "slips": {"a": "x", "b": "y"}},
        {"potential": 3, "slips": {"a": "x", "b": "y"}},
        {"potential": "norm(x, y)", "slips": {"a": "x", "b": "y"}, "flat": "x"},
    ],
)
def test_tampered_evidence_is_refused(evidence: dict[str, Any]) -> None:
    law = {"forces": ("a", "b"), "pressure": "s", "parameters": {"m": POSITIVE}, "constraints": [], "g": "norm(a, b) - 1", "flow": None}
    assert objection("duality", "polar-gauge", frozenset(), StatedLaw.read(law), evidence)
    assert not objection(
        "duality", "polar-gauge", frozenset(), StatedLaw.read(law), {"potential": "norm(x, y)", "slips": {"a": "x", "b": "y"}}
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", long_at([0], ["superellipse", "tresca", "von-mises"]))
def test_potentials_of_built_in_laws_are_confirmed(name: str) -> None:
    law = load(name)
    assert isinstance(law, Criterion)
    (found,) = (r for r in verify(law, claims=["duality"]).results if r.claim == "duality")
    assert found.trust is Trust.CHECKED
