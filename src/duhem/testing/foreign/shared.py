"""A routine in a shared library, C or Fortran with bind(C), with a prototype that says what its arguments hold.

The name of an argument says what it holds, its type how it is passed.

A subroutine with the arguments of Abaqus' UMAT, in double precision, is a material too (Abaqus User Subroutines Reference Guide, UMAT):
stresses in the order 11, 22, 33, 12, 13, 23 (the first NDI direct ones, then NSHR shears), tension positive, shear strains those of
engineers; DDSDDE = d DSTRESS/d DSTRAN, SSE and SPD increased by the step.  Its source is compiled to a shared library once a process, with
stubs of what Abaqus offers a UMAT.
"""

from __future__ import annotations

import atexit
import os
import re
import shutil
import subprocess
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.projection.result import Array
from duhem.testing.foreign.native import SECONDS, Native, NativeFault, OutOfTime
from duhem.testing.routines import Material, MaterialState, Overwritten, Step, Unfinished, changed, overwritten

__all__ = [
    "SOURCES", "Argument", "Prototype", "SharedLibrary", "built", "loaded", "made_again", "rotation", "shared_library", "shared_material",
    "umat", "watched",
]  # fmt: skip

_RETURNED = ("stress", "tangent", "slip", "multiplier", "dissipation", "status", "variables", "stored", "dissipated")
_BOTH, _OUT = ("pressure", "stiffness", "parameters", "n", "d"), ("stress", "tangent", "slip")
_WORDS = {  # by what the routine is given
    "trial": (*_BOTH, "trial", *_OUT, "multiplier", "dissipation", "status"),
    "increment": (*_BOTH, "increment", "strain", "duration", *_OUT, "variables", "stored", "dissipated", "status"),
}
_MEANINGS = frozenset().union(*_WORDS.values())
_NUMBERS: dict[str, tuple[str, Any]] = {"double": ("d", np.double), "int": ("i", np.intc), "size_t": ("n", np.uintp)}
_ARGUMENT = re.compile(
    r"(?:const\s+)?(double|int|size_t)\s*(?:const\s*)?(\*?)\s*(?:(?:restrict|__restrict|__restrict__|const)\s+)*([A-Za-z_]\w*)\s*((?:\[\w*\]\s*)*)"
)
_WHOLE = re.compile(r"\s*(?:extern\s+)?(void|int)\s+([A-Za-z_]\w*)\s*\((.*)\)\s*;?\s*", flags=re.S)
_EXAMPLE = "write it as in the header: 'int friction(const double *trial, double pressure, double mu, double *stress)'"


@dataclass(frozen=True)
class Argument:
    """``number`` is "double", "int" or "size_t"; ``place``: passed as a pointer."""

    name: str
    number: str
    place: bool

    @property
    def kind(self) -> str:
        """The letter of :class:`duhem.testing.foreign.native.Native`."""
        return "p" if self.place else _NUMBERS[self.number][0]


@dataclass(frozen=True)
class Prototype:
    """``returns``: whether the routine returns an int, its status."""

    symbol: str
    arguments: tuple[Argument, ...]
    returns: bool

    @classmethod
    def read(cls, text: str, driver: str) -> Prototype:
        """``driver`` is what the routine is given beside what it returns, "trial" or "increment".

        Raises InputError for what is no such prototype, with the argument that is not understood.
        """
        whole = _WHOLE.fullmatch(re.sub(r"/\*.*?\*/", " ", text, flags=re.S))
        if whole is None:
            raise InputError(f"{text!r} is not the prototype of a function that returns void or int", where="signature", remedy=_EXAMPLE)
        back, symbol, inner = whole.groups()
        arguments = tuple(_argument(part) for part in inner.split(","))
        names = [a.name for a in arguments]
        if twice := [name for name in names if names.count(name) > 1]:
            raise InputError(f"{twice[0]!r} is named twice", where=f"signature of {symbol}", remedy="give each argument its own name")
        remedy = f"use these names for the arguments: {', '.join(_WORDS[driver])}, or a parameter"
        if lacking := [needed for needed in (driver, "stress") if needed not in names]:
            raise InputError(f"there is no argument {lacking[0]!r}", where=f"signature of {symbol}", remedy=remedy)
        if strange := [name for name in names if name in _MEANINGS and name not in _WORDS[driver]]:
            raise InputError(f"{strange[0]!r} is not known to a routine given {driver}", where=f"signature of {symbol}", remedy=remedy)
        if "n" in names and any(a.name == "pressure" and not a.place for a in arguments):
            remedy = "make it an array: 'const double *pressure'"
            raise InputError("one pressure for n increments", where=f"signature of {symbol}", remedy=remedy)
        return cls(symbol, arguments, back == "int")

    @property
    def batched(self) -> bool:
        """Whether one call answers ``n`` increments."""
        return any(a.name == "n" for a in self.arguments)

    def values(self) -> tuple[str, ...]:
        """The names that are no meaning of their own: parameters."""
        return tuple(a.name for a in self.arguments if a.name not in _MEANINGS)

    def covers(self, values: Iterable[str]) -> None:
        """Raises InputError unless the numbers that are known are those that the signature has a place for."""
        known = set(values)
        where = f"signature of {self.symbol}"
        if lacking := [name for name in self.values() if name not in known]:
            said = "it is neither a known name nor a parameter"
            raise InputError(f"argument {lacking[0]!r}: {said}", where=where, remedy="rename it, or give its value in parameters")
        whole = any(a.name == "parameters" for a in self.arguments)
        if not whole and (unread := sorted(known - set(self.values()))):
            remedy = f"add 'double {unread[0]}', or fix its value in conformance"
            raise InputError(f"there is no argument for the parameter {unread[0]!r}", where=where, remedy=remedy)


def _argument(text: str) -> Argument:
    found = _ARGUMENT.fullmatch(text.strip())
    if found is None:
        raise InputError(f"{text.strip()!r} is not understood as an argument", where="signature", remedy=_EXAMPLE)
    number, star, name, brackets = found.groups()
    argument = Argument(name, number, bool(star or brackets))
    if (number == "double") == (name in ("n", "d", "status")):
        raise InputError(f"{text.strip()!r}: a {number}", where="signature", remedy="n, d and status are integers, all else is double")
    if name in _RETURNED and not argument.place:
        raise InputError(f"{text.strip()!r} cannot be written to", where="signature", remedy=f"make it a pointer: '{number} *{name}'")
    if not argument.place and name in ("trial", "increment", "strain", "stiffness", "parameters"):
        raise InputError(f"{text.strip()!r} is one number", where="signature", remedy=f"make it a pointer: 'const double *{name}'")
    return argument


def loaded(path: str | Path, symbol: str, kinds: str, isolated: bool, seconds: float) -> Native:
    """Return the routine of a library.  Raises InputError for a file or symbol that is not there, and unless ``seconds`` > 0."""
    where = Path(path)
    if not seconds > 0.0:
        raise InputError(f"{seconds!r} s is not a valid time limit", where="seconds", remedy="give a number > 0, or remove it")
    if not where.is_file():
        raise InputError("there is no such file", where=str(path), remedy="give the path of the shared library (.so, .dylib, .dll)")
    try:
        return Native(str(where.resolve()), symbol, kinds, isolated, seconds)
    except NativeFault as fault:
        remedy = "name an exported function (nm -D lists them; Fortran without bind(C) adds an underscore)"
        remedy = "add what is missing to the source or the library" if "undefined symbol" in str(fault) else remedy
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
        remedy = "check its loops, or allow more time with seconds=..."
        raise Unfinished(str(fault), where="the routine", remedy=remedy) from None
    every = n // rows
    spoilt = changed(before) | {f"beside {names[j]}": beside[:, j] for j in np.flatnonzero(beside.any(axis=0)).tolist()}
    return codes, overwritten({name: np.repeat(rows_, every) for name, rows_ in spoilt.items()})


class _Call:
    """A function with what its arguments hold; its options are those of :func:`shared_library`."""

    def __init__(
        self, path: str | Path, signature: str, driver: str, solved: Collection[int], column_major: bool, isolated: bool, seconds: float
    ) -> None:
        self.prototype, self.solved, self.column_major = Prototype.read(signature, driver), tuple(solved), column_major
        arguments = self.prototype.arguments
        self.names = [a.name for a in arguments]
        self.given = [a.name for a in arguments if a.place and a.name not in _RETURNED]  # a value is a copy
        self.native = loaded(path, self.prototype.symbol, "".join(a.kind for a in arguments), isolated, seconds)

    def __call__(
        self, by_row: Mapping[str, Any], pressure: Array | None, stiffness: Array, values: Mapping[str, float], **same: float
    ) -> tuple[dict[str, Array], Any, Overwritten | None]:
        """Return what the function has written by name (n, …), which increments are solved (n,), and what it has overwritten (n,).

        ``by_row`` are arrays (n, …) of which it is given copies, the first one (n, d); ``values`` parameters, and ``same`` other numbers.
        What it returns is nan before, where ``by_row`` has no value.
        """
        n, d = next(iter(by_row.values())).shape
        sizes: dict[str, tuple[int, ...]] = {"stress": (d,), "slip": (d,), "multiplier": (), "dissipation": (), "tangent": (d, d)}
        filled = {name: np.full((n, *size), np.nan) for name, size in sizes.items() if name in self.names and name not in by_row}
        filled |= {"status": np.zeros(n, dtype=np.intc), "pressure": np.zeros(n) if pressure is None else pressure, **by_row}
        known = {"n": n, "d": d, "stiffness": stiffness, "parameters": [*values.values()], **values, **same}
        batched, columns = self.prototype.batched, []
        for a in self.prototype.arguments:
            if a.name in filled:
                column = np.array(filled[a.name], dtype=_NUMBERS[a.number][1], order="C")
                column = column[None] if batched else column
            else:
                flat, rows = np.array(known[a.name], dtype=_NUMBERS[a.number][1]).ravel(), 1 if batched else n
                column = np.repeat(flat[None], rows, axis=0) if a.place else np.repeat(flat[:1], rows)
            columns.append(column)
        codes, spoilt = watched(self.native, columns, 1 if batched else n, self.names, self.given, n)
        back = {name: c.reshape(np.shape(filled[name])) for name, c in zip(self.names, columns, strict=True) if name in filled}
        status = back.pop("status", np.repeat(codes, n // len(codes)) if self.prototype.returns else np.full(n, self.solved[0]))
        if self.column_major and "tangent" in back:
            back["tangent"] = np.swapaxes(back["tangent"], 1, 2)
        return back, np.array([code in self.solved for code in status.tolist()], dtype=np.bool_), spoilt


def made_again(function: Callable[..., Any], path: str | Path, *arguments: Any, **options: Any) -> str:
    """Return the Python that makes a routine again, without options at their defaults."""
    defaults = function.__kwdefaults__ or {}
    said = [repr(str(Path(path).resolve())), *map(repr, arguments)]
    said += [f"{name}={value!r}" for name, value in options.items() if value != defaults[name] and (value or defaults[name])]
    return f"from duhem.testing.foreign import {function.__name__}\nupdate = {function.__name__}({', '.join(said)})"


class SharedLibrary:
    """An update routine; see :func:`shared_library`."""

    def __init__(self, call: _Call, parameters: Mapping[str, float], line: str) -> None:
        self._call, self._parameters = call, dict(parameters)
        self.__duhem_import__ = line
        self.__name__ = self.__qualname__ = call.prototype.symbol

    def __call__(self, trial: Array, pressure: Array | None, stiffness: Array, **open_: float) -> Step:
        values = self._parameters | {name: float(value) for name, value in open_.items()}
        self._call.prototype.covers(values)
        back, solved, spoilt = self._call({"trial": trial}, pressure, stiffness, values)
        return Step(back["stress"], back.get("slip"), back.get("multiplier"), back.get("tangent"), solved, spoilt)


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
    the test run, and a call that takes more than ``seconds``, as one without end does, ends a run with the increment
    (:attr:`duhem.testing.Report.unfinished`): no check is decided by the clock.  What is returned is filled with nan
    before, so that what the routine leaves out is seen; what it is only given, and 64 bytes before and behind each array, it has to
    leave as they are (the check ``inputs``).

    A library does not say how many arguments its function has: a prototype that differs from the source is not found out.

    Raises InputError for a missing file or symbol, and for a signature that is not understood or has no place for a parameter;
    called, NativeFault where the library ends its process.
    """
    fixed = dict(parameters or {})
    how: dict[str, Any] = {"solved": tuple(solved), "column_major": column_major, "isolated": isolated, "seconds": seconds}
    line = made_again(shared_library, path, signature, parameters=fixed, **how)
    return SharedLibrary(_Call(path, signature, "trial", **how), fixed, line)


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
    fixed, k = dict(parameters or {}), np.array(stiffness, dtype=np.float64)
    how: dict[str, Any] = {"solved": tuple(solved), "column_major": column_major, "isolated": isolated, "seconds": seconds}
    Prototype.read(signature, "increment").covers(fixed)
    call = _Call(path, signature, "increment", **how)
    energies = {"stored", "dissipated"} <= {*call.names}

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        by_row = {"increment": increment, "strain": before.strain, "stress": before.stress, "variables": before.variables}
        kept = {"stored": before.stored, "dissipated": before.dissipated}
        by_row |= {name: np.zeros(len(increment)) if energy is None else energy for name, energy in kept.items()}
        back, good, spoilt = call(by_row, pressure, k, fixed, duration=duration)
        stored, dissipated = (back["stored"], back["dissipated"]) if energies else (None, None)
        after = before.strain + increment, back["stress"], back.get("variables", before.variables), stored, dissipated
        return MaterialState(*after, back.get("slip"), back.get("tangent"), good, spoilt)

    line = made_again(shared_material, path, signature, k.tolist(), variables=tuple(variables), parameters=fixed, **how)
    return Material(advance, k, tuple(variables), energies, name=call.prototype.symbol, line=line)


# -- a subroutine with the arguments of Abaqus' UMAT -------------------------------------------------------------------

_WRITTEN = ("STRESS", "STATEV", "DDSDDE", "SSE", "SPD", "SCD", "RPL", "DDSDDT", "DRPLDE", "DRPLDT")
_GIVEN = (
    "STRAN", "DSTRAN", "TIME", "DTIME", "TEMP", "DTEMP", "PREDEF", "DPRED", "CMNAME", "NDI", "NSHR", "NTENS", "NSTATV", "PROPS",
    "NPROPS", "COORDS", "DROT", "PNEWDT", "CELENT", "DFGRD0", "DFGRD1", "NOEL", "NPT", "LAYER", "KSPT", "JSTEP", "KINC",
)  # fmt: skip
# by reference, then the length of CMNAME by value, which compilers of Fortran pass after them
_NAMES = (*_WRITTEN, *_GIVEN, "the length of CMNAME")
_KINDS = "p" * len((*_WRITTEN, *_GIVEN)) + "n"
_KEPT = frozenset(_GIVEN) - {"PNEWDT"}
_ORDERS = {"abaqus": ("xx", "yy", "zz", "xy", "xz", "yz"), "voigt": ("xx", "yy", "zz", "yz", "xz", "xy")}
_SECONDS = 10.0  # that all increments of one call may take
_SAFE = "duhem_umat"  # of the stubs: it comes back from XIT
_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def rotation(axes: ArrayLike) -> Array:
    """T (6, 6) with stress in the material axes = T stress, for axes (3, 3) whose rows are the material's directions.

    Strains with engineering shears go with the inverse transpose of T.  Raises InputError where the axes are not orthonormal.
    """
    q = np.array(axes, dtype=np.float64)
    if q.shape != (3, 3) or not np.allclose(q @ q.T, np.eye(3), atol=1e-12):
        raise InputError("the material axes are no rotation", where="axes", remedy="give three orthonormal directions as rows (3, 3)")
    i, j = np.array(_PAIRS).T
    return np.asarray(q[np.ix_(i, i)] * q[np.ix_(j, j)] + np.where(i != j, q[np.ix_(i, j)] * q[np.ix_(j, i)], 0.0))


def umat(
    path: str | Path,
    props: Sequence[float] = (),
    stiffness: ArrayLike | None = None,
    *,
    ntens: int | None = None,
    nstatv: int | None = None,
    order: str | Sequence[str] = "abaqus",
    state: Mapping[str, Any] | None = None,
    variables: Sequence[float] = (),
    direct: int | None = None,
    axes: ArrayLike | None = None,
    energies: bool = True,
    tangent: bool = True,
    name: str = "MATERIAL",
    symbol: str = "umat_",
    isolated: bool = True,
    seconds: float = _SECONDS,
) -> Material:
    """A UMAT, of a source file or a shared library, as a material.

    A source in Fortran or C (``.f``, ``.for``, ``.f90``, ``.c``, ...) is compiled with the compiler that FC or CC names, or gfortran or cc,
    together with stubs of what Abaqus offers: XIT and STDB_ABQERR(-3, ...), which end the increment as not solved, ROTSIG, SINV, SPRINC,
    SPRIND, GETVRM (which knows no output variable) and ABA_PARAM.INC.  Of Fortran, gfortran alone was tried.

    ``props`` are PROPS; ``nstatv`` the number of STATEV, ``variables`` their values at the beginning (default: 0).  ``ntens`` (default
    6) is 6, 4 (NDI = 3, NSHR = 1) or 3 (plane stress, NDI = 2), or any other with ``direct`` for NDI.  ``order`` names the components of
    the routine: "abaqus" (xx yy zz xy xz yz), "voigt" (xx yy zz yz xz xy), or the names themselves; a law with a stress of such
    components is put in that order.  Shear strains are those of engineers.  ``state`` says where the variables of a law stand in
    STATEV (:func:`duhem.testing.conformance`).  ``stiffness`` (NTENS, NTENS), the elastic one, is measured if left out, and compared
    with what is measured if given.  ``axes``: the material's directions as rows (3, 3), where they are not those of the strains: what
    UMAT is given and returns is then turned, six components alone.  ``energies``, ``tangent``: whether it sets SSE and SPD (with SCD),
    which are not judged where they stay 0, and DDSDDE, which is zero before.  A PNEWDT below 1 says that the increment is not solved.
    The last argument beside Abaqus' is the length of CMNAME, as gfortran and ifort pass it.  DFGRD0, DFGRD1 and DROT are the identity
    (small strains); times are in s, and an increment from the beginning has KINC 1 and TIME 0, any other KINC 2 and DTIME for TIME.  TEMP
    is the temperature of the points, or 0, each point an element of its own (NOEL).
    ``isolated``, ``seconds`` and what it has to leave as it is, as in :func:`shared_library`; what an isolated routine prints is shown
    where it fails, and nowhere else.

    Raises InputError for a missing file or symbol, a source that does not compile, and for sizes that do not fit.
    """
    k = None if stiffness is None else np.array(stiffness, dtype=np.float64)
    size = ntens if ntens is not None else 6 if k is None else len(k) if k.ndim == 2 else 0
    ndi = direct if direct is not None else 2 if size == 3 else min(size, 3)
    library = built(path)
    native = loaded(library, _SAFE if library != Path(path) and symbol == "umat_" else symbol, _KINDS, isolated, seconds)
    if not 1 <= ndi <= size or (k is not None and k.shape != (size, size)):
        remedy = "give ntens, and a stiffness (NTENS, NTENS), NDI <= NTENS"
        raise InputError(f"{ndi} direct stresses among {size}", where="umat", remedy=remedy)
    if axes is not None and size != 6:
        raise InputError(f"material axes with {size} components", where="umat", remedy="turn the properties, or use six components")
    first = np.zeros(nstatv or 0) if not len(variables) else np.array(variables, dtype=np.float64)
    if nstatv not in (None, len(first)):
        raise InputError(f"{len(first)} variables, and nstatv = {nstatv}", where="umat", remedy="give one of them")
    turn = np.eye(size) if axes is None else rotation(axes)
    back = np.linalg.inv(turn)
    material_name = np.frombuffer(name.ljust(80)[:80].encode("ascii", "replace"), dtype=np.uint8)

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        n = len(increment)

        def rows(given: Any, kept: Any = np.double) -> NDArray[Any]:
            return np.tile(np.asarray(given, dtype=kept).ravel(), (n, 1))

        def integer(value: int) -> NDArray[Any]:
            return rows([value], np.intc)

        def column(given: Array | None) -> Array:
            return np.zeros((n, 1)) if given is None else given[:, None].copy()

        strain, step = (np.ascontiguousarray(x @ back) for x in (before.strain, increment))  # T^-T x
        stress = np.ascontiguousarray(before.stress @ turn.T)
        statev = np.array(before.variables, dtype=np.double, order="C")
        slopes = np.zeros((n, size, size))
        sse, spd, warm = map(column, (before.stored, before.dissipated, before.temperature))
        smaller, scd, scalar, ones = rows([1.0]), rows([0.0]), rows([0.0]), np.eye(3)
        begun = (before.strain.any(axis=1) | before.stress.any(axis=1) | (statev != first).any(axis=1))[:, None]
        columns = [
            stress, statev, slopes, sse, spd, scd, scalar.copy(), rows(np.zeros(size)), rows(np.zeros(size)), scalar.copy(),
            strain, step, begun * rows([duration, duration]), rows([duration]), warm, scalar.copy(),
            scalar.copy(), scalar.copy(), np.tile(material_name, (n, 1)), integer(ndi), integer(size - ndi), integer(size),
            integer(len(first)), rows([*props]), integer(len(props)), rows(np.zeros(3)), rows(ones), smaller,
            rows([1.0]), rows(ones), rows(ones), np.arange(1, n + 1, dtype=np.intc)[:, None], integer(1), integer(1), integer(1),
            rows([1, 1, 0, 0], np.intc), integer(1) + begun, np.full(n, 80, dtype=np.uintp),
        ]  # fmt: skip
        _, spoilt = watched(native, columns, n, _NAMES, _KEPT, n)
        stored, dissipated = (sse[:, 0], spd[:, 0] + scd[:, 0]) if energies else (None, None)
        found = back @ np.swapaxes(slopes, 1, 2) @ back.T if tangent else None  # Fortran keeps columns together
        strain_after, solved = before.strain + increment, ~(smaller[:, 0] < 1.0)
        return MaterialState(strain_after, stress @ back.T, statev, stored, dissipated, None, found, solved, spoilt)

    names = _ORDERS.get(order, ()) if isinstance(order, str) else tuple(order)
    if isinstance(order, str) and not names:
        raise InputError(f"unknown order {order!r}", where="umat", remedy=f"give {' or '.join(_ORDERS)}, or the names of the components")
    kept = {6: names, 4: tuple(x for x in names if x not in ("xz", "yz")), 3: tuple(x for x in names if "z" not in x)}
    components = names if len(names) == size else kept.get(size, ()) if direct is None else ()
    components = components if k is not None or len(components) == size else tuple(map(str, range(1, size + 1)))
    given: dict[str, Any] = {"ntens": size, "variables": first.tolist(), "axes": None if axes is None else np.asarray(axes).tolist()}
    given |= {"direct": ndi, "energies": energies, "tangent": tangent, "name": name, "symbol": symbol, "isolated": isolated}
    given |= {"order": order, "state": state, "seconds": seconds}
    line = made_again(umat, path, [*map(float, props)], None if k is None else k.tolist(), **given)
    return Material(advance, k, first, energies, symbol.rstrip("_"), line, components=components, state=state)


# -- a shared library of a routine that is given as its source ---------------------------------------------------------


_FORTRAN = (".f", ".for", ".ftn", ".f77", ".f90", ".f95", ".f03", ".f08")
_C = (".c", ".cc", ".cpp", ".cxx")
SOURCES = _FORTRAN + _C
_COMPILERS = {"FC": ("gfortran", "ifx", "ifort", "flang"), "CC": ("cc", "gcc", "clang"), "CXX": ("c++", "g++", "clang++")}
_STUBS = Path(__file__).with_name("abaqus_stubs.c")
_PARAMETERS = "      implicit real*8(a-h,o-z)\n      parameter (nprecd=2)\n"
_LINES = 12  # of what a compiler says


def built(path: str | Path) -> Path:
    """The library of a source in Fortran or C; any other file stays as it is.

    Raises InputError where there is no such file, no compiler for it, or one that refuses it, with what it says.
    """
    file = Path(path)
    if file.suffix.lower() not in SOURCES or not file.is_file():
        return file
    return _library(file.resolve(), file.stat().st_mtime_ns)


@cache
def _library(file: Path, _: int) -> Path:
    kind = "FC" if file.suffix.lower() in _FORTRAN else "CC" if file.suffix == ".c" else "CXX"
    names = (named,) if (named := os.environ.get(kind)) else _COMPILERS[kind]
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        what = f"there is no compiler: none of {', '.join(names)} is on the path"
        raise InputError(what, where=str(file), remedy=f"install one, name it in {kind}, or give the compiled library (.so)")
    folder = Path(mkdtemp(prefix="duhem-built-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    for name in ("ABA_PARAM.INC", "aba_param.inc"):  # a folder of its own, as some systems take both for one
        (folder / name).write_text(_PARAMETERS, "utf-8")
    made = folder / f"{file.stem}.so"
    form = ("-cpp", "-std=legacy", "-ffixed-line-length-none", "-ffree-line-length-none") if "gfortran" in Path(found).name else ()
    stubs = str(folder / "stubs.o")  # apart: C has no use for options of Fortran
    whole = ["-shared", f"-I{folder}", *form, str(file), stubs, "-o", str(made), "-lm"]
    for options in (["-c", str(_STUBS), "-o", stubs], whole):
        done = subprocess.run([found, "-O2", "-fPIC", *options], capture_output=True, text=True, errors="replace", check=False)
        if done.returncode != 0:
            said = "\n".join((done.stderr or done.stdout).strip().splitlines()[:_LINES])
            remedy = "mend the source, or give the compiled library"
            raise InputError(f"{Path(found).name} refuses it:\n{said}", where=str(file), remedy=remedy)
    return made
