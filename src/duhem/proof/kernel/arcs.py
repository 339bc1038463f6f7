"""A formula in two forces along the rays from zero force, arc by arc: on each it is a polynomial times powers of positive ones.

The rays are x = side (1 - t^2), y = side 2 t with -1 <= t <= 1 and side = 1 (x >= 0) or -1, so that norm(x, y) = 1 + t^2 is a
polynomial too and theta, with t = tan(theta/2) or so turned by pi, grows with t.  Every part of the formula is read, also what
is multiplied by 0, and must be defined: what is divided by or has a root taken of it is shown to be > 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import lcm

from duhem.proof.kernel.curvature import facts
from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.line import Line, divides, joined, parts, roots, sign_inside
from duhem.proof.kernel.plane_function import MOST_POWER, PlaneFunction, PlaneVariable, added, multiplied
from duhem.proof.kernel.polynomial import Polynomial, negated, number_in, total
from duhem.proof.kernel.positivity import RAY, nonnegative, on_the_line, without_content
from duhem.proof.kernel.term import NotWritten, Term

__all__ = ["CIRCLE", "DirectionArc", "arcs", "difference", "exponent"]

End = tuple[Fraction, Fraction]  # a t between two numbers, known exactly where they are one
CIRCLE: Polynomial = {(): Fraction(1), ((RAY, 2),): Fraction(1)}  # 1 + t^2
_MOST_ARCS = 24


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
        return nonnegative(poly, (self.start[0], self.stop[1]), self.domain, strict)

    def sign(self, poly: Polynomial, strict: bool = False) -> int:
        """1 for >= 0 and -1 for <= 0 on the closed arc; ``strict``: > 0 and < 0 between its ends, and 0 for 0."""
        if strict and self.above(poly) and self.above(negated(poly)):
            return 0
        for way, turned in ((1, poly), (-1, negated(poly))):
            if self.above(turned, strict):
                return way
        plain = on_the_line(without_content(poly, self.domain))
        if plain is None:
            raise NotWritten("where a part changes its sign depends on the constants")
        switch = parts(plain)[not strict]
        if not divides(switch, self.switches):
            raise _Turns(switch)
        return sign_inside(plain, self.start[1], self.stop[0])


def arcs(terms: Sequence[Term], forces: tuple[str, str], domain: StatedDomain) -> Iterator[list[tuple[DirectionArc, list[PlaneFunction]]]]:
    """The terms along all rays, one side after the other: arcs that meet at their ends, all in the direction of t.

    Where a ``where`` may jump, the rays at the ends of arcs stand between them.
    """
    jumps = any(_has_where(term) for term in terms)
    for side in (1, -1):
        switches: Line = (1,)
        found: list[tuple[DirectionArc, list[PlaneFunction]]] = []
        while not found:
            try:
                found = [(arc, [_read(term, arc) for term in terms]) for arc in _cut(side, switches, jumps, forces, domain)]
            except _Turns as turns:
                switches = joined(switches, turns.switch)
        yield found


def _cut(side: int, switches: Line, singles: bool, forces: tuple[str, str], domain: StatedDomain) -> Iterator[DirectionArc]:
    ends = [(Fraction(-1), Fraction(-1)), *roots(switches, Fraction(-1), Fraction(1)), (Fraction(1), Fraction(1))]
    if len(ends) > _MOST_ARCS or any(a[1] >= b[0] for a, b in pairwise(ends)) or (singles and any(a != b for a, b in ends)):
        raise NotWritten("the arcs are too many, or their ends too near or not exact")
    for start, stop in pairwise(ends):
        if singles:
            yield DirectionArc(domain, forces, side, start, start, switches)
        yield DirectionArc(domain, forces, side, start, stop, switches)
    if singles:
        yield DirectionArc(domain, forces, side, ends[-1], ends[-1], switches)


def _has_where(term: Term) -> bool:
    return term.op == "where" or any(map(_has_where, term.args))


def _read(term: Term, arc: DirectionArc) -> PlaneFunction:
    """The term at these forces; its degree in them is not counted."""
    if arc.domain.constant(term):
        if not facts(term, arc.domain).defined:
            raise NotWritten("a constant may be undefined")
        return PlaneFunction(Fraction(0), arc.domain.polynomial(term), {})
    if term.op == "name":
        x: Polynomial = {(): Fraction(arc.side), ((RAY, 2),): Fraction(-arc.side)}
        return PlaneFunction(Fraction(0), x if term.name == arc.forces[0] else {((RAY, 1),): Fraction(2 * arc.side)}, {})
    if term.op == "**":
        if (n := exponent(term, arc.domain)) is None:
            raise NotWritten("an exponent is no number")
        return arc.power(_read(term.args[0], arc), {(): n})
    if term.op == "where":
        comparison, *values = term.args
        left, right = (_read(a, arc) for a in comparison.args)
        gap = difference(left, right, arc)
        holds = {"<": (-1,), "<=": (-1, 0), ">": (1,), ">=": (0, 1)}[comparison.op]
        return _read(values[arc.sign(gap, strict=True) not in holds], arc)
    read = [_read(a, arc) for a in term.args]
    match term.op:
        case "+":
            return added(read)
        case "*":
            return multiplied(read)
        case "abs" | "pos" | "neg":
            positive = arc.sign(read[0].poly) > 0
            if term.op != "abs" and positive is (term.op == "neg"):
                return read[0]._replace(poly={}, powers={})
            return read[0] if positive else _opposite(read[0])
        case "max" | "min":
            best = read[0]
            for other in read[1:]:
                if (arc.sign(difference(best, other, arc)) < 0) is (term.op == "max"):
                    best = other
            return best
        case "norm":
            moving = [v for v in read if v.poly] or read[:1]
            if len(moving) == 1:
                return moving[0] if arc.sign(moving[0].poly) > 0 else _opposite(moving[0])
            return arc.power(added([multiplied([v, v]) for v in moving]), {(): Fraction(1, 2)})
    raise NotWritten(f"{term.op} is not read along a ray")


def exponent(term: Term, domain: StatedDomain) -> Fraction | None:
    """The exponent of a power, if it is a number, like 1/4."""
    n = number_in(domain.polynomial(term.args[1]))
    return n if facts(term.args[1], domain).defined else None


def _opposite(value: PlaneFunction) -> PlaneFunction:
    return value._replace(poly=negated(value.poly))


def difference(one: PlaneFunction, two: PlaneFunction, arc: DirectionArc) -> Polynomial:
    """A polynomial with the sign of one - two: of their powers, free of roots, where both are >= 0."""
    apart = [number_in(total(one.powers.get(b, {}), negated(two.powers.get(b, {})))) or Fraction(0) for b in {*one.powers, *two.powers}]
    whole = lcm(*(n.denominator for n in apart))
    if whole > MOST_POWER or (whole > 1 and not (arc.above(one.poly) and arc.above(two.poly))):
        raise NotWritten("high roots are compared, or roots with what may be < 0")
    return added([multiplied([one] * whole), _opposite(multiplied([two] * whole))]).poly
