"""An algebraic question as polynomials, and z3 on it: the negation of the goal together with the hypotheses must be unsatisfiable.

Encodings as measured: polynomials only, each root and each quotient a variable with its defining equation.  What cannot be written so
(exp, tanh, a symbolic exponent, a kink) raises NotAlgebraicError.
``unknown`` decides nothing; a model is only a hint for the witness search.  z3 is stopped by its own count of steps.  It
counts nothing for long stretches of some resultants, though, and nothing tells beforehand which: a net of processor time, many
times what a counted step takes, ends those.  No answer was ever seen to take half of it, on a busy machine or an idle one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Event, Thread
from time import process_time
from typing import Any, NamedTuple

import sympy as sp

from duhem.errors import InputError
from duhem.expression import Norm, fold
from duhem.expression.number import MOST_ROOT
from duhem.expression.smt import Reals
from duhem.proof.decide.question import Answer, Budget, Question, Sense

__all__ = ["NotAlgebraicError", "Relation", "System", "by_smt", "counted", "polynomial_system"]

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
    """Roots and reciprocals met so far, each after those in it; on a circle the sum of its squares is 1."""

    def __init__(self, circle: tuple[sp.Symbol, sp.Symbol] | None = None) -> None:
        self._one = None if circle is None else sp.Add(*(x**2 for x in circle))
        self.found: dict[tuple[sp.Expr, int], _Named] = {}

    def root(self, radicand: sp.Expr, q: int) -> sp.Expr:
        """Return a symbol rho >= 0 that stands for the root: rho^q = radicand."""
        if radicand == self._one:
            return sp.S.One
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
    names = _Names(question.circle)
    said = dict.fromkeys((names.rewrite(_gap(r)), _OPS[type(r)]) for r in (*question.given, *question.on_circle()))
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


def _gap(relation: Any) -> sp.Expr:
    return relation.lhs - relation.rhs if isinstance(relation, sp.Eq | sp.Ne) else relation.gts - relation.lts


_TACTIC = "qfnra-nlsat"  # complete for these questions, but may be slow
_MOST = 2**32 - 1  # z3 counts no further
_NET = 3  # microseconds of the processor for each step of the budget; a counted step takes less than one


def by_smt(system: System, budget: Budget) -> Answer:
    """Prove the goal, or return a model of its negation as a hint."""
    import z3

    most = min(budget.left, _MOST)
    if not most:
        return Answer(None, "smt-z3", reason="its steps are spent")
    reals = Reals(system.variables)
    solver = z3.Tactic(_TACTIC, ctx=reals.context).solver()
    solver.set("rlimit", most)
    try:
        solver.add(*(reals.relation(r.poly, r.op) for r in system.given), z3.Not(reals.relation(system.goal.poly, system.goal.op)))
        with _net(reals.context, _NET * most):
            result = solver.check()
    except (z3.Z3Exception, ValueError) as fault:  # Python writes no number of thousands of digits as text
        result, reason = z3.unknown, str(fault)
    else:
        reason = f"z3: {solver.reason_unknown()}"
    if "keyboard" in reason:  # z3 takes Ctrl-C for itself
        raise KeyboardInterrupt
    budget.pays(most if result == z3.unknown else min(most, counted(solver, most)))
    if result == z3.unknown:
        return Answer(None, "smt-z3", reason=reason)
    return Answer(True, "smt-z3") if result == z3.unsat else Answer(False, "smt-z3", point=reals.point(solver.model()))


def counted(solver: Any, otherwise: int) -> int:
    """Return how many steps the solver counted, or ``otherwise`` where it counted none."""
    found = solver.statistics()
    return int(found.get_key_value("rlimit count")) if "rlimit count" in found.keys() else otherwise  # noqa: SIM118


@contextmanager
def _net(context: Any, microseconds: int) -> Iterator[None]:
    """Interrupt what runs in the context once it has had so much of the processor."""
    end, done = process_time() + 1e-6 * microseconds, Event()

    def watch() -> None:
        while not done.wait(0.1):
            if process_time() > end:
                context.interrupt()
                return

    thread = Thread(target=watch, daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()
