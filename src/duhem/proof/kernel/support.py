"""Whether a formula is the support function of K: by separate variables, for ellipsoids, for polyhedra."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from duhem.proof.kernel.curvature import facts, over
from duhem.proof.kernel.domain import StatedLaw
from duhem.proof.kernel.polytope import supports_polytope
from duhem.proof.kernel.quadric import supports_quadric
from duhem.proof.kernel.separable import supports_separable, supports_separable_in_forms
from duhem.proof.kernel.term import NotWritten, Term

__all__ = ["is_support_function"]


def is_support_function(potential: Term, dual: Mapping[str, str], flat: Sequence[Term], law: StatedLaw) -> bool:
    """Whether ``potential`` = sup {sigma . d : g <= 0} for every slip d on which the forms ``flat`` vanish, and that is infinite elsewhere.

    ``dual`` names the slip of each force.
    """
    slips = [dual[force] for force in law.forces]
    taken = {*law.forces, *law.parameters, law.pressure, "pi"}
    if len(dual) != len(slips) or len(set(slips)) != len(slips) or taken & set(slips):
        return False
    if not all(term.names() <= {*slips, *law.parameters, law.pressure, "pi"} for term in (potential, *flat)):
        return False
    domain = over(law._replace(forces=(*law.forces, *slips)))  # in which the slips are no constants either
    if not all(facts(form, domain).defined for form in flat):
        return False
    for shape in (supports_separable, supports_quadric, supports_polytope, supports_separable_in_forms):
        try:
            if shape(law.g, potential, law.forces, slips, flat, domain):
                return True
        except (NotWritten, ValueError):
            continue
    return False
