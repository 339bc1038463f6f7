"""Driving a law along a path: checks, the start, and the integrator asked for.

Many points run block by block, so that memory is bounded, blocks can be written as they are done, and threads share the work.
"""

from __future__ import annotations

import pathlib
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from itertools import islice
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike

from duhem.errors import DuhemError, InputError
from duhem.law.catalogue import load_formula
from duhem.law.formula_law import Criterion
from duhem.law.state import evolves
from duhem.path.closest import closest_by, outside, shape_by
from duhem.path.history import STATES, SUMS, Checkpoint, Due, H, Histories, History, Interrupted, LeftDomain, LeftPrecision, told_of
from duhem.path.integrators import INTEGRATORS, STEPS
from duhem.path.loading import Path, Paths, Which, between, checked_count
from duhem.path.rows import Ledger, States, Step
from duhem.path.run import MOST_THREADS, Batch, Plan, Run, Share, columns, stress_at_start, times
from duhem.path.state_path import StateHistory, state_history
from duhem.path.step_formulas import booked
from duhem.projection.increment import beyond, crossed, posed, setting
from duhem.projection.result import Array, Status

__all__ = ["MOST_KEPT", "check_compiled", "driven", "first_stress", "parts", "simulate"]

_SAME = 1e-9  # of the largest stress that is added up: rounding is less, and another stiffness more


@overload
def simulate(law: Criterion | str | pathlib.Path, path: Path, **asked: Any) -> History | Any: ...
@overload
def simulate(law: Criterion | str | pathlib.Path, path: Paths, **asked: Any) -> Histories | Any: ...
def simulate(
    law: Criterion | str | pathlib.Path,
    path: Path | Paths,
    *,
    start: History | StateHistory | None = None,
    on_step: Callable[[int, int], None] | None = None,
    checkpoint: Checkpoint[Any] | None = None,
    **asked: Any,
) -> History | Histories | StateHistory:
    """:func:`duhem.simulate` where nobody asks whether K is convex: ``asked`` are the other fields of :class:`Run`."""
    return driven(Run(law, path, **asked), start, on_step, checkpoint)


def driven(
    run: Run,
    start: History | StateHistory | None = None,
    on_step: Callable[[int, int], None] | None = None,
    checkpoint: Checkpoint[Any] | None = None,
) -> History | Histories | StateHistory:
    """What a run leaves behind: a history of one path, histories of many; arguments and errors are those of :func:`duhem.simulate`."""
    method = run.method
    if not isinstance(method, str) or method not in INTEGRATORS:
        raise InputError(f"unknown method {method!r}", where="method", remedy=f"choose {', '.join(INTEGRATORS)}")
    if on_step is not None and not callable(on_step):
        raise InputError(f"{type(on_step).__name__} cannot be called", where="on_step", remedy="give a function of (done, all)")
    law = load_formula(run.law)
    run = replace(run, law=law)
    if evolves(law):
        return state_history(run, _part(start, StateHistory, run), on_step, checkpoint)
    start = _part(start, History, run)
    of_a_state = {"state": run.state, "tangent": run.tangent or None, "accuracy": run.accuracy}
    if key := next((key for key, given in of_a_state.items() if given is not None), None):
        what = f"{law.name} has no state, and {key} applies only to laws with one"
        raise InputError(what, where=key, remedy="remove it; stress= is the initial stress, and duhem.project gives tangents")
    if isinstance(run.path, Paths):
        return _many(Batch.of(run), method, run.threads, on_step)
    checked_count(run.threads, "threads", 1, MOST_THREADS)
    if run.keep != 1:
        raise InputError("keep applies only to many points", where="keep", remedy="remove it, or give Paths")
    plan = Plan.of(run)
    if plan.path.control == "stress":
        with np.errstate(all="ignore"):  # what is not finite is found
            return _prescribed(plan)
    integrator = INTEGRATORS[method]
    why = integrator.why(plan)
    advance = integrator.advance
    if run.compiled:
        check_compiled(method)
        from duhem.path import compiled_run

        advance, why = compiled_run.advance, f"{why}, compiled"
    with np.errstate(all="ignore"):
        ledger = Ledger.begun(len(plan.path.time), plan.path.values[0], _begun(plan, run, start), plan.compliance)
    if start is not None:
        _go_on(ledger, plan, method, start)
    steps = len(plan.path.time) - 1
    try:
        rows = advance(plan, ledger)
        due = Due(checkpoint)
        while (done := _next(rows)) is not None and np.isfinite(ledger.balance[done - 1]):
            if on_step is not None:
                on_step(done - 1, steps)
            if done <= steps:
                due(lambda: ledger.history(plan, method, why))
    except KeyboardInterrupt:
        raise Interrupted(ledger.history(plan, method, why)) from None
    except ArithmeticError:
        raise LeftPrecision(ledger.finite().history(plan, method, why), float(plan.path.time[ledger.done])) from None
    return _whole(ledger, plan, method, why)


def _part(start: History | StateHistory | None, kind: type[H], run: Run) -> H | None:
    """The first part of a run, where one is given; InputError where it is not of its kind, or the run is of many points."""
    if start is None:
        return None
    if not isinstance(start, kind):
        what = f"{type(start).__name__} is not a history of {load_formula(run.law).name}"
        raise InputError(what, where="start", remedy="give the history of the interrupted run")
    if isinstance(run.path, Paths):
        raise InputError("a run of many points cannot be continued with start", where="start", remedy="run only the remaining points")
    return start


def check_compiled(method: str) -> None:
    """InputError for a method of which one path is not compiled."""
    if method != "implicit":
        what = f"a single {method} path cannot be compiled"
        raise InputError(what, where="compiled", remedy='remove it, or use method="implicit"')


def _next(rows: Iterator[int]) -> int | None:
    with np.errstate(all="ignore"):
        return next(rows, None)


def _whole(ledger: Ledger, plan: Plan, method: str, why: str) -> History:
    """The rows of a run, all of them finite and within the law's ranges."""
    done, law = ledger.done, plan.increment.law
    if ledger.finite().done < done:
        raise LeftPrecision(ledger.history(plan, method, why), float(plan.path.time[ledger.done]))
    if (out := np.flatnonzero(beyond(law, ledger.stress[:done]))).size:
        ledger.done = int(out[0])
        raise LeftDomain(ledger.history(plan, method, why), crossed(law, ledger.stress[out]), float(plan.path.time[out[0]]))
    return ledger.history(plan, method, why)


def _outside(plan: Plan, stress: Array) -> int | None:
    """The first of ``stress`` (n, d), at as many knots, that lies outside K."""
    knots = np.arange(len(stress))
    out = np.flatnonzero(outside(Share.alone(plan), plan.projection, stress, knots, np.zeros_like(knots)))
    return int(out[0]) if out.size else None


def _begun(plan: Plan, run: Run, start: History | None) -> Array:
    """The stress at the first knot: that of the part to go on from, where none is given."""
    if start is None or run.stress is not None or start.stress.shape[1:] != plan.path.values.shape[1:] or not len(start):
        return first_stress(plan, run.stress)
    return first_stress(plan, start.stress[0])


def first_stress(plan: Plan, given: ArrayLike | None) -> Array:
    """The stress at the first knot (d,), 0 where none is given; InputError where it does not fit the law, or lies outside K."""
    law = plan.increment.law
    stress = np.array(stress_at_start(law, given, 1)[0])
    if _outside(plan, stress[None]) is not None:
        remedy = "give one inside K" if given is not None else "zero stress is not admissible: give stress= inside K"
        raise InputError(f"the initial stress {stress.tolist()} lies outside K", where="stress", remedy=remedy)
    if beyond(law, stress[None]).any():
        what = f"the initial stress: {crossed(law, stress[None])}"
        raise InputError(what, where="stress", remedy="give one inside the range")
    return stress


def _prescribed(plan: Plan) -> History:
    """A stress path inside K: the displacement follows, and nothing slips."""
    stress = plan.path.values
    if (i := _outside(plan, stress)) is not None:
        raise InputError(
            f"the stress {stress[i].tolist()} at time {plan.path.time[i]:g} lies outside K, where no equilibrium exists",
            where=f"path, step {i}",
            remedy='stay inside K, or prescribe the displacement (control="displacement")',
        )
    ledger = Ledger.begun(len(stress), times(stress[0], plan.compliance), stress[0], plan.compliance)
    before, after, none = columns(stress[:-1]), columns(stress[1:]), np.zeros_like(stress[1:].T)
    k, c = plan.stiffness[:, :, None], plan.compliance[:, :, None]
    _, _, added = booked(before, after, after, none, np.zeros(len(stress) - 1), False, none, none, k, c)
    ledger.rows(stress[1:], np.zeros_like(stress[1:]), added)
    return _whole(ledger, plan, "prescribed stress", "inside K the slip stays what it was")


def _go_on(ledger: Ledger, plan: Plan, method: str, start: History) -> None:
    """Copy the rows of an earlier part of the run into the ledger; InputError where it is none, as far as it tells."""
    n, path = len(start), plan.path
    pairs = ((start.time, path.time), (start.pressure, plan.increment.pressure), (start.displacement, path.values))
    same = 1 <= n <= len(path.time) and all(np.array_equal(old, new[:n]) for old, new in pairs)
    same = same and start.law == plan.increment.law.name and np.array_equal(start.stress[0], ledger.stress[0])
    if same and start.plan is not None:
        old, new = start.plan, plan
        same = old.increment.g == new.increment.g and old.projection == new.projection
        same = same and start.method in ("", method)  # a part that was read does not say how it was integrated
    if not same or not _elastic(start, plan):
        raise InputError("the given history belongs to another run", where="start", remedy="start afresh")
    ledger.resume(start)


def _elastic(start: History, plan: Plan) -> bool:
    """Whether its stresses are k (u - u_in) with the stiffness of the plan, to rounding."""
    moved, slipped = times(start.displacement, plan.stiffness), times(start.slip, plan.stiffness)
    size = np.maximum(np.maximum(np.abs(moved).max(), np.abs(slipped).max()), np.abs(start.stress).max())
    return bool(np.abs(moved - slipped - start.stress).max() <= _SAME * size)


# -- many points, block by block -----------------------------------------------------------------------------------------


MOST_KEPT = 1 << 28  # numbers in memory: 2 GiB


def _many(batch: Batch, method: str, threads: int, on_step: Callable[[int, int], None] | None) -> Histories:
    """All points; Interrupted with those that are done.  InputError where they do not fit into memory."""
    n, done, why = len(batch.own), 0, ""
    if n * batch.numbers > MOST_KEPT:
        raise InputError(
            f"{n} points with {len(batch.knots)} knots each are {8 * n * batch.numbers / 2**30:.3g} GiB, and 2 GiB are kept in memory",
            where="keep",
            remedy='keep fewer knots (keep="last" or keep=n), or run a scene, which writes its table step by step',
        )
    whole = _room(batch, 0, n, method)
    try:
        for part in parts(batch, method, threads, whole):
            done, why = int(part.points[-1]) + 1, part.why
            if on_step is not None:
                on_step(done, n)
    except KeyboardInterrupt:
        raise Interrupted(replace(_view(whole, 0, done), why=why) if done else None) from None
    return replace(whole, why=why)


def parts(batch: Batch, method: str, threads: int = 1, into: Histories | None = None, first: int = 0) -> Iterator[Histories]:
    """The histories of the points, block after block, from the block on that begins with ``first``.

    No more blocks than ``threads`` are in memory at once; the numbers are the same for every number of threads.
    """
    if not first:
        check(batch)
    halves = STEPS[method].halves if method in STEPS else 1
    blocks = iter([block for block in batch.blocks() if block[0] >= first])

    def work(block: tuple[int, int]) -> Histories:
        out = _room(batch, *block, method) if into is None else _view(into, *block)
        share = batch.block(*block, halves)
        with np.errstate(all="ignore"):  # what is not finite is found
            why = _filled(batch, share, method, out)
        _note_prescribed(share, halves, out)
        member = replace(batch.members[0], pressure=out.pressure[:, -1])
        if member.convexity is not None:
            out.status[(out.status == Status.SLIP) & ~member.shown_convex()] = Status.STATIONARY
        return replace(out, why=why)

    if threads == 1:
        yield from map(work, blocks)
        return
    with ThreadPoolExecutor(threads) as pool:
        under_way: list[Future[Histories]] = [pool.submit(work, block) for block in islice(blocks, threads)]
        try:
            while under_way:
                done = under_way.pop(0).result()
                under_way += [pool.submit(work, block) for block in islice(blocks, 1)]
                yield done
        finally:
            for future in under_way:
                future.cancel()


def check(batch: Batch) -> None:
    """InputError for a point whose stress at the first knot lies outside K or a declared range."""
    for first, last in batch.blocks():
        share = batch.start(first, last)
        with np.errstate(all="ignore"):  # what is not finite is found
            bad = outside(share, batch.run.projection, share.stress, 0, np.arange(len(share))) | beyond(batch.law, share.stress)
        if bad.any():
            at = int(np.argmax(bad))
            what = f"the initial stress {share.stress[at].tolist()} of point {first + at} lies outside K or a declared range"
            raise InputError(what, where="stress", remedy="give stress= inside")


def _filled(batch: Batch, block: Share, method: str, out: Histories) -> str:
    """Fill the histories of one block but for what is prescribed; it says how."""
    if method not in STEPS:
        return [_alone(block, i, batch.run.projection, method, out) for i in range(len(block))][-1]
    shape, points = shape_by(block, batch.run.projection), np.arange(len(block))
    at, why = closest_by(block, batch.run.projection, shape, batch.run.compiled)
    if batch.run.compiled and method == "implicit":
        from duhem.path import compiled_run

        if shape is not None and compiled_run.reason(block, shape) is None:
            compiled_run.fill(block, shape, out)
            return f"{why}, compiled"
        if (left := compiled_run.looped(block, batch.run.projection, out)) is not None:
            points, why = left, f"{why}, compiled"
    if points.size:
        _abreast(block, points, STEPS[method].by_arrays(block, at), out)
    return f"{why}{STEPS[method].said}"


def _abreast(block: Share, points: Which, step: Step, out: Histories) -> None:
    """These points from the first knot to the last, at each those that still go on."""
    states, rows = States.begun(block), {knot: row for row, knot in enumerate(out.knots.tolist())}
    which = points
    for knot in range(int(out.knots[-1]) + 1):
        if knot and which.size:
            states.take(block, which, step(states.anchor_stress[which], states.anchor[which], states.stress[which], knot, which))
            which = which[states.reached[which] == knot]
        if knot in rows:
            states.keep(out, points, rows[knot])
    out.status[points], out.reached[points] = states.status[points], states.reached[points]


def _note_prescribed(block: Share, halves: int, out: Histories) -> None:
    """What is prescribed at the kept knots; nan where a point has not come so far."""
    every = np.arange(len(block))
    for row, knot in enumerate(out.knots.tolist()):
        out.displacement[:, row] = block.paths.at(halves * knot)
        out.pressure[:, row] = block.paths.pressure_at(halves * knot, every)
        if (gone := np.flatnonzero(out.reached < knot)).size:
            for name in ("displacement", "slip", "stress", *SUMS):
                getattr(out, name)[gone, row] = np.nan


def _alone(block: Share, i: int, projection: str, method: str, out: Histories) -> str:
    """One point by its own path, where an integrator takes one at a time."""
    member, path = block.members[block.own[i]], block.paths.path(i)
    whole = replace(setting(member.law, member.stiffness, member.parameters), convexity=member.convexity)
    increment = posed(whole, path.values, path.pressure)
    plan = Plan(increment, path, projection, block.compliance)
    integrator = INTEGRATORS[method]
    ledger, status = Ledger.begun(len(path.time), path.values[0], block.stress[i], plan.compliance), None
    rows = integrator.advance(plan, ledger)
    try:
        while next(rows, None) is not None and np.isfinite(ledger.balance[ledger.done - 1]):
            pass
    except InputError:
        raise
    except (DuhemError, ArithmeticError):
        status = Status.FAILED
    if ledger.finite().done < len(path.time):
        status = Status.FAILED
    if (gone := np.flatnonzero(beyond(increment.law, ledger.stress[: ledger.done]))).size:
        ledger.done, status = int(gone[0]), Status.OUTSIDE
    ledger.keep(out, i)
    out.status[i] = out.status[i] if status is None else status
    return integrator.why(plan)


def _room(batch: Batch, first: int, last: int, method: str) -> Histories:
    law, n, r = batch.law, last - first, len(batch.knots)
    d = len(law.forces)
    return Histories(
        points=np.arange(first, last),
        knots=batch.knots,
        time=between(batch.paths.time, batch.run.substeps)[batch.knots],
        timed=batch.paths.timed,
        **told_of(law, **{name: np.empty((n, r, d) if name in ("displacement", "slip", "stress") else (n, r)) for name in STATES}),
        status=np.empty(n, dtype=np.int8),
        reached=np.empty(n, dtype=np.intp),
        method=method,
        why="",
    )


def _view(whole: Histories, first: int, last: int) -> Histories:
    """Some points of ``whole``, in its memory."""
    each = {name: getattr(whole, name)[first:last] for name in ("points", *STATES, "status", "reached")}
    return replace(whole, **each)
