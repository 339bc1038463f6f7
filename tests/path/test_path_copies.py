"""Paths, histories, trajectories and scenes are values: pickled or copied they are the same to the last bit."""

import copy
import pickle
from dataclasses import fields, is_dataclass
from functools import cache

import numpy as np
import pytest
import sympy as sp

from duhem import Path, simulate
from duhem.path import scene_file
from duhem.path.picture import trajectory
from tests.long import long_but

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
SCENE = """\
law = "antoni2007"
stiffness = [1.0, 2.0]
stress = [0.01, 0.0]
[parameters]
mu_a_plus = 0.2
mu_a_minus = 0.08
mu_b_plus = 0.12
mu_b_minus = 0.15
[path]
kind = "random"
seed = 3
points = 5
scale = 0.3
pressure = -1.0
[method]
integrator = "exact"
"""


def pickled(value):
    return pickle.loads(pickle.dumps(value))


def same(a, b):
    """Equal in every field, arrays bit for bit."""
    if isinstance(a, np.ndarray):
        return type(b) is type(a) and a.dtype == b.dtype and a.tobytes() == b.tobytes()
    if is_dataclass(a) and not isinstance(a, sp.Basic):
        return type(a) is type(b) and all(same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    return bool(a == b)


@cache
def histories():
    path = Path.random(seed=3, points=2, scale=0.3, pressure=(-2.0, -0.5))
    stressed = Path.linear([[0, 0], [0.1, 0.05]], pressure=-1.0, control="stress")
    return [
        *(
            simulate("antoni2007", path, stiffness=[1.0, 2.0], parameters=MU, method=method)
            for method in ("implicit", "extrapolated", "exact")
        ),
        simulate("coulomb", Path.circle(0.3, points=5, pressure=-1.0), stiffness=1.0, parameters={"mu": 0.2}, method="exact"),
        simulate("box", path, stiffness=1.0, parameters={"mu_a": 0.2, "mu_b": 0.1}),
        simulate("antoni2007", stressed, stiffness=1.0, parameters=MU),
    ]


@pytest.mark.slow
@pytest.mark.parametrize("copied", long_but([1], [pickled, copy.deepcopy]), ids=["pickle", "deepcopy"])
def test_histories_and_their_trajectories_are_the_same_after_copying(copied):
    for history in histories():
        back = copied(history)
        assert same(history, back) and back.plan.increment.g == history.plan.increment.g
        assert back.to_text() == history.to_text()
        assert same(trajectory(back, 4), trajectory(history, 4))
        assert same(copied(trajectory(history, 4)), trajectory(history, 4))


@pytest.mark.parametrize("copied", [pickled, copy.deepcopy], ids=["pickle", "deepcopy"])
def test_scenes_and_paths_are_the_same_after_copying(copied):
    scene = scene_file.reads(SCENE)
    back = copied(scene)
    assert same(scene, back) and back.fingerprint == scene.fingerprint and same(back.run(), scene.run())
    for path in (scene.path, Path.circle(0.3, points=5), Path.cycle(1.0, pressure=-1.0)):
        assert same(copied(path), path)


def test_a_difference_would_be_seen():
    history, *_ = histories()
    other = copy.deepcopy(history)
    other.stress[-1, 0] = np.nextafter(other.stress[-1, 0], np.inf)
    assert not same(history, other)
