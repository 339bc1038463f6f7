"""Repeated runs by a clock, with a limit on what one measurement may take."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from duhem.benchmark.work_precision.result import Spread

__all__ = ["timed"]


def timed(
    run: Callable[[], object], repeats: int, share: float = 1.0, limit: float = 1.5, clock: Callable[[], float] = perf_counter
) -> Spread:
    """Seconds of ``run`` times ``share``: up to ``repeats`` runs, fewer (but three, or one long one) past ``limit`` seconds.

    ``clock``: by default the wall's.
    """
    seconds: list[float] = []
    while len(seconds) < repeats and (sum(seconds) < limit or (len(seconds) < 3 and seconds[0] < limit)):
        began = clock()
        run()
        seconds.append(clock() - began)
    return Spread.of(seconds, share)
