"""Proofs on the boundary as an implicit surface, where there is no gauge to read off, by deciders: the kernel has no rule for them.

Star-shape first: if g < 0 at the origin and sigma . grad g > 0 wherever g = 0, each ray leaves K once, so K is the
region inside its boundary and convexity is local (Tietze 1928, Nakajima 1928): the second derivative of g along
every tangent must be >= 0 on the boundary.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

import sympy as sp

from duhem.expression.branches import Branch, seam, seams
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Verdict
from tests.oracles.prover.where import interior, on, within

__all__ = ["convexity", "hessian"]

_MOST_PIECES = 8


def convexity(subject: FormulaSubject) -> Evidence | None:
    """Tangential second derivatives >= 0 on the boundary of a set star-shaped about the origin, no kink inward on a seam.

    Of closed branches: strictly inside them there may be no boundary at all, and then nothing would have been asked.
    """
    pieces, forces = subject.pieces, subject.simple.forces
    if pieces is None or len(pieces) > (_MOST_PIECES if len(forces) == 2 else 1) or not subject.continuous or not _star(subject, pieces):
        return None
    if len(forces) == 1:
        return Evidence(Verdict.PROVED, "implicit-curvature", "K is an interval: star-shaped about 0 on a line")
    used: set[str] = set()
    for piece in pieces:
        bend, tangential = _bend(piece.expr, forces)
        on_boundary = (sp.Eq(piece.expr, 0), *tangential)
        answer = subject.ask(bend, Sense.NONNEGATIVE, *on_boundary, *piece.conditions())
        if answer.holds is not True and _crossed(subject, piece):
            answer = subject.ask(bend, Sense.NONNEGATIVE, *on_boundary, *interior(piece))
        if answer.holds is not True:
            return None
        used.add(answer.method)
    if not all(_outward_kink(subject, before, after) for before, after in permutations(pieces, 2)):
        return None
    seams_too = "" if len(pieces) == 1 else " and kinks outward on every seam"
    return Evidence(
        Verdict.PROVED,
        f"implicit-curvature ({', '.join(sorted(used))})",
        f"K is star-shaped about 0 and its boundary curves inward everywhere{seams_too}",
    )


def _crossed(subject: FormulaSubject, piece: Branch) -> bool:
    """Whether the boundary only passes across the seams of a branch (two forces), never along: then its inside tells all of it."""
    if len(subject.simple.forces) != 2:
        return False
    x, y = subject.simple.forces
    for switch in piece.signs:
        across = sp.diff(piece.expr, x) * sp.diff(switch, y) - sp.diff(piece.expr, y) * sp.diff(switch, x)
        on_both = (sp.Eq(piece.expr, 0), sp.Eq(switch, 0), *piece.conditions())
        if subject.ask(across**2, Sense.POSITIVE, *on_both).holds is not True:
            return False
    return True


def _bend(g: sp.Expr, forces: tuple[sp.Symbol, ...]) -> tuple[sp.Expr, tuple[sp.Basic, ...]]:
    """Second derivative of g along a tangent of its level set, and what makes that a tangent."""
    gradient = [sp.diff(g, x) for x in forces]
    given: tuple[sp.Basic, ...] = ()
    if len(forces) == 2:
        tangent: list[sp.Expr] = [-gradient[1], gradient[0]]
    else:
        tangent = [sp.Dummy(f"v{i}", real=True) for i in range(len(forces))]
        given = (sp.Eq(sum(v * d for v, d in zip(tangent, gradient, strict=True)), 0),)
    return sum(tangent[i] * tangent[j] * sp.diff(gradient[i], forces[j]) for i in range(len(forces)) for j in range(len(forces))), given


def _outward_kink(subject: FormulaSubject, before: Branch, after: Branch) -> bool:
    """Whether the boundary, run through with K on its left, turns left where it passes from one branch to another (two forces).

    The tangent (-g_y, g_x) of either branch then points into `after`, which is assumed, and T/E = gamma'/gamma with
    E = sigma . grad g > 0 and T = x g_y - y g_x does not fall.
    """
    if before.expr == after.expr:
        return True
    if (found := seam(before, after)) is None:
        return False
    x, y = subject.simple.forces
    (bx, by), (ax, ay) = ([sp.diff(b.expr, v) for v in (x, y)] for b in (before, after))
    on_seam = [sp.Eq(before.expr, 0), *on(found), *within(found)]
    for s in found.crossed:
        sx, sy = (after.signs[s] * sp.diff(s, v) for v in (x, y))
        on_seam += [sp.GreaterThan(sy * ax - sx * ay, 0), sp.GreaterThan(sy * bx - sx * by, 0)]
    turn = (x * ay - y * ax) * (x * bx + y * by) - (x * by - y * bx) * (x * ax + y * ay)
    return sp.false in on_seam or subject.ask(turn, Sense.NONNEGATIVE, *(r for r in on_seam if r is not sp.true)).holds is True


def hessian(subject: FormulaSubject) -> Evidence | None:
    """g is convex: second derivatives >= 0 inside every branch, no downward jump of the gradient across a seam."""
    pieces = subject.pieces
    if pieces is None or len(pieces) > _MOST_PIECES or not subject.continuous:
        return None
    forces = subject.simple.forces
    used: set[str] = set()
    v = [sp.Dummy(f"v{i}", real=True) for i in range(len(forces))]
    for piece in pieces:
        bend = sum(v[i] * v[j] * sp.diff(piece.expr, a, b) for i, a in enumerate(forces) for j, b in enumerate(forces))
        answer = subject.ask(bend, Sense.NONNEGATIVE, *interior(piece))
        if answer.holds is not True:
            return None
        used.add(answer.method)
    for between in seams(pieces):
        where = (*within(between), *on(between))
        rise = [sp.diff(between.after.expr - between.before.expr, x) for x in forces]
        for switch in between.crossed:
            if not _regular(subject, switch, where):
                return None
            jump = between.after.signs[switch] * sp.Add(*(r * sp.diff(switch, x) for r, x in zip(rise, forces, strict=True)))
            if subject.ask(jump, Sense.NONNEGATIVE, *where).holds is not True:
                return None
    return Evidence(
        Verdict.PROVED,
        f"hessian ({', '.join(sorted(used))})",
        "g is convex: second derivatives >= 0 on each branch, gradient never jumps down",
    )


def _regular(subject: FormulaSubject, switch: sp.Expr, where: Sequence[sp.Basic]) -> bool:
    """Whether the gradient of a switch shows the seam's normal: it vanishes on no more than a set of lower dimension."""
    forces = subject.simple.forces
    if switch.is_polynomial(*forces) and (form := sp.Poly(switch, *forces)).domain in (sp.ZZ, sp.QQ):
        return bool(form.is_sqf)
    return subject.ask(sp.Add(*(sp.diff(switch, x) ** 2 for x in forces)), Sense.POSITIVE, *where).holds is True


def _star(subject: FormulaSubject, pieces: Sequence[Branch]) -> bool:
    """Whether 0 is inside K and g rises outward wherever it is 0, so that each ray leaves K once."""
    forces = subject.simple.forces
    if subject.at_origin is None or not subject.positive(-subject.at_origin):
        return False
    return all(
        subject.ask(sum(x * sp.diff(p.expr, x) for x in forces), Sense.POSITIVE, sp.Eq(p.expr, 0), *p.conditions()).holds is True
        for p in pieces
    )
