"""Answers from the degrees of a formula in the forces: what is of degree k becomes r^k times itself at r times the forces, r > 0.

:func:`by_degree` splits a formula into its parts G_k.  The other functions answer yes or no, each for one argument below; they leave
the signs of the sums to the domain.  False, or NotWritten, means only that this argument does not apply.

What a word makes of parts of degree 0 is of degree 0, unless it chooses between them.

With G_k the part of degree k, d g(r sigma)/dr at r = 1 is the sum of k G_k (Euler), where log y is of degree 0 but adds k, the degree of
y, times what it is multiplied by.  Less m g it is S, the sum of (k - m) G_k, which is the same where g = 0.  Where S is >= 0 everywhere,
for one m, g(r sigma)/r^m does not fall: K holds of each ray what is below its end.  So it is star-shaped about 0, (1 - e) sigma is in it
with sigma, and sigma . n >= 0 for every normal n and every limit of such.  Where S > 0, or grad g tends to 0 nowhere on g = 0, g
rises outward on its zeros.  The power of a flow that is the gradient of a potential is such a sum too, and so is its limit where
gradients meet.  Where all of g is of one degree, g keeps its sign along each ray: K is a cone, and sigma . n = 0 for every normal n at
sigma, as it is where a choice of formulas changes that each ray keeps.

Where a part of g has no degree, as s tan(a + b exp(-s)), S is sigma . grad g - m g by the derivatives of g.  These have a value around
every place, and g is continuous: so S tells along almost every ray, and in the limit along the others, whether g(r sigma)/r^m falls.

Of rays on which g has no value, those where something of one degree is 0, nothing is asked: whether K holds them, as it does where g has a
limit, or ends beside them, with a normal across the ray, it tends there to what is star-shaped.

A flow of the law's own whose power is a constant times g and something >= 0 has power >= 0 wherever g = 0.  Where a tip of g is 0, as at
the apex of a cone, g has a cone of normals, and the formula of a flow like the gradient of a potential no value; see
:mod:`definedness`.  The power of a mean of its limits from around is >= 0 too, g being continuous.

Of a law in two forces, g = f - c with f of degree 1 and c > 0 may have one formula in each of a fan of cones.  Such an f is convex where it
is so within each cone and, from one cone to the next, does not jump and its slope across their common ray does not fall; then so is
K = {f <= c}.  Where the slopes are equal f is C^1, and sigma . grad f = f = c > 0 on the boundary.  The rays have directions that are
numbers, with roots perhaps, so that what is asked on them is the sign of a number.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple

from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.definedness import Reader, undecided_beside
from duhem.proof.kernel.dents import summands
from duhem.proof.kernel.deviatoric import deviatoric_readers
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain, gap
from duhem.proof.kernel.forms import affine, by_forces
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.identity import in_order, signs_as_sizes, vanishes, written_in_order
from duhem.proof.kernel.normal_form import normal
from duhem.proof.kernel.pieces import CHOICES, choice, chooses, pieces
from duhem.proof.kernel.polynomial import Monomial, Polynomial, in_powers, joined, negated, times, total, written
from duhem.proof.kernel.regularity import tips
from duhem.proof.kernel.semidefinite import only_at_zero_force
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, minus, number, product_of, sum_of

__all__ = [
    "Fan", "by_degree", "falls_from_zero", "flows_with_a_share_of_g", "grows_along_rays", "is_a_graph", "is_cone",
    "potential_flows_outward", "rises_from_zero_force",
]  # fmt: skip

_JUMPING = ("where", "atan2")
_LONGEST = 500  # parts of a gradient that is multiplied out
_ALIKE = ("abs", "pos", "neg", "norm", "max", "min", "eigmax")


def grows_along_rays(g: Term, domain: StatedDomain, steep: bool) -> bool:
    """Whether d g(r sigma)/dr >= 0 at r = 1 wherever g = 0, and grad g != 0 if ``steep``; of a choice that no ray changes, each value's."""
    if (kink := choice(g, domain)) is not None and kink.op == "where" and kink.args[0].op in COMPARISONS:
        values = [g.put({kink: value}) for value in kink.args[1:]]
        return len(by_degree(gap(kink.args[0]), domain)) == 1 and all(grows_along_rays(value, domain, steep) for value in values)
    try:
        sums = _rates(g, domain)[1]
    except (NotWritten, ValueError):  # a part has no degree
        sums = _by_gradient(g, domain)
    for x in sorted(sums, key=Term.size):  # the plain ones first
        sign = Reader(domain).sign(x) & domain.facts(written(domain.without_quotients(domain.polynomial(x)))).sign
        if sign == POSITIVE or not (sign & NEGATIVE or (steep and not _is_steep(g, domain))):
            return True
    return False


def _by_gradient(g: Term, domain: StatedDomain) -> list[Term]:
    """S for m = 0 and 1, where a part of g has no degree: sigma . grad g - m g, by derivatives that have a value but at tips of g."""
    slopes = gradient(g, domain.law.forces)
    if sum(d.size() for d in slopes) > _LONGEST or chooses(g, domain) or undecided_beside(slopes, tips(g, domain), domain) is not None:
        raise NotWritten("g may jump, or have no slope, or one that is too long")
    rate = sum_of(*(product_of(Term("name", name=x), d) for x, d in zip(domain.law.forces, slopes, strict=True)))
    sums = (sum_of(rate, minus(product_of(number(m), g))) for m in range(2))
    return [in_order(signs_as_sizes(x, domain), domain) for x in sums]


def _rates(g: Term, domain: StatedDomain) -> tuple[dict[Term, Term], list[Term]]:
    """The parts of g by their degrees, and S for each of these degrees as m."""
    poly = domain.polynomial(g)
    logs = {x: _degree_of_all(x.args, domain) for m in poly for x, _ in m if x.op == "log" and not domain.constant(x)}
    more = [product_of(logs[x], written({joined(m, ((x, -1),)): c * n})) for m, c in poly.items() for x, n in m if x in logs]
    parts = by_degree(g, domain, logs)
    without = [{k: written_in_order(domain.polynomial(sum_of(k, minus(m)))) for k in parts if k != m} for m in parts]
    return parts, [sum_of(*more, *(product_of(c, parts[k]) for k, c in rates.items())) for rates in without]


def rises_from_zero_force(g: Term, domain: StatedDomain) -> bool:
    """Whether grad g != 0 wherever g = 0, g being C^1: S is > 0 but at zero force, where one part of g is linear and not 0, and the others
    are of degrees above 1.  Where J2 = 0 g and S are what they are by continuity.
    """
    parts, sums = _rates(g, domain)
    linear = by_forces(domain.polynomial(parts.get(number(1), number(0))), domain)
    if any(domain.facts(sum_of(k, number(-1))).sign != POSITIVE for k in parts if k != number(1)):
        return False
    if any(x.op != "name" for m in linear for x, _ in m) or all(domain.facts(written(c)).sign & ZERO for c in linear.values()):
        return False
    return any(_only_at_zero_force(x, domain) for x in sums)


def _only_at_zero_force(term: Term, domain: StatedDomain) -> bool:
    """Whether a term is > 0 but at zero force: its functions of a deviator are so where J2 > 0, and no other part is < 0; what it is where
    J2 = 0 makes with J2 a definite form.
    """
    for reader in deviatoric_readers(term, domain):
        parts, there = [*summands(term, reader)], reader.emptied(term)
        signs = [reader.sign(x) for x in parts if reader.value(x) is not None]
        rest = sum_of(*(x for x in parts if reader.value(x) is None))
        if POSITIVE in signs and not any(sign & NEGATIVE for sign in (*signs, Reader(domain).sign(rest))):
            return Reader(domain).undecided(there) is None and only_at_zero_force(sum_of(written(reader.second), there), domain)
    return False


def _is_steep(g: Term, domain: StatedDomain) -> bool:
    """Whether no limit of grad g is 0 where g = 0: g is h + c z, z a force, or convex and somewhere < 0 (they are subgradients)."""
    law = domain.law._replace(g=g)
    return is_a_graph(law) or (over(law).facts(g).convex and falls_from_zero(law))


def falls_from_zero(law: StatedLaw) -> bool:
    """Whether g is a polynomial that is < 0 somewhere on an axis: g(0) <= 0 with a slope along it, or g = a x^2 + b x + c, b^2 > 4 a c."""
    domain = over(law)
    g = domain.polynomial(law.g)
    if not domain.facts(law.g).defined or any(not domain.constant(x) and (x.op != "name" or n < 0) for m in g for x, n in m):
        return False

    def falls(x: Term) -> bool:
        along = in_powers({m: k for m, k in g.items() if all(y == x or domain.constant(y) for y, _ in m)}, x)
        c, b, a = (*along, Polynomial(), Polynomial())[:3]
        discriminant = total(times(b, b), times({(): Fraction(-4)}, times(a, c)))
        here, rise, apart = (domain.facts(written(f)).sign for f in (c, b, discriminant))
        return (not here & POSITIVE and not rise & ZERO) or (len(along) <= 3 and apart == POSITIVE)

    return any(falls(Term("name", name=x)) for x in law.forces)


def is_a_graph(law: StatedLaw) -> bool:
    """Whether g = h + c z, c never 0, with a force z that is not in h: grad g is never 0."""
    domain = over(law)
    g = by_forces(domain.polynomial(law.g), domain)
    lone = [f for f in law.forces if not domain.facts(written(g.get(((Term("name", name=f), 1),), {}))).sign & ZERO]
    return any(sum(f in x.names() for m in g for x, _ in m) == 1 for f in lone)


def is_cone(g: Term, domain: StatedDomain) -> bool:
    """Whether g keeps its sign along each ray from 0, every part of a maximum being of one degree."""
    if g.op in ("max", "min"):
        return all(is_cone(part, domain) for part in g.args)
    try:
        return len(by_degree(g, domain)) == 1
    except (NotWritten, ValueError):
        return False


def potential_flows_outward(potential: Term, g: Term, share: Term, domain: StatedDomain) -> bool:
    """Whether sigma . d >= 0 wherever g = 0, d a mean of gradients of the potential around: it is ``share`` g + something >= 0.

    What does not jump is continuous, so that the boundary of K lies on g = 0 and the sum is a limit of itself.
    """
    if not all(domain.facts(part).defined for part in (potential, g, share)) or not domain.constant(share) or chooses(g, domain):
        return False
    power = sum_of(*(product_of(written({m: c}), _rate(m, domain)) for m, c in domain.polynomial(potential).items()))
    rest = sum_of(power, minus(product_of(share, g)))
    return domain.nonnegative(rest) or domain.facts(normal(rest, domain)).nonnegative


def flows_with_a_share_of_g(law: StatedLaw, share: Term, rest: Term, scale: Term) -> bool:
    """Whether ``scale`` sigma . d = ``share`` g + ``rest`` with constant scale and share, scale > 0 and rest >= 0, d having a value but
    where a tip of g is 0.  Where the scale may be 0, sigma . d is >= 0 by itself.
    """
    domain = within_ranges(law)
    if law.flow is None or not (domain.constant(share) and domain.constant(scale) and domain.facts(rest).nonnegative):
        return False
    spent = (*law.flow, *([law.power] if law.power else []))
    if undecided_beside(spent, tips(law.g, domain), domain) is not None or chooses(law.g, domain):
        return False
    power = law.power or sum_of(*(product_of(Term("name", name=x), d) for x, d in zip(law.forces, law.flow, strict=True)))
    gap = sum_of(product_of(scale, power), minus(product_of(share, law.g)), minus(rest))
    same = vanishes(in_order(signs_as_sizes(gap, domain), domain), domain)
    known = domain.facts(scale)
    if not (same and known.nonnegative and all(domain.facts(part).defined for part in (law.g, share, rest, scale))):
        return False
    return known.sign == POSITIVE or _never_negative_where_zero(power, scale, law)


def _never_negative_where_zero(power: Term, scale: Term, law: StatedLaw) -> bool:
    """Whether a power is >= 0 for the parameters at which a scale >= 0 is 0."""
    try:
        left = within_ranges(law._replace(constraints=(*law.constraints, Term("<=", (scale, number(0))))))
    except NotWritten:  # the scale is never 0, or more than that is too long
        return False
    return left.never_negative(in_order(power, left))


def by_degree(term: Term, domain: StatedDomain, free: Collection[Term] = ()) -> dict[Term, Term]:
    """The parts of each degree, a constant, as they stand in a sum, else multiplied out; NotWritten where something in it has no degree,
    and is not ``free``: of degree 0.
    """
    parts: dict[Term, Polynomial] = {}
    for m, c in domain.polynomial(term).items():
        parts.setdefault(written_in_order(domain.polynomial(_rate(m, domain, free))), {})[m] = c
    found = {k: written(part) for k, part in parts.items()}
    for k, part in parts.items():
        own = [a for a in term.args if domain.polynomial(a).keys() <= part.keys()] if term.op == "+" else [term]
        rest = total(part, negated(domain.polynomial(sum_of(*own))))
        found[k] = found[k] if domain.constant(found[k]) else sum_of(*own, *([written(rest)] if rest else []))
    return found


def _rate(m: Monomial, domain: StatedDomain, free: Collection[Term] = ()) -> Term:
    """The degree of a product, in which powers may have any constant exponents; what is ``free`` counts as of degree 0."""
    return sum_of(*(product_of(number(n), _degree(x, domain)) for x, n in m if x not in free))


def _degree(x: Term, domain: StatedDomain) -> Term:
    if domain.constant(x):
        return number(0)
    if x.op == "name":
        return number(1)
    if x.op == "**" and domain.constant(x.args[1]):
        return product_of(x.args[1], _degree_of_all(x.args[:1], domain))
    if x.op in _ALIKE:
        return _degree_of_all(x.args, domain)
    if x.op not in _JUMPING and all(set(by_degree(a, domain)) <= {number(0)} for a in x.args):
        return number(0)
    raise NotWritten(f"{x.op} has no degree in the forces")


def _degree_of_all(terms: tuple[Term, ...], domain: StatedDomain) -> Term:
    (k,) = {k for term in terms for k in by_degree(term, domain)}  # ValueError unless there is one
    return k


# -- formulas in a fan of cones ----------------------------------------------------------------------------------------

_MOST_PIECES = 64
Ray = tuple[Term, Term]  # a direction, by two numbers


class _FanPart(NamedTuple):
    """Where ``f`` is g: between two ``rays``, on which some of ``sides`` are 0; inside all are > 0."""

    f: Term
    sides: tuple[Term, ...]
    rays: tuple[Ray, ...]


class Fan:
    """The fan of a law; NotWritten for a law that is not shown to have one."""

    def __init__(self, law: StatedLaw) -> None:
        self._domain = over(law)
        if len(law.forces) != 2:
            raise NotWritten("the law is none of two forces")
        self._forces = tuple(Term("name", name=x) for x in law.forces)
        self._cones, thin, constants = list[_FanPart](), list[tuple[Term, Ray]](), list[Polynomial]()
        for count, (f, sides) in enumerate(pieces(law.g, self._domain, CHOICES)):
            if count == _MOST_PIECES:
                raise NotWritten("there are too many cones")
            if not sides:
                raise NotWritten("nothing bounds a cone")  # it is the plane
            rays, wide = self._rays(sides)
            if wide:
                self._cones.append(_FanPart(f, sides, rays))
            else:
                thin += [(f, ray) for ray in rays]
            parts = by_degree(f, self._domain)
            if {*parts} != {number(0), number(1)} or self._domain.facts(parts[number(0)]).sign != NEGATIVE:
                raise NotWritten("a part of g is not of degree 1 less a constant")
            constants.append(self._domain.polynomial(parts[number(0)]))
        if not self._cones or any(c != d for c, d in pairwise(constants)) or not all(map(self._defined, self._cones)):
            raise NotWritten("the constant is not the same everywhere, or a part of g may be undefined")
        self._seams = list(self._found_seams())
        if not all(self._meet(one.f, two.f, ray) for one, two, ray, _ in self._seams):
            raise NotWritten("f may jump")
        if not all(any(self._alike(ray, at) and self._meet(f, one.f, at) for one, _, at, _ in self._seams) for f, ray in thin):
            raise NotWritten("f may be something else on a ray")

    def convex(self) -> bool:
        """Within each cone, and from one to the next."""
        return all(self._inside(s).facts(s.f).convex for s in self._cones) and not any(jump & NEGATIVE for jump in self._jumps())

    def smooth(self) -> bool:
        """Within each cone, and from one to the next."""
        return all(self._differentiable(s) for s in self._cones) and all(jump == ZERO for jump in self._jumps())

    def _jumps(self) -> Iterator[Sign]:
        """By how much the slope across each ray rises from one cone to the next; a formula may have a kink there that it does not name."""
        for before, after, ray, way in self._seams:
            here, beyond = ([self._at(slope, ray) for slope in self._slopes(cone)] for cone in (before, after))
            if not all(self._domain.facts(slope).defined for slope in (*here, *beyond)):
                raise NotWritten("a slope may be undefined on a ray")
            rise = sum_of(*(product_of(w, sum_of(b, minus(a))) for w, a, b in zip(way, here, beyond, strict=True)))
            yield ZERO if before.f == after.f else self._domain.facts(rise).sign

    def _found_seams(self) -> Iterator[tuple[_FanPart, _FanPart, Ray, Ray]]:
        """Two cones to each ray, the ray, and a way across it from the first to the second."""
        for before in self._cones:
            for ray in before.rays:
                others = [s for s in self._cones if s is not before and any(self._alike(ray, other) for other in s.rays)]
                ways = [w for w in ((minus(ray[1]), ray[0]), (ray[1], minus(ray[0]))) if self._leads(before, ray, w)]
                if len(others) != 1 or len(ways) != 1 or self._leads(others[0], ray, ways[0]):
                    raise NotWritten("cones overlap, or leave something out")
                yield before, others[0], ray, ways[0]

    def _meet(self, one: Term, two: Term, ray: Ray) -> bool:
        """Whether two formulas have one value on a ray."""
        both = self._at(sum_of(one, minus(two)), ray)
        return self._domain.facts(both).defined and self._domain.facts(both).sign == ZERO

    def _leads(self, before: _FanPart, ray: Ray, way: Ray) -> bool:
        """Whether the way leads out of a cone across a ray of its own."""
        return any(self._sign_at(side, ray) == ZERO and self._sign_at(side, way) == NEGATIVE for side in before.sides)

    def _slopes(self, cone: _FanPart) -> tuple[Term, ...]:
        return gradient(cone.f, [x.name for x in self._forces])

    def _differentiable(self, cone: _FanPart) -> bool:
        return all(self._inside(cone).facts(slope).defined for slope in self._slopes(cone))

    def _defined(self, cone: _FanPart) -> bool:
        """Inside the cone and on its rays, where it then is continuous."""
        on_rays = (self._domain.facts(self._at(cone.f, ray)).defined for ray in cone.rays)
        return self._inside(cone).facts(cone.f).defined and all(on_rays)

    def _inside(self, cone: _FanPart) -> StatedDomain:
        return self._domain.where(dict.fromkeys(cone.sides, True))

    def _rays(self, sides: Sequence[Term]) -> tuple[tuple[Ray, ...], bool]:
        """The rays that bound what the sides leave, and whether that is wider than these."""
        normals, found = [self._normal(side) for side in sides], list[Ray]()
        for a, b in normals:
            for ray in ((b, minus(a)), (minus(b), a)):
                signs = [self._sign_at(side, ray) for side in sides]
                if any(sign not in (NEGATIVE, ZERO, POSITIVE) for sign in signs):
                    raise NotWritten("it is open on which side a ray is")
                if NEGATIVE not in signs and not any(self._alike(ray, other) for other in found):
                    found.append(ray)
        if len(found) < 2:
            return tuple(found), False
        (p, q), (r, s) = found  # of a half-plane its normal lies inside, of a narrower cone the sum of its rays
        inner = [*normals, (sum_of(p, r), sum_of(q, s))]
        return tuple(found), any(all(self._sign_at(side, way) == POSITIVE for side in sides) for way in inner)

    def _normal(self, side: Term) -> Ray:
        """a and b of a x + b y."""
        (a, b), rest = affine(side, [x.name for x in self._forces], self._domain)
        if self._domain.polynomial(rest) or all(self._domain.facts(x).sign == ZERO for x in (a, b)):
            raise NotWritten("what bounds a cone is not linear, or 0")
        return a, b

    def _alike(self, one: Ray, two: Ray) -> bool:
        turn = sum_of(product_of(one[0], two[1]), minus(product_of(one[1], two[0])))
        along = sum_of(product_of(one[0], two[0]), product_of(one[1], two[1]))
        return self._domain.facts(turn).sign == ZERO and self._domain.facts(along).sign == POSITIVE

    def _at(self, term: Term, ray: Ray) -> Term:
        return term.put(dict(zip(self._forces, ray, strict=True)))

    def _sign_at(self, term: Term, ray: Ray) -> Sign:
        return self._domain.facts(self._at(term, ray)).sign
