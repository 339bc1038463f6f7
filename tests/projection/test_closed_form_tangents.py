"""Tangents of the closed form against differences in many digits and in doubles."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

import duhem
from duhem.projection.result import Status
from tests.long import long_at
from tests.oracles.projection import Exact, closest
from tests.projection.declared_shapes import FIGURE_5, MU, WITH_SHAPE, values

pytestmark = pytest.mark.usefixtures("many_digits")


@pytest.mark.slow
@pytest.mark.parametrize(
    "k", long_at([1], [np.eye(2), np.diag([1.0, 7.0]), np.array([[2.0, 1.0], [1.0, 3.0]])]), ids=["isotropic", "diagonal", "full"]
)
def test_tangents_are_derivatives_of_the_exact_step(k: np.ndarray) -> None:
    rng = np.random.default_rng(11)
    trial, load = rng.normal(size=(25, 2)), rng.uniform(0.1, 3.0, 25)
    done = duhem.project("antoni2007", trial, -load, k, FIGURE_5, tangent=True)
    assert done.tangent is not None and done.tangent_pressure is not None
    h = mpmath.mpf(10) ** -25
    for n in np.flatnonzero(done.status == Status.SLIP):
        t, e = [mpmath.mpf(x) for x in trial[n].tolist()], mpmath.mpf(float(load[n]))
        expected = np.empty((2, 3))
        for j in range(2):
            moved = [[t[i] + s * h * mpmath.mpf(float(k[i, j])) for i in (0, 1)] for s in (1, -1)]
            expected[:, j] = _difference(closest(moved[0], e, MU, k), closest(moved[1], e, MU, k), h)
        expected[:, 2] = _difference(closest(t, e - h, MU, k), closest(t, e + h, MU, k), h)  # sigma_n = -e
        got = np.column_stack([done.tangent[n], done.tangent_pressure[n]])
        assert np.abs(got - expected).max() <= 1e-13 * np.abs(expected).max()


def _difference(after: Exact, before: Exact, h: Any) -> list[float]:
    return [float((after.stress[i] - before.stress[i]) / (2 * h)) for i in (0, 1)]


@pytest.mark.parametrize("name", WITH_SHAPE)
def test_tangents_are_symmetric_within_zero_and_k_and_match_differences(name: str) -> None:
    law = duhem.load(name)
    d = len(law.forces)
    k = np.array([[2.0, 0.6], [0.6, 1.5]]) if d == 2 else np.array([[2.0]])
    rng = np.random.default_rng(12)
    trial, pressure = rng.normal(size=(200, d)) * 0.7, -rng.uniform(0.3, 1.5, 200)
    done = duhem.project(law, trial, pressure, k, values(law), tangent=True)
    assert done.tangent is not None and done.tangent_pressure is not None
    assert np.array_equal(done.tangent, np.swapaxes(done.tangent, 1, 2))
    root = np.linalg.inv(np.linalg.cholesky(k))
    shares = np.linalg.eigvalsh(root @ done.tangent @ root.T)
    assert shares.min() >= -1e-14 and shares.max() <= 1 + 1e-14
    assert {bool((t == k).all()) for t in done.tangent} == {True, False}
    h = 1e-6

    def stress(u: np.ndarray, p: np.ndarray) -> np.ndarray:
        return duhem.project(law, trial + u @ k, pressure + p, k, values(law)).stress

    zero = np.zeros(1)
    columns = [(stress(h * v, zero) - stress(-h * v, zero)) / (2 * h) for v in np.eye(d)]
    columns.append((stress(np.zeros(d), zero + h) - stress(np.zeros(d), zero - h)) / (2 * h))
    got = np.concatenate([done.tangent, done.tangent_pressure[:, :, None]], axis=2)
    wrong = np.abs(np.stack(columns, axis=2) - got).max(axis=(1, 2))
    assert np.quantile(wrong, 0.97) <= 1e-6  # all but what crosses from stick to slip or over a kink within h
