"""The proofs for boundary curves, each asked by itself, where it holds and where it does not: no refuter hides what they say."""

from __future__ import annotations

import pytest

from duhem import Domain, Verdict
from duhem.law.curve_law import ParametricCriterion
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.methods import curve_signs

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
    "figure of eight": ((C, f"{C}*{S}"), None, ""),
    "diamond with its corners": ((f"{C}*abs({C})", f"{S}*abs({S})"), None, "ocnd"),
}
LETTERS = {"o": "origin", "c": "convexity", "s": "smoothness", "n": "normality", "d": "dissipation"}


@pytest.mark.parametrize("claim", LETTERS, ids=LETTERS.values())
@pytest.mark.parametrize("name", CURVES)
def test_only_what_is_true_of_a_curve_is_proved(name: str, claim: str) -> None:
    boundary, flow, true = CURVES[name]
    found = getattr(curve_signs, LETTERS[claim])(CurveSubject(ParametricCriterion(name, boundary, flow=flow)))  # type: ignore[arg-type]
    assert found is None or claim in true


@pytest.mark.parametrize("name", ["circle with its normal", "circle about a point inside", "ellipse", "limacon, convex"])
def test_what_is_true_of_a_plain_one_is_proved(name: str) -> None:
    boundary, flow, true = CURVES[name]
    proved = []
    for claim in true:
        found = getattr(curve_signs, LETTERS[claim])(CurveSubject(ParametricCriterion(name, boundary, flow=flow)))  # type: ignore[arg-type]
        proved += [claim] if found is not None and found.verdict is Verdict.PROVED else []
    assert "".join(proved) == true


@pytest.mark.parametrize(("most", "true"), [("2/5", "ocsnd"), ("3/5", "osd"), ("99/100", "osd")])
def test_over_a_range_of_parameters(most: str, true: str) -> None:
    law = ParametricCriterion("limacon", limacon("e"), {"e": Domain.between(0, most)})  # type: ignore[arg-type]
    proved = [claim for claim, name in LETTERS.items() if getattr(curve_signs, name)(CurveSubject(law)) is not None]
    assert set(proved) <= set(true)
    assert "o" in proved and ("c" in proved) is ("c" in true)


@pytest.mark.parametrize(
    ("root", "analytic"), [("sqrt(2 + cos(phi))", True), ("sqrt(e + 1/10 + cos(phi)**2)", True), ("sqrt(e + 1 + cos(phi))", False)]
)
def test_a_root_of_what_may_be_zero_is_not_analytic(root: str, analytic: bool) -> None:
    law = ParametricCriterion("root", (f"{C}*{root}", f"{S}*{root}"), {"e": Domain.between(0, 1)})  # type: ignore[arg-type]
    assert (curve_signs.smoothness(CurveSubject(law)) is not None) <= analytic
    assert curve_signs._analytic(CurveSubject(law)) is analytic
