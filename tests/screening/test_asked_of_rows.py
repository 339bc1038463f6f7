"""Checks of a routine and stress cases asked of each row: what comes of them, from any number of processes, whatever the routine does."""

import json
import os
import sys
import types

import pytest
from click.testing import CliRunner

import duhem
from duhem import InputError, screening
from duhem.benchmark.extreme_cases import StressCases
from duhem.cli import cli
from duhem.screening import file, pool
from duhem.screening.campaign import Campaign, Grid, LawName, asked
from duhem.show.printing import text
from duhem.testing import RoutineChecks
from duhem.testing.conformance import _bound
from tests.campaigns import poisoned
from tests.long import mostly_long
from tests.screening import routines
from tests.screening.test_campaign import InProcess, table

ROWS = '[[rows]]\nlaw = "coulomb"\ngrid = { mu = [0.3, 0.5] }\n'
CHECKS = f'[campaign]\nask = "checks"\n{ROWS}[checks]\nchecks = ["feasibility", "dissipation", "tangent"]\nexamples = 3\n'
STRESS = f'[campaign]\nask = "stress"\n{ROWS}[stress]\naxes = ["aspect of K", "seam distance"]\n'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "mine_of_rows.py").write_text("from tests.screening.routines import right as update\n")
    (tmp_path / "c.toml").write_text(CHECKS)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def called(*words):
    return CliRunner().invoke(cli, ["campaign", *words], standalone_mode=False)


@pytest.mark.slow
def test_a_routine_named_on_the_command_line_is_put_to_its_checks(folder, monkeypatch):
    """0.3 is the friction that it has; of 0.5 its K is too small, which no feasibility sees and nothing here refutes."""
    monkeypatch.setattr(screening, "Pool", InProcess)
    (folder / "c.toml").write_text(CHECKS.replace("0.5", "0.1") + 'expect = { tangent = "none yet" }\n')
    done = called("c.toml", "--routine", "mine_of_rows:update", "--out", "t.csv")
    lines = table("t.csv")
    assert done.return_value == 1
    assert [(line["row"], line["claim"], line["verdict"]) for line in lines] == [
        ("1", "dissipation", "passed"),
        ("1", "feasibility", "passed"),
        ("1", "solved", "passed"),
        ("1", "tangent", "not_applicable"),
        ("2", "dissipation", "passed"),
        ("2", "feasibility", "failed"),
        ("2", "solved", "passed"),
        ("2", "tangent", "not_applicable"),
    ]
    found = json.loads(lines[5]["witness"])
    assert found["increment"].startswith("coulomb, mu = 0.1; trial [") and "measured" in found["violated"]
    words = " ".join(done.stdout.split())
    assert "feasibility 1 1 0" in words and "failed: row 2, feasibility" in words and "open" not in words
    assert "duhem campaign c.toml --row=2 --routine=mine_of_rows:update" in words


def test_what_is_expected_to_fail_is_told_apart_and_values_of_the_row_go_to_the_routine():
    campaign = Campaign((Grid(LawName("coulomb"), (("mu", ("3/10", "7/10")),)),), checks(expect=(("feasibility", "known"),)))
    right, silent = ({line.claim: line for line in asked(campaign, number)} for number in (1, 2))
    assert right["feasibility"].verdict == "xpassed" and right["solved"].verdict == "passed" and right["solved"].steps > 0
    assert silent["solved"].verdict == "failed" and json.loads(silent["solved"].witness)["flagged"] == silent["solved"].steps
    campaign = Campaign((Grid(LawName("coulomb"), (("mu", ("1/10",)),)),), checks(routines.right, expect=(("feasibility", "known"),)))
    assert [line.verdict for line in asked(campaign, 1) if line.claim == "feasibility"] == ["xfailed"]


def checks(routine=routines.ends, **options):
    return RoutineChecks(routine, ("feasibility",), examples=2, **options)


ENDS = [
    (4, "its process ended with exit code 3"),
    (1, "it needs more than 1 s of processor time"),
    (2, "it needs more than 4 GB of memory"),
    (6, "KeyboardInterrupt"),
]


@pytest.mark.parametrize(("ends", "said"), mostly_long(ENDS))
def test_what_a_routine_does_to_its_process_is_a_reason_and_harms_no_other_row(ends, said):
    campaign = Campaign((Grid(LawName("coulomb"), (("mu", ("3/10", f"{ends}/10", "8/10")),)),), checks(), seconds=1)
    with pool.Pool(campaign, 1) as processes:
        found = sorted((json.loads(text) for text in processes.texts([range(1, 4)])), key=lambda lines: lines[0][0])
    assert [lines[0][4] for lines in found] == ["passed", None, "passed"] and found[1][0][-1].partition(" (at routines.py:")[0] == said


@pytest.mark.slow
def test_what_a_routine_keeps_is_not_met_by_the_next_row():
    """Two processes for one worker, of which the second has stood by."""
    campaign = Campaign((Grid(LawName("coulomb"), (("mu", ("3/10", "1/10")),)),), checks(routines.keeps))
    with pool.Pool(campaign, 1) as processes:
        found = [json.loads(text)[0] for text in processes.texts([range(1, 3)])]
    assert [(line[0], line[4]) for line in found] == [(1, "passed"), (2, "passed")]


@pytest.mark.filterwarnings("ignore:.*multi-threaded")
def test_the_child_of_a_routine_that_forks_ends_where_the_routine_returns():
    def forks(trial, pressure, stiffness):
        os.fork()
        return trial

    here = os.getpid()
    _bound(forks, duhem.load("coulomb"))(0.0, 0.0, 0.0)
    if os.getpid() != here:
        os._exit(1)
    assert os.wait()[1] == 0


FEW = ("0.12", "0.14", "O.3", "broken.toml")  # 40 GB, an error, malformed values and laws; loops take seconds


@pytest.mark.slow
@pytest.mark.parametrize(("kinds",), mostly_long([(FEW,), (tuple(poisoned.REASONS),)], (FEW,)), ids=["few", "all"])
def test_poisoned_rows_come_back_with_their_reasons_and_harm_no_other(tmp_path, monkeypatch, kinds):
    monkeypatch.setattr(pool, "_WAITED", 1_000.0)  # a busy machine lets a loop that never ends wait too
    asked_rows, written = poisoned.campaign(tmp_path, 12 if kinds == FEW else 20, kinds)
    lines = duhem.campaign(asked_rows, workers=1).lines
    assert poisoned.faults(asked_rows, written, lines, 5) == []
    assert {line.row for line in lines if line.error} == {row for row, kind in enumerate(written, 1) if kind in kinds}


def test_a_routine_that_ends_the_program_fails_its_check():
    campaign = Campaign((Grid(LawName("coulomb"), (("mu", ("5/10",)),)),), checks())
    failed, _ = asked(campaign, 1)
    assert failed.verdict == "failed" and "the routine raised SystemExit: 5" in failed.witness


RAISES = {6: "KeyboardInterrupt", 11: "GeneratorExit", 12: "Speechless", 13: "the routine raises MemoryError by a statement of its own"}


@pytest.mark.parametrize("ends", RAISES)
def test_what_a_routine_raises_that_is_no_error_is_named(ends):
    line, _ = asked(Campaign((Grid(LawName("coulomb"), (("mu", (f"{ends}/10",)),)),), checks()), 1)
    assert line.verdict is None and line.error.partition(" (at routines.py:")[0] == RAISES[ends]


def test_of_a_routine_that_never_answers_nothing_is_said_to_be_solved():
    lines = asked(Campaign((Grid(LawName("coulomb"), (("mu", ("3/10",)),)),), checks(routines.raises)), 1)
    solved = next(line for line in lines if line.claim == "solved")
    assert solved.verdict == "not_applicable" and json.loads(solved.witness) == {"reason": "no increment was answered"}


@pytest.mark.long
def test_the_same_cases_are_drawn_whatever_was_loaded_before(tmp_path, monkeypatch):
    """A module of the package that a row loads, with numbers that Hypothesis would draw."""
    (tmp_path / "late.py").write_text(f"NUMBERS = {[*range(100, 1000)]}\n")
    monkeypatch.setattr(sys.modules[RoutineChecks.__module__], "__file__", str(tmp_path / "testing" / "conformance.py"))
    seen = []

    def routine(trial, pressure, stiffness):
        seen.append((trial.tobytes(), pressure.tobytes(), stiffness.tobytes()))
        return routines.right(trial, pressure, stiffness)

    campaign = Campaign((Grid(LawName("coulomb"), (("mu", ("3/10",)),)),), RoutineChecks(routine, ("feasibility",), examples=20, seed=2))
    asked(campaign, 1)
    before = seen.copy()
    seen.clear()
    late = types.ModuleType("late_module")
    late.__file__ = str(tmp_path / "late.py")
    monkeypatch.setitem(sys.modules, "late_module", late)
    asked(campaign, 1)
    assert seen == before


@pytest.mark.slow
def test_stress_cases_of_a_row(folder, monkeypatch):
    """Of the disc every answer is right; no parameter of it makes K thin along one axis."""
    monkeypatch.setattr(screening, "Pool", InProcess)
    (folder / "s.toml").write_text(STRESS.replace("0.5", "-1"))
    summary = duhem.campaign(folder / "s.toml", stress=StressCases)
    first, second = ([line for line in summary.lines if line.row == row] for row in (1, 2))
    assert [line.claim for line in first] == [line.claim for line in second] == sorted(StressCases(("aspect of K", "seam distance")).names)
    assert {line.verdict for line in first if line.claim.startswith("aspect")} == {"not_applicable"}
    seams = [line for line in first if line.claim.startswith("seam")]
    assert {(line.verdict, line.method, line.steps) for line in seams} == {("ok", "closed-form", 2)} and len(seams) == 13
    assert all(json.loads(line.witness)["digits"]["stress"] > 14.0 for line in seams)
    assert {line.error for line in first} == {None} and all("mu" in line.error for line in second)
    assert sorted(line.row for line in summary.slowest) == [1, 2] and summary.slowest[0].seconds == max(line.seconds for line in first)
    assert "23 names" in text(summary) and summary.commands[1].endswith("--row=1")


@pytest.mark.long
@pytest.mark.parametrize("ask", [STRESS, CHECKS], ids=["stress", "checks"])
def test_the_table_is_the_same_from_two_processes(tmp_path, ask):
    (tmp_path / "c.toml").write_text(ask)
    means = {"routine": routines.right, "checks": RoutineChecks} if ask is CHECKS else {"stress": StressCases}
    one, two = (duhem.campaign(tmp_path / "c.toml", workers=n, **means) for n in (1, 2))
    assert [line[:9] for line in one.lines] == [line[:9] for line in two.lines]


MEANS = {"routine": routines.right, "checks": RoutineChecks, "stress": StressCases}
WRONG = {
    "key": (CHECKS.replace("examples", "exampels"), "c:8:1: unknown key 'exampels'; did you mean 'examples'"),
    "check": (CHECKS.replace('"tangent"', '"tangant"'), "c:7:1: unknown check 'tangant'"),
    "count": (CHECKS.replace("examples = 3", "examples = 0"), "c:8:1: examples = 0; give a whole number >= 1"),
    "share": (f"{CHECKS}most_flagged = 2", "c:9:1: 2 is not a fraction"),
    "accuracy": (f"{CHECKS}accuracy = '1'", "c:9:1: '1' is not a relative error"),
    "expected": (f"{CHECKS}expect = {{ tangant = 'x' }}", "c:9:1: unknown check 'tangant'"),
    "reason": (f"{CHECKS}expect = {{ tangent = 1 }}", "c:9:1: .* does not map checks to reasons"),
    "no pairs": (f"{CHECKS}expect = ['tangent']", "c:9:1: .* does not map checks to reasons"),
    "claims": (f"{ROWS}", 'a routine is given, but ask = "claims"'),
    "axis": (STRESS.replace("aspect", "aspct"), "c:7:1: unknown name 'aspct of K'; they are: load"),
    "axes": (STRESS.replace('["aspect of K", "seam distance"]', '"load"'), "c:7:1: axes is no list of different names"),
    "method": (f"{STRESS}methods = ['newtn']", "c:8:1: unknown name 'newtn'"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_mistake_in_the_file_is_told_with_its_place(tmp_path, case):
    written, said = WRONG[case]
    means = MEANS if "stress" not in written else MEANS | {"routine": None}
    with pytest.raises(InputError, match=said):
        file.reads(written, where="c", folder=tmp_path, **means)


def test_what_is_to_be_asked_must_be_given(folder):
    with pytest.raises(InputError, match='ask = "checks" needs a routine; name it with --routine module:callable'):
        file.reads(CHECKS)
    with pytest.raises(InputError, match='ask = "stress" needs an argument that is missing'):
        file.reads(STRESS)
    with pytest.raises(InputError, match=r"ask=duhem.testing.RoutineChecks\(routine\)"):
        duhem.campaign(["coulomb"], routine=routines.right)
    with pytest.raises(InputError, match="no routine for a law"):
        RoutineChecks(3)
    for name, said in (("mine_of_rows:none", "cannot be imported"), ("nonesuch:update", "cannot be imported"), ("os:sep", "no routine")):
        assert said in str(called("c.toml", "--routine", name, "--out", "t.csv").exception)


def test_another_routine_is_another_campaign(folder):
    mine = folder / "mine_of_rows.py"
    told = [checks(routines.right).told(), checks(routines.ends).told(), checks(routines.right, seed=1).told()]
    assert len({*told}) == 3 and told[0] == checks(routines.right).told() and f"{mine}" not in told[0]
