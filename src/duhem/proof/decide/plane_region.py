"""Exact decision in a plane region: one rational point in each open cell of the polynomials involved (Collins 1975).

A weak goal that holds on the open cells holds on what they are dense in: the region of strict hypotheses, and of bounds
``x >= number`` besides, for there every point has points of the interior beside it.  A strict goal needs that it
vanishes nowhere in the region as well, which is a question along the curve where it does.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import flint
import sympy as sp

from duhem.expression.number import rational
from duhem.proof.decide.bivariate import DegenerateError, Integral, OpenError, Poly, at_rational, factors, projection, true
from duhem.proof.decide.budget import Budget, SpentError
from duhem.proof.decide.plane_curve import by_plane
from duhem.proof.decide.polynomials import Relation, System
from duhem.proof.decide.question import Answer
from duhem.proof.decide.reduction import variables
from duhem.proof.decide.roots import between, real_roots

__all__ = ["by_region"]

_METHOD = "plane-cells"
_BITS = 256


def by_region(system: System, budget: Budget) -> Answer:
    """Decide a question in two variables without equations among the hypotheses; ``holds`` None for any other."""
    used = variables(system)
    op = system.goal.op
    if len(used) != 2 or op not in (">=", ">") or not _dense(system.given):
        return Answer(None, _METHOD, reason="it is no question about an open region of the plane")
    y, x = sorted(used, key=lambda s: (sp.degree(system.goal.poly, s), str(s)))
    polys = Integral(x, y)
    given = [(polys(r.poly), r.op) for r in system.given]
    goal = polys(system.goal.poly)
    try:
        point = _violation(given, goal, budget)
    except (DegenerateError, OpenError, SpentError) as fault:
        return Answer(None, _METHOD, reason=str(fault) or "degenerate")
    if point is not None:
        return Answer(False, _METHOD, point={s: rational(v) for s, v in zip((x, y), point, strict=True)})
    if op == ">":
        zero = (*system.given, Relation(system.goal.poly, "=="))
        return by_plane(System(Relation(sp.S.NegativeOne, ">"), zero, (), system.variables, None), budget)
    return Answer(True, _METHOD)


def _dense(given: tuple[Relation, ...]) -> bool:
    """Whether all relations are strict or bounds on one variable that leave it an interval: then inner points are dense."""
    low: dict[sp.Symbol, sp.Rational] = {}
    high: dict[sp.Symbol, sp.Rational] = {}
    for relation in given:
        if relation.op in (">", "!="):
            continue
        symbols = relation.poly.free_symbols
        form = sp.Poly(relation.poly, *symbols) if len(symbols) == 1 else None
        if relation.op != ">=" or form is None or form.degree() != 1:
            return False
        end = -form.nth(0) / form.nth(1)
        if form.nth(1) > 0:
            low[form.gen] = max(end, low.get(form.gen, end))
        else:
            high[form.gen] = min(end, high.get(form.gen, end))
    return all(low[x] < high[x] for x in low.keys() & high.keys())


def _violation(given: list[tuple[Poly, str]], goal: Poly, budget: Budget) -> tuple[Fraction, Fraction] | None:
    """A point inside a cell where the hypotheses hold and the goal is negative."""
    found: list[Poly] = []
    for poly in (*(p for p, _ in given), goal):
        if not poly.is_constant():
            found += [f for f in factors(poly) if f not in found]
    upright = [f for f in found if f.degrees()[1] == 0]
    curves = [f for f in found if f not in upright]
    special = projection(curves, combinations(curves, 2), budget, upright)
    for x in between(real_roots(special, _BITS, budget)):
        product = flint.fmpz_poly([1])
        for curve in curves:
            product *= at_rational(curve, x)
        conditions, wanted = [(at_rational(p, x), op) for p, op in given], at_rational(goal, x)
        for y in between(real_roots(product, _BITS, budget)):
            at = flint.fmpq(y.numerator, y.denominator)
            if wanted(at) < 0 and all(true(_sign(p(at)), ">" if op == ">=" else op) for p, op in conditions):
                return x, y
    return None


def _sign(value: flint.fmpq) -> int:
    return (value > 0) - (value < 0)
