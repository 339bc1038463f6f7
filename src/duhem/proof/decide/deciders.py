"""The deciders in the order they are asked: sign rules, exact cells on the line and in the plane, z3, enclosures."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy as sp

from duhem.expression import Atan2, Neg, Pos, Where
from duhem.expression.branches import TooManyBranchesError, branches
from duhem.expression.factoring import factor_list
from duhem.proof.decide.budget import Budget, SpentError
from duhem.proof.decide.exact import by_exact
from duhem.proof.decide.polynomials import NotAlgebraicError, Relation, System, polynomial_system
from duhem.proof.decide.question import Answer, Question, Sense, asked_of
from duhem.proof.decide.rays import between_rays
from duhem.proof.decide.smt import by_smt

__all__ = ["POLYNOMIAL_DECIDERS", "decide"]

# Asked in turn, each with half of what is left, about polynomials with all obligations met; an answer that is not open is the last.
POLYNOMIAL_DECIDERS: tuple[Callable[[System, Budget], Answer], ...] = (by_exact, by_smt)
_STEPS = 8_000_000  # for a question that belongs to no claim
_KINKS = (sp.Abs, sp.Max, sp.Min, Pos, Neg, Where)
_BEYOND = (sp.exp, sp.tan)
_NEAR_RIGHT = sp.Rational(3, 2)  # an angle below pi/2
_AT_SIGHT = {Sense.NONNEGATIVE: "is_nonnegative", Sense.POSITIVE: "is_positive", Sense.ZERO: "is_zero"}
# What has the sign of a word of x.
_SIGNS: dict[type, Callable[[sp.Expr], sp.Expr]] = {
    **dict.fromkeys((sp.sinh, sp.tanh, sp.asin, sp.atan), lambda x: x),
    sp.acos: lambda x: 1 - x,
    sp.log: lambda x: x - 1,
}


def decide(question: Question, budget: Budget | None = None) -> Answer:
    """Answer the question by the first method that can within the budget; the answer names it.

    Kinks are opened into branches, products of unrelated factors into their factors; each part must hold.
    """
    budget = budget or Budget(_STEPS)
    if sp.false in question.given:
        return Answer(True, "vacuous")
    if sp.true in question.given:
        given = tuple(r for r in question.given if r is not sp.true)
        question = Question(question.expr, question.sense, given, question.circle)
    quick = by_rules(question)
    if quick.holds:
        return quick
    if question.expr.has(*_KINKS) or any(r.has(*_KINKS) for r in question.given):
        return _by_branches(question, budget)
    match between_rays(question, budget):
        case Question() as question:
            pass
        case Answer() as answer:
            return answer
    try:
        system = polynomial_system(question, budget.part(budget.left // 4))
    except (NotAlgebraicError, SpentError) as fault:
        answer = _by_factors(question, budget)
        if answer.holds is None and (wider := _beyond_words(question, budget.part(budget.left // 2))) is not None:
            answer = decide(wider, budget.part(budget.left // 2))
            answer = answer if answer.holds else Answer(None, answer.method, reason=answer.reason)  # it says more than was asked
        if answer.holds is None:
            answer = _by_argument(question, budget)
        if answer.holds is None:
            answer = _enclosed(question, budget)
        return answer if answer.holds is not None else Answer(None, answer.method, reason=f"{fault}; {answer.reason}")
    answer = _decide_system(system, budget)
    if answer.holds is None:
        enclosed = _enclosed(question, budget)
        return enclosed if enclosed.holds is not None else answer
    return answer


def _by_branches(question: Question, budget: Budget) -> Answer:
    """The question on every smooth branch of its expression and hypotheses."""
    parts = sp.Tuple(question.expr, *(sp.Tuple(r.lhs, r.rhs) for r in question.given))
    try:
        pieces = branches(parts, 32)
    except TooManyBranchesError as fault:
        return Answer(None, "branches", reason=str(fault))
    method = ""
    for hidden in question.hidden(piece.expr[0] for piece in pieces):
        if (answer := decide(hidden, budget)).holds is not True:
            return Answer(None, answer.method, reason=f"it is open whether {hidden.expr} {hidden.sense.value} 0")
    for piece in pieces:
        expr, *sides = piece.expr
        given = tuple(type(r)(*pair) for r, pair in zip(question.given, sides, strict=True)) + piece.conditions()
        answer = decide(Question(expr, question.sense, given, question.circle), budget)
        if answer.holds is not True:
            return answer
        method = answer.method
    return Answer(True, method)


def _by_factors(question: Question, budget: Budget) -> Answer:
    """A product is >= 0 (or > 0) if each factor is, each under the hypotheses that speak of its symbols alone."""
    factors = sp.Mul.make_args(question.expr)
    if question.sense is Sense.ZERO or len(factors) < 2:
        return Answer(None, "factors", reason="it is not a product")
    method = ""
    for factor in factors:
        related = tuple(r for r in question.given if r.free_symbols <= factor.free_symbols)
        answer = decide(Question(factor, question.sense, related, None), budget)
        if answer.holds is not True:
            return Answer(None, "factors", reason=answer.reason)
        method = answer.method if answer.method != "sign-rules" else method or answer.method
    return Answer(True, method)


def _by_argument(question: Question, budget: Budget) -> Answer:
    """A monotone word has the sign of its argument less the place where it is 0, and must be defined."""
    scale, word = question.expr.as_coeff_Mul()
    wanted = _SIGNS.get(type(word))
    if wanted is None or question.sense is Sense.ZERO:
        return Answer(None, "monotone", reason="it is no monotone word")
    x, method = word.args[0], ""
    for expr, sense in ((sp.sign(scale) * wanted(x), question.sense), *asked_of(word)):
        answer = decide(Question(expr, sense, question.given, question.circle), budget)
        if answer.holds is not True:
            return Answer(None, "monotone", reason=answer.reason)
        method = answer.method
    return Answer(True, method)


def _beyond_words(question: Question, budget: Budget) -> Question | None:
    """The question with any number on its side of 1, or of 0, for each exponential or tangent whose argument has a known sign."""
    swap: dict[sp.Expr, sp.Expr] = {}
    sides: list[sp.Basic] = []
    known = sp.Tuple(question.expr, *question.given) if question.expr.has(*_BEYOND) else sp.Tuple()
    for node in sorted(known.atoms(*_BEYOND), key=sp.default_sort_key):
        x, name = node.args[0], sp.Dummy(node.func.__name__, positive=node.func is sp.exp or None, real=True)
        if node.func is sp.tan and not all(_shown(_NEAR_RIGHT + side, question, budget) for side in (x, -x)):
            continue
        if _shown(-x, question, budget):
            relation = sp.StrictLessThan if x.is_nonzero else sp.LessThan
        elif _shown(x, question, budget):
            relation = sp.StrictGreaterThan if x.is_nonzero else sp.GreaterThan
        else:
            continue
        swap[node] = name
        sides.append(relation(name, 1 if node.func is sp.exp else 0))
    if not swap:
        return None
    return Question(question.expr.xreplace(swap), question.sense, (*(r.xreplace(swap) for r in question.given), *sides), question.circle)


def _shown(x: sp.Expr, question: Question, budget: Budget) -> bool:
    """Whether an argument is >= 0, by the hypotheses without such words."""
    given = tuple(r for r in question.given if not r.has(*_BEYOND))
    return decide(Question(x, Sense.NONNEGATIVE, given), budget.part(budget.left // 8)).holds is True


def _enclosed(question: Question, budget: Budget) -> Answer:
    from duhem.proof.decide.enclosure import by_enclosure

    return by_enclosure(question, budget.part(budget.left // 2))


def by_rules(question: Question) -> Answer:
    """Sign rules: sums and products of quantities whose sign is known from the declared domains."""
    expr = question.expr
    if not all(map(_meaningful, expr.atoms(sp.Pow, sp.log, sp.tan, sp.asin, sp.acos, Atan2))):
        return Answer(None, "sign-rules", reason="a part of it may be undefined")
    for form in (expr, sp.factor_terms(expr)):
        if getattr(form, _AT_SIGHT[question.sense]):
            return Answer(True, "sign-rules")
    return Answer(None, "sign-rules")


def _meaningful(node: Any) -> bool:
    """Whether signs show that a power, a logarithm, a tangent, ... is a number: SymPy has |log(x)| >= 0 for all x."""
    if node.is_Pow:
        return bool(node.is_extended_real and (node.exp.is_nonnegative or node.base.is_nonzero))
    return bool(node.is_real)


def _decide_system(system: System, budget: Budget) -> Answer:
    for obligation in system.obligations:
        met = _decide_system(obligation, budget)
        if met.holds is not True:
            return Answer(None, met.method, reason=f"it is open whether {obligation.goal.poly} {obligation.goal.op} 0")

    def answered(goal: Relation, given: tuple[Relation, ...]) -> Answer:
        part = System(goal, given, (), system.variables, system.circle)
        answer = Answer(None)
        for decider in POLYNOMIAL_DECIDERS:
            try:
                answer = decider(part, budget.part(budget.left // 2))
            except SpentError as fault:
                answer = Answer(None, reason=str(fault))
            if answer.holds is not None:
                break
        return answer

    used = ""
    for goal, away in _factors(system, budget):
        answer = answered(goal, system.given)
        if answer.holds is False and away:  # perhaps only where a factor that was left out vanishes
            answer = answered(goal, (*system.given, *away))
        if answer.holds is not True:
            return answer
        used = used if used == "smt-z3" else answer.method
    return Answer(True, used or "identity")


def _factors(system: System, budget: Budget) -> tuple[tuple[Relation, tuple[Relation, ...]], ...]:
    """Goals that together are the system's, each with what may be assumed for it.

    Factors whose sign is plain are left out of the core; where one of them vanishes the core may have any sign (if the goal
    is weak), so that it does not vanish may be assumed.
    """
    goal = system.goal
    if goal.poly.is_number:
        return () if goal.holds() else ((goal, ()),)
    if goal.op in ("==", "!=") or not budget.part(budget.left // 8).pays(_factoring(goal.poly)):
        return ((goal, ()),)
    coefficient, factors = factor_list(goal.poly)
    core, away = sp.Integer(sp.sign(coefficient)), []
    for factor, power in factors:
        if factor.is_positive:
            continue
        if power % 2 == 0 or factor.is_nonnegative:
            away.append(Relation(factor, "!="))
            continue
        core *= factor
    main = Relation(sp.expand(core), goal.op)
    extra = tuple((relation, ()) for relation in away) if goal.op == ">" else ()
    if main.poly.is_number and main.holds():
        return extra
    return (*extra, (main, tuple(away)))


def _factoring(poly: sp.Expr) -> int:
    """Steps of the factors of a polynomial, by its terms, degree and variables."""
    form = sp.Poly(poly)
    return 10 * len(form.terms()) * form.total_degree() * len(form.gens)
