"""Laws in two forces made of formulas in a fan of cones: g = f - c, f of degree 1 in the forces, c > 0, one formula between two rays.

Such an f is convex where it is so within each cone and, from one cone to the next, does not jump and its slope across their
common ray does not fall; then so is K = {f <= c}.  Where the slopes are equal f is C^1, and sigma . grad f = f = c > 0 on the boundary.
The rays have directions that are numbers, with roots perhaps, so that what is asked on them is the sign of a number.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain
from duhem.proof.kernel.forms import affine
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.homogeneity import by_degree
from duhem.proof.kernel.pieces import CHOICES, pieces
from duhem.proof.kernel.polynomial import Polynomial
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, minus, number, product_of, sum_of

__all__ = ["Fan"]

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
