"""An algebraic question as polynomials: roots become variables, quotients are cleared with their signs kept.

What cannot be written so (exp, tanh, a symbolic exponent, a kink) raises NotAlgebraicError.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import sympy as sp
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyElement, PolyRing

from duhem.errors import InputError
from duhem.expression import Norm, fold
from duhem.expression.inert_number import MOST_ROOT
from duhem.proof.decide.question import Question

__all__ = ["NotAlgebraicError", "Relation", "System", "polynomial_system"]


class NotAlgebraicError(Exception):
    """The question involves something else than polynomials, quotients and roots."""


@dataclass(frozen=True)
class Relation:
    """``poly op 0`` with op one of ``>=``, ``>``, ``==``, ``!=``."""

    poly: sp.Expr
    op: str

    def holds(self) -> bool:
        """Its truth, where ``poly`` is a number."""
        value = self.poly
        return bool({">=": value >= 0, ">": value > 0, "==": value == 0, "!=": value != 0}[self.op])


@dataclass(frozen=True)
class System:
    """A question over polynomials: ``goal`` is wanted wherever all of ``given`` hold.

    ``obligations`` (denominators non-zero, radicands non-negative) must be proved before a proof of the goal counts.
    """

    goal: Relation
    given: tuple[Relation, ...]
    obligations: tuple[System, ...]
    variables: tuple[sp.Symbol, ...]
    circle: tuple[sp.Symbol, sp.Symbol] | None


class _Roots:
    """Radicals met so far, each a fresh non-negative symbol rho with rho**q = radicand."""

    def __init__(self, circle: tuple[sp.Symbol, sp.Symbol] | None) -> None:
        self.circle = circle
        self.found: dict[tuple[sp.Expr, int], sp.Symbol] = {}

    def on_circle(self, expr: sp.Expr) -> sp.Expr:
        """Normal form modulo x^2 + y^2 = 1, for polynomials; anything else is left alone."""
        if self.circle is None:
            return expr
        x, y = self.circle
        if not expr.has(y) or not expr.is_polynomial(x, y):
            return expr
        return sp.rem(sp.expand(expr), x**2 + y**2 - 1, y)

    def root(self, radicand: sp.Expr, q: int) -> sp.Expr:
        radicand = self.on_circle(radicand)
        if radicand.is_Rational:
            exact = sp.root(radicand, q)
            if exact.is_Rational:
                return exact
        key = (radicand, q)
        if key not in self.found:
            self.found[key] = sp.Dummy(f"rho{len(self.found)}", nonnegative=True)
        return self.found[key]

    def rewrite(self, expr: sp.Basic) -> sp.Expr:
        """``expr`` with every radical replaced by its symbol."""

        def power(node: sp.Basic, base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
            if not exponent.is_Rational or exponent.q > MOST_ROOT:
                raise NotAlgebraicError(f"the exponent {exponent} is not a number")
            if exponent.is_Integer:
                return base**exponent
            return self.root(base, int(exponent.q)) ** exponent.p

        def norm(node: sp.Basic, *args: sp.Expr) -> sp.Expr:
            return self.root(sp.Add(*(a**2 for a in args)), 2)

        def add(node: sp.Basic, *args: sp.Expr) -> sp.Expr:
            return sp.Add(*args)

        def mul(node: sp.Basic, *args: sp.Expr) -> sp.Expr:
            return sp.Mul(*args)

        def leaf(node: Any) -> sp.Expr:
            if node.is_Symbol or node.is_Rational:
                return node
            raise NotAlgebraicError(f"{node} is not algebraic")

        table: dict[type, Callable[..., sp.Expr]] = {sp.Add: add, sp.Mul: mul, sp.Pow: power, Norm: norm}
        try:
            return fold(expr, table, leaf)
        except InputError as fault:
            raise NotAlgebraicError(fault.what) from None


@dataclass(frozen=True)
class _Quotient:
    num: PolyElement
    den: tuple[PolyElement, ...]


def _quotient(expr: sp.Expr, ring: PolyRing, divisors: dict[PolyElement, None]) -> _Quotient:
    """``expr`` (rational in the generators) as one numerator over a tuple of denominator factors.

    ``divisors`` receives all that is divided by, also what 1/(1/x + 1) = x/(1 + x) no longer shows.
    """

    def times(factors: Iterable[PolyElement]) -> PolyElement:
        product = ring.one
        for factor in factors:
            product = product * factor
        return product

    def missing(all_: list[PolyElement], have: tuple[PolyElement, ...]) -> PolyElement:
        rest = list(all_)
        for factor in have:
            rest.remove(factor)
        return times(rest)

    def add(node: sp.Basic, *terms: _Quotient) -> _Quotient:
        common: list[PolyElement] = []
        for term in terms:
            left = list(common)
            for factor in term.den:
                if factor in left:
                    left.remove(factor)
                else:
                    common.append(factor)
        return _Quotient(sum((t.num * missing(common, t.den) for t in terms), ring.zero), tuple(common))

    def mul(node: sp.Basic, *terms: _Quotient) -> _Quotient:
        return _Quotient(times(t.num for t in terms), tuple(f for t in terms for f in t.den))

    def power(node: Any, base: _Quotient, _: _Quotient) -> _Quotient:
        n = int(node.exp)
        if n >= 0:
            return _Quotient(base.num**n, base.den * n)
        if not base.num:
            raise NotAlgebraicError("division by zero")
        turned = times(base.den) ** -n
        if base.num.is_ground:
            return _Quotient(turned * (1 / base.num.LC) ** -n, ())
        divisors.setdefault(base.num)
        return _Quotient(turned, (base.num,) * -n)

    def leaf(node: Any) -> _Quotient:
        if node.is_Rational:
            return _Quotient(ring.ground_new(ring.domain(int(node.p), int(node.q))), ())
        return _Quotient(ring.gens[ring.symbols.index(node)], ())

    return fold(expr, {sp.Add: add, sp.Mul: mul, sp.Pow: power}, leaf)


_OPS = {sp.GreaterThan: ">=", sp.StrictGreaterThan: ">", sp.LessThan: ">=", sp.StrictLessThan: ">", sp.Eq: "==", sp.Ne: "!="}


def polynomial_system(question: Question) -> System:
    """The question over polynomials; raises NotAlgebraicError where it is not algebraic."""
    roots = _Roots(question.circle)
    goal = roots.rewrite(question.expr)
    given = [(roots.rewrite(_gap(r)), _OPS[type(r)]) for r in question.given if r is not sp.true]
    symbols: set[sp.Symbol] = set(question.circle or ()).union(goal.free_symbols, *(e.free_symbols for e, _ in given))
    for (radicand, _), rho in roots.found.items():
        symbols |= radicand.free_symbols | {rho}
    ordered = tuple(sorted(symbols, key=lambda s: (isinstance(s, sp.Dummy), s.name)))
    given += [(x, ">" if x.is_positive else ">=") for x in ordered if x.is_nonnegative and not isinstance(x, sp.Dummy)]
    ring = PolyRing(ordered, sp.QQ, lex)
    clear = _Clearing(ring, roots)
    relations = [clear.relation(expr, op) for expr, op in given]
    if question.circle is not None:
        relations.append(Relation(question.circle[0] ** 2 + question.circle[1] ** 2 - 1, "=="))
    obligations: list[System] = []

    def oblige(*goals: Relation) -> None:
        obligations.extend(System(wanted, tuple(relations), (), ordered, question.circle) for wanted in goals)

    for (radicand, q), rho in roots.found.items():
        inner = _Clearing(ring, roots)
        radical, definition = inner.relation(radicand, ">="), inner.definition(rho, radicand, q)
        # before the root is defined: rho**2 * x = 1 would show that x is not 0
        oblige(*() if _nonnegative(radicand) else (radical,), *inner.doubtful())
        relations += [definition, Relation(rho, ">=")]
    wanted = clear.relation(goal, question.sense.value)
    oblige(*clear.doubtful())
    return System(wanted, tuple(relations), tuple(obligations), ordered, question.circle)


class _Clearing:
    """Clears quotients within one ring, remembering all that is divided by."""

    def __init__(self, ring: PolyRing, roots: _Roots) -> None:
        self.ring, self.roots = ring, roots
        self.divisors: dict[PolyElement, None] = {}

    def doubtful(self) -> list[Relation]:
        """That the divisors whose sign is not plain are not 0."""
        return [Relation(d.as_expr(), "!=") for d in self.divisors if not _positive(d)]

    def relation(self, expr: sp.Expr, op: str) -> Relation:
        """``expr op 0`` with denominators multiplied out, each odd one together with its sign."""
        form = _quotient(expr, self.ring, self.divisors)
        num = form.num
        for factor in set(form.den):
            if not _positive(factor) and form.den.count(factor) % 2 and op in (">=", ">"):
                num = num * factor
        return Relation(self.roots.on_circle(self._reduced(num).as_expr()), op)

    def definition(self, rho: sp.Symbol, radicand: sp.Expr, q: int) -> Relation:
        """rho**q = radicand, cleared."""
        form = _quotient(radicand, self.ring, self.divisors)
        scale = self.ring.one
        for factor in form.den:
            scale = scale * factor
        return Relation((scale * self.ring.gens[self.ring.symbols.index(rho)] ** q - form.num).as_expr(), "==")

    def _reduced(self, num: PolyElement) -> PolyElement:
        """Powers rho**q replaced by the radicand, last root first, where the radicand is a polynomial."""
        for (radicand, q), rho in reversed(self.roots.found.items()):
            form = _quotient(radicand, self.ring, self.divisors)
            if form.den:
                continue
            i = self.ring.symbols.index(rho)
            result = self.ring.zero
            for monom, coeff in num.terms():
                rest = list(monom)
                rest[i] = monom[i] % q
                result += self.ring.term_new(tuple(rest), coeff) * form.num ** (monom[i] // q)
            num = result
        return num


def _gap(relation: Any) -> sp.Expr:
    return relation.lhs - relation.rhs if isinstance(relation, sp.Eq | sp.Ne) else relation.gts - relation.lts


def _nonnegative(radicand: sp.Expr) -> bool:
    return bool(radicand.is_nonnegative)


def _positive(factor: PolyElement) -> bool:
    """Positive at sight: a sum of positive monomials in positive symbols."""
    return bool(factor.as_expr().is_positive)
