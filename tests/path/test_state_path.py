"""Laws with a state along paths: closed forms, equations integrated by others, and many points."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import duhem
from duhem import Criterion, Domain, InputError, Path, Paths, YieldSurface
from duhem.law.state import Variable
from duhem.path.state_path import StateHistory
from tests.path.states import (
    ADHESIVE,
    BINGHAM,
    FREDERICK,
    GAMMA,
    ISOTROPIC,
    MOST,
    NORTON,
    ONE,
    PRAGER,
    QUADRATIC,
    RECOVERING,
    SLIP,
    YIELDED,
    C,
    H,
    K,
    R,
    balanced,
    made,
    order_of,
    plane,
    run,
)


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


def test_an_exponent_that_is_a_parameter() -> None:
    law = plane("(abs(sa)**m + abs(sb)**m)**(1/m) - 1", {"m": Domain.between(1, None)})
    history = duhem.simulate(law, Path.linear([[0.0, 0.0], [3.0, 2.0]]), parameters={"m": 4})
    assert abs(np.abs(history.force[-1] ** 4).sum() - 1.0) < 1e-9


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


def test_paths_go_on_from_where_they_ended() -> None:
    """At the end of a step the criterion is 0 but for rounding, which is no violation, however small its forces are."""
    moduli = np.linspace(0.5, 2.0, 40)
    numbers = {"mu": 0.3, "C": moduli, "k": 0.7, "w": 0.9}
    knots = np.tile([[0.1, 0.2], [2.0, 0.7], [1.0, -0.5]], (40, 1, 1))
    whole = duhem.simulate("adhesion", Paths.linear(knots, pressure=-1.0), parameters=numbers, state={"beta": 1.0})
    begun = {name: whole[name][:, 1] for name in whole.variables[2:]}
    rest = duhem.simulate("adhesion", Paths.linear(knots[:, 1:], pressure=-1.0), parameters=numbers, state=begun)
    assert np.allclose(rest.state, whole.state[:, 1:], rtol=0, atol=1e-12)
