"""Runs of many points: block by block, so that memory is bounded, blocks can be written as they are done, and threads share the work."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from itertools import islice

import numpy as np

from duhem.errors import DuhemError, InputError
from duhem.path.closest import closest_by, outside, shape_by
from duhem.path.history import STATES, SUMS, Histories
from duhem.path.integrators import INTEGRATORS, STEPS
from duhem.path.ledger import Ledger, States
from duhem.path.loading import Which, between
from duhem.path.rows import Step
from duhem.path.run import Batch, Plan, Share
from duhem.projection.declared_ranges import beyond
from duhem.projection.increment import posed, setting
from duhem.projection.result import Status

__all__ = ["MOST_KEPT", "check", "histories", "parts"]

MOST_KEPT = 1 << 28  # numbers in memory: 2 GiB


def histories(batch: Batch, method: str, threads: int, on_step: Callable[[int, int], None] | None) -> Iterator[Histories]:
    """What is done after each block: the points up to there, at last all of them.  InputError where they do not fit into memory."""
    n = len(batch.own)
    if n * batch.numbers > MOST_KEPT:
        raise InputError(
            f"{n} points with {len(batch.knots)} knots each are {8 * n * batch.numbers / 2**30:.3g} GiB, and 2 GiB are kept in memory",
            where="keep",
            remedy='keep fewer knots (keep="last" or keep=n), or run a scene, which writes its table step by step',
        )
    whole = _room(batch, 0, n, method)
    for part in parts(batch, method, threads, whole):
        done = int(part.points[-1]) + 1
        yield replace(_view(whole, 0, done), why=part.why)
        if on_step is not None:
            on_step(done, n)


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
        _prescribed(share, halves, out)
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
            bad = outside(share, batch.projection, share.stress, 0, np.arange(len(share))) | beyond(batch.law, share.stress)
        if bad.any():
            at = int(np.argmax(bad))
            what = f"the initial stress {share.stress[at].tolist()} of point {first + at} lies outside K or a declared range"
            raise InputError(what, where="stress", remedy="give stress= inside")


def _filled(batch: Batch, block: Share, method: str, out: Histories) -> str:
    """Fill the histories of one block but for what is prescribed; it says how."""
    if method not in STEPS:
        return [_alone(block, i, batch.projection, method, out) for i in range(len(block))][-1]
    shape, points = shape_by(block, batch.projection), np.arange(len(block))
    at, why = closest_by(block, batch.projection, shape, batch.compiled)
    if batch.compiled and method == "implicit":
        from duhem.path import compiled_run

        if shape is not None and compiled_run.reason(block, shape) is None:
            compiled_run.fill(block, shape, out)
            return f"{why}, compiled"
        if (left := compiled_run.looped(block, batch.projection, out)) is not None:
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


def _prescribed(block: Share, halves: int, out: Histories) -> None:
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
        law=law.name,
        forces=law.forces,
        pressure_name=law.pressure,
        points=np.arange(first, last),
        knots=batch.knots,
        time=between(batch.paths.time, batch.substeps)[batch.knots],
        timed=batch.paths.timed,
        **{name: np.empty((n, r, d) if name in ("displacement", "slip", "stress") else (n, r)) for name in STATES},
        status=np.empty(n, dtype=np.int8),
        reached=np.empty(n, dtype=np.intp),
        method=method,
        why="",
    )


def _view(whole: Histories, first: int, last: int) -> Histories:
    """Some points of ``whole``, in its memory."""
    each = {name: getattr(whole, name)[first:last] for name in ("points", *STATES, "status", "reached")}
    return replace(whole, **each)
