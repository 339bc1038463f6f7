"""A behaviour that MFront has compiled, through MGIS, as a material: written after MGIS' documentation, and never run."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.projection.result import Array
from duhem.testing.routines.material import Material, MaterialState

__all__ = ["mgis_material"]


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
    if find_spec("mgis") is None:
        remedy = "install MGIS (conda install -c conda-forge mgis, or built with -Denable-python-bindings=ON)"
        raise InputError("mgis is not installed", where="mgis_material", remedy=remedy)
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
