"""``duhem.project`` as users call it, checks, residuals and statuses included: wall time a point, as ratios within one run.

The bound is a copy of three numbers a point between arrays that exist, by one thread: what reading a trial stress and a pressure in
the plane costs at least.  Compiled calls are taken on one thread and on all that there are; what is compiled on first use is
compiled before.  Small batches, the copy of them too, are taken as often as it takes to see as many points, up to twenty times as
often: five calls of half a millisecond are all over while another program has the processor.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from duhem.benchmark.contenders import Contender
from duhem.benchmark.work_precision.result import Measurement, Target
from duhem.benchmark.work_precision.throughput import Load
from duhem.benchmark.work_precision.timing import measured
from duhem.left_out import LeftOut

__all__ = ["SCENE", "rows", "targets"]

SCENE = "project"
COPY, ONE = "copy of 24 bytes a point", ", one thread"
_SMALL, _FEW = 10_000, 2_000  # points of a small batch; of newton without a compiler beside many
_OFTEN = 20
_LIMIT = 6.0


def rows(load: Load, contenders: Sequence[Contender], repeats: int) -> Iterator[Measurement]:
    """Seconds a point of the copy and of each call: large and small batches, with and without the compiler."""
    n = len(load.question.trial)
    for many in sorted({n, min(n, _SMALL)}, reverse=True):
        there, here, often = np.ones((many, 3)), np.empty((many, 3)), repeats * min(n // many, _OFTEN)
        yield _measured(COPY, many, partial(np.copyto, here, there), 5 * often, "one thread")
        for contender in contenders:
            name, options = contender.method.name, vars(contender.options)
            if "compiled" not in options:
                continue
            if not options["compiled"] and name == "newton":
                yield _called(load, contender, contender.name, min(many, _FEW) if many == n else many, often)
                continue
            yield _called(load, contender, contender.name, many, often)
            if options["compiled"]:
                alone = Contender.of(contender.name, name, compiled=True, threads=1)
                yield _called(load, alone, contender.name + ONE, many, often)


def _called(load: Load, contender: Contender, name: str, count: int, repeats: int) -> Measurement:
    trial = load.question.trial[:count]
    pressure = None if load.specimen.pressure is None else load.question.pressure[:count]
    return _measured(name, count, lambda: contender.project(load.specimen, trial, pressure), repeats, "")


def _measured(name: str, n: int, run: Callable[[], object], repeats: int, note: str) -> Measurement:
    return measured(SCENE, name, f"N = {n}", run, repeats, 1.0 / n, _LIMIT, note=note)


def targets(rows: Sequence[Measurement], left_out: Sequence[LeftOut]) -> tuple[Target, ...]:
    """The ratios of least times that duhem sets itself; of one that was not measured, why."""
    own = [row for row in rows if row.scene == SCENE]
    least = {(row.method, int(row.setting.removeprefix("N = "))): row.seconds.least for row in own if row.seconds is not None}
    absent = {part.part: part.reason for part in left_out} | {row.method: f"failed: {row.failure}" for row in own if row.failure}
    if not own:
        return ()
    n = max(count for _, count in least) if least else 0
    small = min(n, _SMALL)

    def target(what: str, over: tuple[str, int], under: tuple[str, int], relation: str, bound: float) -> Target:
        missing = [name.removesuffix(ONE) for name, count in (over, under) if (name, count) not in least]
        reason = "; ".join(absent.get(name, f"{name} was not measured") for name in dict.fromkeys(missing))
        return Target(what, None if missing else least[over] / least[under], relation, bound, reason)

    fast = [
        target("duhem.project / copy of 24 bytes a point", ("closed-form", n), (COPY, n), "<=", 160.0),
        target("duhem.project (numba) / copy of 24 bytes a point", ("closed-form, numba", n), (COPY, n), "<=", 50.0),
        _in_nanoseconds(least.get(("closed-form, numba", small)), small, absent.get("closed-form, numba", "")),
        target("closed form (numba), one thread / all", ("closed-form, numba" + ONE, n), ("closed-form, numba", n), ">=", 1.6),
    ]
    newton = [
        target("newton / newton (numba)", ("newton", min(n, _FEW)), ("newton, numba", n), ">=", 15.0),
        target("newton (numba), one thread / all", ("newton, numba" + ONE, n), ("newton, numba", n), ">=", 1.6),
    ]
    if small < n:
        both = f"newton / newton (numba), both at N = {small}"
        newton.insert(1, target(both, ("newton", small), ("newton, numba", small), ">=", 15.0))
    return tuple(newton if "closed-form" in absent else fast)


def _in_nanoseconds(seconds: float | None, small: int, reason: str) -> Target:
    what = f"duhem.project (numba), ns a point of N = {small}"
    return Target(what, None if seconds is None else 1e9 * seconds, "<=", 100.0, "" if seconds is not None else reason or "not measured")
