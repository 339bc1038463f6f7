"""Coordinates in which a set is round: found whatever linear map it went through, and polynomials in them exactly."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from duhem.proof.search.round_coordinates import in_coordinates, round_coordinates

F = Fraction


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
    sizes = np.linalg.svd(inverse @ np.array(axes, dtype=float), compute_uv=False)
    assert sizes.max() < 4 * sizes.min()  # among the rays met it is less than 2.5


def test_what_is_round_or_never_met_is_left() -> None:
    u = directions(3)
    assert round_coordinates(lambda rays: 1 + rays[:, 0] ** 2, u, 2.5) is None
    assert round_coordinates(lambda rays: np.full(len(rays), np.inf), u, 2.5) is None


def test_a_polynomial_in_other_coordinates() -> None:
    axes = ((F(2), F(0)), (F(-1, 3), F(5)))
    p = {(2, 1): F(3), (0, 3): F(1, 7), (1, 0): F(-1), (0, 0): F(-4)}
    assert in_coordinates({}, axes) == {}
    q = in_coordinates(p, axes)
    for w in ((F(1), F(2)), (F(-3, 4), F(1, 9)), (F(0), F(5))):
        x = [sum(a * b for a, b in zip(row, w, strict=True)) for row in axes]
        assert sum(c * w[0] ** i * w[1] ** j for (i, j), c in q.items()) == sum(c * x[0] ** i * x[1] ** j for (i, j), c in p.items())
