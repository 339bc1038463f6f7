r"""A law given by a boundary curve, under examination: where it has no value, and the curve at choices of its parameters, in balls.

With numbers for all parameters power series over balls carry T, T', T'', ... over a whole arc at once, so each sign is shown arc by arc
with directed rounding: a proof by subdivision of the angle.  Angles are in units of pi, from -1 to 1.  Where a kink (abs, pos, ...) may
lie in the arc, the arc stays open.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from itertools import chain, islice, pairwise
from random import Random
from typing import Any

import flint
import sympy as sp

from duhem.errors import InputError
from duhem.expression import defined_at
from duhem.expression.angles import algebraic_angles
from duhem.expression.ball_series import compiled, derivatives
from duhem.expression.balls import ball, certain_sign
from duhem.expression.number import fraction
from duhem.expression.parse import parse_as_written
from duhem.expression.text import formula
from duhem.law.curve_law import ParametricCriterion
from duhem.law.domain import Domain
from duhem.law.parameter_domain import simple_points
from duhem.proof.decide import EFFORTS, Budget
from duhem.proof.decide.question import Obligation, obligations
from duhem.proof.facts.subject import Subject, Values, rationals
from duhem.proof.statement import with_algebraic_angles

__all__ = ["Ball", "CurveJet", "CurveSubject", "Greatest", "NumericCurve", "Span", "Vector", "cross", "dot"]

Ball = Any
Vector = tuple[Any, Any]
Span = tuple[Fraction, Fraction]
_QUESTION_STEPS = 4_000_000
_REMEDY = "narrow the parameters' domains, or add a constraint, so that no such values are admitted"
_LOOKED_AT = 12  # parameter values at which it is seen whether the law has a value
_TURN: Span = (Fraction(-1), Fraction(1))
_NODE = 8  # steps of each node of the formulas over an arc
_MOST, _NARROWEST = 8192, Fraction(1, 2**40)  # how many arcs are looked at, and how narrow ones, before a question is left open


def dot(a: Sequence[Ball], b: Sequence[Ball]) -> Ball:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1]


def cross(a: Sequence[Ball], b: Sequence[Ball]) -> Ball:
    """a x b = a_1 b_2 - a_2 b_1."""
    return a[0] * b[1] - a[1] * b[0]


@dataclass(frozen=True)
class CurveJet:
    """Boundary and flow at an angle with their derivatives by it: ``boundary[k]``, ``flow[k]``; of numbers, balls or formulas."""

    boundary: tuple[Vector, ...]
    flow: tuple[Vector, ...]

    @property
    def lead(self) -> Ball:
        """d x T', of the flow d and the boundary T: > 0 where the flow is less than a right angle from the outward normal."""
        return cross(self.flow[0], self.boundary[1])

    @property
    def lean(self) -> Ball:
        """d . T': 0 where the flow is normal."""
        return dot(self.flow[0], self.boundary[1])


@dataclass(frozen=True)
class Greatest:
    """The greatest size of a function of the angle lies in ``value`` and is taken in ``arcs`` only (units of pi)."""

    value: Ball
    arcs: tuple[Span, ...]


class NumericCurve:
    """phi -> (boundary, flow) in balls; ``cosine`` and ``sine`` are the symbols that stand for those of the angle.

    Without a flow of its own the flow is the outward normal of a curve run counter-clockwise.
    """

    def __init__(
        self, boundary: Sequence[sp.Expr], flow: Sequence[sp.Expr] | None, cosine: sp.Symbol, sine: sp.Symbol, budget: Budget
    ) -> None:
        self._run = compiled([*boundary, *(flow or ())], (cosine, sine))
        self._budget = budget
        self._price = _NODE * sum(1 for x in (*boundary, *(flow or ())) for _ in sp.preorder_traversal(x))

    def over(self, span: Span, order: int) -> CurveJet:
        """Boundary and flow with derivatives up to ``order``, over the arc."""
        return self._along(flint.arb.pi() * ball(*span), order)

    def at(self, t: Fraction, order: int = 0) -> CurveJet:
        """The same at the one angle 2 atan t."""
        return self._along(2 * ball(t).atan(), order)

    def point(self, t: Fraction) -> Vector:
        """The boundary point at the angle 2 atan t."""
        return self.at(t).boundary[0]

    def _along(self, turn: Ball, order: int) -> CurveJet:
        angle = flint.arb_series([turn, 1], prec=order + 2)
        rows = [derivatives(component, order + 1) for component in self._run(angle.cos(), angle.sin())]
        boundary = tuple(zip(rows[0], rows[1], strict=True))
        flow = zip(rows[2], rows[3], strict=True) if len(rows) == 4 else normals(boundary)
        return CurveJet(boundary[: order + 1], tuple(flow)[: order + 1])

    def positive(self, quantity: Callable[[CurveJet], Ball], order: int) -> bool:
        """Whether ``quantity`` is > 0 at every angle; False also when that stays open."""
        if any(quantity(self.over((x, x), order)) <= 0 for x, _ in _pieces(32)):
            return False

        def settled(span: Span) -> bool | None:
            value = quantity(self.over(span, order))
            return None if value <= 0 else bool(value.is_finite() and value > 0)

        return self._covered(8, settled)

    def _covered(self, n: int, settled: Callable[[Span], bool | None], narrowest_first: bool = False) -> bool:
        """Whether each of n arcs is settled, halved where it is open; an arc that says None ends it.

        Where a sign changes, halving never ends, so the widest arcs are looked at first.  Whom one arc that is never settled stops, as
        a pole does, sees it sooner with the ``narrowest_first``.
        """
        queue, looked = deque(_pieces(n)), 0
        while queue:
            span = queue.pop() if narrowest_first else queue.popleft()
            looked += 1
            if known := settled(span):
                continue
            if known is None or looked > _MOST or span[1] - span[0] < _NARROWEST or not self._budget.pays(self._price):
                return False
            queue.extend(_halves(span))
        return True

    def winding(self, vector: Callable[[CurveJet], Vector], order: int) -> int | None:
        """How often a vector that never vanishes turns around 0 while the angle runs once; None if that stays open.

        On an arc where the vector stays in the open half-plane of its value at the start, it turns by the angle between
        its values at the ends.
        """
        turned = [flint.arb(0)]

        def settled(span: Span) -> bool:
            start, end = (vector(self.over((x, x), order)) for x in span)
            lead = dot(start, vector(self.over(span, order)))
            within = bool(lead.is_finite() and lead > 0)
            turned.append(flint.arb.atan2(cross(start, end), dot(start, end)) if within else flint.arb(0))
            return within

        turns = (sum(turned) / (2 * flint.arb.pi())).unique_fmpz() if self._covered(16, settled, narrowest_first=True) else None
        return None if turns is None else int(turns)

    def greatest(self, quantity: Callable[[CurveJet], Sequence[Ball]], order: int, width: float) -> Greatest | None:
        """The greatest size of a quantity over all angles, to within ``width`` or as well as time allows; None if it stays open.

        ``quantity`` gives value, slope and second derivative; what is not finite says nothing.  Arcs that cannot hold the
        greatest size are dropped: their enclosure lies below one met, or their slope has one sign.
        """
        best, queue = flint.arb("-inf"), _pieces(32)
        found: Greatest | None = None
        while queue:
            kept: list[tuple[Span, Ball]] = []
            for span in queue:
                if not self._budget.pays(self._price):
                    return found
                middle = (span[0] + span[1]) / 2
                here, over = quantity(self.over((middle, middle), order)), quantity(self.over(span, order))
                if here[0].is_finite() and here[0].abs_lower() > best:
                    best = here[0].abs_lower()
                reach = flint.arb.pi() * ball((span[0] - span[1]) / 2, (span[1] - span[0]) / 2)
                slopes = (over[1], here[1] + over[2] * reach)
                if any(certain_sign(slope) in (1, -1) for slope in slopes):
                    continue
                bounds = [over[0], here[0] + slopes[0] * reach, here[0] + here[1] * reach + over[2] * reach * reach / 2]
                kept.append((span, min((x.abs_upper() for x in bounds if x.is_finite()), key=float, default=flint.arb("inf"))))
            kept = [(span, bound) for span, bound in kept if not bound < best]
            if not kept:
                return found
            if all(bound.is_finite() for _, bound in kept):
                top = max((bound for _, bound in kept), key=float)
                found = Greatest(best.union(top), tuple(sorted(span for span, _ in kept)))
                if float((top - best).upper()) < width:
                    return found
            queue = [half for span, _ in kept for half in _halves(span)] if len(kept) < _MOST // 4 else []
        return found


def normals(derivatives: Sequence[Vector]) -> list[Vector]:
    """Outward normals (T_b', -T_a') of a curve run counter-clockwise, from its derivatives 0, 1, 2, ...; one fewer."""
    return [(b, -a) for a, b in derivatives[1:]]


def _pieces(n: int) -> list[Span]:
    low, high = _TURN
    ends = [low + (high - low) * k / n for k in range(n + 1)]
    return list(pairwise(ends))


def _halves(span: Span) -> list[Span]:
    middle = (span[0] + span[1]) / 2
    return [(span[0], middle), (middle, span[1])]


def _bend(k: int, jet: CurveJet) -> Ball:
    return cross(jet.boundary[k], jet.boundary[k + 1])


class CurveSubject(Subject):
    """The curve over the cosine and sine of its angle, to be looked at for one choice of parameters."""

    law: ParametricCriterion

    def __init__(self, law: ParametricCriterion, effort: Fraction = EFFORTS["normal"]) -> None:
        super().__init__(_QUESTION_STEPS, effort)
        self.law = law
        self.cosine, self.sine = sp.Dummy("cos", real=True), sp.Dummy("sin", real=True)

    def check_defined(self) -> None:
        """Raise InputError where the boundary or the flow has no value for admitted parameter values, whatever the angle."""
        for values in self.choices(_LOOKED_AT):
            at = {**self.law.fixed_values(), **rationals(values)}
            for what, symbols in self._without_value(at):
                named = ", ".join(f"{x} = {at[x]}" for x in sorted(symbols, key=str))
                raise InputError(f"{what} has no value{f' at {named}' if named else ''}", where=self.law.name, remedy=_REMEDY)

    def _without_value(self, at: Mapping[sp.Symbol, sp.Rational]) -> Iterator[tuple[str, set[sp.Symbol]]]:
        """Parts of the law that have no value at a choice of parameters, with those that enter them."""
        for what, pair in (("boundary", self.law.boundary), ("flow", self.law.flow or ())):
            yield from ((f"the {what}", x.free_symbols & set(at)) for x in pair if defined_at(x, at) is None)
        for text, needs in self._stated:
            lost = (need for need in needs if need.symbols() <= set(at) and need.broken(at))
            yield from ((f"{text!r} {need.does} {formula(need.expr)}, which", need.symbols()) for need in lost)

    @cached_property
    def sense(self) -> int:
        """1 for a curve that is run counter-clockwise; -1 for one that is turned round here: its angle is minus the law's own.

        Either way of running it has the same points, each with the same flow.  A few points suggest which way shows more.
        """
        given = self._in_angle(self.law.boundary, self.sine)
        for values in self.choices(1):
            curve = self._numeric([x.xreplace(rationals(values)) for x in given], None)
            points = [curve.point(Fraction(k, 8)) for k in (-40, -16, -8, -4, 0, 4, 8, 16, 40)]
            if certain_sign(sum(cross(p, q) for p, q in zip(points, points[1:] + points[:1], strict=True))) == -1:
                return -1
        return 1

    @cached_property
    def boundary(self) -> Vector:
        """T over (cosine, sine) and the free parameters."""
        return self._in_angle(self.law.boundary, self.sense * self.sine)

    @cached_property
    def flow(self) -> Vector | None:
        """d likewise; None for an associated law."""
        return None if self.law.flow is None else self._in_angle(self.law.flow, self.sense * self.sine)

    def _in_angle(self, pair: Vector, sine: sp.Expr) -> Vector:
        turn, fixed = self.law.symbols()[self.law.angle], self.law.fixed_values()
        there = {sp.cos(turn): self.cosine, sp.sin(turn): sine}
        one, two = (algebraic_angles(x.xreplace(there)).xreplace(fixed) for x in pair)
        return one, two

    @cached_property
    def _stated(self) -> tuple[tuple[str, tuple[Obligation, ...]], ...]:
        """The components that were given as text, with what those ask of their parts, in the law's symbols."""
        known = self.law.symbols()
        return tuple((text, tuple(obligations(with_algebraic_angles(parse_as_written(text, known))))) for text in self.law.written if text)

    # -- one choice of parameters --------------------------------------------------------------------------------

    def simple_at(self, values: Values) -> bool:
        """Whether the curve is shown to be simple there, as convex or star-shaped about 0; its points then bound K.

        It turns left throughout where T' x T'' > 0, and runs around 0 in polar order where T x T' > 0.
        """
        return any(self.at(values).positive(partial(_bend, k), k + 1) and self.turns_at(values, k) == 1 for k in (1, 0))

    def turns_at(self, values: Values, derivative: int) -> int | None:
        """How often T (0) or T' (1) turns at one choice of parameters."""
        return self.at(values).winding(lambda j: j.boundary[derivative], derivative)

    def at(self, values: Values) -> NumericCurve:
        """The curve at exact values of the free parameters."""
        exact = rationals(values)
        boundary = [x.xreplace(exact) for x in self.boundary]
        flow = None if self.flow is None else [x.xreplace(exact) for x in self.flow]
        return self._numeric(boundary, flow)

    def _numeric(self, boundary: Sequence[sp.Expr], flow: Sequence[sp.Expr] | None) -> NumericCurve:
        """For one look around the curve: with half of the steps that are left."""
        return NumericCurve(boundary, flow, self.cosine, self.sine, self.budget.part(self.budget.left // 2))

    def choices(self, most: int) -> Iterator[Values]:
        """Exact values of the free parameters inside the domain: the plainest first, then ends of ranges and random ones over decades."""
        rng, domains = Random(7), {x: self.law.parameters[x.name] for x in self.free}
        plain = ({x: fraction(point[x]) for x in self.free} for point in simple_points(self.law))
        drawn = ({x: fraction(_drawn(domain, rng)) for x, domain in domains.items()} for _ in range(40 * most))
        every = chain(plain, super().choices(most), drawn) if self.free else [{}]
        yield from islice(filter(self.admits, every), most)


def _drawn(domain: Domain, rng: Random) -> sp.Rational:
    size = sp.Rational(round(10 ** rng.uniform(1, 3)), 100)
    if domain.low is None and domain.high is None:
        return rng.choice((-1, 1)) * size
    if domain.low is not None and domain.high is not None:
        return domain.low + (domain.high - domain.low) * sp.Rational(rng.randint(1, 99), 100)
    return domain.high - size if domain.low is None else domain.low + size
