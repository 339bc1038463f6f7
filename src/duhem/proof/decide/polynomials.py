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
from duhem.proof.decide.budget import Budget
from duhem.proof.decide.question import Question, Sense

__all__ = ["NotAlgebraicError", "Relation", "System", "polynomial_system"]


_TERM = 2  # steps of the product of two terms
_MOST_TERMS = 3_000  # of a polynomial: one with more is beyond the deciders, and to read it alone takes long


class NotAlgebraicError(Exception):
    """The question involves something else than polynomials of a size to be handled, quotients and roots."""


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


class _Products:
    """Products in a ring, each paid for before it is made."""

    def __init__(self, ring: PolyRing, budget: Budget) -> None:
        self.ring, self.budget = ring, budget

    def of(self, factors: Iterable[PolyElement]) -> PolyElement:
        """All factors together."""
        product = self.ring.one
        for factor in factors:
            self.budget.spend(_TERM * len(product) * len(factor))
            product = product * factor
        return product

    def power(self, base: PolyElement, n: int) -> PolyElement:
        """The n-th power, n >= 0."""
        return base**n if len(base) < 2 else self.of([base] * n)


def _quotient(expr: sp.Expr, products: _Products, divisors: dict[PolyElement, None]) -> _Quotient:
    """``expr`` (rational in the generators) as one numerator over a tuple of denominator factors.

    ``divisors`` receives all that is divided by, also what 1/(1/x + 1) = x/(1 + x) no longer shows.
    """
    ring = products.ring

    def missing(all_: list[PolyElement], have: tuple[PolyElement, ...]) -> PolyElement:
        rest = list(all_)
        for factor in have:
            rest.remove(factor)
        return products.of(rest)

    def add(node: sp.Basic, *terms: _Quotient) -> _Quotient:
        common: list[PolyElement] = []
        for term in terms:
            left = list(common)
            for factor in term.den:
                if factor in left:
                    left.remove(factor)
                else:
                    common.append(factor)
        return _Quotient(sum((products.of((t.num, missing(common, t.den))) for t in terms), ring.zero), tuple(common))

    def mul(node: sp.Basic, *terms: _Quotient) -> _Quotient:
        return _Quotient(products.of(t.num for t in terms), tuple(f for t in terms for f in t.den))

    def power(node: Any, base: _Quotient, _: _Quotient) -> _Quotient:
        n = int(node.exp)
        if n >= 0:
            return _Quotient(products.power(base.num, n), base.den * n)
        if not base.num:
            raise NotAlgebraicError("division by zero")
        turned = products.power(products.of(base.den), -n)
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


def polynomial_system(question: Question, budget: Budget) -> System:
    """The question over polynomials; NotAlgebraicError where it is not algebraic, SpentError where they grow too large."""
    roots = _Roots(question.circle)
    goal = roots.rewrite(question.expr)
    given = [(roots.rewrite(_gap(r)), _OPS[type(r)]) for r in question.given if r is not sp.true]
    symbols: set[sp.Symbol] = set(question.circle or ()).union(goal.free_symbols, *(e.free_symbols for e, _ in given))
    for (radicand, _), rho in roots.found.items():
        symbols |= radicand.free_symbols | {rho}
    ordered = tuple(sorted(symbols, key=lambda s: (s.is_Dummy, sp.default_sort_key(s))))
    given += [(x, ">" if x.is_positive else ">=") for x in ordered if x.is_nonnegative and not isinstance(x, sp.Dummy)]
    products = _Products(PolyRing(ordered, sp.QQ, lex), budget)
    clear = _Clearing(products, roots)
    relations = [clear.relation(expr, op) for expr, op in given]
    if question.circle is not None:
        relations.append(Relation(question.circle[0] ** 2 + question.circle[1] ** 2 - 1, "=="))
    obligations: list[System] = []

    def oblige(*goals: Relation) -> None:
        obligations.extend(System(wanted, tuple(relations), (), ordered, question.circle) for wanted in goals)

    for (radicand, q), rho in roots.found.items():
        inner = _Clearing(products, roots)
        radical, definition = inner.relation(radicand, ">="), inner.definition(rho, radicand, q)
        # before the root is defined: rho**2 * x = 1 would show that x is not 0
        oblige(*() if _nonnegative(radicand) else (radical,), *inner.doubtful())
        relations += [definition, Relation(rho, ">=")]
    wanted = clear.relation(goal, question.sense.value)
    if question.sense is Sense.NONNEGATIVE and question.expr.is_Pow and question.expr.exp.is_even:
        wanted = Relation(sp.S.Zero, ">=")  # a square: that it is defined is all there is to show
    oblige(*clear.doubtful())
    return System(wanted, tuple(relations), tuple(obligations), ordered, question.circle)


class _Clearing:
    """Clears quotients within one ring, remembering all that is divided by."""

    def __init__(self, products: _Products, roots: _Roots) -> None:
        self.products, self.ring, self.roots = products, products.ring, roots
        self.divisors: dict[PolyElement, None] = {}

    def doubtful(self) -> list[Relation]:
        """That the divisors whose sign is not plain are not 0."""
        return [Relation(d.as_expr(), "!=") for d in self.divisors if not _positive(d)]

    def relation(self, expr: sp.Expr, op: str) -> Relation:
        """``expr op 0`` with denominators multiplied out, each odd one together with its sign."""
        form = _quotient(expr, self.products, self.divisors)
        num = form.num
        for factor in dict.fromkeys(form.den):
            if not _positive(factor) and form.den.count(factor) % 2 and op in (">=", ">"):
                num = self.products.of((num, factor))
        return Relation(_expression(self._reduced(num)), op)

    def definition(self, rho: sp.Symbol, radicand: sp.Expr, q: int) -> Relation:
        """rho**q = radicand, cleared."""
        form = _quotient(radicand, self.products, self.divisors)
        scale = self.products.of(form.den)
        return Relation(_expression(scale * self.ring.gens[self.ring.symbols.index(rho)] ** q - form.num), "==")

    def _reduced(self, num: PolyElement) -> PolyElement:
        """Powers rho**q replaced by the radicand, last root first, where the radicand is a polynomial; y**2 on the circle too."""
        for (radicand, q), rho in reversed(self.roots.found.items()):
            form = _quotient(radicand, self.products, self.divisors)
            if not form.den:
                num = self._put(num, rho, q, form.num)
        if self.roots.circle is not None:
            x, y = self.roots.circle
            num = self._put(num, y, 2, 1 - self.ring.gens[self.ring.symbols.index(x)] ** 2)
        return num

    def _put(self, num: PolyElement, x: sp.Symbol, q: int, value: PolyElement) -> PolyElement:
        """x**q replaced by a polynomial, by Horner's rule."""
        i = self.ring.symbols.index(x)
        parts: dict[int, dict[tuple[int, ...], Any]] = {}
        for monom, coefficient in num.terms():
            whole, rest = divmod(monom[i], q)
            parts.setdefault(whole, {})[(*monom[:i], rest, *monom[i + 1 :])] = coefficient
        found = self.ring.zero
        for k in range(max(parts, default=0), -1, -1):
            found = self.products.of((found, value)) + self.ring.from_dict(parts.get(k, {}))
        return found


def _expression(poly: PolyElement) -> sp.Expr:
    if len(poly) > _MOST_TERMS:
        raise NotAlgebraicError(f"a polynomial has {len(poly)} terms")
    return poly.as_expr()


def _gap(relation: Any) -> sp.Expr:
    return relation.lhs - relation.rhs if isinstance(relation, sp.Eq | sp.Ne) else relation.gts - relation.lts


def _nonnegative(radicand: sp.Expr) -> bool:
    return bool(radicand.is_nonnegative)


def _positive(factor: PolyElement) -> bool:
    """Positive at sight: a sum of positive monomials in positive symbols."""
    return bool(factor.as_expr().is_positive)
