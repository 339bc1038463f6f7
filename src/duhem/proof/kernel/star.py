"""Star-shaped laws in the plane: g = A - B with A, B > 0 homogeneous in the forces, of degrees a > b.

K is then what the gauge gamma = (A/B)^(1/(a - b)) leaves, {gamma <= 1}.  Along the rays of :mod:`arcs`, gamma(1 - t^2, 2 t) =
psi(t) is a product of powers of positive polynomials, and gamma = psi/(1 + t^2) at the angle theta, dtheta = 2 dt/(1 + t^2):

    gamma + gamma''  has the sign of  (1 + t^2) psi'' - 2 t psi' + 2 psi,      2 gamma'  is  psi' - 2 t psi/(1 + t^2).

K is convex where gamma'' + gamma >= 0 as a measure on the circle, and has a C^1 boundary where gamma' does not jump
(R. Schneider 2014, Convex Bodies, section 1.7).  On g = 0, sigma . grad g = a A - b B = (a - b) A > 0 (Euler).
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import islice, pairwise

from duhem.proof.kernel.arcs import CIRCLE, DirectionArc, arcs, difference, exponent
from duhem.proof.kernel.curvature import facts, over
from duhem.proof.kernel.domain import StatedDomain, StatedLaw
from duhem.proof.kernel.plane_function import PlaneFunction, derivatives, multiplied
from duhem.proof.kernel.polynomial import Polynomial, negated, replaced, times, total
from duhem.proof.kernel.positivity import RAY, Interval, nonnegative
from duhem.proof.kernel.term import NotWritten, Term, minus, number

__all__ = ["StarGauge"]

_ALIKE = ("+", "abs", "pos", "neg", "max", "min", "norm", "where", "<", "<=", ">", ">=")  # of one degree in all arguments
_MOST_TERMS = 200
_TWO_T: Polynomial = {((RAY, 1),): Fraction(2)}


class StarGauge:
    """The gauge of a star-shaped law; NotWritten for a law that is not shown to have one."""

    def __init__(self, law: StatedLaw) -> None:
        self._domain = over(law)
        g, forces = _in_the_plane(law, self._domain)
        upper, lower, order = _split(g, self._domain)
        sides = [[_Piece(a, b, order, arc) for arc, (a, b) in side] for side in arcs((upper, lower), forces, self._domain)]
        if not all(one.meets(two) for side in sides for one, two in pairwise(side)):
            raise NotWritten("the gauge may jump")
        self._sides = [[piece for piece in side if not piece.arc.single] for side in sides]

    def convex(self) -> bool:
        """gamma + gamma'' >= 0 on every arc, and gamma' does not jump down from one to the next."""
        bent = all(piece.bends_outward() for side in self._sides for piece in side)
        return bent and all(nonnegative(jump, at, self._domain) for jump, at in self._jumps())

    def smooth(self) -> bool:
        """gamma' does not jump."""
        return all(nonnegative(rise, at, self._domain) for jump, at in self._jumps() for rise in (jump, negated(jump)))

    def _jumps(self) -> Iterator[tuple[Polynomial, Interval]]:
        """By how much gamma'/gamma rises from each arc to the next, up to positive factors, and for which t."""
        for side, after in zip(self._sides, self._sides[::-1], strict=True):
            for one, two in pairwise(side):
                yield _rise(one.turn(), two.turn()), two.arc.start
            yield _rise(_at(side[-1].turn(), 1), _at(after[0].turn(), -1)), (Fraction(0), Fraction(0))


_Quotient = tuple[Polynomial, Polynomial]  # of two, the second > 0


def _at(quotient: _Quotient, t: int) -> _Quotient:
    upper, lower = (replaced(p, RAY, {(): Fraction(t)}) for p in quotient)
    return upper, lower


def _rise(before: _Quotient, after: _Quotient) -> Polynomial:
    return total(times(after[0], before[1]), negated(times(before[0], after[1])))


class _Piece:
    """psi on an arc, a product of powers of positive polynomials."""

    def __init__(self, upper: PlaneFunction, lower: PlaneFunction, order: Fraction, arc: DirectionArc) -> None:
        self.arc = arc
        self._psi = multiplied((arc.positive_power(upper, {(): 1 / order}), arc.positive_power(lower, {(): -1 / order})))

    def bends_outward(self) -> bool:
        """Whether (1 + t^2) psi'' - 2 t psi' + 2 psi >= 0 on the arc."""
        return self.arc.above(self.arc.bend(self._psi))

    def turn(self) -> _Quotient:
        """2 gamma'/gamma."""
        found = derivatives(self._psi, self.arc.along)
        size = times(self._psi.poly, found.over)
        return total(times(CIRCLE, found.first), negated(times(_TWO_T, size))), size

    def meets(self, after: _Piece) -> bool:
        """Whether psi is the same on both arcs where they meet; a formula that cannot jump needs no question."""
        if not (self.arc.single or after.arc.single):
            return True
        ray = self.arc if self.arc.single else after.arc
        return ray.sign(difference(self._psi, after._psi, ray), strict=True) == 0


def _in_the_plane(law: StatedLaw, domain: StatedDomain) -> tuple[Term, tuple[str, str]]:
    """g in two forces; in three, where adding the same to all changes nothing, those two that remain when the third is 0."""
    if len(law.forces) == 2:
        return law.g, (law.forces[0], law.forces[1])
    names = [Term("name", name=f) for f in law.forces]
    moved = {x: Term("+", (x, RAY)) for x in names}

    def fixed(term: Term) -> bool:
        same = facts(term, domain).defined and domain.polynomial(term.put(moved)) == domain.polynomial(term)
        return same or (bool(term.args) and all(map(fixed, term.args)))

    if len(names) != 3 or not fixed(law.g):
        raise NotWritten("the law is none of two forces")
    return law.g.put({names[2]: number(0)}), (law.forces[0], law.forces[1])


def _split(g: Term, domain: StatedDomain) -> tuple[Term, Term, Fraction]:
    """A, B and a - b."""
    by_degree: dict[Fraction, list[Term]] = {}
    for term in islice(_summands(g, domain), _MOST_TERMS):
        if (degree := _degree(term, domain)) is None:
            raise NotWritten("a part of g has no degree in the forces")
        by_degree.setdefault(degree, []).append(term)
    if len(by_degree) != 2 or sum(map(len, by_degree.values())) == _MOST_TERMS:
        raise NotWritten("g has not two degrees in the forces")
    low, high = sorted(by_degree)
    return Term("+", tuple(by_degree[high])), Term("+", tuple(map(minus, by_degree[low]))), high - low


def _summands(term: Term, domain: StatedDomain) -> Iterator[Term]:
    """What the term is the sum of; a factor that is a sum of several degrees is multiplied out."""
    if term.op == "+":
        for part in term.args:
            yield from _summands(part, domain)
        return
    mixed = [i for i, a in enumerate(term.args) if a.op == "+" and _degree(a, domain) is None] if term.op == "*" else []
    if not mixed:
        yield term
        return
    for part in term.args[mixed[0]].args:
        yield from _summands(Term("*", (*term.args[: mixed[0]], part, *term.args[mixed[0] + 1 :])), domain)


def _degree(term: Term, domain: StatedDomain) -> Fraction | None:
    """k where the term at r times the forces is r^k times it, for every r > 0; None if that is not seen."""
    if domain.constant(term):
        return Fraction(0)
    if term.op == "name":
        return Fraction(1)
    if term.op == "**":
        base, n = _degree(term.args[0], domain), exponent(term, domain)
        return None if base is None or n is None else base * n
    if term.op == "where" and _degree(term.args[0], domain) is None:
        return None
    if term.op not in (*_ALIKE, "*"):
        return None
    parts = term.args[1:] if term.op == "where" else term.args
    zeros = [term.op != "*" and domain.constant(a) and not domain.polynomial(a) for a in parts]  # of every degree
    degrees = [_degree(a, domain) for a, zero in zip(parts, zeros, strict=True) if not zero]
    known = [k for k in degrees if k is not None]
    if len(known) < len(degrees) or (term.op != "*" and len(set(known)) != 1):
        return None
    return sum(known, Fraction(0)) if term.op == "*" else known[0]
