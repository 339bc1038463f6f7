"""Scenes of many points: tables of what is a point's own, a table that grows, and runs that go on after they were stopped or killed."""

import os
import signal
import subprocess
import sys
from pathlib import Path as File

import numpy as np
import pytest
from click.testing import CliRunner

import duhem
from duhem import InputError, Paths
from duhem.cli import cli
from duhem.path import run as runs
from duhem.path import scene as scenes
from duhem.path import scene_file
from duhem.show.place import beside, rows_beside
from tests.long import long_but
from tests.path.scenes import TABLE, walk

MU = {"mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
SCENE = f"{walk(9, TABLE, **MU)}\n[output]\nkeep = 4\n"
POINTS = "scale,mu_a_plus,sigma_n,scale_b\n1,0.2,-1.0,2\n-1,0.1,-1.5,1\n0.5,0.2,-0.5,-1\n2,0.3,0.0,1\n1.5,0.2,-2,0.25\n"
OWN = "point,time,u_a,u_b,sigma_n\n7,0,0,0,-1\n7,1,0.5,0.1,-2\n3,0,0,0,-1\n3,1,-0.2,0.4,-1\n"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "points.csv").write_text(POINTS)
    (tmp_path / "own.csv").write_text(OWN)
    return tmp_path


def run(*arguments):
    return CliRunner().invoke(cli, ["simulate", *map(str, arguments)], standalone_mode=False)


def called():
    rows = np.array([[float(x) for x in line.split(",")] for line in POINTS.splitlines()[1:]])
    path = duhem.Path.random(seed=3, points=9, scale=0.3)
    by = np.stack([rows[:, 0], rows[:, 0] * rows[:, 3]], axis=1)
    mu = {**MU, "mu_a_plus": rows[:, 1]}
    return duhem.simulate("antoni2007", Paths.scaled(path, by, pressure=rows[:, 2:3]), stiffness=[1.0, 2.0], parameters=mu, keep=4)


def test_the_command_writes_what_the_call_gives(folder):
    called().to_csv(folder / "right.csv")
    assert run(folder / "scene.toml", "--out", folder / "h.csv").return_value == 0
    assert (folder / "h.csv").read_bytes() == (folder / "right.csv").read_bytes()
    assert run(folder / "scene.toml").stdout == (folder / "right.csv").read_text()
    assert sorted(place.name for place in folder.iterdir()) == ["h.csv", "own.csv", "points.csv", "right.csv", "scene.toml"]
    assert "not needed: pyarrow" in run(folder / "scene.toml", "--explain").stdout


def test_each_point_has_a_path_of_its_own_in_a_table(folder):
    head = SCENE.partition("[points]")[0].replace("[parameters]", "[parameters]\nmu_a_plus = 0.2")
    scene = scene_file.reads(f'{head}[path]\nkind = "table"\nfile = "own.csv"\npoint = "point"\n', folder=folder)
    assert np.array_equal(scene.path.values, [[[0, 0], [0.5, 0.1]], [[0, 0], [-0.2, 0.4]]])
    assert np.array_equal(scene.path.pressure, [[-1, -2], [-1, -1]])
    (folder / "more.csv").write_text("mu_a_plus,scale\n0.2,1\n0.3,2\n")
    both = f'{SCENE.partition("[points]")[0]}[points]\ntable = "more.csv"\n[path]\nkind = "table"\nfile = "own.csv"\npoint = "point"\n'
    scene = scene_file.reads(both, folder=folder)
    assert np.array_equal(scene.path.at(1), [[0.5, 0.1], [-0.4, 0.8]]) and scene.parameters["mu_a_plus"].tolist() == [0.2, 0.3]


@pytest.mark.parametrize("timed", [True, False])
def test_points_have_times_where_their_table_states_them(folder, timed):
    if not timed:
        (folder / "own.csv").write_text("".join(",".join(np.delete(row.split(","), 1)) + "\n" for row in OWN.splitlines()))
    (folder / "more.csv").write_text("mu_a_plus,scale\n0.2,1\n0.3,2\n")
    head = SCENE.partition("[points]")[0]
    own = '[path]\nkind = "table"\nfile = "own.csv"\npoint = "point"\n'
    for text in (head.replace("[parameters]", "[parameters]\nmu_a_plus = 0.2") + own, f'{head}[points]\ntable = "more.csv"\n{own}'):
        assert scene_file.reads(text, folder=folder).path.timed is timed


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("scale_b", "scale_c", "unknown column 'scale_c'"),
        ("0.1,-1.5", "-0.1,-1.5", "mu_a_plus"),
        ("-0.5,-1", "0.5,-1", "pressure[2, 0] is 0.5 > 0"),
        ("mu_a_plus", "mu_a_minus", "given twice"),
        ("-2,0.25", "-2", "is not 4 numbers"),
        (POINTS.partition("\n")[2], "", "fewer than one row"),
    ],
)
def test_what_is_wrong_in_the_table_of_points_is_said(folder, old, new, words):
    (folder / "points.csv").write_text(POINTS.replace(old, new, 1))
    with pytest.raises(scene_file.SceneFaults) as caught:
        scene_file.read(folder / "scene.toml")
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (OWN.replace("7,1,", "8,1,"), "the points do not have the same number"),
        (OWN.replace("3,1,-0.2", "3,2,-0.2"), "different times"),
        (OWN.replace("point,", "number,"), "no column point"),
        (OWN + "7,2,1,1,-1\n3,2,1,1,-1\n", "the points do not have the same number"),
    ],
)
def test_what_is_wrong_in_a_table_of_paths_is_said(folder, table, words):
    (folder / "own.csv").write_text(table)
    scene = SCENE.partition("[points]")[0] + '[path]\nkind = "table"\nfile = "own.csv"\npoint = "point"\n'
    with pytest.raises(scene_file.SceneFaults) as caught:
        scene_file.reads(scene, folder=folder)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    "line",
    [
        *("keep = 0", "keep = -1", 'keep = ""', "keep = 1.5"),
        *("checkpoint = 0", "checkpoint = nan", "checkpoint = true"),
        *('compiled = "yes"', "threads = true", "threads = -2"),
    ],
)
def test_options_of_the_wrong_kind_are_said_at_their_line(folder, line):
    section = "method" if line.startswith(("compiled", "threads")) else "output"
    text = SCENE.replace("[output]\nkeep = 4\n", f"[{section}]\n{line}\n")
    with pytest.raises(scene_file.SceneFaults) as caught:
        scene_file.reads(text, where="s.toml", folder=folder)
    assert f"s.toml:{len(text.splitlines())}:" in str(caught.value)


def test_a_picture_is_of_one_point(folder):
    assert "one point" in str(run(folder / "scene.toml", "--plot", folder / "p.png").exception)


# -- stopped, killed, gone on with -------------------------------------------------------------------------------------


class Killed(BaseException):
    """What ends a run without a word, as SIGKILL does."""


@pytest.mark.parametrize("fault", [KeyboardInterrupt, Killed])
def test_a_run_goes_on_from_the_points_that_are_done(folder, monkeypatch, fault):
    monkeypatch.setattr(runs, "_POINTS", 2)
    assert run(folder / "scene.toml", "--out", folder / "whole.csv").return_value == 0
    table, add = folder / "h.csv", scenes.GrowingTable.add
    with monkeypatch.context() as patch:

        def stop(self, part):
            if self.points == 2:
                self.write("half a row, and then")
                raise fault
            add(self, part)

        patch.setattr(scenes.GrowingTable, "add", stop)
        if fault is Killed:
            with pytest.raises(Killed):
                CliRunner().invoke(cli, ["simulate", str(folder / "scene.toml"), "--out", str(table)], standalone_mode=False)
        else:
            stopped = run(folder / "scene.toml", "--out", table)
            assert stopped.return_value == 130 and "2 of 5 points" in stopped.stderr and "--resume" in stopped.stderr
    assert not table.exists()
    begun = []
    monkeypatch.setattr(scenes.GrowingTable, "add", lambda self, part: (begun.append(self.points), add(self, part)))
    other = folder / "other.toml"
    other.write_text(SCENE.replace("0.08", "0.09"))
    assert "another run" in str(run(other, "--out", table, "--resume").exception)
    assert run(folder / "scene.toml", "--out", table, "--resume").return_value == 0
    assert begun == [2, 4] and table.read_bytes() == (folder / "whole.csv").read_bytes()
    assert not list(folder.glob("h.csv.partial*"))


def test_notes_and_rows_cut_short_are_refused_or_gone_on_with_to_the_same_bytes(folder, monkeypatch):
    """Wherever the last write ended: a torn note counts as none, and rows behind the last note are cut off."""
    monkeypatch.setattr(runs, "_POINTS", 2)
    scene, table = scene_file.read(folder / "scene.toml"), folder / "h.csv"
    assert run(folder / "scene.toml", "--out", folder / "whole.csv").return_value == 0
    with monkeypatch.context() as patch:
        patch.setattr(scenes.GrowingTable, "finish", lambda self: (_ for _ in ()).throw(KeyboardInterrupt))
        run(folder / "scene.toml", "--out", table)
    notes, rows = beside(table).read_bytes(), rows_beside(table).read_bytes()
    wanted = ("point", "time")
    ends = [i + shift for i, byte in enumerate(notes) if byte == ord("\n") for shift in (0, 1)]
    for length in sorted({*range(0, len(notes), 11), *ends}):
        beside(table).write_bytes(notes[:length])
        rows_beside(table).write_bytes(rows + b"torn")
        with scenes.GrowingTable(table, scene.fingerprint, wanted, True) as growing:
            whole = notes[:length].count(b"\n") - 1
            assert growing.points == (0 if whole < 1 else [2, 4, 5][whole - 1])
    beside(table).write_bytes(notes)
    rows_beside(table).write_bytes(rows[:-1])
    with pytest.raises(InputError, match="damaged"):
        scenes.GrowingTable(table, scene.fingerprint, wanted, True)
    rows_beside(table).write_bytes(rows.replace(b"1", b"2", 1))
    assert "damaged" in str(run(folder / "scene.toml", "--out", table, "--resume").exception)
    rows_beside(table).unlink()
    assert run(folder / "scene.toml", "--out", table, "--resume").return_value == 0
    assert table.read_bytes() == (folder / "whole.csv").read_bytes()
    rows_beside(table).write_bytes(b"somebody's")
    assert "does not belong to duhem" in str(run(folder / "scene.toml", "--out", table).exception)
    assert rows_beside(table).read_bytes() == b"somebody's"


def test_points_that_end_early_are_counted_also_by_a_run_that_goes_on(folder, monkeypatch):
    monkeypatch.setattr(runs, "_POINTS", 1)
    (folder / "points.csv").write_text(POINTS.replace("2,0.3,0.0,1", "1e308,0.3,-1.0,1").replace("-1,0.1", "1e308,0.1"))
    table, add = folder / "h.csv", scenes.GrowingTable.add

    def stop(self, part):
        if self.points == 3:
            raise KeyboardInterrupt
        add(self, part)

    with monkeypatch.context() as patch:
        patch.setattr(scenes.GrowingTable, "add", stop)
        assert run(folder / "scene.toml", "--out", table).return_value == 130
    ended = run(folder / "scene.toml", "--out", table, "--resume")
    assert ended.return_value == 4 and "2 points end early" in ended.stderr
    assert len([line for line in table.read_text().splitlines() if line.startswith("1,")]) < 4


def test_one_point_is_kept_at_intervals_too(folder, monkeypatch):
    one = (
        SCENE.replace('[points]\ntable = "points.csv"\n', "")
        .replace("keep = 4", "checkpoint = 1e-9")
        .replace("scale = 0.3", "scale = 0.3\npressure = -1")
    )
    (folder / "one.toml").write_text(one.replace("[parameters]", "[parameters]\nmu_a_plus = 0.2"))
    kept = []
    keep = scenes.keep
    monkeypatch.setattr(scenes, "keep", lambda history, *rest: (kept.append(len(history)), keep(history, *rest))[1])
    assert run(folder / "one.toml", "--out", folder / "h.csv").return_value == 0
    assert kept and kept == sorted(kept) and kept[-1] < 10 and not beside(folder / "h.csv").exists()


@pytest.mark.slow
@pytest.mark.parametrize("sent", long_but([0], [signal.SIGTERM, signal.SIGINT]))
def test_a_signal_ends_a_process_as_ctrl_c_does(folder, sent):
    """It is stopped at its first step, by itself; the campaign `killed` does so from outside, at moments of chance."""
    code = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # what a shell starts beside itself ignores it
        "import os, sys; from duhem.path.simulate import parts; from duhem.__main__ import main\n"
        "def first(*a, **k):\n"
        "    for part in parts(*a, **k):\n"
        f"        yield part; os.kill(os.getpid(), {int(sent)})\n"
        "from duhem.path import scene, run; run._POINTS = 2; scene.parts = first\n"
        "sys.argv = ['duhem', 'simulate', 'scene.toml', '--out', 'h.csv']; sys.exit(main())"
    )
    environment = os.environ | {"PYTHONPATH": str(File(duhem.__file__).parents[1])}
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=folder, env=environment, check=False)
    assert ran.returncode == 130 and "2 of 5 points" in ran.stderr


@pytest.mark.slow
def test_a_parquet_table_holds_the_same_numbers(folder, monkeypatch):
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr(scenes, "_LINES", 3)
    assert run(folder / "scene.toml", "--out", folder / "h.parquet").return_value == 0
    read = parquet.read_table(folder / "h.parquet")
    right = called()
    assert tuple(read.column_names) == right.columns() and not list(folder.glob("*.partial*"))
    assert np.array_equal(np.column_stack([column.to_numpy() for column in read.columns]), right.to_array())
