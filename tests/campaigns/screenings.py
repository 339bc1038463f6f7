"""A campaign of plane-stress quartics of known truth: right, quick, small, and the same whoever asks and however often it is killed.

    python -m tests.campaigns.screenings [--rows 500] [--few 200] [--turns 1] [--kills 10] [--seed 1] [--folder F] [--parts truth,...]

Each part prints its lines, and what is wrong ends the command with 1:

truth     all rows with 2 workers: what is wrong or open by an oracle apart, rows a second, the memory of the processes as rows are done
workers   the first --few rows with 1 and 2 workers in turn, --turns times: rows a second and how much faster two are
overhead  what a row costs beside its inquiry: many rows that are answered at once, by the pool of one into a table, and in a plain loop
loop      the first --few rows in a plain loop, against the table
killed    the first --few rows, killed --kills times at moments of chance by SIGTERM, SIGINT and SIGKILL in turn; and workers killed
dask      the first --few rows on clusters of 1, 2 and 4 processes on the loopback address, with one worker killed, with the run killed

Sets and truth stay in --folder, and are made where it has none: 20 ms of processor time each.
"""

from __future__ import annotations

import argparse
import csv
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from pathlib import Path
from statistics import median

import duhem
from duhem.screening import file
from duhem.screening.campaign import Answer, asked
from tests.campaigns.polynomials import PLANE, plane_ray

NAMES = ["a{}{}{}".format(*powers) for powers in PLANE]
SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGKILL)
CAMPAIGN = '[campaign]\nclaims = ["convexity"]\nout = "table.csv"\n[[rows]]\nlaw = "quartic.toml"\ntable = "{}.csv"\n'
AT_ONCE = 5_000  # rows that are answered at once
Table = list[dict[str, str]]


@dataclass(frozen=True)
class AtOnce:
    """An inquiry that costs nothing."""

    names: tuple[str, ...] = ("at once",)
    options: tuple[str, ...] = ()
    alone: bool = False

    def told(self) -> str:
        return "at once"

    def answers(self, law: object) -> Iterator[Answer]:
        yield "at once", "proved", "none", None, None, 0, 0.0


# -- rows and truth ----------------------------------------------------------------------------------------------------


def prepared(folder: Path, rows: int, few: int, seed: int) -> list[bool]:
    """The campaigns all.toml and few.toml in the folder, and whether each set is convex."""
    folder.mkdir(parents=True, exist_ok=True)
    terms = " + ".join(f"{name}*sx**{i}*sy**{j}*t**{k}" for name, (i, j, k) in zip(NAMES, PLANE, strict=True))
    head = f'[criterion]\nname = "quartic"\nforces = ["sx", "sy", "t"]\npressure = false\ng = "{terms} - 1"\n[parameters]\n'
    (folder / "quartic.toml").write_text(head + "".join(f"{name} = {{}}\n" for name in NAMES))
    known = folder / f"sets-{seed}.csv"
    if not known.exists() or known.read_text().count("\n") <= rows:
        with open(known, "w") as stream:
            stream.writelines(f"{','.join(map(str, sets))},{int(convex)}\n" for sets, convex in islice(_sets(seed), rows + 1))
    lines = [line.rpartition(",") for line in known.read_text().splitlines()[:rows]]
    for name, count in (("all", rows), ("few", few)):
        (folder / f"{name}.toml").write_text(CAMPAIGN.format(name))
        (folder / f"{name}.csv").write_text("\n".join([",".join(NAMES), *(sets for sets, _, _ in lines[:count])]) + "\n")
    return [convex == "1" for _, _, convex in lines]


def _sets(seed: int) -> Iterator[tuple[list[object], bool]]:
    with ProcessPoolExecutor() as pool:
        ray = 0
        while True:
            for sets in pool.map(partial(plane_ray, seed), range(ray, ray + 32)):
                yield from (sets_and_truth[:2] for sets_and_truth in sets)
            ray += 32


# -- runs --------------------------------------------------------------------------------------------------------------


def run(folder: Path, rows: str, out: str, *options: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "duhem", "campaign", f"{rows}.toml", "--out", out, *options]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def table(path: Path) -> Table:
    with open(path, newline="") as stream:
        return [{name: value for name, value in line.items() if name != "seconds"} for line in csv.DictReader(stream)]


def done_rows(folder: Path, out: str) -> int:
    """How many rows a run has noted as done."""
    with suppress(OSError, ValueError, IndexError):
        return int((folder / f"{out}.partial").read_text().splitlines()[-1].split()[0])
    return 0


def children(process: int) -> list[int]:
    with suppress(OSError):
        return [int(child) for child in Path(f"/proc/{process}/task/{process}/children").read_text().split()]
    return []


def resident(process: int) -> float:
    """MB."""
    with suppress(OSError, ValueError, IndexError):
        return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    return 0.0


def timed(folder: Path, rows: str, out: str, *options: str, watch: Callable[[int], None] = lambda _: None) -> tuple[float, float]:
    """The seconds of a run, by the clock and of the processor in all of its processes."""
    before, began = os.times(), time.monotonic()
    process = run(folder, rows, out, *options)
    while process.poll() is None:
        watch(process.pid)
        time.sleep(0.1)
    if process.returncode not in (0, 1):
        raise SystemExit(f"{out}: exit code {process.returncode}")
    after = os.times()
    return time.monotonic() - began, after.children_user + after.children_system - before.children_user - before.children_system


# -- parts -------------------------------------------------------------------------------------------------------------


def truth_part(folder: Path, options: argparse.Namespace, truth: list[bool]) -> int:
    sizes, marks = dict[int, tuple[float, float]](), [m for m in (500, 2_000, 5_000, 10_000, 20_000) if m < len(truth)]
    largest = [0.0, 0.0]

    def watch(process: int) -> None:
        now = resident(process), max(map(resident, children(process)), default=0.0)
        largest[:] = map(max, largest, now)
        done = done_rows(folder, "truth.csv")
        for mark in marks:
            if done >= mark and mark not in sizes:
                sizes[mark] = (largest[0], largest[1])

    clock, processor = timed(folder, "all", "truth.csv", "--workers", "2", watch=watch)
    found = table(folder / "truth.csv")
    said = [line["verdict"] for line in found]
    pairs = list(zip(said, truth, strict=True))
    wrong = sum(verdict in ("proved", "refuted") and (verdict == "proved") != convex for verdict, convex in pairs)
    is_open = sum(verdict not in ("proved", "refuted") for verdict in said)
    print(f"truth: {len(said)} rows, {sum(truth)} convex; {dict(Counter(said))}; {wrong} wrong, {is_open} open ({is_open / len(said):.2%})")
    print(f"  {len(said) / clock:.1f} rows a second by the clock, {processor:.0f} s of processor time, load {os.getloadavg()[0]:.1f}")
    sizes[len(said)] = (largest[0], largest[1])
    print("  largest of the run and of its workers so far:", *(f"{n} rows {a:.0f} and {b:.0f} MB;" for n, (a, b) in sizes.items()))
    return wrong


def workers_part(folder: Path, options: argparse.Namespace, truth: list[bool]) -> int:
    rates: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(options.turns):
        for workers in rates:
            clock, processor = timed(folder, "few", f"{workers}.csv", "--workers", f"{workers}")
            rates[workers].append(options.few / clock)
            print(f"workers: {workers}: {options.few / clock:.2f} rows a second, {processor:.1f} s of processor time", flush=True)
    print(f"  two are {max(rates[2]) / max(rates[1]):.2f} times as quick as one; load {os.getloadavg()[0]:.1f}")
    return int(table(folder / "1.csv") != table(folder / "2.csv"))


def overhead_part(folder: Path, options: argparse.Namespace, truth: list[bool]) -> int:
    """By the processor's time of all processes."""
    from tests.campaigns import screenings  # as another process finds the inquiry

    read = file.read(folder / "few.toml")
    many = replace(read, inquiry=screenings.AtOnce(), blocks=read.blocks * -(-AT_ONCE // options.few))

    def spent() -> float:
        now = os.times()
        return now.user + now.system + now.children_user + now.children_system

    took = []
    for rows in (1, len(many)):
        part = many if rows > 1 else replace(many, blocks=(replace(read.blocks[0], text=read.blocks[0].text.partition(b"\n")[0] + b"\n"),))
        before = spent()
        duhem.campaign(part, out=folder / "at_once.csv", workers=1)
        took.append(spent() - before)
    before = spent()
    for number in range(1, len(many) + 1):
        asked(many, number)
    loop = spent() - before
    each = (took[1] - took[0] - loop) / len(many)
    some = []
    for number in range(1, options.few + 1):
        before = time.process_time()
        asked(read, number)
        some.append(time.process_time() - before)
    row = median(some)
    print(
        f"overhead: {1e3 * each:.3f} ms a row beside the {1e3 * loop / len(many):.3f} of a plain loop, by {len(many)} rows answered at once"
    )
    print(f"  it is {each / row:.2%} of the median row, {1e3 * row:.1f} ms of processor time; load {os.getloadavg()[0]:.1f}")
    return int(each > 0.05 * row)


def loop_part(folder: Path, options: argparse.Namespace, truth: list[bool]) -> int:
    read = file.read(folder / "few.toml")
    took, found = list[float](), []
    for number in range(1, options.few + 1):
        before = time.process_time()
        (line,) = asked(read, number)
        took.append(time.process_time() - before)
        found.append([str(value or "") for value in line._replace(seconds=0.0)])
    same = [[line[name] for name in line] for line in right(folder)] == [[*line[:8], line[8] or "0", *line[10:]] for line in found]
    print(f"loop: {'the same' if same else 'DIFFERS'}; {1 / median(took):.1f} rows a second of the processor by the median row", end="")
    print(f", {len(took) / sum(took):.1f} in all; {resident(os.getpid()):.0f} MB")
    return int(not same)


def killed_part(folder: Path, options: argparse.Namespace, truth: list[bool]) -> int:
    times = killed(folder, options, "killed.csv", "--workers", "2")
    same = table(folder / "killed.csv") == right(folder) and not list(folder.glob("killed.csv.*"))
    print(f"killed: the run {times} times: {'the same' if same else 'DIFFERS'}", flush=True)
    chance, ended = random.Random(options.seed), list[int]()

    def watch(process: int) -> None:
        workers = children(process)
        if workers and len(ended) < options.kills and done_rows(folder, "lame.csv") > options.few * len(ended) / (options.kills + 1):
            with suppress(ProcessLookupError):
                os.kill(chance.choice(workers), signal.SIGKILL)
                ended.append(process)

    timed(folder, "few", "lame.csv", "--workers", "2", watch=watch)
    whole = table(folder / "lame.csv") == right(folder)
    print(f"killed: one of its workers {len(ended)} times: {'the same' if whole else 'DIFFERS'}")
    return (not same) + (not whole)


def killed(folder: Path, options: argparse.Namespace, out: str, *more: str) -> int:
    """Kill the campaign after rows drawn by chance until it ends by itself; how often it was."""
    chance = random.Random(options.seed)
    for stale in folder.glob(f"{out}*"):
        stale.unlink()
    for done in range(options.kills + 1):
        process = run(folder, "few", out, "--resume", *more)
        least = options.few * (done + chance.random()) / (options.kills + 1)
        while process.poll() is None:
            if done < options.kills and done_rows(folder, out) > least:
                time.sleep(chance.random())  # what is done is noted once a second: not just after it
                process.send_signal(SIGNALS[done % 3])
                break
            time.sleep(0.05)
        if process.wait() in (0, 1) and (folder / out).exists():  # Python itself ends with 1 where it is killed as it starts
            return done
    raise SystemExit("it does not end")


def dask_part(folder: Path, options: argparse.Namespace, truth: list[bool]) -> int:
    try:
        import distributed  # noqa: F401
    except ImportError:
        print("dask: the extra cluster is not installed")
        return 0
    bad = 0
    for workers in (1, 2, 4):
        with cluster(folder, workers) as (place, _):
            clock, _ = timed(folder, "few", f"dask{workers}.csv", "--scheduler", place)
        same = table(folder / f"dask{workers}.csv") == right(folder)
        print(f"dask: {workers} workers {'the same' if same else 'DIFFER'}, {options.few / clock:.1f} rows a second", flush=True)
        bad += not same
    with cluster(folder, 2) as (place, processes):

        def watch(_: int) -> None:
            if done_rows(folder, "lost.csv") > options.few / 3 and processes[-1].poll() is None:
                processes[-1].kill()

        timed(folder, "few", "lost.csv", "--scheduler", place, watch=watch)
        lost = processes[-1].poll() is not None
        same = lost and table(folder / "lost.csv") == right(folder)
        print(f"dask: one of two workers killed: {'the same' if same else 'DIFFERS'}", flush=True)
    with cluster(folder, 2) as (place, _):
        times = killed(folder, options, "resumed.csv", "--scheduler", place)
        alike = table(folder / "resumed.csv") == right(folder)
        print(f"dask: the run killed {times} times: {'the same' if alike else 'DIFFERS'}")
    return bad + (not same) + (not alike)


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """The file of a scheduler on the loopback address, and its workers, processes of one thread each."""
    place = folder / "scheduler.json"
    place.unlink(missing_ok=True)
    with ExitStack() as stack:

        def started(*arguments: str) -> subprocess.Popen[bytes]:
            command = [sys.executable, "-m", f"distributed.cli.{arguments[0]}", *arguments[1:], "--scheduler-file", str(place)]
            process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            stack.callback(process.wait)
            stack.callback(process.kill)
            return process

        started("dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        while not place.exists():
            time.sleep(0.1)
        options = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory", str(folder), "--host", "127.0.0.1")
        processes = [started("dask_worker", *options) for _ in range(workers)]
        from distributed import Client

        with Client(scheduler_file=str(place), set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=300)
        yield str(place), processes


def right(folder: Path) -> Table:
    """The table of the first rows by the pool of two, asked once."""
    if not (folder / "2.csv").exists():
        timed(folder, "few", "2.csv", "--workers", "2")
    return table(folder / "2.csv")


PARTS = {part.__name__.removesuffix("_part"): part for part in (truth_part, workers_part, overhead_part, loop_part, killed_part, dask_part)}


def main() -> int:
    read = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, usual in (("rows", 500), ("few", 200), ("turns", 1), ("kills", 10), ("seed", 1)):
        read.add_argument(f"--{name}", type=int, default=usual)
    read.add_argument("--folder", type=Path, default=None)
    read.add_argument("--parts", default=",".join(PARTS))
    options = read.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # clusters end with the command
    signal.signal(signal.SIGINT, signal.default_int_handler)  # where it is ignored, as under nohup, runs would ignore it too
    folder = (options.folder or Path(tempfile.mkdtemp(prefix="duhem-screening-"))).absolute()
    options.few = min(options.few, options.rows)
    truth = prepared(folder, options.rows, options.few, options.seed)
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, {folder}", flush=True)
    for stale in folder.glob("[0-9].csv*"):
        stale.unlink()
    return sum(PARTS[part](folder, options, truth) for part in options.parts.split(","))


if __name__ == "__main__":
    sys.exit(main() > 0)
