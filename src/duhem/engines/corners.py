"""Refutation of smoothness: a corner held in a box, with the two normals meeting there provably not parallel."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.examination import Case
from duhem.examination.choices import choices
from duhem.examination.witness import Values, decimal_pair, describe, values_at
from duhem.expression import Where
from duhem.expression.balls import ball, certain_sign, enclose, precision
from duhem.expression.branches import Branch
from duhem.expression.text import formula
from duhem.verdict import Evidence, Verdict, Witness

__all__ = ["smoothness"]


def smoothness(case: Case) -> Evidence | None:
    """A boundary point on a seam where the one-sided normals differ (two forces, or laws that reduce to two)."""
    pieces = case.pieces
    if len(case.simple.forces) != 2 or pieces is None or len(pieces) < 2 or (case.simple.g.has(Where) and not case.continuous):
        return None
    for parameters in choices(case, most=6):
        for before, after, seam in _neighbours(pieces):
            for start in _starts(case, parameters, after.expr, seam):
                if (witness := _corner(case, parameters, before, after, seam, start)) is not None:
                    return Evidence(Verdict.REFUTED, "witness-corner", "the outward normal jumps at a corner of the boundary", witness)
    return None


def _neighbours(pieces: Sequence[Branch]) -> Iterator[tuple[Branch, Branch, sp.Expr]]:
    """Pairs of branches that differ in the sign of exactly one switch: the seam between them."""
    for before, after in itertools.combinations(pieces, 2):
        crossed = [s for s, sign in after.signs.items() if before.signs.get(s) == -sign]
        if len(crossed) == 1 and before.expr != after.expr:
            yield before, after, crossed[0]


def _starts(case: Case, parameters: Values, expr: sp.Expr, seam: sp.Expr) -> Iterator[tuple[float, float]]:
    """Approximate common zeros of g and the seam: sign changes of the seam around circles of many radii, then along it."""
    import numpy as np  # only when something is looked for

    from duhem.expression.numpy_ import compiled

    exact = {x: sp.Rational(v.numerator, v.denominator) for x, v in parameters.items()}
    forces = case.simple.forces
    level, switch = compiled(expr.subs(exact), forces), compiled(seam.subs(exact), forces)
    turn = 2 * np.pi * np.arange(721) / 720 + 1e-9
    radii = 10.0 ** np.linspace(-4, 4, 161)
    x, y = np.outer(radii, np.cos(turn)), np.outer(radii, np.sin(turn))
    signs, heights = np.sign(switch(x, y)), level(x, y)
    cells = (signs[:-1, :-1] != signs[:-1, 1:]) & (np.sign(heights[:-1, :-1]) != np.sign(heights[1:, :-1]))
    for i, j in np.argwhere(cells)[:16]:
        yield float(x[i, j]), float(y[i, j])


def _corner(case: Case, parameters: Values, before: Branch, after: Branch, seam: sp.Expr, start: tuple[float, float]) -> Witness | None:
    forces = case.simple.forces
    exact = {x: sp.Rational(v.numerator, v.denominator) for x, v in parameters.items()}
    system = sp.Matrix([after.expr, seam]).subs(exact)
    jacobian = system.jacobian(list(forces))
    centre = _newton(system, jacobian, forces, start)
    if centre is None:
        return None
    for limit, radius in ((1000, Fraction(1, 2**30)), (10**25, Fraction(1, 2**40))):
        point = [c.limit_denominator(limit) for c in centre]
        values = {x: ball(v) for x, v in values_at(case, parameters, point).items()}
        with precision(256):
            box = {**values, **{x: ball(c - radius, c + radius) for x, c in zip(forces, point, strict=True)}}
            if not _has_zero(system, jacobian, forces, values, box, radius):
                continue
            others = {s: v for s, v in {**before.signs, **after.signs}.items() if s != seam}
            if any(certain_sign(enclose(v * s, box)) != 1 for s, v in others.items()):
                continue
            one, two = ([enclose(sp.diff(b.expr, x), box) for x in forces] for b in (before, after))
            cross = one[0] * two[1] - one[1] * two[0]
            same = enclose(before.expr - after.expr, {**values})
            along = [enclose(sp.diff(seam, x), box) for x in forces]
            transversal = all(certain_sign(n[0] * along[1] - n[1] * along[0]) in (-1, 1) for n in (one, two))
            if certain_sign(cross) not in (-1, 1) or not transversal or not same.contains(0):
                continue
            angle = math.degrees(math.atan2(abs(float(cross.mid())), float((one[0] * two[0] + one[1] * two[1]).mid())))
            at = values_at(case, parameters, point)
            return Witness(
                parameters=describe(case, at, forces=False),
                points={"corner": describe(case, at)},
                values={
                    "n1 x n2": decimal_pair(cross),
                    **{f"n{i}_{x}": decimal_pair(c) for i, n in ((1, one), (2, two)) for x, c in zip(forces, n, strict=True)},
                },
                statement=f"within {radius} of this point the boundary has a corner on {formula(seam)} = 0: "
                "the normals n1, n2 of its two sides are not parallel",
                measures={"corner_degrees": angle},
            )
    return None


def _newton(system: Any, jacobian: Any, forces: Sequence[sp.Symbol], start: tuple[float, float]) -> list[Fraction] | None:
    from mpmath import MPContext

    context = MPContext()
    context.dps = 40
    from duhem.expression import mpmath_

    point = [context.mpf(c) for c in start]
    for _ in range(60):
        at = dict(zip(forces, point, strict=True))
        f = [mpmath_.evaluate(e, at, 40) for e in system]
        a, b, c, d = (mpmath_.evaluate(e, at, 40) for e in jacobian)
        det = a * d - b * c
        if det == 0 or not context.isfinite(det):
            return None
        step = [(d * f[0] - b * f[1]) / det, (a * f[1] - c * f[0]) / det]
        point = [p - s for p, s in zip(point, step, strict=True)]
        if not all(context.isfinite(p) for p in point):
            return None
        if max(abs(s) for s in step) < context.mpf(10) ** -36:
            return [Fraction(int(context.nint(p * 10**36)), 10**36) for p in point]
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
