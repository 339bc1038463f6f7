"""Many points from tables: one row a point for what is its own, or one row a knot of each point's own path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike

import numpy as np

from duhem.errors import InputError
from duhem.expression.spelling import spelled
from duhem.law.formula_law import Criterion
from duhem.path.loading import Path, displacements
from duhem.path.paths import Paths
from duhem.path.table_file import read_table
from duhem.projection.result import Array

__all__ = ["paths_from_csv", "spread"]


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
