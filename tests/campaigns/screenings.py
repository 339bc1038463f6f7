"""A campaign of plane-stress quartics of known truth: right, quick, small, and the same however often it is killed.

    python -m tests.campaigns.screenings [ROWS [KILLS [SEED]]]

Rows are asked with 1 and 2 workers, in a plain loop, and once more killed after a random number of rows, KILLS times.  Prints what is
wrong or open by an oracle apart, rows a second, the processor's seconds of all processes, the memory of the largest, and whether the
tables are the same but for the seconds.
"""

from __future__ import annotations

import csv
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from statistics import median

from duhem.screening import file
from duhem.screening.lines import asked
from tests.campaigns.polynomials import PLANE, plane_sets

NAMES = ["a{}{}{}".format(*powers) for powers in PLANE]
SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGKILL)
CAMPAIGN = '[campaign]\nclaims = ["convexity"]\nout = "table.csv"\n[[rows]]\nlaw = "quartic.toml"\ntable = "sets.csv"\n'


def prepared(rows: int, seed: int) -> tuple[Path, list[bool]]:
    """The folder of the campaign, and whether each set is convex."""
    folder, truth = Path(tempfile.mkdtemp(prefix="duhem-screening-")), []
    terms = " + ".join(f"{name}*sx**{i}*sy**{j}*t**{k}" for name, (i, j, k) in zip(NAMES, PLANE, strict=True))
    head = f'[criterion]\nname = "quartic"\nforces = ["sx", "sy", "t"]\npressure = false\ng = "{terms} - 1"\n[parameters]\n'
    (folder / "quartic.toml").write_text(head + "".join(f"{name} = {{}}\n" for name in NAMES))
    (folder / "campaign.toml").write_text(CAMPAIGN)
    with open(folder / "sets.csv", "w") as sets:
        sets.write(",".join(NAMES) + "\n")
        for trial in plane_sets(rows, seed):
            poly = trial.law.g.as_poly(*trial.law.force_symbols())
            sets.write(",".join(str(poly.coeff_monomial(powers)) for powers in PLANE) + "\n")
            truth.append(trial.truth["convexity"])
    return folder, truth


def run(folder: Path, out: str, *options: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "duhem", "campaign", "campaign.toml", "--out", out, *options]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def table(path: Path) -> list[dict[str, str]]:
    with open(path, newline="") as stream:
        return [{name: value for name, value in line.items() if name != "seconds"} for line in csv.DictReader(stream)]


def seconds(path: Path) -> list[float]:
    with open(path, newline="") as stream:
        return [float(line["seconds"]) for line in csv.DictReader(stream)]


def killed(folder: Path, rows: int, kills: int, chance: random.Random) -> int:
    """Kill the campaign after rows drawn by chance until it ends by itself; how often it was."""
    for done in range(kills + 1):
        process = run(folder, "killed.csv", "--resume", "--workers", "2")
        grown, least = folder / "killed.csv.partial.rows", rows * (done + chance.random()) / (kills + 1)
        while process.poll() is None and done < kills:
            if grown.exists() and grown.read_bytes().count(b"\n") > least:
                process.send_signal(SIGNALS[done % 3])
                break
            time.sleep(0.05)
        if process.wait() in (0, 1):
            return done
    raise SystemExit("it does not end")


def main(rows: int = 500, kills: int = 10, seed: int = 1) -> int:
    folder, truth = prepared(rows, seed)
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    for workers in (1, 2):
        began = time.monotonic()
        process = run(folder, f"{workers}.csv", "--workers", f"{workers}")
        _, code, used = os.wait4(process.pid, 0)
        took = time.monotonic() - began
        each = seconds(folder / f"{workers}.csv")
        print(f"{workers} workers: {rows / took:.2f} rows a second, exit code {code >> 8}, load {os.getloadavg()[0]:.1f}; ", end="")
        print(f"its processes took {used.ru_utime + used.ru_stime:.2f} s, the largest {used.ru_maxrss / 1024:.0f} MB", end="")
        print(f"; median of a claim {median(each):.4f} s")
    first, second = table(folder / "1.csv"), table(folder / "2.csv")
    said = [line["verdict"] for line in first]
    wrong = sum(verdict in ("proved", "refuted") and (verdict == "proved") != convex for verdict, convex in zip(said, truth, strict=True))
    print(f"{Counter(said)}; {wrong} wrong; 1 and 2 workers {'the same' if first == second else 'DIFFER'}")
    campaign = file.read(folder / "campaign.toml")
    began = time.process_time()
    plain = [asked(campaign, number) for number in range(1, rows + 1)]
    print(f"in a plain loop {rows / (time.process_time() - began):.2f} rows a second of the processor, ", end="")
    print(f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")
    alike = [line[0].verdict for line in plain] == said and [line[0].witness or "" for line in plain] == [line["witness"] for line in first]
    times = killed(folder, rows, kills, random.Random(seed)) if kills else 0
    same = not kills or (table(folder / "killed.csv") == first and not list(folder.glob("killed.csv.*")))
    print(f"the loop {'the same' if alike else 'DIFFERS'}; killed {times} times: {'the same' if same else 'DIFFERS'}")
    return wrong + (first != second) + (not alike) + (not same)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])) > 0)
