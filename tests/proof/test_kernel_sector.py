"""How the kernel reads functions of ordered principal deviators: their values, degrees and where they vanish; their bends and walls."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise
from random import Random
from typing import Any

import pytest

from duhem.proof.kernel import obligations
from duhem.proof.kernel.bounds import Facts
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.deviatoric import convex_in_deviator, deviatoric_readers
from duhem.proof.kernel.plane_function import PlaneFunction
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import parse
from tests.long import long_at
from tests.oracles import drawn_formulas
from tests.proof.test_kernel_facts import said

F = Fraction
I1 = "(a + b + c)"
J2 = "(((a-b)**2 + (b-c)**2 + (c-a)**2)/6)"
J3 = "((2*a-b-c)*(2*b-c-a)*(2*c-a-b)/27)"
FIRST, LAST = "(max(a, b, c) - (a + b + c)/3)", "(min(a, b, c) - (a + b + c)/3)"
SIX = "eigmax(a, b, c, u, v, w)"
PARAMETERS = {"m": {"positive": True}, "e": {"min": "0", "max": "1/2"}, "q": {"min": "-1", "max": "1"}}


def written_out(text: str) -> str:
    for word, meaning in (("C3", "(3*sqrt(3)/2*J3/J2**(3/2))"), ("FIRST", FIRST), ("LAST", LAST), ("I1", I1), ("J2", J2), ("J3", J3)):
        text = text.replace(word, meaning)
    return text


def law(text: str, *forces: str) -> StatedLaw:
    given: dict[str, Any] = {"pressure": "s", "parameters": PARAMETERS, "constraints": [], "flow": None}
    return StatedLaw.read({"forces": forces or ("a", "b", "c"), "g": written_out(text), **given})


def readers(stated: StatedLaw) -> list[Any]:
    return [r for r in deviatoric_readers(stated.g, over(stated)) if r.tensor.entries]


VALUES: list[tuple[str, int | F]] = [  # a formula and its degree: above 0 it is 0 by continuity where the deviator is
    ("FIRST", 1), ("LAST", 1), ("FIRST**2 + 2*J2", 2), ("J2*FIRST - J3", 3), ("FIRST*LAST*3", 2),
    ("J2/FIRST", 1), ("J2**2/FIRST**3", 1), ("J2/FIRST*FIRST", 2), ("LAST/FIRST", 0),
    ("sqrt(J2)*FIRST", 2),
    ("FIRST**(1/2)", F(1, 2)), ("J2**(1/2) - 2*LAST", 1), ("J2**(3/2)/(FIRST + sqrt(J2))", 2),
    ("(FIRST + sqrt(3)*J2**(1/2))**2", 2), ("FIRST**(1/3)", F(1, 3)), ("(J2 + FIRST**2)**(3/4)", F(3, 2)),
    ("FIRST*(3 + LAST/FIRST)**(m - m)", 1), ("J2**(-1/2)", -1), ("FIRST*J2**(-1/2)", 0),
    ("(FIRST*J2)**(1/2)*FIRST**(1/2)", 2),
    ("FIRST*(1 + LAST/FIRST)", 1),
    ("cos(acos(3*sqrt(3)/2*J3/J2**(3/2))/3)", 0), ("sqrt(J2)*cos(acos(3*sqrt(3)/2*J3/J2**(3/2))/3)", 1),
    ("sqrt(J2)*cos(-acos(3*sqrt(3)/2*J3/J2**(3/2))/3)", 1), ("where(J2 > 0, J2/FIRST, 0)", 1),
    ("where(J2 <= 0, 0, LAST**2/FIRST)", 1), ("where(FIRST > 0, J2/FIRST, 0*FIRST)", 1),
    ("where(J2 > 0, J2/FIRST, FIRST)", 1), ("where(J2 > 0, J2/FIRST, J2/FIRST)", 1),
    ("where(J2/FIRST > 0, J2/FIRST, 0)", 1), ("where(J2 > 0, J2/FIRST, 0) + 2*FIRST", 1), ("-LAST*(2*FIRST + LAST)", 2),
    ("(FIRST/3 - LAST)**3", 3),
    ("sqrt(J2)*sin(acos(C3)/3)", 1), ("cos(acos(C3)/3 - pi/6)", 0), ("sin(asin(-C3)/3)", 0), ("J2*sin(asin(-C3)/3 + e)**2", 2),
    ("cos(m - acos(-C3)/3)", 0), ("FIRST/cos(acos(C3)/3 - pi/6)", 1), ("sin(asin(C3)/3 - 2*pi)", 0), ("sin(-acos(-C3)/3 - 7*pi/6)", 0),
    ("abs(LAST/FIRST)**2*FIRST", 1), ("abs(LAST)**4/J2", 2), ("4**(1/2)*FIRST", 1), ("(2*J2)**(1/2)", 1), ("(J2*FIRST**2/4)**(1/2)", 2),
]  # fmt: skip
OTHERS = [
    "FIRST + J2", "FIRST**LAST", "FIRST**e", "exp(FIRST)", "cos(FIRST)", "LAST**(1/2)", "LAST**-1", "(LAST + 2)**2", "a*FIRST", "I1*FIRST",
    "cos(acos(3*sqrt(3)/2*J3/J2**(3/2))/2)", "cos(acos(3*sqrt(3)/2*J3/J2**(3/2)/2)/3)", "cos(acos(J3/J2)/3)",
    "cos(acos(3*sqrt(3)/2*J3/J2**(3/2)) + 1/3)", "sin(asin(C3)/2)", "sin(asin(C3/2)/3)", "tan(asin(C3)/3)", "1/sin(acos(C3)/3)",
    "cos(acos(3*sqrt(3)/2*J3/J2**(3/2))/3 + acos(3*sqrt(3)/2*J3/J2**(3/2))**2)",
    "where(J2 > 0, J2/FIRST, 1)", "where(J2 >= 0, J2/FIRST, 0)", "where(J2 < 0, 0, J2/FIRST)", "where(LAST > 0, J2/FIRST, 0)",
    "where(J2 > 1, J2/FIRST, 0)", "where(J2 > 0, LAST/FIRST, 0)", "where(FIRST/J2 > 0, J2/FIRST, 0)",
    "where(J2 > 0, J2/FIRST, LAST/FIRST)",
]  # fmt: skip


def at(v: F) -> dict[str, float]:
    """Principal values with X = 3 - v^2 and d = 3 v, in no order."""
    x, d = 3 - float(v) ** 2, 3 * float(v)
    return {"a": -x / 2 - d, "b": x, "c": -x / 2 + d, "m": 1.3, "e": 0.3, "q": -0.4, RAY.name: float(v), "pi": math.pi}


def valued(found: PlaneFunction, here: dict[str, float]) -> float:
    powers = (drawn_formulas.value(written(dict(base)), here) ** drawn_formulas.value(written(n), here) for base, n in found.powers.items())
    return drawn_formulas.value(written(found.poly), here) * math.prod(powers)


@pytest.mark.slow
@pytest.mark.parametrize(("text", "degree"), VALUES)
def test_a_function_of_principal_deviators_is_read(text: str, degree: int | F) -> None:
    term = parse(written_out(text))
    (reader,) = readers(law(f"({text}) + 0*FIRST"))
    found = reader.value(term)
    assert found is not None and found.degree == degree
    for v in (F(1, 8), F(1, 2), F(7, 10), F(19, 20)):
        assert valued(found, at(v)) == pytest.approx(drawn_formulas.value(term, at(v)), rel=1e-9)
    assert (reader.emptied(term) == parse("0")) is (degree > 0)


@pytest.mark.parametrize("text", OTHERS)
def test_what_is_no_such_function_is_not(text: str) -> None:
    for reader in readers(law(f"({text}) + 0*FIRST")):
        assert reader.value(parse(written_out(text))) is None


def test_six_components_are_read_by_their_eigenvalues() -> None:
    names = ("a", "b", "c", "u", "v", "w")
    mean = "(a + b + c)/3"
    second = "(((a-b)**2 + (b-c)**2 + (c-a)**2)/6 + u**2 + v**2 + w**2)"
    for text, degree in (
        (f"{SIX} - {mean}", 1),
        (f"{second}/({SIX} - {mean})", 1),
        (f"{SIX} - {mean} + eigmax(-a, -b, -c, -u, -v, -w) + {mean}", 1),
    ):
        term = parse(text)
        (reader,) = readers(law(f"({text}) + 0*{SIX}", *names))
        found = reader.value(term)
        assert found is not None and found.degree == degree
        for v in (F(1, 8), F(1, 2), F(19, 20)):
            here = at(v) | {"u": 0.0, "v": 0.0, "w": 0.0}
            assert valued(found, here) == pytest.approx(drawn_formulas.value(term, here), rel=1e-6)


def shown(text: str) -> Facts | None:
    stated = law(text)
    domain = over(stated)
    return convex_in_deviator(stated.g, domain)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # e (s1 - s2) + (s2 - s3) for 1/2 <= e <= 2: each wall turns outward
        ("1/2*(2*FIRST + LAST) - FIRST - 2*LAST", ">= convex"), ("0.499*(2*FIRST + LAST) - FIRST - 2*LAST", ""),
        ("2*(2*FIRST + LAST) - FIRST - 2*LAST", ">= convex"), ("2.001*(2*FIRST + LAST) - FIRST - 2*LAST", ""),
        ("(1/2*(2*FIRST + LAST) - FIRST - 2*LAST)**2 + 0", ">= convex"),
        ("(1/2*(2*FIRST + LAST) - FIRST - 2*LAST)**(1/2)", ">= quasiconvex"),
        ("(0.499*(2*FIRST + LAST) - FIRST - 2*LAST)**2 + 0*J2", ""), ("sqrt(J2) + FIRST", ">= convex"), ("sqrt(J2) - FIRST", ""),
        ("FIRST*1 + 0", ">= convex"), ("LAST*1 + 0", ""), ("-LAST*1 + 0", ">= convex"), ("3*FIRST - 2*sqrt(J2)", ""),
        ("where(J2 > 0, J2/FIRST, 0)", ""),
        ("where(J2 > 0, FIRST/2 + LAST**2/FIRST, 0)", ""), ("J2 + FIRST**2", ">= convex"), ("J2 + FIRST", ">= convex"), ("J2 - FIRST", ""),
        ("J2 + 3*FIRST*LAST", ""), ("FIRST**2 + FIRST + J2 + abs(a)", ">= convex"), ("FIRST**2 + abs(a) - 1", "? convex"),
        ("FIRST**2 + sqrt(J2) + log(e)", ""), ("J2*FIRST + J2**(3/2)", ">= convex"), ("J2/FIRST + 3*FIRST", ">= convex"),
        ("J2/FIRST + 2.999*FIRST", ""),
        ("sqrt(FIRST**2 + J2/2) + FIRST", ">= convex"), ("FIRST**2*(1 + a*0) + J2", ">= convex"), ("a*FIRST + J2", ""),
        ("FIRST - 2*LAST + sqrt(J2)*m", ">= convex"), ("FIRST - m*LAST", ">= convex"), ("m*FIRST - LAST", ">= convex"),
        ("q*FIRST - LAST", ""),
        ("(FIRST**2 + J2)**(2/3)", ">= convex"), ("(FIRST**2 + J2)**(1/3)", ">= quasiconvex"),
        # Cazacu and Barlat (2004); with |J3| a kink points inward.  Drucker (1949)
        ("(J2**(3/2) - e*J3)**(1/3)", ">= convex"), ("(J2**(3/2) - e*abs(J3)**1)**(1/3)", ""),
        ("(J2**3 - e*abs(J3)**2)**(1/6)", ">= convex"),
    ],
)  # fmt: skip
def test_what_is_shown_of_sectors(text: str, expected: str) -> None:
    found = shown(text)
    assert (said(found) if found else "") == expected


def test_drawn_waves_are_convex_where_chords_find_them_so() -> None:
    rng = Random(3)
    for _ in range(40):
        low, offset = rng.choice(("asin", "acos")), F(rng.randint(-40, 40), 20)
        text = f"sqrt(J2)*{rng.choice(('cos', 'sin'))}({offset} + {low}({rng.choice('+-')}C3)/3)"
        term, found = parse(written_out(text)), shown(text)
        points = [{"a": rng.gauss(0, 1), "b": rng.gauss(0, 1), "c": rng.gauss(0, 1), "pi": math.pi} for _ in range(400)]
        between = [({k: (p[k] + q[k]) / 2 for k in p}, p, q) for p, q in pairwise(points)]
        gaps = [drawn_formulas.value(term, m) * 2 - drawn_formulas.value(term, p) - drawn_formulas.value(term, q) for m, p, q in between]
        assert (found is not None and found.convex) is (max(gaps) < 1e-9), text


COSINE = "cos(acos(3*sqrt(3)/2*J3/J2**(3/2))/3)"  # without a value where the deviator is 0; FIRST times it is 0 there by continuity


@pytest.mark.parametrize(
    ("text", "empty"),
    [
        (f"FIRST*{COSINE} + a", "0 + a"), ("where(FIRST > 0, a, FIRST)", "where(FIRST > 0, a, 0)"),
        ("where(J2 <= a, J2, b)", "where(J2 <= a, 0, b)"),
        ("m*FIRST**2 - m", "0 - m"), ("J2/FIRST + 1", "0/FIRST + 1"), ("exp(FIRST)", "exp(0)"), ("max(a, LAST + 1)", "max(a, 0 + 1)"),
    ],
)  # fmt: skip
def test_what_is_left_where_the_deviator_is_zero(text: str, empty: str) -> None:
    """What is compared stays: beside the axis it may have another sign than on it."""
    (reader,) = readers(law(f"({text}) + 0*FIRST"))
    domain = over(law("a"))
    left = reader.emptied(parse(written_out(text)))
    assert domain.polynomial(left) == domain.polynomial(parse(written_out(empty)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "right"),
    long_at([1, 4], [
        (f"FIRST*{COSINE} - 1", True), (f"FIRST*{COSINE} + 1", False), ("FIRST*J2/LAST - 1", True), ("FIRST*J2/(LAST + FIRST) - 1", False),
        (f"{COSINE} - 2", False),
        (f"where(FIRST > 0, 5, -1) + FIRST*{COSINE}", False), (f"where(FIRST <= 0, -1, 5) + FIRST*{COSINE}", False),
    ]),
)  # fmt: skip
def test_the_origin_by_continuity(text: str, right: bool) -> None:
    assert (not objection("origin", "evaluation", frozenset(), law(text), {})) is right


@pytest.mark.parametrize(
    ("text", "continued"),
    [
        ("J2/FIRST - 1", True), ("J2**2/FIRST**3 + I1 - 1", True), ("-LAST**2/FIRST - 1", True), ("(J2/FIRST)**2 - 1", True),
        ("J2/FIRST*abs(a)/norm(a, b, c) - 1", False),  # two quotients, one of which has no value at zero force either
        ("where(a > b, J2/FIRST, 2*J2/FIRST) - 1", True), ("abs(J2/FIRST - a) - 1", True), ("exp(J2/FIRST) - 2", True),
        ("LAST/FIRST - 1", False), ("J2/FIRST**2 - 1", False), ("J2/(FIRST + LAST) - 1", False), ("J2/(a - b) - 1", False),
        ("sqrt(J2)*exp(1/FIRST) - 1", False), ("FIRST*log(FIRST) - 1", False), ("J2/FIRST + 1/sqrt(J2) - 1", False),
        ("I1*LAST/FIRST - 1", False), ("J2/(FIRST - sqrt(J2)) - 1", False),
    ],
)  # fmt: skip
def test_a_quotient_of_principal_deviators_is_continued_where_it_tends_to_zero(text: str, continued: bool) -> None:
    assert obligations.formula(law(text)) and bool(obligations.limits(law(text))) is continued
