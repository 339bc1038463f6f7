"""Cost a point at scale, as ratios to what memory allows and to each other, and the memory taken beyond the results.

The bound is the time to read a trial stress and a pressure and to write stress, slip, multiplier, dissipation and status,
as plain NumPy copies and fills, one thread: nothing that returns these can be faster.  It is taken twice, into arrays that
exist and into new ones, whose memory the system has to find and to clear first; what writes into arrays that exist is
compared with the first, what returns new ones with the second.
Times are the processor's, all threads together: what else the machine does in between would distort a ratio of a short
run to a long one.
"""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from time import process_time

import numpy as np
from numpy.typing import NDArray

from duhem.benchmark.contenders import Contender
from duhem.benchmark.specimen import Specimen
from duhem.benchmark.work_precision.result import Measurement, Spread, Target
from duhem.benchmark.work_precision.timing import timed
from duhem.left_out import LeftOut
from duhem.projection.increment import Increment
from duhem.projection.result import Array

__all__ = ["SCENE", "rows", "targets"]

SCENE = "throughput"
BOUND, BOUND_NEW, WHOLE = "memory bandwidth", "memory bandwidth, new arrays", "duhem.project"
REUSED = ", arrays reused"
ONCE, ANEW = "cvxpy, compiled once", "cvxpy, a new problem a point"
_FEW, _FEWER = 2_000, 20  # points for the methods whose cost a point does not depend on N, and for cvxpy
_LIMIT = 6.0


@dataclass(frozen=True)
class Load:
    """N random increments, somewhat more than half of them slipping."""

    specimen: Specimen
    question: Increment

    @classmethod
    def of(cls, specimen: Specimen, points: int) -> Load:
        d = len(specimen.law.forces)
        draw = np.random.default_rng(1)
        reach = [specimen.radius(s * axis, specimen.pressure) for axis in np.eye(d) for s in (1.0, -1.0)]
        size = float(np.median([r for r in reach if 0.0 < r < 1e300] or [1.0]))
        trial = draw.normal(size=(points, d)) * (0.9 * size)
        pressure = None if specimen.pressure is None else -draw.uniform(0.5, 1.5, points)
        return cls(specimen, specimen.question(trial, pressure))

    def first(self, n: int) -> Increment:
        """The question of the first n points."""
        pressure = None if self.specimen.pressure is None else self.question.pressure[:n]
        return self.specimen.question(self.question.trial[:n], pressure)


def rows(load: Load, contenders: Sequence[Contender], repeats: int) -> Iterator[Measurement]:
    """Seconds a point: the bound, each method alone (from the checked question to its answer), and duhem.project whole."""
    n = len(load.question.trial)
    yield Measurement(SCENE, BOUND, f"N = {n}", seconds=_bound(load, repeats, new=False), note="copies and fills, one thread")
    yield Measurement(SCENE, BOUND_NEW, f"N = {n}", seconds=_bound(load, repeats, new=True), note="copies and fills, one thread")
    for contender in contenders:
        method = contender.method.name
        if method == "cvxpy":
            continue
        few = n if method == "closed-form" else _FEW
        part, count = (load.question, n) if few >= n else (load.first(few), few)
        note = "" if count == n else f"{count} points: its cost a point does not fall with N"
        yield _measured(contender.name, count, partial(contender.solve, part), repeats, note)
        if method == "closed-form":
            yield _reused(contender, part, repeats)
        if method == "closed-form" and contender.options == contender.method.options():
            yield _memory(contender.name, partial(contender.solve, load.question))
    if any(contender.method.name == "cvxpy" for contender in contenders):
        yield from _cvxpy(load, min(n, _FEWER), repeats)
    first = contenders[0]
    if first.method.name == "closed-form":
        pressure = None if load.specimen.pressure is None else load.question.pressure

        def whole() -> object:
            return first.project(load.specimen, load.question.trial, pressure)

        yield _measured(WHOLE, n, whole, min(repeats, 3), "checks, residuals and statuses included")
        yield _memory(WHOLE, whole)


def _cvxpy(load: Load, count: int, repeats: int) -> Iterator[Measurement]:
    """Both ways to solve point by point: one compiled problem whose parameters change, and a new problem each time."""
    solve = Contender.of("cvxpy", "cvxpy", solver="CLARABEL", batch=1).solve
    part = load.first(count)
    pressure = None if load.specimen.pressure is None else part.pressure
    alone = [load.specimen.question(x[None], None if pressure is None else pressure[i : i + 1]) for i, x in enumerate(part.trial)]

    def each() -> None:
        for question in alone:
            solve(question)

    yield _measured(ONCE, count, partial(solve, part), repeats, f"{count} points, CLARABEL")
    yield _measured(ANEW, count, each, repeats, f"{count} points, CLARABEL")


def _measured(name: str, n: int, run: Callable[[], object], repeats: int, note: str) -> Measurement:
    try:
        run()  # what is compiled on first use is compiled here
        return Measurement(SCENE, name, f"N = {n}", seconds=timed(run, repeats, 1.0 / n, _LIMIT, process_time), note=note)
    except Exception as fault:  # whatever a method raises is its result
        return Measurement(SCENE, name, f"N = {n}", failure=f"{type(fault).__name__}: {fault}")


def _reused(contender: Contender, question: Increment, repeats: int) -> Measurement:
    """The same into the arrays of an earlier solution."""
    name, n = contender.name + REUSED, len(question.trial)
    try:
        room = contender.solve(question)
    except Exception as fault:
        return Measurement(SCENE, name, f"N = {n}", failure=f"{type(fault).__name__}: {fault}")
    return _measured(name, n, lambda: contender.again(question, room), repeats, "")


def _memory(name: str, run: Callable[[], object]) -> Measurement:
    """Peak bytes beyond what the results keep, in MB, as an error-free row of its own."""
    tracemalloc.start()
    try:
        kept = run()
        now, peak = tracemalloc.get_traced_memory()
        del kept
    except Exception as fault:
        return Measurement(SCENE, name, "extra memory", failure=f"{type(fault).__name__}: {fault}")
    finally:
        tracemalloc.stop()
    return Measurement(SCENE, name, "extra memory", {"megabytes": (peak - now) / 1e6})


def _bound(load: Load, repeats: int, new: bool) -> Spread:
    """Into arrays that exist, or, as whatever returns results must, into new ones."""
    trial, pressure = load.question.trial, load.question.pressure
    n = len(trial)

    def room() -> tuple[Array, Array, Array, Array, NDArray[np.int8]]:
        return np.empty_like(trial), np.empty_like(trial), np.empty(n), np.empty(n), np.empty(n, dtype=np.int8)

    there = room()

    def run() -> None:
        stress, slip, multiplier, dissipation, status = room() if new else there
        np.copyto(stress, trial)
        slip.fill(0.0)
        np.copyto(multiplier, pressure)
        dissipation.fill(0.0)
        status.fill(0)

    run()
    return timed(run, max(3 * repeats, 9), 1.0 / n, clock=process_time)


def targets(rows: Sequence[Measurement], left_out: Sequence[LeftOut]) -> tuple[Target, ...]:
    """The ratios of medians that duhem sets itself, within one run; where one was not measured, why."""
    absent = {part.part: part.reason for part in left_out} | {r.method: f"failed: {r.failure}" for r in rows if r.failure is not None}
    seconds = {row.method: row.seconds.median for row in rows if row.scene == SCENE and row.seconds is not None}
    memory = {row.method: row.error["megabytes"] for row in rows if row.scene == SCENE and "megabytes" in row.error}
    if BOUND not in seconds or BOUND_NEW not in seconds:
        return ()
    absent |= {name + REUSED: reason for name, reason in absent.items()}

    def ratio(what: str, over: str, under: str, relation: str, bound: float) -> Target:
        missing = [name for name in (over, under) if name not in seconds]
        value = None if missing or seconds[under] == 0.0 else seconds[over] / seconds[under]
        reason = "; ".join(absent.get(name, f"{name} was not measured") for name in missing)
        return Target(what, value, relation, bound, reason or ("" if value is not None else "too short for this clock"))

    def megabytes(name: str) -> Target:
        return Target(f"extra memory of {name}, MB", memory.get(name), "<=", 16.0, "" if name in memory else f"{name} was not measured")

    return (
        ratio("closed form (NumPy) / memory bandwidth", "closed-form" + REUSED, BOUND, "<=", 40.0),
        ratio("closed form (numba) / memory bandwidth", "closed-form, numba" + REUSED, BOUND, "<=", 5.0),
        ratio("closed form (NumPy) / memory bandwidth, new arrays", "closed-form", BOUND_NEW, "<=", 40.0),
        ratio("closed form (numba) / memory bandwidth, new arrays", "closed-form, numba", BOUND_NEW, "<=", 5.0),
        ratio("duhem.project, residuals included / memory bandwidth, new arrays", WHOLE, BOUND_NEW, "<=", 40.0),
        ratio("CVXPY, a new problem a point / closed form (NumPy)", ANEW, "closed-form", ">=", 1e4),
        ratio("CVXPY, compiled once / closed form (NumPy)", ONCE, "closed-form", ">=", 1e4),
        megabytes("closed-form"),
        megabytes(WHOLE),
    )
