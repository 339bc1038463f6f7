"""Polynomial questions with fewer variables: the circle by its half-angle, solutions of equations put in place.

Each step is an equivalence: the question holds if and only if each of the smaller ones does.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import comb
from typing import Any

import sympy as sp

from duhem.proof.decide.polynomials import Relation, System

__all__ = ["Reduction", "parts", "variables"]

_MOST = 32
_MOST_TERMS = 20_000


@dataclass(frozen=True)
class Reduction:
    """A smaller question; ``steps`` say what each variable that is gone stands for, last first."""

    system: System
    steps: tuple[tuple[sp.Symbol, sp.Expr], ...] = ()

    def restored(self, point: Mapping[sp.Symbol, Any]) -> dict[sp.Symbol, Any]:
        """A point of the smaller question as one of the whole; what the smaller one does not speak of is 0."""
        whole: dict[sp.Symbol, Any] = {**dict.fromkeys(self.system.variables, sp.S.Zero), **point}
        for x, value in self.steps:
            whole[x] = sp.sympify(value).subs(whole)
        return whole

    def at(self, x: sp.Symbol, value: sp.Expr) -> Reduction | None:
        """With x = value put in place; None if a hypothesis is then false."""

        def put(relation: Relation) -> Relation:
            return Relation(sp.expand(relation.poly.subs(x, value)), relation.op)

        given = tuple(map(put, self.system.given))
        if any(r.poly.is_number and not r.holds() for r in given):
            return None
        circle = None if self.system.circle is not None and x in self.system.circle else self.system.circle
        kept = tuple(dict.fromkeys(r for r in given if not r.poly.is_number))
        variables = tuple(v for v in self.system.variables if v != x)
        return Reduction(System(put(self.system.goal), kept, (), variables, circle), ((x, value), *self.steps))


def variables(system: System) -> set[sp.Symbol]:
    """The symbols that occur."""
    return set().union(system.goal.poly.free_symbols, *(r.poly.free_symbols for r in system.given))


def parts(system: System) -> tuple[Reduction, ...]:
    """The question as parts without a circle, and without an equation that gives a variable rational values or a linear one."""
    found: list[Reduction] = []
    for part in _solved(Reduction(_joined(system))):
        if part.system.circle is not None and variables(part.system) & set(part.system.circle):
            found += [smaller for turned in _half_angle(part) for smaller in _solved(turned)]
        else:
            found.append(part)
    return tuple(found)


def _joined(system: System) -> System:
    """p >= 0 and -p >= 0 as p = 0."""
    weak = {r.poly for r in system.given if r.op == ">="}

    def joined(relation: Relation) -> Relation:
        both = relation.op == ">=" and sp.expand(-relation.poly) in weak
        return Relation(relation.poly, "==") if both else relation

    return replace(system, given=tuple(dict.fromkeys(map(joined, system.given))))


def _solved(part: Reduction) -> list[Reduction]:
    queue, done = [part], list[Reduction]()
    while queue:
        current = queue.pop()
        cases = _cases(current) if len(queue) + len(done) < _MOST else None
        if cases is None:
            done.append(current)
        else:
            queue.extend(case for case in cases if case is not None)
    return done


def _cases(part: Reduction) -> list[Reduction | None] | None:
    """The values, or the linear expression, that some equation gives a variable; None if no equation does."""
    circle = set(part.system.circle or ())
    for relation in part.system.given:
        if relation.op != "==":
            continue
        symbols = relation.poly.free_symbols
        if len(symbols) == 1:
            x = next(iter(symbols))
            values = _rational_roots(sp.Poly(relation.poly, x, domain="QQ"))
            if values is not None:
                return [part.at(x, value) for value in values]
        elif not symbols & circle:
            for x in sorted(symbols, key=str):
                form = sp.Poly(relation.poly, x)
                if form.degree() == 1 and form.LC().is_Rational:
                    value = sp.expand(-form.nth(0) / form.LC())
                    if _terms(part.system, x, len(sp.Add.make_args(value))) <= _MOST_TERMS:
                        return [part.at(x, value)]
    return None


def _terms(system: System, x: sp.Symbol, count: int) -> int:
    """At most so many terms has the question with a sum of ``count`` terms in the place of x."""
    polys = [relation.poly for relation in (system.goal, *system.given)]
    return sum(len(sp.Add.make_args(p)) * comb(max(sp.Poly(p, x).degree(), 0) + count - 1, count - 1) for p in polys)


def _rational_roots(form: sp.Poly) -> list[sp.Rational] | None:
    """All real roots if they are rational."""
    roots = [-f.nth(0) / f.nth(1) for f, _ in form.factor_list()[1] if f.degree() == 1]
    return roots if sp.Poly(form.sqf_part(), form.gen).count_roots() == len(roots) else None


def _half_angle(part: Reduction) -> Iterator[Reduction]:
    """x = (1 - t^2)/(1 + t^2), y = 2t/(1 + t^2), t = tan(theta/2), and the one point without a t, (-1, 0)."""
    assert part.system.circle is not None
    x, y = part.system.circle
    west = part.at(x, sp.S.NegativeOne)
    if west is not None and (west := west.at(y, sp.S.Zero)) is not None:
        yield west
    t = sp.Dummy("t", real=True)

    def turned(relation: Relation) -> Relation:
        return Relation(_turned(relation.poly, x, y, t), relation.op)

    given = tuple(turned(r) for r in part.system.given if not _is_circle(r, x, y))
    free = (*(v for v in part.system.variables if v not in (x, y)), t)
    steps = ((x, (1 - t**2) / (1 + t**2)), (y, 2 * t / (1 + t**2)), *part.steps)
    yield Reduction(System(turned(part.system.goal), given, (), free, None), steps)


def _is_circle(relation: Relation, x: sp.Symbol, y: sp.Symbol) -> bool:
    return (relation.op == "==" and sp.expand(relation.poly - x**2 - y**2 + 1) == 0) or relation.poly == 0


def _turned(poly: sp.Expr, x: sp.Symbol, y: sp.Symbol, t: sp.Symbol) -> sp.Expr:
    """(1 + t^2)^n poly(x(t), y(t)) with n the degree: a positive multiple."""
    form = sp.Poly(poly, x, y)
    n = max((i + j for i, j in form.monoms()), default=0)
    one, two, den = sp.Poly(1 - t**2, t), sp.Poly(2 * t, t), sp.Poly(1 + t**2, t)
    total = sp.Poly(0, t)
    for (i, j), coefficient in form.terms():
        total += coefficient * one**i * two**j * den ** (n - i - j)
    return sp.expand(total.as_expr())
