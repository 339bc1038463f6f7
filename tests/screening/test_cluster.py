"""A campaign on a Dask cluster of real processes on the loopback address: the same table, whoever is lost."""

import json
import os
import pickle
import signal
import subprocess
import sys
from pathlib import Path
from time import monotonic, sleep
from types import SimpleNamespace

import pytest

import duhem
from duhem import InputError, MissingExtraError
from duhem.screening import pool
from duhem.screening.campaign import Campaign, Grid, LawName
from tests.screening.poison import Poison

MU = Grid(LawName("coulomb"), (("mu", tuple(map(str, range(1, 13)))),))


def test_without_the_extra_the_message_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(MissingExtraError, match=r"duhem\[cluster\]"):
        pool.Cluster(Campaign((MU,), Poison()), "tcp://127.0.0.1:1")


def test_a_scheduler_and_workers_of_this_machine_are_not_both_asked():
    with pytest.raises(InputError, match="workers and scheduler"):
        duhem.campaign(["coulomb"], workers=2, scheduler="tcp://127.0.0.1:1")


def test_a_worker_keeps_no_pool_that_failed_and_few_of_campaigns_that_nobody_ended(monkeypatch):
    ended, dask_worker = [], SimpleNamespace()

    class Pool:
        def __init__(self, campaign, workers):
            self.campaign = campaign

        def __exit__(self, *_):
            ended.append(self.campaign)

        def texts(self, rows):
            yield self.campaign
            if rows == [range(1, 1)]:
                raise InputError("none")

    monkeypatch.setattr(pool, "Pool", Pool)
    monkeypatch.setattr(pool, "_distributed", lambda: SimpleNamespace(get_worker=lambda: dask_worker))
    with pytest.raises(InputError):
        pool._asked(pickle.dumps("failed"), "0", 1, 1)
    assert ended == ["failed"]
    for name in ("a", "b", "a", "c", "a"):
        assert pool._asked(pickle.dumps(name), name, 1, 2)[0] == [name]
    assert ended == ["failed", "b"]
    pool._closed("a", dask_worker)
    assert ended == ["failed", "b", "a"]


def started(*arguments):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([*sys.path, str(Path(__file__).parents[2])]), "PYTHONWARNINGS": ""}
    command = [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]]
    return subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.fixture
def scheduler(tmp_path):
    """The file of a scheduler with two workers, and these."""
    pytest.importorskip("distributed")
    place = tmp_path / "scheduler.json"
    here = ("--scheduler-file", str(place), "--no-dashboard")
    children = [started("dask_scheduler", "--host", "127.0.0.1", "--port", "0", *here)]
    began = monotonic()
    while not place.exists():
        assert monotonic() - began < 120 and children[0].poll() is None
        sleep(0.1)
    options = ("--nthreads", "1", "--no-nanny", "--local-directory", str(tmp_path), "--host", "127.0.0.1")
    children += [started("dask_worker", *here, *options) for _ in range(2)]
    from distributed import Client

    with Client(scheduler_file=str(place), set_as_default=False) as client:
        client.wait_for_workers(2, timeout=120)
    yield place, children[1:]
    for child in children:
        child.kill()
        child.wait()


@pytest.mark.long
def test_a_cluster_gives_the_table_of_the_pool(scheduler):
    campaign = Campaign((MU,), Poison(crash=3, fault=5))
    place, workers = scheduler
    told = []
    found = duhem.campaign(campaign, scheduler=place, on_start=told.append)
    assert found.lines == duhem.campaign(campaign, workers=2).lines and len(found.lines) == 24
    assert {line.error for line in found.lines if line.row == 3} == {"its process ended by SIGABRT"}
    assert told[0].startswith("http://127.0.0.1")
    with pool.Cluster(campaign, place) as lame:
        texts = []
        for text in lame.texts([range(1, 13)]):
            texts.append(text)
            if len(texts) == 1:
                workers[0].send_signal(signal.SIGKILL)
    lines = sorted((json.loads(text) for text in texts), key=lambda row: row[0][0])
    assert [tuple(line) for row in lines for line in row] == [tuple(line) for line in found.lines]


@pytest.mark.long
def test_no_scheduler_is_said():
    pytest.importorskip("distributed")
    patience, pool._DASK_PATIENCE = pool._DASK_PATIENCE, "1s"
    try:
        with pytest.raises(InputError, match="the scheduler does not answer"):
            pool.Cluster(Campaign((MU,), Poison()), "tcp://127.0.0.1:9")
    finally:
        pool._DASK_PATIENCE = patience
