"""Tangents of the generic projector against differences."""

from __future__ import annotations

import numpy as np
import pytest

import duhem
from duhem.projection import newton
from duhem.projection.implicit_tangent import tangent
from tests.oracles.optimality import CONVEX, R, increment

SMOOTH = [*(CONVEX[i] for i in (0, 6, 9, 10, 11, 16, 17, 24)), ("superellipse", {"mu_a": R(1, 5), "mu_b": R(1, 10), "p": R(4)})]


@pytest.mark.slow
@pytest.mark.parametrize(("law", "values"), SMOOTH, ids=lambda x: x if isinstance(x, str) else "")
def test_tangent_against_differences(law, values):
    rng = np.random.default_rng(8)
    d = len(duhem.load(law).forces)
    q, _ = np.linalg.qr(rng.standard_normal((d, d)))
    k = (q * np.geomspace(1.0, 8.0, d)) @ q.T
    k = (k + k.T) / 2
    trial, pressure = rng.standard_normal((12, d)), -rng.uniform(0.5, 2, 12)

    def stress(move=0.0, load=0.0):
        return newton.solve(increment(law, trial + move, pressure + load, k, **values)).stress

    question = increment(law, trial, pressure, k, **values)
    of_u, of_pressure = tangent(question, newton.solve(question))
    np.testing.assert_array_equal(of_u, np.swapaxes(of_u, 1, 2))
    root = np.linalg.inv(np.linalg.cholesky(k))
    eigenvalues = np.linalg.eigvalsh(root @ of_u @ root.T)
    assert eigenvalues.min() > -1e-14 and eigenvalues.max() < 1 + 1e-14
    h = 1e-4
    for i in range(d):
        e = k[i] * h  # h along u_i
        slope = (8 * (stress(e) - stress(-e)) - (stress(2 * e) - stress(-2 * e))) / (12 * h)
        near = np.abs(slope - of_u[:, i]).max(axis=1)
        assert np.median(near) < 1e-9 and near.max() < 1e-4
    if of_pressure is None:
        assert duhem.load(law).pressure is None
        return
    slope = (8 * (stress(load=h) - stress(load=-h)) - (stress(load=2 * h) - stress(load=-2 * h))) / (12 * h)
    near = np.abs(slope - of_pressure).max(axis=1)
    assert np.median(near) < 1e-9 and near.max() < 1e-4


def test_tangent_at_corners_and_inside():
    question = increment("box", [[0.9, 0.8], [0.9, 0.1], [0.0, 0.1]], -1.0, (2.0, 3.0), mu_a=R(1, 2), mu_b=R(1, 4))
    of_u, of_pressure = tangent(question, newton.solve(question))
    np.testing.assert_allclose(of_u, [np.zeros((2, 2)), np.diag([0.0, 3.0]), np.diag([2.0, 3.0])], atol=1e-15)
    np.testing.assert_allclose(of_pressure, [[-0.5, -0.25], [-0.5, 0.0], [0.0, 0.0]], atol=1e-15)


@pytest.mark.parametrize("name", ["mujoco-pyramidal", "rankine"])
def test_a_tip_under_more_normals_than_the_push_needs_stays(name: str) -> None:
    """|a| + |b| + |c| <= 1 pushed along an axis: two of the four normals at the tip make the push, and none lets it go."""
    law = duhem.load(name)
    values = {p: 1 for p, domain in law.parameters.items() if domain.value is None}
    trial = {"mujoco-pyramidal": [0.0, 2.0, 0.0], "rankine": [1.5, 1.5, 1.5]}[name]
    done = duhem.project(law, trial, -1.0 if law.pressure else None, parameters=values, tangent=True)
    assert done.tangent is not None
    np.testing.assert_allclose(done.tangent[0], 0.0, atol=1e-12)
    shifted = duhem.project(law, np.array(trial) + 1e-3 * np.eye(3), -1.0 if law.pressure else None, parameters=values)
    np.testing.assert_allclose(shifted.stress, np.tile(done.stress, (3, 1)), atol=1e-12)
