"""Scene files, what they leave out, and the command that runs them."""

import os
import subprocess
import sys
from dataclasses import replace
from functools import partial
from importlib import import_module
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import duhem
from duhem import InputError
from duhem.cli import cli
from duhem.path import scene as scenes
from duhem.path import scene_file
from duhem.path.integrators import INTEGRATORS
from duhem.show.place import beside
from tests.path.scenes import walk

LINE = """\
law = "antoni2007-1d"
stiffness = 2.0

[parameters]
mu_plus = 0.33
mu_minus = 0.29

[path]
kind = "cycle"
amplitude = 1.0
cycles = 2
pressure = -1.0

[method]
substeps = 50
"""

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
PLANE = f'{walk(40, **MU)}pressure = -1.0\n\n[method]\nintegrator = "exact"\n'


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "line.toml").write_text(LINE)
    (tmp_path / "plane.toml").write_text(PLANE)
    return tmp_path


def run(*arguments):
    return CliRunner().invoke(cli, ["simulate", *map(str, arguments)], standalone_mode=False)


def test_a_scene_is_the_call_it_stands_for():
    path = duhem.Path.random(seed=3, points=40, scale=0.3, pressure=-1.0)
    called = duhem.simulate("antoni2007", path, stiffness=[1.0, 2.0], parameters=MU, method="exact")
    assert np.array_equal(scene_file.reads(PLANE).run().to_array(), called.to_array())


@pytest.mark.parametrize(
    "path",
    [
        'kind = "linear"\npoints = [[0, 0], [1, 1]]\npressure = [-1.0, -2.0]',
        'kind = "cycle"\namplitude = [1, 0.5]\npressure = -1',
        'kind = "circle"\nradius = 0.5\npoints = 12\nturns = 2.0\npressure = -1.0',
        'kind = "table"\nfile = "t.csv"',
        'kind = "linear"\npoints = [[0, 0], [0.05, 0.05]]\ncontrol = "stress"\npressure = -1',
    ],
)
def test_every_kind_of_path(tmp_path, path):
    (tmp_path / "t.csv").write_text("time,u_a,u_b,sigma_n\n0,0,0,-1\n1,1,0.5,-2\n")
    head, _, _ = PLANE.partition("[path]")
    history = scene_file.reads(f"{head}[path]\n{path}\n", folder=tmp_path).run()
    assert len(history) >= 2 and np.isfinite(history.to_array()).all()


def test_every_mistake_is_listed_at_once_with_its_place_and_a_suggestion():
    text = """\
law = "antoni207"
stifness = 1.0
[path]
kind = "circel"
[method]
integrator = "exakt"
substeps = 0
[output]
table = "h.xls"
"""
    with pytest.raises(scene_file.SceneFaults) as caught:
        scene_file.reads(text, where="s.toml")
    found = [str(fault) for fault in caught.value.faults]
    for place, word in [
        ("s.toml:1:1", "did you mean antoni2007"),
        ("s.toml:2:1", "did you mean 'stiffness'"),
        ("s.toml:4:1", "did you mean 'circle'"),
        ("s.toml:3:1", "a circle path needs radius"),
        ("s.toml:6:1", "did you mean 'exact'"),
        ("s.toml:7:1", "substeps"),
        ("s.toml:9:1", ".csv"),
        ("s.toml", "no stiffness"),
    ]:
        assert any(text.startswith(place) and word in text for text in found), (place, word, found)
    assert len(found) == 8


WHOLE = """\
law = "antoni2007"
stiffness = [1.0, 2.0]
stress = [0.01, 0.0]
[parameters]
mu_a_plus = 0.2
mu_a_minus = 0.08
mu_b_plus = 0.12
mu_b_minus = 0.15
[method]
integrator = "exact"
substeps = 2
[output]
keep = 1
[path]
"""
OF_ALL = [
    ("stiffness = [1.0, 2.0]", "stiffness = [1.0, -2.0]"),
    ("stress = [0.01, 0.0]", "stress = [9.0, 0.0]"),
    ("mu_a_plus = 0.2", "mu_a_plus = -0.2"),
    ("mu_b_minus = 0.15", ""),
    ('integrator = "exact"', 'integrator = "exakt"'),
    ("substeps = 2", "substeps = 0"),
    ("keep = 1", "keep = -1"),
]
OF_PATHS = {
    'kind = "linear"\npoints = [[0, 0], [1, 0], [1, 1]]\ntime = [0, 1, 2]\npressure = -1\n': [
        ('"linear"', '"linea"'),
        ("[[0, 0], [1, 0], [1, 1]]", "3"),
        ("[1, 0], [1, 1]]", "[1, 'x'], [1, 1]]"),
        ("[[0, 0], [1, 0], [1, 1]]", "[[0], [1], [1]]"),
        ("time = [0, 1, 2]", "time = [0, 1, 1]"),
        ("time = [0, 1, 2]", "time = [0, 1, 'x']"),
        ("pressure = -1", "pressure = 1"),
        ("pressure = -1", ""),
    ],
    'kind = "cycle"\namplitude = [1, 2]\ncycles = 2\nmean = [0, 1]\npressure = -1\n': [
        ("amplitude = [1, 2]", 'amplitude = "wide"'),
        ("amplitude = [1, 2]", ""),
        ("cycles = 2", "cycles = 0"),
        ("mean = [0, 1]", "mean = [0, nan]"),
        ("pressure = -1", "pressure = [-1, 1]"),
    ],
    'kind = "circle"\nradius = 1.0\npoints = 8\nturns = 2\npressure = -1\n': [
        ("radius = 1.0", "radius = [1]"),
        ("points = 8", "points = 0"),
        ("turns = 2", "turns = 'two'"),
        ("pressure = -1", "presure = -1"),
    ],
    'kind = "random"\nseed = 1\npoints = 4\nscale = [1, 2]\npressure = -1\n': [
        ("seed = 1", ""),
        ("points = 4", "points = 0"),
        ("scale = [1, 2]", "scale = [1, 2, 3]"),
        ("pressure = -1", "pressure = 1"),
    ],
}


def mistakes(text, folder="."):
    try:
        scene_file.reads(text, where="s", folder=folder)
    except scene_file.SceneFaults as caught:
        return {(fault.what, fault.remedy) for fault in caught.faults}
    return set()


@pytest.mark.slow
@pytest.mark.parametrize("path", OF_PATHS, ids=lambda path: path.split('"')[1])
def test_two_mistakes_are_told_together_and_nothing_else_is(path):
    assert mistakes(WHOLE + path) == set()
    wrong = {change: mistakes((WHOLE + path).replace(*change)) for change in (*OF_ALL, *OF_PATHS[path])}
    assert all(wrong.values())
    for one, other in combinations(wrong, 2):
        if one[0] not in other[0] and other[0] not in one[0] and "pressure = [-1, 1]" not in (one[1], other[1]):
            assert mistakes((WHOLE + path).replace(*one).replace(*other)) == wrong[one] | wrong[other]


def test_mistakes_in_the_table_of_points_are_told_with_the_others(tmp_path):
    (tmp_path / "points.csv").write_text("mu,sacle\n0.1,1\n0.2,2\n")
    path = '[path]\nkind = "linear"\npoints = {}\npressure = {}\n[points]\ntable = "points.csv"\n[method]\nthreads = 999\n'
    text = f'law = "coulomb"\nstiffness = -1\n{path}'
    said = {what for what, _ in mistakes(text.format(3, 1), tmp_path)}
    assert "unknown column 'sacle'" in said and len(said) == 4 and not any("needs a value" in what for what in said)
    (tmp_path / "points.csv").write_text("mu,scale\n0.1,1\n-0.2,2\n")
    said = {what for what, _ in mistakes(text.format("[[0, 0], [1, 0]]", -1), tmp_path)}
    assert any("-1/5 lies outside" in what for what in said) and any("stiffness" in what for what in said) and "threads = 999" in said


def test_outputs_that_cannot_be_written_are_told_with_the_others(tmp_path):
    pytest.importorskip("matplotlib")
    text = PLANE.replace("seed = 3", "seed = -3") + '[output]\ntable = "no/where/h.csv"\nplot = "h.xyz"\n'
    assert {what.split()[0] for what, _ in mistakes(text, tmp_path)} == {"seed", "there", "xyz"}


@pytest.mark.parametrize(
    ("old", "new", "line", "word"),
    [
        ("stiffness = [1.0, 2.0]", "stiffness = [1.0, -2.0]", 2, "not positive"),
        ("stiffness = [1.0, 2.0]", 'stiffness = "stiff"', 2, "numbers"),
        ("mu_a_plus = 0.2", "mu_a_plus = -0.2", 5, "outside its domain"),
        ("mu_a_plus = 0.2", "mu_a_pluss = 0.2", 5, "did you mean 'mu_a_plus'"),
        ("mu_b_minus = 0.15\n", "", 4, "needs a value for mu_b_minus"),
        ("pressure = -1.0", "pressure = 1.0", 15, "> 0"),
        ("pressure = -1.0\n", "", 10, "needs the pressure"),
        ("points = 40", "points = -40", 13, "points"),
        ("seed = 3", 'seed = "three"', 12, "seed"),
        ("seed = 3", "sead = 3", 12, "did you mean 'seed'"),
        ("[path]", "[path", 10, "TOML"),
        ('kind = "random"', 'kind = ["random"]', 11, "kind"),
    ],
)
def test_each_mistake_has_its_line(old, new, line, word):
    with pytest.raises(scene_file.SceneFaults) as caught:
        scene_file.reads(PLANE.replace(old, new, 1), where="s.toml")
    assert any(fault.where.startswith(f"s.toml:{line}:") and word in str(fault) for fault in caught.value.faults), caught.value.faults


def test_a_file_that_is_no_scene(tmp_path):
    (tmp_path / "bad.toml").write_bytes(b"\xff\xfe")
    for name in ("bad.toml", "none.toml"):
        with pytest.raises(InputError, match=name):
            scene_file.read(tmp_path / name)


# -- the command --------------------------------------------------------------------------------------------------


def test_the_command_writes_the_table_it_prints(folder):
    printed = run(folder / "plane.toml")
    assert printed.return_value == 0 and printed.stdout.startswith("time,u_a,u_b,u_in_a")
    done = run(folder / "plane.toml", "--out", folder / "h.csv")
    assert (done.return_value, done.stdout) == (0, "") and done.stderr == f"duhem: wrote the history of 41 knots to {folder / 'h.csv'}\n"
    assert (folder / "h.csv").read_text() == printed.stdout
    assert not (folder / "h.csv.partial").exists()


def test_the_command_lists_mistakes_line_by_line(folder):
    (folder / "bad.toml").write_text(PLANE.replace("seed", "sead").replace("exact", "exakt"))
    failed = run(folder / "bad.toml")
    assert failed.return_value == 2 and len(failed.stderr.splitlines()) == 3


@pytest.mark.parametrize(
    ("options", "message"),
    [(["--out", "h.xls"], ".csv"), (["--plot", "no/where/h.png"], "no such directory"), (["--resume"], "no table")],
)
def test_outputs_are_checked_before_the_run(folder, options, message, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.setattr(scenes, "perform", lambda *_: pytest.fail("the run began"))
    found = run(folder / "plane.toml", *options)
    assert isinstance(found.exception, InputError) and message in str(found.exception)


def test_an_interrupted_command_keeps_what_is_done_and_resumes(folder, monkeypatch):
    table = folder / "h.csv"
    run(folder / "plane.toml", "--out", folder / "whole.csv")
    simulation = import_module("duhem.path.simulate")  # the package has the function under this name
    exact = INTEGRATORS["exact"]

    def stopping(problem, ledger):
        for done in exact.advance(problem, ledger):
            yield done
            if done == 17:  # it tells of a few rows together
                raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(simulation, "INTEGRATORS", {"exact": replace(exact, advance=stopping)})
        stopped = run(folder / "plane.toml", "--out", table)
    assert stopped.return_value == 130 and "16 of 40" in stopped.stderr and "--resume" in stopped.stderr
    assert not table.exists()
    (folder / "other.toml").write_text(PLANE.replace("0.08", "0.09"))
    other = run(folder / "other.toml", "--out", table, "--resume")
    assert isinstance(other.exception, InputError) and "another run" in str(other.exception)
    begun = []
    counting = replace(exact, advance=lambda problem, ledger: (begun.append(ledger.done), exact.advance(problem, ledger))[1])
    monkeypatch.setattr(simulation, "INTEGRATORS", {"exact": counting})
    assert run(folder / "plane.toml", "--out", table, "--resume").return_value == 0
    assert begun == [17]
    assert table.read_bytes() == (folder / "whole.csv").read_bytes()
    assert not (folder / "h.csv.partial").exists()


@pytest.mark.slow
def test_a_part_cut_short_is_refused_or_resumes_to_the_same_last_digit(tmp_path):
    """Every length of a part: a number that lost its last digits still reads as one, and must not be gone on from.

    Nor from fewer rows than were kept: the sum over them is of all.
    """
    (tmp_path / "line.toml").write_text(LINE.replace("0.33", "0.1234567890123").replace("substeps = 50", "substeps = 1"))
    scene = scene_file.read(tmp_path / "line.toml")
    whole, plan, table = scene.run(), scene.plan(), tmp_path / "h.csv"
    text = scenes.keep(whole, table, scene.fingerprint).read_bytes()
    resumed = 0
    for length in range(len(text) + 1):
        beside(table).write_bytes(text[:length])
        try:
            part = scenes.recall(table, partial(scenes.history_of, plan), scene.fingerprint)
        except InputError as refused:
            assert "damaged" in str(refused) or ("another run" in str(refused) and "version" in str(refused))
            continue
        resumed += 1
        assert scene.run(part).to_text() == whole.to_text()
    assert resumed == 1


@pytest.mark.slow
def test_the_picture_is_in_the_units_that_the_scene_names(folder, monkeypatch):
    pytest.importorskip("matplotlib")
    seen = {}
    monkeypatch.setattr("duhem.show.figure.measure", lambda axis, symbol, unit="", size=0.0: seen.setdefault(unit, symbol))
    for said, units in (("", {"Pa", "m", "J/m²"}), ('stress_unit = "MPa"\nlength_unit = "mm"\n', {"MPa", "mm", "MPa mm"})):
        seen.clear()
        (folder / "units.toml").write_text(f'{PLANE}[output]\nplot = "h.png"\n{said}')
        assert run(folder / "units.toml").return_value == 0
        assert {unit for unit in seen if unit != "s"} - {""} == units
    (folder / "units.toml").write_text(f"{PLANE}[output]\nstress_unit = 3\n")
    with pytest.raises(InputError, match="stress_unit = 3; write for example"):
        scene_file.read(folder / "units.toml")


def test_explain_says_what_is_left_out_and_why(folder):
    line = run(folder / "line.toml", "--explain").stdout
    for words in (
        "not needed: solver (CVXPY or Newton) (one-dimensional: closed form)",
        "not needed: thermal block (the law is isothermal",
        "not needed: K at every step (the pressure is constant: K is computed once)",
        "not needed: matplotlib (nothing is plotted)",
    ):
        assert words in line
    (folder / "general.toml").write_text(
        PLANE.replace("[1.0, 2.0]", "[[1.0, 0.1], [0.1, 2.0]]").replace("pressure = -1.0", "pressure = [-1.0, -2.0]")
    )
    general = run(folder / "general.toml", "--explain", "--plot", folder / "p.png").stdout
    for words in ("needed: ordinary differential equation", "needed: K at every step", "needed: matplotlib"):
        assert f"\n{words}" in f"\n{general}"  # not after "not "


SOLVERS = ("duhem.projection.newton", "duhem.projection.cvxpy_method", "duhem.path.slip_equation")
HEAVY = ("cvxpy", "clarabel", "scipy", "matplotlib", "pyarrow", "z3", *SOLVERS)


def imported(folder, *arguments):
    """Which of the heavy modules runs in a fresh process import, one after the other, their arguments parted by a sign."""
    code = (
        "import sys; from duhem.cli import cli;"
        "codes = [cli.main(['simulate', *run.split()], standalone_mode=False) for run in ' '.join(sys.argv[1:]).split(' + ')];"
        f"print(*[m for m in {HEAVY!r} if m in sys.modules], file=sys.stderr); sys.exit(any(codes))"
    )
    environment = os.environ | {"PYTHONPATH": str(Path(duhem.__file__).parents[1])}
    ran = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)], capture_output=True, text=True, check=True, cwd=folder, env=environment
    )
    return set(ran.stderr.splitlines()[-1].split())


@pytest.mark.slow
def test_what_is_left_out_is_not_imported_and_changes_no_number(folder):
    assert imported(folder, "line.toml", "--out", "a.csv", "+", "plane.toml", "--out", "b.csv") == set()
    pytest.importorskip("matplotlib")
    assert imported(folder, "line.toml", "--out", "c.csv", "--plot", "c.png") == {"matplotlib"}
    assert (folder / "a.csv").read_bytes() == (folder / "c.csv").read_bytes()


def test_the_line_is_the_plane_restricted_to_it():
    """The one-dimensional closed form gives what the law of the plane gives under a motion along t_a."""
    plane = PLANE.replace("0.2\n", "0.33\n").replace("0.08", "0.29").replace("[1.0, 2.0]", "2.0")
    head, _, _ = plane.partition("[path]")
    tail = LINE.partition("[path]")[2].replace("amplitude = 1.0", "amplitude = [1.0, 0.0]")
    one, two = scene_file.reads(LINE).run(), scene_file.reads(f"{head}[path]{tail}").run()
    assert np.abs(one.stress[:, 0] - two.stress[:, 0]).max() < 1e-15 and not two.stress[:, 1].any()
    assert np.abs(one.dissipation - two.dissipation).max() < 1e-14


@pytest.mark.parametrize(
    ("law", "numbers", "pressure", "said"),
    [
        ("polygon", None, "-1e6", "corner"),
    ],
)
def test_what_the_exact_path_cannot_do_is_said_at_the_integrator_in_the_words_of_the_scene(law, numbers, pressure, said):
    if numbers is None:
        numbers = "\n".join(f"{name} = 0.3" for name in duhem.load(law).parameters)
    text = (
        f'law = "{law}"\nstiffness = 1e9\n[parameters]\n{numbers}\n[path]\nkind = "linear"\n'
        f'points = [[0, 0], [1e-3, 1e-3]]\npressure = {pressure}\n[method]\nintegrator = "exact"\n'
    )
    with pytest.raises(scene_file.SceneFaults) as caught:
        scene_file.reads(text, where="s.toml")
    (fault,) = caught.value.faults
    assert said in fault.what and fault.where.startswith(f"s.toml:{len(text.splitlines())}:")
    assert 'integrator = "implicit"' in fault.remedy and "method" not in fault.remedy
