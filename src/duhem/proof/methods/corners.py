"""Refutation of smoothness: a corner held in a box, with the two normals meeting there provably not parallel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression import Where
from duhem.expression.balls import ball, certain_sign, enclose, precision
from duhem.expression.text import formula
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values, rationals
from duhem.proof.search.seam_crossings import Crossing, crossings
from duhem.proof.verdict import Evidence, Verdict, Witness
from duhem.proof.witness.rational_points import decimal_pair, describe

__all__ = ["smoothness"]


def smoothness(subject: FormulaSubject) -> Evidence | None:
    """A boundary point on a seam where the one-sided normals differ (two forces, or laws that reduce to two)."""
    pieces = subject.pieces
    if len(subject.simple.forces) != 2 or pieces is None or len(pieces) < 2:
        return None
    jumps = subject.simple.g.has(Where) and not subject.continuous
    for parameters in subject.choices(6):
        for crossing in crossings(subject, parameters):
            if (witness := _corner(subject, parameters, crossing, jumps)) is not None:
                return Evidence(Verdict.REFUTED, "witness-corner", "the outward normal jumps at a corner of the boundary", witness)
    return None


def _corner(subject: FormulaSubject, parameters: Values, crossing: Crossing, jumps: bool) -> Witness | None:
    """The corner in a box; where g jumps, only one between the boundary of one branch and the seam, which g does not cross."""
    before, after, seam = crossing.before, crossing.after, crossing.seam
    forces = subject.simple.forces
    exact = rationals(parameters)
    system = sp.Matrix([after.expr, seam]).subs(exact)
    jacobian = system.jacobian(list(forces))
    for limit, radius in ((1000, Fraction(1, 2**30)), (10**25, Fraction(1, 2**40))):
        point = [c.limit_denominator(limit) for c in crossing.point]
        values = {x: ball(v) for x, v in subject.values_at(parameters, point).items()}
        with precision(256):
            box = {**values, **{x: ball(c - radius, c + radius) for x, c in zip(forces, point, strict=True)}}
            if not _has_zero(system, jacobian, forces, values, box, radius):
                continue
            others = {s: v for s, v in {**before.signs, **after.signs}.items() if s != seam}
            if any(certain_sign(enclose(v * s, box)) != 1 for s, v in others.items()):
                continue
            along = [enclose(sp.diff(seam, x), box) for x in forces]
            two = [enclose(sp.diff(after.expr, x), box) for x in forces]
            side = certain_sign(enclose(before.expr, box))
            if side in (-1, 1):  # K ends on the seam: towards `before` if that is outside, else towards `after`
                one = [-side * after.signs[seam] * c for c in along]
            elif not jumps and enclose(before.expr - after.expr, {**values}).contains(0):
                one = [enclose(sp.diff(before.expr, x), box) for x in forces]
            else:
                continue
            cross = one[0] * two[1] - one[1] * two[0]
            normals = (one, two) if side not in (-1, 1) else (two,)
            transversal = all(certain_sign(n[0] * along[1] - n[1] * along[0]) in (-1, 1) for n in normals)
            if certain_sign(cross) not in (-1, 1) or not transversal:
                continue
            angle = math.degrees(math.atan2(abs(float(cross.mid())), float((one[0] * two[0] + one[1] * two[1]).mid())))
            at = subject.values_at(parameters, point)
            return Witness(
                parameters=describe(subject, at, forces=False),
                points={"corner": describe(subject, at)},
                values={
                    "n1 x n2": decimal_pair(cross),
                    **{f"n{i}_{x}": decimal_pair(c) for i, n in ((1, one), (2, two)) for x, c in zip(forces, n, strict=True)},
                },
                statement=f"within {radius} of this point the boundary has a corner on {formula(seam)} = 0: "
                "the normals n1, n2 of its two sides are not parallel",
                measures={"corner_degrees": angle},
            )
    return None


def _has_zero(system: Any, jacobian: Any, forces: Sequence[sp.Symbol], centre: Any, box: Any, radius: Fraction) -> bool:
    """Interval Newton: centre - J(box)^-1 F(centre) inside the box shows exactly one zero there (Moore 1966)."""
    f = [enclose(e, centre) for e in system]
    a, b, c, d = (enclose(e, box) for e in jacobian)
    det = a * d - b * c
    if certain_sign(det) not in (-1, 1):
        return False
    steps = [(d * f[0] - b * f[1]) / det, (a * f[1] - c * f[0]) / det]
    return all(step.is_finite() and abs(step) < ball(radius) for step in steps)
