"""Repeated runs by a clock, with a limit on what one measurement may take."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from duhem.benchmark.work_precision.result import Measurement, Spread

__all__ = ["measured", "timed"]


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


def measured(
    scene: str,
    name: str,
    setting: str,
    run: Callable[[], object],
    repeats: int,
    share: float,
    limit: float,
    clock: Callable[[], float] = perf_counter,
    note: str = "",
) -> Measurement:
    """The row of a run by :func:`timed`, after a first one: what is compiled on first use is compiled there."""
    try:
        run()
        return Measurement(scene, name, setting, seconds=timed(run, repeats, share, limit, clock), note=note)
    except Exception as fault:
        return Measurement.failing(scene, name, setting, fault)
