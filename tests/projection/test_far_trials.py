"""Trials so far from K that it is lost in their rounding: an answer is that of a clip or of a shrunk length, or it is not vouched for.

Sizes of K from 1e-150 to 1e150 and trials up to 1e300, with inner points and without.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import duhem
from duhem.projection.result import ACCURACY, Array
from tests.long import mostly_long

WIDE = {"w": duhem.POSITIVE}
WAYS = np.array([(1.0, 0.0), (0.6, 0.8), (1.0, 1.0), (-1.0, 0.5), (-0.3, 1e-3)])
FAR = (1, 6, 15, 16, 17, 40, 150, 200, 300)
SIZES = (-150, -100, -30, 0, 30, 100, 150)
Right = Callable[[Array, float], Array]


def _box(high: float) -> Right:
    return lambda trial, w: np.clip(trial, [-w, -high * w], [w, high * w])


def _disc(trial: Array, w: float) -> Array:
    way = trial / np.abs(trial).max(axis=1, keepdims=True)
    return w * way / np.linalg.norm(way, axis=1, keepdims=True)


def _leaning(trial: Array, w: float) -> Array:
    along = np.clip(0.5 * trial[:, 0] + 0.5 * trial[:, 1], -w, w)
    return np.stack([along, along], axis=1)


SHAPES: dict[str, Right] = {
    "max(abs(a) - w, abs(b) - w)": _box(1.0),
    "max(abs(a) - w, abs(b))": _box(0.0),
    "abs(b) + pos(abs(a) - w)": _box(0.0),
    "b**2 + pos(abs(a) - w)**2": _box(0.0),
    "max(abs(a) - w, abs(a - b))": _leaning,
    "norm(a, b) - w": _disc,
    "a**2 + b**2 - w**2": _disc,
}
SHOWN = [("max(abs(a) - w, abs(b))", 0), ("norm(a, b) - w", -150)]


@pytest.mark.slow
@pytest.mark.parametrize(("g", "size"), mostly_long([(g, size) for g in SHAPES for size in SIZES], *SHOWN))
def test_what_is_vouched_for_is_right_however_far_the_trial(g: str, size: int) -> None:
    trial = np.concatenate([10.0 ** (size + far) * WAYS for far in FAR if size + far <= 300])
    w, law = 10.0**size, duhem.Criterion("far", g, parameters=WIDE, forces=("a", "b"), pressure=None)
    found = duhem.project(law, trial, parameters={"w": w}, method="newton")
    off = np.abs(found.stress - SHAPES[g](trial, w)).max(axis=1)
    slips = found.status == duhem.Status.SLIP
    assert slips.any()
    assert (off[slips] <= ACCURACY * w).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "trial", "w"),
    [
        ("max(abs(a) - w, abs(b))", (0.0, 1e16), 1.0),  # across a segment
        ("max(abs(a) - w, abs(a - b))", (1e17, -1e17), 1.0),
        ("norm(a - 3*w, b - 4*w) - 5*w", (-3e16, -4e16), 0.1),  # a round boundary, through no stress to rounding
        ("a**2 + b**2 - w*b", (0.0, -1e20), 1.0),
        ("max(norm(a, b) - w, a, b)", (1e3, 2e3), 1e-12),  # a corner
    ],
)
def test_no_stress_is_vouched_for_where_it_is_closest(g: str, trial: tuple[float, float], w: float) -> None:
    law = duhem.Criterion("far", g, parameters=WIDE, forces=("a", "b"), pressure=None)
    found = duhem.project(law, [trial], parameters={"w": w}, method="newton")
    assert found.status[0] == duhem.Status.SLIP
    assert not found.stress.any()


@pytest.mark.parametrize(
    ("g", "trial", "w", "residual"),
    [
        ("max(abs(a) - w, abs(b))", (1e16, 5e15), 1.0, "stationarity"),
        ("max(abs(a) - w, abs(a - b))", (1e17, 1e17), 1.0, "stationarity"),
        ("norm(a, b) - w", (0.6e180, 0.8e180), 1e-150, "complementarity"),
    ],
)
def test_no_stress_is_refused_where_k_goes_on_towards_the_trial(g: str, trial: tuple[float, float], w: float, residual: str) -> None:
    from duhem.projection.increment import posed, setting
    from duhem.projection.residuals import residuals
    from duhem.projection.result import Solution

    law = duhem.Criterion("far", g, parameters=WIDE, forces=("a", "b"), pressure=None)
    asked = posed(setting(law, 1.0, {"w": w}), [trial], None)
    multiplier = np.array([np.abs(trial).sum() if "max" in g else 1e180])
    found = residuals(asked, Solution(np.zeros((1, 2)), np.array([trial]), multiplier, np.zeros(1, dtype=bool)), convex=True)
    assert getattr(found, residual)[0] > ACCURACY
