"""A body with a profile: {Q <= h(t)}, t a load and Q a sum of squares of affine functions of the forces, h any function of t.

It is {sqrt Q <= sqrt h(t)}: convex where h > 0 strictly between any two places at which h >= 0, and h'^2 - 2 h h'' >= 0 where h >= 0.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

import sympy as sp

from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject

__all__ = ["convex_by_its_profile"]


def convex_by_its_profile(f: sp.Expr, loads: Collection[sp.Expr], subject: FormulaSubject) -> bool:
    """Whether {f <= 0} is convex where all ``loads`` are >= 0, f being a polynomial in the forces."""
    forces = subject.simple.forces
    if not f.is_polynomial(*forces):
        return False
    return any(_along(f, load, loads, subject) for load in dict.fromkeys((*loads, *_leading(f, forces))))


def _leading(f: sp.Expr, forces: Collection[sp.Symbol]) -> Iterator[sp.Expr]:
    """The load of whose power the terms of the highest degree are a multiple, if they are: told from those in one or two forces."""
    poly = sp.Poly(f, *forces)
    degree = poly.total_degree()
    top = {m: c for m, c in poly.terms() if sum(m) == degree}
    for i in range(len(forces)) if degree > 2 else ():
        steps = [tuple((degree - 1) * (k == i) + (k == j) for k in range(len(forces))) for j in range(len(forces))]
        if own := top.get(steps[i]):
            shares = [sp.S.One if j == i else sp.cancel(top.get(m, sp.S.Zero) / (degree * own)) for j, m in enumerate(steps)]
            if all(
                sp.cancel(top.get(tuple(degree * (k == j) for k in range(len(forces))), 0) / own) == shares[j] ** degree
                for j in range(len(forces))
            ):
                yield sp.Add(*(r * x for r, x in zip(shares, forces, strict=True)))
            return


def _along(f: sp.Expr, load: sp.Expr, loads: Collection[sp.Expr], subject: FormulaSubject) -> bool:
    forces, t = subject.simple.forces, sp.Dummy("t", real=True)
    x = next((x for x in forces if load.has(x) and (sp.diff(load, x).is_positive or sp.diff(load, x).is_negative)), None)
    if x is None:
        return False
    (place,) = sp.solve(load - t, x)
    h = _height(f.xreplace({x: place}), t, [y for y in forces if y != x], subject)
    if h is None:
        return False
    sides = [side for side in (sp.expand(side.xreplace({x: place})) for side in loads) if not side.free_symbols & set(forces)]
    return _single(h, t, sides, subject) and _bent(h, t, sides, subject)


def _height(f: sp.Expr, t: sp.Symbol, others: list[sp.Symbol], subject: FormulaSubject) -> sp.Expr | None:
    """h with f = Q - h(t) up to a positive factor: one force after the other is at its best place."""
    for i, y in enumerate(others):
        rest = others[i + 1 :]
        poly = sp.Poly(sp.expand(f), y)
        if poly.degree() < 1:
            continue
        twice, once, free = (poly.coeff_monomial(y**k) for k in (2, 1, 0))
        affine = once.is_polynomial(t, *rest) and sp.Poly(once, t, *rest).total_degree() < 2
        if poly.degree() > 2 or not affine or twice.free_symbols & {t, *rest} or not subject.positive(twice):
            return None
        f = free - once**2 / (4 * twice)
    return sp.factor(-f)


def _single(h: sp.Expr, t: sp.Symbol, sides: Collection[sp.Expr], subject: FormulaSubject) -> bool:
    """Whether h >= 0 on an interval alone, and > 0 inside it."""
    low, high = (sp.Dummy(name, real=True) for name in ("low", "high"))
    given = [sp.StrictLessThan(low, t), sp.StrictLessThan(t, high)]
    given += [sp.GreaterThan(part.xreplace({t: end}), 0) for end in (low, high) for part in (h, *sides)]
    return subject.ask(h, Sense.POSITIVE, *given).holds is True


def _bent(h: sp.Expr, t: sp.Symbol, sides: Collection[sp.Expr], subject: FormulaSubject) -> bool:
    """Whether sqrt h is concave where h >= 0."""
    bend = sp.factor(sp.diff(h, t) ** 2 - 2 * h * sp.diff(h, t, 2))
    given = [sp.GreaterThan(part, 0) for part in (h, *sides)]
    return subject.ask(bend, Sense.NONNEGATIVE, *(r for r in given if r is not sp.true)).holds is True
