"""One question, decided by the kernel's signs: is an expression >= 0 wherever some relations hold?

The symbols are the parameters of a law that the kernel reads, and the relations are its constraints; or what nothing bounds are its forces.
What has no value somewhere has no sign.  A relation that may have no value keeps no point out, so that it is not used.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction

import sympy as sp
from sympy.core.relational import Relational

from duhem.expression import UNDEFINED
from duhem.expression.number import fraction
from duhem.expression.text import formula
from duhem.law.domain import Domain
from duhem.proof.decide.question import ANY_STEPS, EFFORTS, Answer, Budget, Question, Sense
from duhem.proof.kernel import obligations as needs
from duhem.proof.kernel.bounds import POSITIVE, ZERO, Bounds
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import Reader
from duhem.proof.kernel.domain import gap
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import UNREADABLE, Term, number, parse

__all__ = ["ANY_STEPS", "EFFORTS", "Answer", "Budget", "Question", "Sense", "decide", "defined"]

_STEPS = 8_000_000  # for a question that belongs to no claim
_MOST = 400_000  # steps of one question: what is shown at all takes fewer
_SIGNS = {Sense.NONNEGATIVE: POSITIVE | ZERO, Sense.POSITIVE: POSITIVE, Sense.ZERO: ZERO}
_COMPARED = {sp.Eq: ("<=", ">="), sp.Ne: ()}


def decide(question: Question, budget: Budget | None = None) -> Answer:
    """Answer yes where the kernel shows the sign within the budget; nothing else is ever answered."""
    budget = budget or Budget(_STEPS)
    if any(e.has(*UNDEFINED) for e in (question.expr, *question.given)):
        return Answer(None, reason="the expression is undefined")
    if sp.false in question.given:
        return Answer(True, "vacuous")
    with within(most := min(budget.left, _MOST)) as purse:
        try:
            holds = any(_holds(question, *reading) for reading in _readings(question))
            answer = Answer(True, "signs") if holds else Answer(None, "signs", reason="the signs of its parts do not tell")
        except TooDearError:
            answer = Answer(None, "signs", reason="its steps are spent")
        except UNREADABLE as fault:
            answer = Answer(None, "signs", reason=str(fault))
    budget.pays(min(most, purse.spent))
    return answer


def defined(constraints: Iterable[str], parameters: Mapping[str, Domain]) -> bool:
    """Whether each constraint has a value where the parameters lie in their ranges and those hold that are shown to have one before it."""
    ends = {x: [None if end is None else fraction(end) for end in (own.low, own.high)] for x, own in parameters.items()}
    ranges = {x: Bounds(low, high, parameters[x].positive) for x, (low, high) in ends.items()}
    try:
        return not needs.constraints(StatedLaw(("no force",), None, number(0), None, ranges, tuple(map(parse, constraints))))
    except UNREADABLE:
        return False


def _holds(question: Question, law: StatedLaw, sides: Mapping[Term, bool], term: Term) -> bool:
    """Whether a term has a value in the domain of a law, and one of the signs that are asked for."""
    domain = over(law).where(sides) if sides else over(law)
    square = question.expr.is_Pow and question.expr.exp.is_even and question.sense is Sense.NONNEGATIVE
    return Reader(domain).undecided(term) is None and (square or not domain.sign(term) & ~_SIGNS[question.sense])


def _readings(question: Question) -> Iterator[tuple[StatedLaw, Mapping[Term, bool], Term]]:
    """Laws in which the expression is a constant, and a function of the symbols that nothing bounds; with what is >= 0 or > 0."""
    given = (r for told in question.given for r in (told.args if isinstance(told, sp.And) else (told,)))
    relations = [r for r in given if isinstance(r, Relational)]
    symbols = question.expr.free_symbols.union(*(r.free_symbols for r in relations))
    names = {x: sp.Symbol(f"x{i}", real=True) for i, x in enumerate(sorted(symbols, key=sp.default_sort_key))}
    ranges = {x: _range(x, relations) for x in names}
    term = parse(formula(question.expr.xreplace(names)))
    compared = [(r, c) for r in relations if not _is_bound(r) for c in _comparisons(r.xreplace(names))]
    for moving in dict.fromkeys((frozenset[sp.Symbol](), frozenset(x for x in names if ranges[x] == Bounds(None, None)))):
        forces = tuple(y.name for x, y in names.items() if x in moving) or ("force",)
        law = StatedLaw(forces, None, term, None, {y.name: ranges[x] for x, y in names.items() if x not in moving}, ())
        told = (c for r, c in compared if not r.free_symbols & moving)
        law = law._replace(constraints=tuple(c for c in told if not needs.constraints(law._replace(constraints=(c,)))))
        sides = {gap(c): len(c.op) == 1 for r, c in compared if r.free_symbols & moving}
        yield law, {side: strict for side, strict in sides.items() if Reader(over(law)).undecided(side) is None}, term


def _is_bound(relation: Relational) -> bool:
    return isinstance(relation, sp.core.relational._Inequality) and relation.lhs.is_Symbol and relation.rhs.is_Rational


def _range(x: sp.Symbol, relations: Iterable[Relational]) -> Bounds:
    """Where a symbol lies, by its sign and the relations that bound it."""
    zero = Fraction(0)
    found = Bounds(zero if x.is_nonnegative else None, zero if x.is_nonpositive else None, bool(x.is_positive), bool(x.is_negative))
    for r in relations:
        if _is_bound(r) and r.lhs == x:
            end, strict = fraction(r.rhs), isinstance(r, sp.StrictGreaterThan | sp.StrictLessThan)
            found = found.above(end, strict) if r.rel_op.startswith(">") else found.below(end, strict)
    return found


def _comparisons(relation: Relational) -> Iterator[Term]:
    """The relation as comparisons that the kernel reads."""
    left, right = map(formula, relation.args)
    yield from (parse(f"{left} {op} {right}") for op in _COMPARED.get(type(relation), (relation.rel_op,)))
