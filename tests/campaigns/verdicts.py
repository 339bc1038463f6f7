"""Laws of known truth, generated from a seed, and what duhem says of them.

The truth is decided by each family (tests/campaigns/families) in exact rational arithmetic from its geometry: real roots
counted for curves, vertices and areas for polygons, a distance for ellipses.  Nothing of duhem takes part in it.

    python -m tests.campaigns.verdicts --count 500 --seed 1
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from duhem import Verdict, Verification, verify
from tests.campaigns.families.table import FAMILIES, trials
from tests.campaigns.families.trial import Trial
from tests.oracles.reevaluation import confirmed

__all__ = ["Outcome", "judge"]


@dataclass(frozen=True)
class Outcome:
    """One law's result: per claim ``right``, ``open`` or a sentence saying what is wrong."""

    trial: Trial
    claims: Mapping[str, str]
    seconds: float
    said: Mapping[str, str] = field(default_factory=dict)

    @property
    def wrong(self) -> dict[str, str]:
        """Claims answered against the truth, or refuted by a witness that does not hold."""
        return {c: text for c, text in self.claims.items() if text not in ("right", "open")}


def _compared(trial: Trial, found: Verification, claim: str) -> str:
    result, true = found[claim], trial.truth[claim]
    if result.verdict is Verdict.PROVED:
        return "right" if true else f"proved by {result.method} although false"
    if result.verdict is Verdict.REFUTED:
        assert result.witness is not None
        if true:
            holds = "holds here too: is the truth right?" if confirmed(trial.law, claim, result.witness) else "does not re-evaluate"
            return f"refuted by {result.method} although true; the witness {holds}"
        return "right" if confirmed(trial.law, claim, result.witness) else f"the witness of {result.method} does not re-evaluate"
    return "open"


def judge(trial: Trial) -> Outcome:
    """Verify the trial's law and compare every claim of known truth; re-evaluate every witness."""
    start = time.perf_counter()
    found = verify(trial.law, claims=trial.truth)
    seconds = time.perf_counter() - start
    said = {r.claim: f"{r.verdict.value} ({r.method})" for r in found.results}
    return Outcome(trial, {claim: _compared(trial, found, claim) for claim in trial.truth}, seconds, said)


def _table(outcomes: Sequence[Outcome]) -> str:
    head = f"{'family':18} {'laws':>5} {'claims':>7} {'right':>6} {'open':>5} {'open %':>7} {'wrong':>6} {'slowest s':>10} {'total s':>8}"
    lines = [head, "-" * len(head)]
    for family in [*FAMILIES, "all"]:
        mine = [o for o in outcomes if family in ("all", o.trial.family)]
        marks = [text for o in mine for text in o.claims.values()]
        right, left_open = marks.count("right"), marks.count("open")
        slowest, total = max((o.seconds for o in mine), default=0.0), sum(o.seconds for o in mine)
        share = 100 * left_open / len(marks) if marks else 0.0
        counts = f"{len(mine):5} {len(marks):7} {right:6} {left_open:5} {share:7.1f} {len(marks) - right - left_open:6}"
        lines.append(f"{family:18} {counts} {slowest:10.2f} {total:8.1f}")
    return "\n".join(lines)


def _open_by_claim(outcomes: Sequence[Outcome]) -> str:
    counts: dict[str, int] = {}
    for o in outcomes:
        for claim, text in o.claims.items():
            if text == "open":
                key = f"{o.trial.family}, {claim} {'true' if o.trial.truth[claim] else 'false'}, {o.trial.margin}"
                counts[key] = counts.get(key, 0) + 1
    return "\n".join(f"  {n:4} open: {key}" for key, n in sorted(counts.items(), key=lambda item: -item[1]))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign and print its table; 1 if anything is wrong."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--slow", type=float, default=10.0, help="name laws that take longer than this many seconds")
    asked = parser.parse_args(arguments)
    outcomes = []
    for trial in trials(asked.count, asked.seed):
        outcome = judge(trial)
        outcomes.append(outcome)
        for claim, text in outcome.wrong.items():
            print(f"WRONG {trial.law.name} {claim}: {text}\n      g = {trial.law.g}", flush=True)
        if outcome.seconds > asked.slow:
            print(f"slow  {trial.law.name}: {outcome.seconds:.1f} s, {dict(outcome.said)}\n      g = {trial.law.g}", flush=True)
    print(_table(outcomes))
    print(_open_by_claim(outcomes))
    return int(any(o.wrong for o in outcomes))


if __name__ == "__main__":
    sys.exit(main())
