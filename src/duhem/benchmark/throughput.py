"""The time of increments: one alone, as a user solves it, and cost a point at scale, as ratios to what memory allows and to each other.

Alone are a few trial stresses, by every method and at every tolerance.  At scale the memory taken beyond the results counts too.  The
bound is the time to read a trial stress and a pressure and to write stress, slip, multiplier, dissipation and status, as plain NumPy
copies and fills, one thread: nothing that returns these can be faster.  It is taken twice, into arrays that exist and into new ones,
whose memory the system has to find and to clear first; what writes into arrays that exist is compared with the first, what returns new
ones with the second.  Times are the processor's, all threads together: what else the machine does in between would distort a ratio of a
short run to a long one.  Each method is measured at growing numbers of points, as far as it takes seconds; errors are those of a few of
the first points against many digits, flags those of duhem's own residuals.

The calls of ``duhem.project`` by users, checks, residuals and statuses included, are a scene of their own, in wall time.  Their
bound is a copy of three numbers a point between arrays that exist, by one thread: what reading a trial stress and a pressure in
the plane costs at least.  Compiled calls are taken on one thread and on all that there are; what is compiled on first use is
compiled before.  Small batches, the copy of them too, are taken as often as it takes to see as many points, up to twenty times as
often: five calls of half a millisecond are all over while another program has the processor.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter, process_time

import numpy as np
from numpy.typing import NDArray

from duhem.benchmark.contenders import Contender, Specimen
from duhem.benchmark.measurement import LIMIT, Measurement, Spread, Target, at_most, largest_errors, measured, memory, ratio, timed
from duhem.benchmark.reference import NoReference, ReferenceIncrement
from duhem.omitted import LeftOut
from duhem.projection.closed_form import ClosedFormOptions
from duhem.projection.cvxpy_method import CvxpyOptions
from duhem.projection.increment import Increment
from duhem.projection.projector import ACCURACY
from duhem.projection.residuals import residuals
from duhem.projection.result import Array, Projection, Solution, Status

__all__ = [
    "CALLS", "SCENE", "SINGLE", "TOLERANCES", "Exercise", "Load", "beside_peers", "call_rows", "call_targets", "exercise", "rows",
    "single_rows", "targets",
]  # fmt: skip

SCENE, CALLS = "throughput", "project"
BOUND, BOUND_NEW, WHOLE = "memory bandwidth", "memory bandwidth, new arrays", "duhem.project"
REUSED = ", arrays reused"
COPY, ONE = "copy of 24 bytes a point", ", one thread"
ONCE, ANEW = "cvxpy, compiled once", "cvxpy, a new problem a point"
_SIZES = (100, 10_000)  # points, before the number asked for
_FEWER = 20  # points for cvxpy
_LOOKED_AT = 100  # of the first points: those that are judged
_KNOWN = 20  # of them: those that have an answer in many digits; the largest error of fewer is luck
_SMALL, _FEW = 10_000, 2_000  # points of a small batch; of newton without a compiler beside many
_OFTEN = 20


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
    for name, new in ((BOUND, False), (BOUND_NEW, True)):
        yield Measurement(SCENE, name, f"N = {n}", seconds=_bound(load, repeats, new), note="copies and fills, one thread")
    for contender in contenders:
        if contender.method.name == "cvxpy":
            continue
        yield from _grown(load, contender.name, contender.solve, repeats)
        if contender.method.name == "closed-form":
            yield _reused(contender, load.question, repeats)
            if contender.options == ClosedFormOptions(compiled=False):
                yield memory(SCENE, contender.name, "extra memory", partial(contender.solve, load.question), results=False)
    if any(contender.method.name == "cvxpy" for contender in contenders):
        yield from _cvxpy(load, min(n, _FEWER), repeats)
    first = next((contender for contender in contenders if not contender.peer), None)
    if first is not None and first.method.name != "cvxpy":

        def whole(part: Increment) -> Projection:
            return first.project(load.specimen, part.trial, None if load.specimen.pressure is None else part.pressure)

        yield from _grown(load, WHOLE, whole, min(repeats, 3), "checks, residuals and statuses included")
        if first.method.name == "closed-form":
            yield memory(SCENE, WHOLE, "extra memory", partial(whole, load.question), results=False)


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
        ends = more is None or median * more > LIMIT
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
        seconds = timed(partial(solve, part), repeats, 1.0 / n, LIMIT, process_time)
        flagged = int(np.count_nonzero(head.failed | ~(worst <= ACCURACY)))
        return Measurement(SCENE, name, f"N = {n}", _errors(load, head), seconds, flagged, None, note, first)
    except Exception as fault:
        return Measurement.failing(SCENE, name, f"N = {n}", fault)


def _errors(load: Load, found: Solution) -> dict[str, float]:
    """The largest, relative, of the points that have an answer here and in many digits."""
    known = {i: answer for i, answer in load.answers.items() if i < len(found.failed) and not found.failed[i]}
    return largest_errors([(found.stress[i], found.slip[i], answer) for i, answer in known.items()]) if known else {}


def _cvxpy(load: Load, count: int, repeats: int) -> Iterator[Measurement]:
    """Both ways to solve point by point: one compiled problem whose parameters change, and a new problem each time."""
    solve = Contender.of("cvxpy", "cvxpy", solver="CLARABEL", batch=1).solve
    part = load.first(count)
    pressure = None if load.specimen.pressure is None else part.pressure
    alone = [load.specimen.question(x[None], None if pressure is None else pressure[i : i + 1]) for i, x in enumerate(part.trial)]

    def each() -> None:
        for question in alone:
            solve(question)

    for name, run in ((ONCE, partial(solve, part)), (ANEW, each)):
        yield measured(SCENE, name, f"N = {count}", run, repeats, count, process_time, f"{count} points, CLARABEL")


def _reused(contender: Contender, question: Increment, repeats: int) -> Measurement:
    """The same into the arrays of an earlier solution."""
    name, n = contender.name + REUSED, len(question.trial)
    try:
        room = contender.solve(question)
    except Exception as fault:
        return Measurement.failing(SCENE, name, f"N = {n}", fault)
    return measured(SCENE, name, f"N = {n}", lambda: contender.again(question, room), repeats, n, process_time)


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
    """The ratios of medians that duhem sets itself, at the most points measured; where one was not measured, why."""
    absent = {part.part: part.reason for part in left_out} | {r.method: f"failed: {r.failure}" for r in rows if r.failure is not None}
    seconds = {row.method: row.seconds.median for row in rows if row.scene == SCENE and row.seconds is not None}
    megabytes_of = {row.method: row.error["megabytes"] for row in rows if row.scene == SCENE and "megabytes" in row.error}
    if BOUND not in seconds or BOUND_NEW not in seconds:
        return ()
    if "closed-form" not in seconds:  # what duhem.project is held to is held to with a closed form
        seconds.pop(WHOLE, None)
    absent |= {name + REUSED: reason for name, reason in absent.items()}

    target = partial(ratio, seconds=seconds, absent=absent)

    def megabytes(name: str) -> Target:
        return at_most(f"extra memory of {name}, MB", megabytes_of.get(name), 16.0, f"{name} was not measured")

    return (
        target("closed form (NumPy) / memory bandwidth", "closed-form" + REUSED, BOUND, "<=", 40.0),
        target("closed form (numba) / memory bandwidth", "closed-form, numba" + REUSED, BOUND, "<=", 5.0),
        target("closed form (NumPy) / memory bandwidth, new arrays", "closed-form", BOUND_NEW, "<=", 40.0),
        target("closed form (numba) / memory bandwidth, new arrays", "closed-form, numba", BOUND_NEW, "<=", 5.0),
        target("duhem.project, residuals included / memory bandwidth, new arrays", WHOLE, BOUND_NEW, "<=", 40.0),
        target("CVXPY, a new problem a point / closed form (NumPy)", ANEW, "closed-form", ">=", 1e4),
        target("CVXPY, compiled once / closed form (NumPy)", ONCE, "closed-form", ">=", 1e4),
        megabytes("closed-form"),
        megabytes(WHOLE),
    )


def beside_peers(rows: Sequence[Measurement], own: Collection[str], peers: Collection[str]) -> tuple[Target, ...]:
    """For each peer the time and the error of the quickest of duhem's ``own`` methods, both at the most points both were measured at."""
    found: list[Target] = []
    measured = {(row.method, row.setting): row for row in rows if row.scene == SCENE and row.seconds is not None}
    for peer in peers:
        at = [setting for name, setting in measured if name == peer and any((mine, setting) in measured for mine in own)]
        if not at:
            continue
        theirs = measured[peer, at[-1]]
        mine = min((measured[name, at[-1]] for name in own if (name, at[-1]) in measured), key=_median)
        what = f"{peer} / {mine.method}, time a point at {at[-1]}"
        found.append(Target(what, _median(theirs) / _median(mine) if _median(mine) > 0.0 else None, ">=", 1.0, "too short for this clock"))
        if "stress" in theirs.error and "stress" in mine.error:
            off, other = mine.error["stress"], theirs.error["stress"]
            share = 0.0 if off == 0.0 else off / other if other > 0.0 else float("inf")
            found.append(Target(f"{mine.method} / {peer}, error of the stress at {at[-1]}", share, "<=", 1.0))
    return tuple(found)


def _median(row: Measurement) -> float:
    assert row.seconds is not None
    return row.seconds.median


def call_rows(load: Load, contenders: Sequence[Contender], repeats: int) -> Iterator[Measurement]:
    """Seconds a point of the copy and of each call: large and small batches, with and without the compiler."""
    n = len(load.question.trial)
    for many in sorted({n, min(n, _SMALL)}, reverse=True):
        there, here, often = np.ones((many, 3)), np.empty((many, 3)), repeats * min(n // many, _OFTEN)
        copy = partial(np.copyto, here, there)
        yield measured(CALLS, COPY, f"N = {many}", copy, 5 * often, many, note="one thread")
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
    return measured(CALLS, name, f"N = {count}", lambda: contender.project(load.specimen, trial, pressure), repeats, count)


def call_targets(rows: Sequence[Measurement], left_out: Sequence[LeftOut]) -> tuple[Target, ...]:
    """The ratios of least times that duhem sets itself; of one that was not measured, why."""
    own = [row for row in rows if row.scene == CALLS]
    least = {(row.method, int(row.setting.removeprefix("N = "))): row.seconds.least for row in own if row.seconds is not None}
    absent = {part.part: part.reason for part in left_out} | {row.method: f"failed: {row.failure}" for row in own if row.failure}
    if not own:
        return ()
    n = max(count for _, count in least) if least else 0
    small = min(n, _SMALL)

    target = partial(ratio, seconds=least, absent=absent, name=lambda key: key[0].removesuffix(ONE))
    fast = [
        target("duhem.project / copy of 24 bytes a point", ("closed-form", n), (COPY, n), "<=", 160.0),
        target("duhem.project (numba) / copy of 24 bytes a point", ("closed-form, numba", n), (COPY, n), "<=", 50.0),
        at_most(
            f"duhem.project (numba), ns a point of N = {small}",
            1e9 * least["closed-form, numba", small] if ("closed-form, numba", small) in least else None,
            100.0,
            absent.get("closed-form, numba", "not measured"),
        ),
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


# -- one increment, as a user solves it --------------------------------------------------------------------------------

SINGLE = "increment"
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, None)
_FACTORS = (1.05, 2.0, 30.0, 1e3)  # trial stresses in units of the reach of K


@dataclass(frozen=True)
class Exercise:
    """Trial stresses (N, d), N checked questions of one point each, and their answers in many digits."""

    specimen: Specimen
    trial: Array
    questions: tuple[Increment, ...]
    answers: tuple[ReferenceIncrement, ...]

    @property
    def residual(self) -> float:
        """The largest error of the answers themselves."""
        return max((answer.residual for answer in self.answers), default=0.0)


def exercise(specimen: Specimen) -> Exercise:
    """Four trial stresses outside K, in unlike directions and at unlike distances; NoReference where K has no reference."""
    d = len(specimen.law.forces)
    draw = np.random.default_rng(2007)
    ways = draw.uniform(0.3, 1.0, (len(_FACTORS), d)) * np.where((np.arange(len(_FACTORS))[:, None] >> np.arange(d)) & 1, -1.0, 1.0)
    reach = [specimen.radius(way, specimen.pressure) for way in ways]
    usable = [way * r * f for way, r, f in zip(ways, reach, _FACTORS, strict=True) if 0.0 < r < 1e300]
    trial = np.array(usable).reshape(-1, d)
    closest = specimen.reference()
    answers = tuple(closest(x.tolist(), specimen.pressure) for x in trial)
    return Exercise(specimen, trial, tuple(specimen.question(x[None], specimen.pressure) for x in trial), answers)


def single_rows(work: Exercise, contenders: Sequence[Contender], repeats: int) -> Iterator[Measurement]:
    """A row for each contender, in turn: the largest errors, and the time of the method alone for one increment.

    The checks and residuals that duhem.project adds are in a row of their own.
    """
    for contender in contenders:
        yield _row(work, contender, repeats)
    first = next((contender for contender in contenders if not contender.peer), None)
    if first is None:
        return

    def all_of_it() -> None:
        for x in work.trial:
            first.project(work.specimen, x, work.specimen.pressure)

    note = f"{first.name} through duhem.project: checks and residuals included"
    found = [first.solve(question) for question in work.questions]
    yield Measurement(
        SINGLE, "duhem.project", "", _exercise_errors(work, found), timed(all_of_it, repeats, 1.0 / len(work.trial)), 0, None, note
    )


def _row(work: Exercise, contender: Contender, repeats: int) -> Measurement:
    setting = _setting(contender)
    try:
        found = [contender.solve(question) for question in work.questions]
        errors, flagged = _exercise_errors(work, found), _flagged(work, found)

        def run() -> None:
            for question in work.questions:
                contender.solve(question)

        missing = sum(bool(f.failed[0]) for f in found)
        note = f"{missing} of {len(found)} increments without an answer" if missing else ""
        return Measurement(SINGLE, contender.name, setting, errors, timed(run, repeats, 1.0 / len(work.trial)), flagged, None, note)
    except Exception as fault:  # whatever a solver raises is its result
        return Measurement.failing(SINGLE, contender.name, setting, fault)


def _exercise_errors(work: Exercise, found: Sequence[Solution]) -> dict[str, float]:
    """The largest of the answers there are."""
    answered = [(f.stress[0], f.slip[0], a) for f, a in zip(found, work.answers, strict=True) if not f.failed[0]]
    if not answered:
        raise ArithmeticError("no answer to any increment")
    return largest_errors(answered)


def _flagged(work: Exercise, found: Sequence[Solution]) -> int:
    """How many of its answers duhem's own residuals call inaccurate or failed."""
    judged = [residuals(q, solution).worst()[0] for q, solution in zip(work.questions, found, strict=True)]
    return sum(bool(f.failed[0]) or not worst <= ACCURACY for f, worst in zip(found, judged, strict=True))


def _setting(contender: Contender) -> str:
    """The tolerance, where the method has one."""
    match contender.options:
        case CvxpyOptions(tolerance=None):
            return "tightest it meets"
        case CvxpyOptions(tolerance=tolerance):
            return f"tolerance {tolerance:.0e}"
    return ""
