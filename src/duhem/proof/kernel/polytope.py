"""Whether a formula is the support function of K, for K = {l_j . x <= r_j for all j} with numbers l_j and r_j, each up to a unit.

A bounded polyhedron is the hull of its vertices, and a linear form is greatest at one of them (Rockafellar 1970, Corollary
32.3.4).  A vertex lies on as many independent faces as there are dimensions; a polyhedron that has a vertex and is unbounded
has a direction that never leaves it along which all but one of as many independent forms vanish.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations, product
from math import comb, prod

from duhem.proof.kernel.curvature import facts
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.forms import affine
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["supports_polytope"]

_MOST_ARMS, _MOST_CORNERS = 64, 5000
Vector = Sequence[Fraction]
Faces = Sequence[tuple[Vector, Fraction]]


def supports_polytope(
    g: Term, potential: Term, forces: Sequence[str], slips: Sequence[str], flat: Sequence[Term], domain: StatedDomain
) -> bool:
    """Whether ``potential`` = sup {sigma . d : g <= 0} where the forms ``flat`` in the slips vanish, and it is infinite elsewhere."""
    if not all(facts(term, domain).defined for term in (g, potential)) or len(flat) > 1:
        return False
    faces, corners = (
        [affine(arm, forces, domain) for arm in _arms(g, domain)],
        [affine(arm, slips, domain) for arm in _arms(potential, domain)],
    )
    lines = [affine(form, slips, domain) for form in flat]
    if any(domain.polynomial(offset) for _, offset in (*corners, *lines)):
        return False
    steep, far = _unit([c for row, _ in faces for c in row], domain), _unit([offset for _, offset in faces], domain)
    sides = [(_measured(row, steep, domain), -_measured([offset], far, domain)[0]) for row, offset in faces]
    ends = [_measured([product_of(c, steep) for c in row], far, domain) for row, _ in corners]
    for line in (_measured(row, number(1), domain) for row, _ in lines):  # K is cut by the plane that the slips span
        if not any(line) or any(_dot(row, line) for row, _ in sides):
            return False
        sides += [(line, Fraction(0)), ([-v for v in line], Fraction(0))]
        ends = [[v - _dot(end, line) / _dot(line, line) * w for v, w in zip(end, line, strict=True)] for end in ends]
    return _is_hull(sides, ends, len(forces))


def _arms(term: Term, domain: StatedDomain) -> list[Term]:
    """Terms whose greatest is ``term``."""
    zero = number(0)
    match term.op:
        case _ if domain.constant(term):
            return [term]
        case "max":
            return [arm for a in term.args for arm in _arms(a, domain)]
        case "abs" | "pos" | "neg":
            x = term.args[0]
            return [zero if term.op == "neg" else x, zero if term.op == "pos" else minus(x)]
        case "*":
            moving, still = ([f for f in factors(term) if domain.constant(f) is c] for c in (False, True))
            scale = product_of(*still)
            if len(moving) == 1 and not facts(scale, domain).sign & NEGATIVE:
                return [product_of(scale, arm) for arm in _arms(moving[0], domain)]
        case "+":
            choices = [_arms(a, domain) for a in term.args]
            if prod(map(len, choices)) > _MOST_ARMS:
                raise NotWritten("there are too many faces")
            return [sum_of(*choice) for choice in product(*choices)]
    return [term]


def _unit(terms: Sequence[Term], domain: StatedDomain) -> Term:
    """The size of the first that is not 0."""
    first = next((t for t in terms if domain.polynomial(t)), number(0))
    sign = facts(first, domain).sign
    if sign not in (NEGATIVE, POSITIVE):
        raise NotWritten("a unit has no one sign")
    return first if sign == POSITIVE else minus(first)


def _measured(terms: Sequence[Term], unit: Term, domain: StatedDomain) -> list[Fraction]:
    """The terms as numbers of units."""
    one, found = domain.polynomial(unit), list[Fraction]()
    for poly in map(domain.polynomial, terms):
        share = next(iter(poly.values()), Fraction(0)) / one.get(next(iter(poly), ()), Fraction(1))
        if {m: share * c for m, c in one.items() if share} != poly:
            raise NotWritten("a number has another unit")
        found.append(share)
    return found


def _is_hull(faces: Faces, points: Sequence[Vector], n: int) -> bool:
    """Whether {x : l . x <= r for each face (l, r)} is the hull of the points."""
    if comb(len(faces), n) > _MOST_CORNERS or not all(_within(point, faces) for point in points):
        return False
    for chosen in combinations(faces, n - 1):
        free, _ = _solved([(row, Fraction(0)) for row, _ in chosen], n)
        if len(free) == 1 and not {-1, 1} <= {(slope > 0) - (slope < 0) for slope in (_dot(row, free[0]) for row, _ in faces)}:
            return False
    corners = [point for free, point in (_solved(chosen, n) for chosen in combinations(faces, n)) if not free and point is not None]
    kept = [corner for corner in corners if _within(corner, faces)]
    return bool(kept) and all(corner in points for corner in kept)


def _within(point: Vector, faces: Faces) -> bool:
    return all(_dot(row, point) <= limit for row, limit in faces)


def _dot(one: Vector, two: Vector) -> Fraction:
    return sum((a * b for a, b in zip(one, two, strict=True)), Fraction(0))


def _solved(equations: Faces, n: int) -> tuple[list[list[Fraction]], list[Fraction] | None]:
    """Directions along which every solution may be moved, and one solution if there is any, by elimination."""
    left, done = [[*row, limit] for row, limit in equations], dict[int, list[Fraction]]()
    for column in range(n):
        pivot = next((row for row in left if row[column]), None)
        if pivot is None:
            continue
        left = [_cleared(row, pivot, column) for row in left if row is not pivot]
        done = {k: _cleared(row, pivot, column) for k, row in done.items()}
        done[column] = [v / pivot[column] for v in pivot]
    loose = [k for k in range(n) if k not in done]
    free = [[Fraction(i == k) - (done[i][k] if i in done else 0) for i in range(n)] for k in loose]
    return free, None if any(row[n] for row in left) else [done[i][n] if i in done else Fraction(0) for i in range(n)]


def _cleared(row: list[Fraction], pivot: list[Fraction], column: int) -> list[Fraction]:
    return [v - row[column] / pivot[column] * w for v, w in zip(row, pivot, strict=True)]
