"""Exact decision in one variable: real roots isolated over the rationals, one sample per cell, signs at the roots.

Complete for polynomial questions in one variable with rational coefficients, zero margins included (Sturm 1829; the
roots by FLINT).  A polynomial vanishes at a root of an irreducible one exactly if it is a multiple of it.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import flint
import sympy as sp

from duhem.expression.balls import certain_sign, precision
from duhem.expression.number import fraction, rational
from duhem.proof.decide.bivariate import OpenError, true
from duhem.proof.decide.budget import Budget
from duhem.proof.decide.polynomials import System
from duhem.proof.decide.question import Answer
from duhem.proof.decide.reduction import variables
from duhem.proof.decide.roots import between, real_roots

__all__ = ["by_cells"]

_METHOD = "sturm"
_BITS = (64, 1024, 16384)

Sign = tuple[Any, str]  # a flint.fmpz_poly and its relation to 0


def by_cells(system: System, budget: Budget) -> Answer:
    """Decide a question in one variable; ``holds`` is None where there are more."""
    used = variables(system)
    if len(used) > 1:
        return Answer(None, _METHOD, reason=f"{len(used)} variables remain")
    t = next(iter(used), sp.Dummy("t"))
    given = [(_integral(r.poly, t), r.op) for r in system.given]
    goal = (_integral(system.goal.poly, t), system.goal.op)
    for bits in _BITS:
        try:
            value = _violation(given, goal, bits, budget)
        except OpenError:
            continue
        if value is None:
            return Answer(True, _METHOD)
        return Answer(False, _METHOD, point={t: rational(value)})
    return Answer(None, _METHOD, reason="a sign at a root stays open")


def _integral(expr: sp.Expr, t: sp.Symbol) -> Any:
    """Integer coefficients, up to a positive factor."""
    coefficients = sp.Poly(expr, t, domain="QQ").all_coeffs()[::-1]
    scale = math.lcm(*(int(c.q) for c in coefficients))
    return flint.fmpz_poly([int(c.p) * (scale // int(c.q)) for c in coefficients])


def _violation(given: list[Sign], goal: Sign, bits: int, budget: Budget) -> Fraction | None:
    """A value (at a root: close to it) where every hypothesis holds and the goal fails, or None."""
    factors = _factors([p for p, _ in (*given, goal)])
    product = math.prod(factors, start=flint.fmpz_poly([1]))
    roots = real_roots(product, bits, budget)
    for sample in between(roots):
        if _violated(given, goal, lambda p, at=sample: _sign_at(p, at)):
            return sample
    for factor in factors:
        with precision(bits):
            for root in real_roots(factor, bits, budget):
                if _violated(given, goal, lambda p, f=factor, at=root: _sign_at_root(p, f, at)):
                    middle = root.mid().fmpq()
                    return fraction(middle)
    return None


def _factors(polys: list[Any]) -> list[Any]:
    """The distinct irreducible factors of positive degree."""
    found: list[Any] = []
    for poly in polys:
        found += [f for f, _ in poly.factor()[1] if f not in found]
    return found


def _violated(given: list[Sign], goal: Sign, sign: Any) -> bool:
    return all(true(sign(p), op) for p, op in given) and not true(sign(goal[0]), goal[1])


def _sign_at(p: Any, at: Fraction) -> int:
    value = p(flint.fmpq(at.numerator, at.denominator))
    return (value > 0) - (value < 0)


def _sign_at_root(p: Any, factor: Any, root: Any) -> int:
    """Exact sign of p at a root of the irreducible ``factor``."""
    if p.gcd(factor).degree() > 0:
        return 0
    sign = certain_sign(p(root))
    if sign is None:
        raise OpenError("a sign at a root stays open")
    return sign
