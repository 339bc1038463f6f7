"""Each replay file fails with the bug and passes without: python -m tests.campaigns.replays [NAME ...]

Of each wrong routine of tests/oracles/mutant_routines.py, and of the shipped examples in C and Fortran with each of their bugs (of those
whose name contains a NAME), the first failure is written as a test file.  pytest runs all files as they stand: with the bugs, and with the
right routine or library in their place.  A row each: its check, how many numbers of the increment are not round (of more than two
digits), and what came of either run.  1 where one does not fail with its bug, or fails without, or has more than three such numbers;
of a failure of which no single increment shows anything, or without a law, where increments are not made round, the numbers do not count.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import duhem
from duhem.testing import Update, conformance, projection
from duhem.testing.failures.failure import Failure
from tests.campaigns.routines import compiled, found
from tests.oracles.mutant_routines import MUTANTS
from tests.oracles.round_numbers import unrounded
from tests.testing.examples import EXAMPLES, library

__all__ = ["of_mutant"]

_RIGHT = "DUHEM_REPLAYS_OF_THE_RIGHT"
_MOST = 3  # numbers that are not round
_SOURCES = {"friction": "friction.c", "mises": "mises.c", "interface": "interface.f90"}


def of_mutant(name: str) -> Update:
    """A wrong routine, or the right one in its place, under a name that a replay imports."""
    (mutant,) = (m for m in MUTANTS if m.name == name)
    right = projection(duhem.load(mutant.law).fix(mutant.values), tangent=True) if _RIGHT in os.environ else None
    routine = mutant.routine() if right is None else right

    def update(*given: object) -> object:
        return routine(*given)

    update.__qualname__ = re.sub(r"\W+", "_", name)
    update.__duhem_import__ = f"from tests.campaigns.replays import of_mutant\n\nupdate = of_mutant({name!r})"  # type: ignore[attr-defined]
    return update  # type: ignore[return-value]


def failures(names: Sequence[str]) -> Iterator[tuple[str, Failure]]:
    """The first failure of each."""
    for mutant in MUTANTS:
        if not names or any(name in f"{mutant.kind}: {mutant.name}" for name in names):
            yield mutant.name, found(mutant, of_mutant(mutant.name)).failures[0]
    for _, name, bug, _ in compiled(names):
        yield f"{name}, bug {bug}", conformance(None, **EXAMPLES[name](bug), max_examples=3, rows=12, seed=1).failures[0]


def outcomes(folder: Path, **environment: str) -> dict[str, str]:
    """What pytest says of each file."""
    command = [sys.executable, "-m", "pytest", "-q", "--tb=no", "-rA", "-p", "no:cacheprovider", "-p", "no:randomly", "."]
    done = subprocess.run(command, cwd=folder, env=os.environ | environment, capture_output=True, text=True)
    return {file: what for what, file in re.findall(r"^(PASSED|FAILED|ERROR) (\w+\.py)", done.stdout, re.MULTILINE)}


def main(names: Sequence[str]) -> int:
    """The table."""
    with TemporaryDirectory() as made:
        folder, rows = Path(made), []
        for number, (name, failure) in enumerate(failures(names)):
            there = folder / f"test_{number}_{re.sub(r'[^a-z]+', '_', failure.check.name)}.py"
            there.write_text(failure.replay(folder.resolve()), "utf-8")
            rows.append((name, failure, there.name))
        wrong = outcomes(folder)
        for _, name, bug, _ in compiled(names):
            mended = library(_SOURCES[name]).with_suffix(".mended")
            shutil.copy(library(_SOURCES[name]), mended)
            os.replace(mended, library(_SOURCES[name], bug))
        right = outcomes(folder, **{_RIGHT: "1"})
    bad = 0
    print("| routine | check | numbers not round | with the bug | without |\n|---|---|---|---|---|")
    for name, failure, file in rows:
        count = None if not failure.alone or failure.law is None else unrounded(failure.case)
        good = (wrong.get(file), right.get(file)) == ("FAILED", "PASSED") and (count is None or count <= _MOST)
        bad += not good
        numbers = "-" if count is None else count
        print(f"| {name} | {failure.check.name} | {numbers} | {wrong.get(file, '-')} | {right.get(file, '-')} |{'' if good else ' NOT SO'}")
    print(f"{len(rows)} replays, {bad} not so")
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
