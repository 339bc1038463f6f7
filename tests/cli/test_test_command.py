"""``duhem test``: what it says of routines right and wrong, its exit codes, and what it writes."""

from __future__ import annotations

import json
import runpy
import shlex
import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from xml.etree import ElementTree

import pytest

from duhem.cli.verbs import test as command
from duhem.errors import DuhemError, InputError

ROUTINES = """
import numpy as np
from duhem.testing import Step
from duhem.testing.routines import Unfinished

def right(trial, pressure, stiffness, mu):
    size, limit = np.hypot(*trial.T), -mu * pressure
    with np.errstate(all="ignore"):
        return np.where((size > limit)[:, None], trial / size[:, None] * limit[:, None], trial)

def elastic(trial, pressure, stiffness, mu):
    return trial

def flags_slip(trial, pressure, stiffness, mu):
    return Step(trial, solved=np.hypot(*trial.T) <= -mu * pressure)

def flags_most_slip(trial, pressure, stiffness, mu):
    step = right(trial, pressure, stiffness, mu)
    return Step(step, solved=np.hypot(*trial.T) <= -mu * pressure * (1 + 1e-9))

def flags_some(trial, pressure, stiffness, mu):
    return Step(right(trial, pressure, stiffness, mu), solved=trial[:, 0] < -pressure)

def gives_up(trial, pressure, stiffness, mu):
    return Step(trial, solved=np.zeros(len(trial), dtype=bool))

def endless(trial, pressure, stiffness, mu):
    if (pressure < -2.0).any():
        raise Unfinished("endless has not answered within 120 s", remedy="look where its loop ends")
    return right(trial, pressure, stiffness, mu)

calls = 0

def stopped(trial, pressure, stiffness, mu):
    global calls
    calls += 1
    if calls > 2:
        raise KeyboardInterrupt
    return right(trial, pressure, stiffness, mu)

def plain(trial, pressure, stiffness, limit):
    size = np.hypot(*trial.T)
    return trial * np.where(size > limit, limit / np.where(size > 0, size, 1.0), 1.0)[:, None]

number = 3
"""
FEW = ["--examples", "2", "--seed", "7", "--shrink", "20", "--checks"]

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    (tmp_path / "my_routines.py").write_text(ROUTINES, "utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    yield
    sys.modules.pop("my_routines", None)


def of(routine: str) -> list[str]:
    return ["test", f"my_routines:{routine}", "--law", "coulomb"]


@pytest.mark.slow
def test_a_right_routine_passes_and_what_was_visited_is_said(run: Command) -> None:
    code, out, err = run(*of("right"), *FEW, "feasibility,vacuity,repeatability")
    assert (code, err) == (0, "")
    assert "3 checks passed, 0 failed" in out and "2 examples in" in out and "a second" in out
    assert "checks that call the routine again used one increment in 7; --every 1 uses all of them" in out
    assert "pairs of stresses" not in out
    of_the_law = run(*of("right"), *FEW, "feasibility,convexity")[1]
    assert (
        "one increment in" not in of_the_law
        and "convexity was tested only on 60 pairs of stresses and 7936 pairs of boundary points; " in of_the_law
    )
    assert "visited: stick 0." in out and "decades: stress 1e" in out
    (line,) = [line for line in out.splitlines() if line.startswith("again: ")]
    words = shlex.split(line.removeprefix("again: duhem "))
    assert words[-2:] == ["--seed", "7"]
    shares = [line for line in out.splitlines() if line.startswith(("visited", "decades"))]
    assert [line for line in run(*words)[1].splitlines() if line.startswith(("visited", "decades"))] == shares


@pytest.mark.slow
@pytest.mark.parametrize(
    ("routine", "checks", "code"),
    [
        ("elastic", "feasibility", 1),
        ("flags_slip", "vacuity", 1),
        ("gives_up", "ray", 4),
        ("flags_most_slip", "vacuity", 1),
        ("gives_up", "vacuity", 4),
        ("flags_some", "answers,vacuity", 1),
    ],
)
def test_the_exit_code_says_what_came_out(routine: str, checks: str, code: int, run: Command) -> None:
    assert run(*of(routine), *FEW, checks)[0] == code


def test_how_much_may_be_flagged_is_asked_for(run: Command) -> None:
    for share, code in (("0.01", 1), ("0.9", 0)):
        found, out, _ = run(*of("flags_some"), *FEW, "answers", "--most-flagged", share)
        assert found == code and (f"increments as not solved, more than the allowed fraction {share}" in out) == bool(code)
        assert f"--most-flagged {share}" in out
        named = ElementTree.fromstring(run(*of("flags_some"), *FEW, "answers", "--most-flagged", share, "--format", "junit")[1])
        (case,) = (each for each in named.iter("testcase") if each.get("name") == "flagged")
        assert [f"more than the allowed fraction {share}" in each.get("message", "") for each in case.iter("failure")] == [True] * code
        assert {each.get("name"): each.get("value") for each in named.iter("property")}["most_flagged"] == share
    assert run(*of("flags_some"), *FEW, "answers", "--most-flagged", "2")[2].startswith("duhem: --most-flagged: 2.0 is not a fraction; ")
    assert "this option applies only to your own routine" in run("test", "coulomb", "--most-flagged", "0.1")[2]


def test_all_is_asked_of_every_increment_where_that_is_said(run: Command) -> None:
    asked = [run(*of("right"), *FEW, "ray", *more)[1] for more in ([], ["--every", "3"], ["--every", "1"])]
    counts = [int(next(line for line in out.splitlines() if "increments" in line).split("; ")[1].split()[0]) for out in asked]
    assert counts[0] < counts[1] < counts[2] and "one increment in 3" in asked[1] and "one increment in" not in asked[2]
    assert all(f"--every {n} --seed 7" in out for n, out in ((3, asked[1]), (1, asked[2]))) and "--every 0" not in asked[0]
    code, _, err = run(*of("right"), "--every", "0")
    assert code == 2 and "'--every': 0 is not in the range x>=1" in err


def test_a_failure_is_told_once_and_written_as_a_test(run: Command, tmp_path: Path) -> None:
    code, out, _ = run(*of("elastic"), *FEW, "feasibility,slip", "--replay", "replays")
    assert code == 1 and out.count("feasibility: the stress is admissible") == 1
    (file,) = (tmp_path / "replays").iterdir()
    with pytest.raises(AssertionError, match="measured"):
        runpy.run_path(str(file))["test_feasibility"]()


def test_a_check_may_be_expected_to_fail_and_must_then(run: Command) -> None:
    expected = ["--expect", "feasibility=not yet written"]
    code, out, _ = run(*of("elastic"), *FEW, "feasibility", *expected)
    assert code == 0 and "feasibility failed, as expected: not yet written" in out
    code, out, _ = run(*of("right"), *FEW, "feasibility", *expected)
    assert code == 1 and "feasibility passed, but was expected to fail: not yet written" in out


@pytest.mark.slow
def test_formats_for_programs(run: Command) -> None:
    code, out, _ = run(*of("elastic"), *FEW, "feasibility,repeatability,slip", "--format", "json")
    (found,) = json.loads(out)["routines"].values()
    assert code == 1 and found["passed"] == ["repeatability"] and [*found["left_out"]] == ["slip"]
    (failure,) = found["failures"]
    assert failure["check"] == "feasibility" and failure["departure"]["returned"] == failure["departure"]["trial"]
    code, out, _ = run(*of("elastic"), *FEW, "feasibility,repeatability,slip", "--format", "junit")
    (suite,) = ElementTree.fromstring(out)
    assert code == 1 and (suite.get("tests"), suite.get("failures"), suite.get("skipped")) == ("4", "1", "1")
    assert {case.get("name"): [child.tag for child in case] for case in suite.iter("testcase")} == {
        "repeatability": [],
        "feasibility": ["failure"],
        "slip": ["skipped"],
        "flagged": [],
    }
    assert {p.get("name"): p.get("value") for p in suite.iter("property")}["seed"] == "7"


def test_a_law_is_tested_by_every_method_that_takes_it(run: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    methods = ["closed-form", "newton"]  # a solver of cones is dear to import
    monkeypatch.setattr(import_module("duhem.testing.conformance"), "METHODS", methods)
    code, out, _ = run("test", "tresca", *FEW, "answers", "--examples", "1")
    assert code == 0
    assert "tresca newton" in out.splitlines() and "closed-form skipped: " in out


@pytest.mark.parametrize("constraint", ["b > 4/b", "b > 1000", "1/b > 50"])
def test_a_method_is_tried_at_parameters_that_the_law_admits(
    constraint: str, run: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(import_module("duhem.testing.conformance"), "METHODS", ["newton"])
    head = f'[criterion]\nname = "bound"\ng = "norm(sigma_a, sigma_b) + b*sigma_n"\nconstraints = ["{constraint}"]\n'
    (tmp_path / "bound.toml").write_text(f"{head}[parameters]\nb = {{ positive = true }}\n", "utf-8")
    code, out, _ = run("test", "bound.toml", *FEW, "answers", "--examples", "1")
    assert code == 0 and "bound newton" in out.splitlines()


def test_a_routine_that_misses_a_parameter_that_is_set_is_told_why(run: Command) -> None:
    code, out, _ = run(*of("right"), "--set", "mu=0.3", *FEW, "answers")
    assert code == 1 and "missing 1 required positional argument: 'mu' (duhem passes only parameters without a value; mu has one: " in out


def test_a_routine_may_be_tested_without_a_law(run: Command) -> None:
    asked = ["test", "my_routines:plain", "--stiffness", "1 1", "--set", "limit=0.5", "--examples", "3", "--seed", "7", "--shrink", "20"]
    code, out, err = run(*asked)
    assert (code, err) == (0, "") and "without a law" in out and "0 failed" in out and "slip 0." in out


def test_who_interrupts_sees_what_was_found(run: Command) -> None:
    code, out, _ = run(*of("stopped"), "--checks", "feasibility,answers", "--seed", "7")
    assert code == 130 and "2 checks passed, 0 failed" in out and "visited: " in out


def test_a_routine_that_does_not_come_back_is_an_error_and_written_as_a_test(run: Command, tmp_path: Path) -> None:
    code, _, err = run(*of("endless"), *FEW, "feasibility", "--replay", "replays")
    said, wrote = err.splitlines()
    assert (
        code == 4
        and said.startswith("duhem: coulomb, mu = ")
        and said.endswith(", in the check feasibility: endless has not answered within 120 s; look where its loop ends")
    )
    (file,) = (tmp_path / "replays").iterdir()
    assert wrote == f"duhem: wrote a failure as a test to replays/{file.name}"
    with pytest.raises(DuhemError, match="has not answered"):
        runpy.run_path(str(file))["test_feasibility"]()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["test", "my_routines:right"], "name its law, for example --law coulomb"),
        (["test", "my_routines:plain", "--stiffness", "1 1", "--checks", "feasibility"], "unknown check 'feasibility'"),
        ([*of("number")], "my_routines:number is a int, not a routine"),
        ([*of("absent")], "cannot be imported"),
        ([*of("right"), "--checks", "feasable"], "did you mean 'feasibility'?"),
        ([*of("right"), "--checks", ","], "no check is selected"),
        ([*of("right"), "--expect", "slope"], "not of the form CHECK=REASON"),
        ([*of("right"), "--expect", "slop=because"], "did you mean 'slope'?"),
        ([*of("right"), "--accuracy", "0"], "--accuracy: the accuracy is not positive"),
        ([*of("right"), "--pressure", "1"], "--pressure: sigma_n = 1.0 is positive; sigma_n <= 0 in compression"),
        ([*of("right"), "--stiffness", "1 2 3"], "--stiffness: stiffness has the shape (3,); give one number, "),
        (["test", "plesha"], "has its own flow direction"),
    ],
    ids=lambda x: x if isinstance(x, str) else "",
)
def test_what_cannot_be_asked_is_said(arguments: list[str], said: str, run: Command) -> None:
    code, out, err = run(*arguments)
    assert (code, out) == (2, "") and said in err and err.count("\n") == 1


@pytest.mark.parametrize(("text", "places"), [("0", [0]), ("7:10", [7, 8, 9]), ("1,3", [1, 3]), ("0,2:4", [0, 2, 3])])
def test_places_of_a_state_are_numbers_lists_and_ranges(text: str, places: list[int]) -> None:
    assert command._places(text, "--state") == places
    for wrong in ("", "a", "1:2:3:4", "1;2"):
        with pytest.raises(InputError, match="are no places"):
            command._places(wrong, "--state")


def test_one_number_is_a_stiffness(run: Command) -> None:
    code, out, _ = run(*of("right"), "--stiffness", "1e9", "--checks", "answers", "--examples", "1")
    assert code == 0 and "1 checks passed, 0 failed" in out
