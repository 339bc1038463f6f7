"""Paths and scenes of laws whose K is not shown to be convex: what is refused, what is said, what ends the run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import duhem
from duhem.api.histories import looked_into
from duhem.cli import cli
from duhem.errors import InputError
from duhem.path import scene_file

G = "norm(sigma_a, sigma_b)**2 - abs(sigma_n)*(norm(sigma_a, sigma_b) + e*sigma_a)"
OVAL = duhem.Criterion("oval", G, {"e": duhem.REAL})
ROUND, DENTED = {"e": "0.4"}, {"e": "0.8"}
FRONT = duhem.Path.linear([[0, 0], [3, 0.5], [3, 1]], pressure=-1.0)
DENT = duhem.Path.linear([[0, 0], [-3, 0]], pressure=-1.0)
NOT_SHOWN = "duhem could not show that K is convex"

SCENE = """\
law = "oval.toml"
stiffness = 1.0

[path]
kind = "linear"
points = [[0, 0], [3, 0.5]]
pressure = -1.0

[parameters]
e = 0.8

[method]
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "oval.toml").write_text(f'[criterion]\nname = "oval"\ng = "{G}"\n[parameters.e]\n', "utf-8")
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("method", ["implicit", "extrapolated"])
def test_a_run_over_stationary_points_says_so(method: str) -> None:
    found = duhem.simulate(OVAL, FRONT, stiffness=1.0, parameters=DENTED, method=method)
    assert NOT_SHOWN in found.why
    assumed = duhem.simulate(OVAL, FRONT, stiffness=1.0, parameters=DENTED, method=method, convex="assume")
    assert NOT_SHOWN not in assumed.why and np.array_equal(found.to_array(), assumed.to_array())
    assert NOT_SHOWN not in duhem.simulate(OVAL, FRONT, stiffness=1.0, parameters=ROUND, method=method).why


def test_a_nearer_point_ends_the_run() -> None:
    with pytest.raises(duhem.DuhemError, match=r"^step 1: .*K is not convex there"):
        duhem.simulate(OVAL, DENT, stiffness=1.0, parameters=DENTED)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["implicit", "extrapolated", "exact"])
def test_require_refuses_every_integrator(method: str) -> None:
    with pytest.raises(InputError, match="is convex is refuted"):
        duhem.simulate(OVAL, FRONT, stiffness=1.0, parameters=DENTED, method=method, convex="require")
    duhem.simulate(OVAL, FRONT, stiffness=1.0, parameters=ROUND, method=method, convex="require")


@pytest.mark.slow
def test_an_open_contact_is_asked_about_too() -> None:
    lifted = duhem.Path.linear([[0, 0], [3, 0.5], [3, 1]], pressure=[-1.0, -0.5, 0.0])
    found = duhem.simulate(OVAL, lifted, stiffness=1.0, parameters=ROUND, convex="require")
    assert not found.stress[-1].any()


def test_another_word_is_refused() -> None:
    with pytest.raises(InputError, match="choose ask, require, assume"):
        duhem.simulate(OVAL, FRONT, stiffness=1.0, parameters=ROUND, convex="yes")


@pytest.mark.parametrize(("line", "code", "said"), [("", 0, ""), ('convex = "assume"', 0, ""), ('convex = "require"', 2, "is refuted")])
def test_a_scene_says_what_it_asks_of_k(folder: Path, line: str, code: int, said: str) -> None:
    (folder / "scene.toml").write_text(SCENE + line + "\n", "utf-8")
    done = CliRunner().invoke(cli, ["simulate", str(folder / "scene.toml")], standalone_mode=False)
    if code:
        assert isinstance(done.exception, InputError) and said in str(done.exception)
    else:
        assert done.return_value == 0 and done.output.startswith("time,")
        assert done.stderr == (
            "" if line else f"duhem: in 1 of 1 steps {NOT_SHOWN}: the point is stationary, and a closer point may exist\n"
        )
        assert (NOT_SHOWN in CliRunner().invoke(cli, ["simulate", str(folder / "scene.toml"), "--explain"]).stdout) is not bool(line)


def test_stationary_steps_and_points_are_counted(folder: Path) -> None:
    path = duhem.Path.linear([[0, 0], [0.1, 0], [3, 0.5], [3.1, 0.5], [3, 0.5]], pressure=-1.0)
    found = duhem.simulate(OVAL, path, stiffness=1.0, parameters=DENTED)
    assert found.stationary() == 2 and "2 stationary" in repr(found) and str(found.remark()).startswith(f"in 2 of 4 steps {NOT_SHOWN}")
    assert duhem.simulate(OVAL, path, stiffness=1.0, parameters=DENTED, convex="assume").remark() is None

    (folder / "points.csv").write_text("scale\n1\n0.01\n", "utf-8")
    (folder / "many.toml").write_text(SCENE + '[points]\ntable = "points.csv"\n', "utf-8")
    for out in ([], ["--out", str(folder / "h.csv")]):
        done = CliRunner().invoke(cli, ["simulate", str(folder / "many.toml"), *out], standalone_mode=False)
        assert done.return_value == 0 and done.stderr.startswith(f"duhem: in the slips of 1 of 2 points, {NOT_SHOWN}")


def test_a_scene_that_requires_is_not_run_unasked(folder: Path) -> None:
    text = SCENE.replace("0.8", "0.4") + 'convex = "require"\n'
    scene = scene_file.reads(text, folder=folder)
    with pytest.raises(InputError, match="it is unknown whether K is convex"):
        scene.run()
    assert len(looked_into(scene).run()) == 2
    flat = scene_file.reads(text.replace("oval.toml", "coulomb").replace("e = 0.4", "mu = 0.4"), folder=folder)
    assert len(looked_into(flat).run()) == 2  # the closed form knows


def test_a_wrong_word_in_a_scene_is_a_fault_of_it(folder: Path) -> None:
    with pytest.raises(scene_file.SceneFaults, match="convex"):
        scene_file.reads(SCENE + 'convex = "maybe"\n', folder=folder)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["implicit", "extrapolated"])
def test_many_points_are_asked_about_over_the_range_of_their_numbers(method: str) -> None:
    paths = duhem.Paths.linear([[[0, 0], [3, 0.5]], [[0, 0], [0.1, 0]]], pressure=-1.0)
    for e, status in (([0.2, 0.4], duhem.Status.SLIP), ([0.2, 0.8], duhem.Status.STATIONARY)):
        found = duhem.simulate(OVAL, paths, stiffness=1.0, parameters={"e": np.array(e)}, method=method)
        assert found.status.tolist() == [status, duhem.Status.STICK]
        assert (NOT_SHOWN in found.why) == (status == duhem.Status.STATIONARY)
        alone = duhem.simulate(OVAL, paths.path(0), stiffness=1.0, parameters={"e": e[0]}, method=method)
        assert np.array_equal(found.stress[0], alone.stress)
    with pytest.raises(InputError, match="is convex is refuted"):
        duhem.simulate(OVAL, paths, stiffness=1.0, parameters={"e": np.array([0.2, 0.8])}, method=method, convex="require")
    shaped = duhem.simulate("coulomb", paths, stiffness=1.0, parameters={"mu": np.array([0.2, 0.3])}, method=method, convex="require")
    assert shaped.status.tolist() == [duhem.Status.SLIP, duhem.Status.STICK]


def test_a_nearer_point_ends_the_path_of_one_of_many() -> None:
    paths = duhem.Paths.linear([[[0, 0], [-3, 0]], [[0, 0], [3, 0.5]]], pressure=-1.0)
    found = duhem.simulate(OVAL, paths, stiffness=1.0, parameters=DENTED)
    assert found.status.tolist() == [duhem.Status.INACCURATE, duhem.Status.STATIONARY] and found.reached.tolist() == [0, 1]
