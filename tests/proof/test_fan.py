"""Formulas in a fan of cones between rays, as the kernel checks them; the signs of numbers with roots that this needs."""

from __future__ import annotations

from random import Random

import pytest

import duhem
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.constant_value import sign_of_radicals
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import parse
from tests.long import long_but

TINY = "1/10**80"
DENESTED = "sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6))"
CARDANO = "(2 + sqrt(5))**(1/3) - (sqrt(5) - 2)**(1/3) - 1"


@pytest.mark.parametrize(
    ("text", "sign"),
    [
        (DENESTED, ZERO),
        (f"{DENESTED} + {TINY}", POSITIVE),
        (f"{DENESTED} - {TINY}", NEGATIVE),
        (f"sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6) + {TINY})", NEGATIVE),
        ("1/(sqrt(2) - 1) - sqrt(2) - 1", ZERO),
        (f"1/(sqrt(2) - 1) - sqrt(2) - 1 - {TINY}", NEGATIVE),
        (CARDANO, ZERO),
        (f"{CARDANO} + {TINY}", POSITIVE),
        ("abs(1 - sqrt(2)) + 1 - 2**0.5", ZERO),
        ("(1 - sqrt(2))**3 - 7 + 5*sqrt(2)", ZERO),
        ("1/(sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6)))", ANY),  # it divides by 0
        ("sqrt(sqrt(2) - 2)", ANY),
        ("log(2) - log(2)", ANY),
        ("pi - pi", ANY),
        ("2**(1/1000) - 2**(1/1000)", ANY),
        ("0", ZERO),
        ("sqrt(sqrt(3)*sqrt(5) - sqrt(15))", ANY),  # 0, though its enclosure is not above 0
        ("1 + (sqrt(2) - 1)*0**(1/3) - 8**(1/3)/2", ZERO),
    ],
)
def test_the_sign_of_a_number(text: str, sign: int) -> None:
    assert sign_of_radicals(parse(text)) == sign


@pytest.mark.slow
def test_the_sign_of_what_is_added_to_zero() -> None:
    random, seen = Random(8), set[int]()
    for _ in range(30):
        a, b, c = (random.randint(2, 40) for _ in range(3))
        zero = f"sqrt({a} + {b} + 2*sqrt({a}*{b}))*sqrt({c})/sqrt({c}/4) - 2*sqrt({a}) - 2*sqrt({b})"
        added, sign = random.choice(
            (("", ZERO), (f" + 1/10**{random.randint(1, 99)}", POSITIVE), (f" - 1/10**{random.randint(1, 99)}", NEGATIVE))
        )
        assert sign_of_radicals(parse(zero + added)) == sign
        seen.add(sign)
    assert seen == {NEGATIVE, ZERO, POSITIVE}


K, SIZE = "(1 + sqrt(2))", "sqrt(4 + 2*sqrt(2))"  # of the ray (-k, 1) and its size
TANGENTS = f"where(-a <= {K}*abs(b), norm(a, b), ({K}/{SIZE} + E)*(-a) + ({SIZE} - {K}*({K}/{SIZE} + E) + F)*abs(b)) - 1"
BARREL = "where(abs(a) < abs(b), (A*a**2 + B*b**2)/(2*abs(b)), abs(a)) - 1"  # at zero force it divides by nothing


def tangents(e: str, f: str) -> str:
    return TANGENTS.replace("E", f"({e})").replace("F", f"({f})")


def barrel(a: str, b: str) -> str:
    return BARREL.replace("A", f"({a})").replace("B", f"({b})")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "convex", "smooth"),
    long_but(
        [5, 9, 11, 12, 16, 20, 21, 23, 26],  # 9: smooth in each cone and not across
        [
            (tangents("0", "0"), True, False),
            pytest.param(tangents(TINY, "0"), True, False, marks=pytest.mark.long),
            pytest.param(tangents(f"-{TINY}", "0"), False, False, marks=pytest.mark.long),  # a kink inward
            (tangents("0", TINY), False, False),  # a jump
            pytest.param(barrel("1", "1"), True, True, marks=pytest.mark.long),
            (barrel("1", f"1 + {TINY}"), False, False),
            pytest.param(barrel("-1", "3"), False, False, marks=pytest.mark.long),  # bent outward
            pytest.param(barrel("1/2", "3/2"), True, False, marks=pytest.mark.long),
            pytest.param(barrel("2", "0"), False, False, marks=pytest.mark.long),
            ("where(abs(a) <= abs(b), abs(b), abs(a)) - 1", True, False),
            ("where(abs(a) >= abs(b), abs(b), abs(a)) - 1", False, False),
            ("where(a > 0, norm(a, b), norm(2*a, b)) - 1", True, True),
            ("where(a > 0, norm(a, b) - 1, norm(2*a, b) - 2)", False, False),
            ("where(a > 0, sqrt(a**2) + norm(a, b), sqrt(a**2) + norm(a, b)) - 1", True, False),  # a kink that no word names, and no choice
            ("where(a > 0, (a**4 + b**4)**(1/4), norm(a, b)) - 1", True, True),
            pytest.param("where(a > 0, (abs(a)**(3/2) + abs(b)**(3/2))**(2/3), norm(a, b)) - 1", True, True, marks=pytest.mark.long),
            ("where(a > 0, norm(a, b), norm(2*a, b)) + 1", False, False),
            ("where(a > 0, norm(a, b), a**2 + b**2) - 1", False, False),
            ("where(a > 1, norm(a, b), norm(a, b)) - 1", False, False),  # no cones
            ("where(a >= 0, where(a <= 0, 2*norm(a, b), norm(a, b)), norm(a, b)) - 1", False, False),  # a slit on a ray
            ("where(a >= 0, where(a <= 0, abs(b), norm(a, b)), norm(a, b)) - 1", True, True),
            ("where(a*b > 0, norm(a, b), norm(a, b)) - 1", False, False),
            ("where(a > 0, a/b**2*abs(b)*abs(b), norm(a, b)) - 1", False, False),  # it divides by 0 inside
            ("norm(a, b) + a/2 - 1", False, False),  # there is no fan
            ("norm(a, b) - norm(a, b)**2", False, False),
            ("where(1 > 0, norm(a, b) - norm(a, b)**2, 0)", False, False),
            ("where(1 > 0, norm(a, b) - 1, 0)", False, False),
            ("where(2*a < a + a, norm(a, b), norm(a, b)) - 1", False, False),
        ],
    ),
)
def test_what_a_fan_shows(g: str, convex: bool, smooth: bool) -> None:
    law = StatedLaw.read({"forces": ["a", "b"], "pressure": None, "g": g, "flow": None, "parameters": {}, "constraints": []})
    origin = frozenset({"origin"})
    assert (objection("convexity", "fan", origin, law, {}) == "") is convex
    assert (objection("smoothness", "fan", origin, law, {}) == "") is smooth
    assert objection("convexity", "fan", frozenset(), law, {})


@pytest.mark.long
def test_modes_that_meet_on_rays_with_roots() -> None:
    law, settled = stated(law_as_text(duhem.load("puck"))), frozenset({"origin"})  # Puck, Schürmann (1998)
    assert not objection("origin", "evaluation", frozenset(), law, {})
    assert not objection("convexity", "fan", settled, law, {})
    assert not objection("smoothness", "fan", settled, law, {})
