"""The gauge of a star-shaped set of two forces, arc by arc along the rays from zero force.

The rays are x = side (1 - t^2), y = side 2 t with -1 <= t <= 1 and side = 1 (x >= 0) or -1, so that norm(x, y) = 1 + t^2 is a
polynomial too and theta, with t = tan(theta/2) or so turned by pi, grows with t.  Every part of a formula is read, also what
is multiplied by 0, and must be defined: what is divided by or has a root taken of it is shown to be > 0.

On each arc let g = A - B with A, B > 0 homogeneous in the forces, of degrees a > b.  K is then what the gauge gamma = (A/B)^(1/(a - b))
leaves, {gamma <= 1}.  It is psi(t) at 1 - t^2, 2 t, and psi/(1 + t^2) at the angle theta, dtheta = 2 dt/(1 + t^2), so that
2 gamma' is psi' - 2 t psi/(1 + t^2).  K is convex where gamma'' + gamma >= 0 as a measure on the circle, and has a C^1 boundary
where gamma' does not jump (R. Schneider 2014, Convex Bodies, section 1.7).  On g = 0, sigma . grad g = a A - b B = (a - b) A > 0 (Euler).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise, product
from math import lcm

from duhem.proof.kernel import signs
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.identity import multiplied_through
from duhem.proof.kernel.plane_function import MOST_POWER, PlaneFunction, PlaneVariable, added, derivatives, multiplied
from duhem.proof.kernel.polynomial import Polynomial, negated, number_in, replaced, times, total
from duhem.proof.kernel.signs import RAY, Interval, Line
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, number

__all__ = ["DirectionArc", "StarGauge", "above_zero_along_rays", "arcs", "in_the_plane"]

End = tuple[Fraction, Fraction]  # a t between two numbers, known exactly where they are one
Graded = Mapping[Fraction, PlaneFunction]  # the parts of each degree in the forces that are not 0
_MOST_ARCS = 24
_TWO_T: Polynomial = {((RAY, 1),): Fraction(2)}


class _Turns(Exception):
    """A part changes its sign inside an arc, at roots of ``switch``."""

    def __init__(self, switch: Line) -> None:
        self.switch = switch


@dataclass(frozen=True)
class DirectionArc(PlaneVariable):
    """The rays on one ``side`` with t from ``start`` to ``stop``, or one ray; ``switches`` has no root strictly between."""

    domain: StatedDomain
    forces: tuple[str, str]
    side: int
    start: End
    stop: End
    switches: Line

    @property
    def single(self) -> bool:
        """Whether it is one ray."""
        return self.start == self.stop

    def above(self, poly: Polynomial, strict: bool = False) -> bool:
        """Whether it is >= 0, or > 0, on the closed arc (somewhat beyond an end that is not exact) and the whole domain."""
        return signs.nonnegative(poly, (self.start[0], self.stop[1]), self.domain, strict)

    def sign(self, poly: Polynomial, strict: bool = False) -> int:
        """1 for >= 0 and -1 for <= 0 on the closed arc; ``strict``: > 0 and < 0 between its ends, and 0 for 0."""
        if strict and self.above(poly) and self.above(negated(poly)):
            return 0
        for way, turned in ((1, poly), (-1, negated(poly))):
            if self.above(turned, strict):
                return way
        plain = signs.on_the_line(signs.without_content(multiplied_through(poly, self.domain, signed=True), self.domain))
        if plain is None:
            raise NotWritten("where a part changes its sign depends on the constants")
        if not plain:
            return int(not strict)  # it is 0 once it is multiplied through
        switch = signs.parts(plain)[not strict]
        if not signs.divides(switch, self.switches):
            raise _Turns(switch)
        return signs.sign_inside(plain, self.start[1], self.stop[0])

    # -- reading -------------------------------------------------------------------------------------------------------

    def read(self, term: Term) -> Graded:
        """The term at the forces of these rays."""
        if self.domain.constant(term):
            if not self.domain.facts(term).defined:
                raise NotWritten("a constant may be undefined")
            return _graded([PlaneFunction(Fraction(0), self.domain.polynomial(term), {})])
        if term.op == "name":
            x: Polynomial = {(): Fraction(self.side), ((RAY, 2),): Fraction(-self.side)}
            return _graded([PlaneFunction(Fraction(1), x if term.name == self.forces[0] else {((RAY, 1),): Fraction(2 * self.side)}, {})])
        if term.op == "**":
            return self._power(self.read(term.args[0]), term.args[1])
        if term.op == "where":
            comparison, *values = term.args
            gap = self.difference(*_alone([self.read(a) for a in comparison.args]))
            holds = {"<": (-1,), "<=": (-1, 0), ">": (1,), ">=": (0, 1)}[comparison.op]
            return self.read(values[self.sign(gap, strict=True) not in holds])
        read = [self.read(a) for a in term.args]
        match term.op:
            case "+":
                return _graded([value for parts in read for value in parts.values()])
            case "*":
                return _graded([multiplied(values) for values in product(*(parts.values() for parts in read))])
            case "abs" | "pos" | "neg" | "max" | "min" | "norm":
                return _graded([self._word(term.op, _alone(read))])
        raise NotWritten(f"{term.op} is not read along a ray")

    def _power(self, base: Graded, exponent: Term) -> Graded:
        n = number_in(self.domain.polynomial(exponent))
        if n is None or not self.domain.facts(exponent).defined:
            raise NotWritten("an exponent is no number")
        return _graded([self.power(_alone([base])[0], {(): n})])

    def _word(self, word: str, values: list[PlaneFunction]) -> PlaneFunction:
        """Of values of one degree."""
        best, moving = values[0], [v for v in values if v.poly] or values[:1]
        if word in ("max", "min"):
            if len(values) > _MOST_ARCS:
                raise NotWritten("a maximum has too many arms")
            for other in values[1:]:
                if (self.sign(self.difference(best, other)) < 0) is (word == "max"):
                    best = other
            return best
        if len(moving) > 1:
            return self.power(added([multiplied([v, v]) for v in moving]), {(): Fraction(1, 2)})
        positive = self.sign(moving[0].poly) > 0
        if word in ("pos", "neg") and positive is (word == "neg"):
            return best._replace(poly={}, powers={})
        return moving[0] if positive else _opposite(moving[0])

    def difference(self, one: PlaneFunction, two: PlaneFunction) -> Polynomial:
        """A polynomial with the sign of one - two: of their powers, free of roots, where both are >= 0."""
        apart = [number_in(total(one.powers.get(b, {}), negated(two.powers.get(b, {})))) or Fraction(0) for b in {*one.powers, *two.powers}]
        whole = lcm(*(n.denominator for n in apart))
        if whole > MOST_POWER or (whole > 1 and not (self.above(one.poly) and self.above(two.poly))):
            raise NotWritten("high roots are compared, or roots with what may be < 0")
        return added([multiplied([one] * whole), _opposite(multiplied([two] * whole))]).poly


def _graded(values: Sequence[PlaneFunction]) -> Graded:
    """Their sum by degrees."""
    sums = (added([v for v in values if v.degree == degree]) for degree in sorted({v.degree for v in values}))
    return {value.degree: value for value in sums if value.poly}


def _alone(read: Sequence[Graded]) -> list[PlaneFunction]:
    """What is of one degree, or 0; NotWritten where there are more."""
    degrees = {degree for parts in read for degree in parts} or {Fraction(0)}
    if len(degrees) > 1:
        raise NotWritten("a part has no degree in the forces")
    return [next(iter(parts.values()), PlaneFunction(min(degrees), {}, {})) for parts in read]


def _opposite(value: PlaneFunction) -> PlaneFunction:
    return value._replace(poly=negated(value.poly))


def arcs(term: Term, forces: tuple[str, str], domain: StatedDomain) -> Iterator[list[tuple[DirectionArc, Graded]]]:
    """The term along all rays, one side after the other: arcs that meet at their ends, all in the direction of t.

    Where a ``where`` may jump, the rays at the ends of arcs stand between them.
    """
    jumps = any(part.op == "where" for part in term.parts())
    for side in (1, -1):
        switches: Line = (1,)
        found: list[tuple[DirectionArc, Graded]] = []
        while not found:
            try:
                found = [(arc, arc.read(term)) for arc in _cut(side, switches, jumps, forces, domain)]
            except _Turns as turns:
                switches = signs.roots_of_both(switches, turns.switch)
        yield found


def _cut(side: int, switches: Line, singles: bool, forces: tuple[str, str], domain: StatedDomain) -> Iterator[DirectionArc]:
    ends = [(Fraction(-1), Fraction(-1)), *signs.roots(switches, Fraction(-1), Fraction(1)), (Fraction(1), Fraction(1))]
    if len(ends) > _MOST_ARCS or any(a[1] >= b[0] for a, b in pairwise(ends)) or (singles and any(a != b for a, b in ends)):
        raise NotWritten("the arcs are too many, or their ends too near or not exact")
    for start, stop in pairwise(ends):
        if singles:
            yield DirectionArc(domain, forces, side, start, start, switches)
        yield DirectionArc(domain, forces, side, start, stop, switches)
    if singles:
        yield DirectionArc(domain, forces, side, ends[-1], ends[-1], switches)


# -- the gauge ---------------------------------------------------------------------------------------------------------


class StarGauge:
    """The gauge of a star-shaped law; NotWritten for a law that is not shown to have one."""

    def __init__(self, law: StatedLaw) -> None:
        self._domain = over(law)
        g, forces = in_the_plane(law, self._domain)
        sides = [[_Piece(arc, read) for arc, read in side] for side in arcs(g, forces, self._domain)]
        if not all(one.meets(two) for side in sides for one, two in pairwise(side)):
            raise NotWritten("the gauge may jump")
        self._sides = [[piece for piece in side if not piece.arc.single] for side in sides]

    def convex(self) -> bool:
        """gamma + gamma'' >= 0 on every arc, and gamma' does not jump down from one to the next."""
        bent = all(piece.arc.above(piece.bend()) for side in self._sides for piece in side)
        return bent and all(signs.nonnegative(jump, at, self._domain) for jump, at in self.jumps())

    def smooth(self) -> bool:
        """gamma' does not jump."""
        return all(signs.nonnegative(rise, at, self._domain) for jump, at in self.jumps() for rise in (jump, negated(jump)))

    def bends(self) -> Iterator[tuple[Polynomial, Interval]]:
        """gamma + gamma'' on each arc, up to positive factors, and for which t; these are exact ends or inside of them."""
        for piece in (piece for side in self._sides for piece in side):
            yield piece.bend(), (piece.arc.start[1], piece.arc.stop[0])

    def jumps(self) -> Iterator[tuple[Polynomial, Interval]]:
        """By how much gamma'/gamma rises from each arc to the next, up to positive factors, and for which t.

        An end that is not exact is the one root that ``switches`` has between two numbers: the rise is 0 where it shares this root.
        """
        for side, after in zip(self._sides, self._sides[::-1], strict=True):
            for one, two in pairwise(side):
                yield self._at_the_end(_rise(one.turn(), two.turn()), two.arc), two.arc.start
            yield _rise(_at(side[-1].turn(), 1), _at(after[0].turn(), -1)), (Fraction(0), Fraction(0))

    def _at_the_end(self, rise: Polynomial, arc: DirectionArc) -> Polynomial:
        """A rise where an arc begins, 0 if it is shown to be 0 there."""
        plain = None if arc.start[0] == arc.start[1] else signs.on_the_line(signs.without_content(rise, self._domain))
        return {} if plain and signs.roots_between(signs.common_roots(plain, arc.switches), *arc.start) else rise


_Quotient = tuple[Polynomial, Polynomial]  # of two, the second > 0


def _at(quotient: _Quotient, t: int) -> _Quotient:
    upper, lower = (replaced(p, RAY, {(): Fraction(t)}) for p in quotient)
    return upper, lower


def _rise(before: _Quotient, after: _Quotient) -> Polynomial:
    return total(times(after[0], before[1]), negated(times(before[0], after[1])))


class _Piece:
    """psi on an arc, a product of powers of positive polynomials."""

    def __init__(self, arc: DirectionArc, g: Graded) -> None:
        if len(g) != 2:
            raise NotWritten("g has not two degrees in the forces")
        (low, lower), (high, upper) = sorted(g.items())
        self.arc, order = arc, high - low
        self._psi = multiplied((arc.positive_power(upper, {(): 1 / order}), arc.positive_power(_opposite(lower), {(): -1 / order})))

    def bend(self) -> Polynomial:
        """(1 + t^2) psi'' - 2 t psi' + 2 psi, up to a positive factor."""
        return self.arc.bend(self._psi)

    def turn(self) -> _Quotient:
        """2 gamma'/gamma."""
        found = derivatives(self._psi, self.arc.along)
        size = times(self._psi.poly, found.over)
        return total(times(self.arc.distance, found.first), negated(times(_TWO_T, size))), size

    def meets(self, after: _Piece) -> bool:
        """Whether psi is the same on both arcs where they meet; a formula that cannot jump needs no question."""
        if not (self.arc.single or after.arc.single):
            return True
        ray = self.arc if self.arc.single else after.arc
        return ray.sign(ray.difference(self._psi, after._psi), strict=True) == 0


def above_zero_along_rays(law: StatedLaw) -> bool:
    """Whether g > 0 but at zero force, no part of it of one degree being < 0; in three forces but where all are the same."""
    domain = over(law)
    for arc, parts_of_g in (piece for side in arcs(*in_the_plane(law, domain), domain) for piece in side):
        values = [value.poly for value in parts_of_g.values()]
        if not all(map(arc.above, values)) or not any(arc.above(poly, strict=True) for poly in values):
            return False
    return True


def in_the_plane(law: StatedLaw, domain: StatedDomain) -> tuple[Term, tuple[str, str]]:
    """g in two forces; in three, where adding the same to all changes nothing, those two that remain when the third is 0."""
    if len(law.forces) == 2:
        return law.g, (law.forces[0], law.forces[1])
    names = [Term("name", name=f) for f in law.forces]
    moved = {x: Term("+", (x, RAY)) for x in names}

    def fixed(term: Term) -> bool:
        same = domain.facts(term).defined and domain.polynomial(term.put(moved)) == domain.polynomial(term)
        return same or (bool(term.args) and all(map(fixed, term.args)))

    if len(names) != 3 or not fixed(law.g):
        raise NotWritten("the law is none of two forces")
    return law.g.put({names[2]: number(0)}), (law.forces[0], law.forces[1])
