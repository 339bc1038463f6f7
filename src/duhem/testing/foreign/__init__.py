"""Routines of other languages, as the conformance suite calls them: shared libraries of C and Fortran, UMAT, JAX, MFront."""

from duhem.testing.foreign.abaqus import umat
from duhem.testing.foreign.packages import jax_routine, mgis_material
from duhem.testing.foreign.shared import shared_library, shared_material
from duhem.testing.routines.material import Material, MaterialState, from_material

__all__ = ["Material", "MaterialState", "from_material", "jax_routine", "mgis_material", "shared_library", "shared_material", "umat"]
