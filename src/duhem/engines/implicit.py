"""Proofs on the boundary as an implicit surface, for one smooth formula without a gauge to read off.

Star-shape first: if g < 0 at the origin and sigma . grad g > 0 wherever g = 0, each ray leaves K once, so K is the
region inside its boundary and convexity is local (Tietze 1928, Nakajima 1928): the second derivative of g along
every tangent must be >= 0 on the boundary.
"""

from __future__ import annotations

import sympy as sp

from duhem.examination import Case
from duhem.expression.branches import Branch
from duhem.positivity import Sense
from duhem.verdict import Evidence, Verdict

__all__ = ["convexity", "dissipation", "hessian", "smoothness"]


def convexity(case: Case) -> Evidence | None:
    """Tangential second derivatives >= 0 on the boundary of a set star-shaped about the origin."""
    piece = _one_piece(case)
    if piece is None or not _star(case, piece):
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
    return Evidence(Verdict.PROVED, f"implicit-curvature ({answer.method})", "K is star-shaped about 0 and its boundary curves inward everywhere")


def hessian(case: Case) -> Evidence | None:
    """g is convex: second derivatives >= 0 inside every branch, no downward jump of the gradient across a seam."""
    pieces = case.pieces
    if pieces is None or len(pieces) > 8:
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
    for before in pieces:
        for after in pieces:
            crossed = [s for s, sign in after.signs.items() if sign > 0 and before.signs.get(s) == -1]
            if not crossed or before.expr == after.expr:
                continue
            rest = [sp.GreaterThan(sign * s, 0) for s, sign in {**before.signs, **after.signs}.items() if s not in crossed]
            where = (*(sp.Eq(s, 0) for s in crossed), *rest)
            jump = sum(sp.diff(after.expr - before.expr, x) * sp.diff(crossed[0], x) for x in forces)
            steps = [case.ask(after.expr - before.expr, Sense.ZERO, *where), case.ask(jump, Sense.NONNEGATIVE, *where)]
            if any(step.holds is not True for step in steps):
                return None
    return Evidence(Verdict.PROVED, f"hessian ({', '.join(sorted(used))})", "g is convex: second derivatives >= 0 on each branch, gradient never jumps down")


def smoothness(case: Case) -> Evidence | None:
    """One smooth formula with non-vanishing gradient on the boundary."""
    piece = _one_piece(case)
    if piece is None:
        return None
    gradient = [sp.diff(piece.expr, x) for x in case.simple.forces]
    answer = case.ask(sum(d**2 for d in gradient), Sense.POSITIVE, sp.Eq(piece.expr, 0))
    if answer.holds is not True:
        return None
    return Evidence(Verdict.PROVED, f"regular-value ({answer.method})", "g is smooth and grad g != 0 wherever g = 0")


def dissipation(case: Case) -> Evidence | None:
    """force . flow >= 0 on the boundary, branch by branch; the flow is grad g unless the law has one of its own."""
    problem = case.simple
    pieces = case.pieces
    if pieces is None:
        return None
    used: set[str] = set()
    for piece in pieces:
        flow = problem.flow or tuple(sp.diff(piece.expr, x) for x in problem.forces)
        power = sp.Add(*(x * d for x, d in zip(problem.forces, flow, strict=True)))
        answer = case.ask(sp.factor_terms(sp.expand(power)), Sense.NONNEGATIVE, *piece.conditions(), sp.Eq(piece.expr, 0))
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


