"""Whole-process time of `duhem verify antoni2007` and of a first compiled increment, whose code is on disk, beside `import sympy`.

In alternation, so that drift hits all alike.  duhem's own bytecode is kept, as it is where it was installed.

Run it with `python -m tests.campaigns.startup [ROUNDS]`; pytest does not collect it.
"""

import os
import statistics
import subprocess
import sys
import time

FIRST = """
import numpy as np
import duhem
trial = np.random.default_rng(0).normal(size=(5000, 3))
duhem.project("von-mises", trial, None, parameters={"yield_stress": 0.3}, compiled=True)
"""
COMMANDS = {
    "python -c 'import sympy'": [sys.executable, "-c", "import sympy"],
    "duhem --help": [sys.executable, "-m", "duhem", "--help"],
    "duhem verify antoni2007": [sys.executable, "-m", "duhem", "verify", "antoni2007"],
    "import of numba and sympy": [sys.executable, "-c", "import numba, numpy, sympy"],
    "a first increment of newton": [sys.executable, "-c", FIRST],
}


def seconds(command: list[str]) -> float:
    """Wall-clock time of one process, which must succeed."""
    start = time.perf_counter()
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=kept)
    return time.perf_counter() - start


def main(rounds: int = 15) -> None:
    """Print least, median and greatest time of each command, and the median ratio to the first."""
    for command in COMMANDS.values():
        seconds(command)  # compiles bytecode, fills the page cache
    times: dict[str, list[float]] = {name: [] for name in COMMANDS}
    for _ in range(rounds):
        for name, command in COMMANDS.items():
            times[name].append(seconds(command))
    base = next(iter(times.values()))
    print(f"{'command':28} {'min':>7} {'median':>7} {'max':>7}   ratio   ({rounds} rounds, seconds)")
    for name, row in times.items():
        ratio = statistics.median(a / b for a, b in zip(row, base, strict=True))
        print(f"{name:28} {min(row):7.3f} {statistics.median(row):7.3f} {max(row):7.3f} {ratio:7.2f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
