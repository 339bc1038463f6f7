"""A corner of the boundary, held in a box, with the two normals that meet there provably not parallel (two forces)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression.balls import ball, certain_sign, enclose, precision
from duhem.expression.branches import Seam
from duhem.expression.text import formula
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values, rationals
from duhem.proof.verdict import Witness
from duhem.proof.witness.rational_points import decimal_pair, describe

__all__ = ["corner"]

_BITS = 256
_BOXES = ((1000, Fraction(1, 2**30)), (10**25, Fraction(1, 2**40)))  # greatest denominator of the centre, radius


def corner(subject: FormulaSubject, parameters: Values, seam: Seam, near: Sequence[Fraction], jumps: bool) -> Witness | None:
    """The corner on a seam with one switch, near a point.

    Where g ``jumps``, only one between the boundary of one branch and the seam, which g does not cross.
    """
    forces, exact = subject.simple.forces, rationals(parameters)
    (switch,) = seam.crossed
    system = sp.Matrix([seam.after.expr, switch]).subs(exact)
    jacobian = system.jacobian(list(forces))
    for limit, radius in _BOXES:
        at = subject.values_at(parameters, [c.limit_denominator(limit) for c in near])
        centre = {x: ball(v) for x, v in at.items()}
        with precision(_BITS):
            box = {**centre, **{x: ball(at[x] - radius, at[x] + radius) for x in forces}}
            if not _has_zero(system, jacobian, centre, box, radius):
                continue
            if subject.doubtful and not enclose(subject.problem.stated, box).is_finite():
                continue
            if any(certain_sign(enclose(v * s, box)) != 1 for s, v in seam.kept.items()):
                continue
            normals = _normals(seam, forces, centre, box, jumps)
            if normals is None:
                continue
            one, two = normals
            angle = math.degrees(math.atan2(abs(float(_cross(one, two).mid())), float((one[0] * two[0] + one[1] * two[1]).mid())))
            return Witness(
                parameters=describe(subject, at, forces=False),
                points={"corner": describe(subject, at)},
                values={
                    "n1 x n2": decimal_pair(_cross(one, two)),
                    **{f"n{i}_{x}": decimal_pair(c) for i, n in ((1, one), (2, two)) for x, c in zip(forces, n, strict=True)},
                },
                statement=f"within {radius} of this point the boundary has a corner on {formula(switch)} = 0: "
                "the normals n1, n2 of its two sides are not parallel",
                measures={"corner_degrees": angle},
            )
    return None


def _normals(seam: Seam, forces: Sequence[sp.Symbol], centre: Any, box: Any, jumps: bool) -> tuple[list[Any], list[Any]] | None:
    """Outward normals of the two sides over the box, surely not parallel and neither along the seam's own; None if that is open."""
    (switch,) = seam.crossed
    along = [enclose(sp.diff(switch, x), box) for x in forces]
    two = [enclose(sp.diff(seam.after.expr, x), box) for x in forces]
    side = certain_sign(enclose(seam.before.expr, box))
    if side in (-1, 1):  # K ends on the seam: towards `before` if that is outside, else towards `after`
        one = [-side * seam.after.signs[switch] * c for c in along]
        crossing = [two]
    elif not jumps and enclose(seam.before.expr - seam.after.expr, {**centre}).contains(0):
        one = [enclose(sp.diff(seam.before.expr, x), box) for x in forces]
        crossing = [one, two]
    else:
        return None
    certain = all(certain_sign(_cross(n, along)) in (-1, 1) for n in crossing) and certain_sign(_cross(one, two)) in (-1, 1)
    return (one, two) if certain else None


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
