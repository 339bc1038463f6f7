"""A law given by a boundary curve, under examination: which quantities are positive all around, and how often vectors turn."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cached_property
from itertools import chain, islice
from random import Random

import sympy as sp

from duhem.errors import InputError
from duhem.expression import UNDEFINED, defined_at, holds_at
from duhem.expression.angles import algebraic_angles
from duhem.expression.balls import certain_sign
from duhem.expression.number import fraction
from duhem.expression.parse import parse_as_written
from duhem.expression.text import formula
from duhem.expression.vocabulary import KINKS, Where
from duhem.law.curve_law import ParametricCriterion
from duhem.law.domain import Domain
from duhem.law.parameter_domain import simple_points
from duhem.proof.decide import EFFORTS, Answer, Budget, Question, Sense
from duhem.proof.decide.needs import Obligation, obligations
from duhem.proof.facts.numeric_curve import STAR, TURNING, CurveJet, NumericCurve, Quantity, Vector, cross, normals
from duhem.proof.facts.parameter_choices import Values, rationals
from duhem.proof.facts.subject import Subject
from duhem.proof.statement.problem import with_algebraic_angles

__all__ = ["CurveSubject"]

_QUESTION_STEPS = 4_000_000
_REMEDY = "narrow the parameters' domains, or add a constraint, so that no such values are admitted"
_LOOKED_AT = 12  # parameter values at which it is seen whether the law has a value
_MOST_VARIABLES = 6  # a question with more, radicals included, is beyond the deciders


class CurveSubject(Subject):
    """The curve over the cosine and sine of its angle, for all parameters together or at one choice of them."""

    law: ParametricCriterion

    def __init__(self, law: ParametricCriterion, effort: Fraction = EFFORTS["normal"]) -> None:
        super().__init__(_QUESTION_STEPS, effort)
        self.law = law
        self.cosine, self.sine = sp.Dummy("cos", real=True), sp.Dummy("sin", real=True)
        self._signs: dict[Quantity, str | None] = {}

    def check_defined(self) -> None:
        """Raise InputError where the boundary or the flow has no value for admitted parameter values, whatever the angle."""
        for values in self.choices(_LOOKED_AT):
            at = {**self.fixed, **rationals(values)}
            for what, pair in (("boundary", self.law.boundary), ("flow", self.law.flow or ())):
                for component in pair:
                    if defined_at(component, at) is None:
                        named = ", ".join(f"{x} = {at[x]}" for x in sorted(component.free_symbols & set(at), key=str))
                        raise InputError(
                            f"the {what} has no value{f' at {named}' if named else ''}",
                            where=self.law.name,
                            remedy=_REMEDY,
                        )
            for text, need in ((text, need) for text, needs in self._stated for need in needs):
                if need.symbols() <= set(at) and need.broken(at):
                    named = ", ".join(f"{x} = {at[x]}" for x in sorted(need.symbols(), key=str))
                    what = f"{text!r} {need.does} {formula(need.expr)}, which has no value{f' at {named}' if named else ''}"
                    raise InputError(what, where=self.law.name, remedy=_REMEDY)

    def may_prove(self, claim: str) -> bool:
        """Whether a proof counts; one of a curve that may have no value somewhere would be of another law."""
        return super().may_prove(claim) and self.defined

    @cached_property
    def sense(self) -> int:
        """1 for a curve that is run counter-clockwise; -1 for one that is turned round here: its angle is minus the law's own.

        Either way of running it has the same points, each with the same flow.  A few points suggest which way shows more.
        """
        given = [self._here(algebraic_angles(self._in(x, self.sine))) for x in self.law.boundary]
        for values in self.choices(1):
            curve = NumericCurve([x.xreplace(rationals(values)) for x in given], None, self.cosine, self.sine, self._share())
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
        if not self._free_in(quantity):
            values = next(self.choices(1), None)
            return "interval" if values is not None and self.at(values).positive(quantity.of, quantity.order) else None
        if any(x.has(*KINKS) for x in (*self.boundary, *(self.flow or ()))):
            return None  # a derivative might jump, and then signs say nothing of how it turns
        if not self.defined:
            return None
        if quantity.linear and self.flow is not None and (method := self._by_parts(quantity)):
            return method
        return self.ask(quantity.of(self._jet(self.boundary)), Sense.POSITIVE).method or None

    def _free_in(self, quantity: Quantity) -> bool:
        """Whether a free parameter enters the quantity; those that are linear in the boundary speak of the flow too."""
        told = (*self.boundary, *((self.flow or ()) if quantity.linear else ()))
        return any(x.free_symbols & set(self.free) for x in told)

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

    def nonnegative(self, quantity: Quantity) -> str:
        """The method by which the quantity is >= 0 at every angle and for every parameter value, or ""."""
        return self.ask(quantity.of(self._jet(self.boundary)), Sense.NONNEGATIVE).method if self.defined else ""

    @cached_property
    def defined(self) -> bool:
        """Whether boundary and flow are shown to have a value at every angle and for every parameter value.

        It is asked of both as they stand, or were written: in a product of the two, what one of them divides by may cancel.
        """
        needed = dict.fromkeys(o for x in (*self.boundary, *(self.flow or ())) for o in obligations(x))
        stated = dict.fromkeys(need for _, needs in self._stated for need in needs)
        return all(map(self._everywhere, needed)) and all(self._everywhere(self._need_here(need)) for need in stated)

    @cached_property
    def _stated(self) -> tuple[tuple[str, tuple[Obligation, ...]], ...]:
        """The components that were given as text, with what those ask of their parts, in the law's symbols."""
        known = self.law.symbols()
        return tuple((text, tuple(obligations(with_algebraic_angles(parse_as_written(text, known))))) for text in self.law.written if text)

    def _need_here(self, need: Obligation) -> Obligation:
        return need._replace(expr=self._here(self._in_angle(need.expr)), instead=tuple(map(self._need_here, need.instead)))

    def _everywhere(self, obligation: Obligation) -> bool:
        """Whether it is shown; what holds in one branch of a ``where`` alone is asked of all angles."""
        return obligation.met(lambda expr, sense, _: self.ask(expr, sense).method != "")

    def turns_once(self, derivative: int, sign: Quantity) -> bool:
        """Whether T (0) or T' (1), which never vanishes where ``sign`` > 0, turns once, for every parameter value.

        The number of turns cannot change over a connected domain; one without constraints is a product of intervals.  Where no free
        parameter enters the boundary it is one number.
        """
        cut = any(c.func(*c.args) != sp.true for c in self.law.constraints)  # one that holds of itself leaves all of the domain
        if self.shaped_by_parameters and (cut or any(x.has(Where) for x in self.boundary)):
            return False
        if self.positive(sign) is None:
            return False
        return any(self.turns_at(values, derivative) == 1 for values in self.choices(1))

    @property
    def shaped_by_parameters(self) -> bool:
        """Whether a free parameter enters the boundary."""
        return any(x.free_symbols & set(self.free) for x in self.boundary)

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
