"""The ranges that a law declares of its pressure and forces: refused where they are asked for, said where they are left."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path as File

import numpy as np
import pytest

import duhem
from duhem import Criterion, Domain, Path, Status
from duhem.errors import InputError
from duhem.path.history import LeftDomain
from duhem.projection.increment import beyond, crossed, refused
from duhem.testing import conformance, projection

HALF = {"mu": Domain.fixed("1/2")}
CONE = Criterion(
    "cone",
    "norm(sigma_a, sigma_b) - mu*abs(sigma_n)",
    HALF,
    domain={"sigma_n": Domain.between(-10, "-0.1"), "sigma_a": Domain.between(-1, "0.3")},
)
FREE = Criterion("cone", "norm(sigma_a, sigma_b) - mu*abs(sigma_n)", HALF)
FILE = """[criterion]
name = "cone"
g = "norm(sigma_a, sigma_b) - mu*abs(sigma_n)"
[domain]
sigma_n = { min = -10 }
sigma_a = { max = 0.3 }
[parameters]
mu = { value = 0.5 }
"""


@pytest.mark.parametrize("pressure", [-10.0, -0.1, [-10.0, -0.1, -3.0]])
def test_the_ends_of_a_range_belong_to_it(pressure) -> None:
    """-0.1 as a double is less than -1/10, and is what a user means by it."""
    assert not refused(CONE, np.atleast_1d(pressure)).any()
    assert (duhem.project(CONE, [0.0, 9.0], pressure).status == Status.SLIP).all()


@pytest.mark.parametrize(
    ("pressure", "said"),
    [
        (-10.000001, "pressure[0] is -10.000001, outside the range of sigma_n in [-10, -1/10]"),
        (0.0, "pressure[0] is 0.0, outside"),
        ([-1.0, -2.0, -0.05, -30.0], "pressure[2] is -0.05, outside"),
    ],
)
def test_a_pressure_outside_is_refused(pressure, said: str) -> None:
    asked = np.atleast_1d(pressure)
    with pytest.raises(InputError, match="keep to the range") as fault:
        duhem.project(CONE, np.zeros((len(asked), 2)), asked)
    assert said in str(fault.value)
    assert (duhem.project(FREE, np.zeros((len(asked), 2)), asked).status == Status.STICK).all()


def test_a_stress_outside_is_said_so_point_by_point() -> None:
    """The trial may lie anywhere; what counts is where the stress ends, to rounding."""
    trial = np.array([[9.0, 0.0], [0.29, 0.0], [0.31, 0.0], [-9.0, 0.0], [0.9, 1.2], [0.3, 0.0], [9.0, 1e-3], [0.9, 1e300]])
    found = duhem.project(CONE, trial, -1.0)
    free = duhem.project(FREE, trial, -1.0)
    np.testing.assert_array_equal(found.stress, free.stress)
    assert [Status(s).name for s in found.status] == ["OUTSIDE", "STICK", "OUTSIDE", "SLIP", "SLIP", "STICK", "OUTSIDE", "SLIP"]
    assert (found.status == np.where(found.stress[:, 0] > 0.3 + 1e-9, Status.OUTSIDE, free.status)).all()


def test_what_is_not_solved_is_not_called_outside() -> None:
    not_convex = Criterion(
        "star",
        "sigma_a**2*sigma_b**2 + (sigma_a**2 + sigma_b**2)/100 - 1",
        pressure=None,
        domain={"sigma_a": Domain.between(-1, "0.9")},
    )
    found = duhem.project(not_convex, [3.0, 3.0])
    assert found.stress[0, 0] > 0.9
    assert found.status[0] == Status.INACCURATE


def test_stresses_are_held_against_each_range() -> None:
    law = Criterion(
        "ball",
        "norm(a, b, c) - 5",
        forces=("a", "b", "c"),
        pressure=None,
        domain={"c": Domain.between(-1, None), "a": Domain.between(None, 2)},
    )
    stress = np.array([[2.0, 99.0, -1.0], [2.1, 0.0, 0.0], [0.0, 0.0, -1.1], [-99.0, 0.0, 99.0]])
    assert beyond(law, stress).tolist() == [False, True, True, False]
    assert crossed(law, stress) == "a = 2.1 lies outside its range (-oo, 2]"
    assert crossed(law, stress[2:]) == "c = -1.1 lies outside its range [-1, oo)"
    just = np.array([[2.0000000001, 0.0, 0.0]])
    assert crossed(law, just) == "a = 2.0000000001 lies outside its range (-oo, 2]"


@pytest.mark.slow
@pytest.mark.parametrize("method", ["implicit", "extrapolated", "exact"])
@pytest.mark.parametrize("closed", [True, False])
def test_a_path_ends_where_its_stress_leaves_a_range(method: str, closed: bool) -> None:
    """Whichever way the stress is found: by closed form, by solving, or along the boundary."""
    law = duhem.load("coulomb").fix({"mu": "1/2"}) if closed else FREE
    ranged = Criterion("ranged", law.g, law.parameters, closed_form=law.closed_form, domain={"sigma_a": Domain.between(-2, 1)})
    path = Path.linear([[0, 0], [0, 1], [2, 1], [4, 4]], pressure=-4.0)
    with pytest.raises(LeftDomain, match=r"at time 1\.\d+ sigma_a = 1\.\d+ lies outside its range \[-2, 1\]") as left:
        duhem.simulate(ranged, path, stiffness=1.0, method=method, substeps=4)
    whole = duhem.simulate(law, path, stiffness=1.0, method=method, substeps=4)
    kept = left.value.history
    np.testing.assert_array_equal(kept.stress, whole.stress[: len(kept)])
    assert (kept.stress[:, 0] <= 1.0).all()
    assert whole.stress[len(kept), 0] > 1.0


def test_a_path_starts_in_range_and_stays_under_pressures_in_range() -> None:
    with pytest.raises(InputError, match=r"the initial stress: sigma_a = 0\.5 lies outside its range"):
        duhem.simulate(CONE, Path.linear([[0, 0], [0, 1]], pressure=-9.0), stiffness=1.0, stress=[0.5, 0.0])
    with pytest.raises(InputError, match=r"pressure\[1\] is -11\.0, outside the range"):
        duhem.simulate(CONE, Path.linear([[0, 0], [0, 1]], pressure=[-9.0, -11.0]), stiffness=1.0)
    with pytest.raises(InputError, match=r"at time 1 sigma_a = 0\.5 lies outside its range"):
        duhem.simulate(CONE, Path.linear([[0, 0], [0.5, 0]], pressure=-9.0, control="stress"), stiffness=1.0)


def test_commands_name_the_range(tmp_path: File, run: Callable[..., tuple[int, str, str]]) -> None:
    law = tmp_path / "cone.toml"
    law.write_text(FILE)
    code, out, err = run("project", str(law), "--trial", "9", "0", "--pressure", "-11")
    assert (code, out) == (2, "")
    assert "pressure is -11.0, outside the range of sigma_n in [-10, oo)" in err
    code, out, _ = run("project", str(law), "--trial", "9", "0", "--pressure", "-1", "--format", "json")
    found = json.loads(out)
    assert (code, found["status"]) == (4, "outside")
    assert found["remark"] == "sigma_a = 0.5 lies outside its range (-oo, 3/10], where cone is not declared"
    code, out, _ = run("project", str(law), "--trial", "9", "0", "--pressure", "-1")
    assert "outside (sigma_a = 0.5 lies outside" in " ".join(out.split())
    scene = tmp_path / "scene.toml"
    text = 'law = "cone.toml"\nstiffness = 1\n[path]\nkind = "linear"\npoints = [[0, 0], [0, 1], [9, 1]]\npressure = {}\n'
    scene.write_text(text.format("[-1, -1, -11]"))
    code, _, err = run("simulate", str(scene))
    assert code == 2
    assert f"{scene}:6" in err
    assert "outside the range" in err
    scene.write_text(text.format(-1))
    table = tmp_path / "history.csv"
    code, _, err = run("simulate", str(scene), "--out", str(table))
    assert code == 2
    assert "lies outside its range (-oo, 3/10]" in err
    assert len(list(tmp_path.glob("history*"))) == 1  # what came before is kept


@pytest.mark.slow
def test_the_suite_draws_pressures_in_range() -> None:
    report = conformance(CONE, projection(CONE), max_examples=3, rows=6)
    assert report.ok, str(report)
    assert report.flagged < report.points
    assert "homogeneity" in report.left_out  # a multiple of a pressure may lie outside
