"""Polynomials with square roots: what they are made plain to has their value, so has their slope, and their signs are true."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import pytest

from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.plane_function import Signs, plain, roots_in, slope_along, sqrt
from duhem.proof.kernel.polynomial import Polynomial, written
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, parse
from tests.oracles import drawn_formulas

F = Fraction
PARAMETERS = {"m": {"positive": True}, "e": {"min": "0", "max": "1/2"}, "q": {"min": "-1", "max": "1"}}
AT = {RAY.name: 0.37, "m": 1.7, "e": 0.3, "q": -0.6}


def domain() -> StatedDomain:
    given: dict[str, Any] = {"forces": ("a", "b"), "pressure": "s", "parameters": PARAMETERS, "constraints": []}
    return over(StatedLaw.read({**given, "g": "a", "flow": None}))


def poly(text: str) -> Polynomial:
    return domain().polynomial(parse(text).put({parse("t"): RAY}))


def value(found: Polynomial, at: Mapping[str, float] = AT) -> float:
    return drawn_formulas.value(written(found), at)


@pytest.mark.parametrize(
    ("number", "terms"),
    [
        (F(0), 0), (F(1), 0), (F(9), 0), (F(4, 9), 0), (F(12), 1), (F(3, 4), 1), (F(2, 3), 2), (F(17), 1), (F(289), 0), (F(34), 2),
        (F(169, 2), 1),
        (F(8), 1), (F(360), 2), (F(19 * 19, 25), 0), (F(1, 17), 1), (F(30030), 6), (F(51), 2), (F(85), 2), (F(119), 2), (F(187), 2),
        (F(221), 2), (F(10**30), 0), (F(10007), 1),
    ],
)  # fmt: skip
def test_roots_of_numbers(number: F, terms: int) -> None:
    found = sqrt({(): number} if number else {})
    assert value(found) == pytest.approx(math.sqrt(number), rel=1e-14)
    assert [len(m) for m in found] == ([terms] if number else []) and all(n == 1 for m in found for _, n in m)
    with pytest.raises(NotWritten):
        sqrt({(): F(-1)})


@pytest.mark.parametrize(
    "text",
    [
        "sqrt(2)*sqrt(2)", "sqrt(12)*sqrt(3)", "sqrt(1 + t)**2", "sqrt(1 + t)**3*t", "sqrt(1 + t)**4 + sqrt(m)**5", "sqrt(8)/sqrt(2)",
        "1/sqrt(2)", "sqrt(2)**-3",
        "sqrt(1 + t)*sqrt(2 + t)", "sqrt(m + t**2)**2*sqrt(3)**3", "sqrt(0.5) + sqrt(4.5)", "1/sqrt(1 + t)", "sqrt(2)*sqrt(3)*sqrt(6)",
        "q*sqrt(18)*t + 1",
    ],
)  # fmt: skip
def test_what_is_made_plain_keeps_its_value(text: str) -> None:
    found = plain(poly(text), domain())
    assert value(found) == pytest.approx(value(poly(text)), rel=1e-13)
    assert all(n == 1 or (n < 0 and x.args[0].op != "number") for m in found for x, n in m if x in roots_in(found))


@pytest.mark.parametrize(
    "text",
    [
        "t**3 - 2*t",
        "sqrt(1 + t)",
        "t*sqrt(m + t**2)",
        "1/sqrt(1 + t)",
        "sqrt(1 + t)*sqrt(2 + 3*t**2)",
        "sqrt(2)*t**2 + sqrt(m)",
        "q",
        "sqrt(1 + t)**3",
    ],
)
def test_slopes(text: str) -> None:
    found, h = poly(text), 1e-6
    after, before = (value(found, {**AT, RAY.name: AT[RAY.name] + way}) for way in (h, -h))
    assert value(slope_along(found, domain())) == pytest.approx((after - before) / (2 * h), rel=1e-7, abs=1e-8)


@pytest.mark.parametrize(
    ("text", "weakly", "strictly"),
    [
        ("0*t", True, False), ("1 + t", True, True), ("t", True, False), ("t - 1/2", False, False), ("sqrt(1 + t)", True, True),
        ("-sqrt(1 + t)", False, False),
        ("sqrt(1 + t) - 1", True, False), ("sqrt(1 + t) - 1/2", True, True), ("sqrt(1 + t) - 1.001", False, False),
        ("sqrt(2) - sqrt(1 + t)", True, False),
        ("sqrt(2.001) - sqrt(1 + t)", True, True), ("sqrt(1.999) - sqrt(1 + t)", False, False), ("2 - sqrt(1 + t)", True, True),
        ("t*sqrt(1 + t)", True, False),
        ("t + sqrt(t**2 + m)", True, True), ("sqrt(t**2 + m) - t", True, True), ("sqrt(t**2 + e) - t", True, False),
        ("sqrt(t**2 + m) - t - m", False, False),
        ("1/sqrt(1 + t) - 1/2", True, True), ("1/sqrt(1 + t) - 3/4", False, False), ("1 - 1/sqrt(1 + t)", True, False),
        ("q*sqrt(1 + t) + 2", True, True),
        ("q*sqrt(1 + t) + 1", False, False), ("sqrt(1 + t)*sqrt(2 + t) - 1 - t", True, True),
        ("sqrt(1 + t)*sqrt(2 + t) - 2 - t", False, False),
        ("sqrt(1 + t) + sqrt(2 + t) - 2", True, True), ("sqrt(1 + t) + sqrt(2 + t) - 2.5", False, False), ("sqrt(3)*t - 1", False, False),
        ("sqrt(3) - t", True, True),
        ("2*sqrt(3)*t + sqrt(2)", True, True), ("sqrt(2)*t - t", True, False), ("m*sqrt(1 + t) - m", True, False),
        ("sqrt(m)*(1 + t)", True, True),
    ],
)  # fmt: skip
def test_signs(text: str, weakly: bool, strictly: bool) -> None:
    """The variable runs from 0 to 1."""
    signs = Signs(domain(), (F(0), F(1)))
    assert signs.above(poly(text)) is weakly
    assert signs.above(poly(text), strict=True) is strictly


@pytest.mark.parametrize(
    "text", ["t + sqrt(1 + t)", "1/sqrt(1 + t) - t", "sqrt(4 + 5*t)*t + q", "sqrt(m**2 + 2*m*t + t**2)", "sqrt(2*(1 + t)**2)", "t**3 - m"]
)
@pytest.mark.parametrize("place", [F(0), F(1), F(1, 4)])
def test_values_at_a_place(text: str, place: F) -> None:
    """A positive multiple of the value."""
    signs, at = Signs(domain(), (F(0), F(1))), {**AT, RAY.name: float(place)}
    here, there = value(poly(text), at), value(signs.at(poly(text), place), at)
    assert (here > 1e-12) == (there > 1e-12) and (here < -1e-12) == (there < -1e-12)
    if "/" not in text:
        assert there == pytest.approx(here, rel=1e-12, abs=1e-12)
    assert RAY not in {x for m in signs.at(poly(text), place) for x, _ in m}


def test_roots_that_divide_are_multiplied_in() -> None:
    signs, root = Signs(domain(), (F(0), F(1))), Term("**", (parse("1 + t").put({parse("t"): RAY}), parse("0.5")))
    here = domain().polynomial(parse("q + t/w - 2/w**3").put({parse("t"): RAY, parse("w"): root}))
    found, powers = signs.split(here)
    assert list(powers.values()) == [-3] and value(found) == pytest.approx(value(here) * value({((root, 3),): F(1)}), rel=1e-12)
    assert signs.split(poly("q + t"))[1] == {}
    with pytest.raises(NotWritten):
        signs.split({((roots_in(found)[0] if roots_in(found) else root, -41),): F(1)})
