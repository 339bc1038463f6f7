"""A run whose numbers leave the range of double precision ends in one sentence, and what was done before is kept."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from duhem import InputError, Path, simulate
from duhem.cli import cli
from duhem.path.integrators import INTEGRATORS

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
BEYOND = {  # points, pressure, stiffness
    "displacement": ([[0, 0], [1e-4, 0], [1e300, 1e300]], -1e6, [1e9, 2e9]),
    "pressure too": ([[0, 0], [1e280, 1e280], [1e290, 1e290], [0, 0]], -1e299, [1e9, 2e9]),
    "energies alone": ([[0, 0], [1e100, 0], [1e155, 1e155]], -1e200, [1.0, 2.0]),
    "coupled": ([[0, 0], [1e-4, 0], [1e300, 1e300]], -1e6, [[2e9, 1e9], [1e9, 2e9]]),
    "at rest": ([[0, 0], [1e10, 0], [1e200, 1e200]], -1e300, [1.0, 1.0]),
}


@pytest.mark.parametrize("name", BEYOND)
@pytest.mark.parametrize("method", INTEGRATORS)
def test_it_is_said_where_and_the_rows_before_are_kept(method, name):
    points, pressure, stiffness = BEYOND[name]
    given = {"stiffness": stiffness, "parameters": MU, "method": method}
    with warnings.catch_warnings(), pytest.raises(InputError, match=r"overflow or underflow.*units") as caught:
        warnings.simplefilter("error")
        simulate("antoni2007", Path.linear(points, pressure=pressure), **given)
    part = caught.value.history
    assert caught.value.where == f"path, step {len(part)}" and len(part) == (1 if name == "pressure too" else 2)
    assert np.isfinite(part.to_array()).all()
    if len(part) > 1:
        alone = simulate("antoni2007", Path.linear(points[: len(part)], pressure=pressure), **given)
        assert np.array_equal(part.to_array(), alone.to_array())


def test_a_prescribed_stress_too():
    path = Path.linear([[0, 0], [1e100, 0], [1e200, 0]], pressure=-1e250, control="stress")
    with pytest.raises(InputError, match=r"path, step 2.*overflow or underflow"):
        simulate("antoni2007", path, stiffness=1.0, parameters=MU)


@pytest.mark.parametrize("method", INTEGRATORS)
def test_the_command_says_it_and_keeps_the_table(method, tmp_path):
    numbers = "".join(f"{key} = {value}\n" for key, value in MU.items())
    scene = tmp_path / "scene.toml"
    scene.write_text(
        f'law = "antoni2007"\nstiffness = [1e9, 2e9]\n[parameters]\n{numbers}[path]\nkind = "linear"\n'
        f'points = [[0, 0], [1e-4, 0], [1e300, 1e300]]\npressure = -1e6\n[method]\nintegrator = "{method}"\n'
    )
    told = CliRunner().invoke(cli, ["simulate", str(scene), "--out", str(tmp_path / "h.csv"), "--plot", str(tmp_path / "h.png")])
    assert isinstance(told.exception, InputError)
    assert "overflow or underflow" in str(told.exception) and "h.csv.partial" in str(told.exception)
    assert len((tmp_path / "h.csv.partial").read_text().splitlines()) == 4  # the mark, the names, two knots


@pytest.mark.parametrize("wrong", [np.inf, -np.inf, np.nan])
def test_a_history_that_is_not_finite_is_not_drawn(wrong):
    history = simulate("antoni2007", Path.linear([[0, 0], [1, 0]], pressure=-1.0), stiffness=1.0, parameters=MU)
    with pytest.raises(InputError, match=r"not finite"):
        replace(history, psi=np.array([0.0, wrong])).plot()
