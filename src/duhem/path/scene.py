"""A checked scene as a value: what it runs, what it needs and what it leaves out."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from duhem.law.formula_law import Criterion
from duhem.law.shapes import Interval
from duhem.path.history import History
from duhem.path.loading import Path
from duhem.path.problem import Problem
from duhem.path.simulate import plan, simulate

__all__ = ["Part", "Scene"]


@dataclass(frozen=True)
class Part:
    """A part of the program, whether the scene needs it, and why."""

    part: str
    needed: bool
    reason: str


@dataclass(frozen=True, eq=False)
class Scene:
    """A checked scene; ``fingerprint`` tells runs of different scenes apart."""

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

    def problem(self) -> Problem:
        """The checked question of the run."""
        return plan(
            self.law,
            self.path,
            stiffness=self.stiffness,
            parameters=self.parameters,
            method=self.method,
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

    def parts(self, table: str | None = None, plot: str | None = None) -> tuple[Part, ...]:
        """What a run of the scene needs and what it leaves out, with the reason."""
        problem = self.problem()
        return (
            _integration(self, problem),
            _solver(self, problem),
            Part("thermal block", False, "isothermal: no temperature in the law"),
            Part("flow check", False, "associated: slip is normal to K by construction"),
            Part("K at every step", False, "constant pressure: K is assembled once")
            if self.path.constant_pressure
            else Part("K at every step", True, "the pressure changes along the path"),
            Part("matplotlib", True, f"plot {plot}") if plot else Part("matplotlib", False, "nothing is plotted"),
            Part("pyarrow", True, f"table {table}")
            if table and table.endswith(".parquet")
            else Part("pyarrow", False, "no Parquet file is written"),
        )


def _integration(scene: Scene, problem: Problem) -> Part:
    name = "ordinary differential equation"
    if scene.path.control == "stress":
        return Part(name, False, "stress path: the displacement follows from it")
    if scene.method != "exact":
        return Part(name, False, f"{scene.method} steps: closest points only")
    from duhem.path.exact import elementary, why

    reason = elementary(problem)
    return Part(name, False, why(problem)) if reason is None else Part(name, True, reason)


def _solver(scene: Scene, problem: Problem) -> Part:
    from duhem.projection import closed_form

    name, reason = "solver (CVXPY or Newton)", closed_form.applies(problem.increment)
    if scene.projection not in ("auto", "closed-form"):
        return Part(name, True, f"projection {scene.projection} is asked for")
    if reason is None:
        one = isinstance(scene.law.closed_form, Interval)
        return Part(name, False, "one-dimensional: closed form" if one else "the closest point has a closed form")
    return Part(name, True, f"{reason.partition(':')[0]}")
