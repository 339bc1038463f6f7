"""Right routines of ten laws with a state and of twenty without: none may be accused.

    python -m tests.campaigns.false_alarms [--seeds 3] [--examples 2000] [--name NAME ...]

Each is put to all its checks in so many cases of ten increments or histories for each seed.  All come by turns, a hundred cases each, so
that a run that is ended early has asked all of them alike; the line of a round says how far it came.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from functools import partial
from typing import Any

import duhem
from duhem.testing import projection
from duhem.testing.conformance import conformance
from tests.campaigns.routines import first_cause
from tests.testing.atlas_materials import material
from tests.testing.hardening import KINDS, hardening
from tests.testing.test_properties import ACCURACY, ALWAYS, of, without_reason

_ROUND = 100  # cases
_STATES = ("armstrong-frederick-recall", "at1-damage", "chaboche", "perzyna")


def _of_kind(kind: str) -> dict[str, Any]:
    law, routine, parameters = hardening(kind)
    return {"law": law, "update": routine, "parameters": parameters}


def _without_state(name: str, values: dict[str, str], method: str) -> dict[str, Any]:
    law = duhem.load(name).fix(values)
    return {"law": law, "update": projection(law, method), "accuracy": of(ACCURACY, method)}


_METHODS = [(name, values, method) for method in ("closed-form", "newton") for name, values in ALWAYS]
_APPLY = [each for each in _METHODS if without_reason(duhem.load(each[0]).fix(each[1]), each[2]) is None][:20]
ROUTINES: dict[str, Callable[[], dict[str, Any]]] = {
    **{f"hardening, {kind}": partial(_of_kind, kind) for kind in KINDS},
    **{name: partial(material, name) for name in _STATES},
    **{f"{each[0]}, {each[2]}": partial(_without_state, *each) for each in _APPLY},
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--examples", type=int, default=2000)
    parser.add_argument("--name", action="append", choices=[*ROUTINES])
    asked = parser.parse_args()
    made, alarms, increments = {name: ROUTINES[name]() for name in asked.name or ROUTINES}, 0, 0
    rounds = [(seed, begun) for begun in range(0, asked.examples, _ROUND) for seed in range(asked.seeds)]
    for n, (seed, begun) in enumerate(rounds, 1):
        for name, given in made.items():
            many = min(_ROUND, asked.examples - begun)
            report = conformance(**given, max_examples=many, rows=10, seed=asked.examples * seed + begun)
            increments += report.points
            if not report.ok:
                alarms += 1
                print(f"ACCUSED {name}: {first_cause(report)}: {report}", flush=True)
            elif n == 1:
                print(f"{name}: {len(report.passed)} checks pass, slip {report.visited['slip']:.2f}", flush=True)
        print(f"round {n} of {len(rounds)}: {len(made)} routines, {increments:,} increments, {alarms} false alarms", flush=True)
    return int(alarms > 0)


if __name__ == "__main__":
    sys.exit(main())
