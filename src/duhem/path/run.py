"""What is asked of a law and loading paths, as one value, and the checked question of one path or of many points, in blocks."""

from __future__ import annotations

import pathlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError, faults_at
from duhem.expression.given_array import in_order
from duhem.law.catalogue import load_formula
from duhem.law.domain import by_name
from duhem.law.formula_law import Criterion
from duhem.law.table_file import MOST_NUMBERS
from duhem.path import step_formulas
from duhem.path.loading import Path, Paths, checked_count, given_numbers
from duhem.projection.increment import Convexity, Increment, refused, setting
from duhem.projection.increment import increment as checked
from duhem.projection.result import Array

__all__ = [
    "MOST_THREADS", "Batch", "Plan", "Run", "Share", "as_paths", "by_point", "check_pressure", "columns", "energy", "kept_knots",
    "stress_at_start", "times",
]  # fmt: skip


@dataclass(frozen=True, eq=False)
class Run:
    """The arguments of :func:`duhem.simulate` that determine numbers, as given and not yet checked; ``threads``, which do not, too.

    ``convexity`` is what is known of K where somebody has asked, None where nobody has.  ``state``, ``tangent`` and ``accuracy`` are of
    laws that evolve (:func:`duhem.law.state.evolves`).
    """

    law: Criterion | str | pathlib.Path
    path: Path | Paths
    stiffness: ArrayLike | None = None
    parameters: Mapping[str, Any] | None = None
    method: str = "implicit"
    projection: str = "auto"
    substeps: int = 1
    stress: ArrayLike | None = None
    keep: int | str = 1
    threads: int = 1
    compiled: bool = False
    convexity: Convexity | None = None
    state: Mapping[str, Any] | None = None
    tangent: bool = False
    accuracy: float | None = None


@dataclass(frozen=True, eq=False)
class Plan:
    """A law with numbers in place, and the path.

    ``increment`` is the checked question, its trial stresses being those without slip; ``projection`` the method of the
    closest point.  Displacements in m, stresses in Pa, stiffness in Pa/m.
    """

    increment: Increment
    path: Path
    projection: str
    compliance: Array

    @classmethod
    def of(cls, run: Run) -> Plan:
        """The run of one path, checked; InputError for what does not fit."""
        known, path = load_formula(run.law), run.path
        if not isinstance(path, Path):
            what = f"{type(path).__name__} is no loading path"
            raise InputError(what, where="path", remedy="make one with Path.linear(points, pressure=...) or Path.from_csv(file)")
        fine = path.refined(run.substeps)
        _check_columns(known, fine.values)
        increment = checked(known, fine.values, fine.pressure, run.stiffness, run.parameters)
        compliance = np.asarray(np.linalg.inv(increment.stiffness))
        return cls(replace(increment, convexity=run.convexity), fine, run.projection, compliance)

    @property
    def stiffness(self) -> Array:
        return self.increment.stiffness

    def psi(self, stress: Array) -> Array:
        """sigma . k^-1 sigma / 2 of each row, in Pa m."""
        return energy(stress, self.compliance)


def energy(rows: Array, matrix: Array) -> Array:
    """rows . matrix rows / 2 of each row."""
    return np.reshape(step_formulas.energy(columns(rows), matrix[:, :, None]), rows.shape[:-1])


def times(rows: Array, matrix: Array) -> Array:
    """rows @ matrix of each row."""
    return np.reshape(step_formulas.times(columns(rows), matrix[:, :, None]).T, rows.shape)


def columns(rows: Array) -> Array:
    """Vectors (..., d) as the columns of formulas, (d, n)."""
    return rows.reshape(-1, rows.shape[-1]).T


# -- many points, and the blocks in which they are answered -------------------------------------------------------------

MOST_THREADS = 256

_POINTS = 4032  # of a block: their states stay in the second cache, and a whole number of the compiled kernel's chunks
_NUMBERS = 1 << 25  # that a block holds of its own paths and results: 256 MiB


@dataclass(frozen=True, eq=False)
class Share:
    """Some points of a batch, in memory: their paths with all substeps, the parameter sets they have, and which each has."""

    paths: Paths
    members: tuple[Increment, ...]
    own: NDArray[np.intp]
    stress: Array
    compliance: Array

    def __len__(self) -> int:
        return len(self.own)

    @classmethod
    def alone(cls, plan: Plan, halves: int = 1) -> Share:
        """One path as a share of one point, each of its steps in ``halves`` parts."""
        paths = as_paths(plan.path.refined(halves))
        return cls(paths, (plan.increment,), np.zeros(1, dtype=np.intp), np.zeros((1, paths.values.shape[2])), plan.compliance)


@dataclass(frozen=True, eq=False)
class Batch:
    """A law with numbers in place for each of N points, and their paths.

    ``members`` are the distinct sets of parameters as checked questions, whose formula may be left out where a shape is declared;
    ``own`` (N,) which of them each point has; ``stress`` (N, d) or (1, d) at the first knot in Pa; ``knots`` (r,) those that are kept.
    """

    run: Run
    paths: Paths
    members: tuple[Increment, ...]
    own: NDArray[np.intp]
    stress: Array
    knots: NDArray[np.intp]
    compliance: Array

    @classmethod
    def of(cls, run: Run) -> Batch:
        """The run of many points, checked; InputError for what does not fit."""
        known, paths, substeps = load_formula(run.law), run.path, run.substeps
        assert isinstance(paths, Paths)
        n = len(paths)
        d = len(known.forces)
        _check_columns(known, paths.values)
        members, own = _members(known, run.stiffness, run.parameters, n)
        checked_count(substeps, "substeps", 1)
        checked_count(run.threads, "threads", 1, MOST_THREADS)
        if (steps := (len(paths.time) - 1) * substeps) > MOST_NUMBERS // d:
            raise InputError(f"{steps} steps are too many", where="substeps", remedy=f"take at most {MOST_NUMBERS // d} in all")
        stress, knots = stress_at_start(known, run.stress, n), kept_knots(run.keep, steps)
        check_pressure(known, paths.pressure)
        return cls(
            run=run,
            paths=paths,
            members=tuple(replace(member, convexity=run.convexity) for member in members),
            own=own,
            stress=stress,
            knots=knots,
            compliance=np.asarray(np.linalg.inv(members[0].stiffness)),
        )

    @property
    def law(self) -> Criterion:
        return self.members[0].law

    @property
    def steps(self) -> int:
        """Of each point."""
        return (len(self.paths.time) - 1) * self.run.substeps

    @property
    def numbers(self) -> int:
        """How many are kept of each point."""
        return len(self.knots) * (3 * len(self.law.forces) + 7)

    def blocks(self) -> list[tuple[int, int]]:
        """First and last point of each block: by the size of the question alone, so that no number depends on who computes it."""
        held = self.numbers + (0 if self.paths.alike else (self.steps + 1) * (len(self.law.forces) + 4))
        each = max(1, min(_POINTS, _NUMBERS // held))
        return [(first, min(first + each, len(self.own))) for first in range(0, len(self.own), each)]

    def start(self, first: int, last: int) -> Share:
        """The points from ``first`` to before ``last``, at their first knots alone."""
        return self._share(self.paths.begun().part(first, last), first, last)

    def block(self, first: int, last: int, halves: int = 1) -> Share:
        """The points from ``first`` to before ``last``; each step of their paths in ``halves`` parts."""
        return self._share(self.paths.part(first, last).refined(self.run.substeps).refined(halves), first, last)

    def _share(self, paths: Paths, first: int, last: int) -> Share:
        used, own = np.unique(self.own[first:last], return_inverse=True)
        stress = self.stress if len(self.stress) == 1 else self.stress[first:last]
        members = tuple(self.members[i] for i in used)
        return Share(paths, members, own, np.broadcast_to(stress, (last - first, stress.shape[1])), self.compliance)


def as_paths(path: Path | Paths) -> Paths:
    """Paths as they are, and one path as that of one point."""
    if isinstance(path, Paths):
        return path
    pressure = None if path.pressure is None else path.pressure[None]
    return Paths(path.values[None], np.ones((1, path.values.shape[1])), pressure, path.time, path.timed)


def _check_columns(law: Criterion, values: Array) -> None:
    if values.shape[-1] != len(law.forces):
        what = f"the path has {values.shape[-1]} columns and {law.name} the {len(law.forces)} forces {', '.join(law.forces)}"
        raise InputError(what, where="path", remedy="give one column for each force")


def check_pressure(law: Criterion, load: Array | None) -> None:
    """InputError where the pressures (N, m) of points at knots are missing, are none of the law's, or lie outside its range."""
    if (law.pressure is None) != (load is None):
        what = f"{law.name} has no pressure" if law.pressure is None else f"{law.name} needs the pressure {law.pressure}"
        raise InputError(what, where="pressure", remedy="remove it" if law.pressure is None else "give pressure= in the path")
    if load is not None and (out := np.argwhere(refused(law, load))).size:
        point, knot = out[0].tolist()
        name = law.pressure or ""
        what = f"pressure[{point}, {knot}] is {load[point, knot]}, outside the range of {law.domain[name].stated(name)}"
        raise InputError(what, where="path", remedy="keep to the range, or declare a wider one in the law's domain")


def by_point(parameters: Mapping[str, Any] | None, n: int) -> tuple[dict[str, Any], dict[str, Array]]:
    """The numbers of ``n`` points by name, and those of them that each point has of its own (N,)."""
    given = dict(by_name(parameters))
    each = {name: given_numbers(value, name) for name, value in given.items() if np.ndim(value)}
    if wrong := next((name for name, array in each.items() if array.shape != (n,)), None):
        what = f"{wrong} has the shape {each[wrong].shape} for {n} points"
        raise InputError(what, where=f"parameter {wrong}", remedy=f"give one number, or ({n},)")
    return given, each


def _members(
    law: Criterion, stiffness: ArrayLike | None, parameters: Mapping[str, Any] | None, n: int
) -> tuple[tuple[Increment, ...], NDArray[np.intp]]:
    """The checked question of each distinct set of parameters, and which set each of the ``n`` points has."""
    given, each = by_point(parameters, n)
    if not each:
        return (setting(law, stiffness, given),), np.zeros(n, dtype=np.intp)
    sets, own = np.unique(np.stack(list(each.values()), axis=1), axis=0, return_inverse=True)
    rows = [dict(zip(each, row, strict=True)) for row in sets.tolist()]
    # a shape asks for no formula, and ranges of parameters, being intervals, are held by all where they are by the ends
    every = law.closed_form is None or bool(law.constraints)
    checked = every | ((sets == sets.min(axis=0)) | (sets == sets.max(axis=0))).any(axis=1)
    try:
        first = setting(law, stiffness, given | rows[0])
        members = tuple(
            setting(law, first.stiffness, given | row) if whole else replace(first, g=sp.nan, parameters={**first.parameters, **row})
            for row, whole in zip(rows, checked.tolist(), strict=True)
        )
    except InputError as fault:
        raise _first_bad(law, stiffness, given, each) or fault from None
    return members, own.reshape(n)


def _first_bad(law: Criterion, stiffness: ArrayLike | None, given: Mapping[str, Any], each: Mapping[str, Array]) -> InputError | None:
    """The fault of the first point with a value outside its domain, or in a law of constraints with values that break one."""
    doubtful = np.full(len(next(iter(each.values()))), bool(law.constraints))
    for name in law.parameters.keys() & each.keys():
        low, high = law.parameters[name].ends
        doubtful |= ~((each[name] > low) & (each[name] < high))
    for point in np.flatnonzero(doubtful).tolist():
        try:
            setting(law, stiffness, {**given, **{name: float(values[point]) for name, values in each.items()}})
        except InputError as fault:
            return InputError(fault.what, where=f"point {point}, {fault.where}", remedy=fault.remedy)
    return None


def stress_at_start(law: Criterion, given: ArrayLike | None, n: int) -> Array:
    """The stress of ``n`` points at the first knot, (n, d) or (1, d), 0 where none is given; InputError where it does not fit the law."""
    d = len(law.forces)
    if given is None:
        return np.zeros((1, d))
    with faults_at("stress"):
        stress = given_numbers(in_order(given, law.forces, "stress"), "stress")
    if stress.shape not in ((d,), (n, d)):
        raise InputError(f"stress has the shape {stress.shape}", where="stress", remedy=f"give ({d},) or ({n}, {d})")
    return stress.reshape(-1, d)


def kept_knots(keep: int | str, steps: int) -> NDArray[np.intp]:
    """The knots of so many steps that ``keep`` asks for; InputError where it says nothing of the kind."""
    if keep == "last":
        return np.array([0, steps])
    if isinstance(keep, str):
        raise InputError(f"keep = {keep[:40]!r}", where="keep", remedy='give the number n to keep every n-th knot, or "last"')
    checked_count(keep, "keep", 1)
    return np.unique(np.append(np.arange(0, steps + 1, keep), steps))
