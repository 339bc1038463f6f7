"""A subroutine with the arguments of Abaqus' UMAT, in double precision, as a material.

Abaqus User Subroutines Reference Guide, UMAT: stresses in the order 11, 22, 33, 12, 13, 23 (the first NDI direct ones, then
NSHR shears), tension positive, shear strains those of engineers; DDSDDE = d DSTRESS/d DSTRAN, SSE and SPD increased by the step.

A source is compiled to a shared library once a process, with stubs of what Abaqus offers a UMAT.
"""

from __future__ import annotations

import atexit
import os
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.projection.result import Array
from duhem.testing.foreign.shared import loaded, made_again, watched
from duhem.testing.routines import Material, MaterialState

__all__ = ["SOURCES", "built", "rotation", "umat"]

_RETURNED = ("STRESS", "STATEV", "DDSDDE", "SSE", "SPD", "SCD", "RPL", "DDSDDT", "DRPLDE", "DRPLDT")
_GIVEN = (
    "STRAN", "DSTRAN", "TIME", "DTIME", "TEMP", "DTEMP", "PREDEF", "DPRED", "CMNAME", "NDI", "NSHR", "NTENS", "NSTATV", "PROPS",
    "NPROPS", "COORDS", "DROT", "PNEWDT", "CELENT", "DFGRD0", "DFGRD1", "NOEL", "NPT", "LAYER", "KSPT", "JSTEP", "KINC",
)  # fmt: skip
# by reference, then the length of CMNAME by value, which compilers of Fortran pass after them
_NAMES = (*_RETURNED, *_GIVEN, "the length of CMNAME")
_KINDS = "p" * len((*_RETURNED, *_GIVEN)) + "n"
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
