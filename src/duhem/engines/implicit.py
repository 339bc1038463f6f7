"""Proofs on the boundary as an implicit surface, for one smooth formula without a gauge to read off.

Star-shape first: if g < 0 at the origin and sigma . grad g > 0 wherever g = 0, each ray leaves K once, so K is the
region inside its boundary and convexity is local (Tietze 1928, Nakajima 1928): the second derivative of g along
every tangent must be >= 0 on the boundary.
"""

from __future__ import annotations

from itertools import combinations

import sympy as sp

from duhem.examination import Case
from duhem.expression.branches import Branch, seams
from duhem.positivity import Sense
from duhem.verdict import Evidence, Verdict

__all__ = ["convexity", "dissipation", "hessian", "smoothness"]


def convexity(case: Case) -> Evidence | None:
    """Tangential second derivatives >= 0 on the boundary of a set star-shaped about the origin."""
    piece = _one_piece(case)
    if piece is None or not case.continuous or not _star(case, piece):
        return None
    forces = case.simple.forces
    gradient = [sp.diff(piece.expr, x) for x in forces]
    if len(forces) == 1:
        return Evidence(Verdict.PROVED, "implicit-curvature", "K is an interval: star-shaped about 0 on a line")
    if len(forces) == 2:
        tangent: list[sp.Expr] = [-gradient[1], gradient[0]]
        given: tuple[sp.Basic, ...] = (sp.Eq(piece.expr, 0),)
    else:
        tangent = [sp.Dummy(f"v{i}", real=True) for i in range(len(forces))]
        given = (sp.Eq(piece.expr, 0), sp.Eq(sum(v * d for v, d in zip(tangent, gradient, strict=True)), 0))
    bend = sum(tangent[i] * tangent[j] * sp.diff(gradient[i], forces[j]) for i in range(len(forces)) for j in range(len(forces)))
    answer = case.ask(bend, Sense.NONNEGATIVE, *given)
    if answer.holds is not True:
        return None
    return Evidence(
        Verdict.PROVED, f"implicit-curvature ({answer.method})", "K is star-shaped about 0 and its boundary curves inward everywhere"
    )


def hessian(case: Case) -> Evidence | None:
    """g is convex: second derivatives >= 0 inside every branch, no downward jump of the gradient across a seam."""
    pieces = case.pieces
    if pieces is None or len(pieces) > 8 or not case.continuous:
        return None
    forces = case.simple.forces
    used: set[str] = set()
    v = [sp.Dummy(f"v{i}", real=True) for i in range(len(forces))]
    for piece in pieces:
        bend = sum(v[i] * v[j] * sp.diff(piece.expr, a, b) for i, a in enumerate(forces) for j, b in enumerate(forces))
        answer = case.ask(bend, Sense.NONNEGATIVE, *piece.conditions(strict=True))
        if answer.holds is not True:
            return None
        used.add(answer.method)
    for before, after, crossed, shared in seams(pieces):
        where = (*shared, *(sp.Eq(s, 0) for s in crossed))
        rise = [sp.diff(after.expr - before.expr, x) for x in forces]
        for switch in crossed:
            jump = after.signs[switch] * sp.Add(*(r * sp.diff(switch, x) for r, x in zip(rise, forces, strict=True)))
            if case.ask(jump, Sense.NONNEGATIVE, *where).holds is not True:
                return None
    return Evidence(
        Verdict.PROVED,
        f"hessian ({', '.join(sorted(used))})",
        "g is convex: second derivatives >= 0 on each branch, gradient never jumps down",
    )


def smoothness(case: Case) -> Evidence | None:
    """grad g does not vanish on the boundary and keeps its direction across every seam that the boundary crosses."""
    pieces, forces = case.pieces, case.simple.forces
    if pieces is None or len(pieces) > 8 or not case.continuous:
        return None
    used: set[str] = set()
    for piece in pieces:
        gradient = [sp.diff(piece.expr, x) for x in forces]
        answer = case.ask(sp.Add(*(d**2 for d in gradient)), Sense.POSITIVE, *piece.conditions(), sp.Eq(piece.expr, 0))
        if answer.holds is not True:
            return None
        used.add(answer.method)
    for before, after, crossed, where in seams(pieces):
        one, two = ([sp.diff(b.expr, x) for x in forces] for b in (before, after))
        on_seam = (*where, *(sp.Eq(s, 0) for s in crossed), sp.Eq(before.expr, 0))
        minors = [one[i] * two[j] - one[j] * two[i] for i, j in combinations(range(len(forces)), 2)]
        if any(case.ask(m, Sense.ZERO, *on_seam).holds is not True for m in (after.expr, *minors)):
            return None
        if case.ask(sp.Add(*(p * q for p, q in zip(one, two, strict=True))), Sense.POSITIVE, *on_seam).holds is not True:
            return None
    told = "" if len(pieces) == 1 else ", with one direction on both sides of each seam"
    return Evidence(Verdict.PROVED, f"regular-value ({', '.join(sorted(used))})", f"grad g != 0 wherever g = 0{told}")


def dissipation(case: Case) -> Evidence | None:
    """force . flow >= 0 on the boundary, branch by branch; the flow is grad g unless the law has one of its own."""
    problem = case.simple
    pieces = case.pieces
    if pieces is None or not case.continuous:
        return None
    used: set[str] = set()
    for piece in pieces:
        gradient = tuple(sp.diff(piece.expr, x) for x in problem.forces)
        on_boundary = (*piece.conditions(), sp.Eq(piece.expr, 0))
        flow = problem.flow or gradient
        if flow is gradient and case.ask(sp.Add(*(d**2 for d in flow)), Sense.POSITIVE, *on_boundary).holds is not True:
            return None  # where grad g = 0 it says nothing of the normal
        power = sp.Add(*(x * d for x, d in zip(problem.forces, flow, strict=True)))
        answer = case.ask(sp.factor_terms(sp.expand(power)), Sense.NONNEGATIVE, *on_boundary)
        if answer.holds is not True:
            return None
        used.add(answer.method)
    return Evidence(Verdict.PROVED, f"boundary-power ({', '.join(sorted(used))})", "force . flow >= 0 wherever g = 0")


def _one_piece(case: Case) -> Branch | None:
    return case.pieces[0] if case.pieces is not None and len(case.pieces) == 1 and not case.pieces[0].signs else None


def _star(case: Case, piece: Branch) -> bool:
    forces = case.simple.forces
    if not case.positive(-piece.expr.xreplace(dict.fromkeys(forces, sp.S.Zero))):
        return False
    power = sum(x * sp.diff(piece.expr, x) for x in forces)
    return case.ask(power, Sense.POSITIVE, sp.Eq(piece.expr, 0)).holds is True
