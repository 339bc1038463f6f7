"""Newton's method under stiffnesses far apart, held against the closest point in many digits: what slips has its digits in every ratio.

In the metric of such a stiffness K is thin.  A bend of it looks like an apex, pieces that touch look like one, and the rounding of a
level is longer than what the normals are still off by.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import duhem
from duhem.law.formula_law import Criterion
from duhem.projection.compiled_newton import solved_one_by_one
from duhem.projection.extended_precision import close_look, closest
from duhem.projection.increment import Increment, increment
from duhem.projection.newton import search, solve
from duhem.projection.result import Solution
from tests.campaigns.extremes import law
from tests.campaigns.increments import trials

Array = NDArray[np.float64]

OFF = 1e-13  # of trial and stress, in the metric; a component of a stress is off by cond(k)^1/2 of it
LAWS = ("antoni2007", "lobes", "orthotropic", "superellipse")


def stiffnesses(ratio: float) -> list[Array]:
    soft, coupled = np.diag([1.0, ratio]), 0.9 * np.sqrt(ratio) * np.array([[0.0, 1.0], [1.0, 0.0]])
    return [soft, soft[::-1, ::-1].copy(), soft + coupled]


def off(asked: Increment, found: Solution) -> Array:
    """How far stresses (N,) are from the closest points in many digits, of the lengths of trial and stress in the metric."""
    root, look = np.linalg.cholesky(asked.stiffness), close_look(asked)
    lengths = []
    for trial, pressure, stress in zip(asked.trial, asked.pressure, found.stress, strict=True):
        exact = closest(look, trial, float(pressure), asked.stiffness, stress, 0.0, 2.0 ** np.floor(np.log2(np.abs(stress).max())))
        assert exact is not None
        parts = (np.linalg.norm(np.linalg.solve(root, x)) for x in (stress - exact.stress, trial, exact.stress))
        moved, far, reach = parts
        lengths.append(moved / (far + reach))
    return np.array(lengths)


def by_the_loop(asked: Increment) -> Solution:
    found, left = solved_one_by_one(asked)
    assert not left.size
    return found


def beyond(known: Criterion, stretch: float) -> Array:
    """Trial stresses on rays, those along the axes a little beside them: the closest points are at the ends of a thin K."""
    t = trials(known, rays=6)
    return stretch * (t + 1e-6 * np.abs(t).max(axis=1, keepdims=True) * np.array([1.0, -0.7]))


@pytest.mark.parametrize("ratio", [1.0, 1e3, 1e6])
@pytest.mark.parametrize("name", LAWS)
def test_the_loop_and_the_search_have_their_digits_in_every_ratio(name: str, ratio: float) -> None:
    known = law(name)
    for k in stiffnesses(ratio):
        asked = increment(known, np.concatenate([beyond(known, 1.0), beyond(known, 70.0)]), -1.0, k, None)
        for found in (by_the_loop(asked), search(asked)):
            slips = np.flatnonzero(found.slip.any(axis=1))
            assert not found.failed.any()
            assert off(asked.of(slips), found.of(slips)).max() <= OFF


FOUND = [
    ("orthotropic", [[1.0, 0.0], [0.0, 1e3]], [0.5318564518329628, 0.055343328569345984]),  # a bend taken for an apex
    ("antoni2007", [[1.0, 28.460498941515414], [28.460498941515414, 1e3]], [-8.923296691599527, -251.68463119766963]),  # over a seam
    ("lobes", [[1.0, 0.0], [0.0, 1e6]], [-20.692197637769894, -1.8162212170101344e-07]),  # a flat end, which takes many steps
]


@pytest.mark.parametrize(("name", "k", "trial"), FOUND)
def test_answers_that_had_lost_digits(name: str, k: list[list[float]], trial: list[float]) -> None:
    asked = increment(law(name), np.array([trial]), -1.0, np.array(k), None)
    for found in (by_the_loop(asked), search(asked)):
        assert off(asked, found).max() <= OFF


@pytest.mark.parametrize("ratio", [1.0, 1e3, 1e6])
def test_an_apex_stays_one_in_every_ratio(ratio: float) -> None:
    tip = duhem.Criterion("tip", "2*sigma_a - 2/3 + norm(sigma_a - 1/3, sigma_b)", forces=("sigma_a", "sigma_b"), pressure=None)
    for k in stiffnesses(ratio):
        away = np.array([[1.0, 0.1], [2.0, -0.5], [30.0, 0.0], [1e3, 2.0]])  # slips
        asked = increment(tip, np.array([1 / 3, 0.0]) + away @ k, None, k, None)
        found = solve(asked)
        assert np.abs(found.stress - [1 / 3, 0.0]).max() <= 1e-12 * np.sqrt(ratio)
        assert not found.failed.any()
