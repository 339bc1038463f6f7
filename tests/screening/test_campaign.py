"""A campaign's table: the same from any number of processes and after any interruption, whatever single rows do."""

import csv
import errno
import json
import os
import resource
import signal
import sys
from contextlib import suppress
from dataclasses import replace
from importlib import import_module

import pytest
from click.testing import CliRunner

import duhem
from duhem import InputError, screening
from duhem.cli import cli
from duhem.law.catalogue import load
from duhem.proof.verification import claim_results
from duhem.screening import file, pool
from duhem.screening.campaign import Campaign, Claimed, Grid, LawName, as_text, asked
from duhem.screening.summary import Counts
from duhem.show.place import beside, rows_beside
from duhem.show.printing import text
from tests.campaigns.screenings import AtOnce
from tests.long import mostly_long
from tests.screening.poison import NAMES, Poison

CAMPAIGN = """\
[campaign]
claims = ["origin", "convexity"]
out = "table.csv"
[[rows]]
laws = ["coulomb", "broken.toml"]
[[rows]]
law = "limacon"
grid = { mu = [0.3], e = [0.1, 0.5, 0.6] }
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    (tmp_path / "broken.toml").write_text("[criterion]\nname =")
    return tmp_path


class InProcess:
    """The pool's stand-in: rows asked here, in an order of its own, and ended after some of them."""

    def __init__(self, campaign, workers, most=10**9, killed=KeyboardInterrupt):
        self.campaign, self.most, self.killed, self.asked = campaign, most, killed, []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def texts(self, rows):
        for number in sorted((n for each in rows for n in each), key=lambda n: (n % 2, n)):
            if len(self.asked) == self.most:
                raise self.killed
            self.asked.append(number)
            yield as_text(asked(self.campaign, number))


def table(path):
    """The lines without what may differ from run to run."""
    with open(path, newline="") as stream:
        return [{name: value for name, value in line.items() if name != "seconds"} for line in csv.DictReader(stream)]


def mu(values):
    return Grid(LawName("coulomb"), (("mu", tuple(map(str, values))),))


@pytest.mark.slow
def test_the_table_is_sorted_whatever_was_done_first(folder, monkeypatch):
    monkeypatch.setattr(screening, "Pool", InProcess)
    done = CliRunner().invoke(cli, ["campaign", str(folder / "campaign.toml")], standalone_mode=False)
    assert done.return_value == 4  # a row has no verdict
    lines = table(folder / "table.csv")
    assert [(line["row"], line["claim"]) for line in lines] == [(f"{n}", c) for n in range(1, 6) for c in ("convexity", "origin")]
    assert [line["verdict"] for line in lines] == ["proved"] * 2 + [""] * 2 + ["proved"] * 4 + ["refuted", "proved"]
    assert "broken.toml:2" in lines[2]["error"] and json.loads(lines[4]["parameters"]) == {"mu": "3/10", "e": "1/10"}
    assert lines[8]["witness"] and {line["steps"] == "0" for line in lines if line["claim"] == "convexity"} == {True, False}
    words = " ".join(done.stdout.split())
    monkeypatch.setattr(pool, "Pool", InProcess)
    alone = CliRunner().invoke(cli, ["campaign", str(folder / "campaign.toml"), "--row", "5"], standalone_mode=False)
    assert alone.return_value == 1 and [line["witness"] for line in json.loads(alone.stdout)] == [lines[8]["witness"], None]
    assert "5 rows" in words and "convexity 3 1 1" in words and "origin 4 0 1" in words
    assert "duhem verify limacon --set=mu=3/10" in words and "no verdict: row 2" in words
    assert [p.name for p in folder.glob("table.csv.*")] == []


class Killed(BaseException):
    """What ends a run without a word."""


@pytest.mark.slow
@pytest.mark.parametrize("fault", [KeyboardInterrupt, Killed])
def test_a_campaign_goes_on_from_what_is_done(folder, monkeypatch, fault):
    monkeypatch.setattr(screening, "Pool", InProcess)
    monkeypatch.setattr("duhem.screening.table._PAUSE", 0.0)
    whole = folder / "whole.csv"
    duhem.campaign(folder / "campaign.toml", out=whole)
    out, last = folder / "t.csv", []

    def some(most, campaign, workers):
        last.append(InProcess(campaign, workers, most, fault))
        return last[-1]

    for most in (2, 1):
        monkeypatch.setattr(screening, "Pool", lambda campaign, workers, most=most: some(most, campaign, workers))
        with pytest.raises(screening.StoppedCampaign if fault is KeyboardInterrupt else Killed) as ended:
            duhem.campaign(folder / "campaign.toml", out=out, resume=bool(last))
        assert fault is Killed or ("of 5 rows" in str(ended.value) and "--resume" in str(ended.value))
        with open(rows_beside(out), "ab") as stream:
            stream.write(b"half a row, and then")
    assert not out.exists()
    monkeypatch.setattr(screening, "Pool", lambda campaign, workers: some(9, campaign, workers))
    with pytest.raises(InputError, match="another run; delete it, or go on with the campaign as it was"):
        duhem.campaign(folder / "campaign.toml", claims=["origin"], out=out, resume=True)
    duhem.campaign(folder / "campaign.toml", out=out, resume=True)
    assert [each.asked for each in last if each.asked] == [[2, 4], [1], [3, 5]]
    assert table(out) == table(whole) and not beside(out).exists() and not rows_beside(out).exists()


def test_a_finished_table_in_csv_is_asked_anew_as_it_says_not_what_was_asked(folder, monkeypatch):
    """The same rows, values and claims, of a law with another formula."""
    monkeypatch.setattr(screening, "Pool", InProcess)
    mine = folder / "mine.toml"
    mine.write_text('[criterion]\nname = "mine"\nforces = ["t"]\npressure = false\ng = "t**2 - 1"\n')
    (folder / "c.toml").write_text('[campaign]\nclaims = ["origin"]\nout = "t.csv"\n[[rows]]\nlaws = ["mine.toml"]\n')
    said = []
    for formula in ("t**2 - 1", "t**2 + 1"):
        mine.write_text(mine.read_text().replace("t**2 - 1", formula))
        import_module("duhem.screening.campaign")._law.cache_clear()  # as another process has it
        done = CliRunner().invoke(cli, ["campaign", str(folder / "c.toml"), "--resume"], standalone_mode=False)
        said.append((done.return_value, table(folder / "t.csv")[0]["verdict"], done.stderr.count("computes all rows again")))
    assert said == [(0, "proved", 0), (1, "refuted", 1)]


@pytest.mark.slow
def test_a_finished_campaign_in_parquet_has_nothing_left_to_do(folder, monkeypatch):
    pytest.importorskip("pyarrow")
    monkeypatch.setattr(screening, "Pool", InProcess)
    out = folder / "t.parquet"
    first = duhem.campaign(folder / "campaign.toml", out=out)
    stands = out.read_bytes(), out.stat().st_mtime_ns
    monkeypatch.setattr(screening, "Pool", None)
    again = duhem.campaign(folder / "campaign.toml", out=out, resume=True)
    assert (out.read_bytes(), out.stat().st_mtime_ns) == stands and replace(again, stood=False) == first
    done = CliRunner().invoke(cli, ["campaign", str(folder / "campaign.toml"), "--out", str(out), "--resume"], standalone_mode=False)
    assert done.return_value == 4 and "nothing left to do" in " ".join(done.stdout.split()) and "nothing left" not in text(first)
    for change in ({"mu = [0.3]": "mu = [0.4]"}, {'"coulomb", ': ""}, {'"origin", ': ""}, {"0.5, 0.6": "0.5, 0.6, 0.7"}):
        ((old, new),) = change.items()
        (folder / "other.toml").write_text(CAMPAIGN.replace(old, new))
        with pytest.raises(InputError, match="another campaign"):
            duhem.campaign(folder / "other.toml", out=out, resume=True)
    out.write_bytes(stands[0][: len(stands[0]) // 2])
    with pytest.raises(InputError, match=r"another campaign|no table"):
        duhem.campaign(folder / "campaign.toml", out=out, resume=True)


def test_a_part_that_was_changed_is_refused(folder, monkeypatch):
    monkeypatch.setattr(screening, "Pool", lambda campaign, workers: InProcess(campaign, workers, 3))
    out = folder / "t.csv"
    with pytest.raises(screening.StoppedCampaign):
        duhem.campaign(folder / "campaign.toml", out=out)
    rows_beside(out).write_bytes(rows_beside(out).read_bytes().replace(b"proved", b"Proved", 1))
    with pytest.raises(InputError, match="damaged"):
        duhem.campaign(folder / "campaign.toml", out=out, resume=True)


@pytest.mark.slow
def test_two_runs_do_not_write_one_table(folder, monkeypatch):
    monkeypatch.setattr(screening, "Pool", InProcess)
    out, refused = folder / "t.csv", []

    def another_begins(done, rows):
        for resume in (False, True):
            with pytest.raises(InputError, match="another run is writing"):
                duhem.campaign(folder / "campaign.toml", out=out, resume=resume)
            refused.append(done)

    duhem.campaign(folder / "campaign.toml", out=out, on_row=another_begins)
    duhem.campaign(folder / "campaign.toml", out=folder / "alone.csv")
    assert refused == [1, 1, 2, 2, 3, 3, 4, 4, 5, 5] and table(out) == table(folder / "alone.csv")


@pytest.mark.slow
def test_where_there_is_no_room_one_line_says_so_and_what_is_noted_stays(folder, monkeypatch):
    monkeypatch.setattr(screening, "Pool", InProcess)
    monkeypatch.setattr("duhem.screening.table._PAUSE", 0.0)
    out, whole = folder / "t.csv", folder / "whole.csv"
    duhem.campaign(folder / "campaign.toml", out=whole)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    monkeypatch.setattr(signal, "SIGXFSZ", signal.signal(signal.SIGXFSZ, signal.SIG_IGN))

    def full(done, rows):  # in the midst of the next row
        resource.setrlimit(resource.RLIMIT_FSIZE, (rows_beside(out).stat().st_size + 20, before[1]))

    try:
        with pytest.raises(InputError, match=r"the rows cannot be written: .*; free some disk space"):
            duhem.campaign(folder / "campaign.toml", out=out, on_row=full)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    with open(beside(out), "ab") as stream:
        stream.write(b"3 12")  # half a note
    pools = []
    for most in (1, 9):
        monkeypatch.setattr(screening, "Pool", lambda campaign, workers, n=most: pools.append(InProcess(campaign, workers, n)) or pools[-1])
        with suppress(screening.StoppedCampaign):
            duhem.campaign(folder / "campaign.toml", out=out, resume=True)
    assert [each.asked for each in pools] == [[4], [1, 3, 5]] and table(out) == table(whole)


def test_what_repeats_a_row_asks_what_the_row_asked(folder, monkeypatch):
    monkeypatch.setattr(screening, "Pool", InProcess)
    head = '[campaign]\nclaims = ["origin"]\neffort = "quick"\n'
    (folder / "v.csv").write_text("mu,e\n0.3,0.1\n0.3\n")
    (folder / "c.toml").write_text(f'{head}[[rows]]\nlaw = "limacon"\ntable = "v.csv"\n')
    summary = duhem.campaign(folder / "c.toml")
    assert summary.commands == {1: "duhem verify limacon --set=mu=3/10 --set=e=1/10 --claims origin --effort=quick"}
    assert "no verdict: row 2, origin, 0.000 s, which has no values" in " ".join(text(summary).split())


def test_a_campaign_without_any_verdict_has_a_summary(folder, monkeypatch):
    monkeypatch.setattr(screening, "Pool", InProcess)
    summary = duhem.campaign([("limacon", {"e": "3"}), ("limacon", {"e": "4"})], ["origin"])
    assert "2 rows" in text(summary) and "origin" in text(summary) and "Without verdict" in text(summary)


def test_what_costs_nothing_is_asked_as_anything_is(folder, monkeypatch):
    monkeypatch.setattr(screening, "Pool", InProcess)
    summary = duhem.campaign(replace(file.read(folder / "campaign.toml"), inquiry=AtOnce(), out=None))
    assert {line.verdict for line in summary.lines} == {"proved", None} and summary.commands


def test_a_row_that_asks_the_program_to_end_is_a_row(folder, monkeypatch):
    monkeypatch.setattr(Claimed, "answers", lambda self, law: sys.exit(3))
    assert {line.error for line in asked(file.read(folder / "campaign.toml"), 1)} == {"it ends the program, with 3"}


@pytest.mark.parametrize("lacks", [OSError(errno.ENOMEM, "Cannot allocate memory"), MemoryError()])
@pytest.mark.parametrize("told", [True, False])
def test_a_call_that_gets_no_memory_is_lack_of_memory_whatever_it_raises_itself(folder, monkeypatch, lacks, told):
    def full(self, law):
        try:
            raise lacks
        except type(lacks):
            if not told:
                raise ValueError("no buffer") from None
            raise

    monkeypatch.setattr(Claimed, "answers", full)
    with pytest.raises(MemoryError):
        asked(file.read(folder / "campaign.toml"), 1)


@pytest.mark.parametrize("lacks", [RuntimeError("can't start new thread"), ImportError("z.so: failed to map segment from shared object")])
def test_a_thread_or_a_library_that_does_not_fit_is_lack_of_memory(folder, monkeypatch, lacks):
    def full(self, law):
        raise lacks

    monkeypatch.setattr(Claimed, "answers", full)
    campaign = file.read(folder / "campaign.toml")
    before = resource.getrlimit(resource.RLIMIT_AS)
    with open("/proc/self/status") as stream:
        peak = next(1024 * int(line.split()[1]) for line in stream if line.startswith("VmPeak"))
    try:
        resource.setrlimit(resource.RLIMIT_AS, (peak + 50_000_000, before[1]))
        with pytest.raises(MemoryError):
            asked(campaign, 1)
        resource.setrlimit(resource.RLIMIT_AS, (peak + 10**9, before[1]))
        assert str(lacks) in asked(campaign, 1)[0].error
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


@pytest.mark.slow
def test_parquet_has_types_and_says_where_it_is_from(folder, monkeypatch):
    pytest.importorskip("pyarrow")
    from pyarrow import parquet

    monkeypatch.setattr(screening, "Pool", InProcess)
    for name in ("t.csv", "t.parquet"):
        duhem.campaign(folder / "campaign.toml", out=folder / name)
    found = parquet.read_table(folder / "t.parquet")
    kinds = {name: f"{found.schema.field(name).type}" for name in found.column_names}
    assert kinds == dict.fromkeys(kinds, "string") | {"row": "int64", "steps": "int64", "seconds": "double"}
    assert found.schema.metadata[b"asked"] == b"claims origin,convexity normal" and found.schema.metadata[b"rows"] == b"5"
    as_csv = [{k: "" if v is None else f"{v}" for k, v in line.items() if k != "seconds"} for line in found.to_pylist()]
    assert as_csv == table(folder / "t.csv")


@pytest.mark.slow
def test_a_row_that_ends_its_process_is_a_row_and_harms_no_other():
    """Two real processes beside each other; what is asked elsewhere is asked here too."""
    campaign = Campaign((mu(range(1, 8)),), Poison(crash=3, fault=5))
    with pool.Pool(campaign, 2) as processes:
        found = sorted(processes.texts([range(1, 8)]), key=lambda text: json.loads(text)[0][0])
    alive = [number for number in range(1, 8) if number != 3]
    assert [text for text in found if f"[[{3}," not in text] == [as_text(asked(campaign, number)) for number in alive]
    (crashed,) = [json.loads(text) for text in found if text.startswith("[[3,")]
    assert [line[3] for line in crashed] == sorted(NAMES) and {line[-1] for line in crashed} == {"its process ended by SIGABRT"}
    assert "ZeroDivisionError: by mu" in found[4]


@pytest.mark.parametrize(("how", "said"), mostly_long([("hang", "more than 1 s of processor time"), ("memory", "more than 4 GB")]))
def test_a_row_that_takes_too_much_is_ended(how, said):
    campaign = Campaign((mu(range(1, 5)),), Poison(**{how: 2}), seconds=1)
    with pool.Pool(campaign, 1) as processes:
        found = sorted(processes.texts([range(1, 5)]))
    assert [json.loads(text)[0][4] for text in found] == ["proved", None, "proved", "proved"] and said in found[1]


@pytest.mark.slow
def test_a_row_that_waits_for_ever_is_ended_with_what_it_started(monkeypatch):
    monkeypatch.setattr(pool, "_WAITED", 1.0)
    campaign = Campaign((mu(range(1, 4)),), Poison(sleep=2), seconds=0.5)
    with pool.Pool(campaign, 1) as processes:
        (found,) = processes.texts([range(2, 3)])
    assert json.loads(found)[0][4] is None
    assert json.loads(found)[0][-1] == "it waits: more than 1.5 s have passed, and it has not taken 0.5 s of processor time"


@pytest.mark.long
def test_what_a_row_forks_says_nothing():
    campaign = Campaign((mu([1, 2]),), Poison(fork=2))
    with pool.Pool(campaign, 1) as processes:
        found = [json.loads(text) for text in processes.texts([range(1, 3)])]
    assert [lines[0][4] for lines in found] == ["proved", "proved"]


@pytest.mark.long
def test_a_process_that_somebody_ends_costs_no_row(folder):
    campaign = replace(file.read(folder / "campaign.toml"), out=None)
    plain = duhem.campaign(campaign, workers=1).lines
    with pool.Pool(campaign, 2) as processes:
        texts = []
        for text in processes.texts([range(1, 6)]):
            texts.append(text)
            if len(texts) in (1, 3):
                for each in processes._processes:
                    os.kill(each.child.pid, signal.SIGKILL)
    found = sorted((json.loads(text) for text in texts), key=lambda lines: lines[0][0])
    assert [[*line[:9], line[10]] for lines in found for line in lines] == [[*line[:9], line[10]] for line in plain]


@pytest.mark.long
def test_a_process_that_has_grown_is_replaced_and_no_row_is_lost_or_doubled(monkeypatch):
    monkeypatch.setattr(pool, "_ROWS", 2)
    monkeypatch.setattr(pool, "_RESIDENT", 0)
    monkeypatch.setattr(pool, "_MOST", 2)
    started = []
    monkeypatch.setattr(pool, "_Worker", lambda sent, make=pool._Worker: started.append(make(sent)) or started[-1])
    campaign = Campaign((mu(range(1, 8)),), Poison())
    with pool.Pool(campaign, 1) as processes:
        found = list(processes.texts([range(1, 8)]))
    assert found == [as_text(asked(campaign, number)) for number in range(1, 8)]
    assert len(started) > 2 and all(each.done in (2, 3) for each in started[:-1])


def test_what_cannot_be_asked_is_said_before_the_work(folder, monkeypatch):
    monkeypatch.setattr(screening, "Pool", None)  # nothing is started
    for arguments, said in (
        ({"out": folder / "t.txt"}, "neither .csv nor .parquet"),
        ({"out": folder / "campaign.toml"}, "neither"),
        ({"out": folder / "none" / "t.csv"}, "no such directory"),
        ({"workers": 0}, "0 workers"),
        ({"claims": ["convex"]}, "unknown claim"),
    ):
        with pytest.raises(InputError, match=said):
            duhem.campaign(folder / "campaign.toml", **arguments)
    with pytest.raises(InputError, match="no table to continue"):
        duhem.campaign(["coulomb"], resume=True)
    with pytest.raises(InputError, match="there are no rows"):
        duhem.campaign([])
    (folder / "campaign.toml").write_text(CAMPAIGN.replace('out = "table.csv"\n', ""))
    done = CliRunner().invoke(cli, ["campaign", str(folder / "campaign.toml")], standalone_mode=False)
    assert "the name of the table is missing" in str(done.exception)


def test_what_no_process_can_take_is_said(monkeypatch):
    campaign = Campaign((mu([1]),), Poison())
    for command, said in (("print('no')", "ended with exit code 0 before it could"), ("import os; os.abort()", "ended by SIGABRT before")):
        monkeypatch.setattr(pool, "_STARTS", 2)
        monkeypatch.setattr(pool, "_COMMAND", (sys.executable, "-S", "-c", command))
        with pool.Pool(campaign, 1) as processes, pytest.raises(InputError, match=said):
            list(processes.texts([range(1, 2)]))


@pytest.mark.slow
def test_a_row_has_what_verify_says():
    law = load("limacon").fix({"mu": "0.3", "e": "0.6"})
    claims = ("dissipation", "convexity")  # the first rests on others, which are not asked
    found, whole = claim_results(law, claims), duhem.verify(law, claims=claims)
    assert [replace(r, seconds=0.0) for r in found] == [replace(r, seconds=0.0) for r in whole.results] and whole.rests_on
    answers = list(Claimed(claims).answers(law))
    assert {(claim, said, steps) for claim, said, *_, steps, _ in answers} == {(r.claim, r.verdict.value, r.steps) for r in whole.results}


def test_what_holds_by_construction_is_counted_apart_and_keeps_its_verdict():
    campaign = Campaign((Grid(LawName("coulomb"), (("mu", ("1/2", "1/3")),)),), Claimed(("origin", "state_laws")))
    lines = [line for number in (1, 2) for line in asked(campaign, number)]
    counts = Counts(campaign)
    assert [*counts.passing(iter(lines))] == lines and {line.verdict for line in lines} == {"proved"}
    assert counts.summary().verdicts == {("origin", "proved"): 2, ("state_laws", "by_construction"): 2}
    assert "by construction" in text(counts.summary())
