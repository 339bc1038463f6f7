"""A checked scene as a value: what it runs, what it needs and what it leaves out."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from duhem.law.formula_law import Criterion
from duhem.law.shapes import Interval
from duhem.left_out import LeftOut
from duhem.path.history import History
from duhem.path.loading import Path
from duhem.path.plan import Plan
from duhem.path.simulate import simulate

__all__ = ["Needed", "Scene"]


@dataclass(frozen=True)
class Needed:
    """A part of the program that the scene needs, and why."""

    part: str
    reason: str


@dataclass(frozen=True, eq=False)
class Scene:
    """A checked scene; ``fingerprint`` tells runs of different scenes apart, ``inputs`` are the files that it names and reads."""

    law: Criterion
    path: Path
    stiffness: Any
    parameters: Mapping[str, Any]
    method: str = "implicit"
    projection: str = "auto"
    substeps: int = 1
    stress: tuple[float, ...] | None = None
    table: str | None = None
    plot: str | None = None
    inputs: tuple[str, ...] = ()

    def run(self, start: History | None = None, on_step: Callable[[int, int], None] | None = None) -> History:
        """The history; ``start`` and ``on_step`` as in :func:`duhem.simulate`."""
        return simulate(
            self.law,
            self.path,
            stiffness=self.stiffness,
            parameters=self.parameters,
            method=self.method,
            projection=self.projection,
            substeps=self.substeps,
            stress=self.stress,
            start=start,
            on_step=on_step,
        )

    def plan(self) -> Plan:
        """The checked question of the run."""
        return Plan.of(
            self.law,
            self.path,
            stiffness=self.stiffness,
            parameters=self.parameters,
            projection=self.projection,
            substeps=self.substeps,
        )

    @property
    def fingerprint(self) -> str:
        """Of all that determines the numbers, in hexadecimal."""
        path = self.path
        given = (self.law, sorted(self.parameters.items()), self.stiffness, self.method, self.projection, self.substeps, self.stress)
        arrays = [path.values, path.time, *([] if path.pressure is None else [path.pressure]), *([path.arc.angle] if path.arc else [])]
        digest = hashlib.sha256(repr((*given, path.control)).encode())
        for array in arrays:
            digest.update(array.tobytes())
        return digest.hexdigest()[:32]

    def parts(self, table: str | None = None, plot: str | None = None) -> tuple[Needed | LeftOut, ...]:
        """What a run of the scene needs and what it leaves out, with the reason."""
        plan = self.plan()
        return (
            _integration(self, plan),
            _solver(self, plan),
            LeftOut("thermal block", "isothermal: no temperature in the law"),
            LeftOut("flow check", "associated: slip is normal to K by construction"),
            LeftOut("K at every step", "constant pressure: K is assembled once")
            if self.path.constant_pressure
            else Needed("K at every step", "the pressure changes along the path"),
            Needed("matplotlib", f"plot {plot}") if plot else LeftOut("matplotlib", "nothing is plotted"),
            Needed("pyarrow", f"table {table}")
            if table and table.endswith(".parquet")
            else LeftOut("pyarrow", "no Parquet file is written"),
        )


def _integration(scene: Scene, plan: Plan) -> Needed | LeftOut:
    name = "ordinary differential equation"
    if scene.path.control == "stress":
        return LeftOut(name, "stress path: the displacement follows from it")
    if scene.method != "exact":
        return LeftOut(name, f"{scene.method} steps: closest points only")
    from duhem.path.exact import elementary, why

    reason = elementary(plan)
    return LeftOut(name, why(plan)) if reason is None else Needed(name, why(plan).partition(": ")[2])


def _solver(scene: Scene, plan: Plan) -> Needed | LeftOut:
    from duhem.projection import closed_form

    name, reason = "solver (CVXPY or Newton)", closed_form.applies(plan.increment)
    if scene.projection not in ("auto", "closed-form"):
        return Needed(name, f"projection {scene.projection} is asked for")
    if reason is None:
        one = isinstance(scene.law.closed_form, Interval)
        return LeftOut(name, "one-dimensional: closed form" if one else "the closest point has a closed form")
    return Needed(name, f"{reason.partition(':')[0]}")
