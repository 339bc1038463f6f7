"""A campaign of a routine among whose rows are poisoned ones: every row comes back, the others as if they were alone.

    python -m tests.campaigns.poisoned [--rows 1000] [--poisoned 24] [--workers 2] [--seed 1]

Poisoned are rows for which the routine never returns, asks for 40 GB or writes where it may not; rows that crash what asks them, by an
error or with their process; values and laws of malformed text.  It prints how many rows of each kind came back and why, and ends with 1
where a row is lost, doubled, without its reason or, of the others, not as in a plain loop.
"""

from __future__ import annotations

import argparse
import ctypes
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle, islice
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

import duhem
from duhem.law.curve_law import Law
from duhem.screening import file, pool
from duhem.screening.campaign import Answer, Campaign, VerdictLine, asked
from duhem.testing import RoutineChecks

__all__ = ["REASONS", "campaign", "faults"]

# What each kind of row says, by the friction that makes it; of malformed ones, by what stands in its place.
REASONS = {
    "0.11": "it needs more than 1 s of processor time",
    "0.12": "it needs more than 4 GB of memory",
    "0.13": "its process ended by SIGSEGV",
    "0.14": "ZeroDivisionError: of the law (at poisoned.py",
    "0.15": "its process ended by SIGABRT",
    "O.3": "'O.3' is not a number",
    "": "'' is not a number",
    "broken.toml": "broken.toml:2",
}
CAMPAIGN = """\
[campaign]
ask = "checks"
seconds = 1
[[rows]]
law = "coulomb"
table = "frictions.csv"
{laws}
[checks]
checks = ["feasibility"]
examples = 2
"""


def routine(trial: Any, pressure: Any, stiffness: Any, mu: float) -> Any:
    """The closest point for any multiple of one stiffness; of some frictions, none."""
    match round(100.0 * mu):
        case 11:
            while True:
                pass
        case 12:
            bytearray(40 * 10**9)
        case 13:
            ctypes.memset(0, 1, 1)
    size, limit = np.linalg.norm(trial, axis=1), mu * np.abs(pressure)
    return trial * np.divide(limit, size, out=np.ones_like(size), where=size > limit)[:, None]


@dataclass(frozen=True)
class Crashing:
    """What is asked, and crashes for some laws before the routine has its turn; not ``alone``, so that a crash has rows to harm."""

    inquiry: RoutineChecks
    options: tuple[str, ...] = ()
    alone: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        return self.inquiry.names

    def told(self) -> str:
        return f"crashing {self.inquiry.told()}"

    def answers(self, law: Law) -> Iterator[Answer]:
        match round(100.0 * float(law.parameters["mu"].value)):
            case 14:
                raise ZeroDivisionError("of the law")
            case 15:
                ctypes.CDLL(None).abort()
        return self.inquiry.answers(law)


def _crashing(given: str, **options: Any) -> Crashing:
    from tests.campaigns import poisoned  # as another process finds it

    return poisoned.Crashing(RoutineChecks(given, **options))


def campaign(folder: Path, rows: int, kinds: Sequence[str], seed: int = 1) -> tuple[Campaign, list[str]]:
    """So many rows, with poisoned ones of these kinds at places of chance, and the friction of each row as it is written."""
    chance = random.Random(seed)
    broken = [kind for kind in kinds if kind == "broken.toml"]
    written = [kind for kind in kinds if kind not in broken]
    frictions = [*written, *(f"{chance.randint(200, 999) / 1000}" for _ in range(rows - len(kinds)))]
    chance.shuffle(frictions)
    (folder / "frictions.csv").write_text("".join(f"{line}\n" for line in ("mu", *(f'"{each}"' for each in frictions))))
    (folder / "broken.toml").write_text("[criterion]\nname =")
    text = CAMPAIGN.format(laws='[[rows]]\nlaws = ["broken.toml"]\n' * len(broken))
    asked_of_rows = file.reads(text, folder=folder, routine="tests.campaigns.poisoned:routine", checks=_crashing)
    return asked_of_rows, [*frictions, *broken]


def faults(asked_rows: Campaign, written: list[str], lines: tuple[VerdictLine, ...], every: int) -> list[str]:
    """What is wrong with the lines; of the rows that are not poisoned each so many are asked again in a plain loop."""
    found = []
    if [line.row for line in lines] != [row for row in range(1, len(written) + 1) for _ in asked_rows.inquiry.names]:
        found.append("rows are lost or doubled")
    sound = 0
    for line in lines:
        kind = written[line.row - 1]
        if kind in REASONS:
            if line.verdict is not None or REASONS[kind] not in (line.error or ""):
                found.append(f"row {line.row}, {kind!r}: {line.verdict}, {line.error}")
        elif line.verdict != "passed" or line.error is not None:
            found.append(f"row {line.row}, {kind!r}: {line.verdict}, {line.error}")
        else:
            sound += 1
            if sound % every == 1 and line._replace(seconds=0.0) not in [one._replace(seconds=0.0) for one in asked(asked_rows, line.row)]:
                found.append(f"row {line.row} is another in a plain loop")
    return found


def main() -> int:
    read = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, usual in (("rows", 1000), ("poisoned", 24), ("workers", 2), ("seed", 1)):
        read.add_argument(f"--{name}", type=int, default=usual)
    options = read.parse_args()
    with tempfile.TemporaryDirectory(prefix="duhem-poisoned-") as folder, patch.object(pool, "_WAITED", 1_000.0):
        kinds = list(islice(cycle(REASONS), options.poisoned))
        asked_rows, written = campaign(Path(folder), options.rows, kinds, options.seed)
        began = time.monotonic()
        lines = duhem.campaign(asked_rows, workers=options.workers).lines
    print(f"{len({line.row for line in lines})} of {len(written)} rows came back, in {time.monotonic() - began:.0f} s, with")
    last = len(asked_rows.inquiry.names)
    for (kind, said), count in sorted(Counter((written[line.row - 1], line.error) for line in lines[::last] if line.error).items()):
        print(f"  {count:3} of mu = {kind!r:7} {said}")
    found = faults(asked_rows, written, lines, 10)
    print(*found or [f"none is wrong; {sum(line.error is None for line in lines[::last])} passed"], sep="\n")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
