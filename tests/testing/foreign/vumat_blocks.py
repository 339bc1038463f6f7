"""An example of an adapter: a VUMAT, which takes blocks of points and strains of the tensor, as a material."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from duhem.testing import Material, MaterialState

Array = np.ndarray
COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")
_SHEARS = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # strains of engineers over those of the tensor


def vumat(library: Path, props: Sequence[float], states: int, density: float = 1.0) -> Material:
    """``states`` variables, 0 at first; arrays are (points, components) with the points of a component together, as Fortran has them."""
    routine = ctypes.CDLL(str(library)).vumat_

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        n = len(increment)

        def block(*shape: int, of: float = 0.0) -> Array:
            return np.full(shape, of, order="F")

        counts = [np.array([count], dtype=np.intc) for count in (n, 3, 3, states, 0, len(props), 0)]
        times = [np.array([0.0]), np.array([0.0]), np.array([duration]), np.frombuffer(b"MATERIAL".ljust(80), dtype=np.uint8)]
        own = [block(n, 3), block(n, of=1.0), np.array(props, dtype=np.float64), block(n, of=density)]
        old = [np.asfortranarray(increment / _SHEARS), block(n, 3), block(n), block(n, 6), block(n, 9), block(n, 1)]
        kept = [np.asfortranarray(part) for part in (before.stress, before.variables)]
        kept += [block(n), block(n)]  # energies, which are not looked at
        new = [block(n), block(n, 6), block(n, 9), block(n, 1), block(n, 6), block(n, states), block(n), block(n)]
        routine(*(part.ctypes.data_as(ctypes.c_void_p) for part in (*counts, *times, *own, *old, *kept, *new)))
        stress, variables = (np.ascontiguousarray(part) for part in new[4:6])
        return MaterialState(before.strain + increment, stress, variables)

    return Material(advance, None, np.zeros(states), name="vumat", components=COMPONENTS)
