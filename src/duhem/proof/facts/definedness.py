"""Whether a law's formula means something: its obligations, each decided over the whole domain and for all forces but zero.

A quotient that is 0/0 at zero force alone is taken by closure; the kernel takes one so that is 0/0 where a deviator is 0, if it
has a limit there.  A law that is undefined for admitted parameters, whatever the forces, is an error.  One that is undefined at
some forces does not have those points in K: of such a law, and of one for which the question stays open, nothing is proved.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice
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
    symbols = obligation.symbols()
    alone = symbols <= {x for x in problem.parameters if x is not problem.magnitude}
    if alone and not _plain(obligation):
        own = _bearing_on(symbols, problem.given)
        points = _plain_points(problem, symbols, own)
        _check(problem, obligation, own, points, of)
        _check_between(problem, obligation, points, of)
        answer = subject.decided(_question(problem, *obligation.asked, obligation.given))
        if answer.holds is False and answer.point is not None:
            _check(problem, obligation, problem.given, [dict(answer.point)], of)
    return met_for_all(subject, problem, obligation)


def _plain_points(problem: Problem, symbols: set[sp.Symbol], own: tuple[sp.Basic, ...]) -> list[Point]:
    """Admitted values of the symbols, which may be the parameters and the size of the pressure, and of what the relations tie to them."""
    names = tuple(x for x in problem.parameters if x in symbols.union(*(r.free_symbols for r in own)))
    tried = map(rationals, islice(plain_choices(names, own), _MOST_POINTS))
    return [point for point in tried if point.get(problem.magnitude, 1) > 0 and all(holds_at(r, point) for r in own)]


def broken_at(problem: Problem, obligation: Obligation) -> Point | None:
    """Admitted parameters and a size of the pressure at which it certainly fails, whatever the forces; None where none were found."""
    symbols = obligation.symbols()
    if not symbols <= set(problem.parameters):
        return None
    points = _plain_points(problem, symbols, _bearing_on(symbols, problem.given))
    return next(({x: point[x] for x in problem.parameters if x in symbols} for point in points if obligation.broken(point)), None)


def _bearing_on(symbols: set[sp.Symbol], given: tuple[sp.Basic, ...]) -> tuple[sp.Basic, ...]:
    """The relations that speak of the symbols, of what those speak of besides, and so on."""
    own = tuple(r for r in given if r.free_symbols & symbols)
    wider = symbols.union(*(r.free_symbols for r in own))
    return own if wider == symbols else _bearing_on(wider, given)


def _plain(obligation: Obligation) -> bool:
    """Whether the signs of its symbols show it."""
    expr, sense = obligation.expr, obligation.sense
    return bool(expr.is_positive or (sense is Sense.NONNEGATIVE and expr.is_nonnegative) or (sense is Sense.ZERO and expr.is_negative))


def _check(problem: Problem, obligation: Obligation, given: tuple[sp.Basic, ...], points: Iterable[Point], of: str) -> None:
    for point in points:
        whole = obligation.symbols().union(*(r.free_symbols for r in given)) <= set(point)
        if whole and all(holds_at(r, point) for r in given) and obligation.broken(point):
            at = ", ".join(f"{x} = {point[x]}" for x in problem.parameters if x in obligation.symbols())
            fault = "0" if obligation.expr.subs(point).is_zero else "negative"
            what = f"{of} {obligation.does} {formula(obligation.expr)}, which is {fault} {f'at {at}' if at else 'always'}"
            raise InputError(what, where=problem.law.name, remedy=_remedy(obligation))


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


def _check_between(problem: Problem, obligation: Obligation, points: Iterable[Point], of: str) -> None:
    """A divisor of both signs over a product of intervals is 0 in between, if it does not jump."""
    symbols = obligation.symbols()
    jumps = obligation.expr.has(Where, Atan2)
    if obligation.sense is not Sense.ZERO or jumps or obligation.given or any(c.free_symbols & symbols for c in problem.law.constraints):
        return
    above: Point | None = None
    below: Point | None = None
    for point in points:
        value = obligation.expr.subs(point)
        above, below = point if value.is_positive else above, point if value.is_negative else below
        if above is not None and below is not None:
            ends = " and ".join(", ".join(f"{x} = {end[x]}" for x in problem.parameters if x in symbols) for end in (above, below))
            what = f"{of} {obligation.does} {formula(obligation.expr)}, which is 0 somewhere between {ends}"
            raise InputError(what, where=problem.law.name, remedy=_remedy(obligation))


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
