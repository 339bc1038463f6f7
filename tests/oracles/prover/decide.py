"""Questions decided with SymPy and z3, which share nothing with the kernel: the second way for what it shows.

They are asked in this order: sign rules, z3 on polynomials, and z3 with a name for each part that is not algebraic, of which its sign, its
least and its greatest value are known.  z3 sees polynomials only, each root and each quotient being a variable with its defining equation.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import sympy as sp

from duhem.errors import InputError
from duhem.expression import UNDEFINED, Atan2, Norm, fold
from duhem.expression.balls import ball, enclose
from duhem.expression.branches import TooManyBranchesError, branches
from duhem.expression.elementary import ELEMENTARY
from duhem.expression.number import MOST_ROOT
from duhem.expression.smt import Reals
from duhem.expression.vocabulary import KINKS
from duhem.proof.decide import Answer, Budget, Question, Sense
from duhem.proof.decide.question import NEAR_RIGHT, Obligation, bounds, obligations
from duhem.proof.facts.formula_subject import FormulaSubject

__all__ = ["SIGNS", "AskedSubject", "Relation", "System", "by_smt", "counted", "decide", "polynomial_system", "stated_in"]

_STEPS = 8_000_000  # for a question that belongs to no claim
_AT_SIGHT = {Sense.NONNEGATIVE: "is_nonnegative", Sense.POSITIVE: "is_positive", Sense.ZERO: "is_zero"}
SIGNS = {  # (b, a, s): f(x) - b has the sign of s (x - a)
    **dict.fromkeys(("tan", "atan", "sinh", "tanh", "asin"), (0, 0, 1)), "exp": (1, 0, 1), "log": (0, 1, 1), "acos": (0, 1, -1),
}  # fmt: skip
_SIGNS = {ELEMENTARY[name].node: change for name, change in SIGNS.items()}


class AskedSubject(FormulaSubject):
    """A law under examination whose questions are decided here."""

    def decided(self, question: Question) -> Answer:
        """The answer, for as many steps as a question may have."""
        return decide(question, self.budget.part(self._question_steps))

    def may_prove(self, claim: str) -> bool:
        """Whether a proof of the second way counts; one of a formula that may be undefined somewhere would be of another law."""
        told = self.law.energy is None and not self.law.rates if claim == "dissipation" else True
        shown = not (self.doubtful or (claim in ("normality", "dissipation") and self.doubtful_flow))
        return told and shown and self.of is self.law and self.law.around_zero and self.constraints_defined

    def ask(self, expr: sp.Expr, sense: Sense, *given: sp.Basic, circle: tuple[sp.Symbol, sp.Symbol] | None = None) -> Answer:
        """Decide ``expr sense 0`` over the parameter domain of the simple problem and further relations, and on the unit circle."""
        on = () if circle is None else (sp.Eq(circle[0] ** 2 + circle[1] ** 2, 1),)
        return self.decided(Question(sp.sympify(expr), sense, (*self.simple.given, *given, *on)))


def _hidden(expr: sp.Expr, shown: Iterable[sp.Expr]) -> tuple[Obligation, ...]:
    """The obligations of a formula that some other form of it no longer has: abs(x)/x divides by x, and its form 1 does not."""
    needs = dict.fromkeys(obligations(expr))
    common = set(needs).intersection(*map(obligations, shown))
    return tuple(need for need in needs if need not in common)


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
        return decide(Question(expr, sense, (*question.given, *given)), budget).holds is True

    for need in _hidden(question.expr, [piece.expr[0] for piece in pieces]):
        if not need.met(shown):
            return Answer(None, reason=f"it is open whether {need.asked[0]} {need.asked[1].value} 0")
    for piece in pieces:
        expr, *sides = piece.expr
        given = tuple(type(r)(*pair) for r, pair in zip(question.given, sides, strict=True)) + piece.conditions()
        answer = decide(Question(expr, question.sense, given), budget)
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
        return decide(Question(expr, sense, (*plain, *given)), budget.part(budget.left // 8)).holds is True

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
    return Question(question.expr.xreplace(names), question.sense, (*(r.xreplace(names) for r in given), *sides))


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
    return by_smt(system, budget.part(budget.left // 8))


# -- polynomials ----------------------------------------------------------------------------------------------------


_OPS = {sp.GreaterThan: ">=", sp.StrictGreaterThan: ">", sp.LessThan: ">=", sp.StrictLessThan: ">", sp.Eq: "==", sp.Ne: "!="}


class NotAlgebraicError(Exception):
    """This is raised where a question has something else than polynomials, quotients and roots."""


@dataclass(frozen=True)
class Relation:
    """The relation ``poly op 0``, where op is one of ``>=``, ``>``, ``==``, ``!=``."""

    poly: sp.Expr
    op: str


@dataclass(frozen=True)
class System:
    """A question over polynomials: ``goal`` is wanted wherever all of ``given`` hold.

    ``obligations`` (divisors not 0, radicands >= 0) must be proved before a proof of the goal counts.
    """

    goal: Relation
    given: tuple[Relation, ...]
    obligations: tuple[System, ...]
    variables: tuple[sp.Symbol, ...]


class _Named(NamedTuple):
    """A root of what is >= 0, or 1 over what is not 0: its symbol, what that must meet beforehand, and what then defines it."""

    symbol: sp.Symbol
    needed: Relation
    defined: tuple[Relation, Relation]


class _Names:
    """Roots and reciprocals met so far, each after those in it."""

    def __init__(self) -> None:
        self.found: dict[tuple[sp.Expr, int], _Named] = {}

    def root(self, radicand: sp.Expr, q: int) -> sp.Expr:
        """Return a symbol rho >= 0 that stands for the root: rho^q = radicand."""
        if radicand.is_Rational and (exact := sp.root(radicand, q)).is_Rational:
            return exact
        if (radicand, q) not in self.found:
            rho = sp.Dummy(f"rho{len(self.found)}", nonnegative=True)
            defined = Relation(rho**q - radicand, "=="), Relation(rho, ">=")
            self.found[radicand, q] = _Named(rho, Relation(radicand, ">="), defined)
        return self.found[radicand, q].symbol

    def reciprocal(self, divisor: sp.Expr) -> sp.Expr:
        """Return a symbol r that stands for the quotient: r divisor = 1."""
        if divisor.is_Rational:
            if divisor == 0:
                raise NotAlgebraicError("division by zero")
            return 1 / divisor
        if (divisor, -1) not in self.found:
            r = sp.Dummy(f"r{len(self.found)}", real=True, **({"positive": True} if divisor.is_positive else {"nonzero": True}))
            defined = Relation(r * divisor - 1, "=="), Relation(r, ">" if r.is_positive else "!=")
            self.found[divisor, -1] = _Named(r, Relation(divisor, "!="), defined)
        return self.found[divisor, -1].symbol

    def rewrite(self, expr: sp.Basic) -> sp.Expr:
        """Return ``expr`` with a symbol in the place of every root and every quotient."""

        def power(_: sp.Basic, base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
            if not exponent.is_Rational or exponent.q > MOST_ROOT:
                raise NotAlgebraicError(f"the exponent {exponent} is not a number")
            root = base if exponent.is_Integer else self.root(base, int(exponent.q))
            return root**exponent.p if exponent.p >= 0 else self.reciprocal(root) ** -exponent.p

        def norm(_: sp.Basic, *args: sp.Expr) -> sp.Expr:
            return self.root(sp.Add(*(a**2 for a in args)), 2)

        def leaf(node: Any) -> sp.Expr:
            if node.is_Symbol or node.is_Rational:
                return node
            raise NotAlgebraicError(f"{node} is not algebraic")

        table: dict[type, Callable[..., sp.Expr]] = {sp.Pow: power, Norm: norm}
        table |= {kind: lambda node, *args: node.func(*args) for kind in (sp.Add, sp.Mul)}
        try:
            return fold(expr, table, leaf)
        except InputError as fault:
            raise NotAlgebraicError(fault.what) from None


def polynomial_system(question: Question) -> System:
    """Return the question over polynomials; raise NotAlgebraicError where it is not algebraic."""
    names = _Names()
    said = dict.fromkeys((names.rewrite(_gap(r)), _OPS[type(r)]) for r in question.given)
    given = [Relation(p, "==" if op == ">=" and (-p, op) in said else op) for p, op in said]  # z3 does not see that, and it costs much
    goal = Relation(names.rewrite(question.expr), question.sense.value)
    if question.sense is Sense.NONNEGATIVE and question.expr.is_Pow and question.expr.exp.is_even:
        goal = Relation(sp.S.Zero, ">=")  # a square: that it is defined is all there is to show
    named = names.found.values()
    relations = (goal, *given, *(r for one in named for r in (one.needed, *one.defined)))
    symbols = set().union(*(r.poly.free_symbols for r in relations))
    ordered = tuple(sorted(symbols, key=lambda s: (s.is_Dummy, sp.default_sort_key(s))))
    own = {one.symbol for one in named}
    given += [Relation(x, ">" if x.is_positive else ">=") for x in ordered if x.is_nonnegative and x not in own]
    obligations: list[System] = []
    for _, needed, defined in named:  # asked before it is defined: rho^2 x = 1 would show that x is not 0
        if not (needed.poly.is_nonnegative if needed.op == ">=" else needed.poly.is_nonzero):
            obligations.append(System(needed, tuple(given), (), ordered))
        given += defined
    return System(goal, tuple(given), tuple(obligations), ordered)


_HOLDS: Mapping[str, Callable[[Any, Any], Any]] = {
    ">=": operator.ge, ">": operator.gt, "<=": operator.le, "<": operator.lt, "==": operator.eq, "!=": operator.ne,
}  # fmt: skip


def stated_in(reals: Reals, expr: sp.Expr, op: str) -> Any:
    """The proposition ``expr op 0``."""
    return _HOLDS[op](reals.term(expr), 0)


def _gap(relation: Any) -> sp.Expr:
    return relation.lhs - relation.rhs if isinstance(relation, sp.Eq | sp.Ne) else relation.gts - relation.lts


_TACTIC = "qfnra-nlsat"  # complete for these questions, but may be slow
_MOST = 2**32 - 1  # z3 counts no further


def by_smt(system: System, budget: Budget) -> Answer:
    """Prove the goal, or deny it by a model of its negation."""
    import z3

    most = min(budget.left, _MOST)
    if not most:
        return Answer(None, "smt-z3", reason="its steps are spent")
    reals = Reals(system.variables)
    solver = z3.Tactic(_TACTIC, ctx=reals.context).solver()
    solver.set("rlimit", most)
    try:
        given, goal = [stated_in(reals, r.poly, r.op) for r in system.given], system.goal
        solver.add(*given, z3.Not(stated_in(reals, goal.poly, goal.op)))
        result = solver.check()
    except (z3.Z3Exception, ValueError) as fault:  # Python writes no number of thousands of digits as text
        result, reason = z3.unknown, str(fault)
    else:
        reason = f"z3: {solver.reason_unknown()}"
    budget.pays(most if result == z3.unknown else min(most, counted(solver, most)))
    if result == z3.unknown:
        return Answer(None, "smt-z3", reason=reason)
    return Answer(True, "smt-z3") if result == z3.unsat else Answer(False, "smt-z3")


def counted(solver: Any, otherwise: int) -> int:
    """Return how many steps the solver counted, or ``otherwise`` where it counted none."""
    found = solver.statistics()
    return int(found.get_key_value("rlimit count")) if "rlimit count" in found.keys() else otherwise  # noqa: SIM118
