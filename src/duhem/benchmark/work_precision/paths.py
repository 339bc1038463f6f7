"""A loading path by every integrator over step counts, against the path in many digits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from duhem.benchmark.reference import Drive, Driven, distance
from duhem.benchmark.specimen import Specimen
from duhem.benchmark.work_precision.result import Measurement
from duhem.benchmark.work_precision.timing import timed
from duhem.errors import DuhemError
from duhem.left_out import LeftOut
from duhem.path.integrators import INTEGRATORS
from duhem.path.loading import Path
from duhem.path.simulate import simulate
from duhem.projection.result import Array

__all__ = ["SCENE", "STEPS", "Route", "route", "rows"]

SCENE = "path"
STEPS = (1, 4, 16, 64, 256, 1024)
_SLOW = 1.0  # a setting whose run takes longer is the last of its integrator
_TURNS = np.array([0.0, 0.35, -0.5, 0.15, 0.8])  # of pi, the directions of the steps in the first two displacements
_LENGTHS = np.array([0.0, 1.8, 1.5, 2.2, 2.5])  # of the reach of K, as a displacement


@dataclass(frozen=True)
class Route:
    """Knots (m, d) in m, joined by straight steps under constant pressure, and the stresses there in many digits."""

    specimen: Specimen
    points: Array
    driven: Driven


def route(specimen: Specimen) -> Route:
    """Four straight steps that slip, turn and unload; NoReference where the path has no reference."""
    d = len(specimen.law.forces)
    angles = np.pi * _TURNS[1:]
    ways = np.zeros((len(angles), d))
    ways[:, 0] = np.cos(angles) if d > 1 else np.cos(np.pi * np.arange(len(angles)))
    if d > 1:
        ways[:, 1] = np.sin(angles)
    axes = np.eye(d)[: min(d, 2)]
    reach = min(r for r in (specimen.radius(sign * axis, specimen.pressure) for axis in axes for sign in (1, -1)) if r > 0)
    points = np.vstack([np.zeros(d), np.cumsum(_LENGTHS[1:, None] * reach * ways, axis=0)]) / float(np.diagonal(specimen.stiffness).mean())
    question = specimen.question(np.zeros((1, d)), specimen.pressure)
    symbol = None if specimen.law.pressure is None else specimen.law.symbols()[specimen.law.pressure]
    drive = Drive(question.g, specimen.law.force_symbols(), symbol, question.stiffness.tolist(), specimen.pressure)
    return Route(specimen, points, drive(points.tolist()))


def rows(work: Route, repeats: int, left_out: list[LeftOut], steps: tuple[int, ...] = STEPS) -> Iterator[Measurement]:
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
        return Measurement(SCENE, method, setting, failure=str(fault))
    except Exception as fault:  # whatever an integrator raises is its result
        return Measurement.failing(SCENE, method, setting, fault)
    assert history is not None
    unit = max(abs(x) for stress in work.driven.stress for x in stress)
    knots = history.stress[::count].tolist()
    error = max(distance(got, exact, unit) for got, exact in zip(knots, work.driven.stress, strict=True))
    return Measurement(SCENE, method, setting, {"stress": error}, seconds, note=history.why)
