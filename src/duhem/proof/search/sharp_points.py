"""Exact places where the boundary may come to a point: zero force, and where it meets the axes at plain fractions."""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from itertools import islice, product
from typing import Any

import sympy as sp

from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.search.suggestion import Point, SharpPoint

__all__ = ["sharp_points"]

_NEAR = 1e-5
_MOST_WAYS, _TRIED = 400, 6
_STEPS = 20_000  # of one place


def sharp_points(subject: FormulaSubject, parameters: Values) -> Iterator[SharpPoint]:
    """Places with directions: on both ends of the one g > 0, as it seems, and on the other g < 0; while steps are left."""
    import numpy as np

    from duhem.expression.numpy_ import compiled

    forces = subject.simple.forces
    level = compiled(subject.formula_at(parameters), forces)
    ways = _ways(len(forces))
    steps = np.array([[float(c) for c in way] for way in ways])

    def values(place: Point, reach: float) -> Any:
        points = np.array([float(c) for c in place]) + reach * steps
        with np.errstate(all="ignore"):
            return np.broadcast_to(level(*points.T), len(ways))

    for place in _places(subject, parameters):
        if not subject.budget.pays(_STEPS):
            return
        size = _NEAR * max(1.0, *(abs(float(c)) for c in place))
        found = values(place, size)
        other = np.array([found[ways.index(tuple(-c for c in way))] for way in ways])
        inside = [ways[k] for k in np.argsort(found) if found[k] < 0][:_TRIED]
        both = np.minimum(found, other)
        outside = [ways[k] for k in np.argsort(-both) if both[k] > 0][:_TRIED]
        yield from (SharpPoint(parameters, place, away, into) for away in outside for into in inside[:2])


def _places(subject: FormulaSubject, parameters: Values) -> Iterator[Point]:
    forces = subject.simple.forces
    g = subject.formula_at(parameters)
    yield tuple(Fraction(0) for _ in forces)
    for i, x in enumerate(forces):
        try:
            along = g.xreplace({y: sp.S.Zero for y in forces if y != x})
        except (ValueError, TypeError):  # SymPy compares something with nan
            continue
        if along.is_polynomial(x) and (form := sp.Poly(along, x)).domain in (sp.ZZ, sp.QQ) and not form.is_ground:
            for root in sorted(form.ground_roots()):
                if root:
                    yield tuple(Fraction(int(root.p), int(root.q)) if k == i else Fraction(0) for k in range(len(forces)))


def _ways(dimension: int) -> list[Point]:
    """Directions of small whole numbers, each with its opposite: all of them in few forces, else some at random (fixed seed)."""
    if dimension <= 3:
        return [tuple(map(Fraction, way)) for way in product(range(-2, 3), repeat=dimension) if any(way)]
    rng = random.Random(6)
    drawn = ([rng.randint(-2, 2) for _ in range(dimension)] for _ in iter(int, 1))
    found = dict.fromkeys(tuple(map(Fraction, way)) for way in islice((w for w in drawn if any(w)), _MOST_WAYS // 2))
    axes = [tuple(Fraction(int(i == k)) for i in range(dimension)) for k in range(dimension)]
    return list(dict.fromkeys(sign for way in (*found, *axes) for sign in (way, tuple(-c for c in way))))
