"""Routines of other languages, as the conformance suite calls them: shared libraries of C and Fortran, UMAT, JAX, MFront."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.projection.result import Array
from duhem.testing.foreign.shared import shared_library, shared_material, umat
from duhem.testing.routines import Material, MaterialState, Step, Update, from_material

__all__ = ["Material", "MaterialState", "from_material", "jax_routine", "mgis_material", "shared_library", "shared_material", "umat"]


# -- packages of Python: a function written in JAX, and a behaviour that MFront has compiled, through MGIS ---------------

_LEAST = 16  # increments of a call


def _demand(package: str, where: str, remedy: str) -> None:
    """Raise InputError unless the package is installed."""
    if find_spec(package) is None:
        raise InputError(f"{package} is not installed", where=where, remedy=remedy)


def jax_routine(step: Callable[..., Any], *, tangent: bool = True) -> Update:
    """A JAX function for one increment, ``step(trial (d,), pressure, stiffness (d, d), **parameters) -> stress (d,)``.

    It is vmapped and jitted in double precision, for a power of two of increments, the last one repeated: JAX compiles anew for each
    number of them; the tangent d sigma/d u = (d sigma/d sigma_tr) k is taken by ``jax.jacfwd`` and
    judged with the rest, unless ``tangent`` is False.  Raises InputError without JAX.
    """
    _demand("jax", "jax_routine", "install it with: pip install jax")
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


def mgis_material(
    path: str | Path,
    behaviour: str,
    stiffness: ArrayLike,
    *,
    hypothesis: str = "Tridimensional",
    properties: Mapping[str, float] | None = None,
    temperature: float = 293.15,
) -> Material:
    """A small-strain behaviour of an MFront library, loaded by the Python module of MGIS (mgis.behaviour).

    Never run: it is written after the documentation of MGIS, which no machine that tests duhem has.  Compare its first stresses with
    those of another program.

    Order of components 11, 22, 33, 12, 13, 23; MGIS' sqrt(2) in the shears is turned into shears of engineers and back.
    ``stiffness`` (d, d) is the elastic one in these components, ``properties`` the material properties by name, ``hypothesis``
    MGIS' modelling hypothesis.  Energies are those that the behaviour computes.  Raises InputError without MGIS, and where the
    library or behaviour is not there.
    """
    remedy = "install MGIS (conda install -c conda-forge mgis, or built with -Denable-python-bindings=ON)"
    _demand("mgis", "mgis_material", remedy)
    import mgis.behaviour as mgis

    if not Path(path).is_file():
        raise InputError("there is no such file", where=str(path), remedy="give the place of the library that mfront has made")
    try:
        known = mgis.load(getattr(mgis.Hypothesis, hypothesis.upper()), str(path), behaviour)
    except (AttributeError, RuntimeError) as fault:
        raise InputError(f"behaviour {behaviour!r} is not loaded: {fault}", where=str(path), remedy="see: mfront-query") from None
    k = np.array(stiffness, dtype=np.float64)
    d = len(k)
    shear = np.where(np.arange(d) < 3, 1.0, np.sqrt(2.0))  # a component of MGIS over the stress of engineers

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        n = len(increment)
        points = mgis.MaterialDataManager(known, n)
        for state in (points.s0, points.s1):
            for name, value in (properties or {}).items():
                mgis.setMaterialProperty(state, name, float(value))
            mgis.setExternalStateVariable(state, "Temperature", temperature)
        points.s0.gradients[:] = before.strain / shear
        points.s1.gradients[:] = (before.strain + increment) / shear
        points.s0.thermodynamic_forces[:] = before.stress * shear
        points.s0.internal_state_variables[:] = before.variables
        points.s0.stored_energies[:] = before.stored
        points.s0.dissipated_energies[:] = before.dissipated
        kind = mgis.IntegrationType.IntegrationWithConsistentTangentOperator
        status = mgis.integrate(points, kind, duration, 0, n)
        end = points.s1
        tangent = np.array(points.K).reshape(n, d, d) / shear[:, None] / shear
        solved = np.full(n, status >= 0)  # it says so of all points together
        variables = np.array(end.internal_state_variables).reshape(n, -1)
        energies = np.array(end.stored_energies), np.array(end.dissipated_energies)
        stress = np.array(end.thermodynamic_forces) / shear
        return MaterialState(before.strain + increment, stress, variables, *energies, None, tangent, solved)

    size: Any = mgis.getArraySize(known.isvs, known.hypothesis)
    return Material(advance, k, np.zeros(size), energies=True, name=behaviour)
