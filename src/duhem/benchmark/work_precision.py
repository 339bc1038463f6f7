"""Error against run time: one increment by every method and solver, a path by every integrator, and cost a point at scale.

The scenes are taken in turn; what is done when a run is interrupted is kept.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from duhem.benchmark import paths as path
from duhem.benchmark import throughput
from duhem.benchmark.contenders import Contender, Specimen, applicable
from duhem.benchmark.measurement import Measurement, WorkPrecision
from duhem.benchmark.reference import NoReference
from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.omitted import LeftOut

__all__ = ["SCENES", "WorkPrecision", "bench"]

SCENES = (throughput.SINGLE, path.SCENE, throughput.SCENE, throughput.CALLS, path.LONG)


def bench(
    law: Criterion,
    *,
    scenes: Sequence[str] = SCENES,
    stiffness: Sequence[float] | None = None,
    repeats: int = 5,
    points: int = 1_000_000,
    steps: Sequence[int] = path.STEPS,
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
        work = path.route(specimen)
        reference[path.SCENE] = work.driven.error
        yield from path.rows(work, repeats, left_out, tuple(steps))

    runs: dict[str, Callable[[], Iterator[Measurement]]] = {
        throughput.SINGLE: increments,
        path.SCENE: paths,
        throughput.SCENE: lambda: throughput.rows(throughput.Load.of(specimen, points, left_out), chosen, repeats),
        throughput.CALLS: lambda: throughput.call_rows(throughput.Load.of(specimen, points), chosen, repeats),
        path.LONG: lambda: path.long_rows(path.LongPaths.of(specimen, points), chosen, repeats),
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
            *path.long_targets(rows, left_out),
            *throughput.beside_peers(rows, *([c.name for c in chosen if c.peer == peer] for peer in (False, True))),
        ),
        reference=reference,
        left_out=tuple(left_out),
        interrupted=interrupted,
    )
