"""Contact lost and regained: the pressure vanishes at a knot or along a step, and every integrator goes on."""

import numpy as np
import pytest

import duhem
from duhem import Criterion, InputError, Path, Paths, simulate
from duhem.path import scene_file
from duhem.path.picture import trajectory
from tests.long import mostly_long

LAWS = {
    "coulomb": {"mu": 0.3},
    "antoni2007": {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15},
    "shifted-ellipse": {"mu_a": 0.3, "mu_b": 0.2, "shift": 0.1},
    "superellipse": {"mu_a": 0.3, "mu_b": 0.2, "p": 4},
    "capped": {"mu": 0.3, "tau_max": 0.35},
}
KNOTS = np.array([[0.0, 0.0], [1.0, 0.4], [1.5, 0.1], [2.0, -0.5], [1.0, -1.0], [1.01, -1.01]])
LOAD = np.array([-1.0, -2.0, 0.0, 0.0, -1.5, 0.0])
SUMS = ("stress", "slip", "multiplier", "dissipation", "work")


@pytest.mark.slow
@pytest.mark.parametrize("law", mostly_long(LAWS, "shifted-ellipse"))
def test_exact_steps_do_not_depend_on_where_they_are_cut_and_others_converge_to_them(law):
    path, given = Path.linear(KNOTS, pressure=LOAD), {"stiffness": [1.0, 2.0], "parameters": LAWS[law]}
    one, three = (simulate(law, path, method="exact", substeps=n, **given) for n in (1, 3))
    for name in SUMS:
        assert np.abs(getattr(one, name) - getattr(three, name)[::3]).max() < 2e-13
    assert np.abs(one.balance).max() < 1e-13 and not one.stress[[2, 3, 5]].any()
    if law == "superellipse":
        return
    for method, error in (("implicit", 4e-3), ("extrapolated", 2e-5)):
        fine = simulate(law, path, method=method, substeps=200, **given)
        assert max(np.abs(getattr(fine, name)[::200] - getattr(one, name)).max() for name in SUMS) < error
        assert not fine.stress[400:601].any() and np.isfinite(fine.to_array()).all()


def test_from_no_stress_a_disk_is_dragged_along_a_line_of_growing_friction():
    """sigma = mu |sigma_n| e, slip = (1 - mu |sigma_n|/k) e at the end, and half of their product is the dissipation."""
    mu, k, load, du = 0.3, 2.0, 1.5, np.array([0.6, 0.8])
    found = simulate("coulomb", Path.linear([[0, 0], du], pressure=[0.0, -load]), stiffness=k, parameters={"mu": mu}, method="exact")
    length = 1.0 - mu * load / k
    assert np.abs(found.stress[1] - mu * load * du).max() < 1e-15
    assert np.abs(found.slip[1] - length * du).max() < 1e-15 and abs(found.multiplier[1] - length) < 1e-13
    assert abs(found.dissipation[1] - 0.5 * mu * load * length) < 1e-15
    sticks = simulate("coulomb", Path.linear([[0, 0], 0.1 * du], pressure=[0.0, -load]), stiffness=k, parameters={"mu": mu}, method="exact")
    assert not sticks.slip.any() and np.abs(sticks.stress[1] - 0.1 * k * du).max() < 1e-16


def test_along_an_axis_the_equation_is_the_elementary_solution():
    line, mu = [0.0, 1.0, 1.5, 2.0, 1.0, 1.01], 0.3
    elementary = simulate(
        "antoni2007-1d", Path.linear(line, pressure=LOAD), stiffness=2.0, parameters={"mu_plus": mu, "mu_minus": mu}, method="exact"
    )
    plane = Path.linear([[x, 0.0] for x in line], pressure=LOAD)
    equation = simulate("coulomb", plane, stiffness=2.0, parameters={"mu": mu}, method="exact")
    assert "elementary" in elementary.why and "Dormand" in equation.why
    assert np.abs(equation.stress[:, 0] - elementary.stress[:, 0]).max() < 1e-14
    for name in ("dissipation", "work"):
        assert np.abs(getattr(equation, name) - getattr(elementary, name)).max() < 1e-13
    slipped = np.abs(np.diff(equation.slip[:, 0]))[[1, 2]].sum()  # contact is open in the third step
    assert abs(equation.multiplier[3] - equation.multiplier[1] - slipped) < 1e-13


@pytest.mark.slow
def test_between_the_knots_the_stress_lies_on_the_boundary():
    history = simulate("coulomb", Path.linear(KNOTS[:5], pressure=LOAD[:5]), stiffness=1.0, parameters={"mu": 0.3}, method="exact")
    seen = trajectory(history, 8).states
    excess = np.hypot(*seen.stress.T) - 0.3 * np.abs(seen.pressure)
    assert excess.max() < 1e-13 and (np.abs(excess[4:]) < 1e-13).all()


@pytest.mark.slow
@pytest.mark.parametrize("method", ["implicit", "extrapolated", "exact"])
def test_many_points_open_and_close_alike(method):
    load = np.stack([LOAD, np.full(len(LOAD), -1.0)])
    many = simulate("coulomb", Paths.linear(np.stack([KNOTS, KNOTS]), pressure=load), stiffness=1.0, parameters={"mu": 0.3}, method=method)
    for i in range(2):
        alone = simulate("coulomb", Path.linear(KNOTS, pressure=load[i]), stiffness=1.0, parameters={"mu": 0.3}, method=method)
        assert np.array_equal(many.history(i).stress, alone.stress) and np.array_equal(many.history(i).work, alone.work)


def test_a_scene_may_open_contact():
    text = (
        'law = "coulomb"\nstiffness = 1.0\n[parameters]\nmu = 0.3\n[path]\nkind = "linear"\n'
        'points = [[0, 0], [1, 1]]\npressure = [-1, 0]\n[method]\nintegrator = "exact"\n'
    )
    assert not scene_file.reads(text).run().stress[-1].any()


def test_a_law_with_cohesion_needs_nothing_special():
    mu = {name: 0.3 for name in duhem.load("cohesive").parameters}
    path = Path.linear(KNOTS, pressure=LOAD)
    one, three = (simulate("cohesive", path, stiffness=1.0, parameters=mu, method="exact", substeps=n) for n in (1, 3))
    assert np.abs(one.stress - three.stress[::3]).max() < 1e-13 and one.stress[2].any()


@pytest.mark.slow
def test_a_set_that_does_not_shrink_to_the_origin_is_refused():
    """Without pressure K is a line: no stress of it is called right."""
    law = Criterion("line", "norm(sigma_b, sigma_n*sigma_a) + sigma_n", {})
    with pytest.raises(InputError, match="neither the origin nor a disk"):
        simulate(law, Path.linear(KNOTS, pressure=LOAD), stiffness=1.0, method="exact")
    with pytest.raises(InputError, match="arc"):
        simulate("coulomb", Path.circle(1.0, pressure=0.0, points=4), stiffness=1.0, parameters={"mu": 0.3}, method="exact", stress=[0, 0])


@pytest.mark.slow
def test_a_cap_that_is_passed_is_an_event():
    """As the pressure crosses the cap the load has a kink: one step over it is as exact as many."""
    path = Path.linear(KNOTS[:4], pressure=[-1.0, -2.0, -0.5, -1.5])
    one, many = (simulate("capped", path, stiffness=1.0, parameters=LAWS["capped"], method="exact", substeps=n) for n in (1, 4))
    for name in SUMS:
        assert np.abs(getattr(one, name) - getattr(many, name)[::4]).max() < 1e-13
