"""``duhem identify``: what it writes, prints and draws, and the tables and arguments that cannot be used."""

import json
import sys

import numpy as np
import pytest
from click.testing import CliRunner

import duhem
from duhem import InputError
from duhem.__main__ import main
from duhem.cli import cli
from tests.identification.limit_points import PAPER, table


def write(path, rows, header="sigma_a,sigma_b,sigma_n"):
    path.write_text(header + "\n" + "".join(",".join(map(repr, map(float, row))) + "\n" for row in rows))
    return path


def run(*arguments):
    return CliRunner().invoke(cli, list(map(str, arguments)), standalone_mode=False)


def test_command_writes_a_law_that_verify_proves(tmp_path):
    points = write(tmp_path / "points.csv", table(PAPER, noise=300.0))
    law = tmp_path / "law.toml"
    done = run("identify", points, "--out", law, "--bootstrap", 20, "--seed", 3)
    assert done.return_value == 0 and "mu_b_minus" in done.stdout and "bootstrap, 20 draws, seed 3" in done.stdout
    assert done.stderr == f"duhem: wrote the fitted law to {law}\n"
    assert run("verify", law, "--claims", "origin,convexity,normality,dissipation").return_value == 0
    direct = duhem.identify(points)
    read = duhem.load(str(law))
    assert {n: d.value for n, d in read.parameters.items()} == {n: d.value for n, d in direct.law.parameters.items()}
    assert duhem.verify(read, claims=["origin", "convexity", "normality"]).generalized_standard


def test_command_prints_one_json_object_and_names_lines(tmp_path):
    rows = table(PAPER, m=40, seed=5, noise=400.0)
    rows[3, :2] *= 1.4
    points = write(tmp_path / "points.csv", rows, "# stresses in Pa\nsigma_a,sigma_b,sigma_n")
    done = run("identify", points, "--format", "json", "--robust")
    report = json.loads(done.output)
    assert [(o["row"], o["line"]) for o in report["outliers"]] == [(4, 6)]
    assert report["parameters"]["mu_a_plus"]["value"] == duhem.identify(points, robust=True).coefficients["mu_a_plus"]
    assert report["generalized_standard"] is True


@pytest.mark.slow
def test_command_stays_inside_the_region(tmp_path):
    angles = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    reach = 0.3 * (1 + 0.8 * np.cos(angles))
    points = write(tmp_path / "points.csv", np.column_stack([reach * np.cos(angles), reach * np.sin(angles), -np.ones(40)]))
    done = run("identify", points, "--law", "limacon", "--inside", "--format", "json")
    report = json.loads(done.stdout)
    assert "only e in [0, 1/2] is tried, where K is proved convex" in done.stderr
    assert report["parameters"]["e"]["value"] == 0.5 and report["generalized_standard"] is True
    dented = run("identify", points, "--law", "limacon", "--set", "e=0.8", "--inside")
    assert "no range of one shape parameter" in str(dented.exception)


@pytest.mark.long
def test_command_draws(tmp_path):
    pytest.importorskip("matplotlib")
    rows = table(PAPER, m=40, seed=5, noise=400.0)
    rows[3, :2] *= 1.4
    points = write(tmp_path / "points.csv", rows)
    assert run("identify", points, "--plot", tmp_path / "fit.svg").return_value == 0
    assert "<svg" in (tmp_path / "fit.svg").read_text()
    with pytest.raises(InputError, match=r"end the name in \.png"):
        duhem.identify(points).plot(tmp_path / "fit.nothing")


GOOD = "0.2,0.01,-1\n-0.08,0.01,-1\n0.01,0.12,-1\n0.01,-0.15,-1\n"
HEAD = "sigma_a,sigma_b,sigma_n\n"


@pytest.mark.parametrize(
    "content, place, words",
    [
        ("", "", "empty"),
        ("\n \n", "", "empty"),
        (HEAD, "", "no row below the header"),
        ("sigma_a,sigma_n\n0.1,-1\n", ":1", "no column sigma_b"),
        (b"\xef\xbb\xbf" * 2 + f"{HEAD}{GOOD}".encode(), ":1", r"'\ufeffsigma_a' has an invisible character"),
        ("sigma_a,sigma_b\u200b,sigma_n\n" + GOOD, ":1", r"'sigma_b\u200b' has an invisible character"),
        ("sigma_a,sigma_b,sigma_n,sigma_a\n" + GOOD, ":1", "'sigma_a' is there twice"),
        ("sigma_a,sigma_b,sigma_n,wieght\n", ":1", "did you mean 'weight'"),
        ("sigma_a,sigma_b,sigma_n,weight,scatter\n", ":1", "both weight and scatter"),
        ("sigma_a;sigma_b;sigma_n\n0,1;0,2;-1\n", ":1", "separated by semicolons; separate numbers by commas"),
        ("sigma_n\tsigma_b\tsigma_a\n-1\t0.1\t0.2\n", ":1", "separated by tabs; separate numbers by commas"),
        ("note;sigma_a;sigma_b\nx;0.1;0.2\n", ":1", "separated by semicolons"),
        ("sigma_a sigma_b   sigma_n\n0.1 0.2 -1\n", ":1", "separated by blanks; separate numbers by commas"),
        ("sigma_a|sigma_b|sigma_n\n0.1|0.2|-1\n", ":1", "separated by bars"),
        (GOOD, ":1", "there is no header; write the names of the columns above, sigma_a,sigma_b,sigma_n"),
        (GOOD.replace(",", ";"), ":1", "separated by semicolons; separate numbers by commas, and write decimals with points"),
        (GOOD.replace(",", "\t").replace(".", ","), ":1", "separated by tabs; separate numbers by commas, and write decimals with points"),
        (HEAD + "0,2,0,01,-1\n", ":2", "5 cells under 3 columns; give one cell per column, and write decimals with points"),
        (HEAD + '"0,2",0,-1\n', ":2", "sigma_a is '0,2', not a number; write a number such as -1.5e6"),
        ("sigma_a [MPa],sigma_b,sigma_n\n" + GOOD, ":1", "no column sigma_a"),
        (HEAD + "0.2,0.01,-1\n", "", "there is only 1 point for the 4 unknowns"),
        (HEAD + "0.1,0.2\n", ":2", "2 cells under 3 columns"),
        (HEAD + GOOD + "0.1,abc,-1\n", ":6", "sigma_b is 'abc', not a number"),
        (HEAD + GOOD + "0.1,,-1\n", ":6", "sigma_b is empty"),
        (HEAD + GOOD + "nan,0.1,-1\n", ":6", "sigma_a is nan"),
        (HEAD + GOOD + "0.1,0.1,-inf\n", ":6", "sigma_n is -inf"),
        (HEAD + GOOD + "0.1,0.1,1\n", ":6", "sigma_n is not negative"),
        (HEAD + GOOD + "0.1,0.1,0\n", ":6", "sigma_n is not negative"),
        (HEAD + GOOD + "0,0,-1\n", ":6", "no limit point"),
        (HEAD + GOOD + "1e200,0,-1\n", ":6", "beyond"),
        (HEAD + "0.1,0.1,-1\n" * 5, "", "all 5 points are the same"),
        (HEAD + "0.2,0.01,-1\n-0.08,0.01,-1\n0.01,0.12,-1\n", "", "only 3 points for the 4 unknowns"),
        ("sigma_a,sigma_b,sigma_n,weight\n0.2,0.01,-1,-2\n0.1,0.1,-1,1\n", ":2", "weight is negative"),
        ("sigma_a,sigma_b,sigma_n,weight\n0.2,0.01,-1,0\n0.1,0.1,-1,0\n", "", "every weight is zero"),
        ("sigma_a,sigma_b,sigma_n,scatter\n0.2,0.01,-1,1\n0.1,0.1,-1,0\n", ":3", "scatter is not positive"),
        (b"\x89PNG\r\n\x1a\n\xff\xfe", ":1", "not text in UTF-8"),
        (b"sigma_a,sigma_b\x00,sigma_n\n", ":1", "binary"),
        (None, "", "there is no such file"),
    ],
)
def test_tables_that_cannot_be_used(content, place, words, tmp_path, monkeypatch, capsys):
    file = tmp_path / "points.csv"
    if content is not None:
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
    monkeypatch.setattr(sys, "argv", ["duhem", "identify", str(file)])
    assert main() == 2
    complaint = capsys.readouterr().err
    assert complaint.startswith(f"duhem: {file}{place}: ") and words in complaint
    assert complaint.count("\n") == 1 and "; " in complaint  # one line, with a remedy


def test_arguments_that_cannot_be_used():
    with pytest.raises(InputError, match=r"shape \(4, 2\)"):
        duhem.identify(np.ones((4, 2)))
    with pytest.raises(InputError, match="bootstrap"):
        duhem.identify(table(PAPER), bootstrap=-1)
    with pytest.raises(InputError, match="no free parameter"):
        duhem.identify(table(PAPER), "coulomb", parameters={"mu": 0.3})
    for dates in (np.array([2020], "M8[Y]"), np.array([3], "m8[s]"), np.array([True])):  # NumPy would make numbers of them
        with pytest.raises(InputError, match="sigma_a does not hold real numbers"):
            duhem.identify({"sigma_a": dates, "sigma_b": [0.1], "sigma_n": [-1.0]}, "coulomb")
    with pytest.raises(InputError, match="no column sigma_n"):
        duhem.identify({"sigma_a": [1.0], "sigma_b": [1.0]})
    with pytest.raises(InputError, match="no formula"):
        duhem.identify(table(PAPER), "wedge")
