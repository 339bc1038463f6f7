"""Dormand and Prince's steps on plain numbers, against known motions and SciPy's steps."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, exp, pi, sin

import numpy as np
import pytest
from scipy.integrate import DOP853

from duhem.errors import DuhemError
from duhem.path.slip_equation import followed

ATOL = [1e-16] * 2


def turning(time: float, state: Sequence[float]) -> list[float]:
    """Once around in a time of 1."""
    return [-2.0 * pi * state[1], 2.0 * pi * state[0]]


def test_a_circle_is_closed_and_known_within_its_steps() -> None:
    run = followed(turning, 0.0, [1.0, 0.0], ATOL, [], kept=True)
    assert run.time == 1.0
    np.testing.assert_allclose(run.state, [1.0, 0.0], rtol=0, atol=2e-13)
    for time in np.linspace(0.03, 1.0, 40).tolist():
        np.testing.assert_allclose(run.at(time), [cos(2.0 * pi * time), sin(2.0 * pi * time)], rtol=0, atol=2e-12)


@pytest.mark.parametrize(("first", "second", "at"), [(0.5, 0.8, 1.0 / 12.0), (0.9, 0.3, None)])
def test_the_first_event_on_the_way_ends_it(first: float, second: float, at: float | None) -> None:
    events = [lambda _, y: y[1] - first, lambda _, y: y[1] - second]
    run = followed(turning, 0.0, [1.0, 0.0], ATOL, events, kept=False)
    assert run.first is (at is not None)
    level = min(first, second)
    np.testing.assert_allclose(run.state, [np.sqrt(1.0 - level**2), level], rtol=0, atol=1e-13)
    assert at is None or run.time == pytest.approx(at, abs=1e-13)


def test_one_step_is_that_of_scipy() -> None:
    def slope(time: float, state: Sequence[float]) -> list[float]:
        return [state[1] * time, -state[0] * exp(state[1])]

    from duhem.path.slip_equation import _step

    theirs = DOP853(lambda t, y: np.array(slope(t, y)), 0.0, np.array([1.0, 0.5]), 1.0, rtol=1e-3, atol=1e-3, first_step=0.1)
    theirs.step()
    end, *_ = _step(2)(slope, 0.0, 0.1, (1.0, 0.5), slope(0.0, (1.0, 0.5)))
    assert theirs.t == 0.1
    np.testing.assert_allclose(end, theirs.y, rtol=1e-15)


def test_a_way_without_a_value_is_not_followed() -> None:
    def ends(time: float, state: Sequence[float]) -> list[float]:
        return [-1.0 / (1.0 - 2.0 * time) ** 2]

    with pytest.raises(DuhemError, match="steps become too small"):
        followed(ends, 0.0, [1.0], [1e-16], [], kept=False)
