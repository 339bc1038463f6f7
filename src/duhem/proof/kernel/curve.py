"""A law given by a boundary curve, as its text says it: signs all around, and how often a vector turns.

With T the boundary and ' the derivative by the angle, over boxes that cover the circle: the circle is (c, s) and (-c, -s)
with c = (1 - t^2)/(1 + t^2), s = 2 t/(1 + t^2), |t| <= 1.  Theorems: a closed curve whose tangent turns once and to the
left throughout is simple and bounds a convex set; one that runs around 0 in polar order once is simple and bounds a set
star-shaped about 0 (M. P. do Carmo 1976, section 5-7).  A curve run clockwise is turned round first: T(-phi) with the
flow d(-phi) has the same points, each with the same slip, and winds around the same set.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, Bounds, as_list, declared
from duhem.proof.kernel.interval import AngleJet, Enclosure
from duhem.proof.kernel.term import NotWritten, Term, minus, parse

__all__ = ["StatedCurve"]

_MOST_BOXES, _NARROWEST = 4096, Fraction(1, 2**24)  # in t; what is not shown there hardly ever is in narrower boxes
_ZERO, _ONE = Enclosure(0, 0), Enclosure.between(Fraction(1), Fraction(1))
Vector = tuple[AngleJet, AngleJet]
Steps = tuple[list[tuple[Term, tuple[int, ...]]], list[int]]  # each part with the places of its arguments; where the formulas end
Box = tuple[int, Fraction, Fraction]  # which half of the circle, and t from where to where


class StatedCurve(NamedTuple):
    """The law of a certificate: K = |pressure| times what the curve ``boundary`` (angle) winds around; ``flow`` its slip."""

    forces: tuple[str, ...]
    pressure: str
    angle: str
    boundary: tuple[Term, ...]
    flow: tuple[Term, ...] | None
    parameters: Mapping[str, Bounds]
    constraints: tuple[Term, ...]

    @classmethod
    def read(cls, given: Mapping[str, Any]) -> StatedCurve:
        """From the ``law`` of a certificate; NotWritten for what is no law or has no parameter values."""
        forces, parameters, constraints, fixed = declared(given, (given["pressure"], given["angle"]), {"angle", "boundary", "flow"})
        one, two = (parse(text).put(fixed) for text in as_list(given["boundary"]))
        flow = None if given["flow"] is None else tuple(parse(text).put(fixed) for text in as_list(given["flow"]))
        if len(forces) != 2 or (flow is not None and len(flow) != 2):
            raise NotWritten("a boundary curve takes two forces")
        if any(not x.names() <= {given["angle"], *parameters, "pi"} for x in (one, two, *(flow or ()))):
            raise NotWritten("a name is not declared")
        return cls(forces, given["pressure"], given["angle"], (one, two), flow, parameters, constraints)

    def convex(self) -> bool:
        """T' x T'' > 0 and T' turns once, run one way or the other."""
        return self._turns_once(lambda c: _derivative(c.boundary), lambda c: _cross(*_ends(c.boundary, 1, 2)))

    def star_shaped(self) -> bool:
        """T x T' > 0 and T turns once, run one way or the other."""
        return self._turns_once(lambda c: _value(c.boundary), lambda c: _cross(*_ends(c.boundary, 0, 1)))

    def around_zero(self) -> bool:
        """T turns once around 0, which it never meets, run one way or the other."""
        return self._turns_once(lambda c: _value(c.boundary))

    def powered(self) -> bool:
        """T . d > 0."""
        return self.flow is not None and self._turn(None, lambda c: _dot(_value(c.boundary), _value(c.flow))) is not None

    def reversed(self) -> StatedCurve:
        """The same law by T(-phi) and d(-phi), whose angle enters through its cosine and sine only."""
        sine = Term("sin", (Term("name", name=self.angle),))
        turn = {sine: minus(sine)}
        flow = None if self.flow is None else tuple(x.put(turn) for x in self.flow)
        return self._replace(boundary=tuple(x.put(turn) for x in self.boundary), flow=flow)

    def _turns_once(self, vector: Callable[[_OnBox], Pair], positive: Callable[[_OnBox], Enclosure] | None = None) -> bool:
        """Whether the vector turns once to the left, of the curve or of its reverse."""
        return any(curve._turn(vector, positive) == 1 for curve in (self, self.reversed()))

    def _turn(self, vector: Callable[[_OnBox], Pair] | None, positive: Callable[[_OnBox], Enclosure] | None = None) -> int | None:
        """How often a vector turns (0 for none), where ``positive`` is > 0 and the vector is not 0 all around; None if not shown."""
        steps, quadrants = self._steps(), list[int]()
        boxes: list[Box] = [(-1, Fraction(-1), Fraction(1)), (1, Fraction(-1), Fraction(1))]  # the first one last
        while boxes:
            half, low, high = boxes.pop()
            found = self._half_plane(steps, _circle(half, low, high), vector, positive)
            if found is not None:
                quadrants.append(found)
                continue
            if high - low < _NARROWEST or len(quadrants) > _MOST_BOXES:
                return None
            middle = (low + high) / 2
            boxes += [(half, middle, high), (half, low, middle)]
        turned = [(after - before + 1) % 4 - 1 for before, after in pairwise([*quadrants, quadrants[0]])]
        return sum(turned) // 4 if max(map(abs, turned)) <= 1 else None

    def _steps(self) -> Steps:
        """Every part of boundary and flow once, after its arguments; the angle enters through its cosine and sine only."""
        here = (Term("name", name=self.angle),)
        steps, places = list[tuple[Term, tuple[int, ...]]](), dict[Term, int]()

        def enter(term: Term) -> int:
            if term not in places:
                parts = () if term.op in ("cos", "sin") and term.args == here else tuple(enter(a) for a in term.args)
                steps.append((term, parts))
                places[term] = len(steps) - 1
            return places[term]

        return steps, [enter(term) for term in (*self.boundary, *(self.flow or ()))]

    def _half_plane(
        self, steps: Steps, circle: Vector, vector: Callable[[_OnBox], Pair] | None, positive: Callable[[_OnBox], Enclosure] | None
    ) -> int | None:
        """0 to 3 where the vector's x > 0, y > 0, x < 0, y < 0 over a box; None where nothing is shown."""
        try:
            jets: list[AngleJet] = []
            for term, arguments in steps[0]:
                jets.append(self._jet(term, [jets[i] for i in arguments], circle))
            found = [jets[i] for i in steps[1]]
            place = _OnBox(tuple(found[:2]), tuple(found[2:]))
            if positive is not None and positive(place).sign != POSITIVE:
                return None
            x, y = (_ONE, _ZERO) if vector is None else vector(place)
        except (ZeroDivisionError, ValueError):
            return None
        for i, (part, sign) in enumerate(((x, POSITIVE), (y, POSITIVE), (x, NEGATIVE), (y, NEGATIVE))):
            if part.sign == sign:
                return i
        return None

    def _jet(self, term: Term, parts: list[AngleJet], circle: Vector) -> AngleJet:
        """A term from its arguments, over a box of angles and all values of the parameters; NotWritten for what may have a kink."""
        if term.op == "number":
            return _constant(Enclosure.between(term.value, term.value))
        if term.op == "name" and term.name in self.parameters:
            low, high, *_ = self.parameters[term.name]
            if low is None or high is None:
                raise NotWritten("a parameter has no bounds")
            return _constant(Enclosure.between(low, high))
        if term.op in ("cos", "sin") and not parts:
            return circle[term.op == "sin"]
        if term.op == "**" and term.args[1].op == "number":
            return _power(parts[0], term.args[1].value)
        if term.op in ("+", "*", "norm"):
            first, *rest = (x.times(x) for x in parts) if term.op == "norm" else parts
            for x in rest:
                first = first.times(x) if term.op == "*" else first.plus(x)
            return first.root() if term.op == "norm" else first
        raise NotWritten(f"no rule for {term.op}")


class _OnBox(NamedTuple):
    """The curve and its slip over a box."""

    boundary: Any
    flow: Any


Pair = tuple[Enclosure, Enclosure]


def _circle(half: int, low: Fraction, high: Fraction) -> Vector:
    """Cosine and sine over a box: c falls with |t|, s rises with t."""
    far, near = max(abs(low), abs(high)), Fraction(0) if low <= 0 <= high else min(abs(low), abs(high))
    c = Enclosure.between((1 - far**2) / (1 + far**2), (1 - near**2) / (1 + near**2))
    s = Enclosure.between(2 * low / (1 + low**2), 2 * high / (1 + high**2))
    if half < 0:
        c, s = c.minus(), s.minus()
    return AngleJet(c, s.minus(), c.minus()), AngleJet(s, c, s.minus())


def _power(base: AngleJet, exponent: Fraction) -> AngleJet:
    """A power with a whole or half exponent."""
    if exponent.denominator > 2 or abs(exponent) > 12:
        raise NotWritten("no rule for this exponent")
    base = base.root() if exponent.denominator == 2 else base
    total = _constant(_ONE)
    for _ in range(abs(exponent.numerator)):
        total = total.times(base)
    return total if exponent >= 0 else total.inverse()


def _constant(value: Enclosure) -> AngleJet:
    return AngleJet(value, _ZERO, _ZERO)


def _value(v: Vector) -> Pair:
    return v[0].value, v[1].value


def _derivative(v: Vector) -> Pair:
    return v[0].first, v[1].first


def _ends(v: Vector, one: int, two: int) -> tuple[Pair, Pair]:
    return (v[0][one], v[1][one]), (v[0][two], v[1][two])


def _dot(a: Pair, b: Pair) -> Enclosure:
    return a[0].times(b[0]).plus(a[1].times(b[1]))


def _cross(a: Pair, b: Pair) -> Enclosure:
    return a[0].times(b[1]).plus(a[1].times(b[0]).minus())
