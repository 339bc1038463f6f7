"""Laws with a state along paths: closed forms, equations integrated by others, balances, and what is not solved."""

from __future__ import annotations

import inspect
from contextlib import suppress
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import sympy as sp
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import duhem
from duhem import Criterion, Domain, InputError, Path, Paths, Status, YieldSurface
from duhem.cli import cli
from duhem.expression.numpy_ import compiled
from duhem.law.state import Variable
from duhem.path import scene_file, state_question, state_step, state_steps
from duhem.path.history import LeftDomain
from duhem.path.state_path import NoAnswer, StateHistory

POSITIVE = duhem.POSITIVE
SLIP = {"u": Variable("sigma", observable=True), "u_in": Variable("sigma")}
QUADRATIC = "k/2*(u - u_in)**2"
BACK = SLIP | {"alpha": Variable("X")}
STORED = f"{QUADRATIC} + C/2*alpha**2"
ALONG = "(sigma + X)/norm(sigma + X)"
RECALL = (ALONG, f"{ALONG} - gamma*alpha")
R, K, C, H, GAMMA = 1.0, 100.0, 5.0, 3.0, 2.0
ONE = {"R": R, "k": K}


def made(g: str, energy: str | None = QUADRATIC, variables: Any = SLIP, **given: Any) -> Criterion:
    """A law in the forces that its internal variables have."""
    forces = tuple(dict.fromkeys(own.force for own in variables.values() if own.force is not None))
    names = ("R", "k", *given.pop("names", ()))
    return Criterion(
        "made", g, dict.fromkeys(names, POSITIVE), forces, given.pop("pressure", None), energy=energy, variables=variables, **given
    )


PRAGER = made("norm(sigma + X) - R", STORED, BACK, names=("C",))
FREDERICK = made("norm(sigma + X) - R", STORED, BACK, names=("C", "gamma"), flow=RECALL)
RECOVERING = made(
    "norm(sigma + X) - R", STORED, BACK, names=("C", "gamma", "c", "m"), flow=RECALL, rates={"alpha": "c/C*abs(X)**(m - 1)*X"}
)
ISOTROPIC = made("abs(sigma) + A - R", f"{QUADRATIC} + H/2*alpha**2", SLIP | {"alpha": Variable("A")}, names=("H",))
BINGHAM = made("pos(norm(sigma) - R)**2/(2*eta)", names=("eta",), viscous=True)
NORTON = Criterion("norton", "A/(n + 1)*norm(sigma_a, sigma_b)**(n + 1)", {"A": POSITIVE, "n": POSITIVE}, pressure=None, viscous=True)
YIELDED = [0.0, R / K, 1.0]  # knots of a shear whose second is where flow begins


def run(law: Criterion, path: Any = None, **asked: Any) -> StateHistory:
    found = duhem.simulate(law, Path.linear(YIELDED) if path is None else path, **asked)
    assert isinstance(found, StateHistory)
    return found


def balanced(found: StateHistory) -> float:
    """The largest residual of the energies of a step, relative to the largest of them."""
    size = max(np.abs(getattr(found, name)).max() for name in ("work", "psi", "dissipation"))
    return float(np.abs(found.balance).max() / (size or 1.0))


# -- closed forms ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("steps", [1, 7])
@pytest.mark.parametrize(("law", "parameters"), [(PRAGER, {"C": H}), (ISOTROPIC, {"H": H})])
def test_linear_hardening_under_shear_is_exact_in_any_number_of_steps(law: Criterion, parameters: Any, steps: int) -> None:
    found = run(law, parameters=ONE | parameters, substeps=steps)
    slip = (K - R) / (K + H)
    assert found["sigma"][-1] == pytest.approx(R + H * slip, rel=1e-13)
    assert found["u_in"][-1] == pytest.approx(slip, rel=1e-13) and found["alpha"][-1] == pytest.approx(slip, rel=1e-13)
    assert found.multiplier[-1] == pytest.approx(slip, rel=1e-13)
    assert balanced(found) < 1e-14 and found.residual.max() < 1e-14 and "least of psi" in found.why


def test_hardening_differs_when_the_load_is_reversed() -> None:
    path = Path.linear([0.0, 1.0, -1.0])
    forward = (K - R) / (K + H)
    stress = R + H * forward
    kinematic = run(PRAGER, path, parameters=ONE | {"C": H})["sigma"][-1]
    isotropic = run(ISOTROPIC, path, parameters=ONE | {"H": H})
    assert kinematic == pytest.approx(-R + H * (R - K) / (K + H), rel=1e-12)  # |sigma + X| = R at u_in = alpha
    more = (2 * K - 2 * stress) / (K + H)
    assert isotropic["sigma"][-1] == pytest.approx(-(stress + H * more), rel=1e-12)
    assert isotropic["alpha"][-1] == pytest.approx(forward + more, rel=1e-12)


def order_of(law: Criterion, exact: Any, path: Any, method: str, most: float, **asked: Any) -> float:
    """The order with which the error falls from 16 substeps to 32, with which it is below ``most``."""
    errors = []
    for count in (16, 32):
        found = run(law, path, method=method, substeps=count, **asked)
        assert balanced(found) < 1e-12 and found.residual.max() <= state_step.KKT
        errors.append(float(np.abs(exact(found)).max()))
    assert errors[1] < most
    return float(np.log2(errors[0] / errors[1]))


MOST = {1: 0.05, 2: 1e-3}


def recall(found: StateHistory) -> Any:
    """Armstrong and Frederick's back stress over the slip."""
    return -found["X"] - C / GAMMA * (1.0 - np.exp(-GAMMA * found["u_in"]))


@pytest.mark.slow
@pytest.mark.parametrize(("method", "order"), [("implicit", 1), ("extrapolated", 2)])
def test_armstrong_and_frederick(method: str, order: int) -> None:
    found = order_of(FREDERICK, recall, None, method, MOST[order], parameters=ONE | {"C": C, "gamma": GAMMA})
    assert found == pytest.approx(order, abs=0.2)


@pytest.mark.parametrize(("method", "order"), [("implicit", 1), ("extrapolated", 2)])
def test_bingham_at_constant_rate(method: str, order: int) -> None:
    eta, time = 2.0, np.array([0.0, 0.01, 0.03])  # the rate of u is 1
    path = Path.linear(time, time=time)

    def exact(found: StateHistory) -> Any:
        return found["sigma"][-1] - (R + eta * (1.0 - np.exp(-K * (time[-1] - time[1]) / eta)))

    found = order_of(BINGHAM, exact, path, method, MOST[order], parameters=ONE | {"eta": eta})
    assert found == pytest.approx(order, abs=0.2)


def test_norton_creeps_at_constant_stress() -> None:
    stress, a, n = np.array([0.3, 0.4]), 2.0, 3.0
    path = Path.linear([stress, stress], time=[0.0, 2.0], control="stress")
    found = run(NORTON, path, stiffness=10.0, parameters={"A": a, "n": n}, substeps=3)
    creep = 2.0 * a * 0.5 ** (n - 1) * stress
    assert found.state[-1] == pytest.approx([*(stress / 10.0 + creep), *creep], rel=1e-13)
    assert found.dissipation[-1] == pytest.approx(2.0 * a * 0.5 ** (n + 1), rel=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize(("method", "order"), [("implicit", 1), ("extrapolated", 2)])
def test_norton_relaxes(method: str, order: int) -> None:
    def exact(found: StateHistory) -> Any:
        return np.hypot(found["sigma_a"][-1], found["sigma_b"][-1]) - (0.5**-2 + 2 * 10 * 2 * 0.05) ** -0.5

    path = Path.linear([[0.03, 0.04]] * 2, time=[0.0, 0.05])
    found = order_of(NORTON, exact, path, method, MOST[order], stiffness=10.0, parameters={"A": 2.0, "n": 3.0})
    assert found == pytest.approx(order, abs=0.2)


@pytest.mark.slow
@pytest.mark.parametrize(("method", "order"), [("implicit", 1), ("extrapolated", 2)])
def test_static_recovery_against_an_equation_of_its_own(method: str, order: int) -> None:
    """Flow in one direction: |sigma + X| = R gives lambda, and alpha' and u_in' are an ordinary differential equation."""
    c, m, begin = 0.2, 3.0, R / K

    def rate(t: float, y: Any) -> Any:
        back = -C * y[1]
        recovered = c / C * abs(back) ** (m - 1) * back
        flow = (K - C * recovered) / (K + C * (1.0 - GAMMA * y[1]))
        return [flow, flow * (1.0 - GAMMA * y[1]) + recovered]

    solved = solve_ivp(rate, (begin, 1.0), [0.0, 0.0], rtol=1e-11, atol=1e-13, method="DOP853").y[:, -1]
    parameters = ONE | {"C": C, "gamma": GAMMA, "c": c, "m": m}
    path = Path.linear(YIELDED, time=YIELDED)
    found = order_of(RECOVERING, lambda found: found.state[-1, 1:] - solved, path, method, MOST[order], parameters=parameters)
    assert found == pytest.approx(order, abs=0.2)


@pytest.mark.slow
def test_two_back_stresses_and_a_radius_against_an_equation_of_their_own() -> None:
    """Chaboche's law; four times the errors of the half minus those of the whole steps is of third order."""
    g, along = "norm(sigma + X + Z) + A - R", "(sigma + X + Z)/norm(sigma + X + Z)"
    flow = (along, f"{along} - 2*alpha", f"{along} - 5*beta", "1 - alpha_r/2")
    variables = SLIP | {"alpha": Variable("X"), "beta": Variable("Z"), "alpha_r": Variable("A")}
    law = made(g, f"{QUADRATIC} + 2*alpha**2 + 3*beta**2 + alpha_r**2/2", variables, flow=flow)

    def rate(u: float, y: Any) -> Any:
        flows = np.array([1.0, 1.0 - 2.0 * y[1], 1.0 - 5.0 * y[2], 1.0 - y[3] / 2.0])
        return K / (K + flows @ [0.0, 4.0, 6.0, 1.0]) * flows

    solved = solve_ivp(rate, (R / K, 1.0), np.zeros(4), rtol=1e-11, atol=1e-13, method="DOP853").y[:, -1]
    found = [run(law, parameters=ONE, method="extrapolated", substeps=n) for n in (16, 32)]
    coarse, fine = (np.abs(each.state[-1, 1:] - solved).max() for each in found)
    assert 3.0 < coarse / fine < 5.0 and fine < 1e-3 and max(map(balanced, found)) < 1e-13


ADHESIVE = made(
    "max(abs(sigma) - R, -B)",
    "beta**2*k*(u - u_in)**2/2 - w*beta",
    SLIP | {"beta": Variable("B", domain=Domain.between(0, 1))},
    names=("w",),
)


def test_adhesion_decays_as_the_energy_release_rate_says() -> None:
    found = run(ADHESIVE, Path.linear([0.0, 0.5]), state={"beta": 1.0}, parameters={"R": 1e3, "k": K, "w": 2.0}, substeps=20)
    u = found["u"][1:]
    assert found["beta"][1:] == pytest.approx(np.minimum(1.0, 2.0 / (K * u**2)), rel=1e-12)
    assert found["sigma"][1:] == pytest.approx(found["beta"][1:] ** 2 * K * u, rel=1e-12)
    assert found.multiplier.shape == (21, 2) and balanced(found) < 1e-13 and (np.diff(found.dissipation) >= -1e-15).all()


def test_corners_have_a_multiplier_of_each_surface() -> None:
    variables = {f"{x}{end}": Variable(f"s_{x}", observable=not end) for x in "ab" for end in ("", "_in")}
    energy = "k/2*((a - a_in)**2 + (b - b_in)**2)"
    parts = ("abs(s_a) - R", "abs(s_b) - 2*R")
    greatest = made(f"max({', '.join(parts)})", energy, variables)
    several = made(sp_nan(), energy, variables, surfaces=tuple(YieldSurface(g) for g in parts))
    for law in (greatest, several):
        found = run(law, Path.linear([[0.0, 0.0], [0.05, 0.1], [0.05, 0.1], [0.0, 0.1]]), parameters=ONE)
        assert found.force[1] == pytest.approx([R, 2 * R], rel=1e-14)
        assert sorted(found.multiplier[1]) == pytest.approx([0.04, 0.08], rel=1e-13)
        assert found.force[-1] == pytest.approx([-R, 2 * R], rel=1e-14)
        assert balanced(found) < 1e-14


def sp_nan() -> Any:
    return Criterion.__dataclass_fields__["g"].default


def test_a_flow_of_its_own_needs_no_energy() -> None:
    """The slip is along the stress, which lies on the ellipse that the law declares."""
    found = run("radial-flow", Path.linear([[0, 0], [1, 2]], pressure=-1.0), stiffness=[1.0, 2.0], parameters={"mu_a": 0.3, "mu_b": 0.2})  # type: ignore[arg-type]
    assert np.hypot(found["sigma_a"][-1] / 0.3, found["sigma_b"][-1] / 0.2) == pytest.approx(1.0, rel=1e-13)
    assert found["u_in_a"][-1] * found["sigma_b"][-1] == pytest.approx(found["u_in_b"][-1] * found["sigma_a"][-1], rel=1e-12)
    assert "no minimum: the law has a flow of its own" in found.why and found.columns()[1:5] == ("u_a", "u_b", "u_in_a", "u_in_b")


def test_wear_without_a_force_follows_the_multiplier() -> None:
    law = made("abs(sigma) - R", variables=SLIP | {"w": Variable(domain=Domain.between(0, "1/10"))}, unforced={"w": "abs(sigma)/4"})
    found = run(law, parameters=ONE, substeps=5)
    assert found["w"] == pytest.approx(np.minimum(R / 4 * found["u_in"], 0.1), abs=1e-15)
    assert found["u_in"][-1] == pytest.approx(0.99, rel=1e-13) and balanced(found) < 1e-14
    assert found.remark() == "w stops at its bound 0.1 at time 1.6, and is held there in 3 steps"


def test_a_bound_of_a_variable_with_a_force_holds_it_by_a_reaction() -> None:
    """Of the minimum over admissible states: beyond the bound nothing flows, and the answer is elastic."""
    variables = SLIP | {"alpha": Variable("A", domain=Domain.between(0, "1/2"))}
    law = made("abs(sigma) + A - R", f"{QUADRATIC} + H/2*alpha**2", variables, names=("H",))
    found = run(law, Path.linear([0.0, 1.0, 0.0]), parameters=ONE | {"H": H}, substeps=10)
    assert found["alpha"].max() == 0.5 and found["u_in"][10] == pytest.approx(0.5, rel=1e-14)
    assert found["sigma"][10] == pytest.approx(K * 0.5, rel=1e-13) and "alpha stops at its bound 0.5" in (found.remark() or "")
    assert found["sigma"][15] == pytest.approx(0.0, abs=1e-12) and balanced(found) < 1e-13


# -- heat --------------------------------------------------------------------------------------------------------------

WARM = SLIP | {"T": Variable(temperature=True, domain=POSITIVE)}
HEAT = f"{QUADRATIC} - c*(T*log(T/T0) - T + T0)"
SOFTENING = made("abs(sigma) - R*(1 - b*(T - T0))", HEAT, WARM, names=("c", "T0", "b"))
NUMBERS = ONE | {"c": 2.0, "T0": 300.0, "b": 0.5}


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


# -- what each step satisfies ------------------------------------------------------------------------------------------


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
    mutate(old, new, monkeypatch)
    with pytest.raises((AssertionError, NoAnswer)):
        conditions([1.0, -0.5], R, C, GAMMA)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new"), [("- heat.sum(axis=1) - inflow", "- 2 * heat.sum(axis=1) - inflow"), ("(t * gained - ", "(0 * gained - ")]
)
def test_a_wrong_balance_of_entropy_is_caught(old: str, new: str, monkeypatch: pytest.MonkeyPatch) -> None:
    mutate(old, new, monkeypatch)
    with pytest.raises((AssertionError, NoAnswer)):
        test_the_entropy_of_an_adiabatic_step_grows_by_what_it_dissipates()


def mutate(old: str, new: str, monkeypatch: pytest.MonkeyPatch) -> None:
    source = inspect.getsource(state_step)
    assert source.count(old) == 1
    mutant = ModuleType("mutant")
    monkeypatch.setitem(__import__("sys").modules, "mutant", mutant)
    exec(compile(source.replace(old, new), "mutant", "exec"), mutant.__dict__)
    for module, name in ((state_question, "StateLaw"), (state_steps, "own_dissipation")):
        monkeypatch.setattr(module, name, getattr(mutant, name))


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


def test_many_points_are_each_its_own_path() -> None:
    moduli, ends = np.array([1.0, 5.0, 20.0]), np.array([1.0, -0.3, 0.005])
    given = ONE | {"C": moduli, "gamma": GAMMA}
    found = run(FREDERICK, Paths.linear(np.stack([0 * ends, ends, 0 * ends], axis=1)), parameters=given, substeps=3)
    assert found.state.shape == (3, 7, 3) and (found.reached == 6).all()
    for i, (modulus, end) in enumerate(zip(moduli, ends, strict=True)):
        alone = run(FREDERICK, Path.linear([0.0, end, 0.0]), parameters=given | {"C": modulus}, substeps=3)
        assert np.array_equal(found.point(i).to_array(), alone.to_array())
    assert found.to_array().shape == (21, len(found.columns())) and found.columns()[0] == "point"
    kept = run(FREDERICK, Paths.linear(np.stack([0 * ends, ends], axis=1)), parameters=given, keep="last")
    assert np.array_equal(
        kept.state[:, -1], run(FREDERICK, Paths.linear(np.stack([0 * ends, ends], axis=1)), parameters=given).state[:, -1]
    )


# -- what is not answered ----------------------------------------------------------------------------------------------


def test_a_step_without_an_answer_ends_the_path_and_never_passes_for_one() -> None:
    """More softening than elasticity: beyond the peak no state satisfies the conditions."""
    softening = made("abs(sigma) + A - R", f"{QUADRATIC} - H*alpha**2", SLIP | {"alpha": Variable("A")}, names=("H",))
    with pytest.raises(NoAnswer, match="has no answer") as fault:
        run(softening, Path.linear([0.0, 0.005, 0.1]), parameters=ONE | {"H": 80.0})
    assert len(fault.value.history) == 2 and fault.value.history["sigma"][-1] == pytest.approx(0.5)
    many = run(softening, Paths.linear([[0.0, 0.005, 0.1], [0.0, 0.005, 0.006]]), parameters=ONE | {"H": 80.0})
    assert many.status.tolist() == [Status.FAILED, Status.STICK] and many.reached.tolist() == [1, 2]
    assert np.isnan(many.state[0, 2]).all()


def test_a_force_that_leaves_its_range_ends_the_path() -> None:
    law = made("norm(sigma + X) - R", STORED, BACK, names=("C",), domain={"sigma": Domain.between(-2, 2)})
    with pytest.raises(LeftDomain, match=r"sigma = .* lies outside its range") as fault:
        run(law, parameters=ONE | {"C": 10.0}, substeps=10)
    assert abs(fault.value.history["sigma"][-1]) <= 2.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"method": "exact"}, "no method 'exact'"),
        ({"stiffness": 1.0}, "has an energy"),
        ({"stress": [1.0, 0.0]}, "the start of made is a state"),
        ({"state": {"alpha": 3.0}}, "lie outside K"),
        ({"state": {"u": 0.0}}, "'u' is not a variable that begins somewhere"),
        ({"state": {"alpha": [0.0, 1.0]}}, "one a point"),
        ({"parameters": ONE | {"C": 1.0}}, "no value is given for gamma"),
        ({"parameters": ONE | {"C": -1.0, "gamma": 1.0}}, "C = -1"),
        ({"parameters": ONE | {"C": 1.0, "gamma": 1.0, "alpha": 0.0}}, "alpha is a variable"),
        ({"path": Path.linear([[0, 0], [1, 1]])}, "2 columns"),
        ({"path": Path.linear([0, 1], pressure=-1.0)}, "has no pressure"),
        ({"law": RECOVERING}, "the path states no times"),
        ({"law": made("norm(sigma + X) - R", None, BACK), "stiffness": 1.0}, "nothing says how the force X follows from alpha"),
        ({"convex": "require"}, "not required of made"),
        ({"keep": 2}, "only to many points"),
        ({"tangent": True, "path": Path.linear([0.0, 0.5], control="stress")}, "no displacement"),
        ({"law": "mohr-coulomb", "state": {"alpha": 1.0}}, "has no state"),
    ],
)
def test_misuse_is_named(change: dict[str, Any], message: str) -> None:
    asked = {"law": FREDERICK, "path": Path.linear([0.0, 1.0]), "parameters": ONE | {"C": 1.0, "gamma": 1.0}} | change
    with pytest.raises(InputError, match=message):
        duhem.simulate(asked.pop("law"), asked.pop("path"), **asked)


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


# -- scenes ------------------------------------------------------------------------------------------------------------

LAW = """\
[criterion]
name = "recalled"
forces = ["sigma", "X"]
pressure = false
g = "norm(sigma + X) - R"

[parameters]
R = { value = 1 }
C = { positive = true }
k = { value = 100 }

[energy]
psi = "k/2*(u - u_in)**2 + C/2*alpha**2"

[variables]
u = { observable = true, force = "sigma" }
u_in = { force = "sigma" }
alpha = { force = "X" }

[flow]
direction = ["(sigma + X)/norm(sigma + X)", "(sigma + X)/norm(sigma + X) - 2*alpha"]
"""
SCENE = """\
law = "law.toml"

[parameters]
C = 5

[state]
alpha = 0.1

[path]
kind = "cycle"
amplitude = 1.0

[method]
substeps = 4
"""


def test_a_scene_is_the_call_it_stands_for(tmp_path: Any) -> None:
    (tmp_path / "law.toml").write_text(LAW)
    (tmp_path / "scene.toml").write_text(SCENE)
    found = scene_file.read(tmp_path / "scene.toml").run()
    called = run(tmp_path / "law.toml", Path.cycle(1.0), parameters={"C": 5.0}, state={"alpha": 0.1}, substeps=4)  # type: ignore[arg-type]
    assert np.array_equal(found.to_array(), called.to_array()) and "History of recalled" in found.to_html()

    def asked(*arguments: str) -> Any:
        return CliRunner().invoke(cli, ["simulate", str(tmp_path / "scene.toml"), *arguments])

    assert asked("--out", str(tmp_path / "h.csv")).exit_code == 0
    table = np.loadtxt(tmp_path / "h.csv", delimiter=",", skiprows=1)
    assert np.array_equal(table, called.to_array())
    explained = asked("--explain").output
    assert "needed: implicit step (Newton's method on the residual" in explained and "not needed: closest point" in explained
    assert asked("--out", str(tmp_path / "g.csv"), "--plot", str(tmp_path / "h.svg"), "--resume").exit_code == 0
    assert (tmp_path / "g.csv").read_bytes() == (tmp_path / "h.csv").read_bytes() and "<svg" in (tmp_path / "h.svg").read_text()


def test_the_faults_of_a_scene_have_their_places(tmp_path: Any) -> None:
    (tmp_path / "law.toml").write_text(LAW)
    for old, new, said in (
        ("alpha = 0.1", "alpha = 9", r":6:1: .*outside K"),
        ("alpha = 0.1", "beta = 1", r":6:1: .*not a variable"),
        ("C = 5", "C = 5\nalpha = 1", r":3:1: .*is a variable"),
        ('law = "law.toml"', 'law = "law.toml"\nstiffness = 1', r":2:1: .*has an energy"),
        ("substeps = 4", 'integrator = "exact"', r":14:1: .*no method"),
    ):
        with pytest.raises(scene_file.SceneFaults, match=said):
            scene_file.reads(SCENE.replace(old, new), "scene", tmp_path)


# -- what must not pass ----------------------------------------------------------------------------------------------------


def plane(g: Any, parameters: Any = None, **more: Any) -> Criterion:
    """Two forces with unit moduli."""
    variables = {
        "ua": Variable("sa", observable=True), "ub": Variable("sb", observable=True), "pa": Variable("sa"), "pb": Variable("sb"),
    }  # fmt: skip
    energy = "((ua - pa)**2 + (ub - pb)**2)/2"
    return Criterion("plane", g, parameters or {}, ("sa", "sb"), None, energy=energy, variables=variables, **more)


@pytest.mark.parametrize("g", ["abs(sa) - sqrt(1 - sb)", "abs(sa) - (1 - sb)**(3/4)", "log(1 + sb) + abs(sa) - 1"])
def test_a_criterion_without_a_value_is_not_satisfied(g: str) -> None:
    for end in ((0.5, 3.0), (0.0, -9.0), (0.0, 3.0)):
        with suppress(NoAnswer):
            history = duhem.simulate(plane(g), Path.linear([[0.0, 0.0], end]))
            values = compiled(plane(g).g, plane(g).force_symbols())(*history.force.T)
            assert (values <= 1e-9).all()


def test_a_slope_without_end_hides_no_other_surface() -> None:
    law = plane(sp.nan, surfaces=(YieldSurface("sqrt(abs(sa)) - 1"), YieldSurface("abs(sb) - 1")))
    history = duhem.simulate(law, Path.linear([[0.0, 0.0], [0.0, 3.0], [0.0, 50.0]]))
    assert history.force[1:].tolist() == [[0.0, 1.0], [0.0, 1.0]]
    with pytest.raises(InputError, match="outside K"):
        duhem.simulate(law, Path.linear([[0.0, 50.0], [0.0, 51.0]]))


@pytest.mark.parametrize(("n", "k", "dt"), [("3/10", "1000000", 1.0), ("3/10", "100", 1e3), ("1/2", "10000", 1e3)])
def test_a_steep_viscous_flow_is_right_or_no_answer(n: str, k: str, dt: float) -> None:
    """eta rate = (|s| - 1)^n beyond the threshold: a step at dt -> oo ends at |s| = 1 with the sign of the load."""
    variables = {"u": Variable("s", observable=True), "p": Variable("s")}
    potential, energy = f"1/({n} + 1)*max(abs(s) - 1, 0)**({n} + 1)", f"{k}/2*(u - p)**2"
    law = Criterion("steep", potential, {}, ("s",), None, energy=energy, variables=variables, viscous=True)
    knots, wanted = [0.0, 9.0, 120.0, -50.0], [0.0, 1.0, 1.0, -1.0]
    try:
        found = duhem.simulate(law, Path.linear(knots, time=[dt * i for i in range(4)])).force[:, 0]
    except NoAnswer as fault:
        found = fault.history.force[:, 0]
    assert all(s * w >= 0.0 for s, w in zip(found, wanted, strict=False))


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


def test_a_criterion_that_is_violated_where_its_slope_has_no_end_is_not_satisfied() -> None:
    assert state_step._excess(np.array([2.0, 2.0, np.nan, -1.0, 0.0]), np.array([np.inf, 4.0, 1.0, np.inf, 0.0])).tolist() == [
        np.inf, 0.5, np.inf, 0.0, 0.0,
    ]  # fmt: skip


def test_what_a_path_without_an_answer_says() -> None:
    history = run(PRAGER, parameters=ONE | {"C": H})
    for residual, said in ((np.inf, "no value"), (0.2, "met to 0.2 and not to 1e-10"), (3e-12, "hold to 3e-12")):
        assert said in str(NoAnswer(history, 1.0, residual))


def test_a_tangent_is_one_of_the_step() -> None:
    with pytest.raises(InputError, match="no tangent"):
        duhem.simulate(plane("norm(sa, sb) - 1"), Path.linear([[0.0, 0.0], [3.0, 0.0]]), method="extrapolated", tangent=True)


def test_a_state_is_a_mapping() -> None:
    with pytest.raises(InputError, match="no mapping"):
        duhem.simulate(plane("norm(sa, sb) - 1"), Path.linear([[0.0, 0.0], [3.0, 0.0]]), state=[1, 2])


def test_damage_is_driven_by_an_observable_whose_force_drives_nothing() -> None:
    history = duhem.simulate("at1-damage", Path.linear([0.0, 1.2]), parameters={"E": 1, "w_1": 1}, substeps=12)
    assert history["d"][-1] == pytest.approx(1 - 1 / 1.2**2, rel=1e-9) and np.abs(history.balance).max() < 1e-12


def test_a_bar_that_damage_breaks_at_once_is_broken_and_goes_on() -> None:
    """The energy release rate does not depend on D: beyond the threshold D = 1 alone is an answer, with a reaction of its bound."""
    numbers = {"E": 1.0, "Y_0": 1.0}
    found = duhem.simulate("lemaitre-damage", Path.linear([0.0, 1.2, 1.8, -2.0, 0.5]), parameters=numbers)
    assert found["D"].tolist() == [0.0, 0.0, 1.0, 1.0, 1.0] and found["Y"][2] == 1.0  # of 1.62, but for the reaction
    assert found.dissipation.tolist() == [0.0, 0.0, 1.0, 1.0, 1.0] and balanced(found) < 1e-14
    whole = duhem.simulate("lemaitre-damage", Path.linear([1.8, -2.0, 0.5]), parameters=numbers, state={"D": 1.0})
    assert np.array_equal(whole.state, found.state[2:])
    with pytest.raises(InputError, match="outside K"):
        duhem.simulate("lemaitre-damage", Path.linear([1.8, -2.0]), parameters=numbers, state={"D": 0.9})


def test_paths_go_on_from_where_they_ended() -> None:
    """At the end of a step the criterion is 0 but for rounding, which is no violation, however small its forces are."""
    moduli = np.linspace(0.5, 2.0, 40)
    numbers = {"mu": 0.3, "C": moduli, "k": 0.7, "w": 0.9}
    knots = np.tile([[0.1, 0.2], [2.0, 0.7], [1.0, -0.5]], (40, 1, 1))
    whole = duhem.simulate("adhesion", Paths.linear(knots, pressure=-1.0), parameters=numbers, state={"beta": 1.0})
    begun = {name: whole[name][:, 1] for name in whole.variables[2:]}
    rest = duhem.simulate("adhesion", Paths.linear(knots[:, 1:], pressure=-1.0), parameters=numbers, state=begun)
    assert np.allclose(rest.state, whole.state[:, 1:], rtol=0, atol=1e-12)


def test_an_exponent_that_is_a_parameter() -> None:
    law = plane("(abs(sa)**m + abs(sb)**m)**(1/m) - 1", {"m": Domain.between(1, None)})
    history = duhem.simulate(law, Path.linear([[0.0, 0.0], [3.0, 2.0]]), parameters={"m": 4})
    assert abs(np.abs(history.force[-1] ** 4).sum() - 1.0) < 1e-9
