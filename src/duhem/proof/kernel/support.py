"""Whether a formula is the support function of K: for gauges put together from functions of one form each, for ellipsoids, for polyhedra.

A positively homogeneous function of one force is h(x) = a pos(x) + b neg(x) with a = h(1), b = h(-1); for a, b > 0 it is a gauge
and pos(d)/a + neg(d)/b its polar.  The p-norm of gauges of separate variables has as polar the q-norm of their polars,
1/p + 1/q = 1, the greatest being p infinite; {gauge <= R} has R times the polar as its support function, and moved by c
it has c . d more (Rockafellar 1970, sections 13 and 15).  The variables are linear forms l of the forces, and m of the slips, with
l_i . m_j = 0 for i != j: then x . d is the sum of (l_i . x)(m_i . d)/(l_i . m_i), and both sets of forms are independent.

A quadratic K = {x . A x + b . x + c <= 0} is {y . A y <= R} about its centre, R > 0, A positive semidefinite.  By Cauchy-Schwarz the
greatest of y . d, d = A z, is sqrt(R z . A z); it is infinite for other d.  So it is sqrt(d . B d) with any B for which A B A = R A
(Rockafellar 1970, section 12), and B A/R projects on the range of A: the trace of A B is R times the rank of A.

A piecewise affine formula is the least of some greatest of affine ones, their coefficients numbers of a unit; polyhedra
{x : l . x <= r for each face (l, r)} are in fractions.  A corner lies on as many independent faces as there are dimensions.  A polyhedron
with so many independent faces holds no line; if it is unbounded, some direction never leaves it along which all but one of as many
independent forms vanish.  A bounded one is the hull of its corners (the same, section 18), and a linear form is greatest at one of them
(corollary 32.3.4).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations, product
from math import comb, prod

from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.forms import Row, affine, apart, at, degree_at_most, determinant, quadratic
from duhem.proof.kernel.homogeneity import by_degree
from duhem.proof.kernel.identity import in_order, multiplied_out, value, vanishes
from duhem.proof.kernel.polynomial import Monomial, solved, written
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["is_support_function", "polyhedra", "union_is_convex"]

# -- polyhedra ---------------------------------------------------------------------------------------------------------

_MOST_ARMS, _MOST_CHOICES, _MOST_CELLS = 100, 5000, 100
Vector = tuple[Fraction, ...]
Face = tuple[Vector, Fraction]
_Names = Sequence[str]


def polyhedra(g: Term, forces: _Names, domain: StatedDomain) -> tuple[list[list[Face]], Term, Term]:
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
    points = (_common_point(chosen, n) for chosen in _chosen(faces, n))
    return list(dict.fromkeys(point for point in points if point is not None and within(point, faces)))


def is_bounded(faces: Sequence[Face], n: int) -> bool:
    """Whether it is, and holds no line even if it is empty."""
    if all(_common_point(chosen, n) is None for chosen in _chosen(faces, n)):
        return False
    units: list[Face] = [(tuple(Fraction(i == k) for i in range(n)), Fraction(1)) for k in range(n)]
    for chosen in _chosen([(row, Fraction(0)) for row, _ in faces], n - 1):
        way = next((found for unit in units if (found := _common_point([*chosen, unit], n)) is not None), None)  # on which they vanish
        if way is not None and not {-1, 1} <= {(rise > 0) - (rise < 0) for rise in (dot(row, way) for row, _ in faces)}:
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


def _common_point(faces: Sequence[Face], n: int) -> Vector | None:
    """The one point that lies on all of the faces; None where there is none, or more than one."""
    found = solved((dict(enumerate(row)), {(): limit} if limit else {}) for row, limit in faces)
    return None if found is None or len(found) < n else tuple(found[i].get((), Fraction(0)) for i in range(n))


def supports_polytope(g: Term, potential: Term, forces: _Names, slips: _Names, flat: Sequence[Term], domain: StatedDomain) -> bool:
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


# -- support functions -------------------------------------------------------------------------------------------------

_TWO = number(2)


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
    domain = over(law).wider(*slips)  # in which the slips are no constants either
    if not all(domain.facts(term).defined for term in (law.g, potential, *flat)):
        return False
    for shape in (_supports_separable, _supports_quadric, supports_polytope):
        try:
            if shape(law.g, potential, law.forces, slips, flat, domain):
                return True
        except (NotWritten, ValueError):
            continue
    return False


def _supports_separable(g: Term, potential: Term, forces: _Names, slips: _Names, flat: Sequence[Term], domain: StatedDomain) -> bool:
    if flat:
        return False
    gauge, other, radius = _about_its_centre(g, potential, forces, slips, domain)
    gauge, rows = _in_forms(gauge, forces, "form", domain)
    other, columns = _in_forms(other, slips, "dual form", domain)
    if not len(rows) == len(columns) == len(forces):
        return False
    dual = dict[str, str]()
    for x, row in rows.items():
        products = {y: sum_of(*map(product_of, row, column)) for y, column in columns.items()}
        (y,) = (y for y, scale in products.items() if not vanishes(scale, domain))  # ValueError unless there is one
        if domain.facts(products[y]).sign not in (NEGATIVE, POSITIVE):
            return False
        other = at(other, [y], [product_of(products[y], Term("name", name=y))])
        dual[x] = y
    wide = domain.wider(*rows, *columns)
    return len(set(dual.values())) == len(dual) and _polar(gauge, other, radius, dual, wide)


def _about_its_centre(g: Term, potential: Term, forces: _Names, slips: _Names, domain: StatedDomain) -> tuple[Term, Term, Term]:
    """(gauge, other, radius): {g <= 0} is {gauge <= radius} moved by c, the potential c . d and the other term."""
    straight, other = _parted(potential, lambda t: _is_affine(t, slips, domain))
    centre, offset = affine(straight, slips, domain)
    still, gauge = _parted(at(g, forces, [sum_of(Term("name", name=f), c) for f, c in zip(forces, centre, strict=True)]), domain.constant)
    radius = minus(still)
    if not set(forces) <= gauge.names() or domain.facts(radius).sign != POSITIVE or not vanishes(offset, domain):
        raise NotWritten("g is no gauge and radius")
    gauge, radius = _with_root(gauge, radius, domain)
    return gauge, other, radius


def _in_forms(term: Term, names: _Names, kind: str, domain: StatedDomain) -> tuple[Term, dict[str, Row]]:
    """A term in its linear forms, each under a name, and their rows; multiples by a number are one form."""
    forms, swap = dict[frozenset[tuple[Monomial, Fraction]], tuple[str, Row]](), dict[Term, Term]()
    for part in _linear_parts(term, names, domain):
        poly = domain.polynomial(part)
        first = poly[min(poly)]
        key = frozenset((m, c / first) for m, c in poly.items())
        row = affine(product_of(number(1 / first), part), names, domain)[0]
        name, _ = forms.setdefault(key, (f"{kind} {len(forms)}", row))  # no name of a law has blanks
        swap[part] = product_of(number(first), Term("name", name=name))
    return term.put(swap), dict(forms.values())


def _linear_parts(term: Term, names: _Names, domain: StatedDomain) -> Iterator[Term]:
    """The largest parts that are linear in the names."""
    if domain.constant(term):
        return
    if _is_affine(term, names, domain) and vanishes(affine(term, names, domain)[1], domain):
        yield term
    else:
        for a in term.args:
            yield from _linear_parts(a, names, domain)


def _with_root(gauge: Term, radius: Term, domain: StatedDomain) -> tuple[Term, Term]:
    """{sum of c_i f_i^p <= R} as {(sum of (c_i^(1/p) f_i)^p)^(1/p) <= R^(1/p)}; anything else as it is."""
    split = [[[f for f in factors(a) if domain.constant(f) is c] for c in (False, True)] for a in gauge.args]
    if gauge.op != "+" or any([f.op for f in moving] != ["**"] for moving, _ in split):
        return gauge, radius
    p = split[0][0][0].args[1]
    if domain.facts(p).sign != POSITIVE or not all(vanishes(sum_of(x.args[1], minus(p)), domain) for (x,), _ in split):
        return gauge, radius
    out = Term("**", (p, number(-1)))
    parts = (product_of(_raised(product_of(*still), out, domain), x.args[0]) for (x,), still in split)
    return Term("**", (Term("+", tuple(Term("**", (part, p)) for part in parts)), out)), _raised(radius, out, domain)


def _raised(term: Term, power: Term, domain: StatedDomain) -> Term:
    """A constant > 0 to a power, factor by factor where each is > 0."""
    poly = domain.polynomial(term)
    parts = [number(c) for c in poly.values() if c != 1] + [Term("**", (x, number(n))) for m in poly for x, n in m]
    if len(poly) != 1 or not all(domain.facts(part).sign == POSITIVE for part in parts):
        parts = [term]
    return product_of(*(Term("**", (part, power)) for part in parts))


def _parted(term: Term, where: Callable[[Term], bool]) -> tuple[Term, Term]:
    """The sum of the terms of which something holds, and the sum of the others."""
    yes, no = ([t for t in (term.args if term.op == "+" else (term,)) if where(t) is c] for c in (True, False))
    return sum_of(*yes), no[0] if len(no) == 1 else Term("+", tuple(no))


def _polar(gauge: Term, other: Term, radius: Term, dual: Mapping[str, str], domain: StatedDomain) -> bool:
    """Whether ``other`` (d) = sup {x . d : gauge(x) <= radius}, in the forces that occur."""
    forces = [f for f in dual if f in gauge.names()]
    if not forces or {dual[f] for f in forces} != other.names() & set(dual.values()):
        return False
    if len(forces) == 1:
        return _polar_of_one(gauge, other, radius, forces[0], dual[forces[0]], domain)
    for one, two in ((gauge, other), (other, gauge)):
        if one.op == "*":
            inner, scale = _unscaled(one, domain)
            left = product_of(radius, Term("**", (scale, number(-1))))
            return _polar(*((inner, two) if one is gauge else (two, inner)), left, dual, domain)
    (p, parts), (q, others) = _norm(gauge, domain), _norm(other, domain)
    if any(domain.facts(x).sign & NEGATIVE for x in (p, q)) or not vanishes(sum_of(p, q, number(-1)), domain):
        return False
    sets = [part.names() & set(dual) for part in parts]
    if len(parts) != len(others) or sum(map(len, sets)) != len(forces):
        return False
    return all(any(_polar(part, partner, radius, dual, domain) for partner in others) for part in parts)


def _polar_of_one(gauge: Term, other: Term, radius: Term, force: str, slip: str, domain: StatedDomain) -> bool:
    if not all(list(by_degree(part, domain)) == [number(1)] for part in (gauge, other)):
        return False
    for way in (number(1), number(-1)):
        weight, width = at(gauge, [force], [way]), at(other, [slip], [way])
        gap = sum_of(product_of(weight, width), minus(radius))  # their constants may be written in different orders
        if domain.facts(weight).sign != POSITIVE or not (vanishes(gap, domain) or vanishes(in_order(gap, domain), domain)):
            return False
    return True


def _norm(term: Term, domain: StatedDomain) -> tuple[Term, list[Term]]:
    """(1/p, parts) of a p-norm of parts that are >= 0."""
    if term.op == "norm":
        return number(Fraction(1, 2)), [_size(a, domain) for a in term.args]
    if term.op == "max":
        return number(0), list(term.args)
    if term.op == "+":
        groups: dict[frozenset[str], list[Term]] = {}
        for a in term.args:
            if domain.polynomial(a):
                groups.setdefault(a.names() & set(domain.law.forces), []).append(a)
        return number(1), [parts[0] if len(parts) == 1 else Term("+", tuple(parts)) for parts in groups.values()]
    if term.op == "**":
        (base, out), parts = term.args, list[Term]()
        for a in base.args if base.op == "+" else (base,):
            if a.op != "**" or not vanishes(sum_of(product_of(a.args[1], out), number(-1)), domain):
                raise NotWritten("a root is no norm")
            p = value(a.args[1], domain)
            parts.append(_size(a.args[0], domain) if p is not None and p % 2 == 0 else a.args[0])
        return out, parts
    raise NotWritten(f"{term.op} is no norm")


def _size(term: Term, domain: StatedDomain) -> Term:
    return term if domain.facts(term).nonnegative else Term("abs", (term,))


def _unscaled(term: Term, domain: StatedDomain) -> tuple[Term, Term]:
    """The one factor that is no constant, and the product of the others, > 0."""
    scale, moving = apart(term, domain)
    if len(moving) != 1 or domain.facts(scale).sign != POSITIVE:
        raise NotWritten("a product is no multiple of a gauge")
    return moving[0], scale


def _is_affine(term: Term, names: _Names, domain: StatedDomain) -> bool:
    """Whether it is written as sums and products, and affine in the names."""
    return degree_at_most(term, domain) in (0, 1) and term.names() & {*domain.law.forces} <= {*names}


def _supports_quadric(g: Term, potential: Term, forces: _Names, slips: _Names, flat: Sequence[Term], domain: StatedDomain) -> bool:
    q = _without_root(g, domain)
    a, b, _ = quadratic(q, forces, domain)
    terms = potential.args if potential.op == "+" else (potential,)
    squares = [(t, _square(t, domain)) for t in terms]
    roots = [square for _, square in squares if square is not None]
    straight = sum_of(*(t for t, square in squares if square is None))
    centre, offset = affine(straight, slips, domain)
    if len(roots) != 1 or not domain.facts(straight).defined:
        return False
    inverse, slant, level = quadratic(roots[0], slips, domain)
    size = multiplied_out(minus(at(q, forces, centre)), domain)
    n, rank = range(len(forces)), len(forces) - len(flat)
    zeros = [offset, level, *slant]
    zeros += [sum_of(b[i], *(product_of(_TWO, a[i][j], centre[j]) for j in n)) for i in n]
    projected = [[multiplied_out(sum_of(*(product_of(a[i][k], inverse[k][j]) for k in n)), domain) for j in n] for i in n]
    zeros += [sum_of(*(product_of(projected[i][k], a[k][j]) for k in n), minus(product_of(size, a[i][j]))) for i in n for j in n]
    zeros.append(sum_of(*(projected[i][i] for i in n), product_of(number(-rank), size)))
    rows = [affine(form, slips, domain) for form in flat]
    zeros += [constant for _, constant in rows]
    zeros += [sum_of(*map(product_of, a[i], row)) for row, _ in rows for i in n]
    gram = written(determinant([[sum_of(*map(product_of, one, two)) for two, _ in rows] for one, _ in rows], domain))
    return all(vanishes(zero, domain) for zero in zeros) and _positive(size, domain) and _positive(gram, domain) and domain.facts(q).convex


def _without_root(g: Term, domain: StatedDomain) -> Term:
    """A formula that is <= 0 where g is, without the root of g = root - radius."""
    moving, still = ([t for t in (g.args if g.op == "+" else (g,)) if domain.constant(t) is c] for c in (False, True))
    square, radius = _square(moving[0], domain) if len(moving) == 1 else None, minus(sum_of(*still))
    if square is None or domain.facts(radius).sign & NEGATIVE:
        return g
    return sum_of(square, minus(Term("**", (radius, _TWO))))


def _square(term: Term, domain: StatedDomain) -> Term | None:
    """The square of a norm or root times constants, where that is >= 0."""
    scale, moving = apart(term, domain)
    known = domain.facts(scale)
    if len(moving) != 1 or not known.defined or known.sign & NEGATIVE:
        return None
    (x,) = moving
    if x.op in ("norm", "abs"):
        inner = [Term("**", (a, _TWO)) for a in x.args]
    elif x.op == "**" and value(x.args[1], domain) == Fraction(1, 2):
        inner = [x.args[0]]
    else:
        return None
    if not all(domain.facts(part).defined for part in inner):
        return None
    return sum_of(*(product_of(Term("**", (scale, _TWO)), part) for part in inner))


def _positive(term: Term, domain: StatedDomain) -> bool:
    return domain.facts(term).defined and domain.facts(term).sign == POSITIVE
