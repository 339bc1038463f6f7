"""Whole-process time of `duhem verify antoni2007` beside `import sympy`, in alternation so that drift hits both alike.

Run it with `python -m tests.campaigns.startup [ROUNDS]`; pytest does not collect it.
"""

import statistics
import subprocess
import sys
import time

COMMANDS = {
    "python -c 'import sympy'": [sys.executable, "-c", "import sympy"],
    "duhem --help": [sys.executable, "-m", "duhem", "--help"],
    "duhem verify antoni2007": [sys.executable, "-m", "duhem", "verify", "antoni2007"],
}


def seconds(command: list[str]) -> float:
    """Wall-clock time of one process, which must succeed."""
    start = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
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
    print(f"{'command':26} {'min':>7} {'median':>7} {'max':>7}   ratio   ({rounds} rounds, seconds)")
    for name, row in times.items():
        ratio = statistics.median(a / b for a, b in zip(row, base, strict=True))
        print(f"{name:26} {min(row):7.3f} {statistics.median(row):7.3f} {max(row):7.3f} {ratio:7.2f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
