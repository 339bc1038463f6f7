"""What every test may use: the Hypothesis profiles, the command run in this process, one worker a file, dear files first.

What is collected stays: nobody looks for garbage while it is, nor in it afterwards, which took a third of collecting.

Profiles: `ci` (the default) repeats itself exactly; HYPOTHESIS_PROFILE or --hypothesis-profile chooses another.
`dev` draws anew each time, `deep` does so a hundred times longer.
"""

import gc
import os
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from hypothesis import settings

from duhem.__main__ import main

settings.register_profile("ci", derandomize=True, deadline=None, database=None)
settings.register_profile("dev", deadline=None)
settings.register_profile("deep", deadline=None, max_examples=10_000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))


gc.disable()  # until all tests are collected
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # each of the many processes that tests start would compile duhem anew
sys.dont_write_bytecode = False  # and each run all tests, whose assertions pytest rewrites: a third of collecting

SLOW = 50  # quick tests take as long as a slow one
KEPT_IN_COMMON = {  # a file: another, whose tests keep in a module of both what these ask for again
    "tests/derivation/test_printing.py": "tests/derivation/test_derivation.py",
    "tests/test_map.py": "tests/test_structure.py",
}


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """All tests of a file go to one worker: what a file computes once and keeps is not computed again by another worker."""
    from xdist.scheduler import LoadFileScheduling

    class Scheduling(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = super()._split_scope(nodeid)
            return KEPT_IN_COMMON.get(file, file)

    if config.getvalue("dist") != "load":
        return None
    config.option.loadscopereorder = False  # the order is that of the items, below
    return Scheduling(config, log)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> Iterator[None]:
    """What is long is slow too, so that -m "not slow" leaves it out.  Workers begin with dear files, so that all end together."""
    for item in items:
        if item.get_closest_marker("long"):
            item.add_marker("slow")
    yield
    if hasattr(config, "workerinput"):
        cost: Counter[Any] = Counter()
        for item in items:
            slow = item.get_closest_marker("slow")
            cost[item.path] += SLOW * (slow.args[0] if slow.args else 1) if slow else 1
        items.sort(key=lambda item: -cost[item.path])


def pytest_collection_finish() -> None:
    gc.freeze()
    gc.set_threshold(50_000, 10, 10)  # a proof makes much that stays a while: to look less often for garbage takes 4 % less time
    gc.enable()


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Callable[..., tuple[int, str, str]]:
    """Exit code, standard output and standard error of `duhem ARGUMENTS`."""

    def call(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["duhem", *arguments])
        code = main()
        return code, *capsys.readouterr()

    return call
