"""Convexity of piecewise affine laws: K is the intersection of the half-spaces of its faces.

Let g be continuous and affine on finitely many polyhedral cells, l_j on cell j, and J the cells on which l_j vanishes
on a set of dimension d - 1.  If some z has g(z) < 0 and l_j(z) < 0 for all j in J, then a segment that leaves K for
good passes such a face into l_j > 0 (generically: it avoids what has a lower dimension), and stays there.  So K contains
the intersection of the half-spaces {l_j <= 0}, j in J; if it also lies in each of them it is that intersection.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from duhem.expression import Where
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Verdict
from tests.oracles.prover.affine import Affine

__all__ = ["convexity"]


def convexity(subject: FormulaSubject) -> Evidence | None:
    """K is the intersection of the half-spaces that its faces span."""
    g, forces, pieces = subject.simple.g, subject.simple.forces, subject.pieces
    if pieces is None or len(pieces) < 2 or subject.simple.parameters or g.has(Where):
        return None
    exprs = [p.expr for p in pieces] + [s for p in pieces for s in p.signs]
    if not all(e.is_polynomial(*forces) and sp.Poly(e, *forces).total_degree() <= 1 for e in exprs):
        return None
    if not all(c.is_Rational for e in exprs for c in sp.Poly(e, *forces).coeffs()):
        return None
    space = Affine(forces, subject.budget)
    faces: dict[sp.Expr, None] = {}
    for piece in pieces:
        if not piece.expr.free_symbols:
            if piece.expr.is_zero:
                return None  # g = 0 on the whole cell
            continue
        beside = any(_plane(piece.expr, forces) == _plane(s, forces) for s in piece.signs if s.free_symbols)
        if beside or space.solution((piece.expr, "=="), *((sign * s, ">") for s, sign in piece.signs.items())) is not False:
            faces.setdefault(piece.expr)
    if not faces or not isinstance(space.solution((g, "<"), *((face, "<") for face in faces)), dict):
        return None
    if any(space.solution((g, "<="), (face, ">")) is not False for face in faces):
        return None
    return Evidence(Verdict.PROVED, "polyhedral (smt-z3)", f"K is the intersection of the {len(faces)} half-spaces that its faces span")


def _plane(expr: sp.Expr, forces: Sequence[sp.Symbol]) -> sp.Poly:
    """The same for all multiples of an affine expression."""
    return sp.Poly(expr, *forces, domain="QQ").monic()
