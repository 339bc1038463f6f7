"""Whether a quadratic polynomial in the forces has a positive semidefinite matrix for every parameter."""

from __future__ import annotations

from collections.abc import Collection

import sympy as sp

from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject

__all__ = ["semidefinite"]


def semidefinite(expr: sp.Expr, variables: Collection[sp.Symbol], subject: FormulaSubject, root: bool = False) -> bool:
    """Whether that is shown of a polynomial of degree 2; with ``root``, of its form with one variable more, so that it is >= 0."""
    forces = sorted(variables, key=str)
    if not expr.is_polynomial(*forces):
        return False
    form = sp.Poly(expr, *forces)
    if form.total_degree() != 2:
        return False
    if root:
        whole = form.homogenize(sp.Dummy("t", real=True)).as_expr()
    else:
        whole = sum(c * sp.prod(x**k for x, k in zip(forces, m, strict=True)) for m, c in form.terms() if sum(m) == 2)
    return subject.ask(whole, Sense.NONNEGATIVE).holds is True
