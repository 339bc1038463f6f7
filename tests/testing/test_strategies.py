"""What the strategies draw."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

import duhem
from duhem.projection.increment import setting
from duhem.testing import (
    conformance,
    decades,
    loadings,
    parameters,
    pressures,
    stiffnesses,
    trials,
)
from duhem.testing.drawn.case import Region
from tests.long import mostly_long
from tests.oracles.routines import (
    DISK,
)


def drawn(strategy: object, n: int = 400) -> list[object]:
    found: list[object] = []

    @settings(max_examples=n)
    @given(strategy)
    def take(value: object) -> None:
        found.append(value)

    take()
    return found


@pytest.mark.slow
def test_every_decade_is_drawn() -> None:
    sizes = np.abs(np.array(drawn(decades(-6, 6, signed=True), 1000)))
    counts = np.bincount(np.floor(np.log10(sizes * (1 + 1e-15))).astype(int) + 6, minlength=13)
    assert counts.min() >= 15


def test_pressures_are_compressive_and_sometimes_none() -> None:
    found = np.array(drawn(pressures()))
    assert (found <= 0.0).all() and (found == 0.0).any() and found.min() < -1e5 and found[found < 0].max() > -1e-5


@pytest.mark.slow
@pytest.mark.parametrize("d", [1, 2, 3])
def test_stiffnesses_are_positive_definite_in_three_forms(d: int) -> None:
    found = drawn(stiffnesses(d), 200)
    assert all(np.linalg.eigvalsh(k / np.sqrt(np.outer(np.diag(k), np.diag(k)))).min() > 0 for k in found)
    full = sum(bool((k != np.diag(np.diag(k))).any()) for k in found)
    assert (full > 20) == (d > 1)


@pytest.mark.slow
@pytest.mark.parametrize(
    "law", mostly_long(["shifted-ellipse", "superellipse", "limacon", "lobes", "drucker1949"], "superellipse", "limacon")
)
def test_parameters_lie_in_the_domain(law: str) -> None:
    known = duhem.load(law)
    found = drawn(parameters(law), 60)
    assert known.fix(found[0])
    duhem.project(law, np.ones(len(known.forces)), -1.0 if known.pressure else None, 1.0, found[0], method="newton")  # agrees
    table = known.symbols()
    for values in found:
        assert all(bool(c.subs({table[n]: v for n, v in values.items()})) for c in known.constraints)


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_long([240, 800], 240))
def test_trials_lie_on_next_to_and_far_from_the_boundary(count: int) -> None:
    found = np.array(drawn(trials("coulomb", DISK, -1.0), count))
    gap = np.hypot(*found.T) / 0.3 - 1.0
    ulps = np.abs(gap) / np.finfo(float).eps
    assert (ulps <= 3).sum() > count / 27 and (gap > 100).any() and (gap < -0.99).any()
    assert ((np.abs(gap) > 1e-13) & (np.abs(gap) < 1e-5)).sum() > count / 60
    on, beside = (found == 0.0).any(axis=1), (np.abs(found) < 1e-300).any(axis=1)
    assert on.sum() > count / 60 < (beside & ~on).sum()


@pytest.mark.slow
def test_loading_paths_start_at_rest_and_are_of_three_kinds() -> None:
    found = drawn(loadings(2), 200)
    assert all(path[0].tolist() == [0.0, 0.0] and np.abs(path).max() <= 3.0 for path in found)
    closed = sum(bool(np.abs(path[-1]).max() < 1e-12) for path in found)
    assert 20 < closed < 180


def test_a_ray_that_leaves_at_once_has_no_reach() -> None:
    """Beside the origin, on the boundary of the ellipse norm(a + b + 1, a - b) <= 1, rounding of g admits some 1e-16 of any ray."""
    law = duhem.load("hibler").fix({"P": 1, "e": 1})
    ways = np.array([[1.0, 0.3], [1.0, 1e-9], [-1.0, -0.5], [0.2, 1.0]])
    reach = Region(law, {"P": 1.0, "e": 1.0}).reach(ways, np.zeros(4))
    np.testing.assert_array_equal(reach == 0.0, [True, True, False, True])
    assert reach[2] == pytest.approx(3.0 / 2.5)


def test_a_ray_along_which_powers_overflow_does_not_end_there() -> None:
    law = duhem.Criterion(name="x", g="(a - b)**4 - 1", forces=("a", "b"), pressure=None)
    reach = Region(law, {}).reach(np.array([[1.0, 1.0 + 1e-9], [1.0, 1.0], [1.0, -1.0]]), np.zeros(3))
    assert reach[0] == pytest.approx(1e9) and np.isinf(reach[1]) and reach[2] == pytest.approx(0.5)
    cone = duhem.Criterion(name="y", g="sqrt(a**2 + b**2) + a", forces=("a", "b"), pressure=None)
    assert np.isinf(Region(cone, {}).reach(np.array([[-1.0, 0.0]]), np.zeros(1)))[0]


GIVEN = [(4.0, "stiffness 4"), ([4.0, 4.0, 4.0], "stiffness diag [4, 4, 4]")]


@pytest.mark.slow
@pytest.mark.parametrize(("given_stiffness", "said"), mostly_long(GIVEN, GIVEN[0]), ids=str)
def test_one_number_is_a_stiffness_of_the_tensors_as_increments_take_it(given_stiffness: object, said: str) -> None:
    law, seen = duhem.load("tresca-plane").fix({"s0": 1}), []

    def elastic(trial: np.ndarray, pressure: None, stiffness: np.ndarray) -> np.ndarray:
        seen.append(stiffness)
        return trial

    report = conformance(law, elastic, stiffness=given_stiffness, checks=["feasibility"], max_examples=1, rows=12, tries=0, seed=0)
    taken = setting(law, given_stiffness, None).stiffness
    assert all(np.array_equal(k, taken) for k in seen)
    assert np.array_equal(np.diag(taken), 4.0 / np.array([1.0, 1.0, 2.0 if given_stiffness == 4.0 else 1.0]))
    assert said in report.failures[0].increment
