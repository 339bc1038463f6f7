"""A function written in JAX as an update routine: mapped over the increments, its tangent by forward differentiation."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

import numpy as np

from duhem.errors import InputError
from duhem.projection.result import Array
from duhem.testing.routines.routine import Step, Update

__all__ = ["jax_routine"]

_LEAST = 16  # increments of a call


def jax_routine(step: Callable[..., Any], *, tangent: bool = True) -> Update:
    """A JAX function for one increment, ``step(trial (d,), pressure, stiffness (d, d), **parameters) -> stress (d,)``.

    It is vmapped and jitted in double precision, for a power of two of increments, the last one repeated: JAX compiles anew for each
    number of them; the tangent d sigma/d u = (d sigma/d sigma_tr) k is taken by ``jax.jacfwd`` and
    judged with the rest, unless ``tangent`` is False.  Raises InputError without JAX.
    """
    if find_spec("jax") is None:
        raise InputError("jax is not installed", where="jax_routine", remedy="install it with: pip install jax")
    import jax

    def one(trial: Any, pressure: Any, stiffness: Any, values: dict[str, Any]) -> Any:
        stress = step(trial, pressure, stiffness, **values)
        return stress, stress

    def both(*given: Any) -> Any:
        slope, stress = jax.jacfwd(one, has_aux=True)(*given)
        return stress, slope @ given[2]

    made, without = (jax.jit(jax.vmap(both if tangent else one, in_axes=(0, axis, None, None))) for axis in (0, None))  # or no pressure

    def update(trial: Array, pressure: Array | None, stiffness: Array, **parameters: float) -> Step:
        n = len(trial)
        rows = np.minimum(np.arange(max(_LEAST, 1 << (n - 1).bit_length())), n - 1)
        with jax.enable_x64(True) if hasattr(jax, "enable_x64") else jax.experimental.enable_x64():
            function, loads = (without, None) if pressure is None else (made, pressure[rows])
            stress, slope = function(trial[rows], loads, stiffness, parameters)
            return Step(np.asarray(stress)[:n], tangent=np.asarray(slope)[:n] if tangent else None)

    update.__name__ = getattr(step, "__name__", "update")
    return update
