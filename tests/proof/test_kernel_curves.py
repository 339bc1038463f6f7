"""The kernel's rules for laws given by a boundary curve: intervals that enclose, derivatives by the angle, curves of known shape."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from math import cos, exp, isclose, pi, sin, sqrt
from random import Random
from typing import Any

import pytest

import duhem
from duhem.law.curve_law import ParametricCriterion
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.certificate import COUPLED, recheck
from duhem.proof.kernel.claims import CURVE_RULES, objection
from duhem.proof.kernel.constant_value import Enclosure, enclosed
from duhem.proof.kernel.curve import StatedCurve, _circle
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import NotWritten, number, parse
from tests.long import long_at, long_but, mostly_long

UNIT = 2**96
CIRCLE = ["cos(phi)", "sin(phi)"]


def curve(*boundary: str, flow: list[str] | None = None, **parameters: Any) -> StatedCurve:
    given = {"forces": ["x", "y"], "pressure": "s", "angle": "phi", "boundary": boundary, "flow": flow, "constraints": []}
    return StatedCurve.read(given | {"parameters": parameters})


def shown(stated: StatedCurve) -> set[str]:
    """The claims of the shape that the kernel shows; those that rest on others are left out."""
    return {
        claim
        for (claim, rule), (needs, *_) in CURVE_RULES.items()
        if claim not in COUPLED and not needs and not objection(claim, rule, frozenset(), stated, {})
    }


def test_intervals_hold_every_result() -> None:
    rng = Random(5)

    def drawn() -> Fraction:
        return Fraction(rng.randint(-1000, 1000), rng.randint(1, 1000))

    def inside(x: Fraction, found: Enclosure) -> bool:
        return found.low <= x * UNIT <= found.high

    for _ in range(2000):
        one, two = sorted([drawn(), drawn()]), sorted([drawn(), drawn()])
        a, b = Enclosure.between(*one), Enclosure.between(*two)
        x, y = (low + (high - low) * Fraction(rng.randint(0, 8), 8) for low, high in (one, two))
        assert inside(x + y, a.plus(b)) and inside(x * y, a.times(b)) and inside(-x, a.minus())
        if not one[0] <= 0 <= one[1]:
            assert inside(1 / x, a.inverse())
        if one[0] >= 0:
            root = a.root()
            assert root.low**2 <= x * UNIT**2 <= root.high**2


def test_an_interval_with_0_has_no_inverse_and_one_below_it_no_root() -> None:
    with pytest.raises(ZeroDivisionError):
        Enclosure.between(Fraction(-1), Fraction(0)).inverse()
    with pytest.raises(ValueError, match="a root"):
        Enclosure.between(Fraction(-1), Fraction(1)).root()


def test_derivatives_by_the_angle() -> None:
    x, h = 0.7, 1e-4
    place = {f"{word} of the angle": Enclosure.between(v, v) for word, v in (("cosine", Fraction(cos(x))), ("sine", Fraction(sin(x))))}
    for text, exact in (
        ("1/(2 + cos(phi))", lambda t: 1 / (2 + cos(t))),
        ("sqrt(2 + cos(phi))", lambda t: sqrt(2 + cos(t))),
        ("(2 + cos(phi))*sqrt(2 + cos(phi)) + 2 + cos(phi)", lambda t: (2 + cos(t)) ** 1.5 + 2 + cos(t)),
        ("norm(2*sin(phi), cos(phi), 1)", lambda t: sqrt(4 * sin(t) ** 2 + cos(t) ** 2 + 1)),
        ("exp(sin(phi)*cos(phi))*(2 + sin(phi))**(1/3)", lambda t: exp(sin(t) * cos(t)) * (2 + sin(t)) ** (1 / 3)),
    ):
        found = [enclosed(curve(text, "0").derivative(order)[0], place).low / UNIT for order in range(3)]
        here, after, before = exact(x), exact(x + h), exact(x - h)
        assert isclose(found[0], here, rel_tol=1e-14)
        assert isclose(found[1], (after - before) / (2 * h), rel_tol=1e-6)
        assert isclose(found[2], (after - 2 * here + before) / h**2, rel_tol=1e-5)


ALL = {"origin", "convexity", "smoothness", "dissipation", "state_laws"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stated", "expected"),
    long_at(
        [6, 11, 13, 17],
        [
            (curve(*CIRCLE), ALL),
            (curve(*CIRCLE, flow=CIRCLE), ALL),
            (curve("3*cos(phi)", "sin(phi)/2"), ALL),
            (curve("cos(phi)", "-sin(phi)"), ALL),  # clockwise
            (curve("-cos(phi)", "sin(phi)", flow=["-cos(phi)", "sin(phi)"]), ALL),
            (curve("-cos(phi)", "sin(phi)", flow=CIRCLE), {"origin", "convexity", "smoothness", "state_laws"}),
            (curve("(1 + 51/100*cos(phi))*sin(phi)", "(1 + 51/100*cos(phi))*cos(phi)"), ALL - {"convexity"}),
            (curve("cos(phi) + 2", "sin(phi)", flow=CIRCLE), {"convexity", "smoothness", "state_laws"}),  # 0 is outside
            (curve("cos(phi) + 1", "sin(phi)", flow=CIRCLE), {"convexity", "smoothness", "dissipation", "state_laws"}),  # 0 is on it
            (curve("(1 + 49/100*cos(phi))*cos(phi)", "(1 + 49/100*cos(phi))*sin(phi)"), ALL),  # limacons are convex up to 1/2
            (curve("(1 + 51/100*cos(phi))*cos(phi)", "(1 + 51/100*cos(phi))*sin(phi)"), ALL - {"convexity"}),
            pytest.param(curve("(1 + 2*cos(phi))*cos(phi)", "(1 + 2*cos(phi))*sin(phi)"), {"state_laws"}, marks=pytest.mark.long),  # a loop
            (curve("cos(phi)**2 - sin(phi)**2", "2*cos(phi)*sin(phi)", flow=CIRCLE), {"origin", "state_laws"}),  # twice around
            (curve("cos(phi)**3", "sin(phi)**3", flow=CIRCLE), {"origin", "dissipation", "state_laws"}),  # cusps
            (curve("m*cos(phi)", "sin(phi)", m={"min": "1", "max": "9/8"}), ALL),  # for all m between
            (curve("m*cos(phi)", "sin(phi)", m={"min": "0", "max": "1"}), {"state_laws"}),  # a segment at m = 0
            (curve("m*cos(phi)", "sin(phi)", m={"positive": True, "max": None}), ALL),  # for all m > 0
            (curve("cos(phi)/(1 + cos(phi))", "sin(phi)"), {"state_laws"}),
            (curve("sqrt(cos(phi)**2)", "sin(phi)"), {"state_laws"}),
            (curve("abs(cos(phi))", "sin(phi)"), {"state_laws"}),
            (curve("phi", "sin(phi)"), {"state_laws"}),
        ],
    ),
)
def test_curves_of_known_shape(stated: StatedCurve, expected: set[str]) -> None:
    assert shown(stated) == expected


def test_names_of_a_curve_are_declared() -> None:
    for boundary in (["cos(psi)", "sin(phi)"], ["cos(phi)", "a*sin(phi)"], ["cos(phi)"]):
        with pytest.raises((NotWritten, ValueError)):
            curve(*boundary)
    with pytest.raises(NotWritten, match="twice"):
        curve(*CIRCLE, phi={"positive": True, "max": None})


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_long([2, 8], 2))
def test_star_shapes_of_random_harmonics_agree_with_their_own_curvature(count: int) -> None:
    """r = 1 + e cos n phi: convex exactly while r^2 + 2 r'^2 - r r'' >= 0, seen on a grid of the angle."""
    rng = Random(11)
    for _ in range(count):
        n, e = rng.choice((1, 2)), Fraction(rng.randint(1, 70), 100)
        wave = "cos(phi)" if n == 1 else "(cos(phi)**2 - sin(phi)**2)"
        r = f"(1 + {e}*{wave})"
        found = "convexity" in shown(curve(f"{r}*cos(phi)", f"{r}*sin(phi)"))
        radii = [(1 + e * cos(n * t), -n * e * sin(n * t), -n * n * e * cos(n * t)) for t in (k * pi / 300 for k in range(601))]
        bend = min(r * r + 2 * dr * dr - r * ddr for r, dr, ddr in radii)
        assert abs(bend) < 1e-2 or found is (bend > 0), (n, e, bend)


@pytest.mark.long
def test_the_certificate_of_a_wedge_is_confirmed_and_that_of_another_wedge_is_not() -> None:
    values = {"tan_alpha": "1", "tan_beta": "1/4", "mu_alpha": "1/4", "mu_beta": "1/4"}
    made = duhem.verify("wedge", values).certificate()
    assert {r.claim for r in recheck(made) if r.confirmed} == ALL
    assert {c["trust"] for c in made["claims"] if c["verdict"] == "proved"} == {"checked"}


@pytest.mark.slow
def test_what_is_refuted_of_a_curve_is_not_confirmed() -> None:
    bent = ParametricCriterion(name="bent", boundary=("(1 + 3/5*cos(phi))*cos(phi)", "(1 + 3/5*cos(phi))*sin(phi)"), flow=("1", "0"))
    found = duhem.verify(bent, claims=["origin", "convexity", "normality", "dissipation"])
    assert {r.claim for r in found.results if r.verdict == "refuted"} >= {"convexity", "dissipation"}
    assert not any(r.confirmed for r in recheck(found.certificate()) if found[r.claim].verdict == "refuted")
    assert not shown(StatedCurve.read(found.certificate()["law"])) & {"convexity", "dissipation", "normality"}


@pytest.mark.parametrize(
    ("half", "low", "high", "c", "s"),
    [
        (1, "0", "1", ("0", "1"), ("0", "1")), (1, "-1", "0", ("0", "1"), ("-1", "0")), (-1, "0", "1", ("-1", "0"), ("-1", "0")),
        (1, "-1/2", "1/3", ("3/5", "1"), ("-4/5", "3/5")), (1, "1/3", "1/2", ("3/5", "4/5"), ("3/5", "4/5")),
        (1, "-1/2", "-1/3", ("3/5", "4/5"), ("-4/5", "-3/5")), (-1, "1/3", "1/2", ("-4/5", "-3/5"), ("-4/5", "-3/5")),
        (-1, "-1/3", "1/2", ("-1", "-3/5"), ("-4/5", "3/5")), (1, "1/2", "1/2", ("3/5", "3/5"), ("4/5", "4/5")),
    ],
)  # fmt: skip
def test_cosine_and_sine_over_a_box(half: int, low: str, high: str, c: tuple[str, str], s: tuple[str, str]) -> None:
    found = _circle(half, Fraction(low), Fraction(high))
    for word, ends in (("cosine", c), ("sine", s)):
        wanted = Enclosure.between(*map(Fraction, ends))
        assert all(abs(x - y) <= 1 for x, y in zip(found[f"{word} of the angle"], wanted, strict=True))


@pytest.mark.parametrize(
    ("boundary", "turns"),
    [
        (CIRCLE, 1), (["sin(phi)", "cos(phi)"], -1), (["cos(phi)**2 - sin(phi)**2", "2*cos(phi)*sin(phi)"], 2),
        (["cos(phi)**2 - sin(phi)**2", "-2*cos(phi)*sin(phi)"], -2), (["cos(phi) + 2", "sin(phi)"], 0), (["cos(phi)", "sin(phi) + 2"], 0),
        (["cos(phi) + 99/100", "sin(phi)"], 1), (["cos(phi) + 1", "sin(phi)"], None), (["cos(phi)", "0*sin(phi)"], None),
        (["cos(phi)", "sin(phi)/1000"], 1), (["-cos(phi)", "-sin(phi)"], 1), (["1 + 0*cos(phi)", "1 + 0*sin(phi)"], 0),
    ],
)  # fmt: skip
def test_how_often_a_curve_turns_around_zero(boundary: list[str], turns: int | None) -> None:
    found = curve(*boundary)
    assert found.turns(found.derivative(0), number(1)) == turns
    assert found.around_zero() is bool(turns)  # whichever way it is run, and however often


@pytest.mark.parametrize(
    ("flow", "powered"),
    [
        (CIRCLE, True), (["cos(phi) - sin(phi)", "sin(phi) + cos(phi)"], True), (["-sin(phi)", "cos(phi)"], True),
        (["-cos(phi)", "-sin(phi)"], False), (["1", "0"], False), (["cos(phi) + 1/2", "sin(phi)"], True),
        (["cos(phi) + 1", "sin(phi)"], True), (["2*cos(phi)", "0"], True), (["cos(phi) + 101/100", "sin(phi)"], False),
    ],
)  # fmt: skip
def test_the_power_all_around(flow: list[str], powered: bool) -> None:
    assert curve(*CIRCLE, flow=flow).powered() is powered
    assert curve(*CIRCLE).powered()


def test_a_curve_turned_round_has_the_same_slip_at_each_point() -> None:
    clockwise = curve("cos(phi)", "-sin(phi)", flow=["cos(phi)", "-sin(phi)"])
    turned = clockwise.reversed()
    assert clockwise.powered() and turned.powered()
    turns = [c.turns(c.derivative(0), number(1)) for c in (clockwise, turned, turned.reversed())]
    assert turns == [-1, 1, -1]
    assert curve("cos(phi)**2 - sin(phi)**2", "-2*cos(phi)*sin(phi)").around_zero()  # twice around, either way


ABOVE_0: dict[str, Any] = {"positive": True, "max": None}
UNIT_RANGE = {"min": "0", "max": "1"}
SHAPE = ALL - {"dissipation"}


def between(low: str, high: str) -> dict[str, str]:
    return {"min": low, "max": high}


def limacon(e: str) -> list[str]:
    return [f"(1 + ({e})*cos(phi))*cos(phi)", f"(1 + ({e})*cos(phi))*sin(phi)"]


def held(stated: StatedCurve, *constraints: str) -> StatedCurve:
    return stated._replace(constraints=tuple(map(parse, constraints)))


TWO, SIGN = ["cos(phi)**2 - sin(phi)**2", "2*cos(phi)*sin(phi)"], "e/sqrt(e**2)"
ONCE_OR_TWICE = [f"(1 + {SIGN})/2*({one}) + (1 - {SIGN})/2*({two})" for one, two in zip(CIRCLE, TWO, strict=True)]
OVAL = ["a*cos(phi)", "b*sin(phi)"]
AXES: dict[str, Any] = {"a": ABOVE_0, "b": ABOVE_0}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stated", "expected"),
    long_at(
        [1, 3, 6, *range(9, 13), 14, 15, 17, 19, 20, 24, 26, 27],
        [
            (curve(*OVAL, **AXES), ALL),
            (curve("a*cos(phi)", "-b*sin(phi)", **AXES), ALL),
            (curve(*OVAL, flow=["cos(phi)/a", "sin(phi)/b"], **AXES), ALL),
            (curve(*OVAL, flow=["-cos(phi)", "-sin(phi)"], **AXES), SHAPE),
            (curve(*OVAL, a=ABOVE_0, b={"min": "0", "max": None}), {"state_laws"}),  # a segment at b = 0
            (curve(*OVAL, a={"min": None, "max": None}, b=ABOVE_0), {"state_laws"}),
            (curve("a*cos(phi) + a/2", "b*sin(phi)", **AXES), ALL),
            (curve("a*cos(phi) + a", "b*sin(phi)", **AXES), ALL - {"origin", "dissipation"}),  # through 0
            (curve("a*cos(phi) + 2*a", "b*sin(phi)", flow=CIRCLE, **AXES), SHAPE - {"origin"}),
            (curve(*limacon("e"), e=between("-2/5", "2/5")), ALL),
            (curve(*limacon("e"), e=between("-99/100", "99/100")), ALL - {"convexity"}),
            (curve(*limacon("e"), e=between("0", "1")), {"state_laws"}),
            (curve(*limacon("e"), flow=CIRCLE, e=between("0", "3/2")), {"state_laws"}),  # an inner loop
            (held(curve(*limacon("p*q/2"), p=ABOVE_0, q=ABOVE_0), "p*q < 1"), ALL),
            (held(curve(*limacon("p*q/2"), p=ABOVE_0, q=ABOVE_0), "p*q <= 1"), ALL - {"convexity"}),
            (held(curve(*limacon("p*q/2"), p=ABOVE_0, q=ABOVE_0), "3*p*q < 2*2"), ALL - {"convexity"}),
            (held(curve(*limacon("p*q/2"), p=ABOVE_0, q=ABOVE_0), "p*q > 1"), {"state_laws"}),
            (curve(*limacon("p*q/2"), p=ABOVE_0, q=ABOVE_0), {"state_laws"}),
            (held(curve(*limacon("p*q/2"), p={"min": "-1", "max": None}, q=ABOVE_0), "p*q < 1"), {"state_laws"}),  # p q may be -9
            (curve(*CIRCLE, flow=["e*cos(phi)", "e*sin(phi)"], e=between("-1/1000000000000", "1")), SHAPE),
            (curve("cos(phi) + e", "sin(phi)", flow=CIRCLE, e=UNIT_RANGE), ALL - {"origin"}),
            (curve("cos(phi) + e", "sin(phi)", flow=CIRCLE, e=between("0", "1001/1000")), SHAPE - {"origin"}),
            (curve("e/cos(phi)", "sin(phi)", flow=CIRCLE, e=between("1", "2")), {"state_laws"}),  # T . d = e + sin(phi)^2
            (curve("cos(phi)*e/e", "sin(phi)", e=between("-1", "2")), {"state_laws"}),
            (curve("cos(phi) + 0*log(e)", "sin(phi)", e=between("-1", "2")), {"state_laws"}),
            (curve("a*cos(phi) + 0*sqrt(b - 1)", "b*sin(phi)", **AXES), {"state_laws"}),
            (curve("a**2*cos(phi)/norm(a*cos(phi), b*sin(phi))", "b**2*sin(phi)/norm(a*cos(phi), b*sin(phi))", **AXES), ALL),
            (
                curve("a*cos(phi)/norm(cos(phi), b)", "a*sin(phi)/norm(cos(phi), b)", a=ABOVE_0, b=UNIT_RANGE),
                {"state_laws"},
            ),  # 0/0 at b = 0
            (curve("where(m > 1, 3, 1)*cos(phi) + where(m > 1, 5, 0)", "sin(phi)", m=ABOVE_0), {"state_laws"}),  # it jumps
            (held(curve(*ONCE_OR_TWICE, e=between("-3", "3")), "e**2 > 1"), {"origin", "dissipation", "state_laws"}),  # of two parts
            (curve("a*(2*cos(phi) + abs(cos(phi)))", "a*sin(phi)", flow=CIRCLE, a=ABOVE_0), {"origin", "dissipation", "state_laws"}),
            (curve("a*abs(cos(phi))", "a*sin(phi)", flow=CIRCLE, a=ABOVE_0), {"state_laws"}),
        ],
    ),
)
def test_curves_of_known_shape_for_all_parameters(stated: StatedCurve, expected: set[str]) -> None:
    assert shown(stated) == expected


@pytest.mark.parametrize(
    ("boundary", "flow", "normal"),
    [
        (OVAL, ["cos(phi)/a", "sin(phi)/b"], True), (OVAL, ["b*cos(phi)", "a*sin(phi)"], True), (OVAL, CIRCLE, False),
        (OVAL, ["-cos(phi)/a", "-sin(phi)/b"], False), (OVAL, ["cos(phi)/a", "2*sin(phi)/b"], False), (OVAL, ["0", "0"], False),
        (["a*cos(phi)", "-b*sin(phi)"], ["cos(phi)/a", "-sin(phi)/b"], True),
        (["a*cos(phi)", "-b*sin(phi)"], ["-cos(phi)/a", "sin(phi)/b"], False),
        (OVAL, [f"({x})/1000000 + {y}" for x, y in zip(CIRCLE, ("cos(phi)/a", "sin(phi)/b"), strict=True)], False),
        (OVAL, ["cos(phi)**2/a", "cos(phi)*sin(phi)/b"], False),  # backward on one side
        (limacon("3/5"), ["0", "0"], False), (OVAL, ["cos(phi)/a + 0*log(a - 1)", "sin(phi)/b"], False),
    ],
)  # fmt: skip
def test_flows_along_the_normal(boundary: list[str], flow: list[str], normal: bool) -> None:
    stated = curve(*boundary, flow=flow, **AXES)
    assert bool(objection("normality", "parallel", frozenset({"convexity"}), stated, {})) is not normal


WEDGE = law_as_text(duhem.load("wedge"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changed", "expected"),
    long_but(
        [0, 3],
        [
            ({}, {"origin", "dissipation"}),
            ({"constraints": ["mu_alpha*tan_alpha < 1", "mu_beta*tan_beta < 2"]}, set()),
            ({"constraints": ["mu_alpha*tan_alpha <= 1", "mu_beta*tan_beta < 1"]}, set()),
            ({"constraints": ["mu_alpha*tan_alpha < 1"]}, set()),
            ({"flow": ["-cos(phi)", "-sin(phi)"]}, set()),
            ({"flow": ["cos(phi)", "-sin(phi)"]}, set()),
            ({"boundary": [WEDGE["boundary"][0] + " + 1/1000", WEDGE["boundary"][1]]}, set()),
        ],
    ),
)
def test_wedges_for_all_parameters(changed: dict[str, Any], expected: set[str]) -> None:
    stated, found = StatedCurve.read(WEDGE | changed), set[str]()
    for claim, rule in (("origin", "winding"), ("dissipation", "power")):
        with suppress(TooDearError), within(500_000):
            found |= set() if objection(claim, rule, frozenset(), stated, {}) else {claim}
    assert found == expected


def test_a_parameter_below_a_quotient_of_others_is_a_share_of_it() -> None:
    parameters: dict[str, Any] = {"p": ABOVE_0, "q": ABOVE_0, "r": between("1", "2")}
    plain = held(curve("p*cos(phi)", "q*sin(phi)", **parameters), "2*p*q*r < 3", "p > q").by_shares()
    assert sorted(plain.parameters) == ["q", "r", "share 0 of p"] and len(plain.constraints) == 1
    assert plain.parameters["share 0 of p"] == Bounds(Fraction(0), Fraction(1), True, True)
    place = {"share 0 of p": Fraction(1, 2), "q": Fraction(2), "r": Fraction(3, 2), "cosine of the angle": Fraction(1)}
    found = enclosed(plain.derivative(0)[0], {name: Enclosure.between(x, x) for name, x in place.items()})
    assert found.low <= UNIT * Fraction(1, 4) <= found.high  # 2 p q r = 3/2
    for constraint in ("p*q < 0", "p*q > 1", "p*q < r", "p**2*q**2 < 1", "p*q + p < 1", "r*(r - 3) < 1"):
        left = held(curve("p*cos(phi)", "q*sin(phi)", **parameters), constraint)
        assert left.by_shares() == left
