"""A law given by a formula, under examination: its problem, the forms that every method may need, the signs decided.

Whether the formula means something: its obligations are decided over the whole domain and for all forces but zero.  A quotient that is
0/0 at zero force alone is taken by closure; the kernel takes one so that is 0/0 where a deviator is 0, if it has a limit there.  A law that
is undefined for admitted parameters, whatever the forces, is an error.  One that is undefined at some forces does not have those points in
K: of such a law, and of one for which the question stays open, nothing is proved.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from itertools import chain, combinations, islice, tee
from typing import Any

import sympy as sp

from duhem.derivation.support_function import SupportFunction, support_function
from duhem.errors import InputError
from duhem.expression import UNDEFINED, Atan2, Where, defined_at, holds_at
from duhem.expression.branches import Branch, TooManyBranchesError, branches, plain_switches, smooth_below, thick
from duhem.expression.number import fraction, rational
from duhem.expression.text import formula
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import simple_points, solution
from duhem.proof.decide import EFFORTS, Answer, Budget, Question, Sense
from duhem.proof.decide.question import Obligation, obligations
from duhem.proof.facts.subject import Point, Subject, Values, middle_of, plain_choices, rationals, walk
from duhem.proof.in_state import Dissipating, power_of_rates
from duhem.proof.statement import Problem, state

__all__ = ["FormulaSubject", "RateSubject", "admitted_values"]

_QUESTION_STEPS = 8_000_000
_REMEDY = "fix other values"
_MOST_POINTS = 64
_GREATEST = 10**308
_SIGNS = {sp.Ne: "!=", sp.Ge: ">=", sp.Gt: ">", sp.Le: "<=", sp.Lt: "<"}
Place = dict[sp.Symbol, Any]


class FormulaSubject(Subject):
    """``problem`` is the law as stated, ``simple`` an equivalent slice of it (see :class:`duhem.proof.statement.Problem`)."""

    law: Criterion

    def __init__(
        self,
        law: Criterion,
        effort: Fraction = EFFORTS["normal"],
        whole: Budget | None = None,
        *,
        of: Criterion | None = None,
        state: Dissipating | None = None,
    ) -> None:
        """``law`` says in other forces what is claimed ``of`` a law with a state: then the kernel alone proves."""
        super().__init__(_QUESTION_STEPS, effort, whole)
        self.law, self.of, self.state = law, of or law, state
        self._choices = self._sought()

    @cached_property
    def problem(self) -> Problem:
        """The law as stated, with N = |sigma_n|."""
        return state(self.law)

    @cached_property
    def simple(self) -> Problem:
        """The simplest equivalent slice, for claims about the set K alone."""
        return self.problem.simplest()

    @cached_property
    def doubtful(self) -> tuple[Obligation, ...]:
        """What the formula as written asks of its parts and is not shown for all forces but zero: nothing is proved then."""
        return self.open_obligations((self.problem.stated,))

    @cached_property
    def doubtful_flow(self) -> tuple[Obligation, ...]:
        """The same of flows of the law's own, of which only that part of the boundary counts on which they act."""
        found = list[Obligation]()
        for i, (face, trees) in enumerate(zip(self.problem.faces, self.problem.stated_flows, strict=True), 1):
            of = f"the flow of surface {i}" if self.law.surfaces else "the flow"
            inside = (sp.LessThan(smooth, 0) for other in face.others for smooth in smooth_below(other))
            there = (sp.Eq(face.g, 0, evaluate=False), *(r for r in inside if isinstance(r, sp.LessThan)))
            found += self.open_obligations(trees, () if self.doubtful else there, of)
        return tuple(found)

    def power(self, flow: Sequence[sp.Expr]) -> sp.Expr:
        """What a flow dissipates: force . flow, or more where the law has a state (in the symbols of the problem as stated)."""
        if self.state is None:
            return sp.Add(*(x * d for x, d in zip(self.simple.forces, flow, strict=True)))
        return self.state.power.xreplace({**self.law.settled(), **self.problem.compressed}).xreplace(self.simple.slice)

    @property
    def doubted(self) -> tuple[sp.Basic, ...]:
        """The formulas as written of which something is doubtful."""
        return ((self.problem.stated,) if self.doubtful else ()) + (sum(self.problem.stated_flows, ()) if self.doubtful_flow else ())

    def check_defined(self) -> None:
        """Raise InputError where g or the flow is undefined for admitted parameter values, whatever the forces."""
        self.allow(4 * self._question_steps)
        _ = self.doubtful, self.doubtful_flow, self.at_origin

    def may_prove(self, claim: str) -> bool:
        """Of closed forms alone; one of a formula that may be undefined somewhere would be of another law."""
        plain = self.of is self.law and self.law.around_zero  # else the kernel alone knows what is written
        return claim == "duality" and plain and not self.doubtful and self.constraints_defined

    @property
    def onto(self) -> bool:
        """Whether all values of the forces are those of some state of the law."""
        return self.law.energy is None if self.state is None else self.state.onto

    def may_refute(self, claim: str, points: Mapping[str, Mapping[str, str]]) -> bool:
        """Whether all of them lie in the ranges of the law, and are those of a state."""
        if claim == "dissipation" and not (self.onto or all(self.of.variables.keys() <= point.keys() for point in points.values())):
            return False  # no state may have these forces
        return super().may_refute(claim, points)

    # -- whether it means something ------------------------------------------------------------------------------

    def open_obligations(self, trees: Iterable[sp.Basic], there: tuple[sp.Basic, ...] = (), of: str = "g") -> tuple[Obligation, ...]:
        """Those of formulas of the law, as written, that are not shown to be met for all forces but zero, or for those of a place.

        Raises InputError where one is broken by admitted parameter values, whatever the forces and the pressure; ``of`` says whose it is.
        """
        if self.problem.g.has(*UNDEFINED):
            raise InputError(f"{formula(self.law.g)} is undefined at the fixed values", where=self.law.name, remedy=_REMEDY)
        needed = dict.fromkeys(o for tree in trees for o in obligations(tree))
        found = tuple(o for o in needed if not self._everywhere(o, of))
        return tuple(o for o in found if not self._everywhere(o._replace(given=(*o.given, *there)), of)) if there else found

    def met(self, obligation: Obligation) -> bool:
        """Whether it is shown for all forces but zero."""
        return obligation.met(lambda *asked: self.decided(self._question(*asked)).holds is True)

    def _question(self, expr: sp.Expr, sense: Sense, given: tuple[sp.Basic, ...]) -> Question:
        """For all forces but zero."""
        forces = self.problem.forces
        away = (sp.StrictGreaterThan(sp.Add(*(x**2 for x in forces)), 0),) if expr.free_symbols & set(forces) else ()
        return Question(expr, sense, (*self.problem.given, *given, *away))

    def _everywhere(self, obligation: Obligation, of: str) -> bool:
        """Whether it is shown for all forces but zero; InputError where parameters alone break it."""
        problem = self.problem
        if self.met(obligation):
            return True
        if obligation.symbols() <= {x for x in problem.parameters if x is not problem.magnitude}:
            told = ""
            if (point := self.broken_at(obligation)) is not None:
                told = f"{'0' if obligation.expr.subs(point).is_zero else 'negative'} {f'at {_told(point)}' if point else 'always'}"
            elif ends := _on_either_side(problem, obligation):
                told = f"0 somewhere between {' and '.join(map(_told, ends))}"
            if told:
                what = f"{of} {obligation.does} {formula(obligation.expr)}, which is {told}"
                raise InputError(what, where=self.law.name, remedy=_remedy(obligation))
        return False

    def broken_at(self, obligation: Obligation) -> Place | None:
        """Admitted parameters and a size of the pressure at which it certainly fails, whatever the forces; None where none were found."""
        problem, symbols = self.problem, obligation.symbols()
        if not symbols <= set(problem.parameters):
            return None
        point = next((point for point in _plain_points(problem, symbols) if symbols <= point.keys() and obligation.broken(point)), None)
        return None if point is None else {x: point[x] for x in problem.parameters if x in symbols}

    # -- derived forms ------------------------------------------------------------------------------------------

    @cached_property
    def support(self) -> SupportFunction | None:
        """The support function of K in closed form, if there is one; what it requires is not decided."""
        return support_function(self.law)

    @cached_property
    def pieces(self) -> tuple[Branch, ...] | None:
        """Smooth branches of the simple problem's g with an inside; None if there are too many."""
        return _pieces(self.simple.g)

    @cached_property
    def continuous(self) -> bool:
        """Whether g is proved defined and continuous everywhere, so that the boundary of K lies on g = 0."""
        if self.pieces is None or any(self.ask(p.expr**2, Sense.NONNEGATIVE, *p.conditions()).holds is not True for p in self.pieces):
            return False
        return self.joined(self.simple.g)

    @cached_property
    def at_origin(self) -> sp.Expr | None:
        """g at zero force, all forces at once; None where that is 0/0 or otherwise undefined."""
        zero = dict.fromkeys(self.problem.forces, sp.S.Zero)
        if not all(self.met(o.put(zero)) for o in obligations(self.problem.stated)):
            return None
        return defined_at(self.simple.g, dict.fromkeys(self.simple.forces, sp.S.Zero))

    def joined(self, expr: sp.Expr) -> bool:
        """Whether an expression never jumps: built in without ``where``, else shown for every two branches where they meet."""
        if not expr.has(Where):
            return True
        try:
            pieces = branches(expr)
        except TooManyBranchesError:
            return False
        return all(
            self.ask(one.expr - two.expr, Sense.ZERO, *one.conditions(), *two.conditions()).holds is True
            for one, two in combinations(pieces, 2)
            if one.expr != two.expr
        )

    @property
    def stated(self) -> sp.Basic:
        """g as it is written, in the symbols of the problem as stated."""
        return self.problem.stated

    @property
    def nowhere(self) -> Point:
        """Zero force."""
        return (Fraction(0),) * len(self.simple.forces)

    def named(self, values: Values) -> dict[str, Fraction]:
        """The parameters that have one of the values, the forces and the pressure by their names in the law."""
        law, table, magnitude = self.law, self.law.symbols(), self.problem.magnitude
        found = {name: values[table[name]] for name in law.parameters if table[name] in values}
        load = {} if law.pressure is None or magnitude is None else {law.pressure: -values.get(magnitude, Fraction(1))}
        return {**found, **{str(x): values[x] for x in self.problem.forces}, **load}

    def values_at(self, parameters: Values, point: Sequence[Fraction]) -> dict[sp.Symbol, Fraction]:
        """Every symbol of the stated problem at a parameter choice and a point of the simple problem's force space."""
        fixed = {x: fraction(v) for x, v in self.simple.slice.items()}
        return {**fixed, **parameters, **dict(zip(self.simple.forces, point, strict=True))}

    def formula_at(self, parameters: Values) -> sp.Expr:
        """g of the simple problem at a parameter choice."""
        return self.simple.g.subs(rationals(parameters))

    def admits(self, values: Values) -> bool:
        """Whether the parameter values satisfy every relation of the law's domain, in exact arithmetic."""
        exact = rationals(values)
        positive = all(v > 0 for x, v in values.items() if x.is_positive) and all(v >= 0 for x, v in values.items() if x.is_nonnegative)
        return positive and all(holds_at(relation, exact) for relation in self.problem.given)

    def choices(self, most: int, hints: Sequence[Mapping[sp.Symbol, Any]] = ()) -> Iterator[Values]:
        """Exact parameter values inside the domain at which g is defined: hints first, then ``most`` others, the plainest first.

        Where constraints leave few plain ones, the rest are found step by step from solutions of the constraints.
        """
        free = self.simple.parameters
        hinted = [{x: fraction(hint[x]) for x in free} for hint in hints if all(x in hint for x in free)]
        told = [values for values in hinted if self.admits_choice(values)]
        yield from told
        self._choices, known = tee(self._choices)  # each is looked for once
        yield from (values for values in islice(known, most) if values not in told)

    def _sought(self) -> Iterator[Values]:
        """Those without hints."""
        free, seen = self.simple.parameters, list[Values]()
        for values in chain(plain_choices(free, self.simple.given), self._in_constraints()):
            if values not in seen and self.admits_choice(values):
                seen.append(values)
                yield values

    def _in_constraints(self) -> Iterator[Values]:
        """Solutions of the constraints with each parameter high or low in its range, and what lies around them."""
        free, given = self.simple.parameters, self.simple.given
        tied = [x for x in free if any(x in r.free_symbols for r in given if len(r.free_symbols) > 1)]
        if not tied:
            return
        starts = []
        plain = next(plain_choices(free, tuple(r for r in given if len(r.free_symbols) == 1)))
        halves = [half(x, rational(middle_of(x, given))) for x in tied for half in (sp.GreaterThan, sp.LessThan)]
        for half in (sp.true, *halves):
            point = solution(free, (*given, half)) or {}
            values = {x: fraction(point[x]) if x in tied and point else plain[x] for x in free}
            if self.admits_choice(values) and values not in starts:
                starts.append(values)
        yield from walk(starts, self.admits_choice)

    def admits_choice(self, values: Values) -> bool:
        """Whether the law admits the values, and g has a value with them in numbers that are not too large for doubles."""
        if not self.admits(self.values_at(values, self.nowhere)) or (here := defined_at(self.simple.g, rationals(values))) is None:
            return False
        return all(abs(number) < _GREATEST for number in here.atoms(sp.Rational))

    def ask(self, expr: sp.Expr, sense: Sense, *given: sp.Basic) -> Answer:
        """Decide ``expr sense 0`` over the parameter domain of the simple problem and further relations."""
        return self.decided(Question(sp.sympify(expr), sense, (*self.simple.given, *given)))

    def nonnegative(self, constant: sp.Expr) -> bool:
        """Whether an expression in the parameters is >= 0 on the whole domain (False also when undecided)."""
        return self.ask(constant, Sense.NONNEGATIVE).holds is True

    def positive(self, constant: sp.Expr) -> bool:
        """Whether an expression in the parameters is > 0 on the whole domain (False also when undecided)."""
        return self.ask(constant, Sense.POSITIVE).holds is True


class RateSubject(FormulaSubject):
    """A law whose forces are functions of the rates, which has no K; it is looked at in the space of rates."""

    def __init__(self, law: Criterion, effort: Fraction = EFFORTS["normal"]) -> None:
        super().__init__(power_of_rates(law), effort, of=law)


def _pieces(g: sp.Expr) -> tuple[Branch, ...] | None:
    found = thick(g)
    return None if found is None else plain_switches(found)


def _told(point: Place) -> str:
    return ", ".join(f"{x} = {value}" for x, value in point.items())


def _plain_points(problem: Problem, symbols: set[sp.Symbol]) -> list[Place]:
    """Admitted values of the symbols, which may be the parameters and the size of the pressure, and of what the relations tie to them."""
    own = _bearing_on(symbols, problem.given)
    names = tuple(x for x in problem.parameters if x in symbols.union(*(r.free_symbols for r in own)))
    tried = map(rationals, islice(plain_choices(names, own), _MOST_POINTS))
    return [point for point in tried if point.get(problem.magnitude, 1) > 0 and all(holds_at(r, point) for r in own)]


def _bearing_on(symbols: set[sp.Symbol], given: tuple[sp.Basic, ...]) -> tuple[sp.Basic, ...]:
    """The relations that speak of the symbols, of what those speak of besides, and so on."""
    own = tuple(r for r in given if r.free_symbols & symbols)
    wider = symbols.union(*(r.free_symbols for r in own))
    return own if wider == symbols else _bearing_on(wider, given)


def _remedy(obligation: Obligation) -> str:
    """The condition under which it is met, for one parameter alone as a bound of that."""
    expr, symbols = obligation.expr, obligation.expr.free_symbols
    if not symbols or obligation.instead:
        return "admit no such values"
    relation = {Sense.ZERO: sp.Ne, Sense.NONNEGATIVE: sp.Ge, Sense.POSITIVE: sp.Gt}[obligation.sense]
    (x, *others) = sorted(symbols, key=str)
    if others or not (expr.is_polynomial(x) and sp.degree(expr, x) == 1):
        return f"admit only values with {formula(expr)} {_SIGNS[relation]} 0"
    slope, rest = sp.Poly(expr, x).all_coeffs()
    bound, sign = -rest / slope, _SIGNS[relation if slope.is_positive else {sp.Ge: sp.Le, sp.Gt: sp.Lt}.get(relation, relation)]
    above_0 = bound.is_zero and sign in (">", "!=")
    return f"admit only values with {x} {sign} {formula(bound)}" + (" (positive = true, or a least value above 0)" if above_0 else "")


def _on_either_side(problem: Problem, obligation: Obligation) -> tuple[Place, Place] | None:
    """Places at which a divisor is above and below 0: over a product of intervals it is 0 in between, if it does not jump."""
    symbols, expr = obligation.symbols(), obligation.expr
    tied = expr.has(Where, Atan2) or obligation.given or any(c.free_symbols & symbols for c in problem.law.constraints)
    if obligation.sense is not Sense.ZERO or tied:
        return None
    points = _plain_points(problem, symbols)
    above, below = ([p for p in points if (side * expr.subs(p)).is_positive] for side in (1, -1))
    return (above[0], below[0]) if above and below else None


def admitted_values(law: Law) -> Mapping[str, str] | None:
    """Parameter values inside the domain, which show that a claim over it is not empty; None where no exact ones were found."""
    given = [*(r for x, domain in law.free().items() for r in domain.relations(x)), *law.constraints]
    for point in chain(simple_points(law), map(rationals, plain_choices(tuple(law.free()), given)), _in_the_slice(law)):
        whole = law.fixed_values() | dict(point)
        if all(holds_at(r, whole) for r in given):
            return {x.name: str(value) for x, value in whole.items()}
    return None


def _in_the_slice(law: Law) -> Iterator[Mapping[sp.Symbol, sp.Rational]]:
    """Where constraints leave no plain ones."""
    if isinstance(law, Criterion) and not law.forces_of_rates:
        subject = FormulaSubject(law)
        for found in subject.choices(1):
            values = rationals(subject.values_at(found, subject.nowhere))
            yield {x: value for x, value in values.items() if x.name in law.parameters}
