"""Eigenvalues and axes of symmetric matrices in plain loops, against many digits: far apart, close, equal, large and small."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

from duhem.expression.error_bounds import Bounded, eigenvalue
from duhem.expression.principal_axes import greatest, principal_axes

UNIT = 2.0**-53
SPECTRA = {
    "apart": (0.3, -1.1, 0.7),
    "double above": (1.0, 1.0, -0.4),
    "double below": (-0.4, -0.4, 1.0),
    "close": (1.0, 1.0 + 1e-9, -2.0),
    "closer": (1.0, 1.0 + 3e-15, -2.0),
    "triple": (0.7, 0.7, 0.7),
    "nearly triple": (1.0, 1.0 + 1e-13, 1.0 - 1e-10),
    "no third invariant": (1.0, 0.0, -1.0),
    "of any size": (1e6, -1e-3, 1e-9),
    "small": (1e-200, -3e-200, 2e-201),
    "large": (1e200, -3e200, 2e199),
}


def _entries(matrix: np.ndarray) -> list[float]:
    return [float(matrix[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]


def _drawn(spectrum: Any, seed: int) -> np.ndarray:
    turn, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    whole = turn @ np.diag(spectrum) @ turn.T
    return np.asarray(0.5 * (whole + whole.T))


@pytest.mark.parametrize("name", SPECTRA)
def test_they_are_those_in_many_digits(name: str) -> None:
    for seed in range(20):
        matrix = _drawn(SPECTRA[name], seed)
        size, axes = np.abs(matrix).max(), np.empty((4, 3))
        principal_axes(axes, *_entries(matrix))
        with mpmath.workdps(60):
            exact = sorted(mpmath.eigsy(mpmath.matrix(matrix.tolist()), eigvals_only=True))
        off = [abs(float(e - mpmath.mpf(float(v)))) for e, v in zip(exact, axes[0], strict=True)]
        assert max(off) <= 16 * UNIT * size
        assert axes[1:] @ axes[1:].T == pytest.approx(np.eye(3), abs=16 * UNIT)
        assert matrix / size @ axes[1:].T == pytest.approx(axes[1:].T * (axes[0] / size), abs=24 * UNIT)
        assert greatest(*_entries(matrix)) == axes[0, 2]
        assert off[2] <= eigenvalue(axes[0, 2], [Bounded(e, 0.0) for e in _entries(matrix)]).bound


@pytest.mark.parametrize("values", [(1.0, 2.0, 3.0), (3.0, 2.0, 1.0), (0.1, 0.1, 0.7), (0.3, 0.3, 0.3), (0.0, 0.0, 0.0), (-0.1, 5.0, 0.0)])
def test_a_diagonal_matrix_keeps_its_entries(values: tuple[float, ...]) -> None:
    axes = np.empty((4, 3))
    principal_axes(axes, *values, 0.0, 0.0, 0.0)
    assert axes[0].tolist() == sorted(values)
    assert sorted(np.abs(axes[1:]).ravel().tolist()) == [0.0] * 6 + [1.0] * 3


@pytest.mark.parametrize("entry", [float("nan"), float("inf"), -float("inf")])
def test_what_is_undefined_stays_so(entry: float) -> None:
    for place in range(6):
        given, axes = [1.0, 2.0, 3.0, 0.1, 0.2, 0.3], np.empty((4, 3))
        given[place] = entry
        with np.errstate(all="ignore"):
            principal_axes(axes, *given)
        assert np.isnan(axes).all()
