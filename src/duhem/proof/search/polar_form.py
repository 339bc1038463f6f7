"""Where the boundary of a star-shaped law in two forces may bend inward: the sign of gamma'' + gamma on the arcs of its gauge.

With the gauge gamma = prod P_i^a_i over the unit circle and D = d/dtheta = x d/dy - y d/dx, L = D gamma/gamma = sum a_i D P_i/P_i
and (gamma'' + gamma)/gamma = D L + L^2 + 1.  Where every P_i > 0 this has the sign of a polynomial in the P_i and their derivatives.
Source: R. Schneider (2014), Convex Bodies, section 1.7 (gauge and radial functions).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from duhem.expression import Norm
from duhem.expression.branches import Branch, TooManyBranchesError, branches
from duhem.expression.switches import plain_switches
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import fact

__all__ = ["PolarForm", "polar_form"]

_MOST_ARCS = 24


@dataclass(frozen=True)
class PolarArc(Branch):
    """Where the gauge is the product of the bases in ``expr`` to the powers in ``exponents``."""

    exponents: tuple[sp.Rational, ...]


@dataclass(frozen=True)
class PolarForm:
    """The gauge arc by arc, on the circle of the forces ``x`` and ``y``."""

    x: sp.Symbol
    y: sp.Symbol
    arcs: tuple[PolarArc, ...]

    def curvature(self, arc: PolarArc) -> sp.Expr:
        """(gamma'' + gamma)/gamma times prod P_i^2 on an arc: a polynomial in the bases and their derivatives."""
        bases, first = list(arc.expr), [self._turn(p) for p in arc.expr]
        second = [self._turn(d) for d in first]

        def others(*left_out: int) -> sp.Expr:
            return sp.Mul(*(p for k, p in enumerate(bases) if k not in left_out))

        bend = sp.Add(
            *(
                a * (p * d2 - d1**2) * others(i) ** 2
                for i, (a, p, d1, d2) in enumerate(zip(arc.exponents, bases, first, second, strict=True))
            )
        )
        slope = sp.Add(*(a * d1 * others(i) for i, (a, d1) in enumerate(zip(arc.exponents, first, strict=True))))
        return bend + slope**2 + others() ** 2

    def _turn(self, expr: sp.Expr) -> sp.Expr:
        """The derivative by theta of a function of (x, y) on the circle."""
        return self.x * sp.diff(expr, self.y) - self.y * sp.diff(expr, self.x)


@fact
def polar_form(subject: FormulaSubject) -> PolarForm | None:
    """The polar form of the subject's simple problem; None where it has none or its bases are not shown to be positive."""
    problem, star = subject.simple, subject.star
    if star is None or len(problem.forces) != 2:
        return None
    if subject.at_origin is not None and not subject.nonnegative(-subject.at_origin):
        return None  # the form says nothing of the origin itself, where a formula may jump
    x, y = problem.forces
    factors = star.factors()
    try:
        found = plain_switches(branches(sp.Tuple(*(p for p, _ in factors)), _MOST_ARCS))
    except TooManyBranchesError:
        return None
    pieces = [_arc(piece, [a for _, a in factors]) for piece in found]
    for arc in pieces:
        for base in arc.expr:
            if subject.ask(base, Sense.POSITIVE, *arc.conditions(), circle=(x, y)).holds is not True:
                return None
    return PolarForm(x, y, tuple(arc for arc in pieces if 0 not in arc.signs.values()))


def _arc(piece: Branch, exponents: Sequence[sp.Rational]) -> PolarArc:
    """The piece's bases split further: each root as a power of what is under it, so that the arc is free of roots."""
    found: dict[sp.Expr, sp.Rational] = {}
    queue = list(zip(piece.expr, exponents, strict=True))
    while queue:
        base, a = queue.pop(0)
        if isinstance(base, Norm):
            queue.append((sp.Add(*(c**2 for c in base.args)), a / 2))
        elif base.is_Pow and base.exp.is_Rational:
            queue.append((base.base, a * base.exp))
        elif base.is_Mul and base.args[0].is_positive:  # a scale: its derivative is 0, and so is that of any parameter
            queue += [(base.args[0], a), (sp.Mul(*base.args[1:]), a)]
        else:
            found[base] = found.get(base, sp.S.Zero) + a
    return PolarArc(piece.signs, tuple(found), tuple(found.values()))
