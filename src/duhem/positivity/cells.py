"""Exact decision in one variable: real roots isolated over the rationals, one sample per cell, signs at the roots.

Complete for polynomial questions in one variable with rational coefficients, zero margins included (Sturm 1829;
isolation by SymPy's exact arithmetic).  A question on the unit circle becomes one in t = tan(theta/2) by
x = (1 - t^2)/(1 + t^2), y = 2t/(1 + t^2); the point theta = pi is examined apart.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import sympy as sp

from duhem.positivity.polynomials import Relation, System
from duhem.positivity.question import Answer

__all__ = ["by_cells"]

_METHOD = "sturm"


def by_cells(system: System) -> Answer:
    """Decide a question in one variable or on the unit circle; ``holds`` is None where there are more variables."""
    used = _variables(system)
    if system.circle is not None and used <= set(system.circle):
        return _on_circle(system)
    if len(used) <= 1:
        t = next(iter(used), sp.Dummy("t", real=True))
        return _decide([(r.poly, r.op) for r in system.given], (system.goal.poly, system.goal.op), t)
    return Answer(None, _METHOD, reason=f"{len(used)} variables remain")


def _variables(system: System) -> set[sp.Symbol]:
    return set().union(system.goal.poly.free_symbols, *(r.poly.free_symbols for r in system.given))


def _on_circle(system: System) -> Answer:
    assert system.circle is not None
    x, y = system.circle
    given = [r for r in system.given if not _is_circle(r, x, y)]
    at_pi = {x: sp.S.NegativeOne, y: sp.S.Zero}
    if all(_true(r.poly.subs(at_pi), r.op) for r in given) and not _true(system.goal.poly.subs(at_pi), system.goal.op):
        return Answer(False, _METHOD, point=at_pi)
    t = sp.Dummy("t", real=True)
    answer = _decide([(_half_angle(r.poly, x, y, t), r.op) for r in given], (_half_angle(system.goal.poly, x, y, t), system.goal.op), t)
    if answer.point is not None:
        value = answer.point[t]
        scale = 1 + value**2
        return Answer(False, _METHOD, point={x: (1 - value**2) / scale, y: 2 * value / scale})
    return answer


def _is_circle(relation: Relation, x: sp.Symbol, y: sp.Symbol) -> bool:
    return (relation.op == "==" and sp.expand(relation.poly - x**2 - y**2 + 1) == 0) or relation.poly == 0


def _half_angle(poly: sp.Expr, x: sp.Symbol, y: sp.Symbol, t: sp.Symbol) -> sp.Expr:
    """(1 + t^2)^n poly(x(t), y(t)) with n the degree: a positive multiple."""
    form = sp.Poly(poly, x, y)
    n = max((i + j for i, j in form.monoms()), default=0)
    one, two, den = sp.Poly(1 - t**2, t), sp.Poly(2 * t, t), sp.Poly(1 + t**2, t)
    total = sp.Poly(0, t)
    for (i, j), coefficient in form.terms():
        total += coefficient * one**i * two**j * den ** (n - i - j)
    return total.as_expr()


def _true(value: sp.Expr, op: str) -> bool:
    return bool(value >= 0 if op == ">=" else value > 0 if op == ">" else value == 0 if op == "==" else value != 0)


def _decide(given: list[tuple[sp.Expr, str]], goal: tuple[sp.Expr, str], t: sp.Symbol) -> Answer:
    polys = [sp.Poly(p, t, domain="QQ") for p, _ in [*given, goal]]
    varying = [p for p in polys if p.degree() > 0]
    product = sp.Poly(1, t, domain="QQ")
    for p in varying:
        factor = sp.Poly(p.sqf_part(), t, domain="QQ")
        product = product * factor.quo(factor.gcd(product)) if product.degree() > 0 else factor
    isolated = product.intervals() if product.degree() > 0 else []
    spans = sorted(_apart(product, span) for span, _ in isolated)
    for sample in _samples(spans):
        if all(_true(p.eval(sample), op) for p, (_, op) in zip(polys, given, strict=False)) and not _true(polys[-1].eval(sample), goal[1]):
            return Answer(False, _METHOD, point={t: sample})
    for span in spans:
        signs = [_sign_at_root(p, product, span) for p in polys]
        if all(_true(sp.Integer(s), op) for s, (_, op) in zip(signs, given, strict=False)) and not _true(sp.Integer(signs[-1]), goal[1]):
            return Answer(False, _METHOD, point={t: (span[0] + span[1]) / 2})
    return Answer(True, _METHOD)


def _apart(product: sp.Poly, span: tuple[sp.Rational, sp.Rational]) -> tuple[sp.Rational, sp.Rational]:
    """The span shrunk until neither end is a root of ``product``, unless it is a point."""
    low, high = span
    while low < high and (product.eval(low) == 0 or product.eval(high) == 0):
        low, high = product.refine_root(low, high, steps=1)
    return low, high


def _samples(spans: list[tuple[sp.Rational, sp.Rational]]) -> Iterable[sp.Rational]:
    """One rational strictly between each pair of neighbouring roots, and one beyond each end."""
    if not spans:
        return [sp.S.Zero]
    inner = [(a[1] + b[0]) / 2 for a, b in pairwise(spans)]
    return [spans[0][0] - 1, *inner, spans[-1][1] + 1]


def _sign_at_root(p: sp.Poly, product: sp.Poly, span: tuple[sp.Rational, sp.Rational]) -> int:
    """Exact sign of p at the one root of ``product`` in the span."""
    low, high = span
    if low == high:
        return int(sp.sign(p.eval(low)))
    if p.degree() <= 0:
        return int(sp.sign(p.eval(0)))
    common = p.gcd(product)
    if common.degree() > 0 and common.count_roots(low, high) > 0:
        return 0
    while low < high and p.count_roots(low, high) > 0:
        low, high = product.refine_root(low, high, steps=4)
    return int(sp.sign(p.eval((low + high) / 2)))
