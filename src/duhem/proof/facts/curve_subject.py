"""A law given by a boundary curve, under examination: the curve at choices of its parameters, and where it has no value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from itertools import chain, islice
from random import Random

import sympy as sp

from duhem.errors import InputError
from duhem.expression import defined_at, holds_at
from duhem.expression.angles import algebraic_angles
from duhem.expression.balls import certain_sign
from duhem.expression.number import fraction
from duhem.expression.parse import parse_as_written
from duhem.expression.text import formula
from duhem.law.curve_law import ParametricCriterion
from duhem.law.domain import Domain
from duhem.law.parameter_domain import simple_points
from duhem.proof.decide import EFFORTS
from duhem.proof.decide.needs import Obligation, obligations
from duhem.proof.facts.numeric_curve import STAR, TURNING, NumericCurve, Vector, cross
from duhem.proof.facts.parameter_choices import Values, rationals
from duhem.proof.facts.subject import Subject
from duhem.proof.statement.problem import with_algebraic_angles

__all__ = ["CurveSubject"]

_QUESTION_STEPS = 4_000_000
_REMEDY = "narrow the parameters' domains, or add a constraint, so that no such values are admitted"
_LOOKED_AT = 12  # parameter values at which it is seen whether the law has a value


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
            at = {**self.fixed, **rationals(values)}
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
        given = [self._here(algebraic_angles(self._in(x, self.sine))) for x in self.law.boundary]
        for values in self.choices(1):
            curve = self._numeric([x.xreplace(rationals(values)) for x in given], None)
            points = [curve.point(Fraction(k, 8)) for k in (-40, -16, -8, -4, 0, 4, 8, 16, 40)]
            if certain_sign(sum(cross(p, q) for p, q in zip(points, points[1:] + points[:1], strict=True))) == -1:
                return -1
        return 1

    @cached_property
    def given(self) -> tuple[sp.Basic, ...]:
        """The domain of the free parameters, as relations."""
        return tuple(r for r in (*self.ranges, *map(self._here, self.law.constraints)) if r != sp.true)

    @cached_property
    def boundary(self) -> Vector:
        """T over (cosine, sine) and the free parameters."""
        one, two = (self._here(self._in_angle(x)) for x in self.law.boundary)
        return one, two

    @cached_property
    def flow(self) -> Vector | None:
        """d likewise; None for an associated law."""
        if self.law.flow is None:
            return None
        one, two = (self._here(self._in_angle(x)) for x in self.law.flow)
        return one, two

    def _in_angle(self, expr: sp.Expr) -> sp.Expr:
        return algebraic_angles(self._in(expr, self.sense * self.sine))

    def _in(self, expr: sp.Expr, sine: sp.Expr) -> sp.Expr:
        turn = self.law.symbols()[self.law.angle]
        return expr.xreplace({sp.cos(turn): self.cosine, sp.sin(turn): sine})

    def _here(self, expr: sp.Expr) -> sp.Expr:
        return expr.xreplace(dict(self.fixed))

    @cached_property
    def _stated(self) -> tuple[tuple[str, tuple[Obligation, ...]], ...]:
        """The components that were given as text, with what those ask of their parts, in the law's symbols."""
        known = self.law.symbols()
        return tuple((text, tuple(obligations(with_algebraic_angles(parse_as_written(text, known))))) for text in self.law.written if text)

    # -- one choice of parameters --------------------------------------------------------------------------------

    def simple_at(self, values: Values) -> bool:
        """Whether the curve is shown to be simple there, as convex or star-shaped about 0; its points then bound K."""
        return any(self.at(values).positive(q.of, q.order) and self.turns_at(values, k) == 1 for q, k in ((TURNING, 1), (STAR, 0)))

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
        if not self.free:
            yield {}
            return
        rng = Random(7)
        domains = {x: self.law.parameters[x.name] for x in self.free}
        plain = [{x: point[x] for x in self.free} for point in simple_points(self.law)]
        middle = plain[-1]
        drawn = ({x: _drawn(domain, rng) for x, domain in domains.items()} for _ in range(40 * most))
        ends = ({**middle, x: end} for x in self.free for end in _closed_ends(domains[x]))
        others = chain.from_iterable(zip(ends, drawn))  # noqa: B905
        admitted = (point for point in chain(plain, others, drawn) if all(holds_at(r, point) for r in self.given))
        for point in islice(admitted, most):
            yield {x: fraction(value) for x, value in point.items()}


def _closed_ends(domain: Domain) -> Iterator[sp.Rational]:
    """The ends of a range that belong to it."""
    if domain.low is not None and not domain.positive:
        yield domain.low
    if domain.high is not None:
        yield domain.high


def _drawn(domain: Domain, rng: Random) -> sp.Rational:
    size = sp.Rational(round(10 ** rng.uniform(1, 3)), 100)
    if domain.low is None and domain.high is None:
        return rng.choice((-1, 1)) * size
    if domain.low is not None and domain.high is not None:
        return domain.low + (domain.high - domain.low) * sp.Rational(rng.randint(1, 99), 100)
    return domain.high - size if domain.low is None else domain.low + size
