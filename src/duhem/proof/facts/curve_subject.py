"""A law given by a boundary curve, under examination: which quantities are positive all around, and how often vectors turn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from functools import cached_property
from itertools import chain, islice
from random import Random

import sympy as sp

from duhem.expression import UNDEFINED, holds_at
from duhem.expression.angles import algebraic_angles
from duhem.expression.balls import certain_sign
from duhem.expression.number import fraction
from duhem.expression.vocabulary import Where
from duhem.law.curve_law import ParametricCriterion
from duhem.law.domain import Domain
from duhem.law.parameter_domain import simple_points
from duhem.proof.decide import EFFORTS, Answer, Budget, Question, Sense
from duhem.proof.facts.curve_quantities import STAR, TURNING, Quantity
from duhem.proof.facts.numeric_curve import CurveJet, NumericCurve, Vector, normals
from duhem.proof.facts.parameter_choices import Values, rationals
from duhem.proof.facts.subject import Subject

__all__ = ["CurveSubject"]

_QUESTION_STEPS = 4_000_000
_MOST_VARIABLES = 6  # a question with more, radicals included, is beyond the deciders


class CurveSubject(Subject):
    """The curve over the cosine and sine of its angle, for all parameters together or at one choice of them."""

    law: ParametricCriterion

    def __init__(self, law: ParametricCriterion, effort: Fraction = EFFORTS["normal"]) -> None:
        super().__init__(_QUESTION_STEPS, effort)
        self.law = law
        self.cosine, self.sine = sp.Dummy("cos", real=True), sp.Dummy("sin", real=True)
        self._signs: dict[Quantity, str | None] = {}

    @cached_property
    def free(self) -> tuple[sp.Symbol, ...]:
        """Parameters that are not fixed."""
        table = self.law.symbols()
        return tuple(table[name] for name, domain in self.law.parameters.items() if domain.value is None)

    @cached_property
    def fixed(self) -> Mapping[sp.Symbol, sp.Rational]:
        """Parameters that are."""
        table = self.law.symbols()
        return {table[name]: domain.value for name, domain in self.law.parameters.items() if domain.value is not None}

    @cached_property
    def given(self) -> tuple[sp.Basic, ...]:
        """The domain of the free parameters, as relations."""
        table = self.law.symbols()
        bounds = [r for name, domain in self.law.parameters.items() if domain.value is None for r in domain.relations(table[name])]
        return tuple(r for r in (*bounds, *(c.xreplace(dict(self.fixed)) for c in self.law.constraints)) if r != sp.true)

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
        turn = self.law.symbols()[self.law.angle]
        return algebraic_angles(expr.xreplace({sp.cos(turn): self.cosine, sp.sin(turn): self.sine}))

    def _here(self, expr: sp.Expr) -> sp.Expr:
        return expr.xreplace(dict(self.fixed))

    def _turned(self, v: Vector) -> Vector:
        c, s = self.cosine, self.sine
        one, two = (c * sp.diff(x, s) - s * sp.diff(x, c) for x in v)
        return one, two

    def _jet(self, boundary: Vector) -> CurveJet:
        first = self._turned(boundary)
        curve = (boundary, first, self._turned(first))
        return CurveJet(curve, (self.flow,) if self.flow is not None else tuple(normals(curve)))

    # -- all parameters --------------------------------------------------------------------------------------------

    def positive(self, quantity: Quantity) -> str | None:
        """The method by which the quantity is > 0 at every angle and for every parameter value, or None."""
        if quantity not in self._signs:
            self._signs[quantity] = self._positive(quantity)
        return self._signs[quantity]

    def _positive(self, quantity: Quantity) -> str | None:
        if not self.free:
            return "interval" if self.at({}).positive(quantity.of, quantity.order) else None
        if any(x.has(Where) for x in (*self.boundary, *(self.flow or ()))):
            return None  # it might jump, and then signs say nothing of how it turns
        if quantity.linear and self.flow is not None and (method := self._by_parts(quantity)):
            return method
        return self.ask(quantity.of(self._jet(self.boundary)), Sense.POSITIVE).method or None

    def _by_parts(self, quantity: Quantity) -> str | None:
        """Sum of parts: each is greater than what it is without its own parameters, and what is left is >= 0.

        Parts have no parameter in common but those common to all terms; "without" means with these put to 0.
        """
        used: set[str] = set()
        left = sp.S.Zero
        for part, own in self._parts():
            whole = quantity.of(self._jet(part))
            if not own:
                left += whole
                continue
            bare = whole.subs(dict.fromkeys(own, 0))
            if bare.has(*UNDEFINED):
                return None
            answer = self.ask(self._here(whole - bare), Sense.POSITIVE)
            if not answer.method:
                return None
            used.add(answer.method)
            left += bare
        settled = self.ask(self._here(sp.simplify(left)), Sense.NONNEGATIVE)
        return ", ".join(sorted(used)) if used and settled.method else None

    def _parts(self) -> Iterator[tuple[Vector, set[sp.Symbol]]]:
        """The boundary as a sum of vectors, each with the parameters that are its own, fixed ones included."""
        table = self.law.symbols()
        known = {table[name] for name in self.law.parameters}
        terms = [(i, term) for i, x in enumerate(self.law.boundary) for term in sp.Add.make_args(sp.expand(self._in_angle(x), deep=False))]
        named = [(i, term, term.free_symbols & known) for i, term in terms]
        common = known.intersection(*(names for *_, names in named))
        groups: list[tuple[set[sp.Symbol], list[tuple[int, sp.Expr]]]] = []
        for i, term, names in named:
            own, members = names - common, [(i, term)]
            for group in [g for g in groups if g[0] & own or not (g[0] or own)]:
                groups.remove(group)
                own, members = own | group[0], members + group[1]
            groups.append((own, members))
        for own, members in groups:
            one, two = (sp.Add(*(term for i, term in members if i == k)) for k in (0, 1))
            yield (one, two), own

    def ask(self, expr: sp.Expr, sense: Sense) -> Answer:
        """Decide a sign over all angles and parameters; an answer without a method where that was not proved."""
        core = sp.factor_terms(sp.sympify(expr))
        if sense is not Sense.ZERO:
            core = sp.Mul(*(f for f in sp.Mul.make_args(core) if not f.is_positive))
        radicals = {p.base for p in core.atoms(sp.Pow) if not p.exp.is_Integer}
        names = core.free_symbols
        if len(names) + len(radicals) > _MOST_VARIABLES:
            return Answer(None, reason="too many variables")
        given = tuple(r for r in self.given if r.free_symbols <= names)
        answer = self.decided(Question(core, sense, given, (self.cosine, self.sine)))
        return answer if answer.holds is True else Answer(None, reason=answer.reason)

    def vanishes(self, quantity: Quantity) -> bool:
        """Whether the quantity is 0 at every angle and for every parameter value."""
        for values in self.choices(1):  # a look at one point spares the algebra
            if certain_sign(quantity.of(self.at(values).at(Fraction(1, 3), quantity.order))) in (1, -1):
                return False
        return self.ask(sp.simplify(quantity.of(self._jet(self.boundary))), Sense.ZERO).method != ""

    def turns_once(self, derivative: int, sign: Quantity) -> bool:
        """Whether T (0) or T' (1), which never vanishes where ``sign`` > 0, turns once, for every parameter value.

        The number of turns cannot change over a connected domain; one without constraints is a product of intervals.
        """
        if self.free and (self.law.constraints or any(x.has(Where) for x in self.boundary)):
            return False
        if self.positive(sign) is None:
            return False
        return any(self.turns_at(values, derivative) == 1 for values in self.choices(1))

    def turns_at(self, values: Values, derivative: int) -> int | None:
        """How often T (0) or T' (1) turns at one choice of parameters."""
        return self.at(values).winding(lambda j: j.boundary[derivative], derivative)

    def simple_at(self, values: Values) -> bool:
        """Whether the curve is shown to be simple there, as convex or star-shaped about 0; its points then bound K."""
        return any(self.at(values).positive(q.of, q.order) and self.turns_at(values, k) == 1 for q, k in ((TURNING, 1), (STAR, 0)))

    def flow_turns(self) -> int | None:
        """How often the flow turns, where it is one field for all parameters."""
        if self.flow is None or any(x.free_symbols & set(self.free) for x in self.flow):
            return None
        return NumericCurve(self.flow, None, self.cosine, self.sine, self._share()).winding(lambda j: j.boundary[0], 0)

    def _share(self) -> Budget:
        """For one look around the curve: half of what is left."""
        return self.budget.part(self.budget.left // 2)

    # -- one choice of parameters --------------------------------------------------------------------------------

    def at(self, values: Values) -> NumericCurve:
        """The curve at exact values of the free parameters."""
        exact = rationals(values)
        boundary = [x.xreplace(exact) for x in self.boundary]
        flow = None if self.flow is None else [x.xreplace(exact) for x in self.flow]
        return NumericCurve(boundary, flow, self.cosine, self.sine, self._share())

    def choices(self, most: int) -> Iterator[Values]:
        """Exact values of the free parameters inside the domain: the plainest first, then at random over decades."""
        if not self.free:
            yield {}
            return
        rng = Random(7)
        domains = {x: self.law.parameters[x.name] for x in self.free}
        plain = ({x: point[x] for x in self.free} for point in simple_points(self.law))
        drawn = ({x: _drawn(domain, rng) for x, domain in domains.items()} for _ in range(40 * most))
        admitted = (point for point in chain(plain, drawn) if all(holds_at(r, point) for r in self.given))
        for point in islice(admitted, most):
            yield {x: fraction(value) for x, value in point.items()}


def _drawn(domain: Domain, rng: Random) -> sp.Rational:
    size = sp.Rational(round(10 ** rng.uniform(1, 3)), 100)
    if domain.low is None and domain.high is None:
        return rng.choice((-1, 1)) * size
    if domain.low is not None and domain.high is not None:
        return domain.low + (domain.high - domain.low) * sp.Rational(rng.randint(1, 99), 100)
    return domain.high - size if domain.low is None else domain.low + size
