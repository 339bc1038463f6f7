"""Coordinates in which a set is round: found whatever linear map it went through."""

from __future__ import annotations

import numpy as np
import pytest

from duhem.proof.search.dents import round_coordinates


def directions(n: int) -> np.ndarray:
    drawn = np.random.default_rng(1).standard_normal((80 * n, n))
    return drawn / np.linalg.norm(drawn, axis=1, keepdims=True)


@pytest.mark.parametrize(("n", "length"), [(2, 1e4), (3, 1e3), (6, 30.0)])
def test_a_long_ellipsoid_is_made_round(n: int, length: float) -> None:
    u, turn = directions(n), np.linalg.qr(np.random.default_rng(2).standard_normal((n, n)))[0]
    inverse = np.diag(1e-3 / np.geomspace(1, length, n)) @ turn  # and of any size

    def reach(rays: np.ndarray) -> np.ndarray:
        return np.asarray(1 / np.linalg.norm(rays @ inverse.T, axis=1))

    assert reach(u).max() > 2.5 * reach(u).min()
    axes = round_coordinates(reach, u, 2.5)
    assert axes is not None
    sizes = np.linalg.svd(inverse @ axes, compute_uv=False)
    assert sizes.max() < 4 * sizes.min()  # among the rays met it is less than 2.5


def test_what_is_round_or_never_met_is_left() -> None:
    u = directions(3)
    assert round_coordinates(lambda rays: 1 + rays[:, 0] ** 2, u, 2.5) is None
    assert round_coordinates(lambda rays: np.full(len(rays), np.inf), u, 2.5) is None
