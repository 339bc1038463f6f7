"""Which tests are marked `slow` and are not, and which are slow and unmarked: processor time, measured test by test.

    python -m tests.campaigns.marks tests/path tests/show --bound 0.3

A test counts with all its cases that every run runs, what it sets up and the processes that it starts.  Where all tests of a file are
over the bound the cheapest stays in the quick part, so that this visits every file.  What is measured on a machine whose caches are
cold includes what is compiled for them; no test depends on these numbers.
"""

from __future__ import annotations

import argparse
import os
from collections import Counter, defaultdict
from collections.abc import Generator, Sequence
from typing import Any

import pytest


def _spent() -> float:
    return sum(os.times()[:4])


class Meter:
    """A plugin of pytest that notes what each test takes, without its cases' names."""

    def __init__(self) -> None:
        self.seconds: Counter[str] = Counter()
        self.marked: set[str] = set()  # a case at least

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        name, began = item.nodeid.partition("[")[0], _spent()
        done = yield
        self.seconds[name] += _spent() - began
        if item.get_closest_marker("slow"):
            self.marked.add(name)
        return done


def stale(seconds: dict[str, float], marked: set[str], bound: float) -> tuple[list[str], list[str]]:
    """Tests that lack the mark, and marked ones that take less than half of the bound; dearest first."""
    files: defaultdict[str, list[str]] = defaultdict(list)
    for name in sorted(seconds, key=lambda name: -seconds[name]):
        files[name.partition("::")[0]].append(name)
    slow = {name for names in files.values() for name in names[:-1] if seconds[name] >= bound}
    order = sorted(seconds, key=lambda name: -seconds[name])
    return [name for name in order if name in slow - marked], [name for name in order if name in marked and seconds[name] < bound / 2]


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the tests that are named, and print what each kind of them takes and which marks are stale."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("paths", nargs="*", default=["tests"])
    parser.add_argument("--bound", type=float, default=0.3, help="seconds of processor time")
    given = parser.parse_args(arguments)
    meter = Meter()
    pytest.main(["-q", "-p", "no:cacheprovider", *given.paths], plugins=[meter])
    lacking, needless = stale(meter.seconds, meter.marked, given.bound)
    quick = sum(spent for name, spent in meter.seconds.items() if name not in meter.marked)
    print(f"\n{meter.seconds.total():.0f} s, of which {quick:.0f} s are not marked")
    for said, names in (("slow and not marked", lacking), ("marked and not slow", needless)):
        print(f"\n{said}: {len(names)}")
        for name in names:
            print(f"{meter.seconds[name]:7.2f} s  {name}")


if __name__ == "__main__":
    main()
