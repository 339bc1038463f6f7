"""Measured limit points: a table of forces and normal stresses at which slip was seen to begin.

Sign convention: sigma_n < 0 in compression.  All stresses share one unit.  The normal stress is prescribed by the test
and counts as exact; each force carries an independent Gaussian error of standard deviation ``scatter``.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from os import PathLike, fspath
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.expression.given_array import columns, unmasked
from duhem.law.formula_law import Criterion
from duhem.law.placed_toml import text_of
from duhem.law.table_file import header_of

__all__ = ["Points"]

Array = NDArray[np.float64]

MOST_BYTES = 20_000_000
_MOST_ROWS = 200_000
_OPTIONAL = ("weight", "scatter")


@dataclass(frozen=True, eq=False)
class Points:
    """m limit points of a law: ``forces`` (m, d), ``pressure`` (m,) or None for a law without, ``scatter`` (m,).

    ``absolute``: the scatter is a standard deviation in the unit of the stresses; else it is known up to a common factor,
    which the fit estimates.  ``lines`` are the lines of the file (or the rows, from 1) and ``where`` its name.
    """

    forces: Array
    pressure: Array | None
    scatter: Array
    absolute: bool
    lines: tuple[int, ...]
    where: str

    def __len__(self) -> int:
        return len(self.forces)

    @classmethod
    def of(cls, given: Any, law: Criterion) -> Points:
        """From a CSV file, a mapping of columns, an array (m, d + 1) of forces and pressure, or points as they are.

        Columns: the law's forces, its pressure, and either ``weight`` (>= 0, proportional to 1/scatter^2) or ``scatter``
        (> 0, in the unit of the stresses); others are not read.  Raises InputError naming file, row and remedy.
        """
        if isinstance(given, Points):
            return given
        names = law.coordinates
        if isinstance(given, (str, PathLike)):
            return _of_columns(*_read(given, names), law, f"{fspath(given)}")
        if (table := columns(given, "points", names)) is not None:
            known = {n: _numbers(table[n], n) for n in (*names, *_OPTIONAL) if n in table}
            _complete(known, names, tuple(table), "points")
            return _of_columns(known, (), law, "points")
        rows = _numbers(given, "the table")
        if rows.ndim != 2 or rows.shape[1] != len(names):
            remedy = f"give one column for each of {', '.join(names)}"
            raise InputError(f"the table has the shape {rows.shape}", where="points", remedy=remedy)
        return _of_columns(dict(zip(names, rows.T, strict=True)), (), law, "points")

    def at(self, forces: Array) -> Points:
        """Return the same points with other forces."""
        return Points(forces, self.pressure, self.scatter, self.absolute, self.lines, self.where)


def _numbers(given: ArrayLike, what: str) -> Array:
    unmasked(given, what)
    try:
        if np.asarray(given).dtype.kind not in "bcmM":  # truth values, complex numbers, times and dates become doubles too
            return np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        pass
    raise InputError(f"{what} does not hold real numbers", where="points", remedy="give real numbers")


def _read(file: str | PathLike[str], names: Sequence[str]) -> tuple[dict[str, Array], tuple[int, ...]]:
    """Return the requested columns, and the line of each row."""
    where, text = f"{fspath(file)}", _text(file)
    rows = _rows(text, where)
    if not rows:
        raise InputError("the file is empty", where=where, remedy=f"give a header {','.join(names)} and one row per point")
    (first, header), *body = rows
    header = header_of(header, f"{where}:{first}", ",".join(names))
    _complete(header, names, header, f"{where}:{first}")
    if not body:
        raise InputError("there is no row below the header", where=where, remedy="give one row per point")
    kept = [(header.index(name), name) for name in (*names, *_OPTIONAL) if name in header]
    columns: dict[str, list[float]] = {name: [] for _, name in kept}
    for line, row in body:
        if len(row) != len(header):
            remedy = "give one cell per column, and write decimals with points"
            raise InputError(f"{len(row)} cells under {len(header)} columns", where=f"{where}:{line}", remedy=remedy)
        for i, name in kept:
            columns[name].append(_number(row[i], name, f"{where}:{line}"))
    return {name: np.array(values) for name, values in columns.items()}, tuple(line for line, _ in body)


def _text(file: str | PathLike[str]) -> str:
    text = text_of(file, "table of limit points", MOST_BYTES)
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        raise InputError("this is binary", where=f"{fspath(file)}:{line}", remedy="write the points as CSV")
    return text


def _rows(text: str, where: str) -> list[tuple[int, list[str]]]:
    """Yield the rows that are neither blank nor comments, with their lines."""
    reader = csv.reader(io.StringIO(text, newline=""))
    rows = []
    try:
        for row in reader:
            if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#"):
                rows.append((reader.line_num, row))
                if len(rows) > _MOST_ROWS:
                    place, remedy = f"{where}:{reader.line_num}", "fit a part of them"
                    raise InputError(f"there are more than {_MOST_ROWS} rows", where=place, remedy=remedy)
    except csv.Error as fault:
        raise InputError(f"this is not CSV: {fault}", where=f"{where}:{reader.line_num}", remedy="separate numbers by commas") from None
    return rows


def _complete(present: Any, names: Sequence[str], header: Sequence[str], where: str) -> None:
    """Raise InputError if a required column is missing, or if a name is nearly that of an optional column."""
    shown = ", ".join(header)[:120] or "none"
    if absent := [name for name in names if name not in present]:
        what = f"there is no column {', '.join(absent)}"
        raise InputError(what, where=where, remedy=f"its columns are {shown}; name the law's with --law")
    for name in header:
        if name not in (*names, *_OPTIONAL) and (near := get_close_matches(name.lower(), _OPTIONAL, n=1, cutoff=0.8)):
            what = f"unknown column {name[:40]!r}"
            raise InputError(what, where=where, remedy=f"did you mean {near[0]!r}? other columns need other names")
    if all(name in present for name in _OPTIONAL):
        raise InputError("both weight and scatter are given", where=where, remedy="keep one: weight is 1/scatter^2 up to a factor")


def _number(cell: str, name: str, where: str) -> float:
    try:
        return float(cell)
    except ValueError:
        shown = repr(cell.strip()[:30]) if cell.strip() else "empty"
        raise InputError(f"{name} is {shown}, not a number", where=where, remedy="write a number such as -1.5e6") from None


def _of_columns(columns: Mapping[str, Array], lines: tuple[int, ...], law: Criterion, where: str) -> Points:
    counts = {np.shape(column) for column in columns.values()}
    if len(counts) != 1 or len(next(iter(counts))) != 1:
        raise InputError("the columns differ in length", where=where, remedy="give one number per point in each")
    m = counts.pop()[0]
    if m == 0:
        raise InputError("there are no points", where=where, remedy="give one row per point")
    lines = lines or tuple(range(1, m + 1))

    def refuse(bad: NDArray[np.bool_], what: str, remedy: str) -> None:
        if bad.any():
            i = int(np.argmax(bad))
            place = f"{where}:{lines[i]}" if where != "points" else f"points, row {lines[i]}"
            raise InputError(what.format(i=i), where=place, remedy=remedy)

    for name, column in columns.items():
        value = repr(float(column[np.argmin(np.isfinite(column))]))
        refuse(~np.isfinite(column), f"{name} is {value}", "every number must be finite; remove the row")
    forces = np.column_stack([columns[name] for name in law.forces])
    pressure = columns[law.pressure] if law.pressure else None
    if pressure is not None:
        remedy = f"{law.pressure} < 0 in compression: change the sign, or remove points with open contact"
        refuse(pressure >= 0.0, f"{law.pressure} is not negative", remedy)
    size = np.max(np.abs(forces), axis=1)
    refuse(size == 0.0, f"{' = '.join(law.forces)} = 0 is no limit point", "give the forces at which slip begins")
    load = size if pressure is None else np.abs(pressure)
    refuse((size > 1e100) | (load > 1e100) | (size < 1e-100) | (load < 1e-100), "a stress is beyond 1e-100 ... 1e100", "change the unit")
    if m > 1 and not np.ptp(np.column_stack([forces, load]), axis=0).any():
        raise InputError(f"all {m} points are the same", where=where, remedy="give limit points in several directions")
    if "scatter" in columns:
        refuse(columns["scatter"] <= 0.0, "scatter is not positive", "give a standard deviation in the unit of the stresses")
        return Points(forces, pressure, columns["scatter"], True, lines, where)
    weight = columns.get("weight", np.ones(m))
    refuse(weight < 0.0, "weight is negative", "give weights >= 0, proportional to 1/scatter^2")
    kept = weight > 0.0
    if not kept.any():
        raise InputError("every weight is zero", where=where, remedy="give at least one point a positive weight")
    scatter = 1.0 / np.sqrt(weight[kept] / weight.max())
    shown = tuple(line for line, keep in zip(lines, kept, strict=True) if keep)
    return Points(forces[kept], None if pressure is None else pressure[kept], scatter, False, shown, where)
