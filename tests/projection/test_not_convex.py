"""On a K that is not convex no stationary point passes for the closest one, and on a convex neighbour every closest point passes.

What is closest is read off fine grids of boundaries that are known as curves.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.law.formula_law import Criterion
from duhem.projection.increment import increment
from duhem.projection.projector import Projector
from duhem.projection.residuals import residuals
from duhem.projection.result import ACCURACY, Projection, Residuals, Solution, Status
from tests.long import long_at, long_but, mostly_long
from tests.oracles.drawn_sets import CONVEX, GRID, NOT_CONVEX, law, oval_of


def project(of: Criterion | str, trial: Any, pressure: Any = None, stiffness: Any = 1.0, parameters: Any = None) -> Projection:
    """Where nobody asks whether K is convex."""
    return Projector.of(of, stiffness, parameters)(trial, pressure)


@pytest.mark.slow
@pytest.mark.parametrize("family", mostly_long(NOT_CONVEX, "ovals"))
def test_no_stationary_point_passes_for_the_closest(family: str) -> None:
    rng = np.random.default_rng(1)
    farther = passed = 0
    for _ in range(2):
        g, edge = NOT_CONVEX[family](rng)
        trial = rng.normal(size=(30, 2)) * 2.0
        trial[:3, 0] = trial[3:6, 1] = 0.0  # on the axes of symmetry stationary points are many
        done = project(law(g), trial)
        slip = trial - done.stress
        length = np.linalg.norm(slip, axis=1)
        beyond = np.array([((edge - s) @ n).max() for s, n in zip(done.stress, slip, strict=True)])
        nearest = np.array([np.linalg.norm(edge - u, axis=1).min() for u in trial])
        slips, said = done.status == Status.SLIP, done.residuals.stationary_only()
        assert (length[slips] <= nearest[slips] + GRID).all()
        assert (beyond[slips] <= GRID * length[slips]).all()
        assert (done.status[said] == Status.INACCURATE).all()
        assert (beyond[said] > 0.0).all()  # no alarm without a point of K behind it
        farther += int((said & (length > nearest + GRID)).sum())
        passed += int(slips.sum())
    assert passed > 0 and (farther > 0 or family == "lemniscates")  # none of two equal lobes is farther than the closest


KNOWN: list[tuple[str, tuple[float, float], float]] = [  # of which the last is the distance of the closest point
    (oval_of(0.6)[0], (-3.0, 0.0), 2.596),
    ("min(norm(a, b), norm(a + 3, b)) - 1", (-1.6, 0.1), 0.4036),
    ("(a**2 + b**2)**2 - 2*(a**2 - b**2) - 1/5", (0.0, 1.0), 0.673),
]


@pytest.mark.slow
@pytest.mark.parametrize(("g", "trial", "closest"), KNOWN)
def test_stationary_points_that_nothing_else_tells(g: str, trial: tuple[float, float], closest: float) -> None:
    question = increment(law(g), [trial], None, 1.0, None)
    done = project(question.law, trial)
    solution = Solution(done.stress, done.slip, done.multiplier, done.status == Status.FAILED)
    assert np.linalg.norm(done.stress[0] - trial) > closest
    assert residuals(question, solution, convex=True).worst()[0] <= ACCURACY
    assert done.status[0] == Status.INACCURATE and done.residuals.stationary_only()[0]


@pytest.mark.slow
@pytest.mark.parametrize("family", CONVEX)
def test_convex_neighbours_pass(family: str) -> None:
    rng = np.random.default_rng(2)
    for _ in range(3):
        g, edge = CONVEX[family](rng)
        trial = rng.normal(size=(40, 2)) * 2.0
        done = project(law(g), trial)
        assert set(done.status) <= {Status.STICK, Status.SLIP}
        slips = np.flatnonzero(done.status == Status.SLIP)
        assert slips.size > 10
        nearest = np.array([np.linalg.norm(edge - u, axis=1).min() for u in trial[slips]])
        assert np.abs(np.linalg.norm(trial - done.stress, axis=1)[slips] - nearest).max() <= GRID


@pytest.mark.slow
@pytest.mark.parametrize(
    "g",
    long_at(
        [1, 3, 4, 7],
        [
            "max(abs(a) - 1, abs(b) - 2)",
            "max(norm(a - 1/2, b) - 1, norm(a + 1/2, b) - 1)",
            "max(a + b - 1, a - 2*b - 1, -a - 1)",
            "(abs(a)**(11/10) + abs(b)**(11/10)) - 1",
            "abs(a)**20 + abs(3*b)**20 - 1",
            "norm(a - 9, b) - 1",
            "norm(a, b/1000000) - 1",
            "a**2 - b",
            "abs(a - 2*b) - 1",
        ],
    ),
)
def test_convex_sets_of_all_kinds_pass(g: str) -> None:
    trial = np.random.default_rng(3).normal(size=(40, 2)) * 4.0
    assert set(project(law(g), trial).status) <= {Status.STICK, Status.SLIP}


OVAL = Criterion(
    "oval", "norm(sigma_a, sigma_b)**2 - mu*abs(sigma_n)*(norm(sigma_a, sigma_b) + e*sigma_a)", {"mu": duhem.POSITIVE, "e": duhem.REAL}
)


@pytest.mark.slow
@pytest.mark.parametrize("pressure", long_but([1, 3], [-1e-9, -1.0, -7.3, -1e12]))
def test_the_middle_of_a_dent_is_not_closest_at_any_pressure(pressure: float) -> None:
    trial = np.array([[-3.0, 0.0], [3.0, 0.0], [0.0, 3.0]]) * -pressure
    done = project(OVAL, trial, pressure, parameters={"mu": 1, "e": "0.6"})
    assert done.status.tolist() == [Status.INACCURATE, Status.SLIP, Status.SLIP]
    assert done.residuals.stationary_only().tolist() == [True, False, False]
    assert (project(OVAL, trial, pressure, parameters={"mu": 1, "e": "0.5"}).status == Status.SLIP).all()


LOADS = ("1 + abs(sigma_n)", "abs(sigma_n)**2", "abs(sigma_n)")
STIFFNESSES = (1.0, (1.0, 100.0), ((2.0, 1.0), (1.0, 3.0)))


@pytest.mark.slow
@pytest.mark.parametrize(("load", "stiffness"), mostly_long(product(LOADS, STIFFNESSES), *list(zip(LOADS, STIFFNESSES, strict=True))[::2]))
def test_another_part_of_k_is_seen_at_every_pressure(load: str, stiffness: object) -> None:
    """Two discs, their size and distance growing with the pressure in step."""
    two = Criterion("two", f"min(norm(sigma_a, sigma_b), norm(sigma_a + 3*({load}), sigma_b)) - ({load})", {})
    pressure = -np.array([0.5, 1.0, 3.0, 3.5])
    size = project(two, np.tile([1e3, 0.0], (4, 1)), pressure).stress[:, :1]
    wrong = project(two, size * [-1.6, 0.01], pressure, stiffness)
    assert (wrong.status == Status.INACCURATE).all() and wrong.residuals.stationary_only().all()
    assert (project(two, size * [3.0, 0.0], pressure, stiffness).status == Status.SLIP).all()


@pytest.mark.slow
@pytest.mark.parametrize("width", long_at([3], [0.001, 0.01, 0.1, 0.4]))
def test_the_end_of_a_slot_is_not_closest_however_narrow(width: float) -> None:
    slot = law(f"max(norm(a, b) - 1, min({width} - abs(b), a - 1/2))")
    done = project(slot, [[2.0, 0.0], [2.0, 1.0], [-2.0, 0.0]])
    assert done.status.tolist() == [Status.INACCURATE, Status.SLIP, Status.SLIP]


@pytest.mark.slow
def test_three_forces() -> None:
    two = Criterion("two", "min(norm(a, b, c), norm(a + 3, b, c)) - 1", {}, forces=("a", "b", "c"), pressure=None)
    dent = Criterion("dent", "norm(a, b, c)**2 - (norm(a, b, c) + 3*a/5)", {}, forces=("a", "b", "c"), pressure=None)
    for case, trial in ((two, [-1.6, 0.1, 0.1]), (dent, [-3.0, 0.0, 0.0])):
        assert project(case, [trial, [3.0, 0.0, 0.0]]).status.tolist() == [Status.INACCURATE, Status.SLIP]


def test_only_the_inequality_tells_a_stationary_point() -> None:
    each = np.array([0.0, 1e-3, 0.0, 1e-3])
    found = Residuals(np.zeros(4), np.zeros(4), np.zeros(4), each, np.array([0.0, 0.0, 1e-3, 1e-3]))
    assert found.stationary_only().tolist() == [False, False, True, False]
