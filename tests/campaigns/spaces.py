"""Laws of known truth in two to six forces, and what duhem says of them: python -m tests.campaigns.spaces [COUNT [SEED]]

Prints what is wrong or open, and a line a family with the processor time of the verdicts.  Each law has a process of its own,
with two minutes of processor time.
"""

from __future__ import annotations

import random
import resource
import sys
import time
from itertools import cycle, islice
from multiprocessing import get_context
from multiprocessing.connection import Connection
from statistics import median

from tests.campaigns.families.spaces import SPACES
from tests.campaigns.families.trial import Trial
from tests.campaigns.verdicts import judge

_SECONDS = 120


def _judged(trial: Trial, there: Connection) -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (_SECONDS, _SECONDS + 1))
    start = time.process_time()
    try:
        found = judge(trial)
        there.send((dict(found.claims), dict(found.said), time.process_time() - start))
    except Exception as fault:
        there.send(({"law": f"{type(fault).__name__}: {fault}"}, {}, time.process_time() - start))


def _apart(trial: Trial) -> tuple[dict[str, str], dict[str, str], float]:
    """What is said of each claim, right, open or wrong, and how; the processor time."""
    here, there = get_context("fork").Pipe(duplex=False)
    process = get_context("fork").Process(target=_judged, args=(trial, there))
    process.start()
    there.close()
    try:
        found: tuple[dict[str, str], dict[str, str], float] = here.recv()
    except EOFError:
        found = {"law": "hang"}, {}, float(_SECONDS)
    process.join()
    return found


def main(count: int = 600, seed: int = 1) -> int:
    """Run the campaign; 1 if anything is wrong."""
    marks, seconds = dict[str, list[str]](), dict[str, list[float]]()
    for place, family in enumerate(islice(cycle(SPACES), count)):
        trial = SPACES[family](random.Random(f"{seed}/{family}/{place}"), f"law-{place}")
        claims, how, spent = _apart(trial)
        seconds.setdefault(trial.family, []).append(spent)
        marks.setdefault(trial.family, []).extend(claims.values())
        for claim, text in claims.items():
            if text != "right":
                said = f"{claim} {trial.truth.get(claim)}, {how.get(claim)}"
                print(f"{text}: {place}, {trial.family}, {trial.margin}, {said}: {trial.law.g}"[:400], flush=True)
    for family in sorted(marks):
        found, times = marks[family], seconds[family]
        right, left = found.count("right"), found.count("open")
        print(
            f"{family:26} {len(times):4} laws {len(found):5} claims {right:5} right {left:4} open {len(found) - right - left:3} wrong"
            f"   median {median(times):.2f} s, most {max(times):.2f}"
        )
    every, all_times = [m for each in marks.values() for m in each], [t for each in seconds.values() for t in each]
    left, wrong = every.count("open"), sum(m not in ("right", "open") for m in every)
    share = f"{100 * left / len(every):.1f} % open"
    print(f"{len(all_times)} laws, {len(every)} claims, {share}, {wrong} wrong, median {median(all_times):.2f} s")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
