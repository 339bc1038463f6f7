"""Whether a formula is the support function of K, for a polyhedron K = {x : l . x <= r for each face (l, r)}, in fractions.

A formula that is the greatest of affine ones bounds a polyhedron, its coefficients being numbers of a unit.  A corner lies on as many
independent faces as there are dimensions.  A polyhedron with so many independent faces holds no line; if it is unbounded, some direction
never leaves it along which all but one of as many independent forms vanish.  A bounded one is the hull of its corners (R. T. Rockafellar
1970, Convex Analysis, section 18), and a linear form is greatest at one of them (corollary 32.3.4).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations, product
from math import comb, prod

from duhem.proof.kernel.curvature import facts
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.forms import affine
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = [
    "Face",
    "Vector",
    "corners",
    "dot",
    "greatest_of",
    "is_bounded",
    "measured",
    "polyhedron",
    "supports_polytope",
    "within",
]

_MOST_ARMS, _MOST_CHOICES = 100, 5000
Vector = tuple[Fraction, ...]
Face = tuple[Vector, Fraction]


def polyhedron(g: Term, forces: Sequence[str], domain: StatedDomain) -> tuple[list[Face], Term, Term]:
    """The polyhedron {g <= 0}, at forces in units of r/l, and these units: r of the limits, l of the slopes."""
    arms = [affine(arm, forces, domain) for arm in greatest_of(g, domain)]
    steep, far = _unit([c for row, _ in arms for c in row], domain), _unit([offset for _, offset in arms], domain)
    return [(measured(row, steep, domain), measured([minus(offset)], far, domain)[0]) for row, offset in arms], far, steep


def greatest_of(term: Term, domain: StatedDomain) -> list[Term]:
    """Terms whose greatest is ``term``."""
    if domain.constant(term):
        return [term]
    x, zero = term.args[0] if term.args else term, number(0)
    match term.op:
        case "abs" | "pos" | "neg":
            return [zero if term.op == "neg" else x, zero if term.op == "pos" else minus(x)]
        case "max":
            return [arm for a in term.args for arm in greatest_of(a, domain)]
        case "*":
            moving, still = ([f for f in factors(term) if domain.constant(f) is c] for c in (False, True))
            if len(moving) == 1 and not facts(scale := product_of(*still), domain).sign & NEGATIVE:
                return [product_of(scale, arm) for arm in greatest_of(moving[0], domain)]
        case "+":
            parts = [greatest_of(a, domain) for a in term.args]
            if prod(map(len, parts)) > _MOST_ARMS:
                raise NotWritten("there are too many faces")
            return [sum_of(*arms) for arms in product(*parts)]
    return [term]


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


def corners(faces: Sequence[Face], n: int) -> list[Vector]:
    """The corners, each once."""
    found = list[Vector]()
    for chosen in _chosen(faces, n):
        free, point = _solved(chosen, n)
        if not free and point is not None and point not in found and within(point, faces):
            found.append(point)
    return found


def is_bounded(faces: Sequence[Face], n: int) -> bool:
    """Whether it is, and holds no line even if it is empty."""
    if all(_solved(chosen, n)[0] for chosen in _chosen(faces, n)):
        return False
    for chosen in _chosen([(row, Fraction(0)) for row, _ in faces], n - 1):
        free, _ = _solved(chosen, n)
        if len(free) == 1 and not {-1, 1} <= {(rise > 0) - (rise < 0) for rise in (dot(row, free[0]) for row, _ in faces)}:
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


def _solved(equations: Sequence[Face], n: int) -> tuple[list[Vector], Vector | None]:
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
    faces, far, steep = polyhedron(g, forces, domain)
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
