"""Laws whose set is star-shaped by their form, with the gauge that can be read off it."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from duhem.expression.dimensions import degree
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import fact
from duhem.proof.statement import Problem

__all__ = ["Star", "by_degree", "star_form"]


@dataclass(frozen=True)
class Star:
    """A law whose set is star-shaped by its form: g = A - B with A, B homogeneous in the forces, of degrees a > b, B > 0.

    ``upper`` = A, ``lower`` = B, ``order`` = a - b; B > 0 and A > 0 remain to be shown.  Then K = {0} with
    {r : r^(a-b) A/B <= 1 along each direction}, the gauge is (A/B)^(1/(a-b)), and on the boundary sigma . grad g = (a - b) A > 0
    (Euler): the boundary is regular and seen from the origin.
    """

    upper: sp.Expr
    lower: sp.Expr
    order: sp.Rational

    def factors(self) -> tuple[tuple[sp.Expr, sp.Rational], ...]:
        """The gauge as a product of powers: pairs (base, exponent)."""
        raised = [(self.upper, 1 / self.order), (self.lower, -1 / self.order)]
        found: dict[sp.Expr, sp.Rational] = {}
        for expr, exponent in raised:
            for factor in sp.Mul.make_args(sp.factor_terms(expr)):
                base, power = (factor.base, factor.exp) if factor.is_Pow and factor.exp.is_Rational else (factor, sp.S.One)
                found[base] = found.get(base, sp.S.Zero) + power * exponent
        # A base that cancels between A and B stays, with exponent 0: that it is positive must still be shown.
        return tuple((b, e) for b, e in found.items() if not (b.is_number and b.is_positive))


@fact
def star_form(subject: FormulaSubject) -> Star | None:
    """Split g of the simple problem by degree in the forces; None unless there are exactly two degrees."""
    parts = by_degree(subject.simple)
    if parts is None or len(parts) != 2:
        return None
    low, high = sorted(parts)
    return Star(parts[high], -parts[low], high - low)


def by_degree(problem: Problem) -> dict[sp.Rational, sp.Expr] | None:
    """The parts of g of each degree in the forces; None where something in it has none."""
    found: dict[sp.Rational, list[sp.Expr]] = {}
    for term in sp.Add.make_args(sp.expand(problem.g, deep=False)):
        k = degree(term, problem.forces) if term.free_symbols & set(problem.forces) else sp.S.Zero
        if k is None:
            return None
        found.setdefault(k, []).append(term)
    return {k: sp.Add(*terms) for k, terms in found.items()}
