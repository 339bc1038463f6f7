"""Star-shaped laws in two forces, in polar form: gamma'' + gamma >= 0 as a measure on the circle.

With the gauge gamma = prod P_i^a_i over the unit circle and D = d/dtheta = x d/dy - y d/dx, L = D gamma/gamma = sum a_i D P_i/P_i
and (gamma'' + gamma)/gamma = D L + L^2 + 1.  Where every P_i > 0 this has the sign of a polynomial in the P_i and their derivatives.
K is convex if and only if that is >= 0 inside each smooth arc and L does not jump down across a seam (in the sense of
increasing theta); its boundary is C^1 if and only if L does not jump at all.
Source: R. Schneider (2014), Convex Bodies, section 1.7 (gauge and radial functions); the seam condition is the atomic part.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import sympy as sp

from duhem.examination.case import Case
from duhem.expression.branches import Branch, TooManyBranchesError, branches, thick
from duhem.positivity import Sense

__all__ = ["Profile", "profile"]

_MOST_ARCS = 24


@dataclass(frozen=True)
class Profile:
    """The gauge arc by arc: each branch's ``expr`` is a tuple of bases, ``exponents`` go with them."""

    case: Case
    x: sp.Symbol
    y: sp.Symbol
    bases: tuple[sp.Expr, ...]
    arcs: tuple[Branch, ...]
    exponents: tuple[sp.Rational, ...]
    method: str

    def turn(self, expr: sp.Expr) -> sp.Expr:
        """Derivative by theta of a function of (x, y) on the circle."""
        return self.x * sp.diff(expr, self.y) - self.y * sp.diff(expr, self.x)

    def slope(self, arc: Branch) -> sp.Expr:
        """L = gamma'/gamma on an arc."""
        return sp.Add(*(a * self.turn(p) / p for p, a in zip(arc.expr, self.exponents, strict=True)))

    def curvature(self, arc: Branch) -> sp.Expr:
        """(gamma'' + gamma)/gamma times prod P_i^2 on an arc: a polynomial in the bases and their derivatives."""
        bases, first = list(arc.expr), [self.turn(p) for p in arc.expr]
        second = [self.turn(d) for d in first]

        def others(*left_out: int) -> sp.Expr:
            return sp.Mul(*(p for k, p in enumerate(bases) if k not in left_out))

        bend = sp.Add(
            *(
                a * (p * d2 - d1**2) * others(i) ** 2
                for i, (a, p, d1, d2) in enumerate(zip(self.exponents, bases, first, second, strict=True))
            )
        )
        slope = sp.Add(*(a * d1 * others(i) for i, (a, d1) in enumerate(zip(self.exponents, first, strict=True))))
        return bend + slope**2 + others() ** 2

    def seams(self) -> Iterator[tuple[Branch, Branch, tuple[sp.Basic, ...]]]:
        """Ordered pairs of arcs (before, after) with the relations that say theta passes from one to the other."""
        for before in self.arcs:
            for after in self.arcs:
                crossed = [s for s, sign in after.signs.items() if before.signs.get(s) == -sign]
                if not crossed or before.expr == after.expr:
                    continue
                rest = {s: v for s, v in {**before.signs, **after.signs}.items() if s not in crossed}
                yield (
                    before,
                    after,
                    (
                        *(sp.Eq(s, 0) for s in crossed),
                        *(sp.StrictGreaterThan(after.signs[s] * self.turn(s), 0) for s in crossed),
                        *(sp.GreaterThan(v * s, 0) for s, v in rest.items()),
                    ),
                )

    def transversal(self) -> bool:
        """Whether every switch changes sign where it vanishes, so that each seam is seen by :meth:`seams`."""
        circle = (self.x, self.y)
        for switch in {s for arc in self.arcs for s in arc.signs}:
            if self.case.ask(self.turn(switch) ** 2, Sense.POSITIVE, sp.Eq(switch, 0), circle=circle).holds is not True:
                return False
        return True

    def differentiable(self) -> bool:
        """Whether every base has a derivative on its whole closed arc: no quotient or root in it degenerates there."""
        circle = (self.x, self.y)
        return all(
            self.case.ask(self.turn(p) ** 2, Sense.NONNEGATIVE, *arc.conditions(), circle=circle).holds is True
            for arc in self.arcs
            for p in arc.expr
        )

    def continuous(self) -> bool:
        """Whether the gauge is continuous across seams: built in unless a base has a ``where``."""
        return self.case.joined(*self.bases, circle=(self.x, self.y))


def profile(case: Case) -> Profile | None:
    """The polar form of the case's simple problem; None where it has none or its positivity is not proved."""
    problem, star = case.simple, case.star
    if star is None or len(problem.forces) != 2:
        return None
    if case.at_origin is not None and not case.nonnegative(-case.at_origin):
        return None  # the form says nothing of the origin itself, where a formula may jump
    x, y = problem.forces
    factors = star.factors()
    try:
        arcs = thick(branches(sp.Tuple(*(p for p, _ in factors)), _MOST_ARCS))
    except TooManyBranchesError:
        return None
    used = set()
    for arc in arcs:
        for base in arc.expr:
            answer = case.ask(base, Sense.POSITIVE, *arc.conditions(), circle=(x, y))
            if answer.holds is not True:
                return None
            used.add(answer.method)
    found = Profile(case, x, y, tuple(p for p, _ in factors), arcs, tuple(a for _, a in factors), "polar-curvature")
    return found if found.transversal() and found.continuous() else None
