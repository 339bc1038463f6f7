"""Whether convexity is shown is read by the next process, which then loads nothing that proves."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import duhem
from duhem.api import convexity
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Convexity
from duhem.proof import verification

ROUND = Criterion("round", "norm(a, b) - k", {"k": Domain(positive=True)}, forces=("a", "b"), pressure=None)
BENT = replace(ROUND, name="bent", g="a**4 + b**4 - 3*a**2*b**2 - k", written="")


def answer(law: Criterion, steps: int = convexity._STEPS - convexity._STEPS // 3) -> str:
    """As a process gives it that has asked nothing yet."""
    found: str = convexity._verdict.__wrapped__(law, steps)
    return found


def unasked(*_: Any, **__: Any) -> Any:
    raise AssertionError("what is kept was not read")


@pytest.mark.parametrize(("law", "verdict"), [(ROUND, "proved"), (BENT, "refuted")])
def test_what_stands_is_kept_and_read(law: Criterion, verdict: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("DUHEM_CACHE_DIR", str(tmp_path))
    assert answer(law) == verdict
    monkeypatch.setattr(verification, "verdict_within", unasked)
    assert answer(law) == verdict
    assert answer(replace(law, domain={"a": Domain.between(-1, 1)})) == verdict  # the ranges of forces are not asked about
    with pytest.raises(AssertionError, match="not read"):
        answer(law.within({"k": Domain.fixed(2)}))


def test_what_is_open_is_kept_under_its_steps(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("DUHEM_CACHE_DIR", str(tmp_path))
    assert answer(ROUND, steps=100) == "open"
    with monkeypatch.context() as second:
        second.setattr(verification, "verdict_within", unasked)
        assert answer(ROUND, steps=100) == "open"
    assert answer(ROUND) == "proved"


def test_the_older_ones_make_room(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(convexity, "_MOST", 4)
    for k in range(5):
        convexity.keep(tmp_path / f"{k}", "proved")
        os.utime(tmp_path / f"{k}", ns=(k, k)) if k < 4 else None
    assert sorted(path.name for path in tmp_path.iterdir()) == ["2", "3", "4"]


def test_what_is_damaged_or_of_another_law_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "one"
    convexity.keep(path, "proved")
    whole = path.read_text()
    assert convexity.recalled(path) == "proved"
    path.rename(tmp_path / "another")
    assert convexity.recalled(path) is None is convexity.recalled(tmp_path / "another")
    for changed in ("", "proved", whole[:-1], whole.replace("proved", "refuted"), whole + "\n"):
        path.write_text(changed)
        assert convexity.recalled(path) is None
    path.write_bytes(b"\xff" + whole.encode())
    assert convexity.recalled(path) is None


def test_every_part_of_a_law_tells_it_apart() -> None:
    laws = [
        ROUND,
        replace(ROUND, name="other"),
        replace(ROUND, g="norm(a, b) - 2*k", written=""),
        replace(ROUND, written="sqrt(a**2 + b**2) - k"),
        replace(ROUND, parameters={"k": Domain.between(1)}),
        replace(ROUND, parameters={"k": Domain.between("1.0000000000000000000001")}),
        replace(ROUND, parameters={"k": Domain(positive=True), "l": Domain()}),
        replace(ROUND, constraints=("k < 3",)),
        replace(ROUND, flow=("a", "b")),
        replace(ROUND, potential="a**2 + b**2"),
        replace(ROUND, domain={"a": Domain.between(-1, 1)}),
        replace(ROUND, define={"size": "a + b"}),
        duhem.load("von-mises"),
        duhem.load("coulomb"),
    ]
    places = [convexity.place(law, "convexity quick") for law in laws]
    assert None not in places and len(set(places)) == len(laws)
    assert convexity.place(ROUND, "convexity full") not in places
    again = Criterion("round", "norm(a, b) - k", {"k": Domain(positive=True)}, forces=("a", "b"), pressure=None)
    assert convexity.place(again, "convexity quick") == places[0]


def test_another_text_of_duhem_or_another_solver_asks_anew(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    made_with = convexity._made_with()
    files = [line.split(" ")[0] for line in made_with]
    assert {verification.__file__, convexity.__file__, __import__("flint").__file__} <= set(files)
    before = convexity.place(ROUND, "convexity")
    path = tmp_path / "prover.py"
    path.write_text("one")
    os.utime(path, ns=(1, 1))
    seen = {convexity._file(path)}
    os.utime(path, ns=(1, 2))
    seen.add(convexity._file(path))
    path.write_text("three")
    os.utime(path, ns=(1, 2))
    assert len({*seen, convexity._file(path)}) == 3
    monkeypatch.setattr(convexity, "_made_with", lambda: (*made_with[:-1], "newer"))
    assert convexity.place(ROUND, "convexity") != before


def test_a_law_that_cannot_be_told_or_a_folder_that_cannot_be_written_is_asked_about_all_the_same(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    law = replace(ROUND)
    object.__setattr__(law, "source", 1.5)
    assert convexity.place(law, "convexity") is None
    assert answer(law) == "proved"
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("DUHEM_CACHE_DIR", str(tmp_path / "file"))
    assert answer(ROUND) == "proved"


SECOND = """
import sys
import duhem
from duhem.api.convexity import asked
print(asked(duhem.load("von-mises"), {"yield_stress": 0.3}, "require", unloaded=False))
assert not [name for name in sys.modules if name.startswith("duhem.proof")], "a prover"
"""


@pytest.mark.slow
def test_a_second_process_loads_no_prover(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("DUHEM_CACHE_DIR", str(tmp_path))
    assert answer(duhem.load("von-mises")) == "proved"
    done = subprocess.run([sys.executable, "-c", SECOND], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == repr(Convexity(loaded=True, unloaded=False))


INCREMENT = """
import sys
import numpy as np
import duhem
trial = np.random.default_rng(0).normal(size=(6000, 3))
done = duhem.project("von-mises", trial, None, parameters={"yield_stress": 0.3}, compiled=True, threads=int(sys.argv[1]))
for array in (done.stress, done.slip, done.multiplier, done.dissipation, done.status):
    sys.stdout.buffer.write(array.tobytes())
print(sorted(name for name in sys.modules if name == "numba" or name.startswith("duhem.proof.")), file=sys.stderr)
"""


@pytest.mark.long
def test_a_second_process_computes_the_same_with_neither_numba_nor_prover(tmp_path: Path) -> None:
    pytest.importorskip("numba")
    environment = {**os.environ, "DUHEM_CACHE_DIR": str(tmp_path)}
    done = [
        subprocess.run([sys.executable, "-c", INCREMENT, threads], capture_output=True, env=environment, check=True) for threads in "121"
    ]
    assert b"numba" in done[0].stderr and b"duhem.proof.verification" in done[0].stderr
    assert len(done[0].stdout) > 6000 * 8 * 8
    assert done[2].stdout == done[1].stdout == done[0].stdout
    assert done[2].stderr.strip() == b"[]"
