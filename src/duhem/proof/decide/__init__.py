"""Deciders of one question: is an expression >= 0 wherever some relations hold?

They are asked in this order: sign rules, z3 on polynomials, and z3 with a name for each part that is not algebraic, of which its sign, its
least and its greatest value are known.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import sympy as sp

from duhem.expression import UNDEFINED, Atan2, Norm
from duhem.expression.balls import ball, enclose
from duhem.expression.branches import TooManyBranchesError, branches
from duhem.expression.elementary import ELEMENTARY
from duhem.expression.number import MOST_ROOT
from duhem.expression.vocabulary import KINKS
from duhem.proof.decide.question import ANY_STEPS, EFFORTS, NEAR_RIGHT, Answer, Budget, Question, Sense, bounds, obligations
from duhem.proof.decide.smt import NotAlgebraicError, System, by_smt, polynomial_system

__all__ = ["ANY_STEPS", "EFFORTS", "POLYNOMIAL_DECIDERS", "Answer", "Budget", "Question", "Sense", "by_rules", "decide"]


# Asked in turn about polynomials with all obligations met; an answer that is not open is the last.  Each has an eighth of what is
# left: no answer was ever seen to take half of that.
POLYNOMIAL_DECIDERS: tuple[Callable[[System, Budget], Answer], ...] = (by_smt,)
_STEPS = 8_000_000  # for a question that belongs to no claim
_AT_SIGHT = {Sense.NONNEGATIVE: "is_nonnegative", Sense.POSITIVE: "is_positive", Sense.ZERO: "is_zero"}
_SIGNS = {word.node: word.sign_change for word in ELEMENTARY.values() if word.sign_change}


def decide(question: Question, budget: Budget | None = None) -> Answer:
    """Answer the question by the first method that succeeds within the budget; the answer names this method.

    Kinks are opened into branches; each must hold.
    """
    budget = budget or Budget(_STEPS)
    if any(e.has(*UNDEFINED) for e in (question.expr, *question.given)):
        return Answer(None, reason="the expression is undefined")
    if sp.false in question.given:
        return Answer(True, "vacuous")
    question = replace(question, given=tuple(r for r in question.given if r is not sp.true))
    quick = by_rules(question)
    if quick.holds:
        return quick
    if question.expr.has(*KINKS) or any(r.has(*KINKS) for r in question.given):
        return _by_branches(question, budget)
    try:
        return _decide_system(polynomial_system(question), budget)
    except NotAlgebraicError as fault:
        named = _named(question, budget.part(budget.left // 2))
        if named is not None and (answer := decide(named, budget.part(budget.left // 2))).holds:
            return answer  # else it says more than was asked
        return Answer(None, reason=str(fault))


def _by_branches(question: Question, budget: Budget) -> Answer:
    """Answer the question by deciding it on every smooth branch of its expression and hypotheses."""
    parts = sp.Tuple(question.expr, *(sp.Tuple(r.lhs, r.rhs) for r in question.given))
    try:
        pieces = branches(parts, 32)
    except TooManyBranchesError as fault:
        return Answer(None, "branches", reason=str(fault))
    method = ""

    def shown(expr: sp.Expr, sense: Sense, given: tuple[sp.Basic, ...]) -> bool:
        return decide(Question(expr, sense, (*question.given, *given), question.circle), budget).holds is True

    for need in question.hidden(piece.expr[0] for piece in pieces):
        if not need.met(shown):
            return Answer(None, reason=f"it is open whether {need.asked[0]} {need.asked[1].value} 0")
    for piece in pieces:
        expr, *sides = piece.expr
        given = tuple(type(r)(*pair) for r, pair in zip(question.given, sides, strict=True)) + piece.conditions()
        answer = decide(Question(expr, question.sense, given, question.circle), budget)
        if answer.holds is not True:
            return answer
        method = answer.method
    return Answer(True, method)


def _named(question: Question, budget: Budget) -> Question | None:
    """Return the question with a symbol in the place of each part that is not algebraic; hypotheses say what is known of its sign.

    Return None where there is no such part, or where one may have no value.  The new question asks for more than the old one.  It omits
    each hypothesis of which such a part may have no value.
    """
    plain = tuple(r for r in question.given if not any(_words(r)))

    def shown(expr: sp.Expr, sense: Sense, given: tuple[sp.Basic, ...] = ()) -> bool:
        return decide(Question(expr, sense, (*plain, *given), question.circle), budget.part(budget.left // 8)).holds is True

    def defined(part: sp.Basic) -> bool:
        return all(need.met(shown) for word in _words(part) for need in obligations(word))

    if not defined(question.expr):
        return None
    given = [r for r in question.given if r in plain or defined(r)]
    names: dict[sp.Expr, sp.Symbol] = {}
    sides: list[sp.Basic] = []
    for word in dict.fromkeys(word for part in (question.expr, *given) for word in _words(part)):
        names[word] = _name(word)
        sure = not isinstance(word, sp.tan) or all(shown(NEAR_RIGHT + s * word.args[0], Sense.POSITIVE) for s in (1, -1))  # of no pole
        if type(word) in _SIGNS and sure:
            value, place, sense = _SIGNS[type(word)]
            sides += _sides(names[word] - value, sense * (word.args[0] - place), shown)
        sides += _bounds(names[word], word, plain)
    if not names:
        return None
    return Question(question.expr.xreplace(names), question.sense, (*(r.xreplace(names) for r in given), *sides), question.circle)


def _words(expr: sp.Basic) -> Iterator[sp.Expr]:
    """Yield the largest parts of the expression that are not algebraic."""
    root = expr.is_Pow and expr.exp.is_Rational and expr.exp.q <= MOST_ROOT
    if root or isinstance(expr, sp.Add | sp.Mul | Norm | sp.Rel):
        for part in expr.args:
            yield from _words(part)
    elif not (expr.is_Symbol or expr.is_Rational):
        yield expr


def _bounds(name: sp.Expr, word: sp.Expr, given: tuple[sp.Basic, ...]) -> Iterator[sp.Basic]:
    """Yield the least and the greatest value of a word over the ranges of its symbols, as relations."""
    ranges = ((x, *bounds(x, given)) for x in word.free_symbols)
    within = {x: ball(low, high) for x, low, high in ranges if low is not None and high is not None}
    if within.keys() == word.free_symbols and (value := enclose(word, within)).is_finite():
        low, high = (sp.Rational(int(end.p), int(end.q)) for end in (value.lower().fmpq(), value.upper().fmpq()))
        yield from (name >= low, name <= high)


def _name(word: sp.Expr) -> sp.Symbol:
    """Return a new symbol with the sign that SymPy sees in the word."""
    signs = {"positive": True} if word.is_positive else {"nonnegative": word.is_nonnegative, "nonzero": word.is_nonzero}
    return sp.Dummy("w", real=True, **{sign: True for sign, known in signs.items() if known})


def _sides(name: sp.Expr, like: sp.Expr, shown: Callable[..., bool]) -> Iterator[sp.Basic]:
    """Yield the sign of the symbol ``name``, which is that of another expression, as relations."""
    for sign in (1, -1):
        if shown(sign * like, Sense.NONNEGATIVE):
            relation = sp.StrictGreaterThan if shown(sign * like, Sense.POSITIVE) else sp.GreaterThan
            yield relation(sign * name, 0)


def by_rules(question: Question) -> Answer:
    """Answer by sign rules: SymPy knows signs of sums and products of quantities whose sign the declared domains give."""
    expr = question.expr
    if not all(map(_meaningful, expr.atoms(sp.Pow, sp.log, sp.tan, sp.asin, sp.acos, Atan2))):
        return Answer(None, "sign-rules", reason="a part of it may be undefined")
    for form in (expr, sp.factor_terms(expr)):
        if getattr(form, _AT_SIGHT[question.sense]):
            return Answer(True, "sign-rules")
    return Answer(None, "sign-rules")


def _meaningful(node: Any) -> bool:
    """Return whether signs show that a power, a logarithm, a tangent, ... is a number: SymPy takes |log(x)| >= 0 to hold for all x."""
    if node.is_Pow:
        return bool(node.is_extended_real and (node.exp.is_nonnegative or node.base.is_nonzero))
    return bool(node.is_real)


def _decide_system(system: System, budget: Budget) -> Answer:
    for obligation in system.obligations:
        met = _decide_system(obligation, budget)
        if met.holds is not True:
            return Answer(None, met.method, reason=f"it is open whether {obligation.goal.poly} {obligation.goal.op} 0")
    answer = Answer(None)
    for decider in POLYNOMIAL_DECIDERS:
        answer = decider(system, budget.part(budget.left // 8))
        if answer.holds is not None:
            break
    return answer
