"""What each step of a law with a state satisfies, and that wrong steps are caught: conditions, energies and tangents."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import duhem
from duhem import Criterion, InputError, Path
from duhem.law.state import Variable
from duhem.path import state_step
from duhem.path.state_path import NoAnswer
from tests.path.states import (
    ADHESIVE,
    BINGHAM,
    FREDERICK,
    GAMMA,
    NORTON,
    NUMBERS,
    ONE,
    PRAGER,
    RECOVERING,
    SLIP,
    SOFTENING,
    YIELDED,
    C,
    H,
    K,
    R,
    balanced,
    made,
    mutate,
    run,
)


def conditions(points: list[float], radius: float, modulus: float, gamma: float) -> None:
    """The conditions of every step of Armstrong and Frederick's law by hand: they are what an implicit step is, and no other."""
    given = {"R": radius, "k": 10.0, "C": modulus, "gamma": gamma}
    found = run(FREDERICK, Path.linear([0.0, *points]), parameters=given, substeps=2)
    sigma, back = 10.0 * (found["u"] - found["u_in"]), -modulus * found["alpha"]
    steps, along = np.diff(found.multiplier[:, 0]), np.sign(sigma + back)[1:]
    size = radius + np.abs(sigma).max()
    assert found["sigma"] == pytest.approx(sigma, abs=1e-12 * size) and found["X"] == pytest.approx(back, abs=1e-12 * size)
    assert (steps >= 0.0).all() and (np.abs(sigma + back) - radius).max() <= 1e-11 * size
    assert np.abs(steps * (np.abs(sigma + back)[1:] - radius)).max() <= 1e-11 * size
    assert np.diff(found["u_in"]) == pytest.approx(steps * along, abs=1e-11)
    assert np.diff(found["alpha"]) == pytest.approx(steps * (along - gamma * found["alpha"][1:]), abs=1e-11)
    assert balanced(found) < 1e-12 and (np.diff(found.dissipation) >= -1e-15).all()
    away = np.diff(found["u"] - found["u_in"]), np.diff(found["alpha"])
    assert np.diff(found.numerical) == pytest.approx(5.0 * away[0] ** 2 + modulus / 2 * away[1] ** 2, abs=1e-12 * size)


sizes = st.floats(0.05, 20.0)


@pytest.mark.slow
@settings(max_examples=20, deadline=None, derandomize=True)
@given(st.lists(st.floats(-3.0, 3.0), min_size=1, max_size=3), sizes, sizes, st.floats(0.01, 10.0))
def test_every_step_of_armstrong_and_frederick(points: list[float], radius: float, modulus: float, gamma: float) -> None:
    conditions(points, radius, modulus, gamma)


MUTANTS = [
    ('moved = np.einsum("ns,nsi->ni", at.multiplier, flow) + steps', 'moved = -np.einsum("ns,nsi->ni", at.multiplier, flow) + steps'),
    ("taken = np.concatenate([forces, at.chi], axis=1)", "taken = np.concatenate([forces, base], axis=1)"),
    ("forces = 0.0 - (force[:, place]", "forces = 0.0 + (force[:, place]"),
    ("by_multiplier, psi, forces,", "by_multiplier, -psi, forces,"),
    ("* (after - before)", "* (before - after)"),
    ("np.asarray(begun - end +", "np.asarray(2.0 * (begun - end) +"),
    ("new.active[rows, most] |= excess[rows, most] > KKT", "new.active[rows, most] |= excess[rows, most] > 2.0"),
    ("np.where(at.active, g, at.multiplier)", "np.where(at.active, 1.001 * g + 0.001, at.multiplier)"),
    ("axis=1) + np.finfo(np.float64).tiny, by_state", "axis=1) + 1e9, by_state"),
]


@pytest.mark.parametrize(("old", "new"), MUTANTS)
def test_a_wrong_step_is_caught(old: str, new: str, monkeypatch: pytest.MonkeyPatch) -> None:
    conditions([1.0, -0.5], R, C, GAMMA)
    mutate(state_step, old, new, monkeypatch)
    with pytest.raises((AssertionError, NoAnswer)):
        conditions([1.0, -0.5], R, C, GAMMA)


@pytest.mark.parametrize("viscous", [False, True])
@pytest.mark.parametrize("energy", ["50*pos(u - p)**2 + 5*neg(u - p)**2", "50*abs(u - p)**(5/2)"])
def test_the_energies_of_a_step_balance_where_second_derivatives_jump(energy: str, viscous: bool) -> None:
    """Steps from u > p to u < p, such as those of a contact that opens: what they lose is no integral by a quadrature of psi''."""
    variables = {"u": Variable("s", observable=True), "p": Variable("s")}
    g = "pos(abs(s) - 1)**2/2" if viscous else "abs(s) - 1"
    law = Criterion("one-sided", g, {}, ("s",), None, energy=energy, variables=variables, viscous=viscous)
    for method in ("implicit", "extrapolated"):
        found = run(law, Path.linear([0.0, 0.5, -0.5, 1.0], time=[0, 1, 2, 3]), substeps=4, method=method)
        assert balanced(found) < 1e-13
        if method == "implicit":  # what a step loses of a convex energy is never negative
            assert (np.diff(found.numerical) >= -1e-14).all() and found.numerical[-1] > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "path", "asked"),
    [
        (FREDERICK, Path.linear(YIELDED), {"parameters": ONE | {"C": C, "gamma": GAMMA}}),
        (RECOVERING, Path.linear(YIELDED, time=YIELDED), {"parameters": ONE | {"C": C, "gamma": GAMMA, "c": 2.0, "m": 3.0}}),
        (SOFTENING, Path.linear(YIELDED), {"parameters": NUMBERS, "state": {"T": 300.0}}),
        (NORTON, Path.linear([[0.0, 0.0], [0.3, 0.4]], time=[0, 1]), {"parameters": {"A": 2.0, "n": 3.0}, "stiffness": 10.0}),
        (ADHESIVE, Path.linear([0.0, 0.5]), {"parameters": {"R": 1e3, "k": K, "w": 2.0}, "state": {"beta": 1.0}}),
    ],
)
def test_the_tangent_is_the_slope_of_the_step(law: Criterion, path: Path, asked: Any) -> None:
    found = run(law, path, substeps=2, tangent=True, **asked)
    assert found.tangent is not None
    last = found.state[-2]
    names = found.variables[path.values.shape[1] :]
    begun = dict(zip(names, last[path.values.shape[1] :].tolist(), strict=True))
    time = None if not path.timed else found.time[-2:]
    slopes = []
    for column in range(path.values.shape[1]):
        ends = []
        for by in (1e-6, -1e-6):
            end = path.values[-1].copy()
            end[column] += by
            step = Path.linear([last[: path.values.shape[1]], end], time=time)
            ends.append(run(law, step, **(asked | {"state": begun})).force[-1, : path.values.shape[1]])
        slopes.append((ends[0] - ends[1]) / 2e-6)
    assert found.tangent[-1] == pytest.approx(np.array(slopes).T, rel=1e-5, abs=1e-6)


@pytest.mark.slow
def test_increments_take_the_variables_that_the_criterion_names() -> None:
    worn = made("abs(sigma) - R*(1 + h*w)", None, SLIP | {"w": Variable()}, names=("h",), unforced={"w": "1"})
    for w in (0.0, 1.0):
        given = ONE | {"h": 0.5, "w": w}
        assert duhem.project(worn, [3.0], parameters=given).stress[0, 0] == pytest.approx(R * (1.0 + 0.5 * w), rel=1e-15)
    hardened = duhem.project(PRAGER, [K * 0.1, 0.0], stiffness=[K, H], parameters=ONE | {"C": H})
    assert hardened.stress[0] == pytest.approx(run(PRAGER, Path.linear([0.0, 0.1]), parameters=ONE | {"C": H}).force[-1], rel=1e-14)
    with pytest.raises(InputError, match="no value is given for w"):
        duhem.project(worn, [3.0], parameters=ONE | {"h": 0.5})
    for law in (RECOVERING, BINGHAM, FREDERICK):
        with pytest.raises(InputError, match=r"let duhem\.simulate integrate"):
            duhem.project(law, [3.0] * len(law.forces), parameters=ONE)
