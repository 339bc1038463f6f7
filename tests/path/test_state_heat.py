"""Paths of laws with a temperature: heat that is dissipated, taken out and exchanged, and the balance of entropy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from duhem import Path
from duhem.path import state_step
from duhem.path.state_path import NoAnswer, StateHistory
from tests.path.states import HEAT, MOST, NUMBERS, ONE, SOFTENING, WARM, YIELDED, R, balanced, made, mutate, order_of, run


@pytest.mark.slow
@pytest.mark.parametrize(("method", "order"), [("implicit", 1), ("extrapolated", 2)])
def test_adiabatic_heating_by_friction_that_decreases(method: str, order: int) -> None:
    """c T' = R (1 - b (T - T0)) u_in'."""

    def exact(found: StateHistory) -> Any:
        return found["T"][-1] - 300.0 - (1.0 - np.exp(-0.5 * R * found["u_in"][-1] / 2.0)) / 0.5

    found = order_of(SOFTENING, exact, None, method, MOST[order], parameters=NUMBERS, state={"T": 300.0})
    assert found == pytest.approx(order, abs=0.2)


def test_the_entropy_of_an_adiabatic_step_grows_by_what_it_dissipates() -> None:
    found = run(SOFTENING, parameters=NUMBERS, state={"T": 300.0}, substeps=6)
    assert found.entropy is not None and found.heat is not None and "adiabatic" in found.why
    gained = found["T"][1:] * np.diff(found.entropy)
    assert gained == pytest.approx(np.diff(found.dissipation), abs=1e-12) and np.abs(found.heat).max() < 1e-12
    stored = found.psi + found["T"] * found.entropy  # the first law, but for what steps lose
    lost = np.diff(found.numerical) + np.diff(found["T"]) * np.diff(found.entropy)
    assert np.diff(stored) == pytest.approx(np.diff(found.work) - lost, abs=2e-12)


def test_a_prescribed_temperature_takes_heat_out() -> None:
    warm = Path.linear(np.column_stack([YIELDED, [300.0] * 3]))
    found = run(SOFTENING, warm, parameters=NUMBERS, substeps=4)
    assert found["sigma"][-1] == pytest.approx(R, rel=1e-13) and found.heat is not None
    assert found.heat[-1] == pytest.approx(-found.dissipation[-1], rel=1e-13) and balanced(found) < 1e-13
    risen = run(SOFTENING, Path.linear(np.column_stack([YIELDED, [300.0, 300.0, 301.0]])), parameters=NUMBERS, substeps=4)
    assert risen["sigma"][-1] == pytest.approx(R / 2, rel=1e-13) and balanced(risen) < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize(("method", "order"), [("implicit", 1), ("extrapolated", 2)])
def test_bodies_warm_an_interface_at_rest(method: str, order: int) -> None:
    """c T' = h (T1 - T)."""
    law = made("abs(sigma) - R", HEAT, WARM, names=("c", "T0", "h"), heat={"T1": "h"})
    path = Path.linear([0.0, 0.0], time=[0.0, 1.0])
    given = ONE | {"c": 2.0, "T0": 300.0, "h": 3.0, "T1": 400.0}

    def exact(found: StateHistory) -> Any:
        assert found.heat is not None and found.heat[-1] == pytest.approx(2.0 * (found["T"][-1] - 300.0), rel=(0.1, 1e-2)[order - 1])
        return (found["T"][-1] - 400.0 + 100.0 * np.exp(-1.5)) / 100.0

    assert order_of(law, exact, path, method, MOST[order], parameters=given, state={"T": 300.0}) == pytest.approx(order, abs=0.2)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new"), [("- heat.sum(axis=1) - inflow", "- 2 * heat.sum(axis=1) - inflow"), ("(t * gained - ", "(0 * gained - ")]
)
def test_a_wrong_balance_of_entropy_is_caught(old: str, new: str, monkeypatch: pytest.MonkeyPatch) -> None:
    mutate(state_step, old, new, monkeypatch)
    with pytest.raises((AssertionError, NoAnswer)):
        test_the_entropy_of_an_adiabatic_step_grows_by_what_it_dissipates()
