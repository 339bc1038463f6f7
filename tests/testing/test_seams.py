"""Directions on seams, at corners and to apexes."""

from __future__ import annotations

import numpy as np

import duhem
from duhem.testing.drawn.case import Region
from duhem.testing.drawn.strategies import TURNS, turned
from tests.oracles.routines import MU

FIRST = np.array([[1.0, 0.3], [1.0, 0.4], [0.2, 1.0], [-0.5, 1.0]])
LAST = np.array([[0.2, -1.0], [0.1, -1.0], [-1.0, 0.5], [0.3, 1.0]])


def test_a_seam_is_met_to_the_last_digit_from_either_side() -> None:
    """The pieces of this law are its quadrants."""
    region = Region(duhem.load("antoni2007"), MU)
    found = turned(region, FIRST, LAST, ["seam"] * 4, -np.ones(4))
    size = np.abs(found).max(axis=1)
    small = np.abs(found).min(axis=1)
    np.testing.assert_allclose(size, 1.0)
    assert (small < 1e-15).all()
    pieces = np.asarray(region.slope(found * region.reach(found, -np.ones(4))[:, None], -np.ones(4))[1])
    start = np.asarray(region.slope(0.01 * FIRST, -np.ones(4))[1])
    assert (pieces == start).all(axis=1).tolist() == [True, False, True, False]


def test_a_direction_stays_where_no_piece_ends() -> None:
    region = Region(duhem.load("coulomb"), {"mu": 0.3})
    np.testing.assert_array_equal(turned(region, FIRST, LAST, ["seam"] * 4, -np.ones(4)), FIRST)
    np.testing.assert_array_equal(turned(region, FIRST, LAST, ["as drawn"] * 4, -np.ones(4)), FIRST)


def test_corners_and_apexes() -> None:
    disk = Region(duhem.load("coulomb"), {"mu": 0.3})
    few = np.array([[1.0, 1e-4], [-0.2, 1.0], [0.0, 1.0]])
    assert turned(disk, few, few, ["corner", "equal", "equal"], -np.ones(3)).tolist() == [[1.0, 0.0], [-1.0, -1.0], [0.0, 1.0]]
    plane = turned(Region(duhem.load("box"), {"mu_a": 1.0, "mu_b": 1.0}), FIRST, LAST, ["corner", "equal", "mean", "as drawn"], -np.ones(4))
    assert plane.tolist() == [[1.0, 1.0], [1.0, 1.0], [0.2, 1.0], [-0.5, 1.0]]
    stress = duhem.load("drucker-prager")
    d = len(stress.forces)
    way = np.vstack([np.linspace(-1.0, 1.0, d), np.linspace(1.0, -1.0, d)])
    values = {name: 0.5 for name in stress.parameters}
    found = turned(Region(stress, values), way, way, ["mean", "mean"], np.zeros(2))
    assert stress.stress is not None
    assert [set(row[~np.array(stress.stress.shears)]) for row in found] == [{-1.0}, {1.0}] and not found[
        :, np.array(stress.stress.shears)
    ].any()


def test_most_directions_are_as_drawn() -> None:
    assert (
        TURNS[0] == "as drawn"
        and TURNS.count("as drawn") > len(TURNS) / 2
        and set(TURNS) == {"as drawn", "corner", "mean", "equal", "seam"}
    )
