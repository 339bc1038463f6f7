"""Boundary curves of every shape: only what is true of them is proved, and each refuter is asked by itself."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import flint
import pytest

from duhem import Domain, InputError, Verdict, verify
from duhem.law.curve_law import ParametricCriterion
from duhem.proof.facts.curve_subject import CurveSubject, Greatest, NumericCurve
from duhem.proof.methods import curves
from duhem.proof.verdict import Evidence, Trust
from tests.long import long_but, mostly_long

C, S = "cos(phi)", "sin(phi)"
DOUBLE = (f"({C}**2 - {S}**2)", f"2*{C}*{S}")  # the circle, run twice


def limacon(e: str) -> tuple[str, str]:
    """r = 1 + e cos phi: simple for |e| < 1, convex for |e| <= 1/2, with its tangent never at rest for |e| < 1."""
    return (f"(1 + {e}*{C})*{C}", f"(1 + {e}*{C})*{S}")


NORMAL = (C, S)  # of a circle
CURVES: dict[str, tuple[tuple[str, str], tuple[str, str] | None, str]] = {
    # boundary, flow, and which claims are true (o c s n d)
    "circle": ((C, S), None, "ocsnd"),
    "circle with its normal": ((C, S), NORMAL, "ocsnd"),
    "circle with the inward normal": ((C, S), (f"-{C}", f"-{S}"), "ocs"),
    "circle with a turned flow": ((C, S), (f"{C} - {S}/10", f"{S} + {C}/10"), "ocsd"),
    "circle with a tangent flow": ((C, S), (f"-{S}", C), "ocsd"),
    "circle about a point inside": ((f"{C} + 1/2", S), None, "ocsnd"),
    "circle about a point outside": ((f"{C} + 3/2", S), None, "csn"),
    "circle about a point outside, with its normal": ((f"{C} + 3/2", S), NORMAL, "csn"),
    "circle run clockwise": ((C, f"-{S}"), None, "ocsnd"),
    "circle run twice": (DOUBLE, None, "ocsnd"),
    "ellipse": ((f"2*{C}", f"{S}/3"), None, "ocsnd"),
    "ellipse with the normal of a circle": ((f"2*{C}", S), NORMAL, "ocsd"),
    "limacon, convex": (limacon("2/5"), None, "ocsnd"),
    "limacon, dented": (limacon("3/5"), None, "osd"),
    "limacon, dented, with the normal of a circle": (limacon("3/5"), NORMAL, "osd"),
    "limacon with a loop": (limacon("3/2"), None, ""),
    "limacon with a loop, about a point beside it": ((f"(1 + 3/2*{C})*{C} - 3/2", limacon("3/2")[1]), None, "o"),  # its tangent turns twice
    "figure of eight": ((C, f"{C}*{S}"), None, ""),
    "diamond with its corners": ((f"{C}*abs({C})", f"{S}*abs({S})"), None, "ocnd"),
}
LETTERS = {"o": "origin", "c": "convexity", "s": "smoothness", "n": "normality", "d": "dissipation"}
DEAR = ("limacon with a loop", "circle with a turned flow", "circle with a tangent flow", "limacon, dented, with the normal of a circle")


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(CURVES, *(name for name in CURVES if name not in DEAR)))
def test_only_what_is_true_of_a_curve_is_proved(name: str) -> None:
    boundary, flow, true = CURVES[name]
    found = verify(ParametricCriterion(name, boundary, flow=flow), claims=[*LETTERS.values()])  # type: ignore[arg-type]
    proved = [letter for letter, claim in LETTERS.items() if found[claim].verdict is Verdict.PROVED]
    assert set(proved) <= set(true)
    assert {found[LETTERS[letter]].trust for letter in proved} <= {Trust.CHECKED}
    if name in ("circle with its normal", "circle about a point inside", "ellipse", "limacon, convex"):
        assert "".join(proved) == true


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(CURVES, "limacon, convex", "circle run twice"))
def test_a_curve_run_the_other_way_gets_the_same_verdicts(name: str) -> None:
    """T(-phi) with d(-phi) is the same law; so is T(phi + pi/2), which begins elsewhere."""
    boundary, flow, _ = CURVES[name]

    def turned(pair: tuple[str, str] | None, swap: Mapping[str, str]) -> tuple[str, str] | None:
        one, two = (re.sub(r"(cos|sin)\(phi\)", lambda found: swap[found[0]], text) for text in pair or ("", ""))
        return pair and (one, two)

    ways = ({C: C, S: f"(-{S})"}, {C: S, S: C}, {C: f"(-{C})", S: S})
    laws = [ParametricCriterion(name, turned(boundary, way), flow=turned(flow, way)) for way in ({C: C, S: S}, *ways)]  # type: ignore[arg-type]
    found = [{r.claim: (r.verdict, r.trust) for r in verify(law).results} for law in laws]
    assert found[1:] == found[:1] * 3


@pytest.mark.parametrize("word", ["cos(phi)*abs(cos(phi))", "max(cos(phi), -1)*cos(phi)**2", "cos(phi)**3 + pos(cos(phi))**3"])
def test_a_curve_whose_derivatives_may_jump_gets_a_verdict(word: str) -> None:
    """Its second derivative has parts to which no arithmetic here gives a meaning: nothing is said of its sign, and nothing breaks."""
    curve = ParametricCriterion("kinked", boundary=(f"m*{word}", "m*sin(phi)**3"), parameters={"m": Domain(positive=True)})
    assert verify(curve, claims="origin")["origin"].verdict is not Verdict.REFUTED


def _subject(boundary: tuple[str, str], flow: tuple[str, str] | None = None, **parameters: Domain) -> CurveSubject:
    return CurveSubject(ParametricCriterion("curve", boundary, parameters, flow=flow))  # type: ignore[arg-type]


def _turned(by: str, across: str = "1") -> tuple[str, str]:
    """A flow with these components along the tangent and the normal of the circle."""
    return f"({across})*{C} - ({by})*{S}", f"({across})*{S} + ({by})*{C}"


def test_why_a_curve_has_no_potential_here() -> None:
    reasons = {
        None: "no closed form found: the support function of K is known only along the curve, Phi = T . n at the normal n",
        NORMAL: "the law has its own flow direction, which does not derive from a potential of K",
    }
    for flow, reason in reasons.items():
        assert curves.duality(_subject((C, S), flow)) == Evidence(Verdict.NOT_APPLICABLE, "curve", reason)


REFUTERS = {
    "o": curves.origin_refuted,
    "c": curves.convexity_refuted,
    "d": curves.dissipation_refuted,
}


@pytest.mark.parametrize("name", ["circle", "circle with the inward normal", "circle about a point outside", "limacon, dented", "ellipse"])
def test_only_what_is_false_of_a_curve_is_refuted(name: str) -> None:
    boundary, flow, true = CURVES[name]
    for claim, refuter in REFUTERS.items():
        found = refuter(_subject(boundary, flow))
        assert (found is None) is (claim in true), claim
        assert found is None or (found.verdict is Verdict.REFUTED and found.witness is not None)


def test_what_is_said_of_a_violation() -> None:
    outside = curves.origin_refuted(_subject((f"{C} + 3/2", S)))
    assert outside is not None and (outside.method, outside.detail) == ("winding (interval)", "zero force is outside K")
    dent = curves.convexity_refuted(_subject(limacon("4/5")))
    assert dent is not None and dent.detail == "a triangle of boundary points holds a point outside K"
    power = curves.dissipation_refuted(_subject((C, S), (f"-{C}", f"-{S}")))
    assert power is not None and (power.method, power.detail) == ("witness-power", "force . flow is negative on the boundary")
    edge = curves.normality_refuted(_subject(limacon("4/5")))
    assert edge is not None and (edge.verdict, edge.method) == (Verdict.REFUTED, "witness-normal")
    assert edge.detail == "the normal is not in the normal cone at the edge of a dent"
    assert curves.normality_refuted(_subject(limacon("2/5"))) is None
    assert curves.normality_refuted(_subject(limacon("4/5"), NORMAL)) is None


PLACES = [Fraction(n, 5) for n in (-17, -4, -1, 0, 2, 5, 11)]


@pytest.mark.parametrize("across", [1, -1])
@pytest.mark.parametrize("t", PLACES)
def test_the_deviation_with_its_slope_and_second_derivative(across: int, t: Fraction) -> None:
    """Of a flow with tangential part 3 + sin phi and normal part 1 or -1: atan2(3 + sin phi, 1 or -1)."""
    value, slope, second = curves.deviation(_subject((C, S), _turned(f"3 + {S}", str(across))).at({}).at(t, 3))
    phi = 2 * math.atan(float(t))
    u, v, w = 3 + math.sin(phi), math.cos(phi), -math.sin(phi)
    size = 1 + u * u
    expected = (math.atan2(u, across), across * v / size, across * (w / size - 2 * u * v * v / size**2))
    assert [float(x.mid()) for x in (value, slope, second)] == pytest.approx(expected, abs=1e-9)
    assert all(float(x.rad()) < 1e-9 for x in (value, slope, second))


@pytest.mark.parametrize(
    ("by", "across", "angle"),
    [("1", "1", 45), ("-1", "1", -45), ("1", "-1", 135), ("-1", "-1", -135), ("1", "0", 90), ("-1", "0", -90), ("0", "1", 0)],
)
def test_a_deviation_by_so_many_degrees(by: str, across: str, angle: int) -> None:
    value, slope, second = curves.deviation(_subject((C, S), _turned(by, across)).at({}).at(Fraction(1, 3), 3))
    assert math.degrees(float(value.mid())) == pytest.approx(angle) and abs(slope) < 1e-9 and abs(second) < 1e-9


def test_a_deviation_that_jumps_or_has_no_meaning() -> None:
    backward = curves.deviation(_subject((C, S), (f"-{C}", f"-{S}")).at({}).at(Fraction(0), 3))
    assert float(backward[0].mid()) == pytest.approx(math.pi) and not backward[1].is_finite() and not backward[2].is_finite()
    slanted = curves.deviation(_subject((C, S), _turned(S, "-1")).at({}).over((Fraction(-1, 100), Fraction(1, 50)), 3))
    assert all(slanted[0].contains(flint.arb(math.pi - s)) for s in (0, 0.01, 0.05)) and not slanted[0].contains(flint.arb(2.6))
    none = curves.deviation(_subject((C, S), (f"0*{C}", f"0*{S}")).at({}).at(Fraction(0), 3))
    assert none[0].contains(flint.arb(0)) and none[0].contains(flint.arb(3)) and not none[0].contains(flint.arb(4))
    assert not none[1].is_finite() and not none[2].is_finite() and not none[0].contains(flint.arb(-0.5))


def test_neighbouring_arcs_are_one() -> None:
    f = Fraction
    assert curves._cluster(((f(0), f(1, 4)), (f(1, 4), f(1, 2)), (f(3, 4), f(1)))) == (0, f(1, 2))
    assert curves._cluster(((f(-1), f(-1, 2)), (f(1, 4), f(1, 2)), (f(1, 2), f(1)))) == (f(1, 4), 1)
    assert curves._cluster(((f(-1), f(-1, 2)), (f(-1, 4), f(-1, 8)))) == (f(-1, 4), f(-1, 8))
    assert curves._cluster(((f(-1, 2), f(0)), (f(0), f(1, 2)))) == (f(-1, 2), f(1, 2))
    later = (f(3, 4), f(1))
    for first, found in (((f(-1, 2), f(1, 2)), True), ((f(-1, 8), f(1, 4)), True), ((f(-1, 4), f(1, 8)), False)):
        assert curves._cluster((first, later)) == (first if found else later)


def test_the_greatest_deviation_and_where_it_is() -> None:
    found = curves.normality_by_deviation(_subject((C, S), _turned(f"(1 + {C}/2)*2/3")))
    assert found is not None and (found.verdict, found.method) == (Verdict.REFUTED, "deviation (interval)") and found.witness is not None
    assert found.detail == "the flow leaves the normal by 45 degrees at angle 0, and nowhere by more"
    turned = curves.normality_by_deviation(_subject((C, S), _turned(S)))
    assert turned is not None and turned.detail == "the flow leaves the normal by 45 degrees at angle 90, and nowhere by more"
    curve = _subject((C, S), _turned(f"({C}*3/5 + {S}*4/5)/2")).at({})
    worst = curve.greatest(curves.deviation, 3, 1e-9)
    assert worst is not None and math.tan(float(worst.value.mid())) == pytest.approx(0.5)
    assert curves._place(curve, worst) == pytest.approx(math.atan2(4, 3), abs=1e-6)
    for flow in (None, NORMAL):
        assert curves.normality_by_deviation(_subject((C, S), flow)) is None


def test_a_few_angles_show_whether_there_is_a_deviation() -> None:
    assert not curves._deviates(_subject((C, S), NORMAL), {})
    for flow in (
        _turned("1/100"),
        _turned("-1/100"),
        (f"-{C}", f"-{S}"),
        _turned(f"pos({S} - 4/5)"),
        _turned(f"pos({C} - 4/5)"),
        _turned(f"pos(-{S} - 4/5)"),
    ):
        assert curves._deviates(_subject((C, S), flow), {})


def test_where_the_flow_runs_backward_it_deviates() -> None:
    """Along the normal throughout, but turned round for angles of less than 66 degrees, or of more than 114."""
    for flow in ((f"({C} - 2/5)*{C}", f"({C} - 2/5)*{S}"), (f"(2/5 - {C})*{C}", f"(2/5 - {C})*{S}")):
        assert curves._deviates(_subject((C, S), flow), {})


@pytest.mark.long
def test_no_deviation_of_a_curve_that_is_not_simple() -> None:
    for boundary in (limacon("3/2"), DOUBLE, (C, f"{C}*{S}")):
        for flow in (_turned(S), ("1", "0")):
            assert curves.normality_by_deviation(_subject(boundary, flow)) is None
    ranged = _subject(limacon("e"), _turned("1"), e=Domain.between(0, "3/2"))
    found = curves.normality_by_deviation(ranged)
    assert found is None or (found.witness is not None and Fraction(found.witness.parameters["e"]) < 1)


def test_where_the_greatest_deviation_is_known_roughly(monkeypatch: pytest.MonkeyPatch) -> None:
    subject = _subject((C, S), _turned(f"(1 + {C}/2)*2/3"))
    greatest = NumericCurve.greatest
    for rough, bound in ((0.1, "than 48.1831"), (0.001, "than 45.0318"), (0.0, "")):

        def widened(curve: NumericCurve, *asked: Any, by: float = rough) -> Greatest | None:
            found = greatest(curve, *asked)
            return found and Greatest(found.value.union(found.value + by * flint.arb(5, 0) / 9), found.arcs)

        monkeypatch.setattr(NumericCurve, "greatest", widened)
        told = curves.normality_by_deviation(subject)
        assert told is not None and told.detail.partition("nowhere by more")[2].strip() == bound
    monkeypatch.setattr(NumericCurve, "greatest", lambda *_: None)
    assert curves.normality_by_deviation(subject) is None


def test_the_place_of_the_greatest_deviation_for_flows_turned_either_way() -> None:
    for sign in ("", "-"):
        curve = _subject((C, S), _turned(f"{sign}({C}*4/5 - {S}*3/5 + 2)/2")).at({})
        worst = curve.greatest(curves.deviation, 3, 1e-9)
        assert worst is not None and curves._place(curve, worst) == pytest.approx(-math.atan2(3, 4), abs=1e-7)


def test_a_violation_of_a_clockwise_curve_is_told_in_its_own_angle() -> None:
    """The angle of a witness and its coordinates are those of the law as it was given."""
    law = ParametricCriterion("clockwise", (C, f"-{S}"), flow=_turned(f"pos({S} - 4/5)"))  # type: ignore[arg-type]
    witness = verify(law)["normality"].witness
    assert witness is not None
    t = Fraction(witness.points["sigma"]["tan_half_phi"])
    low, high = (Fraction(x) for x in witness.values["sigma_a(sigma)"])
    assert low <= (1 - t * t) / (1 + t * t) <= high
    low, high = (Fraction(x) for x in witness.values["sigma_b(sigma)"])
    assert low <= -2 * t / (1 + t * t) <= high


@pytest.mark.slow
def test_a_flow_that_is_wrong_in_a_thin_range_of_a_parameter_is_refuted_there() -> None:
    found = verify(ParametricCriterion("thin", (C, S), {"e": Domain.between("-1e-20", 1)}, flow=(f"e*{C}", f"e*{S}")))  # type: ignore[arg-type]
    assert found["dissipation"].verdict is Verdict.REFUTED and found["convexity"].verdict is Verdict.PROVED
    touching = ParametricCriterion("touching", (C, S), {"e": Domain.between("-1e-20", 1)}, flow=(f"{C} + e", S))  # type: ignore[arg-type]
    assert verify(touching)["dissipation"].verdict is Verdict.PROVED  # force . flow = 1 + e cos phi >= 0


@pytest.mark.parametrize(("factor", "at"), [("sqrt(e)", "e = -1"), ("1/e", "e = 0"), ("log(e)", "e = 0")])
def test_a_curve_without_value_at_some_parameters_is_an_error(factor: str, at: str) -> None:
    law = ParametricCriterion("law", (f"{factor}*{C}", S), {"e": Domain.between(-1, 1)})  # type: ignore[arg-type]
    with pytest.raises(InputError, match=f"the boundary has no value at {at}; narrow"):
        verify(law)


@pytest.mark.parametrize("e", [pytest.param(Domain.between(1, 2), marks=pytest.mark.long), Domain.fixed(1)])
def test_a_pole_that_cancels_in_the_power_proves_nothing(e: Domain) -> None:
    """T . d = e + sin(phi)^2 wherever T has a value, which it has not at phi = pi/2."""
    law = ParametricCriterion("pole", (f"e/{C}", S), {"e": e}, flow=(C, S))  # type: ignore[arg-type]
    assert Verdict.PROVED not in {verify(law, claims=["origin", "dissipation"])[c].verdict for c in ("origin", "dissipation")}


def test_a_constraint_on_what_the_curve_does_not_hold_keeps_no_claim_open() -> None:
    law = ParametricCriterion("law", (C, S), {"b": Domain.between(1)}, constraints=("b > 4/b",))  # type: ignore[arg-type]
    assert {r.verdict for r in verify(law).results} == {Verdict.PROVED, Verdict.NOT_APPLICABLE}


def by_support(e: str, k: int) -> tuple[str, str]:
    """Its support function is 1 + e cos(k phi): h + h'' = 1 - (k^2 - 1) e cos(k phi), so that it is convex for e <= 1/(k^2 - 1)."""
    h, slope = {
        2: (f"(1 + {e}*(2*{C}**2 - 1))", f"(-2*{e}*2*{S}*{C})"),
        3: (f"(1 + {e}*(4*{C}**3 - 3*{C}))", f"(-3*{e}*(3*{S} - 4*{S}**3))"),
    }[k]
    return f"{h}*{C} - {slope}*{S}", f"{h}*{S} + {slope}*{C}"


@pytest.mark.long
@pytest.mark.parametrize(("k", "limit"), [(2, Fraction(1, 3)), (3, Fraction(1, 8))])
def test_a_fixed_parameter_is_no_weaker_than_its_range_however_near_the_limit(k: int, limit: Fraction) -> None:
    for gap in (Fraction(1, 10**9),):
        law = ParametricCriterion("near", by_support("e", k), {"e": Domain(low=0, high=limit - gap)})
        for found in (verify(law), verify(law, {"e": limit - gap})):
            assert {r.claim: str(r.trust) for r in found if r.claim != "duality"} == dict.fromkeys(
                ("origin", "convexity", "smoothness", "normality", "dissipation", "state_laws"), "checked"
            )
    beyond = ParametricCriterion("beyond", by_support("e", k), {"e": Domain(low=0, high=limit + Fraction(1, 10**4))})
    assert verify(beyond, claims=["convexity"])["convexity"].verdict is not Verdict.PROVED


@pytest.mark.slow
@pytest.mark.parametrize("share", long_but([2], ["1 - 2*cos(phi)", "cos(phi) + 1/2", "(cos(phi) - 1)**3"]))
def test_a_flow_that_points_into_k_is_not_in_the_normal_cone(share: str) -> None:
    """T . d < 0 at some angle, and zero force is in K."""
    law = ParametricCriterion("inward", (C, S), flow=(f"{C}*({share})", f"{S}*({share})"))
    found = {r.claim: r.verdict for r in verify(law, claims=["normality", "dissipation"])}
    assert found["normality"] is found["dissipation"] is Verdict.REFUTED


@pytest.mark.slow
@pytest.mark.parametrize("share", long_but([2], ["atan2(sin(phi), cos(phi))", "asin(2*cos(phi))", "log(sin(phi)**2)"]))
def test_a_flow_without_a_value_somewhere_ends_in_no_crash(share: str) -> None:
    law = ParametricCriterion("parted", (C, S), flow=(f"{C}*{share}", f"{S}*{share}"))
    found = {r.claim: r.verdict for r in verify(law, claims=["normality", "dissipation"])}
    assert found["normality"] is not Verdict.PROVED is not found["dissipation"]
