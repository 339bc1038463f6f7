"""Every built-in law on its extreme cases, all methods: python -m tests.campaigns.extremes [LAW ...] [--every 3] [--peers]

Each answer is held against many digits (``duhem stress``).  What is printed by law and method: points, those that are flagged, and those
that are wrong without a flag, in stress and in slip; then the cases that have no reference, and why.  Exit code 1 where duhem's own
methods are silently wrong in a stress.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import duhem
from duhem.benchmark.contenders import PEERS
from duhem.benchmark.extreme_cases import AXES, ExtremeCases, stress
from duhem.law.formula_law import Criterion

# Parameters at which K is convex, unlike each other where there are two.
CONVEX = {
    "antoni2007": {"mu_a_plus": "0.2", "mu_a_minus": "0.08", "mu_b_plus": "0.12", "mu_b_minus": "0.15"},
    "antoni2007-1d": {"mu_plus": "0.2", "mu_minus": "0.1"},
    "box": {"mu_a": "0.5", "mu_b": "0.25"},
    "capped": {"mu": "0.5", "tau_max": "0.3"},
    "cohesive": {"mu": "0.3", "cohesion": "0.1"},
    "coulomb": {"mu": "0.3"},
    "drucker1949": {"k": "1", "c": "2"},
    "hosford": {"yield_stress": "1", "m": "6"},
    "limacon": {"mu": "0.3", "e": "0.3"},
    "lobes": {"mu": "0.3", "e": "0.1"},
    "matchstick": {"mu_a": "0.3", "mu_b": "0.25"},
    "orthotropic": {"mu_a": "0.3", "mu_b": "0.1"},
    "polygon": {"mu": "0.3"},
    "quartic": {"mu": "0.3", "c": "1"},
    "regularised": {"mu": "0.3", "c": "0.1"},
    "shifted-ellipse": {"mu_a": "0.3", "mu_b": "0.2", "shift": "0.05"},
    "superellipse": {"mu_a": "0.3", "mu_b": "0.2", "p": "4"},
    "tresca": {"yield_stress": "1"},
    "von-mises": {"yield_stress": "1"},
}


def law(name: str) -> Criterion:
    """The law at the parameters above."""
    found = duhem.load(name)
    assert isinstance(found, Criterion)
    return found.fix(CONVEX[name])


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("laws", nargs="*", metavar="LAW")
    parser.add_argument("--axis", action="append", choices=list(AXES))
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--peers", action="store_true")
    given = parser.parse_args(arguments)
    wrong = False
    for name in given.laws or CONVEX:
        result = stress(law(name), axes=given.axis or tuple(AXES), every=given.every, peers=given.peers)
        print(f"{name}: reference to {result.reference:.0e}")
        print("\n".join(lines(result)), flush=True)
        own = result.silently_wrong.keys() - {peer.method.name for peer in PEERS}
        wrong |= any(result.silently_wrong[method][0] for method in own)
    return int(wrong)


def lines(result: ExtremeCases) -> list[str]:
    """A line for each method, and one for each case that is left out for want of a reference."""
    found = []
    for method, (wrong_stress, wrong_slip) in result.silently_wrong.items():
        rows = [row for row in result.rows if row.method == method]
        points, flagged = sum(row.points for row in rows), sum(row.flagged for row in rows)
        found.append(f"  {method:24} {points:5} points, {flagged:4} flagged, silently wrong: stress {wrong_stress}, slip {wrong_slip}")
    return [*found, *(f"  {part}" for part in result.left_out if "no reference" in part.reason)]


if __name__ == "__main__":
    raise SystemExit(main())
