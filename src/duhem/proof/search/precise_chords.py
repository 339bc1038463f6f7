"""Chords built in high precision at one place of the boundary: they show violations far below double precision.

Dents: at a boundary point whose curvature has the wrong sign, a short chord along the tangent.  Kinks: where the boundary
crosses a seam and its two tangents point inward, a chord from one side to the other, however slight the kink.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import partial
from math import floor
from typing import Any

import sympy as sp

from duhem.expression import mpmath_
from duhem.expression.number import fraction
from duhem.expression.rays_mpmath import reach
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values, rationals
from duhem.proof.search.seam_crossings import Crossing, crossings
from duhem.proof.search.suggestion import Chord, Point

__all__ = ["dent_chords", "kink_chords"]


def dent_chords(subject: FormulaSubject, parameters: Values, direction: Sequence[Any], dps: int = 60) -> Iterator[Chord]:
    """Chords through the boundary point seen from the origin in ``direction``, the longest first.

    In more than two forces along the tangent in which the second differences of that length are least.
    """
    context = mpmath_.kept_digits(dps)
    forces = subject.simple.forces
    run = mpmath_.compiled([subject.formula_at(parameters)], forces, context)

    def value(point: Sequence[Any]) -> Any:
        return run(*point)[0]

    ray = [context.mpf(c.numerator) / c.denominator for c in map(fraction, direction)]
    size = context.norm(ray)
    ray = [c / size for c in ray]
    end = reach(context, value, [0] * len(ray), ray, int(3.4 * dps))
    if end is None:
        return
    x = [end * c for c in ray]
    step = end * context.mpf(10) ** (-dps // 3)
    units = [[context.mpf(i == k) for i in range(len(ray))] for k in range(len(ray))]

    def moved(along: Any, tangent: Sequence[Any], out: Any = 0, normal: Sequence[Any] = ray) -> list[Any]:
        return [c + along * t + out * n for c, t, n in zip(x, tangent, normal, strict=True)]

    slope = [(value(moved(step, unit)) - value(moved(-step, unit))) / (2 * step) for unit in units]
    length = context.norm(slope)
    if not length > 0:
        return
    normal = [c / length for c in slope]
    frame = _tangents(context, normal)

    def bend(t: Any, tangent: Sequence[Any]) -> Any:
        return value(moved(t, tangent)) + value(moved(-t, tangent))

    for k in range(2, 60):
        t = end * context.mpf(2) ** -k
        tangent = frame[0] if len(frame) == 1 else _least(context, frame, partial(bend, t))
        if tangent is not None and (rise := -bend(t, tangent) / (2 * length)) > 0:
            p, q = (_rounded(moved(s * t, tangent, rise / 2, normal), rise / 1000) for s in (1, -1))
            yield Chord(parameters, p, q)


def _tangents(context: Any, normal: Sequence[Any]) -> list[list[Any]]:
    """Unit vectors across the normal and each other."""
    if len(normal) == 2:
        return [[-normal[1], normal[0]]]
    found = [list(normal)]
    for k in sorted(range(len(normal)), key=lambda i: abs(normal[i])):
        left = [context.mpf(i == k) for i in range(len(normal))]
        for v in found:
            share = context.fdot(left, v)
            left = [c - share * d for c, d in zip(left, v, strict=True)]
        if context.norm(left) > 1e-6:
            found.append(_unit(left, context))
    return found[1:]


def _least(context: Any, frame: Sequence[Sequence[Any]], bend: Callable[[Sequence[Any]], Any]) -> list[Any] | None:
    """The unit vector in a frame at which the form that takes ``bend`` as its values is least."""
    n = len(frame)
    form = context.matrix(n, n)
    for i in range(n):
        form[i, i] = bend(frame[i])
    for i in range(n):
        for j in range(i):
            form[i, j] = form[j, i] = (bend([a + b for a, b in zip(frame[i], frame[j], strict=True)]) - form[i, i] - form[j, j]) / 2
    if not all(map(context.isfinite, form)):
        return None
    axes = context.eigsy(form)[1]
    return _unit([sum(axes[i, 0] * v[k] for i, v in enumerate(frame)) for k in range(len(frame[0]))], context)


def kink_chords(subject: FormulaSubject, most: int = 12) -> Iterator[Chord]:
    """Chords across seams where the tangents of the two branches of the boundary point out of K (two forces)."""
    for parameters in subject.choices(most):
        for crossing in crossings(subject, parameters, 80):
            yield from _across(subject, parameters, crossing)


def _across(subject: FormulaSubject, parameters: Values, crossing: Crossing, dps: int = 80) -> Iterator[Chord]:
    """With unit tangents t1, t2 away from the crossing, K is dented there if t1 + t2 points along the outward normals."""
    context = mpmath_.kept_digits(dps)
    forces = subject.simple.forces
    exact = rationals(parameters)
    x = [context.mpf(c.numerator) / c.denominator for c in crossing.point]

    def gradient(expr: sp.Expr) -> list[Any]:
        return _unit([mpmath_.evaluate(expr.diff(v).subs(exact), dict(zip(forces, x, strict=True)), dps) for v in forces], context)

    (switch,) = crossing.seam.crossed
    side = crossing.seam.after.signs[switch]
    seam, one, two = (gradient(e) for e in (switch, crossing.seam.before.expr, crossing.seam.after.expr))
    tangents = []
    for normal, sense in ((one, -side), (two, side)):
        along = [-normal[1], normal[0]]
        lean = sense * (along[0] * seam[0] + along[1] * seam[1])
        if not lean:
            return
        tangents.append([c * context.sign(lean) for c in along])
    out = _unit([a + b for a, b in zip(one, two, strict=True)], context)
    rise = sum(c * (a + b) for c, a, b in zip(out, *tangents, strict=True)) / 2
    if not rise > context.mpf(10) ** (-dps // 4):
        return
    for k in range(2, 40, 3):
        step = rise * max(abs(c) for c in x) * context.mpf(2) ** -k
        pull = rise * step / 2
        ends = [[c + step * t - pull * n for c, t, n in zip(x, tangent, out, strict=True)] for tangent in tangents]
        p, q = (_rounded(end, pull / 1000) for end in ends)
        yield Chord(parameters, p, q)


def _unit(vector: list[Any], context: Any) -> list[Any]:
    size = context.norm(vector)
    return [c / size if size else context.zero for c in vector]


def _rounded(point: Sequence[Any], tolerance: Any) -> Point:
    """The point rounded to the coarsest decimals within the tolerance."""
    denominator = 10 ** max(1, int(-floor(float(sp.log(sp.Float(str(tolerance)), 10)))) + 1)
    return tuple(Fraction(int(c.context.nint(c * denominator)), denominator) for c in point)
