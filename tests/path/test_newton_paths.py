"""Long stretches of one path by a law's own loop: they are the steps of the search, judged like them.

The loop runs as Python here; that numba makes the same of its text is shown in tests/projection/test_compiled_newton.py.
"""

import numpy as np
import pytest

from duhem import Criterion, InputError, Path, Paths
from duhem.errors import DuhemError
from duhem.path import compiled_run, scene_file
from duhem.path.history import Interrupted
from duhem.path.rows import Ledger
from duhem.path.run import Plan, Run
from duhem.path.simulate import simulate
from duhem.projection import compiled_newton
from tests.long import mostly_long
from tests.path.scenes import walk

CASES = {
    "box": ({"mu_a": 0.2, "mu_b": 0.1}, [1.0, 2.0], 2),
    "superellipse": ({"mu_a": 0.2, "mu_b": 0.1, "p": 3}, [[1.0, 0.3], [0.3, 2.0]], 2),
    "von-mises": ({"yield_stress": 0.2}, [1.0, 2.0, 1.5], 3),
    "tresca-tensor": ({"s0": 0.2}, [1.0, 2.0, 1.5, 1.0, 0.7, 0.9], 6),
}


@pytest.fixture(autouse=True)
def _as_python(monkeypatch):
    made = {}

    def run(text, entry):
        if text not in made:
            made[text] = {}
            exec(text, made[text])
        return made[text][entry]

    monkeypatch.setattr(compiled_newton, "compiled_text", run)


def driven(name):
    mu, k, d = CASES[name]
    draw = np.random.default_rng(4)
    points = np.vstack([np.zeros(d), np.cumsum(draw.normal(size=(6, d)) * 0.2, axis=0)])
    points[1] *= 0.1  # sticks
    load = None if d > 2 else np.array([-1.0, -1.5, -0.5, 0.0, -1.0, -1.0, -2.0])  # contact lost and regained
    return Path.linear(points, pressure=load), {"stiffness": k, "parameters": mu, "compiled": True}


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(CASES, "box", "von-mises", "tresca-tensor"))
def test_the_loop_takes_the_steps_of_the_search(name, monkeypatch):
    path, given = driven(name)
    whole, right = simulate(name, path, **given), simulate(name, path, **given | {"compiled": False})
    assert np.abs(whole.to_array() - right.to_array()).max() < 1e-13 and whole.why == f"{right.why}, compiled"
    assert 2 <= (np.diff(whole.multiplier) > 0.0).sum() < len(whole) - 1
    monkeypatch.setattr(compiled_run, "_STEPS", 3)
    parts = simulate(name, path, **given)
    assert np.array_equal(parts.to_array(), whole.to_array())
    with pytest.raises(Interrupted) as stop:
        simulate(name, path, **given, on_step=_stop)
    assert 3 <= len(stop.value.history) <= 4
    assert np.array_equal(simulate(name, path, **given, start=stop.value.history).to_array(), whole.to_array())


def _stop(done, steps):
    raise KeyboardInterrupt


@pytest.mark.slow
@pytest.mark.parametrize("fault", ["wrong stress", pytest.param("wrong slip", marks=pytest.mark.long), "left"])
def test_what_the_judge_does_not_take_is_a_step_of_the_search(fault, monkeypatch):
    """A loop that is wrong at its first slip each time it is called."""
    path, given = driven("box")
    right, searched = simulate("box", path, **given), []
    of = compiled_newton.Loop.of

    def wrong(*args):
        loop = of(*args)

        def run(*taken):
            loop.run(*taken)
            _, stress, slip, _, state = taken[-5:]
            if (slips := np.flatnonzero(state == 1)).size:
                i = slips[0]
                if fault == "wrong stress":
                    stress[i] *= 0.99
                if fault == "wrong slip":
                    slip[i] *= 1.01
                if fault == "left":
                    state[i:] = 2

        return compiled_newton.Loop(run, loop.formula, loop.constants, loop.root, loop.inverse, loop.mean)

    class Wrong:
        of = staticmethod(wrong)

    def counted(*args):
        searched.append(args)
        return stretch(*args)

    stretch = compiled_run.stretch
    monkeypatch.setattr(compiled_run, "Loop", Wrong)
    monkeypatch.setattr(compiled_run, "stretch", counted)
    found = simulate("box", path, **given)
    assert len(searched) >= 2 and np.abs(found.to_array() - right.to_array()).max() < 1e-13


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(CASES, "von-mises"))
def test_many_points_take_the_steps_of_the_search_too(name, monkeypatch):
    """And those that the loop leaves go abreast; a point that cannot go on stops no other."""
    path, given = driven(name)
    paths = Paths.scaled(path, [1.0, 0.5, 1e306, -2.0])
    right = simulate(name, paths, keep=2, **given | {"compiled": False})
    assert right.reached.tolist() != [6] * 4
    of, called = compiled_newton.Loop.of, []

    def leaving(*args):
        loop = of(*args)

        def run(*taken):
            loop.run(*taken)
            called.append(taken)
            if len(called) == 2:
                taken[-1][3:] = 2

        return compiled_newton.Loop(run, loop.formula, loop.constants, loop.root, loop.inverse, loop.mean)

    class Leaving:
        of = staticmethod(leaving)

    monkeypatch.setattr(compiled_run, "Loop", Leaving)
    found = simulate(name, paths, keep=2, **given)
    assert len(called) == 4 and found.why == f"{right.why}, compiled"
    assert np.array_equal(found.reached, right.reached) and np.array_equal(found.status, right.status)
    for point in (0, 1, 3):
        assert np.abs(found.history(point).to_array() - right.history(point).to_array()).max() < 1e-13


@pytest.mark.long
def test_a_step_that_cannot_be_vouched_for_ends_the_run_as_it_does_elsewhere():
    bent = Criterion("bent", "norm(a, b)**2 - 3*a*b - 1/10", {}, forces=("a", "b"), pressure=None)  # not convex, without end
    path = Path.linear([[0.0, 0.0], [0.05, 0.0], [0.9, -0.6], [-1.5, 2.0], [3.0, 0.1]])
    said = []
    for compiled in (False, True):
        with pytest.raises(DuhemError) as fault:
            simulate(bent, path, stiffness=[1.0, 2.0], substeps=2, compiled=compiled)
        said.append(str(fault.value))
    assert said[0] == said[1]


def test_what_has_no_loop_says_so():
    path, given = Path.linear([[0, 0], [1, 1]], pressure=-1.0), {"stiffness": 1.0, "parameters": CASES["box"][0]}
    plan = Plan.of(Run("box", path, projection="cvxpy", **given))
    with pytest.raises(InputError, match="projection by cvxpy has none"):
        next(compiled_run.advance(plan, Ledger.begun(2, np.zeros(2), np.zeros(2), plan.compliance)))
    with pytest.raises(InputError, match="a single extrapolated path"):
        simulate("box", path, **given, method="extrapolated", compiled=True)


def test_a_scene_says_where_the_loop_would_serve():
    text = walk(4, law="box", **CASES["box"][0]) + "pressure = -1.0\n[method]\n"
    said = [str(scene_file.reads(text + method).parts()) for method in ("", "compiled = true\n", 'projection = "cvxpy"\n')]
    assert ["with compiled = true" in parts for parts in said] == [True, False, False]
    assert "box has no closed form" in said[1]
