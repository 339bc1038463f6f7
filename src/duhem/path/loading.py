"""Loading paths: knots of a prescribed displacement or stress with a normal stress, joined by straight lines or an arc.

What is alike for many points over the same times is held once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError, faults_at
from duhem.expression.given_array import reals, unlabelled, unmasked
from duhem.expression.syntax import spelled
from duhem.law.formula_law import Criterion
from duhem.law.table_file import MOST_NUMBERS, read_table
from duhem.projection.result import Array

__all__ = [
    "CONTROLS", "Arc", "Control", "Knot", "Path", "Paths", "Which", "between", "checked_count", "displacements", "given_numbers",
    "in_rows", "paths_from_csv", "spread",
]  # fmt: skip

# -- one path -----------------------------------------------------------------------------------------------------------

_OF_A_HISTORY = {"psi", "dissipation", "work", "numerical", "balance"}  # columns that no other table has together
Control = Literal["displacement", "stress"]
CONTROLS: tuple[Control, ...] = ("displacement", "stress")


@dataclass(frozen=True, eq=False)
class Arc:
    """A circle through the knots: centre (2,), radius > 0 and the angle (m,) of each knot, in radians."""

    centre: Array
    radius: float
    angle: Array

    def at(self, angle: Array) -> Array:
        """Points of the circle (m, 2)."""
        return np.asarray(self.centre + self.radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1))


@dataclass(frozen=True, eq=False)
class Path:
    """What is prescribed, at m >= 2 knots and straight in between (on a circle where ``arc`` is given).

    ``values`` (m, d): displacements in m, or stresses in Pa for ``control="stress"``; ``pressure`` (m,) the normal stress
    sigma_n <= 0 in compression in Pa, None for a law without; ``time`` (m,) in s, increasing: the laws are rate
    independent, so it only labels the knots, and counts the steps where the path is not ``timed``.  Raises InputError for
    arrays that do not fit each other.
    """

    values: Array
    pressure: Array | None
    time: Array
    control: Control = "displacement"
    arc: Arc | None = None
    timed: bool = True

    def __post_init__(self) -> None:
        given = (self.values, self.time, *([] if self.pressure is None else [self.pressure]))
        m = len(self.time) if isinstance(self.time, np.ndarray) else 0
        if not all(isinstance(array, np.ndarray) and len(array) == m for array in given) or self.values.ndim != 2:
            raise InputError("this is no path", where="path", remedy="make one with Path.linear(points, pressure=...)")

    @classmethod
    def linear(
        cls, points: ArrayLike, *, pressure: ArrayLike | None = None, time: ArrayLike | None = None, control: Control = "displacement"
    ) -> Path:
        """Straight from point to point: ``points`` (m, d), or (m,) for one force; ``pressure`` one number or (m,)."""
        if control not in CONTROLS:
            raise InputError(f"unknown control {control!r}", where="path", remedy=f"choose {' or '.join(CONTROLS)}")
        values = given_numbers(unlabelled(points, "points", "give its columns as an array, in the order of the forces"), "points")
        values = values[:, None] if values.ndim == 1 else values
        if values.ndim != 2 or len(values) < 2 or not values.shape[1]:
            raise InputError(f"points has the shape {np.shape(points)}", where="path", remedy="give (m, d) with at least two rows")
        m = len(values)
        _check_size(m, values.shape[1], "points")
        times = np.arange(m, dtype=np.float64) if time is None else given_numbers(time, "time")
        if times.shape != (m,):
            raise InputError(f"time has the shape {times.shape} for {m} points", where="path", remedy="give one time per point")
        if (back := np.flatnonzero(np.diff(times) <= 0.0)).size:
            i = int(back[0]) + 1
            raise InputError(f"time[{i}] = {times[i]} is not greater than {times[i - 1]}", where="path", remedy="give increasing times")
        load = _pressures(pressure, 1, m)
        return cls(values, None if load is None else np.array(np.broadcast_to(load[0], (m,))), times, control, timed=time is not None)

    @classmethod
    def cycle(
        cls,
        amplitude: ArrayLike,
        *,
        cycles: int = 1,
        mean: ArrayLike = 0.0,
        pressure: ArrayLike | None = None,
        control: Control = "displacement",
    ) -> Path:
        """0, then ``cycles`` times from mean + amplitude to mean - amplitude and back: ``amplitude`` (d,) or a number."""
        swing = np.atleast_1d(given_numbers(amplitude, "amplitude"))
        middle = given_numbers(mean, "mean")
        if swing.ndim != 1 or not swing.size or middle.shape not in ((), swing.shape):
            what = f"amplitude has the shape {swing.shape}, mean {middle.shape}"
            raise InputError(what, where="path", remedy="give one number per force in each")
        checked_count(cycles, "cycles", 1)
        _check_size(2 * cycles + 2, swing.size, "cycles")
        with np.errstate(all="ignore"):  # what is not finite is found
            corners = [np.zeros_like(swing), middle + swing, *[middle - swing, middle + swing] * cycles]
        return cls.linear(np.array(corners), pressure=pressure, control=control)

    @classmethod
    def circle(
        cls,
        radius: float,
        *,
        points: int = 64,
        turns: float = 1.0,
        start: float = 0.0,
        centre: ArrayLike = (0.0, 0.0),
        pressure: ArrayLike | None = None,
        chords: bool = False,
    ) -> Path:
        """Displacements round a circle, ``points`` steps a turn, from the angle ``start`` (rad); ``turns`` < 0 is clockwise.

        ``chords`` makes it the polygon of its knots instead.
        """
        checked_count(points, "points", 1)
        size, rounds, first = _number(radius, "radius"), _number(turns, "turns"), _number(start, "start")
        if not (size > 0.0 and rounds != 0.0):
            raise InputError(
                "radius, turns and start do not define a circle", where="path", remedy="give a radius > 0 and turns other than 0"
            )
        if not isinstance(chords, bool | np.bool_):
            raise InputError(f"chords = {str(chords)[:40]!r}", where="path", remedy="give true or false")
        _check_size(abs(rounds) * points + 1.0, 2, "turns")
        steps = max(1, round(abs(rounds) * points))
        middle = given_numbers(centre, "centre")
        if middle.shape != (2,):
            raise InputError(f"centre has the shape {middle.shape}", where="path", remedy="give two numbers")
        with np.errstate(all="ignore"):  # what is not finite is found
            arc = Arc(middle, size, first + 2.0 * np.pi * rounds * np.arange(steps + 1) / steps)
            knots = arc.at(arc.angle)
        polygon = cls.linear(knots, pressure=pressure)
        return polygon if chords else replace(polygon, arc=arc)

    @classmethod
    def random(cls, *, seed: int, points: int, scale: ArrayLike = 1.0, dimension: int = 2, pressure: ArrayLike | None = None) -> Path:
        """From 0 through ``points`` normal deviates times ``scale`` (a number or (d,)); the same seed gives the same path.

        ``pressure`` as in :meth:`linear`, or a pair (least, greatest) to draw each knot's from.
        """
        checked_count(points, "points", 1)
        checked_count(dimension, "dimension", 1)
        checked_count(seed, "seed", 0, 2**63 - 1)
        _check_size(points + 1, dimension, "points")
        size, load = given_numbers(scale, "scale"), None if pressure is None else given_numbers(pressure, "pressure")
        if size.shape not in ((), (dimension,)):
            raise InputError(f"scale has the shape {size.shape}", where="path", remedy=f"give one number or {dimension}")
        draw = np.random.default_rng(seed)
        with np.errstate(all="ignore"):  # what is not finite is found
            deviates = draw.standard_normal((points, dimension)) * size
        if load is not None and load.shape == (2,) and points != 1:
            low, high = np.sort(load).tolist()
            pressure = draw.uniform(low, high, points + 1)
        return cls.linear(np.vstack([np.zeros(dimension), deviates]), pressure=pressure)

    @classmethod
    def from_csv(
        cls,
        file: str | PathLike[str],
        *,
        columns: Sequence[str] | None = None,
        pressure: str | float | None = "sigma_n",
        time: str = "time",
        control: Control = "displacement",
    ) -> Path:
        """A table with a header: ``columns`` (left out: every ``u_...`` that is no ``u_in_...``), pressure and time if there.

        ``pressure`` names a column or is one number; a name that the header lacks means no pressure, or no times.  The table of a
        history whose times count its rows, 0, 1, 2 and so on, states none either: so it is written where the path stated none.
        """
        header, rows = read_table(file)
        return _from_rows(header, rows, f"{file}", columns, pressure, time, control)

    def refined(self, substeps: int) -> Path:
        """The same path with every step cut into ``substeps`` equal ones."""
        checked_count(substeps, "substeps", 1)
        if substeps == 1:
            return self
        _check_size((len(self.time) - 1) * substeps + 1, self.values.shape[1], "substeps")
        time, values = between(self.time, substeps), between(self.values, substeps)
        arc = None if self.arc is None else replace(self.arc, angle=between(self.arc.angle, substeps))
        if arc is not None:
            values = arc.at(arc.angle)
            values[::substeps] = self.values
        pressure = None if self.pressure is None else between(self.pressure, substeps)
        return replace(self, time=time, values=values, pressure=pressure, arc=arc)

    def between(self, step: int, part: float) -> tuple[float, Array, float]:
        """Time, values (d,) and pressure (0 for none) at the ``part`` from 0 to 1 of a step; step i leads to knot i."""

        def along(knots: Array) -> Any:
            return knots[step] - (1.0 - part) * (knots[step] - knots[step - 1])

        values = along(self.values) if self.arc is None else self.arc.at(along(self.arc.angle))
        return float(along(self.time)), values, 0.0 if self.pressure is None else float(along(self.pressure))

    @property
    def constant_pressure(self) -> bool:
        """Whether K stays the same along the path."""
        return self.pressure is None or bool((self.pressure == self.pressure[0]).all())


def _from_rows(
    header: Sequence[str], rows: Array, where: str, columns: Sequence[str] | None, pressure: str | float | None, time: str, control: Control
) -> Path:
    """The path of a table that is read: its names and rows, and ``where`` it is from."""
    names = displacements(header, where, columns)
    at = {name: rows[:, i] for i, name in enumerate(header)}
    load = at.get(spelled(pressure)) if isinstance(pressure, str) else pressure
    times = at.get(spelled(time))
    if times is not None and at.keys() >= _OF_A_HISTORY and np.array_equal(times, np.arange(len(rows))):
        times = None
    with faults_at(where):
        return Path.linear(np.stack([at[n] for n in names], axis=1), pressure=load, time=times, control=control)


def displacements(header: Sequence[str], where: str, columns: Sequence[str] | None) -> tuple[str, ...]:
    """The columns of a table that are prescribed: those named, or every ``u_...`` that is no ``u_in_...``."""
    if columns is not None and (isinstance(columns, str) or not all(isinstance(name, str) for name in columns)):
        raise InputError("columns is no list of names", where="columns", remedy='write columns = ["u_a", "u_b"]')
    own = tuple(h for h in header if h.startswith("u_") and not h.startswith("u_in_"))
    names = own if columns is None else tuple(map(spelled, columns))
    if not names or (absent := [n for n in names if n not in header]):
        lacks = f"no column {', '.join(absent)}" if names else "no column named u_..."
        raise InputError(f"the table has {lacks}", where=f"{where}:1", remedy=f"its columns are {', '.join(header)}")
    return names


def between(knots: Array, n: int) -> Array:
    """Each interval cut into n; the knots themselves stay as they are to the last bit."""
    part = (np.arange(n) / n).reshape((1, n) + (1,) * (knots.ndim - 1))
    inner = knots[:-1, None] + part * (knots[1:] - knots[:-1])[:, None]
    return np.concatenate([inner.reshape(-1, *knots.shape[1:]), knots[-1:]])


def given_numbers(given: Any, what: str) -> Array:
    """Finite doubles; InputError names the first entry that is none."""
    if (array := reals(unmasked(given, what))) is None:
        raise InputError(f"{what} is not made of numbers", where="path", remedy="give finite numbers")
    if len(bad := np.argwhere(~np.isfinite(array))):  # of one number too, which has no index
        at = tuple(bad[0].tolist())
        raise InputError(f"{what}{list(at) if at else ''} is {array[at]}", where="path", remedy="give finite numbers")
    return array


def _number(given: Any, what: str) -> float:
    array = given_numbers(given, what)
    if array.ndim:
        raise InputError(f"{what} has the shape {array.shape}", where="path", remedy="give one number")
    return float(array)


def checked_count(given: Any, what: str, least: int, most: int = MOST_NUMBERS) -> None:
    """InputError for what is no whole number from ``least`` to ``most``."""
    whole = isinstance(given, (int, np.integer)) and not isinstance(given, bool)
    if not whole or not least <= given <= most:
        shown = repr(given)[:60] if not whole or abs(given) < 10**60 else "a number of more than 60 digits"
        raise InputError(f"{what} = {shown}", where="path", remedy=f"give a whole number from {least} to {most}")


def _check_size(knots: float, dimension: int, what: str) -> None:
    """Whether so many knots are kept, before there is memory for them."""
    most = MOST_NUMBERS // dimension
    if not knots <= most:
        raise InputError(f"{what}: {knots:.6g} knots are too many", where="path", remedy=f"give at most {most}, or run the path in parts")


# -- many points --------------------------------------------------------------------------------------------------------

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
                "this is not a path of displacements", where="paths", remedy="give one made with Path.linear(points, pressure=...)"
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
        factor = self.factor if which is None or len(self.factor) == 1 else self.factor[which]
        return np.asarray(in_rows(self.values, knot, np.arange(len(self)) if which is None else which) * factor)

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
    """The pressure of n points at m knots, with one row or one column where all are alike."""
    if given is None:
        return None
    load = _doubles(given, "pressure")
    rows = load.reshape((1,) * (2 - load.ndim) + load.shape) if load.ndim < 2 else load
    if rows.ndim != 2 or rows.shape[0] not in (1, n) or rows.shape[1] not in (1, m):
        what = f"pressure has the shape {np.shape(given)} for {n} points and {m} knots"
        raise InputError(what, where="path", remedy=f"give one number, ({m},), ({n}, 1) or ({n}, {m})")
    if load.size and load.max() > 0.0:
        at = np.argwhere(load > 0.0)[0].tolist()
        remedy = "sigma_n <= 0 in compression, 0 where contact is open"
        raise InputError(f"pressure{at or ''} is {load[tuple(at)]} > 0", where="path", remedy=remedy)
    return rows


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
    with faults_at(f"{file}"):
        if isinstance(path, Path):
            paths = Paths.scaled(path, by, pressure=load)
        elif len(path) != n:
            raise InputError(f"{n} points here and {len(path)} paths", remedy="give a row for each point of the path's table")
        else:
            given = Paths.linear(path.values, pressure=path.pressure if load is None else load, time=path.time)
            paths = replace(given, factor=path.factor * by, timed=path.timed)
    return paths, {name: column[name] for name in law.parameters if name in column}


def paths_from_csv(
    file: str | PathLike[str],
    *,
    point: str,
    columns: Sequence[str] | None = None,
    pressure: str | float | None = "sigma_n",
    time: str = "time",
    control: Control = "displacement",
) -> Paths:
    """A table of one row a knot, as :meth:`duhem.Path.from_csv` reads one, in which the column ``point`` tells points apart.

    The rows of a point stand together, and all have as many knots at the same times.
    """
    if control != "displacement" or not isinstance(point, str):
        raise InputError(
            "a table of many points needs displacements and a column that numbers the points", where="path", remedy='write point = "point"'
        )
    header, rows = read_table(file)
    name = spelled(point)
    if name not in header:
        raise InputError(f"the table has no column {name[:40]}", where=f"{file}:1", remedy=f"its columns are {', '.join(header)}")
    numbers = rows[:, header.index(name)]
    starts = np.append(0, np.flatnonzero(np.diff(numbers)) + 1)
    sizes = np.diff(np.append(starts, len(rows)))
    if (sizes != sizes[0]).any() or len(np.unique(numbers)) != len(starts):
        raise InputError(
            "the points do not have the same number of consecutive rows", where=f"{file}", remedy="sort by point, then by time"
        )
    m = int(sizes[0])
    first = _from_rows(header, rows[:m], f"{file}", columns, pressure, time, control)
    names = displacements(header, f"{file}", columns)
    values = np.stack([rows[:, header.index(n)] for n in names], axis=1).reshape(len(starts), m, len(names))
    if (at := header.index(spelled(time)) if spelled(time) in header else None) is not None:
        times = rows[:, at].reshape(len(starts), m)
        if (times != times[0]).any():
            raise InputError("the points have different times", where=f"{file}", remedy="give the same times for all points")
    load: Array | float | None = None if isinstance(pressure, str) else pressure
    if isinstance(pressure, str) and spelled(pressure) in header:
        load = rows[:, header.index(spelled(pressure))].reshape(len(starts), m)
    with faults_at(f"{file}"):
        return Paths.linear(values, pressure=load, time=first.time if first.timed else None)
