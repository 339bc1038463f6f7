"""Sets without inner points: with a diagonal stiffness the closest point of a box, thin in some forces, is a clip of each coordinate."""

from __future__ import annotations

import numpy as np
import pytest

import duhem
from duhem.law.formula_law import Criterion
from tests.long import long_at, long_but

SEGMENTS = [
    "max(abs(sigma_a) - 1, abs(sigma_b))",
    "abs(sigma_b) + pos(abs(sigma_a) - 1)",
    "max(sigma_a - 1, -1 - sigma_a, sigma_b, -sigma_b)",
    "sigma_b**2 + pos(abs(sigma_a) - 1)**2",
]
FAR = [
    ((0.5, 1e9), (1.0, 1.0)),
    ((0.001, 1e6), (1.0, 1.0)),
    ((-3.0, -1e9), (1.0, 1.0)),
    ((1000.0, 1e6), (1e4, 1.0)),
    ((22.0, -46.0), (1e12, 1.0)),
    ((46.0, 400.0), (1e12, 1.0)),
    ((0.7, 0.2), (1.0, 1.0)),
]


def _stress(g: str, trial: tuple[float, ...], stiffness: tuple[float, ...]) -> np.ndarray:
    forces = ("sigma_a", "sigma_b", "sigma_c")[: len(trial)]
    found = duhem.project(Criterion("thin", g, forces=forces, pressure=None), trial, None, stiffness)
    # A g without a slope on K tells no normals at its end, and beside a stiffness far apart nobody knows how far off the answer is.
    unknown = "**2" in g and max(stiffness) > 1e9
    assert found.status[0] == duhem.Status.SLIP or (unknown and found.status[0] == duhem.Status.INACCURATE)
    return found.stress[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "trial", "stiffness"),
    long_but([3, 6, 11, 19, 27], [(g, *far) for g in SEGMENTS for far in FAR]),
)
def test_a_segment_is_met_beside_far_trials(g: str, trial: tuple[float, float], stiffness: tuple[float, float]) -> None:
    np.testing.assert_allclose(_stress(g, trial, stiffness), [np.clip(trial[0], -1.0, 1.0), 0.0], rtol=1e-7, atol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("trial, stiffness", FAR)
@pytest.mark.parametrize("g", ["abs(sigma_b)", "sigma_b**2"])
def test_a_line_keeps_what_is_along_it(g: str, trial: tuple[float, float], stiffness: tuple[float, float]) -> None:
    np.testing.assert_allclose(_stress(g, trial, stiffness), [trial[0], 0.0], rtol=1e-7, atol=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("trial, stiffness", FAR)
@pytest.mark.parametrize("g", ["abs(sigma_a) + abs(sigma_b)", "norm(sigma_a, sigma_b)", "max(abs(sigma_a), abs(sigma_b))"])
def test_a_point_at_the_origin_stays_there(g: str, trial: tuple[float, float], stiffness: tuple[float, float]) -> None:
    assert not _stress(g, trial, stiffness).any()


@pytest.mark.parametrize(
    "g, trial, stress",
    long_but(
        [1, 3],
        [
            ("max(norm(sigma_a, sigma_b) - 1, abs(sigma_c))", (0.3, 0.4, 1e9), (0.3, 0.4, 0.0)),
            ("max(norm(sigma_a, sigma_b) - 1, abs(sigma_c))", (3.0, 4.0, 1e8), (0.6, 0.8, 0.0)),
            ("max(abs(sigma_b), abs(sigma_c))", (3.0, 4.0, 1e10), (3.0, 0.0, 0.0)),
            ("abs(sigma_c)", (3.0, 4.0, 1e10), (3.0, 4.0, 0.0)),
        ],
    ),
)
def test_flat_sets_of_three_forces(g: str, trial: tuple[float, ...], stress: tuple[float, ...]) -> None:
    np.testing.assert_allclose(_stress(g, trial, (1.0, 1.0, 1.0)), stress, rtol=1e-7, atol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("trial", long_at([1], [1e-310, 1e-320, 5e-324]))
def test_a_trial_beside_which_no_pressure_is_small_ends_at_the_tip(trial: float) -> None:
    done = duhem.project("box", [[trial, 0.0], [trial, trial]], 0.0, 1.0, {"mu_a": 1, "mu_b": 0.01}, method="newton")
    assert not done.stress.any() and (done.multiplier > 0.0).all()
