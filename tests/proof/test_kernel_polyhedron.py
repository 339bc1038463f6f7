"""Polyhedra and unions of them: what the kernel confirms to be convex is, and a gap of a billionth is seen."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import pytest

from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.support import Face, corners, is_bounded, union_is_convex


def convex(g: str, forces: tuple[str, ...] = ("a", "b"), **parameters: Any) -> bool:
    law = {"forces": forces, "pressure": "s", "parameters": parameters, "constraints": [], "g": g, "flow": None}
    return not objection("convexity", "polyhedral", frozenset(), StatedLaw.read(law), {})


LEFT, RIGHT = "max(-a - 1, a, -b, b - 1)", "max(-a, a - 1, -b, b - 1)"
SQUARE = "max(abs(a), abs(b))"
POSITIVE = {"positive": True}


@pytest.mark.parametrize(
    ("g", "right"),
    [
        (f"{SQUARE} - 1", True),
        (f"{SQUARE} - m", True),
        (f"{SQUARE} - k", False),  # k of any sign: no unit
        (f"min({LEFT}, {RIGHT})", True),  # side by side
        (f"min({LEFT}, max(10**(-9) - a, a - 1, -b, b - 1))", False),
        (f"min({LEFT}, max(-a, a - 1, -b, b - 1 - 10**(-9)))", False),  # a step
        (f"min({LEFT}, max(-a - 10**(-9), a - 1, -b, b - 1))", True),  # they overlap
        (f"min({SQUARE} - 1, max(abs(a), abs(b)) - 2)", True),
        (f"min({SQUARE} - 1, max(abs(a - 1/2), abs(b)) - 1)", True),
        (f"min({SQUARE} - 1, max(abs(a - 1/2), abs(b - 1/2)) - 1)", False),
        (f"min({SQUARE} - 1, max(a - 3, 4 - a, abs(b) - 1))", True),  # the other is empty
        (f"min({SQUARE} - 1, max(abs(a - 3), abs(b)) - 1)", False),  # apart
        (f"min({SQUARE} - 1, max(abs(a - 2), abs(b)) - 1)", True),  # they share a side
        (f"min({SQUARE} - 1, max(abs(a - 2), abs(b - 2)) - 1)", False),  # a corner
        ("min(max(-a, a - 1, -b, b - 1), max(-a - 1, a, -b, b - 1), max(-a, a - 1, -b - 1, b))", False),  # three of four quarters
        ("min(max(-a, a - 1, -b, b - 1), max(-a - 1, a, -b, b - 1), max(abs(a) - 1, -b - 1, b))", True),
        (f"min({SQUARE} - 1, abs(a) + abs(b) - 1)", True),
        (f"min({SQUARE} - 1, abs(a) + abs(b) - 1 - 10**(-9))", False),
        (f"max({SQUARE} - 1, min(a, b))", False),  # three quarters of a square
        (f"max({SQUARE} - 1, min(a - 2, b))", True),
        ("min(a, b)", False),  # unbounded
        ("min(abs(a) - 1, abs(a) - 2)", False),  # a strip, which it does not ask about
        (f"{SQUARE} - 1 + 0/((k + 1)*(k - 1) - k**2 + 1)", False),
        ("norm(a, b) - 1", False),
        ("abs(abs(a) - 2) + abs(b) - 1", False),  # two diamonds
        (f"m*min({LEFT}, {RIGHT})", True),
        (f"k*min({LEFT}, {RIGHT})", False),
        (f"-max({LEFT}, {RIGHT})", False),
    ],
)
def test_unions_of_polygons(g: str, right: bool) -> None:
    assert convex(g, m=POSITIVE, k={"min": "-1", "max": "1"}) is right


def test_one_and_three_forces() -> None:
    assert convex("min(max(-a, a - 1), max(1 - a, a - 2))", ("a",))
    assert not convex("min(max(-a, a - 1), max(1 + 10**(-9) - a, a - 2))", ("a",))
    cube = "max(abs(a), abs(b), abs(c)) - 1"
    assert convex(cube, ("a", "b", "c"))
    assert not convex(f"max({cube}, min(a, b, c))", ("a", "b", "c"))


def drawn(rng: Random) -> tuple[list[Face], Face]:
    """A bounded polygon around 0 and a line through it."""
    while True:
        faces = [
            ((Fraction(rng.randint(-4, 4)), Fraction(rng.randint(-4, 4))), Fraction(rng.randint(1, 4), 2)) for _ in range(rng.randint(3, 5))
        ]
        if is_bounded(faces, 2):
            return faces, ((Fraction(rng.randint(1, 4)), Fraction(rng.randint(-4, 4))), Fraction(rng.randint(-1, 1), 8))


def test_a_polygon_that_is_cut_is_convex_unless_something_is_lost() -> None:
    rng, little = Random(3), Fraction(1, 10**9)
    for _ in range(12):
        faces, (row, limit) = drawn(rng)
        for gap in (Fraction(0), -little, little):
            parts = [[*faces, (row, limit)], [*faces, (tuple(-v for v in row), -limit - gap)]]
            assert union_is_convex(parts, 2) is (gap <= 0), (faces, row, limit, gap)


def test_corners_bound_what_a_polygon_holds() -> None:
    rng = Random(4)
    for _ in range(40):
        faces, (row, _) = drawn(rng)
        ends = corners(faces, 2)
        most = max(row[0] * u + row[1] * v for u, v in ends)
        for beyond in (Fraction(1, 10**9), Fraction(0)):  # no corner is beyond the greatest value, and one is on it
            assert bool(corners([*faces, (tuple(-v for v in row), -most - beyond)], 2)) is (beyond == 0)


def test_what_is_not_bounded_is_told() -> None:
    one, zero = Fraction(1), Fraction(0)
    sides: list[Face] = [((one, zero), one), ((-one, zero), one), ((zero, one), one)]
    assert not is_bounded(sides, 2)  # open downward
    assert not is_bounded(sides[:2], 2)  # a strip
    assert not is_bounded([((one, one), one), ((-one, -one), one), ((2 * one, 2 * one), one)], 2)
    assert is_bounded([*sides, ((zero, -one), -5 * one)], 2)  # empty
    assert is_bounded([*sides, ((zero, -one), one)], 2)
