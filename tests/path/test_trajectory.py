"""Between the knots of an exact path: on the boundary or inside, as 30 digits have it, and the knots themselves untouched."""

import subprocess
import sys
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from duhem import InputError, Path, simulate
from duhem.path.picture import trajectory
from tests.long import mostly_long
from tests.oracles.path import drive

NAMES = ("mu_a_plus", "mu_a_minus", "mu_b_plus", "mu_b_minus")
MU = dict(zip(NAMES, (0.2, 0.08, 0.12, 0.15), strict=True))
PLANE = {"law": "antoni2007", "stiffness": [1.0, 2.0], "parameters": MU, "method": "exact"}
COUPLED = PLANE | {"stiffness": [[1.0, 0.3], [0.3, 2.0]]}
LINE = {"law": "antoni2007-1d", "stiffness": 1.3, "parameters": {"mu_plus": 0.4, "mu_minus": 0.2}, "method": "exact"}
DISK = {"law": "coulomb", "stiffness": 1.5, "parameters": {"mu": 0.25}, "method": "exact"}
SHIFTED = PLANE | {"law": "shifted-ellipse", "parameters": {"mu_a": 0.2, "mu_b": 0.1, "shift": 0.05}}
RUNS = {
    "straight": PLANE | {"path": Path.random(seed=3, points=8, scale=0.3, pressure=-1.0)},
    "centre": SHIFTED | {"path": Path.random(seed=3, points=8, scale=0.3, pressure=-1.0)},
    "line": LINE | {"path": Path.random(seed=8, points=9, dimension=1, scale=1.0, pressure=(-3.0, -0.2))},
    "arc": DISK | {"path": Path.circle(0.2, points=3, turns=-1.7, start=0.4, pressure=-1.0), "stress": [0.05, 0.1]},
    "slow arc": DISK | {"path": Path.circle(0.9 * 0.25 / 1.5, points=2, turns=1.0, pressure=-1.0), "stress": [0.0, 0.2]},
    "equation": COUPLED | {"path": Path.random(seed=3, points=4, scale=0.3, pressure=-1.0)},
    "pressure": PLANE | {"path": Path.random(seed=3, points=4, scale=0.3, pressure=(-2.0, -0.5))},
    "equation on an arc": PLANE | {"path": Path.circle(0.3, points=3, turns=1.25, pressure=-1.0)},
}
LIMITS = {  # the semi-axes over the pressure, and the centre over the pressure
    "antoni2007": ([[0.2, 0.08], [0.12, 0.15]], [0.0, 0.0]),
    "antoni2007-1d": ([[0.4, 0.2]], [0.0]),
    "coulomb": ([[0.25, 0.25], [0.25, 0.25]], [0.0, 0.0]),
    "shifted-ellipse": ([[0.2, 0.2], [0.1, 0.1]], [0.05, 0.0]),
}


@cache
def run(name, **options):
    given = dict(RUNS[name]) | options
    return simulate(given.pop("law"), given.pop("path"), **given)


def gauge(history):
    """1 on the boundary of K, less inside."""
    mu, centre = (np.array(entry) for entry in LIMITS[history.law])
    load = np.abs(history.pressure)[:, None]
    about = history.stress - centre * load
    return np.linalg.norm(about / (np.where(about < 0.0, mu[:, 1], mu[:, 0]) * load), axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(RUNS, "centre", "line", "equation"))
def test_the_curve_keeps_the_knots_slips_on_the_boundary_and_rests_inside(name):
    history = run(name)
    seen = trajectory(history, 16)
    states, slips = seen.states, seen.slips
    assert len(states) >= 15 * (len(history) - 1) and (np.diff(states.time) > 0.0).all()
    assert np.array_equal(states.to_array()[seen.knots], history.to_array())
    assert (np.diff(seen.knots) >= 16).all() and len(states.to_array()) == len(slips) == len(states)

    size = gauge(states)
    assert 3 <= slips.sum() <= len(slips) - 3
    assert (size <= 1 + 1e-11).all()
    onto = np.flatnonzero(slips)
    assert np.abs(size[onto] - 1).max() < 1e-11
    assert np.abs(size[onto - 1] - 1).max() < 1e-7  # where slip begins, known as well as the chord cuts the boundary
    rests = np.flatnonzero(~slips)[1:]
    assert np.abs(np.diff(states.slip, axis=0)[rests - 1]).max() < 1e-7
    assert np.abs(np.diff(states.multiplier)[rests - 1]).max() < 1e-7
    assert (np.diff(states.multiplier)[onto - 1] > 0.0).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(RUNS, "line", "slow arc", "pressure"))
def test_stress_slip_and_energies_between_the_knots_fit_each_other(name):
    history = run(name)
    states = trajectory(history, 200).states
    k = np.asarray(RUNS[name]["stiffness"], dtype=float)
    k = k if k.ndim == 2 else np.diag(np.broadcast_to(k, states.stress.shape[1]))
    elastic = states.displacement - states.slip
    assert np.allclose(states.stress, elastic @ k, rtol=0, atol=1e-14)
    assert np.allclose(states.psi, 0.5 * (states.stress * elastic).sum(axis=1), rtol=0, atol=1e-15)
    assert np.abs(states.balance).max() < 1e-11
    du, dslip = np.diff(states.displacement, axis=0), np.diff(states.slip, axis=0)
    middle = 0.5 * (states.stress[1:] + states.stress[:-1])
    assert np.abs(np.cumsum((middle * du).sum(axis=1)) - states.work[1:]).max() < 2e-5 * states.work[-1]
    assert np.abs(np.cumsum((middle * dslip).sum(axis=1)) - states.dissipation[1:]).max() < 2e-5 * states.work[-1]


@pytest.mark.long
@pytest.mark.parametrize(("seed", "coupling"), mostly_long([(10, 0.0), (36, 0.0), (10, 1e-15), (36, 1e-15)], (36, 1e-15)))
def test_states_between_the_knots_agree_with_thirty_digits(seed, coupling):
    draw = np.random.default_rng(seed)
    mu, k = 10 ** draw.uniform(-1, 0, 4), 10 ** draw.uniform(-0.5, 0.5, 2)
    path = Path.random(seed=seed, points=4, scale=mu.mean() / k * 10 ** draw.uniform(-0.3, 0.5), pressure=-1.0)
    coupled = [[k[0], coupling * k[0]], [coupling * k[0], k[1]]]  # by a rounding: the general way is taken
    history = simulate("antoni2007", path, stiffness=coupled, parameters=dict(zip(NAMES, map(float, mu), strict=True)), method="exact")
    assert history.why.startswith("elementary" if coupling == 0.0 else "Dormand-Prince")
    states = trajectory(history, 3).states
    tolerance = 1e-13 if coupling == 0.0 else 1e-11
    true = drive(states.displacement, mu, 1.0, k)
    assert len(true) >= 12
    for i, (stress, multiplier, dissipation, work) in enumerate(true, 1):
        assert np.abs(states.stress[i] - [float(s) for s in stress]).max() <= tolerance * mu.max()
        for name, value in (("multiplier", multiplier), ("dissipation", dissipation), ("work", work)):
            assert abs(getattr(states, name)[i] - float(value)) <= tolerance * max(1.0, float(value)), (name, i)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(RUNS, "arc", "equation"))
def test_between_the_knots_the_curve_is_what_smaller_steps_find(name):
    history, fine = run(name), run(name, substeps=8)
    seen = trajectory(history, 8)
    at = np.searchsorted(seen.states.time, fine.time - 1e-12)
    for column in ("time", "displacement", "stress", "slip", "pressure", "multiplier", "dissipation", "work", "psi"):
        assert np.allclose(getattr(seen.states, column)[at], getattr(fine, column), rtol=0, atol=1e-11), column


def test_a_corner_where_slip_begins_is_a_row():
    """One step from rest, straight through the boundary: the row where slip begins is where the ray leaves K."""
    history = simulate("antoni2007", Path.linear([[0, 0], [1.0, 0.5]], pressure=-1.0), **{k: v for k, v in PLANE.items() if k != "law"})
    seen = trajectory(history, 4)
    ray = np.array([1.0, 1.0]) / np.hypot(1.0 / 0.2, 1.0 / 0.12)
    begins = int(np.flatnonzero(seen.slips)[0])
    assert np.allclose(seen.states.stress[begins - 1], ray, rtol=1e-14, atol=0)
    assert not seen.slips[:begins].any() and seen.slips[begins:].all()


def test_a_prescribed_stress_has_the_energies_of_elasticity_between_its_knots():
    path = Path.linear([[0.0, 0.0], [0.1, 0.05], [-0.04, 0.1]], pressure=-1.0, control="stress")
    history = simulate("antoni2007", path, stiffness=[1.0, 2.0], parameters=MU)
    seen = trajectory(history, 10)
    assert np.array_equal(seen.states.to_array()[seen.knots], history.to_array()) and not seen.slips.any()
    assert np.allclose(seen.states.work, seen.states.psi, rtol=0, atol=1e-17) and len(seen.states) == 21
    assert np.allclose(seen.states.displacement * [1.0, 2.0], seen.states.stress, rtol=1e-14, atol=1e-17)


@pytest.mark.parametrize("method", ["implicit", "extrapolated"])
def test_steps_that_know_their_knots_only_have_no_rows_in_between(method):
    history = run("straight", method=method)
    seen = trajectory(history, 16)
    assert seen.states is history and np.array_equal(seen.knots, np.arange(len(history)))
    assert np.array_equal(np.flatnonzero(seen.slips), np.flatnonzero(np.diff(history.multiplier) > 0.0) + 1)


@pytest.mark.slow
def test_left_out_the_number_of_rows_is_bounded_and_a_wrong_one_is_named():
    history = run("line", substeps=1000)
    assert len(trajectory(history).states) == len(history) == 9001
    assert len(trajectory(run("line")).states) <= 9 * 66 + 1
    for wrong in (0, -1, 2.5, True):
        with pytest.raises(InputError, match="samples"):
            trajectory(history, wrong)


def test_an_interrupted_run_has_a_curve_too():
    def stop(done, _):
        if done >= 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        run("straight", on_step=stop)
    part, whole = trajectory(caught.value.history, 5).states, trajectory(run("straight"), 5).states
    assert np.array_equal(part.to_array(), whole.to_array()[: len(part)])


@pytest.mark.long
def test_a_run_that_draws_nothing_does_not_load_the_curve():
    code = (
        "import sys; from duhem import Path, simulate;"
        "simulate('antoni2007-1d', Path.cycle(1.0, pressure=-1.0), stiffness=1.0,"
        " parameters={'mu_plus': .3, 'mu_minus': .2}, method='exact');"
        "sys.exit('duhem.path.picture' in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


LONG = {
    "alike": PLANE,
    "one force settles later": PLANE | {"stiffness": [1.0, 1e4]},
    "equation": COUPLED,
    "centre": SHIFTED,
    "line": LINE,
}


STEPS = [(name, r) for name in LONG for r in (1.0, 30.0, 1e3, 1e6) if name != "equation" or r <= 30.0]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "ratio"), mostly_long(STEPS, *STEPS[::2]))
def test_however_long_a_step_is_neighbouring_stresses_are_close(name, ratio):
    """Long against the way on which the law sticks: the corner and the curve behind it are seen, no chord cuts through K."""
    given = dict(LONG[name])
    corners = 0.2 * ratio * np.array([[0.0, 0.0], [1.0, 1.0], [-1.0, 1.0]])
    path = Path.linear(corners[:, :1] if name == "line" else corners, pressure=-1.0)
    history = simulate(given.pop("law"), path, **given)
    seen = trajectory(history)
    stress, slips = seen.states.stress, seen.slips[1:]
    assert len(seen.states) <= 2 * 9 * 64 + 1
    assert np.array_equal(seen.states.to_array()[seen.knots], history.to_array())
    assert (np.diff(seen.states.time) > 0.0).all()
    reach = np.ptp(stress, axis=0).max()
    assert np.abs(np.diff(stress, axis=0)).max() <= 0.0201 * reach
    middle = replace(seen.states, stress=0.5 * (stress[1:] + stress[:-1]), pressure=seen.states.pressure[1:])
    assert slips.any() and np.abs(gauge(middle)[slips] - 1.0).max() < 1e-3
    assert np.ptp(stress[1:][~slips], axis=0).max() > 0.3 * reach  # rest is not lost, though it takes no time


@pytest.mark.parametrize("size", [1e-250, 1e-30, 1e-12, 1e-6, 1.0])
def test_where_slip_begins_is_found_at_any_ratio_of_the_step_to_rest(size):
    corners = np.array([[0.0], [1.0], [-1.0]])
    seen = trajectory(simulate(LINE["law"], Path.linear(corners, pressure=-size), **{k: v for k, v in LINE.items() if k != "law"}))
    rests = seen.states.stress[~seen.slips, 0]
    assert np.ptp(rests) == pytest.approx(np.ptp(seen.states.stress), rel=1e-12) and seen.slips.any()
    assert np.abs(np.diff(seen.states.stress[:, 0])).max() <= 0.0201 * np.ptp(seen.states.stress)
