"""Laws about another zero: K is moved, so that it is convex, and its boundary C^1, as before; what is no such law stays as it is."""

from __future__ import annotations

import math
import random
from typing import Any

import pytest

from duhem.proof.kernel.claims import objection, rules_of
from duhem.proof.kernel.simpler_laws import about_its_centre
from duhem.proof.kernel.stated_law import StatedLaw
from tests.oracles import drawn_formulas

FORCES = ("a", "b", "c")
PARAMETERS = {name: {} for name in "xyz"} | {"k": {"positive": True}, "m": {"min": "1", "max": "2"}}


def law(g: str, **more: Any) -> StatedLaw:
    given: dict[str, Any] = {"forces": FORCES, "pressure": None, "parameters": PARAMETERS, "constraints": [], "flow": None, "g": g}
    return StatedLaw.read(given | more)


def of_differences(text: str) -> str:
    """With a - x, b - y, c - z for the forces, in brackets."""
    for force, own in zip("ABC", ("(a - x)", "(b - y)", "(c - z)"), strict=True):
        text = text.replace(force, own)
    return text


J2, J3 = "((A - B)**2 + (B - C)**2 + (C - A)**2)/6", "(2*A - B - C)*(2*B - C - A)*(2*C - A - B)/27"
MOVED = [
    f"({J2})**3 - 9/4*({J3})**2 - k", f"sqrt({J2}) + k*0 - 1", "max(A, B, C) - min(A, B, C) - k", "norm(A, 2*B) + abs(C) - m",
    "where(A + B > 0, (A + B)**2, 2*(A + B)**4) + C**2 - 1", "norm(2*A - B, A + C) - k", "norm(m*A - m*B, C + B, k*C) - 1",
]  # fmt: skip
STAYS = [
    "norm(a, b, c) - k", "max(a - x, -a - y) - k*norm(b, c)", "norm(k*a - x, b) - 1", "(a - x)**2 + abs(a - y) - 1",
    "exp(a - x) + exp(y - a) - k",
    "norm(a*b - x, c) - 1",
]  # fmt: skip


@pytest.mark.parametrize("text", MOVED)
def test_the_moved_law_is_the_law_at_the_moved_force(text: str) -> None:
    stated, rng = law(of_differences(text)), random.Random(text)
    moved = about_its_centre(stated)
    assert moved != stated and not moved.g.names() & {"x", "y", "z"}
    for _ in range(20):
        at = {name: rng.uniform(-2, 2) for name in (*FORCES, "x", "y", "z")} | {"k": 1.5, "m": 1.2}
        there = at | {f: at[f] - at[x] for f, x in zip(FORCES, "xyz", strict=True)}
        assert drawn_formulas.value(stated.g, at) == pytest.approx(drawn_formulas.value(moved.g, there), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("text", STAYS)
def test_what_has_no_such_centre_stays(text: str) -> None:
    assert about_its_centre(law(text)) == law(text)


def test_nothing_cancels_of_which_it_is_not_known_that_it_has_a_value() -> None:
    assert about_its_centre(law("norm(a - sqrt(x), b)")) == law("norm(a - sqrt(x), b)")
    within = law(of_differences(MOVED[0]), domain={"a": {"min": "0"}})
    assert about_its_centre(within) == within  # a range of a force would have to be moved as well


def test_numbers_are_a_centre_too() -> None:
    moved = about_its_centre(law("norm(a - 1/10, b + 2) + abs(a + b + 19/10) - k"))
    for a, b in ((1.0, 2.0), (-0.5, 0.3)):
        assert drawn_formulas.value(moved.g, {"a": a, "b": b, "k": 1.0}) == pytest.approx(math.hypot(a, b) + abs(a + b) - 1)


@pytest.mark.parametrize(("factor", "proved"), [("9/4", True), ("12", False), ("-27/8", True), ("-6", False)])
def test_a_hardening_law_of_drucker_is_convex_as_far_as_the_law_is(factor: str, proved: bool) -> None:
    """J2^3 - c J3^2 is convex for -27/8 <= c <= 9/4, wherever it is moved."""
    stated = law(of_differences(f"({J2})**3 - {factor}*({J3})**2 - k"))
    assert (not objection("convexity", "composition", frozenset(), stated, {})) is proved
    if proved:
        assert not objection("smoothness", "composition", frozenset(), stated, {})


PUNCTURED = [
    "where(norm(a - 3/10, b) > 0, norm(a - 3/10, b) - 1, 5)",
    "where((a - x/4)**2 + b**2 > 0, norm(a - x/4, b) - 1, 5)",
    "norm(a - x/4, b) - 1 + (a - x/4)/norm(a - x/4, b)/2",
    "norm(a - x/4, b)**2/norm(a - x/4, b) - 1",
    "norm(a - x/4, b) + (a - x/4)**2/norm(a - x/4, b) - 1",
    "where(abs(a - 3/10) + abs(b) > 0, norm(a - 3/10, b)**2 - 1, 5)",
]


@pytest.mark.parametrize("text", PUNCTURED)
def test_the_centre_is_not_taken_to_lie_in_k(text: str) -> None:
    """K is a disc without its centre, where g is 5 or has no value; zero force lies in K."""
    stated = law(text, forces=("a", "b"), parameters={"x": {"min": "1", "max": "2"}})
    settled = frozenset({"origin"})
    for claim in ("convexity", "smoothness"):
        for rule in rules_of(claim, stated):
            assert objection(claim, rule, settled | {"convexity"} - {claim}, stated, {}), rule
