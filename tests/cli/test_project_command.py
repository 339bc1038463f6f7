"""duhem project: what it prints, refuses and returns."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

import duhem
from duhem.projection import closed_form
from duhem.projection.increment import Increment
from duhem.projection.method import Options
from duhem.projection.result import Solution

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(run: Run) -> Run:
    """Exit code, standard output and standard error of `duhem project ARGUMENTS`."""
    return partial(run, "project")


SET = [x for name, value in MU.items() for x in ("--set", f"{name}={value}")]


def test_command_prints_the_step_and_its_residuals(run: Run) -> None:
    code, out, err = run("antoni2007", *SET, "--trial", "0.3", "-0.01", "--pressure", "-1", "--tangent")
    assert (code, err) == (0, "")
    for piece in ("0.199875612441215", "-0.00528947044397025", "slip", "closed-form", "stationarity", "variational", "d stress/d sigma_n"):
        assert piece in out
    assert max(map(len, out.splitlines())) <= 100


def test_command_in_json(run: Run) -> None:
    code, out, _ = run("antoni2007", *SET, "--pressure", "-1", "--stiffness", "1", "4", "--format", "json", "--trial", "-0.3", "-0.2")
    report = json.loads(out)
    assert code == 0
    assert report["stress"] == pytest.approx([-0.076140510365716902, -0.04602820183065], rel=1e-14)
    assert report["status"] == "slip"
    assert set(report["residuals"]) == {"feasibility", "multiplier_sign", "complementarity", "stationarity", "variational"}


def test_command_takes_a_matrix_and_fractions(run: Run) -> None:
    matrix = run("coulomb", "--set", "mu=0.3", "--trial=1/2,1", "--pressure", "-1", "--stiffness", "2", "-1", "-1", "2", "--format", "json")
    done = duhem.project("coulomb", [0.5, 1.0], -1.0, [[2.0, -1.0], [-1.0, 2.0]], {"mu": "0.3"})
    assert json.loads(matrix[1])["stress"] == done.stress[0].tolist()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["coulomb", "--set", "mu=1", "--trial", "1", "2", "--pressure", "1"], "pressure is 1.0 > 0"),
        (["coulomb", "--set", "mu=1", "--trial", "1", "nan", "--pressure", "-1"], "--trial: 'nan' is not a number"),
        (["coulomb", "--set", "mu=1", "--trial", "1", "2", "3", "--pressure", "-1"], "trial has the shape"),
        (["coulomb", "--trial", "1", "2", "--pressure", "-1"], "no value is given for mu"),
        (["coulomb", "--set", "mu=1", "--trial", "1", "2", "--pressure", "-1,-2"], "this option has 2 numbers"),
        (["coulomb", "--set", "mu=1", "--pressure", "-1"], "--trial"),
    ],
)
def test_command_refuses(run: Run, arguments: list[str], message: str) -> None:
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert message in err


def test_command_ends_with_4_where_the_point_is_not_solved(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def beyond(question: Increment, _: Options) -> Solution:
        right = closed_form.solve(question)
        return replace(right, stress=right.stress * 1.1)

    monkeypatch.setattr(closed_form, "CLOSED_FORM", replace(closed_form.CLOSED_FORM, solve=beyond))
    code, out, _ = run("coulomb", "--set", "mu=0.3", "--trial", "1", "2", "--pressure", "-1")
    assert code == 4
    assert "inaccurate" in out


@pytest.mark.slow
def test_command_ends_with_4_at_a_point_that_is_stationary_only(run: Run, tmp_path: Path) -> None:
    law = tmp_path / "oval.toml"
    law.write_text(
        '[criterion]\nname = "oval"\ng = "norm(sigma_a, sigma_b)**2 - abs(sigma_n)*(norm(sigma_a, sigma_b) + 3*sigma_a/5)"\n', "utf-8"
    )
    for convex in ("ask", "assume"):
        code, out, _ = run(str(law), "--trial", "-3", "0", "--pressure", "-1", "--convex", convex)
        assert code == 4
        assert "inaccurate (K is not convex there" in out
    for trial, expected in (("-3", 4), ("3", 0)):
        code, out, _ = run(str(law), "--trial", trial, "0", "--pressure", "-1", "--format", "json", "--convex", "assume")
        assert code == expected
        assert (json.loads(out)["remark"] is None) == (code == 0)


@pytest.mark.slow
def test_command_ends_with_4_where_nobody_vouches_that_a_stationary_point_is_closest(run: Run, tmp_path: Path) -> None:
    law = tmp_path / "oval.toml"
    g = "norm(sigma_a, sigma_b)**2 - abs(sigma_n)*(norm(sigma_a, sigma_b) + e*sigma_a)"
    law.write_text(f'[criterion]\nname = "oval"\ng = "{g}"\n[parameters.e]\n', "utf-8")
    asked = [str(law), "--trial", "3", "0", "--pressure", "-1"]
    code, out, _ = run(*asked, "--set", "e=0.6")
    assert code == 4 and "stationary (duhem could not show that K is convex" in out
    code, out, _ = run(*asked, "--set", "e=0.6", "--format", "json")
    assert code == 4 and json.loads(out)["status"] == "stationary" and "could not show" in json.loads(out)["remark"]
    code, out, err = run(*asked, "--set", "e=0.6", "--convex", "require")
    assert (code, out) == (2, "") and "that K of oval is convex is refuted" in err
    for convex in ("ask", "require"):
        assert run(*asked, "--set", "e=0.4", "--convex", convex)[0] == 0


def test_what_is_missing_is_asked_for_in_the_words_of_the_command(run: Run) -> None:
    code, out, message = run("coulomb", "--trial", "1", "1", "--pressure", "-1", "--stiffness", "1")
    assert (code, out) == (2, "")
    assert "--set mu=VALUE" in message and "parameters=" not in message
    code, out, message = run("coulomb", "--set", "mu=0.2", "--trial", "1", "1", "--stiffness", "1")
    assert (code, out) == (2, "")
    assert message.startswith("duhem: --pressure: coulomb needs the pressure sigma_n")


def test_a_law_with_a_flow_of_its_own_is_refused_before_its_parameters_are_asked_for(run: Run) -> None:
    code, out, message = run("hjiaj", "--trial", "1", "1", "1", "--pressure", "-1")
    assert (code, out) == (2, "")
    assert "has its own flow direction" in message and "--set" not in message


def test_an_edge_without_a_tangent_says_so(run: Run) -> None:
    code, out, _ = run("tresca-tensor", "--set", "s0=1", "--trial", "2", "1.9", "0", "0", "0", "0", "--tangent")
    assert code == 0
    assert "unknown: degenerate corner" in out and "nan" not in out
