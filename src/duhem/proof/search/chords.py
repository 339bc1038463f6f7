"""Where to look for a violation of convexity: floating-point scouting; every find goes to the exact check.

Three scouts.  Chords: the boundary is sampled along rays in plane sections, and midpoints of chords of many lengths are
tried, which sees inward kinks, dents and separate components.  Dents: at a boundary point whose curvature has the
wrong sign, a chord is built in high precision, which sees violations far below double precision.  Kinks: where the
boundary crosses a seam and its two tangents point inward, a chord from one side to the other, however slight the kink.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression import mpmath_
from duhem.expression.numpy_ import compiled
from duhem.proof.facts.case import Case
from duhem.proof.search.choices import choices, fraction
from duhem.proof.search.crossings import Crossing, crossings
from duhem.proof.verdict import Witness
from duhem.proof.witness.points import Values, chord

__all__ = ["boundary_dent", "inward_kink", "nonconvex_chord"]

Array = NDArray[np.float64]
_ANGLES, _RADII, _SECTIONS = 720, 48, 24


def nonconvex_chord(case: Case, hints: Sequence[Mapping[sp.Symbol, Any]] = (), most: int = 40) -> Witness | None:
    """An exactly checked chord that leaves K, or None if the scouting found none."""
    for parameters in choices(case, hints, most):
        if case.exhausted:
            break
        if (found := _in_choice(case, parameters)) is not None:
            return found
    return None


def _in_choice(case: Case, parameters: Values) -> Witness | None:
    forces = case.simple.forces
    g = case.simple.g.subs({x: sp.Rational(v.numerator, v.denominator) for x, v in parameters.items()})
    run = compiled(g, forces)

    def value(points: Array) -> Array:
        return run(*np.moveaxis(points, -1, 0))

    centre = _centre(value, len(forces))
    if centre is None:
        return None
    for p, q, p_anchor, q_anchor in _suspects(value, centre):
        for digits in (1, 2, 3, 4, 6, 9, 12, 16):  # the fewest decimals that still show it, for those who check by hand
            pull = 10.0**-digits
            rounded = [
                [Fraction(round(float(c) * 10**digits), 10**digits) for c in x + pull * (a - x)] for x, a in ((p, p_anchor), (q, q_anchor))
            ]
            if (found := chord(case, parameters, *rounded)) is not None:
                return found
    return None


def _centre(value: Any, d: int) -> Array | None:
    """A point of K: the origin, or the lowest of random points of many sizes."""
    origin = np.zeros(d)
    if value(origin) <= 0:
        return origin
    rng = np.random.default_rng(3)
    points = rng.standard_normal((4000, d)) * 10.0 ** rng.uniform(-3, 3, (4000, 1))
    heights = np.where(np.isfinite(value(points)), value(points), np.inf)
    best = points[int(np.argmin(heights))]
    return best if value(best) <= 0 else None


def _suspects(value: Any, centre: Array) -> Iterator[tuple[Array, Array, Array, Array]]:
    """Pairs of points of K whose midpoint seems outside, each with a point further inside to be pulled towards."""
    d = len(centre)
    yield from _random_pairs(value, d)
    rng = np.random.default_rng(4)
    for section in range(1 if d <= 2 else _SECTIONS):
        if d == 1:
            directions = np.array([[1.0], [-1.0]])
        else:
            turn = 2 * np.pi * np.arange(_ANGLES) / _ANGLES
            frame = np.eye(d)[:2] if section == 0 else np.linalg.qr(rng.standard_normal((d, 2)))[0].T
            directions = np.outer(np.cos(turn), frame[0]) + np.outer(np.sin(turn), frame[1])
        yield from _along_rays(value, centre, directions)


def _random_pairs(value: Any, d: int) -> Iterator[tuple[Array, Array, Array, Array]]:
    """Points of K of many sizes, each with its opposite and with another one: sees holes that rays step over."""
    rng = np.random.default_rng(6)
    points = rng.standard_normal((4000, d)) * 10.0 ** rng.uniform(-2, 2, (4000, 1))
    inner = points[value(points) <= 0]
    for others in (-inner, rng.permutation(inner)):
        heights = value((inner + others) / 2)
        score = np.where((value(others) <= 0) & np.isfinite(heights), heights, -np.inf)
        for k in np.argsort(-score)[:2]:
            if score[k] > 0:
                yield inner[k], others[k], inner[k], others[k]


def _along_rays(value: Any, centre: Array, directions: Array) -> Iterator[tuple[Array, Array, Array, Array]]:
    radii = 10.0 ** np.linspace(-6, 6, 12 * _RADII // 4)
    inside = value(centre + radii[None, :, None] * directions[:, None, :]) <= 0
    exits = np.where(inside.all(axis=1), len(radii), np.argmin(inside, axis=1))
    # A ray that comes back into K after leaving it shows a gap by itself.
    later = inside & (np.arange(len(radii))[None, :] > exits[:, None])
    for ray in np.flatnonzero(later.any(axis=1))[:8]:
        back = int(np.argmax(later[ray]))
        leave = _bisect(value, centre, directions[ray], radii[max(int(exits[ray]) - 1, 0)] if exits[ray] else 0.0, radii[exits[ray]])
        enter = _bisect(value, centre, directions[ray], radii[back], radii[back - 1])
        yield centre + leave * directions[ray], centre + enter * directions[ray], centre, centre + radii[back] * directions[ray]
    low = np.where(exits > 0, radii[np.maximum(exits - 1, 0)], 0.0)
    high = radii[np.minimum(exits, len(radii) - 1)]
    bounded = exits < len(radii)
    for _ in range(60):
        middle = (low + high) / 2
        inner = value(centre + middle[:, None] * directions) <= 0
        low, high = np.where(inner & bounded, middle, low), np.where(inner | ~bounded, high, middle)
    boundary = centre + low[:, None] * directions
    n = len(directions)
    best: list[tuple[float, int, int]] = []
    for step in (1, 2, 4, 8, 16, 32, 64, 100, 128, 180, 220, 256, 300):
        if step >= n:
            break
        other = np.roll(boundary, -step, axis=0)
        heights = value((boundary + other) / 2)
        size = np.linalg.norm(other - boundary, axis=1)
        score = np.where(np.isfinite(heights) & (size > 0), heights, -np.inf)
        top = int(np.argmax(score))
        if score[top] > 0:
            best.append((float(score[top]), top, (top + step) % n))
    for _, i, j in sorted(best, reverse=True):
        yield boundary[i], boundary[j], centre, centre


def _bisect(value: Any, centre: Array, direction: Array, inside: float, outside: float) -> float:
    for _ in range(60):
        middle = (inside + outside) / 2
        inside, outside = (middle, outside) if value(centre + middle * direction) <= 0 else (inside, middle)
    return inside


def boundary_dent(case: Case, parameters: Values, direction: Sequence[Any], dps: int = 60) -> Witness | None:
    """A chord through the boundary point seen from the origin in ``direction`` (two forces), built in high precision."""
    from mpmath import MPContext

    context = MPContext()
    context.dps = dps
    forces = case.simple.forces
    g = case.simple.g.subs({x: sp.Rational(v.numerator, v.denominator) for x, v in parameters.items()})

    def value(point: Sequence[Any]) -> Any:
        return mpmath_.evaluate(g, dict(zip(forces, point, strict=True)), dps)

    ray = [context.mpf(c.numerator) / c.denominator for c in map(fraction, direction)]
    size = context.hypot(*ray)
    ray = [c / size for c in ray]
    low, high = context.mpf(0), context.mpf(1)
    while value([high * c for c in ray]) <= 0:
        low, high = high, 2 * high
        if high > 1e12:
            return None
    for _ in range(int(3.4 * dps)):
        middle = (low + high) / 2
        low, high = (middle, high) if value([middle * c for c in ray]) <= 0 else (low, middle)
    x = [low * c for c in ray]
    step = low * context.mpf(10) ** (-dps // 3)
    slope = [
        (value([x[0] + step, x[1]]) - value([x[0] - step, x[1]])) / (2 * step),
        (value([x[0], x[1] + step]) - value([x[0], x[1] - step])) / (2 * step),
    ]
    length = context.hypot(*slope)
    if not length > 0:
        return None
    normal = [c / length for c in slope]
    tangent = [-normal[1], normal[0]]

    def moved(along: Any, out: Any) -> list[Any]:
        return [x[k] + along * tangent[k] + out * normal[k] for k in (0, 1)]

    for k in range(2, 60):
        t = low * context.mpf(2) ** -k
        bend = -(value(moved(t, 0)) + value(moved(-t, 0))) / (2 * length)
        if not bend > 0:
            continue
        p, q = (_rational(moved(s * t, bend / 2), bend / 1000) for s in (1, -1))
        if (found := chord(case, parameters, p, q)) is not None:
            return found
    return None


def inward_kink(case: Case, most: int = 12) -> Witness | None:
    """A chord across a seam where the tangents of the two branches of the boundary point out of K (two forces)."""
    for parameters in choices(case, most=most):
        for crossing in crossings(case, parameters, 80):
            if case.exhausted:
                return None
            if (found := _across(case, parameters, crossing)) is not None:
                return found
    return None


def _across(case: Case, parameters: Values, crossing: Crossing, dps: int = 80) -> Witness | None:
    """With unit tangents t1, t2 away from the crossing, K is dented there if t1 + t2 points along the outward normals."""
    from mpmath import MPContext

    context = MPContext()
    context.dps = dps
    forces = case.simple.forces
    exact = {x: sp.Rational(v.numerator, v.denominator) for x, v in parameters.items()}
    x = [context.mpf(c.numerator) / c.denominator for c in crossing.point]

    def gradient(expr: sp.Expr) -> list[Any]:
        return _unit([mpmath_.evaluate(expr.diff(v).subs(exact), dict(zip(forces, x, strict=True)), dps) for v in forces], context)

    side = crossing.after.signs[crossing.seam]
    seam, one, two = (gradient(e) for e in (crossing.seam, crossing.before.expr, crossing.after.expr))
    tangents = []
    for normal, sense in ((one, -side), (two, side)):
        along = [-normal[1], normal[0]]
        lean = sense * (along[0] * seam[0] + along[1] * seam[1])
        if not lean:
            return None
        tangents.append([c * context.sign(lean) for c in along])
    out = _unit([a + b for a, b in zip(one, two, strict=True)], context)
    rise = sum(c * (a + b) for c, a, b in zip(out, *tangents, strict=True)) / 2
    if not rise > context.mpf(10) ** (-dps // 4):
        return None
    for k in range(2, 40, 3):
        step = rise * max(abs(c) for c in x) * context.mpf(2) ** -k
        pull = rise * step / 2
        ends = [[c + step * t - pull * n for c, t, n in zip(x, tangent, out, strict=True)] for tangent in tangents]
        p, q = (_rational(end, pull / 1000) for end in ends)
        if (found := chord(case, parameters, p, q)) is not None:
            return found
    return None


def _unit(vector: list[Any], context: Any) -> list[Any]:
    size = context.hypot(*vector)
    return [c / size if size else context.zero for c in vector]


def _rational(point: Sequence[Any], tolerance: Any) -> list[Fraction]:
    """The point rounded to the coarsest decimals within the tolerance."""
    denominator = 10 ** max(1, int(-np.floor(float(sp.log(sp.Float(str(tolerance)), 10)))) + 1)
    return [Fraction(int(c.context.nint(c * denominator)), denominator) for c in point]
