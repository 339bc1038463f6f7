"""Chords from where an ellipsoid in a maximum lies farthest along a load: what is cut off a ball may leave a cap that no sample meets.

Along the diameter to such an end g is looked at in floats; the other end of a chord is its mirror image in a zero of a load, or in
where g is greatest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt
from typing import Any

import sympy as sp

from duhem.expression import Norm
from duhem.expression.number import fraction, rational
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.search.edges import affine, largest_loads
from duhem.proof.search.suggestion import Chord

__all__ = ["chords_from_far_points"]

_DIGITS = (1, 2, 3, 4, 6, 9, 12, 15, 20, 30)
_STEPS, _PLACES = 20_000, 401  # of a diameter, and of g on it
_MOST = 40  # diameters
_NOISE = 1e-6  # of floats, in terms of how high g is between


@dataclass(frozen=True)
class _Diameter:
    """centre + t way, for t^2 <= square."""

    centre: tuple[Fraction, ...]
    way: tuple[Fraction, ...]
    square: Fraction

    def at(self, t: Fraction) -> tuple[Fraction, ...]:
        """A point of it."""
        return tuple(c + t * w for c, w in zip(self.centre, self.way, strict=True))

    def ends(self) -> Iterator[Fraction]:
        """Fractions ever closer to the greatest t from below, and t itself if it is one."""
        p, q = self.square.numerator, self.square.denominator
        exact = Fraction(isqrt(p), isqrt(q)) if isqrt(p) ** 2 == p and isqrt(q) ** 2 == q else None
        for digits in _DIGITS:
            unit = 10**digits
            yield exact * Fraction(unit - 1, unit) if exact else Fraction(isqrt(p * q * unit**2), q * unit)
        if exact:
            yield exact


def chords_from_far_points(subject: FormulaSubject, most: int = 4) -> Iterator[Chord]:
    """At so many choices of the parameters; none where g is no maximum."""
    forces = subject.simple.forces
    if not isinstance(subject.simple.g, sp.Max):
        return
    for parameters in subject.choices(most):
        g = subject.formula_at(parameters)
        for diameter in _diameters(g, forces):
            if not subject.budget.pays(_STEPS):
                return
            for t, middle in _mirrored(g, forces, diameter):
                yield Chord(parameters, diameter.at(t), diameter.at(2 * middle - t))


def _diameters(g: sp.Expr, forces: Sequence[sp.Symbol]) -> Iterator[_Diameter]:
    """Of each ellipsoid, through where it touches the planes on which the loads of other parts are constant."""
    seen = set[_Diameter]()
    for part in g.args if isinstance(g, sp.Max) else ():
        square = _square(part, forces)
        rows = [row for other in g.args if other is not part for row in _rows(other, forces)]
        for diameter in _across(square, rows, forces) if square is not None and rows else ():
            if diameter not in seen and len(seen) < _MOST:
                seen.add(diameter)
                yield diameter


def _square(part: sp.Expr, forces: Sequence[sp.Symbol]) -> sp.Poly | None:
    """A quadratic polynomial with fractions that is <= 0 where the part is: of norm(...) - r, sqrt(q) - r or itself."""
    still, moving = part.as_independent(*forces, as_Add=True)
    scale, size = moving.as_independent(*forces, as_Add=False)
    if not moving.is_Add and scale.is_positive and still.is_negative:
        if isinstance(size, Norm):
            part = sp.Add(*(a**2 for a in size.args)) - (still / scale) ** 2
        elif size.is_Pow and size.exp == sp.S.Half:
            part = size.base - (still / scale) ** 2
    if not part.is_polynomial(*forces):
        return None
    poly = sp.Poly(part, *forces)
    return poly if poly.total_degree() == 2 and poly.domain in (sp.ZZ, sp.QQ) else None


def _rows(part: sp.Expr, forces: Sequence[sp.Symbol]) -> Iterator[tuple[sp.Rational, ...]]:
    """The coefficients of the loads in a part; of a quadratic polynomial, of its slopes."""
    slopes = [sp.diff(part, x) for x in forces] if part.is_polynomial(*forces) else []
    for load in (*largest_loads(part, forces), *(slope for slope in slopes if affine(slope, forces))):
        row = [sp.diff(load, x) for x in forces]
        if all(c.is_Rational for c in row):
            first = next(c for c in row if c)
            yield tuple(c / first for c in row)


def _across(square: sp.Poly, rows: Sequence[tuple[sp.Rational, ...]], forces: Sequence[sp.Symbol]) -> Iterator[_Diameter]:
    """The diameters, if {square <= 0} is an ellipsoid."""
    matrix = sp.hessian(square.as_expr(), forces) / 2
    if not matrix.is_positive_definite:
        return
    zero = dict.fromkeys(forces, sp.S.Zero)
    slope = sp.Matrix([sp.diff(square.as_expr(), x).xreplace(zero) for x in forces])
    inverse = matrix.inv()
    centre = -inverse * slope / 2
    level = -square.as_expr().xreplace(dict(zip(forces, centre, strict=True)))
    for row in dict.fromkeys(rows):
        way = inverse * sp.Matrix(row)
        square_of_way = (sp.Matrix(row).T * way)[0]
        if level > 0 and square_of_way > 0:
            yield _Diameter(tuple(map(fraction, centre)), tuple(map(fraction, way)), fraction(level / square_of_way))


def _mirrored(g: sp.Expr, forces: Sequence[sp.Symbol], diameter: _Diameter) -> Iterator[tuple[Fraction, Fraction]]:
    """Ends of a diameter, each with a place on it, no farther from the other end, at which g > 0, as it seems."""
    import numpy as np

    from duhem.expression.numpy_ import compiled

    run, longest = compiled(g, forces), float(diameter.square) ** 0.5
    centre, way = (np.array([[float(c)] for c in v]) for v in (diameter.centre, diameter.way))

    def value(t: Any) -> Any:
        heights = np.broadcast_to(run(*(centre + way * t)), t.shape)
        return np.where(np.isfinite(heights), heights, -np.inf)

    places = longest * np.linspace(-1, 1, _PLACES)
    middles = [Fraction(float(places[int(np.argmax(value(places)))])).limit_denominator(10**6)]
    middles += [t for load in dict.fromkeys(largest_loads(g, forces)) if (t := _zero(load, forces, diameter)) is not None]
    heights = value(np.array([float(t) for t in middles]))
    for middle, height in zip(middles, heights, strict=True):
        for t in diameter.ends() if height > 0 and middle**2 < diameter.square else ():
            end = -t if middle < 0 else t
            both = value(np.array([float(end), float(2 * middle - end)]))
            if t > abs(middle) and both.max() < _NOISE * height:
                yield end, middle


def _zero(load: sp.Expr, forces: Sequence[sp.Symbol], diameter: _Diameter) -> Fraction | None:
    """Where a load is 0 on a diameter, if at one place."""
    level = load.xreplace(dict(zip(forces, map(rational, diameter.centre), strict=True)))
    rise = sum(sp.diff(load, x) * rational(w) for x, w in zip(forces, diameter.way, strict=True))
    return fraction(-level / rise) if rise and (level / rise).is_Rational else None
