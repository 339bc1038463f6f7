"""From one formula to its thermodynamics: state laws, normality, dissipation, potential, increment, one dimension."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from duhem.derivation.closest_point import increment_equations, interval, one_dimensional_equations
from duhem.derivation.energy import state_equations
from duhem.derivation.equation import Derivation, Equation
from duhem.derivation.evolution import evolution_equations, potential_equations
from duhem.derivation.koiter import slips
from duhem.derivation.notation import Names
from duhem.derivation.pieces import MOST, pieces
from duhem.derivation.support_function import fixed, support_function
from duhem.errors import InputError
from duhem.law.catalogue import load, load_formula
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.formula_law import Criterion
from duhem.left_out import LeftOut

__all__ = ["derive"]


def derive(law: Law | str | Path, parameters: Mapping[str, Any] | None = None, stiffness: str = "orthotropic") -> Derivation:
    """Everything that follows symbolically from the law's formula (Antoni et al. 2007, section 2, Eqs. 1 and 21-36).

    ``law`` is a criterion, or what :func:`duhem.load` finds by a name or path.
    ``parameters`` fixes some of them; ``stiffness`` is ``orthotropic`` (one k per force), ``isotropic`` (one k) or
    ``full`` (any symmetric positive definite matrix), in stress per length.  sigma_n <= 0 in compression.  What has no
    closed form is left out and listed with its reason.  Raises InputError for an unknown law,
    parameter or stiffness.  A law given by a boundary curve has the derivation it names, for all parameters, or none.
    """
    chosen = load(law)
    if isinstance(chosen, ParametricCriterion) and chosen.derivation:
        if parameters:
            raise InputError("this derivation is for all parameters", where="parameters", remedy="leave them out")
        own: Derivation = chosen.derive()
        return own
    stated = fixed(load_formula(chosen), parameters)
    names = Names.of(stated, stiffness)
    left_out: list[LeftOut] = []
    return Derivation(stated.name, tuple(_equations(stated, names, left_out)), tuple(left_out), names)


def _equations(law: Criterion, names: Names, left_out: list[LeftOut]) -> Iterator[Equation]:
    left_out.append(
        LeftOut("thermal block: T_C, s_C, heat fluxes and D_th of Eq. (23)", "isothermal law, no equation contains a temperature")
    )
    left_out.append(LeftOut("further internal variables chi_3 ... chi_n of Eq. (24)", "the law has none"))
    yield from state_equations(names)
    found = pieces(law)
    if found is None:
        left_out.append(LeftOut("normal and criterion by branches", f"the formula has more than {MOST} branches"))
    yield from evolution_equations(names, found)
    if not law.associated:
        left_out.append(LeftOut("dissipation potential", "the law has a flow of its own, which no potential of K gives"))
        if law.flow is None and slips(law) is None:
            left_out.append(LeftOut("flow by surfaces", f"a surface has more than {MOST} branches"))
    elif (support := support_function(law)) is None:
        left_out.append(LeftOut("dissipation potential", "K has no support function in closed form by the polar rules"))
    else:
        yield from potential_equations(names, support)
    yield from increment_equations(names, found)
    yield from one_dimensional_equations(names)
    for force in names.forces:
        if interval(law, force) is None:
            left_out.append(LeftOut(f"reduction to {force} alone", "K on that line is unbounded or has no closed form"))
