"""A checked scene as a value: what it runs, what it needs and what it leaves out."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Interval
from duhem.left_out import LeftOut
from duhem.path.batch import Batch
from duhem.path.history import History
from duhem.path.paths import Paths
from duhem.path.run import Plan, Run
from duhem.path.simulate import driven
from duhem.projection.result import NOT_SHOWN

__all__ = ["Needed", "Scene"]


@dataclass(frozen=True)
class Needed:
    """A part of the program that the scene needs, and why."""

    part: str
    reason: str


@dataclass(frozen=True, eq=False)
class Scene(Run):
    """A checked scene; ``fingerprint`` tells runs of different scenes apart, ``inputs`` are the files that it names and reads.

    It is a run, ``parameters`` of many points a number or one a point; ``checkpoint`` the seconds after which what is done is kept.
    ``convex`` is what the scene says of K; ``convexity`` what is known of it once somebody has asked (:mod:`duhem.vouched`).
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
        start: History | None = None,
        on_step: Callable[[int, int], None] | None = None,
        keep: Callable[[History], object] | None = None,
    ) -> History:
        """The history of one point; ``start`` and ``on_step`` as in :func:`duhem.simulate`, ``keep`` its checkpoint."""
        self.check_asked()
        alone = replace(self, keep=1, threads=1)  # both speak of many points
        history = driven(alone, start, on_step, None if keep is None else (self.checkpoint, keep))
        assert isinstance(history, History)
        return history

    def check_asked(self) -> None:
        """InputError where the scene requires what nobody has asked."""
        if self.convex == "require" and self.convexity is None:
            raise InputError("nobody has asked whether K is convex", where="convex", remedy="run what duhem.vouched makes of the scene")

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
        digest = hashlib.sha256(repr((*given, *(["compiled"] if self.compiled else []))).encode())
        for array in arrays:
            digest.update(repr(array.shape).encode())
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
            if plan.path.constant_pressure
            else Needed("K at every step", "the pressure changes along the path"),
            Needed("matplotlib", f"plot {plot}") if plot else LeftOut("matplotlib", "nothing is plotted"),
            Needed("pyarrow", f"table {table}")
            if table and table.endswith(".parquet")
            else LeftOut("pyarrow", "no Parquet file is written"),
        )


def _integration(scene: Scene, plan: Plan) -> Needed | LeftOut:
    name = "ordinary differential equation"
    if plan.path.control == "stress":
        return LeftOut(name, "stress path: the displacement follows from it")
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
    remark = "; some hundred steps a second, with compiled = true in [method] some hundred thousand" if loop else ""
    if scene.projection not in ("auto", "closed-form"):
        return Needed(name, f"projection {scene.projection} is asked for{remark}")
    if reason is None:
        one = isinstance(scene.law.closed_form, Interval)
        return LeftOut(name, "one-dimensional: closed form" if one else "the closest point has a closed form")
    return Needed(name, f"{reason.partition(':')[0]}{remark}")
