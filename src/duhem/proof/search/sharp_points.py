"""Exact places where the boundary may come to a point: zero force, and where it meets axes or edges at plain fractions."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import partial
from itertools import islice, product
from typing import Any

import sympy as sp

from duhem.expression import defined_at
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values, rationals
from duhem.proof.search.edges import edges
from duhem.proof.search.suggestion import Point, SharpPoint

__all__ = ["sharp_points"]

_NEAR = 1e-5
_MOST_WAYS, _TRIED = 400, 6
_STEPS = 20_000  # of one place
_SAME = 3.0  # how much more one may fall than the other on a tenth of the way
_LARGEST = 10_000  # the denominator of a plain fraction
_RADII = [10.0 ** (k / 6) for k in range(-30, 31)]


def sharp_points(subject: FormulaSubject, parameters: Values) -> Iterator[SharpPoint]:
    """Places with directions: on both ends of the one g > 0, as it seems, and on the other g < 0; while steps are left."""
    import numpy as np

    from duhem.expression.numpy_ import compiled

    forces = subject.simple.forces
    g = subject.formula_at(parameters)
    level, pointed = compiled(g, forces), edges(g, forces)
    ways = list(dict.fromkeys([*_ways(len(forces)), *(tuple(Fraction(c, max(map(abs, edge))) for c in edge) for edge in pointed)]))
    opposite = [ways.index(tuple(-c for c in way)) for way in ways]
    steps = np.array([[float(c) for c in way] for way in ways])

    def values(place: Point, reach: float) -> Any:
        points = np.array([float(c) for c in place]) + reach * steps
        with np.errstate(all="ignore"):
            return np.broadcast_to(level(*points.T), len(ways))

    for place in dict.fromkeys([*_places(g, forces), *_on_edges(g, forces, pointed)]):
        if not subject.budget.pays(_STEPS):
            return
        size = _NEAR * max(1.0, *(abs(float(c)) for c in place))
        found, nearer = values(place, size), values(place, size / 10)
        both, both_nearer = (np.minimum(v, v[opposite]) for v in (found, nearer))
        home = tuple(-c / max(map(abs, place)) for c in place) if any(place) else None
        back = [k for k, way in enumerate(ways) if way == home]  # on which floats may not see that a load is 0
        falls = [(k, 0.1) for k in back] + [(k, nearer[k] / found[k]) for k in np.argsort(found)[:2] if found[k] < 0]
        outside = [k for k in np.argsort(-both) if both[k] > 0]
        for k, fall in falls[:2]:  # where g rises less steeply than it falls, K has a tangent
            steep = [i for i in outside if both_nearer[i] > both[i] * fall / _SAME][:_TRIED]
            yield from (SharpPoint(parameters, place, ways[i], ways[k]) for i in steep)


def _places(g: sp.Expr, forces: Sequence[sp.Symbol]) -> Iterator[Point]:
    yield tuple(Fraction(0) for _ in forces)
    for i, x in enumerate(forces):
        along = defined_at(g, {y: sp.S.Zero for y in forces if y != x})
        if along is not None and along.is_polynomial(x) and (form := sp.Poly(along, x)).domain in (sp.ZZ, sp.QQ) and not form.is_ground:
            for root in sorted(form.ground_roots()):
                if root:
                    yield tuple(Fraction(int(root.p), int(root.q)) if k == i else Fraction(0) for k in range(len(forces)))


def _on_edges(g: sp.Expr, forces: Sequence[sp.Symbol], pointed: Sequence[tuple[int, ...]]) -> Iterator[Point]:
    """Where rays along edges leave K, at fractions."""
    import numpy as np

    from duhem.expression.numpy_ import compiled
    from duhem.expression.rays import Rays

    r = sp.Symbol("r", positive=True)
    for edge in pointed:  # what is 0 on it must be seen to be
        along = defined_at(g, {x: c * r for x, c in zip(forces, edge, strict=True)})
        if along is None:
            continue
        level = compiled(along, (r,))
        last, first = Rays(partial(_first, level), np.zeros(1), np.ones((1, 1))).left(np.array(_RADII))
        far = Fraction(float(last[0])).limit_denominator(_LARGEST) if 0 < last[0] < first[0] else Fraction(0)
        place = tuple(far * c for c in edge)
        value = defined_at(g, rationals(dict(zip(forces, place, strict=True)))) if far else None
        if value is not None and value.is_zero:
            yield place


def _first(level: Callable[[Any], Any], points: Any) -> Any:
    return level(points[..., 0])


def _ways(dimension: int) -> list[Point]:
    """Directions of small whole numbers, each with its opposite: all of them in few forces, else some at random (fixed seed)."""
    if dimension <= 3:
        return [tuple(map(Fraction, way)) for way in product(range(-2, 3), repeat=dimension) if any(way)]
    rng = random.Random(6)
    drawn = ([rng.randint(-2, 2) for _ in range(dimension)] for _ in iter(int, 1))
    found = dict.fromkeys(tuple(map(Fraction, way)) for way in islice((w for w in drawn if any(w)), _MOST_WAYS // 2))
    axes = [tuple(Fraction(int(i == k)) for i in range(dimension)) for k in range(dimension)]
    return list(dict.fromkeys(sign for way in (*found, *axes) for sign in (way, tuple(-c for c in way))))
