"""A corner of the boundary, held in a box of a plane, with the two normals that meet there provably not parallel.

The plane cuts g into smooth pieces.  Two of them that meet along a seam have a common zero in the box, and there the zeros of each
cross the seam: so points of the boundary come to the corner from both sides of it.  At these g is differentiable in all forces, with
gradients that stay bounded and whose parts in the plane are not parallel; so the unit normal of K is not continuous.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression.balls import ball, certain_sign, enclose, precision
from duhem.expression.branches import Seam, seams
from duhem.expression.gradient import jacobian
from duhem.expression.text import formula
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.facts.plane_section import LocalPiece, PlaneSection, local_pieces
from duhem.proof.verdict import Witness
from duhem.proof.witness.rational_points import decimal_pair, describe

__all__ = ["corner"]

_BITS = 256
_BESIDE = Fraction(1, 2**30)  # how far from the corner two more points say in which plane it is seen
_BOXES = ((1000, Fraction(1, 2**30)), (10**25, Fraction(1, 2**40)))  # greatest denominator of the centre, radius


def corner(subject: FormulaSubject, parameters: Values, section: PlaneSection, near: Sequence[Fraction], jumps: bool) -> Witness | None:
    """The corner near a place of a plane of forces, on a seam with one switch.

    Where g ``jumps``, only one between the boundary of one piece and the seam, which g does not cross.
    """
    for limit, radius in _BOXES:
        place = [c.limit_denominator(limit) for c in near]
        with precision(_BITS):
            centre = {x: ball(c) for x, c in zip(section.at, place, strict=True)}
            box = {x: ball(c - radius, c + radius) for x, c in zip(section.at, place, strict=True)}
            for seam in seams(local_pieces(subject, parameters, section, box)):
                if len(seam.crossed) != 1 or seam.kept:
                    continue
                normals = _normals(seam, section, centre, box, radius, jumps)
                if normals is not None:
                    return _shown(subject, parameters, section, place, radius, seam.crossed[0], normals)
    return None


def _defined(piece: LocalPiece, switch: sp.Expr, box: Any) -> bool:
    """Whether the formula as written has a value on this side of the seam, over the box; on the seam itself it may be 0/0."""
    for expr, sense in piece.needed:
        sign = _beside(expr, switch, piece.signs[switch], box)
        if sign is None or (sign != 1 if sense is not Sense.ZERO else sign == 0):
            return False
    return True


def _beside(expr: sp.Expr, switch: sp.Expr, side: int, box: Any) -> int | None:
    """The sign of an expression where the switch has the sign ``side``: powers of the switch are taken out of it."""
    sign = 1
    for factor in (expr,) if not switch.is_Symbol else sp.Mul.make_args(sp.factor_terms(sp.expand(expr))):
        base, exponent = factor.as_base_exp()
        own = side ** int(exponent % 2) if base == switch and exponent.is_Integer else certain_sign(enclose(factor, box))
        if own is None:
            return None
        sign *= own
    return sign


def _normals(seam: Seam, section: PlaneSection, centre: Any, box: Any, radius: Fraction, jumps: bool) -> list[list[Any]] | None:
    """Outward normals of the two sides over the box in all forces, surely not parallel in the plane; None if that is open."""
    (switch,), (before, after) = seam.crossed, (seam.before, seam.after)
    assert isinstance(before, LocalPiece) and isinstance(after, LocalPiece)
    system = [after.expr, switch]
    if (slopes := jacobian(system, section.at)) is None or not _has_zero(sp.Matrix(system), slopes, centre, box, radius):
        return None
    if not all(_defined(piece, switch, box) for piece in (before, after)):
        return None
    along, one, two = ([enclose(sp.diff(e, x), box) for x in section.at] for e in (switch, before.expr, after.expr))
    full = [[enclose(c, box) for c in piece.gradient] for piece in (before, after)]
    side = certain_sign(enclose(before.expr, box))
    if side in (-1, 1) and len(section.forces) == 2:  # K ends on the seam: towards `before` if that is outside, else towards `after`
        one = full[0] = [-side * after.signs[switch] * c for c in along]
        crossing = [two]
    elif not jumps and enclose(before.expr - after.expr, box).contains(0):
        crossing = [one, two]
    else:
        return None
    certain = all(certain_sign(_cross(n, along)) in (-1, 1) for n in crossing) and certain_sign(_cross(one, two)) in (-1, 1)
    return full if certain and all(c.is_finite() for n in full for c in n) else None


def _shown(
    subject: FormulaSubject,
    parameters: Values,
    section: PlaneSection,
    place: Sequence[Fraction],
    radius: Fraction,
    switch: sp.Expr,
    normals: list[list[Any]],
) -> Witness:
    at = subject.values_at(parameters, section.point(place))
    one, two = normals
    across, dot = _across(one, two), sum(a * b for a, b in zip(one, two, strict=True))
    points, where = {"corner": at}, f"on {formula(switch)} = 0"
    if len(subject.problem.forces) > 2:
        step = _BESIDE / max(abs(c) for way in section.along for c in way)  # where the law has ranges, they are in them
        spanned = (section.point((place[0] + step, place[1])), section.point((place[0], place[1] + step)))
        points |= {role: subject.values_at(parameters, p) for role, p in zip(("u", "v"), spanned, strict=True)}
        where = "in the plane through it, u and v"
    return Witness(
        parameters=describe(subject, at, forces=False),
        points={role: describe(subject, p) for role, p in points.items()},
        values={
            "n1 x n2" if len(one) == 2 else "|n1 x n2|^2": decimal_pair(across),
            **{f"n{i}_{x}": decimal_pair(c) for i, n in ((1, one), (2, two)) for x, c in zip(section.forces, n, strict=True)},
        },
        statement=f"within {radius} of this point the boundary has a corner {where}: the normals n1, n2 of its two sides are not parallel",
        measures={"corner_degrees": math.degrees(math.atan2(_size(across, len(one)), float(dot.mid())))},
    )


def _size(across: Any, dimension: int) -> float:
    return abs(float(across.mid())) if dimension == 2 else math.sqrt(abs(float(across.mid())))


def _across(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """Their cross product; in more than two forces its square, the sum of all minors' squares."""
    if len(a) == 2:
        return _cross(a, b)
    minors = [a[i] * b[j] - a[j] * b[i] for j in range(len(a)) for i in range(j)]
    return sum((m * m for m in minors), ball(Fraction(0)))


def _cross(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return a[0] * b[1] - a[1] * b[0]


def _has_zero(system: Any, jacobian: Any, centre: Any, box: Any, radius: Fraction) -> bool:
    """Interval Newton: centre - J(box)^-1 F(centre) inside the box shows exactly one zero there (Moore 1966)."""
    f = [enclose(e, centre) for e in system]
    a, b, c, d = (enclose(e, box) for e in jacobian)
    det = a * d - b * c
    if certain_sign(det) not in (-1, 1):
        return False
    steps = [(d * f[0] - b * f[1]) / det, (a * f[1] - c * f[0]) / det]
    return all(step.is_finite() and abs(step) < ball(radius) for step in steps)
