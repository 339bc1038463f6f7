"""Beside what a rule of the kernel shows, what it must not: each pair differs where one of the rule's conditions is wanting."""

from __future__ import annotations

from fractions import Fraction
from math import prod
from typing import Any

import pytest

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.constant_value import _OF_ATANH, _OF_COS, _OF_EXP, _OF_SIN, BITS, Enclosure, _series
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.curve import _COSINE, _SINE, _along_half
from duhem.proof.kernel.definedness import sign_on_axis
from duhem.proof.kernel.dents import dents
from duhem.proof.kernel.deviatoric import deviatoric_readers
from duhem.proof.kernel.identity import vanishes
from duhem.proof.kernel.plane_gauge import above_zero_along_rays
from duhem.proof.kernel.signs import RealRoot
from duhem.proof.kernel.simpler_laws import in_principal_stresses
from duhem.proof.kernel.state import convex_in_each_variable
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import parse
from tests.oracles import drawn_formulas
from tests.proof.test_kernel_facts import domain, said

UNIT = 1 << BITS
PARAMETERS = {
    "q": {"min": "-1", "max": "1"},
    "n": {"min": "1", "max": "2"},
    "m": {"positive": True},
    "e": {"min": "0", "max": "1/2"},
}


def confirmed(claim: str, rule: str, g: str, evidence: Any = None, settled: str = "origin", forces: str = "abp", **more: Any) -> bool:
    given = {"forces": [*forces], "pressure": None, "parameters": PARAMETERS, "constraints": [], "g": g, "flow": None, **more}
    return not objection(claim, rule, frozenset(settled.split()), StatedLaw.read(given), evidence or {})


# -- numbers -----------------------------------------------------------------------------------------------------------


def test_what_a_series_leaves_out_is_allowed_for_on_both_sides() -> None:
    assert {_series(Enclosure(0, 0), shares) for shares in (_OF_EXP, _OF_COS, _OF_SIN, _OF_ATANH)} == {(UNIT - 1, UNIT + 1)}


# -- regions -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("g", "right"),
    [
        ("max(norm(a, b) + 0*p**n - 1, -p)", True),
        ("max(norm(a, b) + 0*p**q - 1, -p)", False),  # no value at p = 0, where K has points
        ("max(2*norm(a, b) - 1 + 0*p**q, -p)", False),
        ("max((norm(a, b) + 0*p**q)*m - 1, -p)", False),
        ("max((norm(a, b)/p)**n - 1, -p)", True),
        ("max((abs(a)/p)**n - p, -p)", False),
        ("max((abs(a)/p)**n + b - 1, -p)", False),
        ("max((abs(a)/p)**(n/2) + p - 1, -p)", False),
        ("max((abs(a)/abs(p))**n + p - 1, -p)", False),
        ("max((a/p)**n + p - 1, -p)", False),
        ("max((norm(a, b)/p)**n*(a/p) - 1, -p)", False),
        ("max(a**2/p + b**2 - m, -p)", True),
        ("max(a**3/p + b**2 - m, -p)", False),
        ("max(a**2/p**2 + b**2 - m, -p)", False),
        ("max(-a**2/p + b**2 - m, -p)", False),
        ("max(norm(a, b) - p*(1 - p)**(1/2), -p, p - 1)", True),  # a weighted mean of p and p (1 - p)
        ("max(norm(a, b) - (1 - p)**e*p, -p, p - 1)", True),
        ("max(norm(a, b) - p*(1 - p**2)**e, -p, p - 1)", True),
        ("max(norm(a, b) - p*(1 - p)**(3/2), -p, p - 1)", False),
        ("max(norm(a, b) - p*(1 - p**2)**n, -p, p - 1)", False),
        ("max(norm(a, b) - p*(1 - p)**e, -p, p - 2)", False),  # no value beyond 1
        ("max(norm(a, b) - p*(1 - p)**e, p - 1)", False),
        ("max(norm(a, b) + p*(1 - p)**e, -p, p - 1)", False),
        ("sqrt(a**2 + a*b + b**2 + p + p**2 + m + 1) - 3 - m", True),
        ("sqrt(a**2 + 3*a*b + b**2 + m) - 1 - m", False),
        ("max(a**2 - b*p, -b, -p)", True),
        ("max((a**2 - 1)**2 - b*p, -b, -p)", False),  # an even power of what is convex and may be < 0
        ("max(a**3 - b*p*(b + p), -b, -p)", True),
        ("max((1 - a**2)**3 - b*p*(b + p), -b, -p)", False),
        ("max(a**2 - b*p*(b + p), -b, -p)", False),
        ("2*max(norm(a, b) - p - 1, p - 1)*3", True),
        ("2*max(norm(a, b)*p - 1, p - 1, -p)", False),
        ("2*max(norm(a, b) - p - 1, p - 1)*(a - 3)", False),
        ("2*max(norm(a, b) - p - 1, p - 1)*q", False),
        ("(-2)*max(norm(a, b) - p - 1, p - 1)", False),
        ("max(norm(a, b) - sqrt((p**2 - p)/(-1)), -p, p - 1)", True),
        ("max(norm(a, b) - sqrt(p)*sqrt(1 - p), -p, p - 1)", True),
        ("max(norm(a, b) - sqrt(p)*sqrt(1 - p), -p, p - 2)", True),
        ("max(norm(a, b) - sqrt((p**2 - p)/(-1)), -p)", False),
        ("max(where(a > 0, a, -2*a) + abs(b) - sqrt(p*(1 - p)), -p, p - 1)", True),  # in its normal form
        ("max(where(a > 0, -a, 2*a) + abs(b) - sqrt(p*(1 - p)), -p, p - 1)", False),
        ("max(where(a > 0, a, 1 - a) + abs(b) - sqrt(p*(1 - p)), -p, p - 1)", False),  # it jumps
        ("max(where(a > 0, a, -2*a) + abs(b) - sqrt(p*(1 - p)), -p, p - 2)", False),
    ],
)
def test_where_loads_allow(g: str, right: bool) -> None:
    assert confirmed("convexity", "composition", g) is right


@pytest.mark.parametrize(
    ("g", "right"),
    [
        ("max(norm(a, b) - sqrt(p*(1 - p)), -p, p - 1)", True),
        ("max(norm(a, b) - 2*pos(p - p**2)**(2/3), -p, p - 1)", True),
        ("max(norm(a + b, 2*b) - m*(p*(1 - p))**(n/4), -p, p - 1)", True),
        ("max(norm(a, b) - (p*(1 - p)*(2 - p))**(1/3), -p, p - 1)", True),
        ("max(norm(a, b) - (p*(1 - p)*(1 - p))**(1/3), -p, p - 1)", False),
        ("max(norm(a, b) - p*(1 - p), -p, p - 1)", False),  # tips
        ("max(norm(a, b) - (p*(1 - p))**(n/2), -p, p - 1)", False),
        ("max(norm(a, b) - (p*(1 - p))**e, -p, p - 1)", False),
        ("max(abs(a) + abs(b) - sqrt(p*(1 - p)), -p, p - 1)", False),  # edges
        ("max(norm(a, b) + abs(a) - sqrt(p*(1 - p)), -p, p - 1)", False),
        ("max(norm(a, b) - sqrt(p*(2 - p)), -p, p - 1)", False),  # an end that is a disc
        ("max(norm(a, b) - sqrt(p), -p, p - 1)", False),
        ("max(norm(a, b) - sqrt(p*(1 - p)), -p, p - 1, a - 1/10)", False),  # cut
        ("max(norm(a, b) - sqrt(p*(1 - p)), -p, p - 1, -2*p)", False),
        ("max(norm(a, b) + 1/10 - sqrt(p*(1 - p)), -p, p - 1)", False),
        ("max(norm(a, b) - sqrt(min(p, 2 - 2*p)*(1 + p)), -p, p - 1)", False),  # a kink between the ends
        ("max(norm(a, b) + sqrt(p*(1 - p)), -p, p - 1)", False),
        ("max(norm(a, b) - q*sqrt(p*(1 - p)), -p, p - 1)", False),
    ],
)
def test_what_is_round_at_its_ends(g: str, right: bool) -> None:
    assert confirmed("smoothness", "composition", g, {"inside": {"p": "1/2"}}) is right


# -- tensors -------------------------------------------------------------------------------------------------------------


MEAN = "(a + b + c)/3"
J2 = "(((a - b)**2 + (b - c)**2 + (c - a)**2)/6 + u**2 + v**2 + w**2)"
J3 = f"((a - {MEAN})*((b - {MEAN})*(c - {MEAN}) - u**2) - w*(w*(c - {MEAN}) - u*v) + v*(w*u - (b - {MEAN})*v))"
EIG = "eigmax(a, b, c, u, v, w)"


@pytest.mark.parametrize(
    ("g", "isotropic"),
    [
        (f"{J2} - 1", True),
        (f"-{J3} - 2*{J2} - 1", True),
        (f"(a + b + c)**2 - {J2}*(-1) - (u**2 + v**2 + w**2 + (a*a + b*b + c*c)/2)*2 - m", True),
        (f"{EIG} - eigmax(-a, -b, -c, -u, -v, -w)*(-2) - m", True),
        ("(-3)*(u**2 - b*c + v**2 - a*c + w**2 - a*b) + 0*u - 1", True),
        ("(-3)*(u**2 - b*c + v**2 - a*c + w**2 - a*b) - 1", True),
        (f"{J2} + u**2 - 1", False),
        (f"{J2} - u*v*w - 1", False),
        ("eigmax(a, b, c, u, w, v) - m", True),  # in another order
        ("eigmax(a, b, c, u, v, -w) - m", False),
        ("eigmax(a, b, c, u, v, 0) - m", False),
        ("eigmax(a, b, 2*c, u, v, w) - m", False),
        ("a + b - m", False),
        ("-(a + b + c) - m", True),
    ],
)
def test_a_law_in_principal_stresses_has_the_value_without_shear(g: str, isotropic: bool) -> None:
    given = {"forces": [*"abcuvw"], "pressure": None, "parameters": PARAMETERS, "constraints": [], "g": g, "flow": None}
    found = in_principal_stresses(StatedLaw.read(given))
    assert (found is not None) is isotropic
    for at in ({"a": 1.0, "b": -2.0, "c": 3.5}, {"a": -4.0, "b": -2.0, "c": 0.25}) if found else ():
        here = {**at, "m": 0.7, "u": 0.0, "v": 0.0, "w": 0.0}
        assert found is not None and found.forces == ("a", "b", "c") and not found.g.names() & {*"uvw"}
        assert drawn_formulas.value(found.g, here) == pytest.approx(drawn_formulas.value(parse(g), here), abs=1e-9)


# -- signs of numbers with roots ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "sign"),
    [
        ("sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6))", ZERO),
        ("sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6)) + 1/10**80", POSITIVE),
        ("sqrt(5 + 2*sqrt(6)) - sqrt(2) - sqrt(3) - 1/10**80", NEGATIVE),
        ("(2 + sqrt(5))**(1/3) - (sqrt(5) - 2)**(1/3) - 1", ZERO),
        ("1 - (2 + sqrt(5))**(1/3) + (sqrt(5) - 2)**(1/3) - 1/10**70", NEGATIVE),
    ],
)
def test_the_sign_of_a_number_with_roots_is_a_fact_of_it(text: str, sign: int) -> None:
    known = over(StatedLaw.read({"forces": ["a"], "pressure": None, "parameters": {}, "constraints": [], "g": "a", "flow": None})).facts(
        parse(text)
    )
    assert known.defined and known.sign == sign


@pytest.mark.parametrize(
    ("text", "sign"),
    [
        ("exp(q) - q - 1/2", POSITIVE), ("exp(q) - q - 5/4", ANY), ("cos(q) - q**2/3", POSITIVE), ("cos(q) - 3*q**2/5", ANY),
        ("cos(q)*q + 6/5 - q", POSITIVE), ("q - exp(q) + 1/2", NEGATIVE), ("q - exp(q) + 5/4", ANY),
    ],
)  # fmt: skip
def test_the_sign_between_corners_of_a_range_is_asked_too(text: str, sign: int) -> None:
    """exp(q) - q - 5/4 is > 0 at both ends of q, and < 0 at q = 0."""
    assert domain().facts(parse(text)).sign == sign


# -- support functions -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("g", "potential", "right"),
    [
        ("norm(a, b) - m", "m*norm(x, y)", True),
        ("norm(a, b) - m", "m*norm(x, y) + norm(x, 2*y)", False),
        ("norm(a, b) - m", "m*norm(x, y) - m*norm(x, y) + m*norm(x, y)", False),
        ("a**2 + b**2 - m**2", "m*norm(x, y)", True),
        ("a**2 + b**2 - m**2", "m*norm(x, y) + m*norm(x, y)", False),
        ("2*a**2 + b**2 - m**2", "m*norm(x/sqrt(2), y)", True),
        ("2*a**2 + b**2 - m**2", "m*norm(x, y)", False),
        ("2*a**2 + b**2 - m**2", "-m*norm(x/sqrt(2), y)", False),
        ("2*a**2 + b**2 - m**2", "m*abs(x/sqrt(2))", False),
        ("max(a, -a, b, -b) - m", "m*(abs(x) + abs(y))", True),
        ("min(a, -a, b, -b) - m", "m*(abs(x) + abs(y))", False),
        ("min(abs(a), abs(b)) - m", "m*(abs(x) + abs(y))", False),
        ("min(norm(a), norm(b)) - m", "m*(abs(x) + norm(y))", False),
        ("a**2 + a*b + b**2 - m**2", "m*sqrt((x**2 - x*y + y**2)*4/3)", True),
        ("a**2 + a*b + b**2 - m**2", "m*sqrt((x**2 + x*y + y**2)*4/3)", False),
        ("a**2 + a*b + b**2 - m**2", "m*norm(x - y/2, y*sqrt(3)/2)*2/sqrt(3)", True),
        ("max(a, -a, b, -b) - m", "m*max(x + y, x - y, y - x)", False),
        ("max(a, -a, b) - m", "m*max(x + y, y - x)", False),  # unbounded
        ("max(a, -a, b, -b) - m", "m*max(x + y, x - y, y - x, -x - y, 2*x)", False),
        ("max(abs(a), abs(b)) - m", "m*min(abs(x) + abs(y), 3*abs(x) + 3*abs(y))", False),
        ("abs(a)**3 + abs(b)**3 - 1", "(abs(x)**(3/2) + abs(y)**(3/2))**(2/3)", True),
        ("abs(a)**3 + abs(b)**3 - 1", "(abs(x)**3 + abs(y)**3)**(1/3)", False),
        ("abs(a)**3 + abs(b)**3 - 1", "(abs(x)**(3/2) + abs(y)**(3/2))**(1/3)", False),
    ],
)
def test_what_is_a_support_function(g: str, potential: str, right: bool) -> None:
    evidence = {"potential": potential, "slips": {"a": "x", "b": "y"}, "flat": []}
    assert confirmed("duality", "polar-gauge", g, evidence, forces="ab") is right


# -- fans --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("g", "convex", "smooth"),
    [
        ("where(a > 0, norm(a, b), norm(2*a, b)) - 1", True, True),
        ("where(a > 0, norm(a, b), norm(2*a, b)) + 1", False, False),
        ("where(a > 0, norm(a, b), norm(2*a, b)) - m", True, True),
        ("where(a > 1, norm(a, b), norm(2*a, b)) - 1", False, False),
        ("where(a > -1, norm(a, b), norm(2*a, b)) - 1", False, False),
        ("where(0*a > 0, norm(a, b), norm(2*a, b)) - 1", False, False),
        ("where(a > 0, norm(a, b) - 1, norm(2*a, b) - 2)", False, False),
        ("where(a > 0, norm(a, b), norm(2*a, b))**2 - 1", False, False),
        ("where(a > 0, norm(a, b) - norm(a, b)**2, norm(2*a, b))", False, False),
        ("where(abs(a) <= abs(b), 2*abs(b), abs(a)) - 1", False, False),  # it jumps
    ],
)
def test_a_fan(g: str, convex: bool, smooth: bool) -> None:
    assert confirmed("convexity", "fan", g, forces="ab") is convex
    assert confirmed("smoothness", "fan", g, forces="ab") is smooth


# -- where loads are 0 -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("where(a > 0, e*a**2, 0)", ">= convex"),  # 0 where e is
        ("where(a > 0, m*a**p, 0)", ">= convex"),
        ("where(0 < a, 3*a**(1/2), 0)", ">= concave quasiconvex"),
        ("where(a > 0, a*(1 + log(a)), 0)", "? convex"),
        ("where(a > 0, -a*log(a)*m, 0)", "? concave"),
        ("where(a > 0, a**(1/2)*log(a), 0)", "?"),
        ("where(a > 0, 3*a**k, 0)", ">= undefined"),  # it grows without end
        ("where(a > 0, a*log(a)*a**(-1), 0)", "? undefined"),
        ("where(a > 0, m*a**e, 0)", ">= undefined"),  # it jumps where e is 0
        ("where(a > 0, 3*a**(1/2), 1)", ">= undefined"),
        ("where(a > 1, 3*a**(1/2), 0)", ">= undefined"),
        ("where(a > 0, 3*b*a, 0)", "? undefined"),
    ],
)
def test_what_is_closed_where_a_load_ends(text: str, expected: str) -> None:
    assert said(domain({"a": False}).facts(parse(text))) == expected


def test_an_odd_power_of_what_has_either_sign_is_no_size() -> None:
    assert not domain().facts(parse("((a + b)**3 + 4*abs(a)**3 + 4*abs(b)**3)**(1/3)")).convex  # 0 on a ray, like (a - b)**(2/3)
    assert domain().facts(parse("((a + b)**4 + 4*abs(a)**4 + 4*abs(b)**4)**(1/4)")).convex


@pytest.mark.parametrize(
    ("g", "above"),
    [
        ("a**2 + b**2", True), ("a**2 + b**2 - a*b", True), ("norm(a, b) + abs(a)**3", True), ("abs(a) + abs(b)", True),
        ("(a - b)**2", False), ("a**2", False), ("(abs(a) - abs(b))**2", False), ("norm(a, b) - a", False), ("norm(a, b) - 1", False),
        ("a**2 + 0*b", False),
    ],
)  # fmt: skip
def test_what_is_above_zero_along_all_rays(g: str, above: bool) -> None:
    given = {"forces": ["a", "b"], "pressure": None, "parameters": {}, "constraints": [], "g": g, "flow": None}
    assert above_zero_along_rays(StatedLaw.read(given)) is above


@pytest.mark.parametrize(
    ("g", "tip", "sign"),
    [
        ("J2 - m", "J2", NEGATIVE), ("m - J2", "J2**2 + J2*norm(a - b, b - c, c - a)**2", POSITIVE),
        ("J2 - m", "4*J2**3 - 27*J3**2", ANY),  # 0 where two of the principal values are equal too
        ("J2 - m", "J2 - 1", ANY), ("J2 - a", "J2", ANY),
    ],
)  # fmt: skip
def test_the_sign_on_the_axis_is_asked_where_nothing_else_is_on_it(g: str, tip: str, sign: int) -> None:
    given = {"forces": ["a", "b", "c"], "pressure": None, "parameters": PARAMETERS, "constraints": [], "g": without_shear(g), "flow": None}
    law = StatedLaw.read(given)
    assert sign_on_axis(law.g, parse(without_shear(tip)), over(law)) == sign


def without_shear(text: str) -> str:
    swap = {"J2": "(((a - b)**2 + (b - c)**2 + (c - a)**2)/6)", "J3": "((2*a - b - c)*(2*b - c - a)*(2*c - a - b)/27)"}
    return text.replace("J2", swap["J2"]).replace("J3", swap["J3"])


# -- identities --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "zero"),
    [
        ("(a**2)**(1/2) - a", False), ("(a**2)**(1/2) + a", False), ("(a**4)**(1/4) + a", False),
        ("(s**4)**(1/4) + s", True), ("(s**4)**(1/4) - s", False), ("(m**4)**(1/4) - m", True), ("(m**4)**(1/4) + m", False),
        ("(q**6)**(1/6) - q", False), ("(q**6)**(1/6) + q", False),
    ],
)  # fmt: skip
def test_a_root_of_an_even_power_is_the_size(text: str, zero: bool) -> None:
    """s < 0 < m; a and q may have either sign."""
    assert vanishes(parse(text), domain()) is zero


@pytest.mark.parametrize("side", [1, -1])
def test_cosine_and_sine_by_the_tangent_of_half_the_angle(side: int) -> None:
    """With c = side (1 - t^2)/(1 + t^2), s = side 2 t/(1 + t^2), the terms keep their proportion whatever their degrees."""
    x, y, f = parse("c"), parse("s"), Fraction
    poly = {((x, 2),): f(1), ((y, 1),): f(-3), ((x, 1), (y, 1)): f(2), (): f(1, 2), ((x, 3), (y, 1)): f(5)}
    found = _along_half({tuple((_COSINE if z == x else _SINE, n) for z, n in m): k for m, k in poly.items()}, side)
    for t in (Fraction(1, 3), Fraction(-2, 5), Fraction(1)):
        at = {x: side * (1 - t * t) / (1 + t * t), y: side * 2 * t / (1 + t * t)}
        value = sum(k * prod(at[z] ** n for z, n in m) for m, k in poly.items())
        assert sum(k * prod(t**n for _, n in m) for m, k in found.items()) == value * (1 + t * t) ** 4


# -- choices where the deviator is 0 -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("condition", "away", "here"),
    [
        ("J2 > 0", "sqrt(J2) + J3/(9*J2)", "0"), ("J2 > 0", "J3/J2", "0*a"), ("J2 > 0", "J3**2/J2**2", "J2"),
        ("J2 > 0", "J3/J2**(5/4)", "0"), ("0 < J2", "J3/J2", "sqrt(J2)"), ("J2 <= 0", "J3/J2", "0"), ("J2**2 <= 0", "J3/J2", "J2"),
    ],
)  # fmt: skip
def test_a_choice_where_the_deviator_is_0_is_what_is_chosen_elsewhere(condition: str, away: str, here: str) -> None:
    found, values = _read(away), (here, away) if "<=" in condition else (away, here)
    assert found is not None and _read(f"where({condition}, {', '.join(values)})") == found


@pytest.mark.parametrize(
    "choice",
    [
        "where(J2 > 0, J3/J2, 1)", "where(J2 > 0, J3/J2, m)", "where(J2 > 0, J3/J2, a)",  # not 0 where J2 is
        "where(J2 > 0, J3**2/J2**3, 0)", "where(J2 > 0, m, 0)", "where(J2 > 0, 1/J2, 0)",  # no limit, another, none
        "where(J2 >= 0, J3/J2, 0)", "where(J2 < 0, 0, J3/J2)", "where(J2 > 1, J3/J2, 0)", "where(J3 > 0, J3/J2, 0)",
        "where(a > 0, J3/J2, 0)",
    ],
)  # fmt: skip
def test_another_choice_is_no_function_of_the_deviator(choice: str) -> None:
    assert _read(choice) is None


def _read(text: str) -> Any:
    given = {"forces": ["a", "b", "c"], "pressure": None, "parameters": PARAMETERS, "constraints": [], "flow": None}
    law = StatedLaw.read({**given, "g": without_shear("J2 + J3 - m")})
    return deviatoric_readers(law.g, over(law))[0].value(parse(without_shear(text)))


# -- energies ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("energy", "convex"),
    [
        ("u**2 + v**2", True), ("u**2*v**2", True), ("u*v", True), ("exp(u*v)", True), ("-u**2", False), ("u**2*v", False),
        ("u**2 + abs(v)", False), ("u**2 - log(v)", False),  # it has no slope everywhere, or no value
    ],
)  # fmt: skip
def test_an_energy_that_is_convex_in_each_variable(energy: str, convex: bool) -> None:
    variables = {"u": {"force": "a"}, "v": {"force": "b"}}
    given = {"forces": ["a", "b"], "pressure": None, "parameters": {"u": {}, "v": {}}, "constraints": [], "g": "a + b", "flow": None}
    assert convex_in_each_variable(StatedLaw.read({**given, "variables": variables, "energy": energy})) is convex


# -- spellings ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("g", "as_written", "otherwise"),
    [
        ("norm(a, b) - m", True, True), ("where(a > 0, a, -a) + abs(b) - m", False, True),
        ("where(a > 0, 2*a, a) + abs(b) - m", False, True),
        ("where(a > 0, a, 2*a) + abs(b) - m", False, False), ("where(a > 0, a, 0) - abs(b) - m", False, False),
    ],
)  # fmt: skip
def test_what_is_asked_of_the_text_is_not_shown_by_a_normal_form(g: str, as_written: bool, otherwise: bool) -> None:
    given = {"forces": ["a", "b"], "pressure": None, "parameters": PARAMETERS, "constraints": [], "g": g, "flow": None}
    law = StatedLaw.read(given)
    shown = [not objection("convexity", "composition", frozenset(), law, {}, said) for said in (True, False, None)]
    assert shown == [as_written, otherwise, as_written or otherwise]


# -- dents ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("g", "convex", "dented"),
    [  # rho (1 + e cos 3 theta)^(1/k) is convex for |e| <= k/(9 - k), k <= 3
        ("sqrt(J2) + Q*J3/J2 - 1", "1/4", "2/5"), ("sqrt(J2) + Q*J3/J2 - 1", "-1/4", "-2/5"), ("J2 + Q*J3/sqrt(J2) - 1", "5/7", "7/9"),
        ("J2**(3/2) + Q*J3 - 1", "9/7", "4/3"), ("J2**(3/2) + Q*J3 - 1", "-9/7", "-4/3"),
        ("J2**3 - Q*J3**2 - 1", "11/5", "7/3"), ("J2**3 - Q*J3**2 - 1", "-10/3", "-7/2"),  # Drucker (1949): -27/8 to 9/4
    ],
)  # fmt: skip
def test_a_function_of_the_deviator_has_dents_where_its_root_of_degree_1_is_not_convex(g: str, convex: str, dented: str) -> None:
    assert not _is_dented(g, convex) and _is_dented(g, dented)


def _is_dented(g: str, q: str) -> bool:
    given = {"forces": ["a", "b", "c"], "pressure": None, "parameters": {}, "constraints": [], "flow": None}
    law = StatedLaw.read({**given, "g": without_shear(g).replace("Q", f"({q})")})
    return any(dent.at(RealRoot.of(Fraction(k, 8))) for dent in dents(law, "sector") for k in range(9))
