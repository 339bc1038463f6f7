"""Whether a law's formula means something: its obligations, each decided over the whole domain and for all forces but zero.

A quotient that is 0/0 at zero force alone is taken by closure; the kernel takes one so that is 0/0 where a deviator is 0, if it
has a limit there.  A law that is undefined for admitted parameters, whatever the forces, is an error.  One that is undefined at
some forces does not have those points in K: of such a law, and of one for which the question stays open, nothing is proved.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import islice
from types import MappingProxyType
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression import UNDEFINED, Atan2, Where, holds_at
from duhem.expression.text import formula
from duhem.proof.decide import Question, Sense
from duhem.proof.decide.needs import Obligation, obligations
from duhem.proof.facts.parameter_choices import plain_choices, rationals
from duhem.proof.facts.subject import Subject
from duhem.proof.statement.problem import Problem

__all__ = ["broken_at", "met_at_zero", "met_for_all", "open_obligations"]

Point = dict[sp.Symbol, Any]
_REMEDY = "fix other values"
_MOST_POINTS = 64
_SIGNS = {sp.Ne: "!=", sp.Ge: ">=", sp.Gt: ">", sp.Le: "<=", sp.Lt: "<"}


def open_obligations(
    subject: Subject, problem: Problem, trees: Iterable[sp.Basic], there: tuple[sp.Basic, ...] = (), of: str = "g"
) -> tuple[Obligation, ...]:
    """Those of formulas of the law, as written, that are not shown to be met for all forces but zero, or for those of a place.

    Raises InputError where one is broken by admitted parameter values, whatever the forces and the pressure; ``of`` says whose it is.
    """
    if problem.g.has(*UNDEFINED):
        raise InputError(f"{formula(problem.law.g)} is undefined at the fixed values", where=problem.law.name, remedy=_REMEDY)
    needed = dict.fromkeys(o for tree in trees for o in obligations(tree))
    found = tuple(o for o in needed if not _everywhere(subject, problem, o, of))
    if not (found and there):
        return found
    return tuple(o for o in found if not _everywhere(subject, problem, o._replace(given=(*o.given, *there)), of))


def _everywhere(subject: Subject, problem: Problem, obligation: Obligation, of: str) -> bool:
    """Whether it is shown for all forces but zero; InputError where parameters alone break it."""
    if met_for_all(subject, problem, obligation):
        return True
    symbols = obligation.symbols()
    if symbols <= {x for x in problem.parameters if x is not problem.magnitude}:
        answer, told = subject.decided(_question(problem, *obligation.asked, obligation.given)), ""
        if (point := broken_at(problem, obligation, answer.point or {})) is not None:
            told = f"{'0' if obligation.expr.subs(point).is_zero else 'negative'} {f'at {_told(point)}' if point else 'always'}"
        elif ends := _on_either_side(problem, obligation):
            told = f"0 somewhere between {' and '.join(map(_told, ends))}"
        if told:
            what = f"{of} {obligation.does} {formula(obligation.expr)}, which is {told}"
            raise InputError(what, where=problem.law.name, remedy=_remedy(obligation))
    return False


def _told(point: Point) -> str:
    return ", ".join(f"{x} = {value}" for x, value in point.items())


def broken_at(problem: Problem, obligation: Obligation, hint: Mapping[sp.Symbol, Any] = MappingProxyType({})) -> Point | None:
    """Admitted parameters and a size of the pressure at which it certainly fails, whatever the forces; None where none were found."""
    symbols = obligation.symbols()
    if not symbols <= set(problem.parameters):
        return None
    points = [*_plain_points(problem, symbols), *([dict(hint)] if all(holds_at(r, hint) for r in problem.given) else [])]
    point = next((point for point in points if symbols <= point.keys() and obligation.broken(point)), None)
    return None if point is None else {x: point[x] for x in problem.parameters if x in symbols}


def _plain_points(problem: Problem, symbols: set[sp.Symbol]) -> list[Point]:
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


def _on_either_side(problem: Problem, obligation: Obligation) -> tuple[Point, Point] | None:
    """Points at which a divisor is above and below 0: over a product of intervals it is 0 in between, if it does not jump."""
    symbols, expr = obligation.symbols(), obligation.expr
    tied = expr.has(Where, Atan2) or obligation.given or any(c.free_symbols & symbols for c in problem.law.constraints)
    if obligation.sense is not Sense.ZERO or tied:
        return None
    points = _plain_points(problem, symbols)
    above, below = ([p for p in points if (side * expr.subs(p)).is_positive] for side in (1, -1))
    return (above[0], below[0]) if above and below else None


def met_for_all(subject: Subject, problem: Problem, obligation: Obligation) -> bool:
    """Whether it is shown for all forces but zero."""
    return obligation.met(lambda expr, sense, given: subject.decided(_question(problem, expr, sense, given)).holds is True)


def met_at_zero(subject: Subject, problem: Problem, obligation: Obligation) -> bool:
    """Whether it is shown at zero force."""
    return met_for_all(subject, problem, obligation.put(dict.fromkeys(problem.forces, sp.S.Zero)))


def _question(problem: Problem, expr: sp.Expr, sense: Sense, given: tuple[sp.Basic, ...]) -> Question:
    """For all forces but zero."""
    away = (sp.StrictGreaterThan(sp.Add(*(x**2 for x in problem.forces)), 0),) if expr.free_symbols & set(problem.forces) else ()
    return Question(expr, sense, (*problem.given, *given, *away))
