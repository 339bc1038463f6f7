"""Laws of known truth in two to six forces, and what duhem says of them: python -m tests.campaigns.spaces [COUNT [SEED]]

Prints what is wrong or open, and a line a family with the processor time of the verdicts.
"""

from __future__ import annotations

import random
import sys
import time
from itertools import cycle, islice
from statistics import median

from tests.campaigns.families.spaces import SPACES
from tests.campaigns.verdicts import judge


def main(count: int = 600, seed: int = 1) -> int:
    """Run the campaign; 1 if anything is wrong."""
    marks, seconds = dict[str, list[str]](), dict[str, list[float]]()
    for place, family in enumerate(islice(cycle(SPACES), count)):
        trial = SPACES[family](random.Random(f"{seed}/{family}/{place}"), f"law-{place}")
        start = time.process_time()
        found = judge(trial)
        seconds.setdefault(trial.family, []).append(time.process_time() - start)
        marks.setdefault(trial.family, []).extend(found.claims.values())
        for claim, text in found.claims.items():
            if text != "right":
                print(
                    f"{text}: {trial.family}, {trial.margin}, {claim} {trial.truth[claim]}, {found.said[claim]}: {trial.law.g}"[:400],
                    flush=True,
                )
    for family in sorted(marks):
        said, times = marks[family], seconds[family]
        right, left = said.count("right"), said.count("open")
        print(
            f"{family:26} {len(times):4} laws {len(said):5} claims {right:5} right {left:4} open {len(said) - right - left:3} wrong"
            f"   median {median(times):.2f} s, most {max(times):.2f}"
        )
    every, all_times = [m for each in marks.values() for m in each], [t for each in seconds.values() for t in each]
    left, wrong = every.count("open"), sum(m not in ("right", "open") for m in every)
    share = f"{100 * left / len(every):.1f} % open"
    print(f"{len(all_times)} laws, {len(every)} claims, {share}, {wrong} wrong, median {median(all_times):.2f} s")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
