"""Commands and files: nothing that is read is written over, a document imports nothing, a failed write is told as what it is."""

import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

Run = Callable[..., tuple[int, str, str]]
ACTS = "open('ran', 'w').close()\n"
SCENE = """\
law = "coulomb"
stiffness = 1.0
[parameters]
mu = 0.3
[path]
kind = "linear"
points = [[0, 0], [1, 1]]
pressure = -1.0
"""
TABLE = SCENE[: SCENE.index("kind")] + 'kind = "table"\nfile = "t.csv"\n'
LAW = '[criterion]\nname = "x"\ng = "norm(sigma_a, sigma_b) + mu*sigma_n"\n[parameters]\nmu = { positive = true }\n'
POINTS = "sigma_a,sigma_b,sigma_n\n0.3,0,-1\n0,0.3,-1\n-0.3,0,-1\n"
FILES = {"s.csv": SCENE, "s.toml": TABLE, "t.csv": "u_a,u_b,sigma_n\n0,0,-1\n1,1,-1\n", "p.csv": POINTS, "l.toml": LAW}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, content in FILES.items():
        (tmp_path / name).write_text(content)
    (tmp_path / "sub").mkdir()
    (tmp_path / "own.toml").write_text(SCENE.replace('"coulomb"', '"l.toml"'))
    return tmp_path


@pytest.mark.parametrize(
    "arguments",
    [
        ("simulate", "s.csv", "--out", "s.csv"),
        ("simulate", "s.toml", "--out", "sub/../t.csv"),
        ("identify", "p.csv", "--law", "coulomb", "--out", "./p.csv"),
        ("identify", "p.csv", "--law", "l.toml", "--out", "l.toml"),
        ("verify", "l.toml", "--claims", "origin", "--certificate", "l.toml"),
        ("stress", "l.toml", "--set", "mu=0.3", "--axis", "load", "--json", "l.toml"),
        ("bench", "l.toml", "--set", "mu=0.3", "--json", "l.toml"),
    ],
    ids=" ".join,
)
def test_nothing_that_is_read_is_written_over(run: Run, folder: Path, arguments) -> None:
    code, out, message = run(*arguments)
    assert (code, out) == (2, "") and "would be overwritten" in message
    assert {name: (folder / name).read_text() for name in FILES} == FILES


@pytest.mark.parametrize(("option", "said"), [("--out", "end its name in .csv or .parquet"), ("--plot", "no file is named; name one")])
def test_a_result_without_a_name_is_not_left_out(run: Run, folder: Path, option: str, said: str) -> None:
    """As a variable of the shell gives it that is not set."""
    code, out, message = run("simulate", "own.toml", option, "")
    assert (code, out) == (2, "") and message.startswith("duhem: ") and said in message


def test_what_a_part_would_be_kept_in_is_no_other_file(run: Run, folder: Path) -> None:
    (folder / "h.csv.partial").write_text("mine")
    code, _, message = run("simulate", "own.toml", "--out", "h.csv")
    assert code == 2 and "does not belong to duhem" in message and (folder / "h.csv.partial").read_text() == "mine"
    (folder / "l.toml").rename("h.csv.partial")
    (folder / "own.toml").write_text(SCENE.replace('"coulomb"', '"h.csv.partial"'))
    code, _, message = run("simulate", "own.toml", "--out", "h.csv")
    assert code == 2 and "would be overwritten" in message and (folder / "h.csv.partial").read_text() == LAW


@pytest.mark.parametrize("law", ["acts:law", "acts:law.toml", "./acts:law", "os:path", "acts.py:law", " acts:law "])
def test_a_scene_imports_no_code(run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch, law: str) -> None:
    (folder / "acts.py").write_text(ACTS)
    monkeypatch.syspath_prepend(str(folder))
    (folder / "s.toml").write_text(SCENE.replace('"coulomb"', f'"{law}"'))
    code, _, message = run("simulate", "s.toml")
    assert code == 2 and ("would import code" in message or "there is no such file" in message)
    assert "acts" not in sys.modules and not (folder / "ran").exists()


@pytest.mark.parametrize("named", ["x" * 5000, "x" * 5000 + ".toml", "\\u0000", "\\u0000.toml"])
def test_a_name_that_no_file_can_have(run: Run, folder: Path, named: str) -> None:
    (folder / "s.toml").write_text(SCENE.replace('"coulomb"', f'"{named}"'))
    assert run("simulate", "s.toml")[0] == 2
    (folder / "s.toml").write_text(TABLE.replace("t.csv", named))
    assert run("simulate", "s.toml")[0] == 2
    (folder / "s.toml").write_text(f'{SCENE}[output]\ntable = "{named}.csv"\n')
    assert run("simulate", "s.toml")[0] == 2


def test_a_criterion_file_with_a_colon_in_its_name_is_a_file(run: Run, folder: Path) -> None:
    (folder / "a:b.toml").write_text(LAW)
    (folder / "s.toml").write_text(SCENE.replace('"coulomb"', '"a:b.toml"'))
    assert run("simulate", "s.toml")[0] == 0
    assert run("verify", "a:b.toml", "--claims", "origin")[0] == 0


def test_a_module_beside_the_user_comes_after_all_that_is_installed(run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", [entry for entry in sys.path if entry not in ("", os.getcwd())])
    monkeypatch.delitem(sys.modules, "colorsys", raising=False)
    (folder / "colorsys.py").write_text(ACTS)
    before = list(sys.path)
    code, _, message = run("verify", "colorsys:law")
    assert code == 2 and "no attribute 'law'" in message and not (folder / "ran").exists()
    (folder / "beside_the_user.py").write_text(ACTS)
    code, _, message = run("verify", "beside_the_user:law")
    assert code == 2 and (folder / "ran").exists() and sys.path == before
    sys.modules.pop("beside_the_user")


@pytest.mark.parametrize("named", ["pipe", "/dev/zero"])
def test_a_scene_reads_files_alone(run: Run, folder: Path, named: str) -> None:
    os.mkfifo("pipe")
    (folder / "s.toml").write_text(TABLE.replace("t.csv", named))
    code, _, message = run("simulate", "s.toml")
    assert code == 2 and "a device or a pipe" in message


def test_a_result_goes_into_no_device(run: Run, folder: Path) -> None:
    code, _, message = run("verify", "coulomb", "--claims", "origin", "--certificate", "/dev/null")
    assert code == 2 and "a device or a pipe" in message
    assert not os.path.isfile("/dev/null")


def test_a_message_is_no_longer_than_one_can_read(run: Run) -> None:
    code, _, message = run("verify", "coulomb", "--set", "mu=" + "x" * 90_000)
    assert code == 2 and len(message) < 5_000 and message.startswith("duhem: --set mu=xxx")
    assert message.endswith("write a finite number such as 0.15, 1e-6 or 1/2\n")
