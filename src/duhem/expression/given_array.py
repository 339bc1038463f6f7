"""Arrays as programs give them: tables by the names of their columns, whatever library made them, and none with masked entries.

What a table is is seen by what it offers: pandas, polars and xarray are not imported.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.syntax import repeated, spelled

__all__ = ["check_rows", "columns", "in_order", "reals", "unlabelled", "unmasked"]

_PLAIN = (np.generic, list, tuple, int, float, str)
_ONE_ORDER = "bring both into one order, or give an array"


def columns(given: Any, where: str, names: Sequence[str] = ()) -> dict[str, Any] | None:
    """The columns of a table by name, in one spelling; None of what has no names, such as an array.

    A table is a mapping (``xarray.Dataset`` is one), a data frame, a series or an ``xarray.DataArray`` labelled by names, or a
    NumPy array of records; where several dimensions of an array have names, that of the ``names`` counts.  InputError for names
    that are there twice, for labels of which only some are names or that are made of several, and for columns whose rows differ.
    """
    found = _labelled(given, names)
    labels = [label for label, _ in found or ()]
    if any(isinstance(label, tuple) and any(isinstance(part, str) for part in label) for label in labels):
        raise InputError("the columns are named at several levels", where=where, remedy="give each one name, or give a plain array")
    if not any(isinstance(label, str) for label in labels):
        return {} if isinstance(given, Mapping) else None
    if not all(isinstance(label, str) for label in labels):
        raise InputError("only some of the columns have a name", where=where, remedy="name each, or give a plain array")
    if twice := repeated(map(spelled, labels)):
        raise InputError(f"the column {twice[0]!r} is there twice", where=where, remedy="give each column its own name")
    made = {spelled(label): column for label, column in found or ()}
    first = next(iter(made.values()))
    ways = getattr(first, "dims", ())
    if other := next((name for name, column in made.items() if _apart(first, column) or getattr(column, "dims", ways) != ways), None):
        raise InputError(f"the rows of {other!r} have other labels than those of {next(iter(made))!r}", where=where, remedy=_ONE_ORDER)
    return made


def in_order(given: Any, names: Sequence[str], where: str) -> Any:
    """``given``, but the columns of a table in the order of ``names``, (N, d), or (d,) of one row.

    InputError where a name is missing, and for columns besides, which might be meant.
    """
    unmasked(given, where)
    table = columns(given, where, names)
    if table is None:
        return given
    absent, besides = [n for n in names if n not in table], [n for n in table if n not in names]
    if absent or besides:
        lacks, has = f"there is no column {', '.join(absent)}", f"no column {', '.join(besides)[:60]} is asked for"
        what = " and ".join([lacks] * bool(absent) + [has] * bool(besides))
        raise InputError(what, where=where, remedy=f"give the columns {', '.join(names)}, in any order, and no other")
    parts = [np.asarray(unmasked(table[name], f"{where}[{name!r}]")) for name in names]
    if strange := next((name for name, part in zip(names, parts, strict=True) if part.dtype.kind not in "iuf"), None):
        raise InputError("these are not real numbers", where=f"{where}[{strange!r}]", remedy="give a column of floats")
    try:
        return np.stack(parts, axis=-1)
    except ValueError:
        raise InputError("the columns differ in length", where=where, remedy="give one number a row in each") from None


def reals(given: Any) -> NDArray[np.float64] | None:
    """``given`` as doubles in an array of its own; None where it is not made of real numbers, as truth values and ragged rows are not."""
    with suppress(TypeError, ValueError):
        raw = np.asarray(given)
        if raw.dtype.kind in "iuf":
            return raw.astype(np.float64)
    return None


def unlabelled(given: Any, where: str, remedy: str) -> Any:
    """``given``; InputError for a table with names, whose order would count, and for masked entries."""
    if columns(given, where) is not None:
        raise InputError("this is a table with names, and nothing says in which order they count", where=where, remedy=remedy)
    return unmasked(given, where)


def unmasked(given: Any, where: str) -> Any:
    """``given``; InputError where an entry of a masked array is masked: it is no number, though there is one below the mask."""
    if "numpy.ma" not in sys.modules:  # nobody has made a masked array, and to ask NumPy for the type imports it
        return given
    if isinstance(given, np.ma.MaskedArray):
        mask: NDArray[np.bool_] = np.ma.getmaskarray(given)
        if len(bad := np.argwhere(mask)):
            index = f"[{', '.join(map(str, bad[0].tolist()))}]" if mask.ndim else ""
            raise InputError(f"{where}{index} is masked", remedy="leave the row out, or give its number")
    elif isinstance(given, list | tuple):  # NumPy takes what is below the masks of its parts
        for i, part in enumerate(given):
            if isinstance(part, list | tuple | np.ma.MaskedArray):
                unmasked(part, f"{where}[{i}]")
    return given


def check_rows(table: Any, column: Any, where: str) -> None:
    """InputError where ``column`` has rows of other labels than ``table``: they are taken in order, and not joined."""
    if (hasattr(table, "columns") or hasattr(table, "dims")) and _apart(table, column):
        raise InputError("its rows have other labels than those of the table of forces", where=where, remedy=_ONE_ORDER)


def _apart(table: Any, column: Any) -> bool:
    """Whether the rows of a table and a column have labels that differ: pandas' index, xarray's dimensions."""
    if hasattr(table, "dims") and hasattr(column, "dims"):
        known = [name for name in column.dims if name in table.coords and name in column.coords]
        return any(not np.array_equal(np.asarray(table.coords[name]), np.asarray(column.coords[name])) for name in known)
    ours: Any = getattr(table, "index", None)
    theirs: Any = getattr(column, "index", None)
    return hasattr(ours, "equals") and hasattr(theirs, "equals") and len(ours) == len(theirs) and not ours.equals(theirs)


def _labelled(given: Any, names: Sequence[str]) -> list[tuple[Any, Any]] | None:
    """Label and column, one by one; None of what has no labels."""
    if isinstance(given, np.ndarray):
        return None if given.dtype.names is None else [(name, given[name]) for name in given.dtype.names]
    if given is None or isinstance(given, _PLAIN):
        return None
    if isinstance(given, Mapping):
        return list(given.items())
    if hasattr(given, "columns") and hasattr(given, "__getitem__"):  # data frames, and tables of Arrow
        return [(label, given[label]) for label in getattr(given, "column_names", given.columns)]
    if hasattr(given, "dims") and hasattr(given, "coords"):  # xarray: along one dimension the labels may be names
        array, found = np.asarray(given), list[tuple[int, list[Any]]]()
        for name in given.coords:  # a dimension's own, or beside it
            along = getattr(given.coords[name], "dims", (name,))
            labels: list[Any] = np.asarray(given.coords[name]).tolist() if len(along) == 1 else []
            if any(isinstance(label, str) for label in labels):
                found.append((given.dims.index(along[0]), labels))
        if not found:
            return None
        axis, labels = next((each for each in found if any(spelled(x) in names for x in each[1] if isinstance(x, str))), min(found))
        return [(label, array.take(i, axis)) for i, label in enumerate(labels)]
    index = getattr(given, "index", None)
    return None if index is None or callable(index) else list(zip(index, np.asarray(given), strict=True))  # a series
