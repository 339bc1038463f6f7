"""Whether a law gets the same verdicts, word for word, however busy the machine is and whoever else computes.

Every law is examined alone, twice beside two busy processes, by eight threads of one process, and in four processes at
once, each with hashes of its own (PYTHONHASHSEED); verdicts, methods, details and witnesses must be the same each time.

    python -m tests.campaigns.determinism --count 30
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

from duhem import InputError, load, verify
from duhem.law import catalogue
from duhem.law.curve_law import Law

__all__ = ["examined", "in_processes"]

Said = Mapping[str, Any]


def _laws(count: int) -> Iterator[tuple[str, Law]]:
    """The built-in laws, those of the adversary, and ``count`` of the campaign."""
    from tests.campaigns.families.table import trials
    from tests.proof.test_adversary import ROWS

    yield from ((name, load(name)) for name in catalogue.names())
    yield from ((row.name, row.law()) for row in ROWS)
    yield from ((trial.law.name, trial.law) for trial in trials(count, 1))


def examined(law: str | Law) -> Said:
    """All that is said of a law but how long it took."""
    try:
        report = verify(law).to_dict()
    except InputError as fault:
        return {"error": str(fault)}
    return {**report, "claims": [{key: value for key, value in row.items() if key != "seconds"} for row in report["claims"]]}


def in_processes(seeds: Sequence[str], names: Sequence[str] = (), count: int = 0) -> list[dict[str, Said]]:
    """The same from processes that run at once, one for each hash seed."""
    command = [sys.executable, "-m", "tests.campaigns.determinism", "--say", "--count", str(count), *names]
    running = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONHASHSEED": seed}) for seed in seeds]
    return [json.loads(process.communicate()[0]) for process in running]


@contextmanager
def _busy(count: int) -> Iterator[None]:
    spinning = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for process in spinning:
            process.kill()
            process.wait()


def _threaded(laws: Mapping[str, Law]) -> dict[str, Said]:
    with ThreadPoolExecutor(8) as pool:
        return dict(zip(laws, pool.map(examined, laws.values()), strict=True))


def _differences(what: str, alone: Mapping[str, Said], other: Mapping[str, Said]) -> int:
    """How many laws are spoken of otherwise; each is printed with the claims in question."""
    found = 0
    for name, said in alone.items():
        there = json.loads(json.dumps(other[name]))
        if there != said:
            found += 1
            pairs = zip(said.get("claims", ()), there.get("claims", ()), strict=False)
            print(f"DIFFERS {what}: {name}", *(f"\n  {a}\n  {b}" for a, b in pairs if a != b), flush=True)
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign and print a line for each setting; 1 if anything differs."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("names", nargs="*", help="built-in laws in place of all")
    parser.add_argument("--count", type=int, default=30, help="laws of the campaign besides")
    parser.add_argument("--say", action="store_true", help="examine each law once and print what is said, as JSON")
    asked = parser.parse_args(arguments)
    laws = {name: load(name) for name in asked.names} or dict(_laws(asked.count))
    if asked.say:
        print(json.dumps({name: examined(law) for name, law in laws.items()}))
        return 0
    alone: dict[str, Said] = {}
    wrong = 0

    def compared(what: str, other: Mapping[str, Said], began: float) -> None:
        nonlocal wrong
        found = _differences(what, alone, other)
        wrong += found
        print(f"{what:24} {len(alone):4} laws {found:4} differ {time.perf_counter() - began:8.1f} s", flush=True)

    start = time.perf_counter()
    alone.update({name: json.loads(json.dumps(examined(law))) for name, law in laws.items()})
    compared("alone", alone, start)
    for turn in ("once", "again"):
        start = time.perf_counter()
        with _busy(2):
            compared(f"two busy processes, {turn}", {name: examined(law) for name, law in laws.items()}, start)
    start = time.perf_counter()
    compared("eight threads", _threaded(laws), start)
    start = time.perf_counter()
    seeds = ("0", "1", "2", "3")
    for seed, said in zip(seeds, in_processes(seeds, asked.names, asked.count), strict=True):
        compared(f"process, hash seed {seed}", said, start)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
