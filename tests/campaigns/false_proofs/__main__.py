"""Laws built to deceive, of known truth: six families, after the causes of the false proofs that were once found.

    python -m tests.campaigns.false_proofs 2000
    python -m tests.campaigns.false_proofs 300 --family maps --seed 2 --first 120
    python -m tests.campaigns.false_proofs 300 --alone

Each is verified in a process of its own, with a minute of processor time.  A wrong verdict is printed with the criterion file.
``--alone``: every method of a false claim is asked by itself instead, so that no refuter hides what it would say.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Sequence
from itertools import islice

from tests.campaigns.false_proofs.judge import Answered, judge, judge_alone, judge_apart
from tests.campaigns.false_proofs.table import FAMILIES, traps


def table(judged: Sequence[tuple[str, Answered]]) -> str:
    """Per family: laws, claims, wrong, the share left open, crashes, hangs, seconds."""
    lines = [f"{'family':10} {'laws':>5} {'claims':>7} {'wrong':>6} {'open %':>7} {'crashes':>8} {'hangs':>6} {'seconds':>8}"]
    for family in [*FAMILIES, "all"]:
        mine = [j for name, j in judged if family in (name, "all")]
        said = [text for j in mine for text in j.claims.values()]
        share = 100 * said.count("open") / max(len(said), 1)
        hangs = sum(j.failed == "hang" for j in mine)
        counts = f"{len(mine):5} {len(said):7} {sum(len(j.wrong) for j in mine):6} {share:7.1f}"
        crashes = sum(bool(j.failed) for j in mine) - hangs
        lines.append(f"{family:10} {counts} {crashes:8} {hangs:6} {sum(j.seconds for j in mine):8.0f}")
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign and print its table; 1 if anything is wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.false_proofs", description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("count", type=int, nargs="?", default=2000)
    parser.add_argument("--family", action="append", choices=tuple(FAMILIES), help="only this one; may be repeated")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="leave out what comes before this place")
    parser.add_argument("--alone", action="store_true", help="ask each method by itself")
    asked = parser.parse_args(arguments)
    judged: list[tuple[str, Answered]] = []
    kinds: Counter[str] = Counter()
    families = tuple(asked.family or FAMILIES)
    for place, (family, trap) in enumerate(islice(traps(asked.count, families, asked.seed), asked.first, None), asked.first):
        found = judge_apart(trap, judge_alone if asked.alone else judge)
        judged.append((family, found))
        for claim, text in ({"law": found.failed} if found.failed else found.wrong).items():
            kinds[f"{family}, {claim}, {text.split(':')[0]}"] += 1
            print(f"WRONG {family} {place} {claim}: {text}\n{trap.toml()}", flush=True)
        if len(judged) % 100 == 0:
            print(table(judged), flush=True)
    print(table(judged))
    print(*(f"{n:5} {kind}" for kind, n in kinds.most_common()), sep="\n")
    return int(bool(kinds))


if __name__ == "__main__":
    sys.exit(main())
