"""Mistakes in a UMAT with a state, and right ones: which are found and named, and that no right one is accused.

    python -m tests.campaigns.state_mutants [EXAMPLES [NUMBER ...]]

Each mistake of tests/testing/hardening.c is held to its law in so many cases of ten histories (200 if left out, until it is found); right
routines of all kinds follow in as many, with three seeds each, and duhem's own step of each law of the atlas with a state.
"""

from __future__ import annotations

import sys
from time import monotonic

from duhem.testing import conformance
from tests.testing.atlas_materials import NAMES, material
from tests.testing.hardening import KINDS, MISTAKES, PAIRS, hardening


def main(examples: int, numbers: list[int]) -> None:
    found = named = 0
    for number in numbers or [*MISTAKES]:
        kind, words = MISTAKES[number]
        begun = monotonic()
        report = conformance(*hardening(kind, number), max_examples=examples, rows=10, tries=20, seed=1)
        first = next(iter(report.failures), None)
        told = "" if first is None else first.diagnosis or first.message
        found, named = found + (not report.ok), named + (words in told)
        mark = "" if words in told else "NOT NAMED " if first is not None else "NOT FOUND "
        print(
            f"{mark}{number} ({kind}, {monotonic() - begun:.1f} s): {'' if first is None else first.check.name}: {told[:160]}", flush=True
        )
    print(f"{found} of {len(numbers or MISTAKES)} found, {named} named as the first cause")
    both = 0
    for kind, one, other in () if numbers else PAIRS:
        report = conformance(*hardening(kind, one, other), max_examples=min(examples, 40), rows=10, tries=20, seed=1)
        told = " ".join(str(failure) for failure in report.failures)
        lost = [number for number in (one, other) if MISTAKES[number][1].split(", not ")[0] not in told]
        both += not lost
        print(f"{one} and {other} ({kind}): {f'{lost} not named: ' if lost else 'both named: '}", end="")
        print("; ".join(f"{f.check.name}: {' or '.join(f.diagnoses.values())[:120]}" for f in report.failures), flush=True)
    print(f"of {len(PAIRS)} pairs both are named in {both}")
    alarms = 0
    for kind in () if numbers else KINDS:
        for seed in range(3):
            report = conformance(*hardening(kind), max_examples=examples, rows=10, seed=seed)
            alarms += not report.ok
            print(f"{kind}, seed {seed}: {sorted(report.failed) or 'passes'}", flush=True)
    for name in () if numbers else NAMES:
        report = conformance(**material(name), max_examples=examples, rows=10, seed=0)
        alarms += not report.ok
        print(f"{name}: {sorted(report.failed) or 'passes'}", flush=True)
    print(f"{alarms} false alarms")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200, [int(x) for x in sys.argv[2:]])
