"""Snapshots: what is kept of a law, which changes are told and how, and the file and the command that keep them."""

from __future__ import annotations

import json
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.errors import InputError
from duhem.testing.snapshots import Entry, SnapshotFile, differences, snapshot

OVAL = """\
[criterion]
name = "oval"
g = "norm(sigma_a, sigma_b)**2 - mu*abs(sigma_n)*(norm(sigma_a, sigma_b) + e*sigma_a)"
[parameters]
mu = { positive = true }
e = { min = 0, max = GREATEST }
"""


@pytest.fixture(scope="module")
def kept() -> Entry:
    return snapshot("coulomb", duhem.project)


def changed(kept: Entry, change: Callable[[Entry], Any]) -> tuple[str, ...]:
    now = deepcopy(kept)
    change(now)
    return differences(kept, now)


def test_what_is_kept_of_a_law(kept: Entry) -> None:
    assert list(kept["claims"]) == ["origin", "convexity", "smoothness", "normality", "dissipation", "duality", "state_laws"]
    assert kept["claims"]["convexity"]["verdict"] == "proved" and kept["claims"]["convexity"]["trust"] == "checked"
    assert [each["status"] for each in kept["increments"]] == ["stick", *["slip"] * 6]
    for each in kept["increments"]:  # Moreau's conditions by hand: the disk of radius mu, k = diag(1, 2)
        trial, stress, slip = (np.array(list(each[part].values())) for part in ("trial", "stress", "slip"))
        assert each["pressure"] == -1.0 and each["stiffness"] == {"sigma_a": 1.0, "sigma_b": 2.0}
        assert stress + np.array([1.0, 2.0]) * slip == pytest.approx(trial, rel=1e-12)
        if each["status"] == "slip":
            assert np.hypot(*stress) == pytest.approx(0.5, rel=1e-12)
            assert slip[0] * stress[1] == pytest.approx(slip[1] * stress[0], abs=1e-12)


def test_asked_again_nothing_has_changed(kept: Entry) -> None:
    again = snapshot("coulomb", duhem.project, increments=kept["increments"])
    assert differences(kept, json.loads(json.dumps(again))) == ()


def test_a_moved_stress_is_told_beyond_the_tolerance(kept: Entry) -> None:
    def move(share: float) -> Callable[[Entry], Any]:
        def change(now: Entry) -> None:
            for force, value in now["increments"][2]["stress"].items():
                now["increments"][2]["stress"][force] = value * (1.0 + share)

        return change

    assert changed(kept, move(5e-10)) == ()
    (line,) = changed(kept, move(2e-3))
    assert line.startswith("increment 3: stress moved by 0.002 of its size, from (")
    (line,) = changed(kept, move(float("inf")))
    assert "increment 3: stress moved and is not finite" in line


CHANGES: dict[str, tuple[Callable[[Entry], Any], str]] = {
    "method": (lambda e: e["claims"]["convexity"].update(method="sampling"), "convexity: method composition → sampling"),
    "trust": (lambda e: e["claims"]["origin"].update(trust="prover"), "origin: trust checked → prover"),
    "scope": (lambda e: e["claims"]["origin"].update(scope="mu = 1"), "origin: scope all parameters → mu = 1"),
    "lost": (lambda e: e["claims"].pop("duality"), "duality: stored, but not examined now"),
    "undecided": (lambda e: e["claims"]["convexity"].update(verdict="undecided"), "convexity: proved → undecided"),
    "domain": (lambda e: e["law"]["parameters"]["mu"].update(max="2"), "parameters mu max: none → 2"),
    "formula": (lambda e: e["law"].update(g="sigma_a"), "→ sigma_a"),
    "status": (lambda e: e["increments"][0].update(status="failed"), "increment 1: status stick → failed"),
    "fewer": (lambda e: e["increments"].pop(), "increments: 7 → 6"),
    "none": (lambda e: e.update(left_out={"increments": "why"}), "increments omitted: none → why"),
    "slip": (lambda e: e["increments"][1]["slip"].update(sigma_a=0.0), "increment 2: slip moved by"),
}


def test_forces_that_stand_in_no_order_of_the_alphabet_are_compared_by_name(tmp_path: Path) -> None:
    law = duhem.Criterion(name="turned", g="norm(z/2, a) - 1", forces=("z", "a"), pressure=None)
    file, taken = str(tmp_path / "kept.json"), snapshot(law, duhem.project, claims="origin")
    SnapshotFile({"turned": taken}).write(file)
    read = SnapshotFile.read(file).entry("turned", file)
    assert differences(read, snapshot(law, duhem.project, claims="origin", increments=read["increments"])) == ()
    read["increments"][1]["stress"] = dict(zip("za", [read["increments"][1]["stress"][f] for f in "az"], strict=True))
    assert [line[:11] for line in differences(read, taken)] == ["increment 2"]


def test_what_was_not_solved_may_move(kept: Entry) -> None:
    before = deepcopy(kept)
    before["increments"][1]["status"] = "inaccurate"
    assert changed(before, lambda e: e["increments"][1]["slip"].update(sigma_a=0.0)) == ()


@pytest.mark.parametrize("change", CHANGES)
def test_each_change_is_told(kept: Entry, change: str) -> None:
    make, said = CHANGES[change]
    found = changed(kept, make)
    assert len(found) == 1 and said in found[0]


def test_what_is_kept_of_fewer_claims_says_so(kept: Entry, tmp_path: Path) -> None:
    few = deepcopy(kept)
    few["claims"] = {"origin": kept["claims"]["origin"]}
    others = [name for name in kept["claims"] if name != "origin"]
    assert differences(few, kept) == tuple(f"{name}: not stored, now {kept['claims'][name]['verdict']}" for name in others)
    named = SnapshotFile({"coulomb, claims origin": few, "box": kept})
    with pytest.raises(InputError, match=r"there is no snapshot of coulomb, only of coulomb, claims origin; write it"):
        named.entry("coulomb", tmp_path / "kept.json")


def test_a_law_that_is_no_more_convex_and_a_witness_that_moves(tmp_path: Path) -> None:
    entries = []
    for greatest in ("0.6", "0.8"):
        (tmp_path / "oval.toml").write_text(OVAL.replace("GREATEST", greatest), "utf-8")
        entries.append(snapshot(tmp_path / "oval.toml", duhem.project, claims="convexity", increments=[]))
    lines = differences(*entries)
    assert lines[0] == "parameters e max: 3/5 → 4/5"
    assert [line for line in lines if line.startswith("convexity: witness: parameters e: ")]
    before = deepcopy(entries[1])
    before["claims"]["convexity"] = {"verdict": "proved", "method": "composition", "trust": "checked", "scope": "all parameters"}
    (line,) = differences(before, entries[1])
    assert line.startswith("convexity: proved → refuted at mu = 1, e = ") and "is not" in line


def test_laws_without_increments_say_why() -> None:
    assert "its own flow direction" in snapshot("plesha", duhem.project, claims="origin")["left_out"]["increments"]
    other = [{"parameters": {}, "pressure": None, "trial": {"x": 1.0}, "stiffness": {"x": 1.0}}]
    assert "have other forces" in snapshot("coulomb", duhem.project, claims="origin", increments=other)["left_out"]["increments"]


def test_the_file_is_read_as_it_was_written(kept: Entry, tmp_path: Path) -> None:
    file = tmp_path / "kept.json"
    SnapshotFile({"coulomb": kept}, 1e-6).write(file)
    assert SnapshotFile.read(file) == SnapshotFile(json.loads(json.dumps({"coulomb": kept})), 1e-6)
    assert max(map(len, file.read_text("utf-8").splitlines())) < 100  # a value a line


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"laws": {"x": {}}, "tolerance": 1e-9}', '{"laws": {}, "tolerance": "none"}', "[" * 99999]
)
def test_what_is_no_snapshot_is_one_error(tmp_path: Path, text: str) -> None:
    (tmp_path / "kept.json").write_text(text, "utf-8")
    with pytest.raises(InputError, match="this is no snapshot; write it with --update"):
        SnapshotFile.read(tmp_path / "kept.json")


@pytest.mark.slow
def test_the_command_keeps_compares_and_tells(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run: Callable[..., tuple[int, str, str]]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("snapshot", "coulomb") == (2, "", "duhem: duhem-snapshot.json: there is no such file; write it with --update\n")
    assert run("snapshot", "coulomb", "--update") == (0, "coulomb: not kept before\nwrote duhem-snapshot.json\n", "")
    assert run("snapshot", "coulomb") == (0, "coulomb: as kept\n", "")
    code, _, said = run("snapshot", "coulomb", "orthotropic")
    assert code == 2 and "there is no snapshot of orthotropic; write it with --update" in said
    before = Path("duhem-snapshot.json").read_text("utf-8")
    Path("duhem-snapshot.json").write_text(before.replace('"proved"', '"undecided"', 1), "utf-8")
    code, said, _ = run("snapshot", "coulomb")
    assert code == 1 and said == "coulomb: convexity: undecided → proved\n"
    assert run("snapshot", "coulomb", "--update")[0] == 0
    assert Path("duhem-snapshot.json").read_text("utf-8") == before
    assert run("snapshot", "no-such-law")[0] == 2
