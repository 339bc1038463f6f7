"""A point's answer and status are its own: no digit of them depends on the points beside it, and of the residuals only the last."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import duhem
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Metric
from duhem.projection.newton import _solved
from duhem.projection.projector import _NearerSearch
from duhem.projection.result import Projection, Residuals
from duhem.projection.row_by_row import any_of, times
from duhem.projection.scaled_formula import level
from tests.campaigns.number_families import BUILT_IN, beyond
from tests.long import mostly_long

SHARES = (1 + 1e-9, 2.3)


def bits(done: Projection, i: int) -> list[bytes]:
    """What is answered of one point."""
    return [x[i].tobytes() for x in (done.stress, done.slip, done.multiplier, done.dissipation, done.status)]


def measures(done: Projection, i: int) -> list[float]:
    """Its residuals."""
    return [float(getattr(done.residuals, name)[i]) for name in Residuals.__dataclass_fields__]


def together_and_alone(law: str | Criterion, trial: Any, pressure: Any, **asked: Any) -> None:
    done = duhem.project(law, trial, pressure, **asked)
    for i, one in enumerate(np.asarray(trial)):
        alone = duhem.project(law, [one], None if pressure is None else pressure[i : i + 1], **asked)
        assert bits(alone, 0) == bits(done, i), i
        assert measures(alone, 0) == pytest.approx(measures(done, i), rel=1e-12, abs=1e-12), i  # few points are judged on plain numbers


@pytest.mark.slow
@pytest.mark.parametrize("case", mostly_long(range(len(BUILT_IN)), 2, 6, 16))
def test_points_do_not_know_of_each_other(case: int) -> None:
    law, parameters, strengths = BUILT_IN[case]
    d = len(duhem.load(law).forces)
    asked = beyond(law, parameters, strengths, SHARES, 2.0 ** np.arange(d))
    loads = 2.0 ** np.linspace(-1.5, 1.5, len(asked.trial))
    trial = asked.trial * (loads[:, None] if asked.pressure else 1.0)
    pressure = asked.pressure and asked.pressure * loads
    together_and_alone(law, trial, pressure, stiffness=asked.stiffness, parameters=asked.parameters, method="newton", convex="assume")


def test_products_and_systems_are_of_one_row() -> None:
    chance = np.random.default_rng(0)
    rows, matrix = chance.standard_normal((37, 3)), chance.standard_normal((3, 3))
    assert all(times(rows[i : i + 1], matrix).tobytes() == times(rows, matrix)[i].tobytes() for i in range(len(rows)))
    assert times(rows, matrix) == pytest.approx(rows @ matrix, rel=1e-14)
    many = chance.standard_normal((5, 3, 3))
    found = _solved(many, rows[:5])
    many[3] = 0.0  # is singular, and no other system is solved otherwise for it
    assert np.delete(_solved(many, rows[:5]), 3, axis=0).tobytes() == np.delete(found, 3, axis=0).tobytes()


def test_k_is_looked_at_by_pressures_of_its_own() -> None:
    law = Criterion("bent", "norm(sigma_a, sigma_b) - abs(sigma_n) - sigma_n**2")
    search = _NearerSearch(level(law.g, law.force_symbols(), law.symbols()["sigma_n"]), Metric.of(np.eye(2)), True)
    pressure = np.array([-0.3, -40.0, 0.0, -0.26, -3.1, -1e9])

    def looks(pressure: np.ndarray) -> dict[float, float | None]:
        at = search.looked_at(np.arange(len(pressure)), pressure)
        return {float(pressure[i]): look for rows, look in at for i in rows}

    together = looks(pressure)
    assert together == {-0.3: -0.25, -40.0: -32.0, 0.0: 0.0, -0.26: -0.25, -3.1: -2.0, -1e9: -(2.0**29)}
    assert all(looks(np.array([one])) == {one: look} for one, look in together.items())


@pytest.mark.parametrize("d", [1, 2, 3, 4, 6, 8])
def test_one_of_each_row_is_seen(d: int) -> None:
    """As words or column by column, whatever the order in memory."""
    rows = np.random.default_rng(1).random((200, d)) < 0.2
    for given in (rows, np.asfortranarray(rows), rows[::2]):
        np.testing.assert_array_equal(any_of(given), given.any(axis=1))
    assert any_of(rows[:0]).shape == (0,)


@pytest.mark.parametrize("n", [1, 9, 40])
@pytest.mark.parametrize("compiled", [False, True])
def test_a_load_that_overflows_has_failed_beside_others_too(n: int, compiled: bool) -> None:
    """Every trial would lie inside, although nothing is known of K."""
    pressure = np.full(n, -1e300)
    pressure[1:] = -1e-5
    asked = {"parameters": {"mu": 1e10, "cohesion": 1.0}, "compiled": compiled}
    status = duhem.prepare("cohesive", **asked)(np.tile([3.0, 4.0], (n, 1)), pressure).status
    assert status.tolist() == [duhem.Status.FAILED] + [duhem.Status.STICK] * (n - 1)
    done = duhem.project("cohesive", np.tile([3.0, 4.0], (n, 1)), pressure, **asked)
    assert done.status.tolist() == status.tolist() and np.isnan(done.stress[0]).all() and (done.stress[1:] == [3.0, 4.0]).all()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("n", [1, 9, 40])
def test_a_multiplier_that_overflows_has_failed_without_a_warning(n: int) -> None:
    status = duhem.prepare("coulomb", parameters={"mu": 0.3})(np.tile([1.7e308, -1.7e308], (n, 1)), np.full(n, -1.0)).status
    assert (status == duhem.Status.FAILED).all()
