"""What is asked of a law with a state, checked: its path, its numbers and the state in which it begins."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError, faults_at
from duhem.expression.numpy_ import compiled
from duhem.expression.syntax import respelled
from duhem.law.catalogue import load_formula
from duhem.law.domain import Domain, Domains
from duhem.law.formula_law import Criterion
from duhem.path.compiled_state import StateLoop
from duhem.path.loading import Path, Paths, checked_count, given_numbers
from duhem.path.run import MOST_THREADS, Run, as_paths, by_point, check_pressure, kept_knots
from duhem.path.state_step import KKT, Advanced, StateLaw
from duhem.projection.increment import stiffness_of
from duhem.projection.result import Array

__all__ = ["Drive", "StateQuestion", "inside"]

_METHODS = "implicit", "extrapolated"
_FINEST = 1e-10  # below which rounding hides what a step is off by

Drive = Callable[[float], tuple[Array, Sequence[Array]]]
"""What is prescribed at a part from 0 to 1 of a step, (N, columns), and the numbers of the formulas."""


@dataclass(frozen=True, eq=False)
class StateQuestion:
    """The run of a law with a state, checked: ``begun`` (N, n) is the first state, ``others`` (N,) the numbers of its formulas.

    ``arc`` is the path itself where it is round between its knots; ``knots`` are those that are kept.
    """

    run: Run
    law: StateLaw
    paths: Paths
    others: Mapping[str, Array]
    begun: Array
    arc: Path | None
    knots: NDArray[np.intp]

    @classmethod
    def of(cls, run: Run) -> StateQuestion:
        """The run, checked; InputError for what does not fit."""
        law, path = load_formula(run.law), run.path
        if not isinstance(path, Path | Paths):
            what = f"{type(path).__name__} is no loading path"
            raise InputError(what, where="path", remedy="make one with Path.linear(points, pressure=...) or Path.from_csv(file)")
        if not isinstance(run.method, str) or run.method not in _METHODS:
            what = f"{law.name} has a state or a flow of its own, and no method {run.method!r}"
            raise InputError(what, where="method", remedy=f"choose {', '.join(_METHODS)}")
        if run.stress is not None:
            what = f"the start of {law.name} is a state"
            raise InputError(what, where="stress", remedy='give the variables that do not begin at 0, such as state={"alpha": 0.1}')
        if run.projection != "auto":
            what = f"{law.name} has a state or a flow of its own, and its steps are no closest points"
            raise InputError(what, where="projection", remedy="remove it")
        checked_count(run.substeps, "substeps", 1)
        checked_count(run.threads, "threads", 1, MOST_THREADS)
        if run.accuracy is not None and (not isinstance(run.accuracy, int | float) or not _FINEST <= run.accuracy < 1.0):
            raise InputError(f"accuracy = {str(run.accuracy)[:40]}", where="accuracy", remedy=f"give a number from {_FINEST:g} to 1")
        if run.accuracy is not None and run.method != "extrapolated":
            raise InputError(f"an {run.method} step has no accuracy", where="accuracy", remedy='use method="extrapolated"')
        if run.tangent and run.method == "extrapolated":
            raise InputError("an extrapolated step has no tangent here", where="tangent", remedy='use method="implicit"')
        stressed = isinstance(path, Path) and path.control == "stress"
        if law.energy is not None and run.stiffness is not None:
            raise InputError(f"{law.name} has an energy", where="stiffness", remedy="remove the stiffness: the energy has it")
        stiffness = None if law.energy is not None else stiffness_of(law, run.stiffness)[0]
        if isinstance(path, Path):
            knots = np.arange((len(path.time) - 1) * run.substeps + 1)
            if run.keep != 1:
                raise InputError("keep applies only to many points", where="keep", remedy="remove it, or give Paths")
        else:
            knots = kept_knots(run.keep, (len(path.time) - 1) * run.substeps)
        width = path.values.shape[-1]
        own = StateLaw.of(law, stiffness, stressed, width)
        if width not in (own.observables, own.observables + (law.temperature is not None)):
            names = ", ".join(own.names[: own.observables])
            warm = "" if law.temperature is None else f", and one more for {law.temperature}, or none where the path is adiabatic"
            raise InputError(f"the path has {width} columns", where="path", remedy=f"give one for each of {names}{warm}")
        if own.timed and not path.timed:
            raise InputError(f"{law.name} depends on the rate, and the path states no times", where="path", remedy="give time=")
        fine = path.refined(run.substeps)
        paths, arc = as_paths(fine), fine if isinstance(fine, Path) and fine.arc is not None else None
        check_pressure(law, paths.pressure)
        others = _numbers(law, run.parameters, len(paths))
        return cls(run, own, paths, others, np.zeros((len(paths), len(own.names))), arc, knots)._started(run.state)

    def _started(self, given: Mapping[str, Any] | None) -> StateQuestion:
        """The question with the state at the first knot, checked."""
        own, law, begun = self.law, self.law.law, self.begun.copy()
        names = own.names[own.observables :] if not own.stressed else own.names
        ends = {name: v.domain for name, v in law.variables.items()}
        if given is not None and not isinstance(given, Mapping):
            raise InputError(f"{type(given).__name__} is no mapping", where="state", remedy='give variables by name, {"alpha": 0.1}')
        for name, value in respelled(given or {}, "state").items():
            if name not in names or (name == law.temperature and not own.adiabatic):
                what = f"{name!r} is not a variable that begins somewhere"
                raise InputError(what, where="state", remedy=f"these are: {', '.join(names)}")
            with faults_at("state"):
                numbers = given_numbers(value, name)
            if numbers.shape not in ((), (len(begun),)):
                raise InputError(f"{name} has the shape {numbers.shape}", where="state", remedy="give one number, or one a point")
            begun[:, own.names.index(name)] = numbers
        values = self.paths.at(0)
        if not own.stressed:
            begun[:, : own.observables] = values[:, : own.observables]
        if values.shape[1] > own.observables:
            begun[:, -1] = values[:, -1]
        for i, name in enumerate(own.names):
            columns = begun[:, i]
            if name in own.names[: own.observables] and not own.stressed:
                columns = np.array([self.paths.at(k)[:, i] for k in range(len(self.paths.time))])
            elif name == law.temperature and not own.adiabatic:
                columns = np.array([self.paths.at(k)[:, -1] for k in range(len(self.paths.time))])
            if name in ends and (wrong := np.ravel(columns)[~inside(ends[name], np.ravel(columns))]).size:
                what = f"{name} = {wrong[0]:g} is outside its range {ends[name].describe()}"
                remedy = f"give it a value there, state={{{name!r}: ...}}" if name in names else "stay inside the range"
                raise InputError(what, where="state" if name in names else "path", remedy=remedy)
        others = self.at(0, np.arange(len(begun)))
        if own.stressed:
            first = own.advance(begun, values, 0.0, others)
            if first.failed.any() or first.multiplier.any():
                raise InputError("no displacement has the forces at the first knot without flow", where="path", remedy="begin inside K")
            begun = first.chi
        _, forces, _ = own.stored(begun, others)
        if not np.isfinite(forces).all():
            raise InputError("the energy or its forces have no value at the start", where="state", remedy="give the variables other values")
        if (out := own.outside(begun, others)).max(initial=0.0) > KKT:  # a bound may hold what would flow
            end = own.advance(begun, values, 0.0, others)
            out[~end.failed & (np.abs(end.chi - begun) <= KKT * np.abs(begun)).all(axis=1)] = 0.0
        if out.max(initial=0.0) > KKT:
            what = f"the forces {dict(zip(law.forces, forces[np.argmax(out)].tolist(), strict=True))} at the start lie outside K"
            raise InputError(what, where="state", remedy="give state= and a first knot inside K")
        return replace(self, begun=begun)

    def at(self, knot: int, which: NDArray[np.intp]) -> list[Array]:
        """The numbers of the formulas of some points at a knot."""
        return self._numbered(self.paths.pressure_at(knot, which), which)

    def _numbered(self, pressure: Array, which: NDArray[np.intp]) -> list[Array]:
        every = {name: np.broadcast_to(numbers, len(self.paths))[which] for name, numbers in self.others.items()}
        if self.law.law.pressure is not None:
            every[self.law.law.pressure] = pressure
        return [every[name] for name in self.law.others]

    def drive(self, knot: int, which: NDArray[np.intp]) -> Drive:
        """What is prescribed of some points on the way to a knot."""
        before, end = self.paths.at(knot - 1, which), self.paths.at(knot, which)
        loads = [self.paths.pressure_at(k, which) for k in (knot - 1, knot)]

        def to(part: float) -> tuple[Array, list[Array]]:
            values = end - (1.0 - part) * (end - before)
            if self.arc is not None and part < 1.0:
                values = self.arc.between(knot, part)[1][None]
            return values, self._numbered(loads[1] - (1.0 - part) * (loads[1] - loads[0]), which)

        return to

    @cached_property
    def loop(self) -> StateLoop | None:
        """Machine code for the steps, where that was asked for and the law has some; MissingExtraError without numba."""
        return StateLoop.of(self.law) if self.run.compiled and not self.run.tangent else None

    def advance(self, base: Array, given: Array, dt: float, others: Sequence[Array], tangent: bool) -> Advanced:
        """A step, by machine code where there is some."""
        return self.law.advance(base, given, dt, others, tangent) if self.loop is None else self.loop.advance(base, given, dt, others)

    @property
    def why(self) -> str:
        """How steps are taken, in words."""
        own = self.law
        if own.minimum:
            how = "Newton's method on the optimality conditions of the step, which is the least of psi + dt Phi where both are convex"
        else:
            law = own.law
            what = [] if law.associated else ["a flow of its own"]
            what += ["rates without a multiplier"] * bool(law.rates) + ["a rate that belongs to no force"] * bool(law.unforced)
            how = f"Newton's method on the residual of the step, which is no minimum: the law has {' and '.join(what)}"
        if self.loop is not None:
            how = f"{how}, compiled"
        if self.run.accuracy is not None:
            how = f"{how}; parts of steps with an estimated error of at most {self.run.accuracy:g}"
        if own.exchange is not None:
            return f"{how}; heat flows from {', '.join(own.law.heat)}"
        return f"{how}; adiabatic" if own.adiabatic else how


def inside(domain: Domain, values: Array) -> NDArray[np.bool_]:
    """Which of the values lie in a range."""
    low, high = domain.ends
    return np.asarray(((values > low) if domain.positive else (values >= low)) & (values <= high))


def _numbers(law: Criterion, parameters: Mapping[str, Any] | None, n: int) -> dict[str, Array]:
    """The numbers of each parameter, (1,) or (N,), inside the domain and the constraints."""
    given, each = by_point(parameters, n)
    if taken := next((name for name in given if name in law.variables), None):
        remedy = f"state={{{taken!r}: ...}} says where it begins"
        raise InputError(f"{taken} is a variable of {law.name}", where="parameters", remedy=remedy)
    domains = Domains(law.parameters)
    for end in (np.min, np.max):
        domains.fixed({name: float(end(values)) for name, values in each.items()}, law.name)
    alike = domains.fixed({name: value for name, value in given.items() if name not in each}, law.name)
    found = {name: np.array([float(own.value)]) for name, own in alike.items() if own.value is not None} | each
    found = {name: values for name, values in found.items() if name not in law.variables}
    if missing := [name for name in law.parameters if name not in found and name not in law.variables]:
        remedy = f"give parameters={{{', '.join(f'{name!r}: ...' for name in missing)}}}"
        raise InputError(f"no value is given for {', '.join(missing)}", where=f"parameters of {law.name}", remedy=remedy)
    for relation in law.constraints:
        names = sorted(map(str, relation.free_symbols))
        if not compiled(relation, [law.symbols()[name] for name in names])(*(found[name] for name in names)).all():
            raise InputError(f"{relation} does not hold", where=f"parameters of {law.name}", remedy="choose values that satisfy it")
    return found
