"""``duhem.simulate`` at length: many points over many implicit steps, and one path of very many; wall time a step of one point.

What the steps of many points are held to is the compiled kernel by itself, on as many points as stay in the cache.  Memory is what the
run takes at its peak, results included, beyond what it was given.  What is compiled on first use is compiled before.
"""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.util import find_spec

import numpy as np

from duhem.benchmark.contenders import Contender
from duhem.benchmark.machine import cores
from duhem.benchmark.specimen import Specimen
from duhem.benchmark.work_precision.result import Measurement, Target
from duhem.benchmark.work_precision.timing import measured
from duhem.left_out import LeftOut
from duhem.path.loading import Path
from duhem.path.paths import Paths
from duhem.path.simulate import simulate

__all__ = ["SCENE", "LongPaths", "rows", "targets"]

SCENE = "paths"
KERNEL, ONE, MANY, ALONE = "kernel alone", "one path", "many points", ", one thread"
NUMBA = ", numba"
_KERNEL = 4_032  # points of the kernel
_TURNS = 10  # straight pieces of each path
_SLOW = 1_000  # steps of what is not compiled; a law without a declared shape takes so many times fewer points
_FEW = 100  # steps of each of many points where the law declares no shape
_LIMIT = 6.0


@dataclass(frozen=True)
class LongPaths:
    """A path of ``size`` steps and more; many points, multiples of it, take a thousand steps each, and ``size`` / 10 is their number."""

    specimen: Specimen
    path: Path
    size: int

    @classmethod
    def of(cls, specimen: Specimen, size: int) -> LongPaths:
        """Turns of chance, each a few times the reach of K, under constant pressure."""
        d = len(specimen.law.forces)
        draw = np.random.default_rng(1)
        width = specimen.width() / np.diagonal(specimen.stiffness)
        points = np.vstack([np.zeros(d), np.cumsum(draw.normal(size=(_TURNS, d)) * 1.5 * width, axis=0)])
        return cls(specimen, Path.linear(points, pressure=specimen.pressure), size)

    @property
    def shaped(self) -> bool:
        """Whether the law declares the shape of its K."""
        return self.specimen.law.closed_form is not None

    def many(self) -> tuple[Paths, int]:
        """The points and how many steps each takes."""
        count = max(1, self.size // (10 if self.shaped else _SLOW))
        factor = np.random.default_rng(2).normal(size=(count, self.path.values.shape[1]))
        return Paths.scaled(self.path, factor), 1_000 if self.shaped else _FEW


def rows(drive: LongPaths, contenders: Sequence[Contender], repeats: int) -> Iterator[Measurement]:
    """Seconds a step of one point: the kernel, one path and many, with and without the compiler, on one thread and on all."""
    given = {"stiffness": drive.specimen.stiffness}
    slow = max(1, min(_SLOW, drive.size) // _TURNS)
    run = partial(simulate, drive.specimen.declared, drive.path, **given)
    yield _measured(ONE, f"{slow * _TURNS} steps", slow * _TURNS, partial(run, substeps=slow), repeats)
    if find_spec("numba") is None:
        return
    name = "closed-form" if drive.shaped else "newton"
    kernel = next((c for c in contenders if c.method.name == name and vars(c.options).get("compiled")), None)
    if kernel is not None:
        yield _kernel(drive, kernel, repeats)
    long = max(1, drive.size // _TURNS)
    yield _measured(ONE + NUMBA, f"{long * _TURNS} steps", long * _TURNS, partial(run, substeps=long, compiled=True), repeats)
    points, steps = drive.many()
    setting, count = f"N = {len(points)}, {steps} steps", len(points) * steps
    many = partial(simulate, drive.specimen.declared, points, substeps=steps // _TURNS, keep="last", compiled=True, **given)
    for label, threads in ((MANY + NUMBA + ALONE, 1), (MANY + NUMBA, cores())):
        yield _measured(label, setting, count, partial(many, threads=threads), repeats)
    yield _memory(MANY + NUMBA, partial(many, threads=cores()))


def _kernel(drive: LongPaths, contender: Contender, repeats: int) -> Measurement:
    d = len(drive.specimen.law.forces)
    reach = np.abs(drive.path.values).max() * np.diagonal(drive.specimen.stiffness)
    trial = np.random.default_rng(3).normal(size=(_KERNEL, d)) * (0.3 * reach)
    question = drive.specimen.question(trial, None if drive.specimen.pressure is None else np.full(_KERNEL, drive.specimen.pressure))
    if contender.method.name != "closed-form":
        return _measured(KERNEL, f"N = {_KERNEL}", _KERNEL, partial(contender.solve, question), 20 * repeats)
    room = contender.solve(question)
    return _measured(KERNEL, f"N = {_KERNEL}", _KERNEL, partial(contender.again, question, room), 100 * repeats)


def _measured(name: str, setting: str, steps: int, run: Callable[[], object], repeats: int) -> Measurement:
    return measured(SCENE, name, setting, run, repeats, 1.0 / steps, _LIMIT)


def _memory(name: str, run: Callable[[], object]) -> Measurement:
    tracemalloc.start()
    try:
        run()
        return Measurement(SCENE, name, "peak memory", {"megabytes": tracemalloc.get_traced_memory()[1] / 1e6})
    except Exception as fault:
        return Measurement.failing(SCENE, name, "peak memory", fault)
    finally:
        tracemalloc.stop()


def targets(rows: Sequence[Measurement], left_out: Sequence[LeftOut]) -> tuple[Target, ...]:
    """The ratios of least times that duhem sets itself; of one that was not measured, why."""
    own = [row for row in rows if row.scene == SCENE]
    least = {row.method: row.seconds.least for row in own if row.seconds is not None}
    absent = {row.method: f"failed: {row.failure}" for row in own if row.failure}
    numba = next((part.reason for part in left_out if part.part.endswith(NUMBA)), "")
    if not own:
        return ()

    def target(what: str, over: str, under: str, relation: str, bound: float) -> Target:
        missing = [name for name in (over, under) if name not in least]
        reason = "; ".join(absent.get(name, numba or f"{name} was not measured") for name in missing)
        return Target(what, None if missing else least[over] / least[under], relation, bound, reason)

    one = Target("10^6 implicit steps of one path (numba), s", None, "<=", 1.0, absent.get(ONE + NUMBA, numba or "not measured"))
    if ONE + NUMBA in least:
        one = replace(one, value=1e6 * least[ONE + NUMBA], reason="")
    return (
        target("implicit steps of many points (numba), one thread / kernel alone", MANY + NUMBA + ALONE, KERNEL, "<=", 3.0),
        one,
        target("implicit steps of many points (numba), one thread / all", MANY + NUMBA + ALONE, MANY + NUMBA, ">=", 1.6),
    )
