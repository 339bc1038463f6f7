"""A checked scene as a value: what it runs, what it needs and what it leaves out; and its run with what it writes."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import islice
from pathlib import Path as File
from typing import Any, NamedTuple

import numpy as np

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Interval
from duhem.law.state import evolves
from duhem.omitted import LeftOut
from duhem.path.history import SUMS, EndedEarly, H, Histories, History, Interrupted, Tabled, columns, told_of
from duhem.path.loading import Path, Paths
from duhem.path.run import Batch, Plan, Run
from duhem.path.simulate import driven, parts
from duhem.path.state_path import StateHistory, recalled
from duhem.path.state_question import StateQuestion
from duhem.projection.result import NOT_SHOWN, Array, Status
from duhem.show import figure
from duhem.show.place import (
    DAMAGED,
    MARK,
    UNREADABLE,
    AnyPath,
    GrowingFile,
    another,
    beside,
    check_growing,
    check_kept,
    check_parquet,
    check_place,
    check_places,
    parquet_packages,
    written,
)

__all__ = [
    "GrowingTable", "Needed", "PointCounts", "Scene", "Stopped", "check_outputs", "history_of", "keep", "perform", "perform_many",
    "recall",
]  # fmt: skip


@dataclass(frozen=True)
class Needed:
    """A part of the program that the scene needs, and why."""

    part: str
    reason: str


@dataclass(frozen=True, eq=False)
class Scene(Run):
    """A checked scene; ``fingerprint`` tells runs of different scenes apart, ``inputs`` are the files that it names and reads.

    It is a run, ``parameters`` of many points a number or one a point; ``checkpoint`` the seconds after which what is done is kept.
    ``convex`` is what the scene says of K; ``convexity`` what is known of it once somebody has asked (:mod:`duhem.api`).
    """

    law: Criterion
    parameters: Mapping[str, Any] = field(default_factory=dict)
    checkpoint: float = 60.0
    table: str | None = None
    plot: str | None = None
    stress_unit: str = "Pa"
    length_unit: str = "m"
    inputs: tuple[str, ...] = ()
    convex: str = "ask"

    def run(
        self,
        start: History | StateHistory | None = None,
        on_step: Callable[[int, int], None] | None = None,
        keep: Callable[[Any], object] | None = None,
    ) -> History | StateHistory:
        """The history of one point; ``start`` and ``on_step`` as in :func:`duhem.simulate`, ``keep`` its checkpoint."""
        self.check_asked()
        alone = replace(self, keep=1, threads=1)  # both speak of many points
        history = driven(alone, start, on_step, None if keep is None else (self.checkpoint, keep))
        assert not isinstance(history, Histories)
        return history

    def check_asked(self) -> None:
        """InputError where the scene requires what nobody has asked."""
        if self.convex == "require" and self.convexity is None:
            raise InputError("it is unknown whether K is convex", where="convex", remedy="run the scene that duhem.api returns")

    def batch(self) -> Batch:
        """The checked question of a run of many points."""
        self.check_asked()
        return Batch.of(self)

    @property
    def many(self) -> bool:
        """Whether it runs many points."""
        return isinstance(self.path, Paths)

    def plan(self) -> Plan:
        """The checked question of the run, of the first point where there are many."""
        if not isinstance(self.path, Paths):
            return Plan.of(self)
        first = {name: np.atleast_1d(value)[0].item() for name, value in self.parameters.items()}
        return Plan.of(replace(self, path=self.path.path(0), parameters=first))

    @property
    def fingerprint(self) -> str:
        """Of all that determines the numbers, in hexadecimal."""
        path = self.path
        each = {name: np.asarray(value) for name, value in self.parameters.items() if np.ndim(value)}
        alike = sorted(item for item in self.parameters.items() if item[0] not in each)
        given: tuple[Any, ...] = (self.law, alike, self.stiffness, self.method, self.projection, self.substeps, self.stress)
        if isinstance(path, Paths):
            given = (*given, self.keep, sorted(each))
            arrays = [path.values, path.factor, *(each[name] for name in sorted(each))]
        else:
            given = (*given, path.control)
            arrays = [path.values, *([path.arc.angle] if path.arc else [])]
        arrays += [path.time, *([] if path.pressure is None else [path.pressure])]
        more: list[Any] = [*(["compiled"] if self.compiled else []), *([sorted(self.state.items())] if self.state else [])]
        more += [] if self.accuracy is None else [self.accuracy]
        digest = hashlib.sha256(repr((*given, *more)).encode())
        for array in arrays:
            digest.update(repr(array.shape).encode())
            digest.update(array.tobytes())
        return digest.hexdigest()[:32]

    def parts(self, table: str | None = None, plot: str | None = None) -> tuple[Needed | LeftOut, ...]:
        """What a run of the scene needs and what it leaves out, with the reason."""
        return (
            *(_of_a_state(self) if evolves(self.law) else _of_closest_points(self, self.plan())),
            Needed("matplotlib", f"plot {plot}") if plot else LeftOut("matplotlib", "nothing is plotted"),
            Needed("pyarrow", f"table {table}")
            if table and table.endswith(".parquet")
            else LeftOut("pyarrow", "the scene writes no Parquet file"),
        )


def _of_closest_points(scene: Scene, plan: Plan) -> tuple[Needed | LeftOut, ...]:
    return (
        _integration(scene, plan),
        _solver(scene, plan),
        LeftOut("thermal block", "the law is isothermal: it has no temperature"),
        LeftOut("flow check", "the law is associated: its slip is normal to K by definition"),
        LeftOut("K at every step", "the pressure is constant: K is computed once")
        if plan.path.constant_pressure
        else Needed("K at every step", "the pressure changes along the path"),
    )


def _of_a_state(scene: Scene) -> tuple[Needed | LeftOut, ...]:
    question = StateQuestion.of(scene)
    heat = "found from the heat" if question.law.adiabatic else "prescribed"
    return (
        LeftOut("closest point", "the law has a state, rates or a flow of its own"),
        Needed("implicit step", question.why),
        Needed("thermal block", f"the temperature {scene.law.temperature} is {heat}")
        if scene.law.temperature
        else LeftOut("thermal block", "the law is isothermal: it has no temperature"),
    )


def _integration(scene: Scene, plan: Plan) -> Needed | LeftOut:
    name = "ordinary differential equation"
    if plan.path.control == "stress":
        return LeftOut(name, "the stress is prescribed: the displacement follows from it")
    if scene.method != "exact":
        question = plan.increment
        shown = question.convexity is None or question.shown_convex().all()
        return LeftOut(name, f"{scene.method} steps: {'closest points only' if shown else f'stationary points only; {NOT_SHOWN}'}")
    from duhem.path.exact import elementary, why

    reason = elementary(plan)
    return LeftOut(name, why(plan)) if reason is None else Needed(name, why(plan).partition(": ")[2])


def _solver(scene: Scene, plan: Plan) -> Needed | LeftOut:
    from duhem.projection import closed_form

    name, reason = "solver (CVXPY or Newton)", closed_form.applies(plan.increment)
    loop = scene.method == "implicit" and not (scene.compiled or scene.many) and scene.projection in ("auto", "newton")
    remark = "; this computes some hundred steps per second, or some hundred thousand with compiled = true in [method]" if loop else ""
    if scene.projection not in ("auto", "closed-form"):
        return Needed(name, f"projection {scene.projection} is selected{remark}")
    if reason is None:
        one = isinstance(scene.law.closed_form, Interval)
        return LeftOut(name, "one-dimensional: closed form" if one else "the closest point has a closed form")
    return Needed(name, f"{reason.partition(':')[0]}{remark}")


# -- the run with what it writes: its table, which of many points grows as they are done, and the part of a run that was stopped


class PointCounts(NamedTuple):
    """What came of many ``points``: how many ``ended`` early, and how many slip to ``stationary`` points and no more is shown of them."""

    points: int
    ended: int
    stationary: int


class Stopped(KeyboardInterrupt):
    """A run that was interrupted; its text says what is kept and how to go on."""


def check_outputs(
    table: str | None, plot: str | None, resume: bool, inputs: Sequence[str] = (), many: bool = False, law: Criterion | None = None
) -> None:
    """Whether the files can be written in these formats with what is installed, before a long run and not after it.

    None is one of the ``inputs``, and what may stand where the part of a run is kept is such a part.  Of ``many`` points the table
    grows as they are done, but not that of a ``law`` with a state, and there is no picture.
    """
    if law is not None and evolves(law) and many and resume:
        what = f"{law.name} has a state or a flow of its own: duhem does not continue its run of many points"
        raise InputError(what, where="--resume", remedy="run it again without --resume")
    if many and plot is not None:
        raise InputError("a picture can show only one point", where=plot, remedy="remove the plot, or draw the history of one point")
    if table is not None and not table.endswith((".csv", ".parquet")):
        raise InputError("the table is neither .csv nor .parquet", where=table, remedy="end its name in .csv or .parquet")
    if table is None and resume:
        raise InputError("there is no table to continue", where="--resume", remedy="name it with --out or in [output]")
    if table is not None and table.endswith(".parquet"):
        check_parquet()
    check_places([table, plot], inputs)
    if table is not None:
        (check_growing if many else check_kept)(table, inputs)
    if plot is not None:
        figure.check(plot)


def perform(scene: Scene, table: str | None, resume: bool, on_step: Callable[[int, int], None] | None = None) -> History | StateHistory:
    """Run the scene of one point and write ``table``; Stopped with the part kept beside it if interrupted.

    From there ``resume`` goes on, and from what was kept every ``scene.checkpoint`` seconds if the process was killed.
    """
    fingerprint, start = scene.fingerprint, None
    if table is not None and resume:
        read: Any = partial(recalled, scene) if evolves(scene.law) else partial(history_of, scene.plan())
        start = recall(table, read, fingerprint)
    try:
        history = scene.run(start, on_step, None if table is None else lambda done: keep(done, table, fingerprint))
    except Interrupted as stop:
        assert isinstance(scene.path, Path)
        steps = (len(scene.path.time) - 1) * scene.substeps
        done = f"interrupted after {len(stop.history) - 1} of {steps} steps"
        if table is None:
            raise Stopped(f"{done}; name a table with --out to keep what is done") from None
        kept = keep(stop.history, table, fingerprint)
        raise Stopped(f"{done}, kept in {kept}; continue with --resume") from None
    except EndedEarly as fault:
        if table is None:
            raise
        kept = keep(fault.history, table, fingerprint)
        raise InputError(f"{fault.what}; the steps before are kept in {kept}", where=fault.where, remedy=fault.remedy) from None
    if table is not None:
        (history.to_parquet if table.endswith(".parquet") else history.to_csv)(table)
        beside(table).unlink(missing_ok=True)
    return history


def perform_many(
    scene: Scene, table: str | None, resume: bool, say: Callable[[str], None], on_step: Callable[[int, int], None] | None = None
) -> PointCounts:
    """Run the scene of many points, whose ``table`` grows as they are done; how many of them came out how.

    Without a table the rows are said, some at a time.  Stopped if interrupted: the points that are done are kept.  Of a law with a
    state there is one table at the end, and nothing is kept.
    """
    if evolves(scene.law):
        found = driven(scene, None, on_step)
        assert isinstance(found, StateHistory)
        if table is None:
            say(found.to_text().removesuffix("\n"))
        else:
            (found.to_parquet if table.endswith(".parquet") else found.to_csv)(table)
        return PointCounts(len(found), int(np.isin(found.status, (Status.FAILED, Status.OUTSIDE)).sum()), 0)
    batch = scene.batch()
    n = len(batch.own)
    if table is None:
        came = PointCounts(n, 0, 0)
        for part in parts(batch, scene.method, scene.threads):
            text = "".join(part.rows())
            say((text if part.points[0] else ",".join(part.columns()) + "\n" + text).removesuffix("\n"))
            came = PointCounts(n, came.ended + part.ended_early(), came.stationary + part.stationary())
        return came
    with GrowingTable(table, scene.fingerprint, ("point", *columns(batch.law.forces, batch.law.pressure)), resume) as growing:
        try:
            for part in parts(batch, scene.method, scene.threads, first=growing.points):
                growing.add(part)
                if on_step is not None:
                    on_step(growing.points, n)
        except KeyboardInterrupt:
            kept = beside(table)
            raise Stopped(f"interrupted after {growing.points} of {n} points, kept in {kept}; continue with --resume") from None
        growing.finish()
        return PointCounts(n, growing.ended, growing.stationary)


def keep(history: Tabled, file: str | os.PathLike[str], fingerprint: str) -> File:
    """Write what is done; ``fingerprint`` is that of the run.  A sum over the table shows what was changed or cut off since."""
    place = beside(file)
    history.to_csv(place, above=f"{MARK}{fingerprint} {_sum(history.to_text())}")
    return place


def recall(file: str | os.PathLike[str], read: Callable[[dict[str, Array]], H], fingerprint: str) -> H | None:
    """The part kept of the run ``fingerprint``, ``read`` from its columns, or None.  InputError if it is of another run or damaged."""
    place = beside(file)
    try:
        text = place.read_text(encoding="utf-8")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError):
        raise InputError("the file of an interrupted run cannot be read", where=f"{place}", remedy=UNREADABLE) from None
    mark, _, table = text.partition("\n")
    if not mark.startswith(f"{MARK}{fingerprint} "):
        raise another(place)
    try:
        if mark != f"{MARK}{fingerprint} {_sum(table)}":
            raise ValueError
        header, *lines = table.splitlines()
        rows = np.array([[float(cell) for cell in line.split(",")] for line in lines])
        if not np.isfinite(rows).all():
            raise ValueError
        column = dict(zip(header.split(","), rows.T, strict=True))
        return read(column)
    except (ValueError, KeyError, IndexError):
        raise InputError("the file of an interrupted run is damaged", where=f"{place}", remedy=DAMAGED) from None


def _sum(table: str) -> str:
    return hashlib.sha256(table.encode()).hexdigest()


def history_of(plan: Plan, column: dict[str, Array]) -> History:
    """The history of a run from the columns of its table."""
    law, n = plan.increment.law, len(column["time"])
    tails = [force.removeprefix("sigma_") for force in law.forces]
    return History(
        time=column["time"],
        timed=plan.path.timed,
        displacement=np.stack([column[f"u_{t}"] for t in tails], axis=1),
        slip=np.stack([column[f"u_in_{t}"] for t in tails], axis=1),
        stress=np.stack([column[f] for f in law.forces], axis=1),
        pressure=column[law.pressure] if law.pressure else np.zeros(n),
        multiplier=column["lambda"],
        **told_of(law, **{name: column[name] for name in SUMS[1:]}),
        method="",
        why="",
        plan=plan,
    )


_LINES = 65_536  # of a table, turned into Parquet together


class GrowingTable(GrowingFile):
    """The table ``file`` of the run ``fingerprint`` with these ``columns``; ``points`` are done.

    Of these ``ended`` ended early, and ``stationary`` slip to stationary points, of which no more is shown.

    ``resume`` goes on with what is there; InputError if that is of another run or damaged.  Use it as a context: what is whole
    stays, and :meth:`finish` puts the table in its place.
    """

    def __init__(self, file: AnyPath, fingerprint: str, columns: tuple[str, ...], resume: bool) -> None:
        super().__init__(file, fingerprint, (0, 0, 0), resume)
        self.file = os.fspath(file)
        self.points, self.ended, self.stationary = self.counts
        if not self.size:
            self.write(",".join(columns) + "\n")

    def add(self, part: Histories) -> None:
        """The rows of further points; they are noted once they are all there."""
        for text in part.rows():
            self.write(text)
        self.points += len(part)
        self.ended += part.ended_early()
        self.stationary += part.stationary()
        self.note(self.points, self.ended, self.stationary)

    def finish(self) -> None:
        """The table in its place, as Parquet where its name says so; nothing is left beside it."""
        self.end()
        check_place(self.file)
        if self.file.endswith(".parquet"):
            _to_parquet(self.rows, self.file)
        else:
            os.replace(self.rows, self.file)
        self.drop()


def _to_parquet(rows: File, file: str) -> None:
    """The same table as Parquet, some rows at a time."""
    pyarrow, parquet = parquet_packages()
    with written(file) as place, open(rows, encoding="utf-8") as stream:
        names = stream.readline().rstrip("\n").split(",")
        schema: Any = pyarrow.schema([(name, pyarrow.int64() if name == "point" else pyarrow.float64()) for name in names])
        with parquet.ParquetWriter(place, schema) as writer:
            while lines := list(islice(stream, _LINES)):
                columns = zip(*(line.split(",") for line in lines), strict=True)
                numbers = [list(map(int if name == "point" else float, column)) for name, column in zip(names, columns, strict=True)]
                writer.write_table(pyarrow.table(dict(zip(names, numbers, strict=True)), schema=schema))
