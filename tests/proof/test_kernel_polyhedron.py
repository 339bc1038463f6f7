"""Polyhedra: their corners, and whether they are bounded."""

from __future__ import annotations

from fractions import Fraction
from random import Random

from duhem.proof.kernel.polyhedron import Face, corners, is_bounded


def drawn(rng: Random) -> tuple[list[Face], Face]:
    """A bounded polygon around 0 and a line through it."""
    while True:
        faces = [
            ((Fraction(rng.randint(-4, 4)), Fraction(rng.randint(-4, 4))), Fraction(rng.randint(1, 4), 2)) for _ in range(rng.randint(3, 5))
        ]
        if is_bounded(faces, 2):
            return faces, ((Fraction(rng.randint(1, 4)), Fraction(rng.randint(-4, 4))), Fraction(rng.randint(-1, 1), 8))


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
