"""Piecewise affine formulas, and polyhedra {x : l . x <= r for each face (l, r)} in fractions.

A piecewise affine formula is the least of some greatest of affine ones, their coefficients numbers of a unit.

A corner lies on as many independent faces as there are dimensions.  A polyhedron with so many independent faces holds no line;
if it is unbounded, some direction never leaves it along which all but one of as many independent forms vanish.  A bounded one is
the hull of its corners (R. T. Rockafellar 1970, Convex Analysis, section 18), and a linear form is
greatest at one of them (corollary 32.3.4).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations, product
from math import comb, prod

from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.forms import affine
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["polyhedra", "supports_polytope", "union_is_convex"]

_MOST_ARMS, _MOST_CHOICES, _MOST_CELLS = 100, 5000, 100
Vector = tuple[Fraction, ...]
Face = tuple[Vector, Fraction]


def polyhedra(g: Term, forces: Sequence[str], domain: StatedDomain) -> tuple[list[list[Face]], Term, Term]:
    """The polyhedra whose union is {g <= 0}, at forces in units of r/l, and these units: r of the limits, l of the slopes."""
    cells = [[affine(arm, forces, domain) for arm in cell] for cell in least_of_greatest(g, domain)]
    steep = _unit([c for cell in cells for row, _ in cell for c in row], domain)
    far = _unit([offset for cell in cells for _, offset in cell], domain)

    def face(row: Sequence[Term], offset: Term) -> Face:
        (limit,) = measured([minus(offset)], far, domain)
        return measured(row, steep, domain), limit

    return [[face(*arm) for arm in cell] for cell in cells], far, steep


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
            if len(moving) == 1 and not domain.facts(scale := product_of(*still)).sign & NEGATIVE:
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
    sign = domain.facts(first).sign
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


def corners(faces: Sequence[Face], n: int) -> list[Vector]:
    """The corners, each once."""
    solutions = (solved(chosen, n) for chosen in _chosen(faces, n))
    return list(dict.fromkeys(point for free, point in solutions if not free and point is not None and within(point, faces)))


def is_bounded(faces: Sequence[Face], n: int) -> bool:
    """Whether it is, and holds no line even if it is empty."""
    if all(solved(chosen, n)[0] for chosen in _chosen(faces, n)):
        return False
    for chosen in _chosen([(row, Fraction(0)) for row, _ in faces], n - 1):
        free, _ = solved(chosen, n)
        if len(free) == 1 and not {-1, 1} <= {(rise > 0) - (rise < 0) for rise in (dot(row, free[0]) for row, _ in faces)}:
            return False
    return True


def union_is_convex(parts: Sequence[Sequence[Face]], n: int) -> bool:
    """Whether it is the polyhedron of all those faces that no part goes beyond.

    A point of that one outside of every part would be strictly beyond a face of each: the mean of the corners of what is beyond
    or on these faces would be such a point, or there is none.
    """
    reached = [corner for part in parts for corner in corners(part, n)]
    outer = [face for face in dict.fromkeys(face for part in parts for face in part) if all(within(corner, [face]) for corner in reached)]
    inner = [[face for face in part if face not in outer] for part in parts]
    if not all(is_bounded(part, n) for part in (*parts, outer)) or prod(map(len, inner)) > _MOST_CELLS:
        return False
    for chosen in product(*inner):
        ends = corners([*outer, *((tuple(-v for v in row), -limit) for row, limit in chosen)], n)
        if ends and not any(all(dot(row, end) == limit for end in ends) for row, limit in chosen):
            return False
    return True


def within(point: Vector, faces: Sequence[Face]) -> bool:
    """Whether a point lies in it."""
    return all(dot(row, point) <= limit for row, limit in faces)


def dot(one: Vector, two: Vector) -> Fraction:
    """one . two."""
    return sum((a * b for a, b in zip(one, two, strict=True)), Fraction(0))


def _chosen(faces: Sequence[Face], n: int) -> Iterator[tuple[Face, ...]]:
    if comb(len(faces), n) > _MOST_CHOICES:
        raise NotWritten("there are too many faces")
    return combinations(faces, n)


def solved(equations: Sequence[Face], n: int) -> tuple[list[Vector], Vector | None]:
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
    free: list[Vector] = [tuple(Fraction(i == k) - (done[i][k] if i in done else 0) for i in range(n)) for k in loose]
    return free, None if any(row[n] for row in left) else tuple(done[i][n] if i in done else Fraction(0) for i in range(n))


def _cleared(row: list[Fraction], pivot: list[Fraction], column: int) -> list[Fraction]:
    return [v - row[column] / pivot[column] * w for v, w in zip(row, pivot, strict=True)]


def supports_polytope(
    g: Term, potential: Term, forces: Sequence[str], slips: Sequence[str], flat: Sequence[Term], domain: StatedDomain
) -> bool:
    """Whether ``potential`` = sup {sigma . d : g <= 0} where the forms ``flat`` in the slips vanish, and it is infinite elsewhere."""
    if len(flat) > 1:
        return False
    (faces,), far, steep = polyhedra(g, forces, domain)
    (greatest,) = least_of_greatest(potential, domain)  # ValueError where some are to be the least of
    ends, lines = ([affine(arm, slips, domain) for arm in arms] for arms in (greatest, flat))
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
