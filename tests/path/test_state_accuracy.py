"""Laws with a state to an accuracy that is asked for, and paths that are continued: closed forms, events, and what must not pass."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import duhem
from duhem import Domain, InputError, Path, Paths, Status
from duhem.cli import cli
from duhem.path import scene, scene_file, state_path
from duhem.path.history import Interrupted
from duhem.path.state_path import NoAnswer, StateHistory, state_history
from duhem.show.place import beside
from tests.path.states import NORTON, NUMBERS, ONE, SOFTENING
from tests.path.states import PRAGER as HARDENING

R, K, C, GAMMA = 1.0, 100.0, 20.0, 3.0
FREDERICK = {"R": R, "k": K, "C": C, "gamma": GAMMA}
PRAGER = {"R": R, "k": K, "C": C}


def run(law: str, path: Any, accuracy: float | None = 1e-8, **asked: Any) -> StateHistory:
    found = duhem.simulate(law, path, method="extrapolated", accuracy=accuracy, **asked)
    assert isinstance(found, StateHistory)
    return found


def back_and_forth(u: tuple[float, float]) -> tuple[float, float]:
    """The stress of Armstrong and Frederick's law at two turns of a shear: X = X_end + (X_0 - X_end) exp(-gamma p)."""
    most, at, slip, found = C / GAMMA, 0.0, 0.0, []
    for sign, end in zip((1.0, -1.0), u, strict=True):

        def back(p: float, sign: float = sign, at: float = at) -> float:
            return sign * most + (at - sign * most) * np.exp(-GAMMA * p)

        def missed(p: float, sign: float = sign, end: float = end, slip: float = slip, back: Any = back) -> float:
            return float((back(p) + sign * R) / K + slip + sign * p - end)

        p = brentq(missed, 0.0, 10.0, xtol=1e-15)
        at, slip = back(p), slip + sign * p
        found.append(at + sign * R)
    return found[0], found[1]


@pytest.mark.parametrize("accuracy", [1e-4, 1e-8])
def test_armstrong_and_frederick_turned_between_knots(accuracy: float) -> None:
    found = run("armstrong-frederick-recall", Path.linear([0.0, 0.1, -0.05]), accuracy, parameters=FREDERICK)
    exact = np.array(back_and_forth((0.1, -0.05)))
    assert (np.abs(found["sigma"][1:] - exact) <= accuracy * np.abs(exact).max()).all()
    assert np.abs(found.balance).max() <= 1e-12 * found.work.max() and found.status == Status.SLIP
    assert f"at most {accuracy:g}" in found.why


@pytest.mark.long
@pytest.mark.slow(4)
def test_creep_and_relaxation_to_an_accuracy() -> None:
    """Norton: u' constant, then held, where sigma' = -k A sigma^n has the closed form sigma^(1-n) = sigma_0^(1-n) + (n - 1) k A t."""
    path = Path.linear([[0.0, 0.0], [0.02, 0.0], [0.02, 0.0]], time=[0.0, 1.0, 3.0])
    found = run("norton-hoff", path, parameters={"A": 0.5, "n": 3}, stiffness=K)
    start, end = found["sigma_a"][1:]
    assert end == pytest.approx((start**-2 + 2.0 * K * 0.5 * 2.0) ** -0.5, rel=1e-8)
    assert not found["sigma_b"].any() and np.abs(found.balance).max() <= 1e-11 * found.work.max()


@pytest.mark.slow(8)
@pytest.mark.parametrize(
    ("k", "a", "n", "time"),
    [
        (1.0, 1.0, 5, (1e-6, 1e3)),
        pytest.param(1e5, 1.0, 1, (1.0, 2.0), marks=pytest.mark.long),
        pytest.param(1e4, 2.0, 1, (1e-3, 1e6), marks=pytest.mark.long),
        pytest.param(50.0, 0.3, 2, (1.0, 1e9), marks=pytest.mark.long),
    ],
)
def test_a_relaxation_much_longer_than_its_time(k: float, a: float, n: int, time: tuple[float, float]) -> None:
    """Held after a load: the first parts are shorter than 2^-27 of the step, and at its end what flows is rounding."""
    path = Path.linear([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]], time=[0.0, *time])
    found = run("norton-hoff", path, parameters={"A": a, "n": n}, stiffness=k)
    start, end = found["sigma_a"][1:]
    held = k * a * (time[1] - time[0])
    right = start * np.exp(-held) if n == 1 else (start ** (1 - n) + (n - 1) * held) ** (1.0 / (1 - n))
    assert abs(end - right) <= 1e-8 * start


@pytest.mark.long
def test_a_slow_flow_ends_and_returns_within_a_path() -> None:
    """A high exponent: what flows falls below rounding while the load turns, and comes back."""
    path = Path.linear([[0.0, 0.0], [0.1, 0.0], [0.0, 0.0]], time=[0.0, 1.0, 2.0])
    found = run("norton-hoff", path, parameters={"A": 1e-3, "n": 12}, stiffness=1e3)
    at, ends = [0.0], []
    for rate in (0.1, -0.1):

        def relaxing(_: float, s: Any, rate: float = rate) -> Any:
            return 1e3 * (rate - 1e-3 * s**12 * np.sign(s))

        at = solve_ivp(relaxing, (0.0, 1.0), at, "Radau", rtol=1e-11, atol=1e-12).y[:, -1]
        ends.append(at[0])
    assert np.allclose(found["sigma_a"][1:], ends, rtol=1e-7, atol=0.0)


def test_the_onset_of_viscous_flow_within_a_step() -> None:
    """Bingham at a constant rate v: the excess over R relaxes to eta v, x = eta v (1 - exp(-k t/eta)) from where R is reached."""
    found = run("bingham", Path.linear([[0.0, 0.0], [0.05, 0.0]], time=[0.0, 1.0]), parameters={"R": R, "eta": 2.0}, stiffness=K)
    excess = 2.0 * 0.05 * (1.0 - np.exp(-K * (1.0 - R / (K * 0.05)) / 2.0))
    assert found["sigma_a"][-1] == pytest.approx(R + excess, rel=1e-8)


@pytest.mark.slow(2)
def test_two_components_against_an_equation_of_their_own() -> None:
    found = run("prager", Path.linear([[0.02, 0.0], [0.05, 0.03]]), parameters=PRAGER, state={"u_in": 0.01})
    slope = K * np.array([0.03, 0.03])

    def rate(_: float, xi: Any) -> Any:  # xi = sigma + Y, on |xi| = R
        n = xi / np.hypot(*xi)
        return slope - n * (n @ slope)

    at = np.array([1.0, 0.0])
    xi = solve_ivp(rate, (0.0, 1.0), at, rtol=1e-12, atol=1e-13).y[:, -1]
    assert np.allclose(found.force[-1, :2] + found.force[-1, 2:], xi, rtol=0.0, atol=1e-8)


@pytest.mark.long
def test_heat_of_slip_to_an_accuracy() -> None:
    """mu(T) N = mu N exp(-a (T - T_0)) at a constant slip rate: c T' = mu N exp(-a (T - T_0)) v, but for the elastic part."""
    given = {"mu": 0.3, "a": 0.01, "k": 1e4, "c": 2.0, "T_0": 300.0, "h_1": 0.0, "h_2": 0.0, "T_1": 300.0, "T_2": 300.0}
    path = Path.linear([[0.0, 0.0], [5.0, 0.0]], time=[0.0, 1.0], pressure=-1.0)
    found = run("frictional-heating", path, parameters=given, state={"T": 300.0})
    slip = found["u_in"][-1]
    assert found["T"][-1] - 300.0 == pytest.approx(100.0 * np.log1p(0.01 * 0.3 * slip / 2.0), rel=1e-8)


def test_many_points_are_each_by_itself() -> None:
    paths = Paths.linear(np.array([[[0.0], [0.02]], [[0.0], [0.005]]]))
    found = run("armstrong-frederick-recall", paths, 1e-2, parameters=FREDERICK)
    for i in range(2):
        alone = run("armstrong-frederick-recall", paths.path(i), 1e-2, parameters=FREDERICK)
        assert np.array_equal(found.state[i], alone.state)


@pytest.mark.slow(3)
@pytest.mark.parametrize("u", [1e1, 1e4])
def test_a_step_far_beyond_saturation_has_its_answer(u: float) -> None:
    """sigma = k (u - p) = R + C p/(1 + gamma p), and of two back stresses and a radius likewise: p is the root of one equation."""
    chaboche = {"R": 1, "k": K, "C_1": 20, "C_2": 5, "gamma_1": 8, "gamma_2": 0.5, "Q": 0.5, "b": 4}
    parts = {"armstrong-frederick-recall": [(C, GAMMA)], "chaboche": [(20.0, 8.0), (5.0, 0.5), (4 * 0.5, 4.0)]}
    for law, parameters in (("armstrong-frederick-recall", FREDERICK), ("chaboche", chaboche)):
        found: Any = duhem.simulate(law, Path.linear([0.0, u]), parameters=parameters)

        def stress(p: float, law: str = law) -> float:
            return R + sum(c * p / (1.0 + gamma * p) for c, gamma in parts[law])

        p = brentq(lambda p: K * (u - p) - stress(p), 0.0, u, xtol=1e-14 * u)
        assert found["sigma"][-1] == pytest.approx(stress(p), rel=1e-7) and found.residual.max() <= 1e-10


@pytest.mark.parametrize(("a", "c", "u"), [(0.1, 2.0, 100.0), (1.0, 0.02, 10.0)])
def test_a_long_adiabatic_step_of_softening_friction_has_its_answer(a: float, c: float, u: float) -> None:
    """c T ln(T/T_0) = mu exp(-a (T - T_0)) N p with the slip p = u - sigma/k of the step."""
    given = {"mu": 0.3, "a": a, "k": K, "c": c, "T_0": 300.0, "h_1": 0, "h_2": 0, "T_1": 300.0, "T_2": 300.0}
    path = Path.linear([[0.0, 0.0], [u, 0.0]], pressure=-1.0, time=[0.0, 1.0])
    found: Any = duhem.simulate("frictional-heating", path, parameters=given, state={"T": 300.0})

    def missed(t: float) -> float:
        limit = 0.3 * np.exp(-a * (t - 300.0))
        return float(c * t * np.log(t / 300.0) - limit * (u - limit / K))

    assert found["T"][-1] == pytest.approx(brentq(missed, 300.0, 1000.0, xtol=1e-11), rel=1e-9)


@pytest.mark.slow(6)
def test_compiled_parts_come_to_the_same() -> None:
    pytest.importorskip("numba")
    path = Path.linear([0.0, 0.1, -0.05])
    plain, machine = (run("armstrong-frederick-recall", path, 1e-6, parameters=FREDERICK, compiled=compiled) for compiled in (False, True))
    assert np.allclose(plain.to_array(), machine.to_array(), rtol=1e-6, atol=1e-8) and "compiled" in machine.why


def test_wrong_weights_do_not_come_to_the_accuracy(monkeypatch: pytest.MonkeyPatch) -> None:
    right = state_path._weights
    monkeypatch.setattr(state_path, "_weights", lambda parts: np.eye(len(parts))[-1] + 1e-3 * (right(parts) - np.eye(len(parts))[-1]))
    monkeypatch.setattr(state_path, "_MOST_PARTS", 40)
    with pytest.raises(NoAnswer, match="do not come to the accuracy"):
        run("armstrong-frederick-recall", Path.linear([0.0, 0.1]), parameters=FREDERICK)


@pytest.mark.parametrize(
    ("asked", "where"),
    [
        ({"accuracy": 0.0}, "accuracy"), ({"accuracy": 1e-15}, "accuracy"), ({"accuracy": float("nan")}, "accuracy"),
        ({"accuracy": "small"}, "accuracy"), ({"accuracy": 1e-8, "method": "implicit"}, "accuracy"),
        ({"projection": "newton"}, "projection"),
        ({"threads": 0}, "path"), ({"state": {"alpha": float("nan")}}, "state"), ({"start": 3}, "start"),
    ],
)  # fmt: skip
def test_what_is_asked_in_vain_is_refused(asked: Any, where: str) -> None:
    with pytest.raises(InputError) as fault:
        duhem.simulate("armstrong-frederick-recall", Path.linear([0.0, 0.1]), parameters=FREDERICK, **{"method": "extrapolated", **asked})
    assert fault.value.where == where
    with pytest.raises(InputError, match="has no state"):
        duhem.simulate(
            "coulomb", Path.linear([[0.0, 0.0], [1.0, 0.0]], pressure=-1.0), parameters={"mu": 0.3}, stiffness=1.0, accuracy=1e-8
        )


# -- runs in parts ------------------------------------------------------------------------------------------------------

SCENE = """
law = "{law}"
[parameters]
{numbers}
[path]
kind = "linear"
points = {points}
{more}
[method]
substeps = 4
integrator = "{method}"
"""
SCENES = {
    "armstrong-frederick-recall": ("R = 1\nk = 100\nC = 20\ngamma = 3", "[0, 0.1, -0.05]", ""),
    "adhesion": ("mu = 0.3\nC = 10\nk = 100\nw = 0.02", "[[0, 0], [0.1, 0.05], [0, 0]]", "pressure = -1\n[state]\nbeta = 1"),
    "perzyna": ("R = 1\neta = 2\nn = 2", "[[0, 0], [0.1, 0.05], [0, 0]]", "time = [0, 1, 3]"),
}


@pytest.mark.parametrize("method", ["implicit", "extrapolated"])
@pytest.mark.parametrize("law", SCENES)
def test_a_run_that_is_continued_is_the_whole_to_the_last_bit(law: str, method: str, tmp_path: Any) -> None:
    numbers, points, more = SCENES[law]
    text = SCENE.format(law=law, numbers=numbers, points=points, more=more, method=method)
    text = text if law != "perzyna" else f"stiffness = 100\n{text}"
    (tmp_path / "scene.toml").write_text(text)
    asked = scene_file.read(tmp_path / "scene.toml")
    whole, parts = state_history(asked), list[StateHistory]()
    assert isinstance(whole, StateHistory)
    state_history(asked, checkpoint=(0.0, parts.append))
    assert parts and all(np.array_equal(part.to_array(), whole.upto(len(part)).to_array()) for part in parts)
    for part in (whole.upto(n) for n in (1, 3, len(whole) - 1)):
        again = state_history(asked, part)
        assert np.array_equal(again.to_array(), whole.to_array()) and again.remark() == whole.remark()
    table = str(tmp_path / "h.csv")
    scene.keep(whole.upto(4), table, asked.fingerprint)
    done = CliRunner().invoke(cli, ["simulate", str(tmp_path / "scene.toml"), "--out", table, "--resume"])
    assert done.exit_code == 0 and not beside(table).exists()
    whole.to_csv(tmp_path / "w.csv")
    assert (tmp_path / "w.csv").read_bytes() == (tmp_path / "h.csv").read_bytes()


@pytest.mark.parametrize("done", [1, 3])
def test_a_continued_run_that_is_interrupted_in_its_first_step_keeps_what_it_began_with(done: int, monkeypatch: Any) -> None:
    asked: dict[str, Any] = {"parameters": FREDERICK, "substeps": 2}
    law, path = "armstrong-frederick-recall", Path.linear([0.0, 0.1, -0.05])
    whole: Any = duhem.simulate(law, path, **asked)
    part = whole.upto(done)

    def interrupted(*_: Any) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr(state_path, "implicit", interrupted)
    with pytest.raises(Interrupted, match=f"after {done - 1} steps") as stop:
        duhem.simulate(law, path, start=part, **asked)
    assert np.array_equal(stop.value.history.to_array(), part.to_array())


def test_a_part_of_another_run_is_refused() -> None:
    path = Path.linear([0.0, 0.1, -0.05])
    asked: dict[str, Any] = {"parameters": FREDERICK, "substeps": 3}
    law = "armstrong-frederick-recall"
    part: Any = duhem.simulate(law, path, **asked)
    part = part.upto(3)
    others: dict[str, Any] = {
        "another path": (law, Path.linear([0.0, 0.2, -0.05]), asked),
        "another start": (law, path, asked | {"state": {"alpha": 0.01}}),
        "another number": (law, path, asked | {"parameters": FREDERICK | {"gamma": 2.0 * GAMMA}}),
        "another method": (law, path, asked | {"method": "extrapolated"}),
        "another law": ("slip-hardening", Path.linear([0.0, 0.1, -0.05], pressure=-1.0), {"parameters": {"mu": 0.3, "k": K, "H": 1}}),
        "a tangent": (law, path, asked | {"tangent": True}),
        "no tangent, but fewer knots": (law, path, asked | {"substeps": 1}),
    }  # fmt: skip
    for other, where, more in others.values():
        with pytest.raises(InputError, match="another run"):
            duhem.simulate(other, where, start=part, **more)
    fine = asked | {"method": "extrapolated", "accuracy": 1e-4}
    part = duhem.simulate(law, path, **fine)
    for another in ({"accuracy": 1e-6}, {"accuracy": None}):
        with pytest.raises(InputError, match="another run"):
            duhem.simulate(law, path, start=part.upto(3), **fine | another)
    many: Any = duhem.simulate(law, Paths.linear([[0.0, 0.1, -0.05]] * 2), **asked | {"parameters": FREDERICK | {"gamma": [GAMMA, 1.0]}})
    assert np.array_equal(duhem.simulate(law, path, start=many.point(0).upto(3), **asked)["alpha"], many.point(0)["alpha"])
    with pytest.raises(InputError, match="another run"):
        duhem.simulate(law, path, start=many.point(1).upto(3), **asked)


@pytest.mark.parametrize(
    ("law", "path", "other", "asked"),
    [
        (SOFTENING, [[0.0, 300.0], [0.01, 301.0], [1.0, 302.0]], [0.01, 300.5], {"parameters": NUMBERS}),
        (NORTON, [[0.3, 0.4], [0.3, 0.5], [0.3, 0.4]], [0.2, 0.5], {"parameters": {"A": 2.0, "n": 3.0}, "stiffness": 10.0}),
        (HARDENING, [[0.0], [1.1], [1.2]], [1.15], {"parameters": ONE | {"C": 3.0}}),
    ],
)
def test_a_part_of_another_temperature_or_of_other_forces_is_refused(law: Any, path: list[Any], other: list[float], asked: Any) -> None:
    control = "displacement" if law is SOFTENING else "stress"
    where, elsewhere = (Path.linear([path[0], knot, path[2]], time=[0.0, 1.0, 2.0], control=control) for knot in (path[1], other))
    whole: Any = duhem.simulate(law, where, **asked)
    again: Any = duhem.simulate(law, where, start=whole.upto(2), **asked)
    assert np.array_equal(again.to_array(), whole.to_array())
    with pytest.raises(InputError, match="another run"):
        duhem.simulate(law, elsewhere, start=whole.upto(2), **asked)


def test_the_stress_of_damage_stands_in_the_table_and_is_drawn(tmp_path: Any) -> None:
    found: Any = duhem.simulate("at1-damage", Path.linear([0.0, 0.2, 0.0]), parameters={"E": 100, "w_1": 0.5}, substeps=5)
    d, eps = found["d"], found["eps"]
    assert np.allclose(found["sigma"], (1.0 - d) ** 2 * 100.0 * eps, rtol=1e-12, atol=1e-14) and d[-1] > 0.5
    assert found.columns()[3:5] == ("Y", "sigma") and np.array_equal(found.to_dict()["sigma"], found["sigma"])
    axes = found.plot(tmp_path / "d.svg")
    assert len(axes) == 3 and "eps" in axes[1].get_xlabel()
    many: Any = duhem.simulate("at1-damage", Paths.linear(np.array([[[0.0], [0.2]]] * 2)), parameters={"E": 100, "w_1": 0.5})
    with pytest.raises(InputError, match="one point"):
        many.plot()
    assert many.point(1).plot()


def test_a_point_that_ended_early_is_drawn_only_as_far_as_it_came() -> None:
    """Beyond their last knot its states are nan, which no picture shows."""
    law = duhem.load("armstrong-frederick-recall")
    law = replace(law, domain={law.forces[0]: Domain.between(-2, 2)})
    many: Any = duhem.simulate(law, Paths.linear([[0.0, 0.01, 0.5], [0.0, 0.005, 0.01]]), parameters=FREDERICK)
    assert many.reached.tolist() == [1, 2]
    with pytest.raises(InputError, match="not finite"):
        many.point(0).plot()
    assert many.point(0).upto(2).plot() and many.point(1).plot()


@pytest.mark.long
def test_a_path_that_ends_where_a_bound_begins_to_hold() -> None:
    """Of brittle damage, which is whole here, the force is at its threshold at the last knot: another part begins there, and is short."""
    found = run("lemaitre-damage", Path.linear([0.2, 0.1]), 1e-4, parameters={"E": 100, "Y_0": 0.5}, state={"D": 1.0})
    assert found["D"][-1] == 1.0 and not found["sigma"].any()
