"""Increments of laws of a stress tensor: one number for the stiffness is meant of the tensors, whose closest point is known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem import Criterion
from duhem.expression.vocabulary import rows

TRIALS = np.random.default_rng(0).uniform(-1.0, 2.0, (3, 6))


def _tensor(components: np.ndarray) -> np.ndarray:
    return np.array(rows(*components))


def _cut(trial: np.ndarray) -> np.ndarray:
    """Rankine: eigenvalues above 1 become 1."""
    values, vectors = np.linalg.eigh(trial)
    return np.asarray(vectors @ np.diag(np.minimum(values, 1.0)) @ vectors.T)


def _returned(trial: np.ndarray) -> np.ndarray:
    """Von Mises: the deviator is shortened (radial return)."""
    mean = np.trace(trial) / 3 * np.eye(3)
    deviator = trial - mean
    return np.asarray(mean + deviator * min(1.0, 1.0 / np.sqrt(1.5 * (deviator * deviator).sum())))


CASES = {"principal(s, 1) - 1": _cut, "sqrt(3*J2(s)) - 1": _returned}


@pytest.mark.slow
@pytest.mark.parametrize("method", ["auto", "cvxpy"])
@pytest.mark.parametrize("g", CASES)
def test_the_closest_point_is_that_of_tensors(g: str, method: str) -> None:
    closest: Callable[[np.ndarray], np.ndarray] = CASES[g]
    law = Criterion(name="x", g=g, stress={"name": "s", "kind": "3d"}, pressure=None)
    done = duhem.project(law, TRIALS, stiffness=2.0, method=method)
    for trial, stress, slip in zip(TRIALS, done.stress, done.slip, strict=True):
        assert _tensor(stress) == pytest.approx(closest(_tensor(trial)), abs=1e-10)
        strain = _tensor(slip * np.array([1, 1, 1, 0.5, 0.5, 0.5]))  # the engineering shears halved
        assert 2.0 * strain == pytest.approx(_tensor(trial) - _tensor(stress), abs=1e-10)
        assert slip @ stress == pytest.approx((strain * _tensor(stress)).sum(), abs=1e-10)


def test_the_isotropic_stiffness_of_a_derivation_is_that_of_tensors() -> None:
    law = Criterion(name="x", g="J2(s) - 1", stress={"name": "s", "kind": "plane"}, pressure=None)
    k = duhem.derive(law, stiffness="isotropic").names.stiffness
    assert list(k.diagonal() / k[0, 0]) == [1, 1, sp.Rational(1, 2)]
