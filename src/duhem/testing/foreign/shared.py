"""A routine in a shared library, C or Fortran with bind(C), with a prototype that says what its arguments hold."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.projection.result import Array
from duhem.testing.foreign.native import SECONDS, Native, NativeFault, OutOfTime
from duhem.testing.foreign.prototype import RETURNED, Prototype
from duhem.testing.routines.material import Material, MaterialState
from duhem.testing.routines.overwritten import Overwritten, changed, overwritten
from duhem.testing.routines.routine import Step
from duhem.testing.routines.unfinished import Unfinished

__all__ = ["SharedLibrary", "loaded", "shared_library", "shared_material", "watched"]

_KEPT = {"double": np.double, "int": np.intc, "size_t": np.uintp}


def loaded(path: str | Path, symbol: str, kinds: str, isolated: bool, seconds: float) -> Native:
    """The routine of a library.  Raises InputError for a file or symbol that is not there, and for no time at all."""
    where = Path(path)
    if not seconds > 0.0:
        raise InputError(f"{seconds!r} s are no time to answer in", where="seconds", remedy="give a number > 0, or leave it out")
    if not where.is_file():
        raise InputError("there is no such file", where=str(path), remedy="give the place of the shared library (.so, .dylib, .dll)")
    try:
        return Native(str(where.resolve()), symbol, kinds, isolated, seconds)
    except NativeFault as fault:
        remedy = "name an exported function (nm -D lists them; Fortran without bind(C) adds an underscore)"
        raise InputError(str(fault), where="shared library", remedy=remedy) from None


def watched(
    native: Native, columns: Sequence[NDArray[Any]], rows: int, names: Sequence[str], given: Collection[str], n: int
) -> tuple[NDArray[np.int64], Overwritten | None]:
    """Call it for each of ``rows``, each of them one or all of n increments: what it returns (rows,), and what it has overwritten (n,).

    That is those of its arrays that it is only ``given``, and what lies before and behind any of them.  Raises Unfinished.
    """
    before = {name: (column.copy(), column) for name, column in zip(names, columns, strict=True) if name in given}
    try:
        codes, beside = native(list(columns), rows)
    except OutOfTime as fault:
        remedy = "look where its loop ends, or give it more time with seconds=..."
        raise Unfinished(str(fault), where="the routine", remedy=remedy) from None
    every = n // rows
    spoilt = changed(before) | {f"beside {names[j]}": beside[:, j] for j in np.flatnonzero(beside.any(axis=0)).tolist()}
    return codes, overwritten({name: np.repeat(rows_, every) for name, rows_ in spoilt.items()})


_DEFAULTS = {"parameters": {}, "variables": (), "solved": (0,), "column_major": False, "isolated": False, "seconds": SECONDS}


class _Call:
    """A function and the meaning of its arguments."""

    def __init__(self, path: str | Path, prototype: Prototype, solved: Collection[int], isolated: bool, seconds: float) -> None:
        self.prototype, self.solved = prototype, tuple(solved)
        self.native = loaded(path, prototype.symbol, "".join(a.kind for a in prototype.arguments), isolated, seconds)

    def __call__(self, by_row: Mapping[str, Any], same: Mapping[str, Any]) -> tuple[dict[str, Array], Any, Overwritten | None]:
        """``by_row`` (n, …), copies of which come back as the routine leaves them, and ``same`` for all; which are solved (n,).

        What it has overwritten (n,) comes last.
        """
        n = len(next(iter(by_row.values())))
        same = {"n": n, **same}
        filled = {"status": np.zeros(n, dtype=np.intc), **by_row}
        batched, columns = self.prototype.batched, []
        for a in self.prototype.arguments:
            if a.name in filled:
                column = np.array(filled[a.name], dtype=_KEPT[a.number], order="C")
                column = column[None] if batched else column
            else:
                flat, rows = np.array(same[a.name], dtype=_KEPT[a.number]).ravel(), 1 if batched else n
                column = np.repeat(flat[None], rows, axis=0) if a.place else np.repeat(flat[:1], rows)
            columns.append(column)
        names = [a.name for a in self.prototype.arguments]
        given = [a.name for a in self.prototype.arguments if a.place and a.name not in RETURNED]  # a value is a copy
        codes, spoilt = watched(self.native, columns, 1 if batched else n, names, given, n)
        named = zip(self.prototype.arguments, columns, strict=True)
        back = {a.name: c.reshape(np.shape(filled[a.name])) for a, c in named if a.name in filled}
        status = back.pop("status", np.repeat(codes, n // len(codes)) if self.prototype.returns else np.full(n, self.solved[0]))
        return back, np.array([code in self.solved for code in status.tolist()], dtype=np.bool_), spoilt


def _line(function: str, path: str | Path, *arguments: Any, **options: Any) -> str:
    """The Python that makes a routine again, options at their defaults left out."""
    said = [
        repr(str(Path(path).resolve())),
        *map(repr, arguments),
        *(f"{name}={value!r}" for name, value in options.items() if value != _DEFAULTS[name]),
    ]
    return f"from duhem.testing.foreign import {function}\nupdate = {function}({', '.join(said)})"


class SharedLibrary:
    """An update routine; see :func:`shared_library`."""

    def __init__(self, call: _Call, parameters: Mapping[str, float], column_major: bool, line: str) -> None:
        self._call, self._parameters, self._column_major = call, dict(parameters), column_major
        self.__duhem_import__ = line
        self.__name__ = self.__qualname__ = call.prototype.symbol

    def __call__(self, trial: Array, pressure: Array | None, stiffness: Array, **open_: float) -> Step:
        values = self._parameters | {name: float(value) for name, value in open_.items()}
        self._call.prototype.covers(values)
        n, d = trial.shape
        sizes: dict[str, tuple[int, ...]] = {"stress": (d,), "slip": (d,), "multiplier": (), "dissipation": (), "tangent": (d, d)}
        wanted = [a.name for a in self._call.prototype.arguments]
        by_row = {name: np.full((n, *size), np.nan) for name, size in sizes.items() if name in wanted}
        by_row |= {"trial": trial, "pressure": np.zeros(n) if pressure is None else pressure}
        back, solved, spoilt = self._call(by_row, {"stiffness": stiffness, "parameters": [*values.values()], "d": d, **values})
        tangent = back.get("tangent")
        if tangent is not None and self._column_major:
            tangent = np.swapaxes(tangent, 1, 2)
        return Step(back["stress"], back.get("slip"), back.get("multiplier"), tangent, solved, spoilt)


def shared_library(
    path: str | Path,
    signature: str,
    *,
    parameters: Mapping[str, float] | None = None,
    solved: Collection[int] = (0,),
    column_major: bool = False,
    isolated: bool = False,
    seconds: float = SECONDS,
) -> SharedLibrary:
    """The routine of a shared library with the prototype ``signature``, as C has it, as an update routine:

        shared_library("libfriction.so", "int friction(const double *trial, double pressure, const double *stiffness,
                                                       double mu, double *stress, double *tangent)")

    The name of an argument says what it holds: ``trial`` and the stress, ``slip`` and ``multiplier`` that are returned (and a
    ``dissipation``, which follows from them and is not looked at), the
    ``stiffness`` (d, d), the ``tangent`` d sigma/d u (d, d), ``pressure`` sigma_n <= 0, all in SI and as in
    :class:`duhem.testing.Step`; ``d`` the number of forces, ``parameters`` all parameters in their order, and any other name the
    parameter of that name.  With an argument ``n`` one call answers n increments, arrays (n, d) row by row (which Fortran declares
    (d, n)), scalars that differ by increment as arrays too; else it is called once an increment.  ``double x`` is passed by
    value, ``double *x`` by reference, as Fortran wants it without VALUE.

    ``parameters`` are further numbers, fixed ones; what conformance leaves open comes by name.  An int that the function returns,
    or writes to ``status``, is its status: the increment counts as solved where it is one of ``solved``.  ``column_major``: the
    tangent is in Fortran's order.  ``isolated``: run in a process of its own, so that a crash is a failed check, not the end of
    the test run, and a call that takes more than ``seconds``, as one without end does, an error that names the increment
    (:class:`duhem.testing.routines.unfinished.Unfinished`): no check is decided by the clock.  What is returned is filled with nan
    before, so that what the routine leaves out is seen; what it is only given, and 64 bytes before and behind each array, it has to
    leave as they are (the check ``inputs``).

    A library does not say how many arguments its function has: a prototype that differs from the source is not found out.

    Raises InputError for a missing file or symbol, and for a signature that is not understood or has no place for a parameter;
    called, NativeFault where the library ends its process.
    """
    read, fixed = Prototype.read(signature, "trial"), dict(parameters or {})
    line = _line(
        "shared_library", path, signature, parameters=fixed, solved=tuple(solved), column_major=column_major, isolated=isolated,
        seconds=seconds,
    )  # fmt: skip
    return SharedLibrary(_Call(path, read, solved, isolated, seconds), fixed, column_major, line)


def shared_material(
    path: str | Path,
    signature: str,
    stiffness: ArrayLike,
    *,
    variables: Sequence[float] = (),
    parameters: Mapping[str, float] | None = None,
    solved: Collection[int] = (0,),
    column_major: bool = False,
    isolated: bool = False,
    seconds: float = SECONDS,
) -> Material:
    """The routine of a shared library that is given increments of strain or displacement and carries a state, as a material:

        shared_material("libmises.so", "int mises(const double *increment, double *stress, double *variables, double *stored,
                                                  double *dissipated, double *tangent, double E, double nu, double yield)", …)

    As :func:`shared_library`, but it is given the ``increment`` (d,), the ``strain`` before it and its ``duration`` in s where it
    asks for them; ``stress``, the state ``variables`` (s,) and the energies ``stored`` and ``dissipated`` since the beginning
    hold the values before the step and are to be overwritten with those after it; ``tangent`` is d stress/d increment.
    ``stiffness`` (d, d) is the elastic one, ``variables`` the state at the beginning, where the stress is 0.
    """
    read, fixed = Prototype.read(signature, "increment"), dict(parameters or {})
    read.covers(fixed)
    call, k = _Call(path, read, solved, isolated, seconds), np.array(stiffness, dtype=np.float64)
    names = [a.name for a in read.arguments]
    energies = "stored" in names and "dissipated" in names

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        n, d = increment.shape
        zero = np.zeros(n)
        by_row = {"increment": increment, "strain": before.strain, "stress": before.stress, "variables": before.variables}
        by_row |= {"stored": zero if before.stored is None else before.stored, "tangent": np.full((n, d, d), np.nan)}
        by_row |= {"dissipated": zero if before.dissipated is None else before.dissipated, "slip": np.full((n, d), np.nan)}
        by_row |= {"pressure": zero if pressure is None else pressure}
        back, good, spoilt = call(by_row, {"stiffness": k, "parameters": [*fixed.values()], "d": d, "duration": duration, **fixed})
        tangent = back.get("tangent")
        if tangent is not None and column_major:
            tangent = np.swapaxes(tangent, 1, 2)
        state = back.get("variables", before.variables)
        stored, dissipated = (back["stored"], back["dissipated"]) if energies else (None, None)
        after = before.strain + increment, back["stress"], state, stored, dissipated
        return MaterialState(*after, back.get("slip"), tangent, good, spoilt)

    line = _line(
        "shared_material", path, signature, k.tolist(), variables=tuple(variables), parameters=fixed, solved=tuple(solved),
        column_major=column_major, isolated=isolated, seconds=seconds,
    )  # fmt: skip
    return Material(advance, k, tuple(variables), energies, name=read.symbol, line=line)
