"""Whether a formula is the support function of K, for a polyhedron K.

A bounded polyhedron is the hull of its corners, and a linear form is greatest at one of them (Rockafellar 1970, Corollary 32.3.4).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from duhem.proof.kernel.curvature import facts
from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.forms import affine
from duhem.proof.kernel.piecewise import greatest_of, measured, polyhedra
from duhem.proof.kernel.polyhedron import corners, dot, is_bounded, within
from duhem.proof.kernel.term import Term, number, product_of

__all__ = ["supports_polytope"]


def supports_polytope(
    g: Term, potential: Term, forces: Sequence[str], slips: Sequence[str], flat: Sequence[Term], domain: StatedDomain
) -> bool:
    """Whether ``potential`` = sup {sigma . d : g <= 0} where the forms ``flat`` in the slips vanish, and it is infinite elsewhere."""
    if not all(facts(term, domain).defined for term in (g, potential)) or len(flat) > 1:
        return False
    (faces,), far, steep = polyhedra(g, forces, domain)
    ends, lines = ([affine(arm, slips, domain) for arm in arms] for arms in (greatest_of(potential, domain), flat))
    if any(domain.polynomial(offset) for _, offset in (*ends, *lines)):
        return False
    points = [measured([product_of(c, steep) for c in row], far, domain) for row, _ in ends]
    for line in (measured(row, number(1), domain) for row, _ in lines):  # K is cut by the plane that the slips span
        if not any(line) or any(dot(row, line) for row, _ in faces):
            return False
        faces += [(line, Fraction(0)), (tuple(-v for v in line), Fraction(0))]
        points = [tuple(v - dot(point, line) / dot(line, line) * w for v, w in zip(point, line, strict=True)) for point in points]
    n = len(forces)
    return is_bounded(faces, n) and all(within(point, faces) for point in points) and set() < set(corners(faces, n)) <= set(points)
