"""Chords between distant points of K that seem to leave it: midpoints are tried in floats.

Sampled: the boundary is followed along rays in plane sections, which sees inward kinks, dents and separate components.
On exact rays: K may have faces, edges or whiskers that no sample meets.  From far points: where an ellipsoid in a maximum lies
farthest along a load, for what is cut off a ball may leave a cap that no sample meets; along the diameter to such an end g is looked
at, and the other end of the chord is its mirror image in a zero of a load, or in where g is greatest.

Of a law kept as a graph: a dent may be as narrow as one kink of one neuron.  So beside long chords between any two points of the boundary,
short ones of every length are tilted and shifted until both ends lie on a level of g, and the one whose midpoint lies highest above it is a
candidate.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import isqrt
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression import Norm
from duhem.expression.invariance import affine, largest_loads
from duhem.expression.number import fraction, rational
from duhem.expression.numpy_ import compiled
from duhem.expression.rays import Rays, first_exit
from duhem.law.domain import REAL
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.facts.subject import Point, Values
from duhem.proof.search.boundary_points import Chord, lowest
from duhem.proof.search.corners import quadratic
from duhem.proof.search.downhill import gaps
from duhem.proof.search.edges import exact_rays
from duhem.proof.search.margins import WALK, least_margin

__all__ = ["chords_between_exact_rays", "chords_downhill", "chords_from_far_points", "graph_chords", "looked_between", "sampled_chords"]

Array = NDArray[np.float64]
_ANGLES, _SECTIONS = 720, 24
_SECTION, _NODE = 10_000, 1_200  # steps of a section, and of each node of the formula over its points
_RADII = 10.0 ** np.linspace(-6, 6, 144)
_POWERS = range(-20, 21)  # points lie at powers of 2
_EXACT_NODE, _POINTS = 200, 240  # steps of each node of the formula; most points of K
_BENT = 1e-5  # a curvature that floats show
_NOTHING = 1e-12  # a height below this part of the greatest around is taken for 0
_TRIED = 6  # chords for an exact look
_ENDS = (1, 2, 3, 4, 6, 9, 12, 15, 20, 30)
_DIAMETER, _PLACES = 20_000, 401  # of a diameter, and of g on it
_DIAMETERS = 40  # diameters
_NOISE = 1e-6  # of floats, in terms of how high g is between


def sampled_chords(subject: FormulaSubject, most: int = 40, steps: int | None = None) -> Iterator[Chord]:
    """Chords worth an exact look, one choice of parameters after the other while steps are left: so many, or all of the claim's."""
    budget = subject.budget if steps is None else subject.budget.part(steps)
    price = _sections(len(subject.simple.forces)) * (_SECTION + _NODE * sum(1 for _ in sp.preorder_traversal(subject.simple.g)))
    for parameters in subject.choices(most):
        if not budget.pays(price):
            return
        seen: list[int] = []
        yield from _in_choice(subject, parameters, seen)
        subject.known[sampled_chords, tuple(parameters.items())] = sum(seen)


def looked_between(subject: FormulaSubject) -> list[int]:
    """Between how many boundary points chords were tried in vain, a parameter choice each."""
    return [n for key, n in subject.known.items() if isinstance(key, tuple) and key[0] is sampled_chords and n > 0]


def chords_downhill(subject: FormulaSubject) -> Iterator[Chord]:
    """Chords across gaps, and where a walk over parameters and rays finds that the boundary bends inward.

    The latter along rays near that place, and all around.
    """
    for parameters, p, x, q in gaps(subject, from_zero=False):
        yield from _in_decimals(parameters, _last(subject, parameters, p, x), _last(subject, parameters, q, x), p, q)
    found = least_margin("convexity", subject, WALK)
    if found is not None and found.value < -_BENT:
        for ways in (found.scout.directions, None):
            yield from _in_choice(subject, found.scout.parameters, [], ways)


def _in_choice(subject: FormulaSubject, parameters: Values, seen: list[int], ways: Array | None = None) -> Iterator[Chord]:
    """Chords of points of K whose midpoint seems outside, each end pulled towards a point further inside, as far as it is rounded.

    Along rays in plane sections, or in the given ``ways`` (M, d); ``seen`` takes up how many rays left K.
    """
    forces = subject.simple.forces
    run = compiled(subject.formula_at(parameters), forces)
    low, high = np.array([subject.law.domain.get(x.name, REAL).ends for x in forces]).T

    def value(points: Array) -> Array:
        g = run(*np.moveaxis(points, -1, 0))
        return np.maximum(g, np.max(np.maximum(low - points, points - high), axis=-1)) if subject.law.domain else g

    zero = np.zeros(len(forces))
    inner = zero if value(zero) < 0 else lowest(value, len(forces), np.random.default_rng(3), (-3, 3))
    centre = zero if value(zero) <= 0 else inner
    if centre is None:
        return
    towards = (centre,) if inner is None or inner is centre else (centre, inner)  # zero force may be a tip of K
    for directions in _planes(len(forces)) if ways is None else [ways]:
        for p, q, *anchors in _along_rays(value, centre, towards, directions, seen):
            yield from _in_decimals(parameters, p, q, *anchors)


def _last(subject: FormulaSubject, parameters: Values, inside: Array, outside: Array) -> Array:
    """The last point of K on the way from one point to another."""
    level = compiled(subject.formula_at(parameters), subject.simple.forces)
    way = Rays(lambda points: level(*np.moveaxis(points, -1, 0)), inside, (outside - inside)[None])
    return way.at(way.narrowed(np.zeros(1), np.ones(1))[0])[0]


def _in_decimals(parameters: Values, p: Array, q: Array, *anchors: Array) -> Iterator[Chord]:
    """The chord with its ends pulled towards the anchors, in the fewest decimals that still show it, for those who check by hand."""
    for digits in (1, 2, 3, 4, 6, 9, 12, 16):
        pulled = (x + 10.0**-digits * (a - x) for x, a in zip((p, q), anchors, strict=True))
        one, two = (tuple(Fraction(round(float(c) * 10**digits), 10**digits) for c in x) for x in pulled)
        yield parameters, one, two


def _planes(d: int) -> Iterator[Array]:
    """Directions all around in plane sections, the first in the planes of a force and the next; of one force both."""
    turn, rng = 2 * np.pi * np.arange(_ANGLES) / _ANGLES, np.random.default_rng(4)
    for section in range(_sections(d)):
        frame = np.eye(d)[[section, section - d + 1]] if section < d else np.linalg.qr(rng.standard_normal((d, 2)))[0].T
        yield np.outer(np.cos(turn), frame[0]) + np.outer(np.sin(turn), frame[1]) if d > 1 else np.array([[1.0], [-1.0]])


def _sections(d: int) -> int:
    """How many plane sections of d forces are looked at."""
    return 1 if d <= 2 else _SECTIONS


def _along_rays(
    value: Any, centre: Array, towards: Sequence[Array], directions: Array, seen: list[int]
) -> Iterator[tuple[Array, Array, Array, Array]]:
    """Pairs of points whose midpoint seems outside K, each pair with the points that its ends are pulled towards, one after the other."""
    rays = Rays(value, centre, directions)
    inside = rays.inside(_RADII)
    last, first = rays.narrowed(*first_exit(inside, _RADII))
    boundary = rays.at(last)
    seen.append(int(np.count_nonzero((last > 0) & (last < first))))
    # A ray that comes back into K after leaving it shows a gap by itself.
    later = inside & (first[:, None] < _RADII)
    who = np.flatnonzero(later.any(axis=1))[:8]
    back = np.argmax(later[who], axis=1)
    gap = Rays(value, centre, directions[who])
    enter, _ = gap.narrowed(_RADII[back], _RADII[back - 1])
    for inner, (leave, entry, farther) in product(towards, zip(boundary[who], gap.at(enter), gap.at(_RADII[back]), strict=True)):
        yield leave, entry, inner, farther
    n = len(directions)
    best: list[tuple[float, int, int]] = []
    for step in (step for step in (1, 2, 4, 8, 16, 32, 64, 100, 128, 180, 220, 256, 300) if step < n):
        other = np.roll(boundary, -step, axis=0)
        heights = value((boundary + other) / 2)
        size = np.linalg.norm(other - boundary, axis=1)
        score = np.where(np.isfinite(heights) & (size > 0), heights, -np.inf)
        top = int(np.argmax(score))
        if score[top] > 0:
            best.append((float(score[top]), top, (top + step) % n))
    for inner, (_, i, j) in product(towards, sorted(best, reverse=True)):
        yield boundary[i], boundary[j], inner, inner


def chords_between_exact_rays(subject: FormulaSubject, most: int = 4) -> Iterator[Chord]:
    """Those whose midpoint is highest above K, at so many choices of the parameters."""
    forces = subject.simple.forces
    price = _EXACT_NODE * sum(1 for _ in sp.preorder_traversal(subject.simple.g))
    for parameters in subject.choices(most) if len(forces) > 1 else ():
        if not subject.budget.pays(price * len(forces)):
            return
        g = subject.formula_at(parameters)
        yield from _between(g, forces, list(exact_rays(g, forces)), parameters)


def _between(g: sp.Expr, forces: Sequence[sp.Symbol], rays: Sequence[tuple[int, ...]], parameters: Values) -> Iterator[Chord]:
    run = compiled(g, forces)

    def value(points: Array) -> Array:
        heights = np.asarray(run(*np.moveaxis(points, -1, 0)), dtype=float)
        return np.where(np.isfinite(heights), heights, np.nan)

    lengths = 2.0 ** np.array(_POWERS)
    points = np.array(rays, dtype=float)[:, None, :] * lengths[:, None]
    heights = value(points)
    inside = heights <= _NOTHING * np.nanmax(np.abs(heights), axis=0, initial=0.0)
    ends = [(i, k) for i, row in enumerate(inside) for k in _ends(row)][:_POINTS]
    if len(ends) < 2:
        return
    known = np.array([points[i, k] for i, k in ends])
    one, two = np.triu_indices(len(ends), 1)
    middle = value((known[one] + known[two]) / 2)
    order = np.argsort(-np.where(np.isnan(middle), -np.inf, middle), kind="stable")[:_TRIED]
    for k in order:
        if middle[k] > 0:
            yield parameters, _place(rays, ends[one[k]]), _place(rays, ends[two[k]])


def _ends(inside: Array) -> list[int]:
    """Where a ray leaves K, and half-way and a quarter of the way there; of one that does not leave it some places."""
    last = [k for k in range(len(inside) - 1) if inside[k] and not inside[k + 1]]
    places = [k - j for k in last for j in (0, 1, 2)] if last else [len(inside) // 2 + j for j in (-2, 0, 2)]
    return [k for k in places if k >= 0 and inside[k]]


def _place(rays: Sequence[tuple[int, ...]], end: tuple[int, int]) -> Point:
    i, k = end
    return tuple(c * Fraction(2) ** _POWERS[k] for c in rays[i])


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
        for digits in _ENDS:
            unit = 10**digits
            yield exact * Fraction(unit - 1, unit) if exact else Fraction(isqrt(p * q * unit**2), q * unit)
        if exact:
            yield exact


def chords_from_far_points(subject: FormulaSubject, most: int = 4) -> Iterator[Chord]:
    """At so many choices of the parameters; none where g is no maximum."""
    forces = subject.simple.forces
    for parameters in subject.choices(most):
        g = subject.formula_at(parameters)
        for diameter in _diameters(g, forces):
            if not subject.budget.pays(_DIAMETER):
                return
            for t, middle in _mirrored(g, forces, diameter):
                yield parameters, diameter.at(t), diameter.at(2 * middle - t)


def _diameters(g: sp.Expr, forces: Sequence[sp.Symbol]) -> Iterator[_Diameter]:
    """Of each ellipsoid, through where it touches the planes on which the loads of other parts are constant."""
    seen = set[_Diameter]()
    for part in g.args if isinstance(g, sp.Max) else ():
        rows = [row for other in g.args if other is not part for row in _rows(other, forces)]
        for diameter in _across(_square(part, forces), rows, forces):
            if diameter not in seen and len(seen) < _DIAMETERS:
                seen.add(diameter)
                yield diameter


def _square(part: sp.Expr, forces: Sequence[sp.Symbol]) -> sp.Expr:
    """What is <= 0 where the part is, and quadratic if possible: of norm(...) - r, sqrt(q) - r or itself."""
    still, moving = part.as_independent(*forces, as_Add=True)
    scale, size = moving.as_independent(*forces, as_Add=False)
    if not moving.is_Add and scale.is_positive and still.is_negative:
        if isinstance(size, Norm):
            part = sp.Add(*(a**2 for a in size.args)) - (still / scale) ** 2
        elif size.is_Pow and size.exp == sp.S.Half:
            part = size.base - (still / scale) ** 2
    return part


def _rows(part: sp.Expr, forces: Sequence[sp.Symbol]) -> Iterator[tuple[sp.Rational, ...]]:
    """The coefficients of the loads in a part; of a quadratic polynomial, of its slopes."""
    slopes = [sp.diff(part, x) for x in forces] if part.is_polynomial(*forces) else []
    for load in (*largest_loads(part, forces), *(slope for slope in slopes if affine(slope, forces))):
        row = [sp.diff(load, x) for x in forces]
        if all(c.is_Rational for c in row):
            first = next(c for c in row if c)
            yield tuple(c / first for c in row)


def _across(square: sp.Expr, rows: Sequence[tuple[sp.Rational, ...]], forces: Sequence[sp.Symbol]) -> Iterator[_Diameter]:
    """The diameters, if {square <= 0} is an ellipsoid."""
    if not rows or (found := quadratic(square, forces)) is None or not found[0].is_positive_definite:
        return
    inverse = 2 * found[0].inv()
    centre = -inverse * found[1] / 2
    level = -square.xreplace(dict(zip(forces, centre, strict=True)))
    for row in dict.fromkeys(rows):
        way = inverse * sp.Matrix(row)
        square_of_way = (sp.Matrix(row).T * way)[0]
        if level > 0 and square_of_way > 0:
            yield _Diameter(tuple(map(fraction, centre)), tuple(map(fraction, way)), fraction(level / square_of_way))


def _mirrored(g: sp.Expr, forces: Sequence[sp.Symbol], diameter: _Diameter) -> Iterator[tuple[Fraction, Fraction]]:
    """Ends of a diameter, each with a place on it, no farther from the other end, at which g > 0, as it seems."""
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


# -- of a law kept as a graph ------------------------------------------------------------------------------------------

_DIRECTIONS, _FEWEST, _PAIRS, _LENGTHS, _TURNS = 1500, 100, 4, 10, 3
_LENGTH = 1_000_000  # letters of all definitions, beyond which fewer directions are looked at
_SIZES, _BITS = np.exp2(np.arange(-10.0, 30.0)), 40
_DIGITS = (2, 3, 4, 6, 9, 12)
_BEST = 2  # of each length
_NOISE_OF_GRAPH = 1e-11  # relative to the sizes of g


def graph_chords(subject: GraphSubject, parameters: Values) -> Iterator[tuple[Point, Point]]:
    """Ends in K with a midpoint that seems to lie outside, the plainest digits first."""
    forces = subject.law.force_symbols()
    rest = {x: float(v) for x, v in subject.values_at(parameters, [Fraction(0)] * len(forces)).items() if x not in forces}
    program = compiled(subject.law.g, [*forces, *rest])

    def g(at: Array) -> Array:
        with np.errstate(all="ignore"):
            return np.asarray(program(*np.moveaxis(at, -1, 0), *rest.values()) + np.zeros(at.shape[:-1]))

    rng = np.random.default_rng(0)
    length = sum(len(text) for _, text in subject.law.graph.nodes) if subject.law.graph else 0
    directions = int(np.clip(_DIRECTIONS * _LENGTH / max(length, 1), _FEWEST, _DIRECTIONS))
    zero = np.zeros(len(forces))
    start = zero if g(zero) < 0.0 else lowest(g, len(forces), rng, (-2, 2))
    if start is None or len(edge := _boundary(g, start, directions, rng)) < 2:
        return
    with np.errstate(all="ignore"):  # where g has no value, or an infinite one
        found = [*_long(g, start, edge, rng), *_short(g, start, edge, rng)]
    for a, b in found:
        yield from _in_digits(a, b)


def _boundary(g: Callable[[Array], Array], start: Array, directions: int, rng: np.random.Generator) -> Array:
    """Points just inside of where rays from a point of K leave it."""
    ways = rng.normal(size=(directions, len(start)))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    rays = Rays(g, start, ways)
    last, first = rays.left(_SIZES, _BITS)
    return rays.at(last)[last < first]


def _long(g: Callable[[Array], Array], start: Array, edge: Array, rng: np.random.Generator) -> Iterator[tuple[Array, Array]]:
    """Between two points of the boundary, a little nearer to the inner point."""
    a, b = (start + (1.0 - 1e-6) * (edge[rng.integers(len(edge), size=_PAIRS * len(edge))] - start) for _ in range(2))
    above = np.minimum(g(0.5 * (a + b)), -np.maximum(g(a), g(b)))
    for i in np.argsort(-above)[:_BEST]:
        if above[i] > 0.0:
            yield a[i], b[i]


def _short(g: Callable[[Array], Array], start: Array, edge: Array, rng: np.random.Generator) -> Iterator[tuple[Array, Array]]:
    """Along tangents, both ends on one level."""
    size = float(np.median(np.linalg.norm(edge - start, axis=1)))
    steps = 1e-6 * size * np.eye(edge.shape[1])
    slopes = np.stack([(g(edge + s) - g(edge - s)) / (2e-6 * size) for s in steps], axis=1)
    steep = np.linalg.norm(slopes, axis=1, keepdims=True)
    edge, slopes, steep = (x[np.isfinite(steep[:, 0]) & (steep[:, 0] > 0.0)] for x in (edge, slopes, steep))
    normal, noise = slopes / steep, _NOISE_OF_GRAPH * float(np.max(steep, initial=0.0)) * size
    for k in range(1, _LENGTHS + 1):
        along = rng.normal(size=edge.shape)
        along -= normal * np.sum(along * normal, axis=1, keepdims=True)
        along *= size * 2.0**-k / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
        middle = edge
        for _ in range(_TURNS):
            ahead, behind = g(middle + along), g(middle - along)
            along = along - normal * ((ahead - behind)[:, None] / (2.0 * steep))
            middle = middle - normal * (0.5 * (ahead + behind)[:, None] / steep)
        ends, above = np.maximum(g(middle + along), g(middle - along)), g(middle)
        gap = np.where(np.isfinite(ends + above), above - ends, -np.inf)
        middle = middle - normal * ((ends + 0.5 * gap)[:, None] / steep)
        for i in np.argsort(-gap)[:_BEST]:
            if gap[i] > noise:
                yield middle[i] + along[i], middle[i] - along[i]


def _in_digits(a: Array, b: Array) -> Iterator[tuple[Point, Point]]:
    """The ends rounded to a few digits of the chord's length, then to more, then as they are."""
    first = -int(np.floor(np.log10(np.max(np.abs(a - b)))))
    p, q = (tuple(Fraction(float(x)) for x in end) for end in (a, b))
    for digits in _DIGITS:
        one, two = (tuple(round(x, first + digits) for x in end) for end in (p, q))
        yield one, two
    yield p, q
