"""Sets that random points miss: small ones far from 0, and thin ones; and what then is said of them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from duhem import Criterion, verify
from duhem.proof.search.boundary_points import lowest
from duhem.proof.verdict import Verdict
from tests.oracles.reevaluation import confirmed


def far_ball(x: Any) -> Any:
    return np.linalg.norm(np.asarray(x) - np.array([40.0, -25.0, 3.0, 0.5]), axis=-1) - 1e-3


def far_slab(x: Any) -> Any:
    p = np.asarray(x)
    return np.maximum(np.abs(p[..., 0] + 3 * p[..., 1] - 18) - 1e-6, np.linalg.norm(p - 5, axis=-1) - 1)


def pit(x: Any) -> Any:
    """0 in its lowest point alone, and without a value beyond."""
    p = np.asarray(x)
    return np.where(p[..., 0] < 1, np.abs(p).sum(axis=-1) + 1e-9, np.nan)


@pytest.mark.parametrize(("value", "d", "found"), [(far_ball, 4, True), (far_slab, 3, True), (pit, 3, False)])
def test_downhill_into_the_set(value: Any, d: int, found: bool) -> None:
    point = lowest(value, d, np.random.default_rng(1), (-2, 2))
    assert (point is not None) is found
    assert point is None or value(point) <= 0


@pytest.mark.slow
@pytest.mark.parametrize("cut", ["", ", b + c - 5"])
def test_the_slip_of_a_small_set_far_from_zero(cut: str) -> None:
    g = "norm(a - 40, 3*b + 2*a, c + a) - 1/10"
    g = f"max({g}{cut})" if cut else g
    law = Criterion(name="law", g=g, forces=("a", "b", "c"), pressure=None)
    result = verify(law, claims=["dissipation"])["dissipation"]
    assert result.verdict is Verdict.REFUTED and result.witness is not None
    assert confirmed(law, "dissipation", result.witness)
