"""Piecewise affine formulas: the least of some greatest of affine ones, their coefficients numbers of a unit."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import product
from math import prod

from duhem.proof.kernel.curvature import facts
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.forms import affine
from duhem.proof.kernel.polyhedron import Face, Vector
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["greatest_of", "least_of_greatest", "measured", "polyhedra"]

_MOST_ARMS = 100


def polyhedra(g: Term, forces: Sequence[str], domain: StatedDomain) -> tuple[list[list[Face]], Term, Term]:
    """The polyhedra whose union is {g <= 0}, at forces in units of r/l, and these units: r of the limits, l of the slopes."""
    cells = [[affine(arm, forces, domain) for arm in cell] for cell in least_of_greatest(g, domain)]
    steep = _unit([c for cell in cells for row, _ in cell for c in row], domain)
    far = _unit([offset for cell in cells for _, offset in cell], domain)

    def face(row: Sequence[Term], offset: Term) -> Face:
        (limit,) = measured([minus(offset)], far, domain)
        return measured(row, steep, domain), limit

    return [[face(*arm) for arm in cell] for cell in cells], far, steep


def greatest_of(term: Term, domain: StatedDomain) -> list[Term]:
    """Terms whose greatest is ``term``."""
    (arms,) = least_of_greatest(term, domain)  # ValueError where some are to be the least of
    return arms


def least_of_greatest(term: Term, domain: StatedDomain) -> list[list[Term]]:
    """Lists of terms; the least of their greatest is ``term``."""
    if domain.constant(term):
        return [[term]]
    x, zero = term.args[0] if term.args else term, number(0)
    match term.op:
        case "abs" | "pos" | "neg":
            return [[zero if term.op == "neg" else x, zero if term.op == "pos" else minus(x)]]
        case "min":
            return [cell for a in term.args for cell in least_of_greatest(a, domain)]
        case "*":
            moving, still = ([f for f in factors(term) if domain.constant(f) is c] for c in (False, True))
            if len(moving) == 1 and not facts(scale := product_of(*still), domain).sign & NEGATIVE:
                return [[product_of(scale, arm) for arm in cell] for cell in least_of_greatest(moving[0], domain)]
        case "max" | "+":
            parts = [least_of_greatest(a, domain) for a in term.args]
            widths = [max(map(len, cells)) for cells in parts]
            if prod(map(len, parts)) * (sum(widths) if term.op == "max" else prod(widths)) > _MOST_ARMS:
                raise NotWritten("there are too many faces")
            if term.op == "max":
                return [[arm for cell in choice for arm in cell] for choice in product(*parts)]
            return [[sum_of(*arms) for arms in product(*choice)] for choice in product(*parts)]
    return [[term]]


def _unit(terms: Sequence[Term], domain: StatedDomain) -> Term:
    """The size of the first that is not 0."""
    first = next((t for t in terms if domain.polynomial(t)), number(0))
    sign = facts(first, domain).sign
    if sign not in (NEGATIVE, POSITIVE):
        raise NotWritten("a unit has no one sign")
    return first if sign == POSITIVE else minus(first)


def measured(terms: Sequence[Term], unit: Term, domain: StatedDomain) -> Vector:
    """The terms as numbers of units."""
    one, found = domain.polynomial(unit), list[Fraction]()
    for poly in map(domain.polynomial, terms):
        share = next(iter(poly.values()), Fraction(0)) / one.get(next(iter(poly), ()), Fraction(1))
        if {m: share * c for m, c in one.items() if share} != poly:
            raise NotWritten("a number has another unit")
        found.append(share)
    return tuple(found)
