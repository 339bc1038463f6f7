"""A subroutine with the arguments of Abaqus' UMAT, in double precision, as a material.

Abaqus User Subroutines Reference Guide, UMAT: stresses in the order 11, 22, 33, 12, 13, 23 (the first NDI direct ones, then
NSHR shears), tension positive, shear strains those of engineers; DDSDDE = d DSTRESS/d DSTRAN, SSE and SPD increased by the step.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.projection.result import Array
from duhem.testing.foreign.native import SECONDS
from duhem.testing.foreign.shared import loaded, watched
from duhem.testing.routines.material import Material, MaterialState

__all__ = ["rotation", "umat"]

_RETURNED = ("STRESS", "STATEV", "DDSDDE", "SSE", "SPD", "SCD", "RPL", "DDSDDT", "DRPLDE", "DRPLDT")
_GIVEN = (
    "STRAN", "DSTRAN", "TIME", "DTIME", "TEMP", "DTEMP", "PREDEF", "DPRED", "CMNAME", "NDI", "NSHR", "NTENS", "NSTATV", "PROPS",
    "NPROPS", "COORDS", "DROT", "PNEWDT", "CELENT", "DFGRD0", "DFGRD1", "NOEL", "NPT", "LAYER", "KSPT", "JSTEP", "KINC",
)  # fmt: skip
# by reference, then the length of CMNAME by value, which compilers of Fortran pass after them
_NAMES = (*_RETURNED, *_GIVEN, "the length of CMNAME")
_KINDS = "p" * len((*_RETURNED, *_GIVEN)) + "n"
_KEPT = frozenset(_GIVEN) - {"PNEWDT"}
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
    properties: Sequence[float],
    stiffness: ArrayLike,
    *,
    variables: Sequence[float] = (),
    direct: int = 3,
    axes: ArrayLike | None = None,
    energies: bool = True,
    tangent: bool = True,
    name: str = "MATERIAL",
    symbol: str = "umat_",
    isolated: bool = False,
    seconds: float = SECONDS,
) -> Material:
    """The UMAT of a shared library as a material.

    ``properties`` are PROPS, ``variables`` STATEV at the beginning; ``stiffness`` (NTENS, NTENS) the elastic one, which says how
    many components there are: NDI = ``direct``, NSHR the rest.  ``axes``: the material's directions as rows (3, 3), where they are
    not those of the strains: what UMAT is given and returns is then turned, six components alone.  ``energies``, ``tangent``:
    whether it sets SSE and SPD, and DDSDDE.  A PNEWDT below 1 says that the increment is not solved.  The last argument beside
    Abaqus' is the length of CMNAME, as gfortran and ifort pass it.  DFGRD0, DFGRD1 and DROT are the identity (small strains); times
    are in s, the temperature 0, each point an element of its own (NOEL).  ``isolated``, ``seconds`` and
    what it has to leave as it is, as in :func:`shared_library`.

    Raises InputError for a missing file or symbol, and for sizes that do not fit.
    """
    k = np.array(stiffness, dtype=np.float64)
    native = loaded(path, symbol, _KINDS, isolated, seconds)
    size = len(k) if k.ndim == 2 else 0
    if not 1 <= direct <= size:
        raise InputError(f"{direct} direct stresses among {size}", where="umat", remedy="give a stiffness (NTENS, NTENS), NDI <= NTENS")
    if axes is not None and size != 6:
        raise InputError(f"material axes with {size} components", where="umat", remedy="turn the properties, or use six components")
    turn = np.eye(size) if axes is None else rotation(axes)
    back = np.linalg.inv(turn)
    material_name = np.frombuffer(name.ljust(80)[:80].encode("ascii", "replace"), dtype=np.uint8)

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        n = len(increment)

        def rows(given: Any, kept: Any = np.double) -> NDArray[Any]:
            flat = np.asarray(given, dtype=kept).ravel()
            column = np.empty((n, flat.size), dtype=kept)
            column[:] = flat
            return column

        def integer(value: int) -> NDArray[Any]:
            return rows([value], np.intc)

        def strain(x: Array) -> Array:
            return np.ascontiguousarray(x @ back)  # T^-T x

        stress = np.ascontiguousarray(before.stress @ turn.T)
        state = np.array(before.variables, dtype=np.double, order="C")
        slopes = np.full((n, size, size), np.nan)
        sse = np.zeros((n, 1)) if before.stored is None else before.stored[:, None].copy()
        spd = np.zeros((n, 1)) if before.dissipated is None else before.dissipated[:, None].copy()
        smaller = rows([1.0])
        scalar, ones = rows([0.0]), np.eye(3)
        columns = [
            stress, state, slopes, sse, spd, scalar.copy(), scalar.copy(), rows(np.zeros(size)), rows(np.zeros(size)), scalar.copy(),
            strain(before.strain), strain(increment), rows([0.0, 0.0]), rows([duration]), scalar.copy(), scalar.copy(), scalar.copy(),
            scalar.copy(), np.tile(material_name, (n, 1)), integer(direct), integer(size - direct), integer(size),
            integer(len(variables)), rows([*properties]), integer(len(properties)), rows(np.zeros(3)), rows(ones), smaller,
            rows([1.0]), rows(ones), rows(ones), np.arange(1, n + 1, dtype=np.intc)[:, None], integer(1), integer(1), integer(1),
            rows([1, 1, 0, 0], np.intc), integer(1), np.full(n, 80, dtype=np.uintp),
        ]  # fmt: skip
        _, spoilt = watched(native, columns, n, _NAMES, _KEPT, n)
        found = np.swapaxes(slopes, 1, 2)  # Fortran keeps columns together
        return MaterialState(
            before.strain + increment,
            stress @ back.T,
            state,
            sse[:, 0] if energies else None,
            spd[:, 0] if energies else None,
            None,
            back @ found @ back.T if tangent else None,
            ~(smaller[:, 0] < 1.0),
            spoilt,
        )

    given = {"variables": tuple(variables), "axes": None if axes is None else np.asarray(axes).tolist(), "isolated": isolated}
    given |= {"direct": direct, "energies": energies, "tangent": tangent, "name": name, "symbol": symbol}
    given |= {} if seconds == SECONDS else {"seconds": seconds}
    where = str(Path(path).resolve())
    said = ", ".join([repr(where), repr(list(properties)), repr(k.tolist()), *(f"{key}={value!r}" for key, value in given.items())])
    line = f"from duhem.testing.foreign import umat\nupdate = umat({said})"
    return Material(advance, k, tuple(variables), energies, symbol.rstrip("_"), line)
