"""What one process asks, another answers: laws, verdicts, histories and derivations pass through a pool of processes."""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import duhem

FILE = """\
[criterion]
name = "shifted"
g = "norm((sigma_a - shift*abs(sigma_n))/mu_a, sigma_b/mu_b) - abs(sigma_n)"
constraints = ["shift < mu_a"]
[parameters]
mu_b = { value = 0.15 }
shift = { min = 0, max = 0.5 }
mu_a = {positive = true}
"""


@pytest.fixture(scope="module")
def pool():
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield pool


@duhem.criterion(source="nobody")
def known_here_only(sigma_a, sigma_b, sigma_n, mu):
    """A law that the other process has never heard of by name."""
    return abs(sigma_a) + abs(sigma_b) - mu * abs(sigma_n)


def verdicts(verification):
    return [(r.claim, r.verdict, r.method, r.scope, r.detail, r.witness) for r in verification.results]


@pytest.mark.slow
def test_a_law_verifies_alike_in_another_process(pool, tmp_path):
    (tmp_path / "shifted.toml").write_text(FILE)
    witnesses = 0
    for law in ("coulomb", duhem.load("radial-flow"), duhem.load(tmp_path / "shifted.toml"), known_here_only):
        there = pool.submit(duhem.verify, law).result()
        here = duhem.verify(law)
        assert verdicts(there) == verdicts(here) and there.criterion == here.criterion
        assert there.left_out == here.left_out and there.remarks == here.remarks
        witnesses += sum(r.witness is not None for r in there.results)
    assert witnesses


@pytest.mark.slow
def test_a_path_runs_alike_in_another_process(pool):
    path = duhem.Path.random(seed=3, points=5, scale=0.3, pressure=-1.0)
    for method in ("implicit", "exact"):
        options = {"stiffness": [1.0, 2.0], "parameters": {"mu_a": 0.2, "mu_b": 0.1}, "method": method}
        law = duhem.load("orthotropic")
        there, here = pool.submit(duhem.simulate, law, path, **options).result(), duhem.simulate(law, path, **options)
        assert np.array_equal(there.to_array(), here.to_array()) and there.why == here.why and here.dissipation[-1] > 0.0


@pytest.mark.slow
def test_a_derivation_is_alike_in_another_process(pool):
    for law in ("coulomb", known_here_only):
        there, here = pool.submit(duhem.derive, law).result(), duhem.derive(law)
        assert there == here and there.latex() == here.latex()


@pytest.mark.slow
def test_a_projection_is_alike_in_another_process(pool):
    asked = {"law": "coulomb", "trial": [[0.3, -0.4], [0.01, 0.0]], "sigma_n": -1.0, "stiffness": 1.0, "parameters": {"mu": 0.2}}
    there = pool.submit(duhem.project, *asked.values()).result()
    here = duhem.project(*asked.values())
    assert np.array_equal(there.stress, here.stress) and np.array_equal(there.status, here.status) and there.method == here.method
