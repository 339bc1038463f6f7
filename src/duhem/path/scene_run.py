"""A scene's run with what it writes; an interrupted run keeps what is done."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

from duhem.errors import InputError
from duhem.path import kept_part
from duhem.path.batch_run import parts
from duhem.path.growing_table import GrowingTable
from duhem.path.history import History, columns
from duhem.path.loading import Path
from duhem.path.scene import Scene
from duhem.path.simulate import Interrupted, LeftDomain, LeftPrecision
from duhem.show import figure, parquet_package
from duhem.show.growing_file import beside, check_growing, check_kept
from duhem.show.place import check_places

__all__ = ["PointCounts", "Stopped", "check_outputs", "perform", "perform_many"]


class PointCounts(NamedTuple):
    """What came of many ``points``: how many ``ended`` early, and how many slip to ``stationary`` points and no more is shown of them."""

    points: int
    ended: int
    stationary: int


class Stopped(KeyboardInterrupt):
    """A run that was interrupted; its text says what is kept and how to go on."""


def check_outputs(table: str | None, plot: str | None, resume: bool, inputs: Sequence[str] = (), many: bool = False) -> None:
    """Whether the files can be written in these formats with what is installed, before a long run and not after it.

    None is one of the ``inputs``, and what may stand where the part of a run is kept is such a part.  Of ``many`` points the table
    grows as they are done, and there is no picture.
    """
    if many and plot is not None:
        raise InputError("a picture shows one point", where=plot, remedy="leave the plot out, or draw one point's history")
    if table is not None and not table.endswith((".csv", ".parquet")):
        raise InputError("the table is neither .csv nor .parquet", where=table, remedy="end its name in .csv or .parquet")
    if table is None and resume:
        raise InputError("there is no table to go on with", where="--resume", remedy="name it with --out or in [output]")
    if table is not None and table.endswith(".parquet"):
        parquet_package.check()
    check_places([table, plot], inputs)
    if table is not None:
        (check_growing if many else check_kept)(table, inputs)
    if plot is not None:
        figure.check(plot)


def perform(scene: Scene, table: str | None, resume: bool, on_step: Callable[[int, int], None] | None = None) -> History:
    """Run the scene of one point and write ``table``; Stopped with the part kept beside it if interrupted.

    From there ``resume`` goes on, and from what was kept every ``scene.checkpoint`` seconds if the process was killed.
    """
    start = kept_part.recall(table, scene.plan(), scene.fingerprint) if table is not None and resume else None
    fingerprint = scene.fingerprint
    try:
        history = scene.run(start, on_step, None if table is None else partial(_keep, table, fingerprint))
    except Interrupted as stop:
        assert isinstance(stop.history, History) and isinstance(scene.path, Path)
        steps = (len(scene.path.time) - 1) * scene.substeps
        done = f"interrupted after {len(stop.history) - 1} of {steps} steps"
        if table is None:
            raise Stopped(f"{done}; name a table with --out to keep what is done") from None
        kept = kept_part.keep(stop.history, table, fingerprint)
        raise Stopped(f"{done}, kept in {kept}; go on with --resume") from None
    except (LeftPrecision, LeftDomain) as fault:
        if table is None:
            raise
        kept = kept_part.keep(fault.history, table, fingerprint)
        raise InputError(f"{fault.what}; the steps before are kept in {kept}", where=fault.where, remedy=fault.remedy) from None
    if table is not None:
        (history.to_parquet if table.endswith(".parquet") else history.to_csv)(table)
        beside(table).unlink(missing_ok=True)
    return history


def _keep(table: str, fingerprint: str, done: History) -> None:
    kept_part.keep(done, table, fingerprint)


def perform_many(
    scene: Scene, table: str | None, resume: bool, say: Callable[[str], None], on_step: Callable[[int, int], None] | None = None
) -> PointCounts:
    """Run the scene of many points, whose ``table`` grows as they are done; how many of them came out how.

    Without a table the rows are said, some at a time.  Stopped if interrupted: the points that are done are kept.
    """
    batch = scene.batch()
    n, ended, stationary = len(batch.own), 0, 0
    if table is None:
        for part in parts(batch, scene.method, scene.threads):
            text = "".join(part.rows())
            say((text if part.points[0] else ",".join(part.columns()) + "\n" + text).removesuffix("\n"))
            ended += part.ended_early()
            stationary += part.stationary()
        return PointCounts(n, ended, stationary)
    with GrowingTable(table, scene.fingerprint, ("point", *columns(batch.law.forces, batch.law.pressure)), resume) as growing:
        try:
            for part in parts(batch, scene.method, scene.threads, first=growing.points):
                growing.add(part)
                if on_step is not None:
                    on_step(growing.points, n)
        except KeyboardInterrupt:
            kept = beside(table)
            raise Stopped(f"interrupted after {growing.points} of {n} points, kept in {kept}; go on with --resume") from None
        growing.finish()
        return PointCounts(n, growing.ended, growing.stationary)
