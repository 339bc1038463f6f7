"""Star-shaped laws in two forces, in polar form: gamma'' + gamma >= 0 as a measure on the circle.

With the gauge gamma = prod P_i^a_i over the unit circle and D = d/dtheta = x d/dy - y d/dx, L = D gamma/gamma = sum a_i D P_i/P_i
and (gamma'' + gamma)/gamma = D L + L^2 + 1.  Where every P_i > 0 this has the sign of a polynomial in the P_i and their derivatives.
K is convex if and only if that is >= 0 inside each smooth arc and L does not jump down across a seam (in the sense of
increasing theta); its boundary is C^1 if and only if L does not jump at all.
Source: R. Schneider (2014), Convex Bodies, section 1.7 (gauge and radial functions); the seam condition is the atomic part.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, permutations
from math import lcm

import sympy as sp

from duhem.expression import Norm, Where
from duhem.expression.branches import Branch, TooManyBranchesError, branches, plain_switches, seam
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import fact
from tests.oracles.prover.star import star_form
from tests.oracles.prover.where import on, within

__all__ = ["PolarForm", "polar_form"]

_MOST_ARCS = 24


@dataclass(frozen=True)
class PolarArc(Branch):
    """Where the gauge is the product of the bases in ``expr`` to the powers in ``exponents``."""

    exponents: tuple[sp.Rational, ...]


@dataclass(frozen=True)
class PolarForm:
    """The gauge arc by arc; ``thin`` holds the branches without an inside, which count where the formula might jump."""

    subject: FormulaSubject
    x: sp.Symbol
    y: sp.Symbol
    arcs: tuple[PolarArc, ...]
    thin: tuple[PolarArc, ...] = ()

    def turn(self, expr: sp.Expr) -> sp.Expr:
        """Derivative by theta of a function of (x, y) on the circle."""
        return self.x * sp.diff(expr, self.y) - self.y * sp.diff(expr, self.x)

    def gauge(self, arc: PolarArc) -> sp.Expr:
        """gamma on an arc, as a formula that is of degree 1 everywhere."""
        return sp.Mul(*(p**a for p, a in zip(arc.expr, arc.exponents, strict=True)))

    def slope(self, arc: PolarArc) -> sp.Expr:
        """L = gamma'/gamma on an arc."""
        return sp.Add(*(a * self.turn(p) / p for p, a in zip(arc.expr, arc.exponents, strict=True)))

    def curvature(self, arc: PolarArc) -> sp.Expr:
        """(gamma'' + gamma)/gamma times prod P_i^2 on an arc: a polynomial in the bases and their derivatives."""
        bases, first = list(arc.expr), [self.turn(p) for p in arc.expr]
        second = [self.turn(d) for d in first]

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

    def seams(self) -> Iterator[tuple[PolarArc, PolarArc, tuple[sp.Basic, ...]]]:
        """Ordered pairs of arcs (before, after) with the relations that say theta passes from one to the other."""
        for before, after in permutations(self.arcs, 2):
            found = seam(before, after)
            if found is not None and not _same(before, after):
                forward = (sp.StrictGreaterThan(after.signs[s] * self.turn(s), 0) for s in found.crossed)
                yield before, after, (*on(found), *forward, *within(found))

    def transversal(self) -> bool:
        """Whether every switch changes sign where it vanishes, so that each seam is seen by :meth:`seams`."""
        circle = (self.x, self.y)
        for switch in {s for arc in self.arcs for s in arc.signs}:
            if self.subject.ask(self.turn(switch) ** 2, Sense.POSITIVE, sp.Eq(switch, 0), circle=circle).holds is not True:
                return False
        return True

    def differentiable(self) -> bool:
        """Whether every base has a derivative on its whole closed arc: no quotient or root in it degenerates there."""
        circle = (self.x, self.y)
        return all(
            self.subject.ask(self.turn(p) ** 2, Sense.NONNEGATIVE, *arc.conditions(), circle=circle).holds is True
            for arc in self.arcs
            for p in arc.expr
        )

    def continuous(self) -> bool:
        """Whether the gauge is the same from both sides wherever two of its branches meet."""
        circle = (self.x, self.y)
        return all(
            self.subject.ask(_quotient_gap(one, two), Sense.ZERO, *one.conditions(), *two.conditions(), circle=circle).holds is True
            for one, two in combinations((*self.arcs, *self.thin), 2)
            if not _same(one, two)
        )


@fact
def polar_form(subject: FormulaSubject) -> PolarForm | None:
    """The polar form of the subject's simple problem; None where it has none or its positivity is not proved (in time)."""
    problem, star = subject.simple, star_form(subject)
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
    arcs, thin = (tuple(a for a in pieces if (0 in a.signs.values()) is flat) for flat in (False, True))
    form = PolarForm(subject, x, y, arcs, thin)
    jumps = any(p.has(Where) for p, _ in factors)
    return form if form.transversal() and (not jumps or form.continuous()) else None


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


def _same(one: PolarArc, two: PolarArc) -> bool:
    return (one.expr, one.exponents) == (two.expr, two.exponents)


def _quotient_gap(one: PolarArc, two: PolarArc) -> sp.Expr:
    """Zero exactly where two products of positive bases agree: both to the power that makes it integer, cleared of quotients."""
    powers = [*zip(one.expr, one.exponents, strict=True), *((p, -a) for p, a in zip(two.expr, two.exponents, strict=True))]
    whole = lcm(*(int(a.q) for _, a in powers))
    over, under = (sp.Mul(*(p ** abs(whole * a) for p, a in powers if a * sense > 0)) for sense in (1, -1))
    return over - under
