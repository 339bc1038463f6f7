"""Cost a point at scale, as ratios to what memory allows and to each other, and the memory taken beyond the results.

The bound is the time to read a trial stress and a pressure and to write stress, slip, multiplier, dissipation and status,
as plain NumPy copies and fills, one thread: nothing that returns these can be faster.  It is taken twice, into arrays that
exist and into new ones, whose memory the system has to find and to clear first; what writes into arrays that exist is
compared with the first, what returns new ones with the second.
Times are the processor's, all threads together: what else the machine does in between would distort a ratio of a short
run to a long one.  Each method is measured at growing numbers of points, as far as it takes seconds; errors are those of a few
of the first points against many digits, flags those of duhem's own residuals.
"""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter, process_time

import numpy as np
from numpy.typing import NDArray

from duhem.benchmark.contenders import Contender
from duhem.benchmark.reference import NoReference, ReferenceIncrement, distance
from duhem.benchmark.specimen import Specimen
from duhem.benchmark.work_precision.result import Measurement, Spread
from duhem.benchmark.work_precision.timing import measured, timed
from duhem.left_out import LeftOut
from duhem.projection.closed_form import ClosedFormOptions
from duhem.projection.increment import Increment
from duhem.projection.projector import ACCURACY
from duhem.projection.residuals import residuals
from duhem.projection.result import Array, Projection, Solution, Status

__all__ = ["ANEW", "BOUND", "BOUND_NEW", "ONCE", "REUSED", "SCENE", "WHOLE", "Load", "rows"]

SCENE = "throughput"
BOUND, BOUND_NEW, WHOLE = "memory bandwidth", "memory bandwidth, new arrays", "duhem.project"
REUSED = ", arrays reused"
ONCE, ANEW = "cvxpy, compiled once", "cvxpy, a new problem a point"
_SIZES = (100, 10_000)  # points, before the number asked for
_FEWER = 20  # points for cvxpy
_LIMIT = 6.0
_LOOKED_AT = 100  # of the first points: those that are judged
_KNOWN = 20  # of them: those that have an answer in many digits; the largest error of fewer is luck


@dataclass(frozen=True)
class Load:
    """N random increments, somewhat more than half of them slipping; ``answers`` in many digits to some of the first, by index."""

    specimen: Specimen
    question: Increment
    answers: dict[int, ReferenceIncrement]

    @classmethod
    def of(cls, specimen: Specimen, points: int, left_out: list[LeftOut] | None = None) -> Load:
        """``left_out`` takes the reason where there are no answers."""
        d = len(specimen.law.forces)
        draw = np.random.default_rng(1)
        trial = draw.normal(size=(points, d)) * (0.9 * specimen.width())
        pressure = None if specimen.pressure is None else -draw.uniform(0.5, 1.5, points)
        answers: dict[int, ReferenceIncrement] = {}
        try:
            closest = specimen.reference()
            for i in range(min(points, _LOOKED_AT)):
                found = closest(trial[i].tolist(), None if pressure is None else float(pressure[i]))
                if found.slips:
                    answers[i] = found
                if len(answers) == _KNOWN:
                    break
        except NoReference as fault:
            answers = {}
            if left_out is not None:
                left_out.append(LeftOut(f"errors of scene {SCENE}", f"no reference: {fault}"))
        return cls(specimen, specimen.question(trial, pressure), answers)

    def first(self, n: int) -> Increment:
        """The question of the first n points."""
        return replace(self.question, trial=self.question.trial[:n], pressure=self.question.pressure[:n])


def rows(load: Load, contenders: Sequence[Contender], repeats: int) -> Iterator[Measurement]:
    """Seconds a point: the bound, each method alone (from the checked question to its answer), and duhem.project whole."""
    n = len(load.question.trial)
    yield Measurement(SCENE, BOUND, f"N = {n}", seconds=_bound(load, repeats, new=False), note="copies and fills, one thread")
    yield Measurement(SCENE, BOUND_NEW, f"N = {n}", seconds=_bound(load, repeats, new=True), note="copies and fills, one thread")
    for contender in contenders:
        if contender.method.name == "cvxpy":
            continue
        yield from _grown(load, contender.name, contender.solve, repeats)
        if contender.method.name == "closed-form":
            yield _reused(contender, load.question, repeats)
            if contender.options == ClosedFormOptions(compiled=False):
                yield _memory(contender.name, partial(contender.solve, load.question))
    if any(contender.method.name == "cvxpy" for contender in contenders):
        yield from _cvxpy(load, min(n, _FEWER), repeats)
    first = next((contender for contender in contenders if not contender.peer), None)
    if first is not None and first.method.name != "cvxpy":

        def whole(part: Increment) -> Projection:
            return first.project(load.specimen, part.trial, None if load.specimen.pressure is None else part.pressure)

        yield from _grown(load, WHOLE, whole, min(repeats, 3), "checks, residuals and statuses included")
        if first.method.name == "closed-form":
            yield _memory(WHOLE, partial(whole, load.question))


def _grown(
    load: Load, name: str, solve: Callable[[Increment], Solution | Projection], repeats: int, note: str = ""
) -> Iterator[Measurement]:
    """The method at more and more points; the last row says what a point costs there beside the first, or what more would take."""
    points = len(load.question.trial)
    sizes = [*(n for n in _SIZES if n < points), points]
    least = 0.0
    for n, more in zip(sizes, [*sizes[1:], None], strict=True):
        row = _judged(load, name, n, solve, repeats)
        if row.seconds is None:
            yield row
            return
        median = row.seconds.median
        least = least or median
        ends = more is None or median * more > _LIMIT
        said = [
            note,
            f"a point takes {median / least:.2g} times what it takes at N = {sizes[0]}" if ends and n > sizes[0] and least > 0.0 else "",
            f"{more} points would take some {median * more:.0f} s" if ends and more is not None else "",
        ]
        yield replace(row, note="; ".join(filter(None, [row.note, *said])) if ends else row.note)
        if ends:
            return


def _judged(load: Load, name: str, n: int, solve: Callable[[Increment], Solution | Projection], repeats: int) -> Measurement:
    """One method at the first n points: its first call by the clock on the wall, what that gave, and the time of further calls."""
    part = load.question if n == len(load.question.trial) else load.first(n)
    try:
        began = perf_counter()
        found = solve(part)
        first = perf_counter() - began
        failed = found.failed if isinstance(found, Solution) else found.status == Status.FAILED
        missing = int(np.count_nonzero(failed))
        k = slice(_LOOKED_AT)
        head = Solution(found.stress[k], found.slip[k], found.multiplier[k], failed[k])
        del found, failed  # a million answers that are kept would make the next million dearer
        worst = residuals(load.first(min(n, _LOOKED_AT)), head).worst()
        note = f"{missing} of {n} points without an answer" if missing else ""
        seconds = timed(partial(solve, part), repeats, 1.0 / n, _LIMIT, process_time)
        flagged = int(np.count_nonzero(head.failed | ~(worst <= ACCURACY)))
        return Measurement(SCENE, name, f"N = {n}", _errors(load, head), seconds, flagged, None, note, first)
    except Exception as fault:
        return Measurement.failing(SCENE, name, f"N = {n}", fault)


def _errors(load: Load, found: Solution) -> dict[str, float]:
    """The largest, relative, of the points that have an answer here and in many digits."""
    known = [(i, answer) for i, answer in load.answers.items() if i < len(found.failed) and not found.failed[i]]
    if not known:
        return {}
    return {
        "stress": max(distance(found.stress[i].tolist(), answer.stress) for i, answer in known),
        "slip": max(distance(found.slip[i].tolist(), answer.slip) for i, answer in known),
    }


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
    return measured(SCENE, name, f"N = {n}", run, repeats, 1.0 / n, _LIMIT, process_time, note)


def _reused(contender: Contender, question: Increment, repeats: int) -> Measurement:
    """The same into the arrays of an earlier solution."""
    name, n = contender.name + REUSED, len(question.trial)
    try:
        room = contender.solve(question)
    except Exception as fault:
        return Measurement.failing(SCENE, name, f"N = {n}", fault)
    return _measured(name, n, lambda: contender.again(question, room), repeats, "")


def _memory(name: str, run: Callable[[], object]) -> Measurement:
    """Peak bytes beyond what the results keep, in MB, as an error-free row of its own."""
    tracemalloc.start()
    try:
        kept = run()
        now, peak = tracemalloc.get_traced_memory()
        del kept
    except Exception as fault:
        return Measurement.failing(SCENE, name, "extra memory", fault)
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
