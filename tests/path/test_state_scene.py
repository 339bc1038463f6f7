"""Scenes of laws with a state: the calls they stand for, and the places of their faults."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from duhem import Path
from duhem.cli import cli
from duhem.path import scene_file
from tests.path.states import run

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
        ("substeps = 4", "substeps = 4\naccuracy = 1e-8", r":15:1: .*no accuracy"),
    ):
        with pytest.raises(scene_file.SceneFaults, match=said):
            scene_file.reads(SCENE.replace(old, new), "scene", tmp_path)
