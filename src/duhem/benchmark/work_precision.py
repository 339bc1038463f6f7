"""Error against run time: one increment by every method and solver, a path by every integrator, and cost a point at scale.

The scenes are taken in turn; what is done when a run is interrupted is kept.

A loading path is taken by every integrator over step counts, against the path in many digits, and by ``duhem.simulate`` at length.  At
length are many points over many implicit steps, and one path of very many, in wall time a step of one point.  What the steps of
many points are held to is the compiled kernel by itself, on as many points as stay in the cache.  Memory is what the run takes at its
peak, results included, beyond what it was given.  What is compiled on first use is compiled before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec

import numpy as np

from duhem.benchmark import throughput
from duhem.benchmark.contenders import Contender, Specimen, applicable
from duhem.benchmark.measurement import Measurement, Target, WorkPrecision, at_most, measured, memory, ratio, timed
from duhem.benchmark.reference import Drive, Driven, NoReference, distance
from duhem.errors import DuhemError, InputError
from duhem.law.formula_law import Criterion
from duhem.omitted import LeftOut
from duhem.path.integrators import INTEGRATORS
from duhem.path.loading import Path, Paths
from duhem.path.simulate import simulate
from duhem.projection.in_blocks import cores
from duhem.projection.result import Array

__all__ = ["SCENES", "WorkPrecision", "bench"]

# -- loading paths -----------------------------------------------------------------------------------------------------

PATH, LONG = "path", "paths"
STEPS = (1, 4, 16, 64, 256, 1024)
_SLOW = 1.0  # a setting whose run takes longer is the last of its integrator
_TURNS = np.array([0.35, -0.5, 0.15, 0.8])  # of pi, the directions of the steps in the first two displacements
_LENGTHS = np.array([1.8, 1.5, 2.2, 2.5])  # of the reach of K, as a displacement

KERNEL, ONE, MANY, ALONE = "kernel alone", "one path", "many points", ", one thread"
NUMBA = ", numba"
_KERNEL = 4_032  # points of the kernel
_PIECES = 10  # straight pieces of each path
_UNCOMPILED = 1_000  # steps of what is not compiled; a law without a declared shape takes so many times fewer points
_FEW = 100  # steps of each of many points where the law declares no shape


@dataclass(frozen=True)
class Route:
    """Knots (m, d) in m, joined by straight steps under constant pressure, and the stresses there in many digits."""

    specimen: Specimen
    points: Array
    driven: Driven


def route(specimen: Specimen) -> Route:
    """Four straight steps that slip, turn and unload; NoReference where the path has no reference."""
    d = len(specimen.law.forces)
    angles = np.pi * _TURNS
    ways = np.zeros((len(angles), d))
    ways[:, 0] = np.cos(angles) if d > 1 else np.cos(np.pi * np.arange(len(angles)))
    if d > 1:
        ways[:, 1] = np.sin(angles)
    axes = np.eye(d)[: min(d, 2)]
    reach = min(r for r in (specimen.radius(sign * axis, specimen.pressure) for axis in axes for sign in (1, -1)) if r > 0)
    points = np.vstack([np.zeros(d), np.cumsum(_LENGTHS[:, None] * reach * ways, axis=0)]) / float(np.diagonal(specimen.stiffness).mean())
    question = specimen.unloaded
    drive = Drive(question.g, specimen.law.force_symbols(), question.pressure_symbol, question.stiffness.tolist(), specimen.pressure)
    return Route(specimen, points, drive(points.tolist()))


def path_rows(work: Route, repeats: int, left_out: list[LeftOut], steps: tuple[int, ...] = STEPS) -> Iterator[Measurement]:
    """A row for each integrator and step count; what grows too slow or does not apply goes to ``left_out``."""
    for method in INTEGRATORS:
        for count in steps:
            row = _row(work, method, count, repeats)
            yield row
            if row.failure is not None or (row.seconds is not None and row.seconds.median > _SLOW):
                if more := [n for n in steps if n > count]:
                    why = "failed" if row.failure is not None else f"takes {row.seconds.median:.1f} s" if row.seconds else ""
                    left_out.append(LeftOut(f"{method} with {', '.join(map(str, more))} steps a segment", f"{count} already {why}"))
                break


def _row(work: Route, method: str, count: int, repeats: int) -> Measurement:
    specimen, path = work.specimen, Path.linear(work.points, pressure=work.specimen.pressure)
    setting = f"{count} step{'s' if count > 1 else ''} a segment"
    history = None

    def run() -> None:
        nonlocal history
        history = simulate(specimen.declared, path, stiffness=specimen.stiffness, method=method, substeps=count)

    try:
        seconds = timed(run, repeats)
    except DuhemError as fault:
        return Measurement(PATH, method, setting, failure=str(fault))
    except Exception as fault:  # whatever an integrator raises is its result
        return Measurement.failing(PATH, method, setting, fault)
    assert history is not None
    unit = max(abs(x) for stress in work.driven.stress for x in stress)
    knots = history.stress[::count].tolist()
    error = max(distance(got, exact, unit) for got, exact in zip(knots, work.driven.stress, strict=True))
    return Measurement(PATH, method, setting, {"stress": error}, seconds, note=history.why)


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
        points = np.vstack([np.zeros(d), np.cumsum(draw.normal(size=(_PIECES, d)) * 1.5 * width, axis=0)])
        return cls(specimen, Path.linear(points, pressure=specimen.pressure), size)

    @property
    def shaped(self) -> bool:
        """Whether the law declares the shape of its K."""
        return self.specimen.law.closed_form is not None

    def many(self) -> tuple[Paths, int]:
        """The points and how many steps each takes."""
        count = max(1, self.size // (10 if self.shaped else _UNCOMPILED))
        factor = np.random.default_rng(2).normal(size=(count, self.path.values.shape[1]))
        return Paths.scaled(self.path, factor), 1_000 if self.shaped else _FEW


def long_rows(drive: LongPaths, contenders: Sequence[Contender], repeats: int) -> Iterator[Measurement]:
    """Seconds a step of one point: the kernel, one path and many, with and without the compiler, on one thread and on all."""
    given = {"stiffness": drive.specimen.stiffness}
    slow = max(1, min(_UNCOMPILED, drive.size) // _PIECES)
    run = partial(simulate, drive.specimen.declared, drive.path, **given)
    yield measured(LONG, ONE, f"{slow * _PIECES} steps", partial(run, substeps=slow), repeats, slow * _PIECES)
    if find_spec("numba") is None:
        return
    name = "closed-form" if drive.shaped else "newton"
    kernel = next((c for c in contenders if c.method.name == name and vars(c.options).get("compiled")), None)
    if kernel is not None:
        yield _kernel(drive, kernel, repeats)
    long = max(1, drive.size // _PIECES)
    one = partial(run, substeps=long, compiled=True)
    yield measured(LONG, ONE + NUMBA, f"{long * _PIECES} steps", one, repeats, long * _PIECES)
    points, steps = drive.many()
    setting, count = f"N = {len(points)}, {steps} steps", len(points) * steps
    many = partial(simulate, drive.specimen.declared, points, substeps=steps // _PIECES, keep="last", compiled=True, **given)
    for label, threads in ((MANY + NUMBA + ALONE, 1), (MANY + NUMBA, cores())):
        yield measured(LONG, label, setting, partial(many, threads=threads), repeats, count)
    yield memory(LONG, MANY + NUMBA, "peak memory", partial(many, threads=cores()), results=True)


def _kernel(drive: LongPaths, contender: Contender, repeats: int) -> Measurement:
    d = len(drive.specimen.law.forces)
    reach = np.abs(drive.path.values).max() * np.diagonal(drive.specimen.stiffness)
    trial = np.random.default_rng(3).normal(size=(_KERNEL, d)) * (0.3 * reach)
    question = drive.specimen.question(trial, None if drive.specimen.pressure is None else np.full(_KERNEL, drive.specimen.pressure))
    run, often = partial(contender.solve, question), 20
    if contender.method.name == "closed-form":
        run, often = partial(contender.again, question, contender.solve(question)), 100
    return measured(LONG, KERNEL, f"N = {_KERNEL}", run, often * repeats, _KERNEL)


def long_targets(rows: Sequence[Measurement], left_out: Sequence[LeftOut]) -> tuple[Target, ...]:
    """The ratios of least times that duhem sets itself; of one that was not measured, why."""
    own = [row for row in rows if row.scene == LONG]
    least = {row.method: row.seconds.least for row in own if row.seconds is not None}
    numba = next((part.reason for part in left_out if part.part.endswith(NUMBA)), None)
    absent = {} if numba is None else dict.fromkeys((ONE + NUMBA, MANY + NUMBA, MANY + NUMBA + ALONE, KERNEL), numba)
    absent |= {row.method: f"failed: {row.failure}" for row in own if row.failure}
    if not own:
        return ()
    target = partial(ratio, seconds=least, absent=absent)
    one = 1e6 * least[ONE + NUMBA] if ONE + NUMBA in least else None
    return (
        target("implicit steps of many points (numba), one thread / kernel alone", MANY + NUMBA + ALONE, KERNEL, "<=", 3.0),
        at_most("10^6 implicit steps of one path (numba), s", one, 1.0, absent.get(ONE + NUMBA, "not measured")),
        target("implicit steps of many points (numba), one thread / all", MANY + NUMBA + ALONE, MANY + NUMBA, ">=", 1.6),
    )


# -- the scenes in turn ------------------------------------------------------------------------------------------------

SCENES = (throughput.SINGLE, PATH, throughput.SCENE, throughput.CALLS, LONG)


def bench(
    law: Criterion,
    *,
    scenes: Sequence[str] = SCENES,
    stiffness: Sequence[float] | None = None,
    repeats: int = 5,
    points: int = 1_000_000,
    steps: Sequence[int] = STEPS,
    contenders: Sequence[Contender] | None = None,
    peers: bool = False,
    on_row: Callable[[Measurement], None] | None = None,
) -> WorkPrecision:
    """Error against run time of every method that applies to ``law``, all parameters fixed.

    ``stiffness`` (d,) diagonal in Pa/m, left out 1, 2, ...; the pressure is -1.  ``scenes``: ``increment`` (each method and
    conic solver over its tolerances), ``path`` (each integrator over ``steps`` a segment), ``throughput`` (``points``
    increments at once), ``project`` (the same through :func:`duhem.project`, by the wall clock), ``paths`` (a tenth as many
    points over 1,000 implicit steps each, and ``points`` steps of one).  Each measurement runs
    ``repeats`` times, fewer where it is slow and more for the small batches of ``project``, and says so.  ``contenders`` in place
    of all methods; ``peers``: other programs beside duhem's, those that are installed.  One that raises is a row with its failure.
    KeyboardInterrupt ends it with what is done.
    Raises InputError for a parameter without value, a law whose increments are more than closest points of K, or an unknown scene.
    """
    if strange := [scene for scene in scenes if scene not in SCENES]:
        raise InputError(f"unknown scene {strange[0]!r}", where="scenes", remedy=f"choose {', '.join(SCENES)}")
    for name, count in (("repeats", repeats), ("points", points)):
        if count < 1:
            raise InputError(f"{name} is {count}", where=name, remedy="give a whole number >= 1")
    specimen = Specimen.of(law, stiffness)
    found, left_out = applicable(specimen.unloaded, throughput.TOLERANCES, peers)
    chosen = list(found if contenders is None else contenders)
    rows: list[Measurement] = []
    reference: dict[str, float | str] = {}

    def increments() -> Iterator[Measurement]:
        work = throughput.exercise(specimen)
        reference[throughput.SINGLE] = work.residual
        yield from throughput.single_rows(work, chosen, repeats)

    def paths() -> Iterator[Measurement]:
        work = route(specimen)
        reference[PATH] = work.driven.error
        yield from path_rows(work, repeats, left_out, tuple(steps))

    runs: dict[str, Callable[[], Iterator[Measurement]]] = {
        throughput.SINGLE: increments,
        PATH: paths,
        throughput.SCENE: lambda: throughput.rows(throughput.Load.of(specimen, points, left_out), chosen, repeats),
        throughput.CALLS: lambda: throughput.call_rows(throughput.Load.of(specimen, points), chosen, repeats),
        LONG: lambda: long_rows(LongPaths.of(specimen, points), chosen, repeats),
    }
    interrupted = False
    try:
        for scene in scenes:
            try:
                for row in runs[scene]():
                    rows.append(row)
                    if on_row is not None:
                        on_row(row)
            except NoReference as fault:
                reference[scene] = str(fault)
                left_out.append(LeftOut(f"scene {scene}", f"no reference: {fault}"))
    except KeyboardInterrupt:
        interrupted = True
    return WorkPrecision(
        law=law.name,
        subject=specimen.describe(),
        repeats=repeats,
        rows=tuple(rows),
        targets=(
            *throughput.targets(rows, left_out),
            *throughput.call_targets(rows, left_out),
            *long_targets(rows, left_out),
            *throughput.beside_peers(rows, *([c.name for c in chosen if c.peer == peer] for peer in (False, True))),
        ),
        reference=reference,
        left_out=tuple(left_out),
        interrupted=interrupted,
    )
