"""Loading paths of many points over the same times, from arrays and from tables: what is alike for all of them is held once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.expression.given_array import unlabelled
from duhem.expression.spelling import spelled
from duhem.law.formula_law import Criterion
from duhem.path.loading import Path, between, displacements, given_numbers
from duhem.path.table_file import read_table
from duhem.projection.result import Array

__all__ = ["Knot", "Paths", "Which", "in_rows", "paths_from_csv", "spread"]

Which = NDArray[np.intp]  # numbers of points (n,)
Knot = int | NDArray[np.intp]  # the knot of all of them, or (n,) of each
_CHUNK = 1 << 20  # numbers looked at together, so that an array on disk is never in memory as a whole


@dataclass(frozen=True, eq=False)
class Paths:
    """The displacements of N points at the same m >= 2 knots, u_n(t_i) = factor_n values_n(t_i), and straight in between.

    ``values`` (N, m, d) or (1, m, d) in m, ``factor`` (N, d) or (1, d); ``pressure`` (N, m), (N, 1), (1, m) or (1, 1), the
    normal stress sigma_n <= 0 in compression in Pa, None for a law without; ``time`` (m,) in s, increasing, or
    the number of steps where the paths are not ``timed``.  Contact is
    open where sigma_n = 0.
    """

    values: Array
    factor: Array
    pressure: Array | None
    time: Array
    timed: bool = True

    def __post_init__(self) -> None:
        given = (self.values, self.factor, self.time, *([] if self.pressure is None else [self.pressure]))
        whole = (
            all(isinstance(array, np.ndarray) for array in given) and self.values.ndim == 3 and self.time.shape == self.values.shape[1:2]
        )
        if not whole or any(len(array) not in (1, len(self)) for array in (self.values, self.factor, *given[3:])):
            raise InputError("these are no paths", where="paths", remedy="make them with Paths.linear(points, pressure=...)")

    @classmethod
    def linear(cls, points: ArrayLike, *, pressure: ArrayLike | None = None, time: ArrayLike | None = None) -> Paths:
        """Straight from point to point: ``points`` (N, m, d), or (N, m) for one force.

        ``pressure`` as NumPy spreads it over (N, m): one number, (m,) a knot, (N, 1) a point, or (N, m).  Arrays of doubles
        are not copied: they may lie in a file (numpy.memmap).
        """
        values = _doubles(unlabelled(points, "points", "give its numbers as an array, in the order of the forces"), "points")
        values = values[..., None] if values.ndim == 2 else values
        if values.ndim != 3 or values.shape[1] < 2 or not values.shape[0] or not values.shape[2]:
            what = f"points has the shape {np.shape(points)}"
            raise InputError(what, where="paths", remedy="give (N, m, d) with at least two knots, or (N, m) for one force")
        n, m, d = values.shape
        line = Path.linear(np.zeros((m, 1)), time=time)
        return cls(values, np.ones((1, d)), _pressures(pressure, n, m), line.time, line.timed)

    @classmethod
    def scaled(cls, path: Path, by: ArrayLike, *, pressure: ArrayLike | None = None) -> Paths:
        """Each point a multiple of one ``path``: ``by`` (N,), or (N, d) for each force by itself.

        ``pressure`` as in :meth:`linear`; left out, that of the path.  Knots alone are kept of an arc.
        """
        if not isinstance(path, Path) or path.control != "displacement":
            raise InputError(
                "this is no path of displacements", where="paths", remedy="give one made with Path.linear(points, pressure=...)"
            )
        remedy = "give (N,), or (N, d) as an array, in the order of the forces"
        factor = given_numbers(unlabelled(by, "by", remedy), "by")
        m, d = path.values.shape
        factor = factor[:, None] if factor.ndim == 1 else factor
        if factor.ndim != 2 or not len(factor) or factor.shape[1] not in (1, d):
            raise InputError(f"by has the shape {np.shape(by)}", where="paths", remedy=f"give (N,) or (N, {d})")
        load = path.pressure if pressure is None else pressure
        spread = np.array(np.broadcast_to(factor, (len(factor), d)))
        return cls(path.values[None], spread, _pressures(load, len(factor), m), path.time, path.timed)

    def __len__(self) -> int:
        return max(len(self.values), len(self.factor), 1 if self.pressure is None else len(self.pressure))

    @property
    def alike(self) -> bool:
        """Whether displacements are multiples of one path, and pressures do not differ both by point and by knot."""
        return len(self.values) == 1 and (self.pressure is None or 1 in self.pressure.shape)

    def part(self, first: int, last: int) -> Paths:
        """The paths of the points from ``first`` to before ``last``, in memory."""

        def own(array: Array) -> Array:
            return np.ascontiguousarray(array if len(array) == 1 else array[first:last])

        return Paths(own(self.values), own(self.factor), None if self.pressure is None else own(self.pressure), self.time, self.timed)

    def begun(self) -> Paths:
        """The first knots alone."""
        return Paths(self.values[:, :1], self.factor, None if self.pressure is None else self.pressure[:, :1], self.time[:1], self.timed)

    def refined(self, substeps: int) -> Paths:
        """The same paths with every step cut into ``substeps`` equal ones."""
        if substeps == 1:
            return self
        pressure = self.pressure
        if pressure is not None and pressure.shape[1] > 1:
            pressure = np.ascontiguousarray(between(pressure.T, substeps).T)
        values = np.swapaxes(between(np.swapaxes(self.values, 0, 1), substeps), 0, 1)
        return Paths(np.ascontiguousarray(values), self.factor, pressure, between(self.time, substeps), self.timed)

    def at(self, knot: Knot, which: Which | None = None) -> Array:
        """The displacements of all points or of some, at one knot or each at its own, (n, d)."""
        which = np.arange(len(self)) if which is None else which
        return np.asarray(in_rows(self.values, knot, which) * (self.factor if len(self.factor) == 1 else self.factor[which]))

    def pressure_at(self, knot: Knot, which: Which) -> Array:
        """The pressure likewise (n,), zeros for a law without."""
        return np.zeros(len(which)) if self.pressure is None else in_rows(self.pressure, knot, which)

    def path(self, point: int) -> Path:
        """The path of one point by itself."""
        values = self.values[point if len(self.values) > 1 else 0] * self.factor[point if len(self.factor) > 1 else 0]
        pressure = None
        if self.pressure is not None:
            pressure = np.array(np.broadcast_to(self.pressure[point if len(self.pressure) > 1 else 0], self.time.shape))
        return Path(values, pressure, self.time, timed=self.timed)


def in_rows(array: Array, knot: Knot, which: Which) -> Array:
    """The rows of ``which`` points at their knots in an array (N, m, ...), which has one row or one column where all are alike."""
    knot = knot if array.shape[1] > 1 else 0
    found: Array = array[which, knot] if len(array) > 1 else array[0][knot]
    return found if found.ndim == array.ndim - 1 else np.broadcast_to(found, (len(which), *array.shape[2:]))


def _doubles(given: Any, what: str) -> Array:
    """An array of doubles as it is, anything else as one; every number finite."""
    if not (isinstance(given, np.ndarray) and given.dtype == np.float64 and not isinstance(given, np.ma.MaskedArray)):
        return given_numbers(given, what)
    rows = max(1, _CHUNK // max(1, given[:1].size))
    for start in range(0, len(given), rows):
        if not np.isfinite(given[start : start + rows]).all():
            bad = np.argwhere(~np.isfinite(given[start : start + rows]))[0]
            at = [int(bad[0]) + start, *map(int, bad[1:])]
            raise InputError(f"{what}{at} is {given[tuple(at)]}", where="paths", remedy="give finite numbers")
    return given


def _pressures(given: ArrayLike | None, n: int, m: int) -> Array | None:
    if given is None:
        return None
    load = _doubles(given, "pressure")
    load = load.reshape((1,) * (2 - load.ndim) + load.shape) if load.ndim < 2 else load
    if load.ndim != 2 or load.shape[0] not in (1, n) or load.shape[1] not in (1, m):
        what = f"pressure has the shape {np.shape(given)} for {n} points and {m} knots"
        raise InputError(what, where="paths", remedy=f"give one number, ({m},), ({n}, 1) or ({n}, {m})")
    if load.size and load.max() > 0.0:
        i, j = np.argwhere(load > 0.0)[0].tolist()
        raise InputError(
            f"pressure[{i}, {j}] is {load[i, j]} > 0", where="paths", remedy="sigma_n <= 0 in compression, 0 where contact is open"
        )
    return load


def spread(file: str | PathLike[str], law: Criterion, path: Path | Paths) -> tuple[Paths, Mapping[str, Array]]:
    """The paths of the points in a table of one row a point, and the parameters that are a point's own (N,).

    Its columns are parameters of the law; ``scale``, or ``scale_a`` and so on for each force, by which the displacements of ``path`` are
    multiplied; and the pressure, which then stays the same along the point's path.
    """
    header, rows = read_table(file, least=1)
    tails = [force.removeprefix("sigma_") for force in law.forces]
    scales = ["scale", *(f"scale_{tail}" for tail in tails)]
    known = [*law.parameters, *scales, *([law.pressure] if law.pressure else [])]
    if unknown := next((name for name in header if name not in known), None):
        raise InputError(f"unknown column {unknown[:40]!r}", where=f"{file}:1", remedy=f"columns are {', '.join(known)}")
    column = dict(zip(header, rows.T, strict=True))
    n, one = len(rows), np.ones(len(rows))
    by = np.stack([column.get("scale", one) * column.get(scale, one) for scale in scales[1:]], axis=1)
    load = column[law.pressure][:, None] if law.pressure in column else None
    try:
        if isinstance(path, Path):
            paths = Paths.scaled(path, by, pressure=load)
        elif len(path) != n:
            raise InputError(f"{n} points here and {len(path)} paths", remedy="give a row for each point of the path's table")
        else:
            given = Paths.linear(path.values, pressure=path.pressure if load is None else load, time=path.time)
            paths = replace(given, factor=path.factor * by, timed=path.timed)
    except InputError as fault:
        raise InputError(fault.what, where=f"{file}", remedy=fault.remedy) from None
    return paths, {name: column[name] for name in law.parameters if name in column}


def paths_from_csv(
    file: str | PathLike[str],
    *,
    point: str,
    columns: Sequence[str] | None = None,
    pressure: str | float | None = "sigma_n",
    time: str = "time",
    control: str = "displacement",
) -> Paths:
    """A table of one row a knot, as :meth:`duhem.Path.from_csv` reads one, in which the column ``point`` tells points apart.

    The rows of a point stand together, and all have as many knots at the same times.
    """
    if control != "displacement" or not isinstance(point, str):
        raise InputError("many points have displacements, and a column that tells them apart", where="path", remedy='write point = "point"')
    header, rows = read_table(file)
    name = spelled(point)
    if name not in header:
        raise InputError(f"the table has no column {name[:40]}", where=f"{file}:1", remedy=f"its columns are {', '.join(header)}")
    numbers = rows[:, header.index(name)]
    starts = np.append(0, np.flatnonzero(np.diff(numbers)) + 1)
    sizes = np.diff(np.append(starts, len(rows)))
    if (sizes != sizes[0]).any() or len(np.unique(numbers)) != len(starts):
        raise InputError("not every point has as many rows, all together", where=f"{file}", remedy="sort by point, then by time")
    m = int(sizes[0])
    first = Path.from_rows(header, rows[:m], f"{file}", columns=columns, pressure=pressure, time=time)
    names = displacements(header, f"{file}", columns)
    values = np.stack([rows[:, header.index(n)] for n in names], axis=1).reshape(len(starts), m, len(names))
    if (at := header.index(spelled(time)) if spelled(time) in header else None) is not None:
        times = rows[:, at].reshape(len(starts), m)
        if (times != times[0]).any():
            raise InputError("points have knots at other times", where=f"{file}", remedy="give all the same times")
    load: Array | float | None = None if isinstance(pressure, str) else pressure
    if isinstance(pressure, str) and spelled(pressure) in header:
        load = rows[:, header.index(spelled(pressure))].reshape(len(starts), m)
    try:
        return Paths.linear(values, pressure=load, time=first.time if first.timed else None)
    except InputError as fault:
        raise InputError(fault.what, where=f"{file}", remedy=fault.remedy) from None
