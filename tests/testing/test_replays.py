"""A failure written as a test file fails with the bug and passes without, wherever its routine came from."""

from __future__ import annotations

import importlib
import runpy
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

import duhem
from duhem.expression import Norm
from duhem.law import registry
from duhem.law.shapes import Disk
from duhem.testing import Report, conformance, pointwise, projection
from tests.long import long_at, long_but, mostly_long
from tests.oracles.routines import DISK, nothing

WRONG = """
import functools

import numpy as np
from duhem.testing import Step

FACTOR = {factor}

def disk(trial, pressure, stiffness, mu):
    size, limit = np.hypot(*trial.T), -FACTOR * mu * pressure
    with np.errstate(all="ignore"):
        return np.where((size > limit)[:, None], trial / size[:, None] * limit[:, None], trial)

def one(trial, pressure, stiffness, mu):
    return disk(trial[None], np.array([pressure]), stiffness, mu)[0]

class Friction:
    @staticmethod
    def disk(trial, pressure, stiffness, mu):
        return disk(trial, pressure, stiffness, mu)

    def __call__(self, trial, pressure, stiffness, mu):
        return disk(trial, pressure, stiffness, mu)

friction = Friction()
half = functools.partial(disk, mu=0.5)
kept = []

def with_a_memory(trial, pressure, stiffness, mu):
    kept.append(1.0 if trial[0, 0] >= 0.0 else -1.0)  # of the first trial of all
    found = np.clip(trial, mu * pressure[:, None], -mu * pressure[:, None])
    return found if FACTOR == 1.0 else np.where(kept[0] * found < 0.0, 0.0, found)
"""


@pytest.fixture
def friction(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[float], object]]:
    """A module of the user's, with a bug where the factor is not 1; written anew it is imported anew."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def written(factor: float) -> object:
        (tmp_path / "my_friction.py").write_text(WRONG.format(factor=factor), "utf-8")
        sys.modules.pop("my_friction", None)
        importlib.invalidate_caches()
        return importlib.import_module("my_friction")

    yield written
    sys.modules.pop("my_friction", None)


ROUTINES = {
    "a function": lambda module: module.disk,
    "a method": lambda module: module.Friction.disk,
    "for one point": lambda module: pointwise(module.one),
    "a value of its module": lambda module: module.friction,
    "partly applied": lambda module: module.half,
}


def failing(update: Callable[..., object], **options: object) -> Report:
    report = conformance("coulomb", update, stiffness=1.0, checks=["feasibility"], max_examples=5, tries=20, **options)
    assert report.failed == {"feasibility"}
    return report


@pytest.mark.slow
@pytest.mark.parametrize("routine", long_but([1, 3, 4], ROUTINES))
def test_a_replay_fails_with_the_bug_and_passes_without(routine: str, friction: Callable[[float], object], tmp_path: Path) -> None:
    (file,) = failing(ROUTINES[routine](friction(2.0))).write_replays(tmp_path / "replays")
    assert file.name.startswith("test_my_friction_") and file.name.endswith("_feasibility.py")
    with pytest.raises(AssertionError, match="measured"):
        runpy.run_path(str(file))["test_feasibility"]()
    friction(1.0)
    runpy.run_path(str(file))["test_feasibility"]()


@pytest.mark.long
def test_what_shows_after_other_calls_alone_is_drawn_again(friction: Callable[[float], object], tmp_path: Path) -> None:
    box = duhem.Criterion("box", "max(abs(sigma_a), abs(sigma_b)) + mu*sigma_n", {"mu": duhem.Domain(positive=True)})
    asked = {"checks": ["variational-inequality", "repeatability"], "stiffness": 1.0, "max_examples": 5, "tries": 20, "seed": 3}
    report = conformance(box, friction(2.0).with_a_memory, **asked)
    assert report.failures[0].alone and "violation(" in report.failures[0].replay()
    file = report.write_replays(tmp_path / "replays")[0]
    for factor, wrong in ((2.0, True), (1.0, False)):
        friction(factor)
        (test,) = (value for name, value in runpy.run_path(str(file)).items() if name.startswith("test_"))
        with pytest.raises(AssertionError, match="box: ") if wrong else nullcontext():
            test()


def test_a_replay_moves_with_the_project(friction: Callable[[float], object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (file,) = failing(friction(2.0).disk).write_replays(tmp_path / "replays")
    moved = tmp_path / "elsewhere" / "replays" / file.name
    moved.parent.mkdir(parents=True)
    moved.write_text(file.read_text("utf-8"), "utf-8")
    (tmp_path / "elsewhere" / "my_friction.py").write_text(WRONG.format(factor=1.0), "utf-8")
    monkeypatch.setattr(sys, "path", [each for each in sys.path if each != str(tmp_path)])
    for place, wrong in ((moved, False), (file, True)):
        sys.modules.pop("my_friction", None)
        importlib.invalidate_caches()
        monkeypatch.setattr(sys, "path", [each for each in sys.path if not each.startswith(str(tmp_path))])
        with pytest.raises(AssertionError, match="measured") if wrong else nullcontext():
            runpy.run_path(str(place))["test_feasibility"]()


@pytest.mark.slow
@pytest.mark.parametrize("factor", mostly_long([2.0, 1.0]))
def test_a_replay_runs_as_it_stands(factor: float, friction: Callable[[float], object], tmp_path: Path) -> None:
    (file,) = failing(friction(2.0).disk).write_replays(tmp_path / "replays")
    friction(factor)
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", file.name], cwd=file.parent, timeout=120)
    assert done.returncode == (factor != 1.0)


def test_a_routine_without_a_name_has_a_stub_that_says_so(tmp_path: Path) -> None:
    (file,) = failing(lambda trial, pressure, stiffness, mu: trial).write_replays(tmp_path)
    with pytest.raises(AssertionError, match=r"<lambda> has no name that can be imported: call it here"):
        runpy.run_path(str(file))["test_feasibility"]()


@pytest.mark.slow
def test_a_law_made_in_python_is_written_out(tmp_path: Path) -> None:
    law = duhem.Criterion(
        name="my-disk", g="sqrt(a**2 + b**2) - r", forces=("a", "b"), pressure=None, parameters={"r": duhem.Domain(positive=True)}
    )
    (failure,) = conformance(law, lambda trial, pressure, stiffness, r: trial, checks=["feasibility"], max_examples=5, tries=20).failures
    text = failure.replay()
    assert "LAW = Criterion('my-disk', 'sqrt(a**2 + b**2) - r', {'r': Domain(positive=True)}, ('a', 'b'), None)" in text
    found = {}
    exec(text.replace("raise NotImplementedError", "return trial\n    raise NotImplementedError"), found)
    with pytest.raises(AssertionError, match="measured"):
        found["test_feasibility"]()


COULOMB = """[criterion]
name = "coulomb"
g = "norm(2*sigma_a, sigma_b) - mu*abs(sigma_n)"
[parameters]
mu = { positive = true }
"""


def ellipse_of_its_own(sigma_a, sigma_b, sigma_n, mu):
    """What the file says too: not the disk of that name."""
    return Norm(2 * sigma_a, sigma_b) - mu * abs(sigma_n)


@pytest.mark.slow
@pytest.mark.parametrize("kind", long_at([0, 3], ["a file", "a value", "fixed", "registered", "closed form"]))
def test_what_is_printed_takes_the_law_that_was_tested(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "own.toml").write_text(COULOMB, "utf-8")
    law = duhem.load(tmp_path / "own.toml")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(registry, "_registered", dict(registry.registered()))
    if kind == "registered":
        duhem.criterion(name="coulomb")(ellipse_of_its_own)
    given = {
        "a file": "own.toml",
        "a value": law,
        "fixed": law.fix({"mu": "3/10"}),
        "registered": "coulomb",
        "closed form": duhem.Criterion("coulomb", "norm(sigma_a, sigma_b) - mu*abs(sigma_n)/2", law.parameters, closed_form=Disk("mu/2")),
    }[kind]
    (failure,) = conformance(given, within_the_disk, DISK, checks=["feasibility"], stiffness=1.0, max_examples=5, tries=20).failures
    monkeypatch.undo()  # as in another process, in another folder
    lines = failure.reproducer()
    if kind == "closed form":
        assert "law = ...  # write the code that makes the law here" in lines
        with pytest.raises(duhem.InputError, match="ellipsis is no law"):
            exec(lines, {})
    else:
        exec(lines, {})
        assert capsys.readouterr().out.strip() == failure.message


def test_a_routine_made_in_a_test_is_told_by_what_makes_it() -> None:
    def upd(trial, pressure, stiffness):
        return trial

    (failure,) = conformance("coulomb", upd, DISK, checks="feasibility", stiffness=1.0, pressure=-1.0, max_examples=2, tries=0).failures
    maker = f"{__name__}.test_a_routine_made_in_a_test_is_told_by_what_makes_it"
    assert f"update = ...  # made by {maker}: write the code that makes it here" in failure.reproducer()


def within_the_disk(trial, pressure, stiffness):
    size, limit = np.hypot(*trial.T), -0.3 * pressure
    return trial * np.where(size > limit, limit / np.maximum(size, 1e-300), 1.0)[:, None]


def test_a_replay_has_no_marked_routine_that_pytest_would_collect(friction: Callable[[float], object], tmp_path: Path) -> None:
    routine = friction(2.0).disk
    routine.pytestmark = ["as the marker leaves it"]
    (file,) = failing(routine).write_replays(tmp_path / "replays")
    found = runpy.run_path(str(file))
    assert callable(found["test_feasibility"]) and not [name for name, value in found.items() if hasattr(value, "pytestmark")]


def test_duhems_own_routine_is_made_again() -> None:
    found: dict[str, object] = {}
    exec(projection(duhem.load("coulomb").fix({"mu": "0.3"}), "newton").__duhem_import__, found)
    assert found["update"](np.array([[1.0, 0.0]]), np.array([-1.0]), np.eye(2)).stress[0].tolist() == [0.3, 0.0]


@pytest.mark.slow
def test_a_law_of_a_file_is_read_from_it(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(
        '[criterion]\nname = "mine"\ng = "norm(sigma_a, sigma_b) + mu*sigma_n"\n[parameters]\nmu = { positive = true }\n', "utf-8"
    )
    (failure,) = conformance(file, nothing, DISK, checks=["feasibility"], max_examples=5, tries=20).failures
    assert f"LAW = {str(file)!r}" in failure.replay()
    assert "LAW = str((Path(__file__).parent / '../mine.toml').resolve())" in failure.replay(tmp_path / "replays")
    assert "from tests.oracles.routines import nothing as update" in failure.replay()
