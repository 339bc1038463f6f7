"""Where the boundary of K turns inward, for every value of the parameters in a domain at once.

A dent is a polynomial of the parameters, or of them and a ray, that is < 0 somewhere exactly where K is not convex there.  In the plane it
is gamma'' + gamma on an arc of the gauge, or the rise of gamma' at a seam (:mod:`plane_gauge`); of a function of the deviator the same in
the sector of ordered principal values (:mod:`deviatoric`), whose walls are seams; of quadratic and of quartic forms a principal
minor (:mod:`semidefinite`).  A law in space has those of a section in the plane too, since sections of a convex K are convex.

Along a straight line on which g falls without bound both ways, and is > 0 between, K has two points and
not all between them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import Any, NamedTuple

from duhem.proof.kernel.bounds import POSITIVE, Facts
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import Reader
from duhem.proof.kernel.deviatoric import WALLS, DeviatoricReader, deviatoric_readers, invariants
from duhem.proof.kernel.domain import NEGATIVE, StatedDomain
from duhem.proof.kernel.forms import Matrix, at, by_forces, place_of, principal_minors, quadratic
from duhem.proof.kernel.normal_form import normal
from duhem.proof.kernel.plane_function import PlaneFunction, Signs, inner
from duhem.proof.kernel.plane_gauge import StarGauge, in_the_plane
from duhem.proof.kernel.polynomial import Monomial, Polynomial, in_powers, negated, replaced, slope, times, total, written
from duhem.proof.kernel.semidefinite import catalecticant, homogeneous_parts, in_coordinates
from duhem.proof.kernel.signs import RAY, Interval, RealRoot, nonnegative
from duhem.proof.kernel.simpler_laws import in_principal_stresses, without_outer_map
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["FAMILIES", "Dent", "dents", "falls_both_ways", "form_of", "summands"]

_ZERO, _HALF, _ONE = Fraction(0), Fraction(1, 2), Fraction(1)
_MOST_ROWS, _MOST_WAYS = 4, 20  # of a minor; along which a form may be > 0
_STEP = Term("name", name="along the line")  # no name of a law has blanks


class Dent(NamedTuple):
    """A ``poly`` of which one value < 0 shows that K is not convex; its variable lies ``between`` two ends.

    A ``seam`` is at one place, told exactly by its ends or between them.
    """

    family: str
    name: str
    poly: Polynomial
    between: Interval
    domain: StatedDomain
    signs: Signs | None = None  # for polynomials with roots in them
    seam: bool = False

    def at(self, place: RealRoot) -> bool:
        """Whether it is < 0 there, over the whole domain."""
        if not (self.between[0] <= place.low and place.high <= self.between[1]):
            return False
        turned = negated(self.poly)
        if self.signs is not None:
            return place.exact and self.signs.above(self.signs.at(turned, place.low), True)
        if self.seam:
            return nonnegative(turned, self.between, self.domain, True)
        if place.exact:
            here = written(replaced(turned, RAY, {(): place.low} if place.low else {}))
            if self.domain.nonnegative(here, strict=True) or self.domain.sign(here) == POSITIVE:
                return True
        return nonnegative(place.reduced(turned), (place.low, place.high), self.domain, True)


def dents(law: StatedLaw, family: str = "") -> Iterator[Dent]:
    """Those of a family, of all without one, that are told of a law: as it is written or in a form with the same K.

    In principal stresses it is a section.  What takes least work comes first.
    """
    forms = list[StatedLaw]()
    for reduce in (lambda law: law, without_outer_map, in_principal_stresses):
        form = law.once(reduce) if forms else law
        if form is None or form in forms:
            continue
        forms.append(form)
        for own, told in FAMILIES.items():
            with suppress(NotWritten):
                yield from told(form) if family in ("", own) else ()
                if own == family == "form":
                    return  # what these do not tell, those of a simpler form do not either


def _of_the_gauge(law: StatedLaw) -> Iterator[Dent]:
    domain = over(law)
    g, forces = _in_two_forces(law, domain)
    gauge = StarGauge(law._replace(g=g, forces=forces))
    for i, (poly, between) in enumerate(gauge.bends()):
        yield Dent("gauge", f"arc {i}", poly, between, domain)
    for i, (poly, between) in enumerate(gauge.jumps()):
        yield Dent("gauge", f"seam {i}", poly, between, domain, seam=True)


def _of_the_deviator(law: StatedLaw) -> Iterator[Dent]:
    """Of {F <= c}, c > 0, which is what K has in a plane of all deviators; of F^(1/k) where F > 0 has the degree k."""
    domain = over(law)
    for i, reader in enumerate(deviatoric_readers(law.g, domain)):
        with suppress(NotWritten):
            value, *others = _deviatoric_parts(law, domain, reader)
            if not (value.degree > 0 and reader.above(value.poly, strict=True)):
                continue
            value = value if value.degree == 1 else reader.root(value)
            if not all(reader.above(inner(w, domain), strict=True) for part in (value, *others) for w in part.roots()):
                continue
            yield Dent("sector", f"sector {i}", reader.bend(value), WALLS, domain, reader.signs)
            for name, wall, rise in zip(("near", "far"), WALLS, reader.at_walls(value), strict=True):
                yield Dent("sector", f"{name} wall {i}", rise, (wall, wall), domain, reader.signs, True)


def _deviatoric_parts(law: StatedLaw, domain: StatedDomain, reader: DeviatoricReader) -> list[PlaneFunction]:
    """What g is but for a constant < 0, where the forces are the tensor of the reader; of principal values, where their sum is 0.

    The diagonal tensors of a trace, or without a third component, have all deviators.  Where g is F and a constant and a multiple of the
    trace, K has sections {F <= c} for every c > 0.  If these are convex, so is {F' <= 1} for the part F' of F of the lowest degree k, since
    F(e s)/e^k goes to F'(s) as e goes to 0.  So F may have parts of several degrees there; the lowest comes first.
    """
    names = [Term("name", name=f) for f in law.forces]
    meanings = [(m.second, m.third) for m in invariants(law.forces)]
    if (told := (reader.second, reader.tensor.invariants.third)) not in meanings:
        raise NotWritten("the forces are another tensor")
    principal = len(names) == 3 and told == meanings[0]
    swap = {names[2]: sum_of(minus(names[0]), minus(names[1]))} if principal else {}
    values, rest = dict[Fraction, list[PlaneFunction]](), list[Term]()
    for part in summands(law.g, reader):
        value = None if domain.constant(part) else reader.value(part)
        if value is not None and value.degree > 0:
            values.setdefault(value.degree, []).append(value)
        else:
            rest.append(part)
    known = _at_no_trace([part.put(swap) for part in rest], domain)
    below = len(values) == 1 and known.sign == NEGATIVE
    if not (values and known.defined and (below or (principal and _moves_with_the_trace(rest, names, domain)))):
        raise NotWritten("g is no function of the deviator less a constant")
    return [reader.added(values[degree]) for degree in sorted(values)]


def summands(term: Term, reader: DeviatoricReader) -> Iterator[Term]:
    """The parts of a sum that is no such function as a whole; of a constant times one, those of this times the constant."""
    moving = [f for f in factors(term) if not reader.domain.constant(f)]
    if len(moving) != 1 or moving[0].op != "+" or reader.value(term) is not None:
        yield term
        return
    scale = [f for f in factors(term) if f is not moving[0]]
    for part in moving[0].args:
        yield from summands(product_of(*scale, part) if scale else part, reader)


def _moves_with_the_trace(rest: list[Term], names: list[Term], domain: StatedDomain) -> bool:
    """Whether a sum is a constant and a multiple, not 0, of the sum of the forces."""
    poly = total(*map(domain.polynomial, rest))
    rates = [slope(poly, x) for x in names]
    affine = all(x in names or domain.constant(x) for m in poly for x, _ in m) and domain.constant(rate := written(rates[0]))
    known = all(domain.facts(part).defined for part in rest)
    return affine and known and rates[0] == rates[1] == rates[2] and domain.facts(rate).sign in (NEGATIVE, POSITIVE)


def _at_no_trace(constants: list[Term], domain: StatedDomain) -> Facts:
    """What is known of a sum whose parts are constants once they are multiplied out."""
    whole = all(domain.facts(part).defined for part in constants)
    if not domain.constant(left := written(total(*map(domain.polynomial, constants)))):
        raise NotWritten("a part is no function of the deviator")
    return domain.facts(left) if whole else replace(domain.facts(left), defined=False)


def _of_the_form(law: StatedLaw) -> Iterator[Dent]:
    """Of a quadratic g, or a quartic form in two forces less a constant > 0: the principal minors of the matrix of its highest form f.

    If f(v) < 0, a line along v has all but a part in K.  So a convex K is a cylinder along v, on whose boundary g = 0, though g falls along
    it: K is everything, and f <= 0.  Where f > 0 somewhere, K is therefore convex only if f >= 0.  Of a quadratic f this is the sign of the
    minors.  A quartic f >= 0 is then the fourth power of the gauge of K, and convex.  It has a positive semidefinite matrix (Reznick 2011):
    f(v) = 0 leaves it c x^4 alone; else it is k (x^4 + 6 l x^2 y^2 + y^4), l >= 1/3, in coordinates in which its two pairs of roots are
    imaginary and reciprocal, its Hessian at (1, 1) has the sign of 1 - l, and l, 1 and 1 - l^2 are the minors of its matrix.

    Of the root of a quadratic form f and an affine part that is < 0 at zero force these are the minors of f.  If f > 0 somewhere and
    f(v) < 0, a line through v has two points where f is 0 on either side of v, where g has no value.  Close to zero force K has such two.
    """
    domain, (g, forces) = over(law), (law.g, law.forces)
    rooted, pointed = _under_a_root(g, domain)
    g = rooted if rooted is not None and pointed else g
    forms = dict[int, dict[Monomial, Polynomial]]()
    with suppress(NotWritten):
        forms = homogeneous_parts(domain.polynomial(g), domain)
    if (degree := max(forms, default=0)) != 2:
        if not all(_is_plain(part, domain) for part in g.parts()):
            raise NotWritten("a part of g is no polynomial")
        g, forces = _in_two_forces(law, domain)
        forms = homogeneous_parts(multiplied_out(g, domain), domain)
        if set(forms) != {0, 4} or domain.facts(written(forms[0][()])).sign != NEGATIVE:
            raise NotWritten("g is no quartic form less a constant")
        degree = 4
    form = written(total(*(times({m: _ONE}, c) for m, c in forms[degree].items())))
    ways = sorted(product((0, 1, -1), repeat=len(forces)), key=lambda way: sum(map(abs, way)))[1:_MOST_WAYS]
    values = (domain.facts(at(form, forces, tuple(map(number, way)))) for way in ways)
    if Reader(domain).undecided(g) is not None or not any(value.sign == POSITIVE for value in values):
        raise NotWritten("a form is not shown to be > 0 somewhere")
    for i, spelled in enumerate(in_coordinates(form, forces)):
        matrix = catalecticant(homogeneous_parts(domain.polynomial(spelled), domain)[degree], degree)
        for rows, minor in principal_minors(matrix, domain, _MOST_ROWS):
            yield Dent("form", f"minor {rows} in coordinates {i}", minor, (_ZERO, _ZERO), domain)


def form_of(law: StatedLaw) -> Matrix:
    """The matrix of the quadratic form in g, or under its root; NotWritten for a g that is not quadratic."""
    domain = over(law)
    return quadratic(_under_a_root(law.g, domain)[0] or law.g, law.forces, domain)[0]


def _under_a_root(g: Term, domain: StatedDomain) -> tuple[Term | None, bool]:
    """f, if g is a multiple of the root of a quadratic form f and an affine part; whether this is < 0 at zero force, or a constant <= 0."""
    with suppress(NotWritten):
        parts = by_forces(domain.polynomial(g), domain)
        roots = [x for m in parts for x, _ in m if x.op == "**" and domain.polynomial(x.args[1]) == {(): _HALF}]
        at_zero, affine = domain.facts(written(parts.get((), {}))).sign, all(m == () or (len(m) == 1 and m[0][1] == 1) for m in parts)
        if len(roots) == 1 and affine and all(x in roots or x.op == "name" for m in parts for x, _ in m):
            small = at_zero == NEGATIVE or (not at_zero & POSITIVE and set(parts) <= {(), ((roots[0], 1),)})
            known, base = Reader(domain).undecided(g.put({roots[0]: number(0)})) is None, roots[0].args[0]
            if set(homogeneous_parts(domain.polynomial(base), domain)) == {2}:
                return base, small and known
    return None, False


def _is_plain(part: Term, domain: StatedDomain) -> bool:
    """Whether a part may be one of a polynomial: constants, powers > 0, and sizes, of which even powers are polynomials."""
    powers = part.op == "**" and domain.facts(part.args[1]).sign == POSITIVE
    return powers or domain.constant(part) or part.op in ("name", "+", "*", "abs", "norm", "pos", "neg")


def _in_two_forces(law: StatedLaw, domain: StatedDomain) -> tuple[Term, tuple[str, str]]:
    """g in the plane; of a law that has none, where all but the first two forces are 0: a section of a convex K is convex."""
    if len(law.forces) < 2:
        raise NotWritten("there are not two forces")
    with suppress(NotWritten):
        return in_the_plane(law, domain)
    first, second, *others = law.forces
    return law.g.put({Term("name", name=f): number(0) for f in others}), (first, second)


FAMILIES: Mapping[str, Callable[[StatedLaw], Iterator[Dent]]] = {"form": _of_the_form, "sector": _of_the_deviator, "gauge": _of_the_gauge}


def multiplied_out(term: Term, domain: StatedDomain) -> Polynomial:
    """The polynomial that a term is where it has a value: what its words become is multiplied out, and words are undone once more."""
    return domain.polynomial(normal(written(domain.polynomial(normal(term, domain))), domain))


# -- by lines ----------------------------------------------------------------------------------------------------------


def falls_both_ways(law: StatedLaw, evidence: Mapping[str, Any]) -> bool:
    """Whether g is > 0 at a point of a line, and a polynomial along it whose highest power is even and has a factor < 0."""
    domain = over(law)
    through, way = (place_of(evidence[key], domain) for key in ("through", "along"))
    place = {x: sum_of(through[x], product_of(_STEP, way[x])) for x in through}
    along = StatedLaw((_STEP.name,), law.pressure, law.g.put(place), None, law.parameters, law.constraints, law.ranges)
    line = over(along)
    if not line.facts(along.g).defined:
        return False
    powers = in_powers(multiplied_out(along.g, line), _STEP)
    if len(powers) % 2 == 0 or any(not line.constant(x) for part in powers for m in part for x, _ in m):
        return False
    top, here = (domain.facts(written(part)) for part in (powers[-1], powers[0]))
    return len(powers) > 1 and top.sign == NEGATIVE and here.sign == POSITIVE
