"""Where the boundary of K has a corner or comes to a point.

Corners lie at a seam in two forces, and in some plane of the force space in more.

Two kinds of planes are looked at: those through the zeros of a root (the axis of a cone, where its tip is), and some through a
point of K, in which the boundary is followed around and its normal is seen to jump.  Directions are small whole numbers (fixed seed).
Points are sought at zero force, and where the boundary meets axes or edges at plain fractions.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import chain, islice, product
from typing import Any

import numpy as np
import sympy as sp

from duhem.expression import EigMax, Norm, defined_at, mpmath_
from duhem.expression.balls import ball
from duhem.expression.branches import Seam, jacobian, seams
from duhem.expression.number import fraction, rational
from duhem.expression.numpy_ import compiled
from duhem.expression.rays import Rays, exits
from duhem.expression.vocabulary import KINKS
from duhem.law.domain import REAL
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.plane_section import PlaneSection, local_pieces
from duhem.proof.facts.subject import Point, Values, rationals
from duhem.proof.search.boundary_points import BoundaryScout, scout
from duhem.proof.search.edges import edges

__all__ = ["Crossing", "centred_choices", "crossings", "quadratic", "section_corners", "sharp_points"]

_MOST, _NEAREST = 16, 2  # crossings of one seam; places nearest to it
_MOST_EXPONENT = 10_000  # SymPy makes polynomials of so high a degree of a power: that took more than a minute
_START = 8_000  # steps from one place to a crossing, or to none
_PLANES, _TIPS, _PLACES, _CENTRES = 6, 6, 6, 6
_DIRECTIONS = 1440
_JUMP = 1e-4  # of the direction, in radians: a smooth boundary turns less where it is looked at so closely
_STEPS = 4_000  # of a place, or of looking around a plane, by the operations in the formula
_DIGITS = 40
_AROUND = Fraction(1, 10**4)  # of a place in floats, by its size: as far as pieces are opened there
_SHARP = 1e-5
_MOST_WAYS, _SHOWN = 400, 6
_PLACE = 20_000  # steps of one
_LEANS = (Fraction(1, 16), Fraction(1), Fraction(4))  # how far two ways out of K lean towards that into it; the first at ends of ranges
_SAME = 3.0  # how much more one may fall than the other on a tenth of the way
_LARGEST = 10_000  # the denominator of a plain fraction
_ALONG = 10.0 ** np.linspace(-5, 5, 61)

Place = tuple[float, float]
Crossing = tuple[Seam, Point]  # a point (decimals of high precision) on the boundary, on a seam with one switch
SharpPoint = tuple[
    Values, Point, Point, Point, Fraction
]  # a place from which, as it seems, K is left in the directions c v + w and c v - w, and entered in v; w, v and c
SectionCorner = tuple[Values, PlaneSection, Point]  # a place in a plane of forces at which, as it seems, the boundary has a corner


def crossings(subject: FormulaSubject, parameters: Values, digits: int = 40) -> Iterator[Crossing]:
    """Common zeros of g and of one seam at a parameter choice, to about ``digits`` decimals; found, not certain; while steps are left."""
    exact, forces = rationals(parameters), subject.simple.forces
    exponents = {x for power in subject.simple.g.atoms(sp.Pow) for x in power.exp.free_symbols}
    if any(abs(value.p) > _MOST_EXPONENT for x, value in exact.items() if x in exponents):
        return
    around = scout(subject, parameters).boundary
    for seam in seams(subject.pieces or ()) if len(around) else ():
        if len(seam.crossed) != 1:
            continue
        system = sp.Matrix([seam.after.expr, *seam.crossed]).subs(exact)
        switch = np.broadcast_to(compiled(system[1], forces)(*around.T), len(around))
        turns = np.flatnonzero(np.sign(switch) != np.sign(np.roll(switch, -1)))[:_MOST]
        nearest = np.argsort(np.abs(switch))[:_NEAREST]  # the seam may begin where rays no longer leave K
        slopes, known = jacobian(system, forces), list[Point]()
        for start in around[[*turns, *nearest]] if slopes is not None else ():
            if any(math.dist(map(float, point), start) < 0.1 * math.hypot(*start) for point in known):
                continue  # a place beside one that led here
            if not subject.budget.pays(_START):
                return
            if (point := common_zero(system, slopes, forces, start, digits)) is not None:
                known.append(point)
                yield seam, point


def common_zero(system: sp.Matrix, slopes: sp.Matrix, unknowns: Sequence[sp.Symbol], start: Sequence[float], digits: int) -> Point | None:
    """The zero that Newton's method comes to, to about ``digits`` decimals; None where it comes to none.

    ``slopes`` are the derivatives of the formulas, row by row.
    """
    context = mpmath_.kept_digits(digits)
    values, derivatives = (mpmath_.compiled(list(exprs), unknowns, context) for exprs in (system, slopes))

    def values_at(*x: Any) -> Any:
        if not all(map(context.isfinite, found := values(*x))):
            raise ZeroDivisionError  # of nan the search would halve its step for ever
        return found

    def jacobian_at(*x: Any) -> Any:
        a, b, c, d = derivatives(*x)
        if not (det := a * d - b * c) or not context.isfinite(det):
            raise ZeroDivisionError
        return context.matrix([[a, b], [c, d]])

    try:
        found = context.findroot(values_at, list(map(float, start)), J=jacobian_at, maxsteps=60)
    except (ValueError, ZeroDivisionError):
        return None
    whole = 10 ** (digits - 4)
    return tuple(Fraction(int(context.nint(p * whole)), whole) for p in found) if all(map(context.isfinite, found)) else None


def section_corners(subject: FormulaSubject, parameters: Values, drawn: bool = True) -> Iterator[SectionCorner]:
    """Corners in planes at a parameter choice, the tips of cones first; found, not certain; while steps are left.

    Unless ``drawn``, in planes across a switch of the formula alone.  Two forces have one plane.
    """
    price = _STEPS * sp.count_ops(subject.simple.g)
    found: Iterable[tuple[PlaneSection, Iterable[Sequence[float]]]]
    if len(subject.simple.forces) == 2:
        whole = PlaneSection.whole(subject.simple.forces)
        found = [(whole, _turns(subject, parameters, whole))] if subject.budget.pays(price) else []
    else:
        kinked = subject.simple.g.has(*KINKS, EigMax)
        found = chain(_tips(subject, parameters) if drawn else (), _planes(subject, parameters, price, drawn) if kinked else ())
    for section, places in found:
        for place in places:
            if not subject.budget.pays(price):
                return
            with suppress(ValueError):  # of a number in the plane with thousands of digits
                yield from _polished(subject, parameters, section, place)


def _polished(subject: FormulaSubject, parameters: Values, section: PlaneSection, place: Sequence[float]) -> Iterator[SectionCorner]:
    """The common zeros of g and of a seam near a place, to many digits, where the gradients beside it are not parallel."""
    middle = [Fraction(c).limit_denominator(10**12) for c in place]
    reach = _AROUND * Fraction(max(*map(abs, place), 1e-3)).limit_denominator(1000)
    box = {x: ball(c - reach, c + reach) for x, c in zip(section.at, middle, strict=True)}
    for seam in seams(local_pieces(subject, parameters, section, box, whole_space=False), both_ways=True):
        if len(seam.crossed) == 1:
            system = sp.Matrix([seam.after.expr, *seam.crossed])
            slopes = jacobian(system, section.at)
            found = None if slopes is None else common_zero(system, slopes, section.at, [float(c) for c in middle], _DIGITS)
            near = found is not None and all(abs(f - c) <= 2 * reach for f, c in zip(found, middle, strict=True))
            if found is not None and near and (_turned(seam, section.at, found) or _jumps(seam, section.at, found)):
                yield parameters, section, found


def _turned(seam: Seam, unknowns: Sequence[sp.Symbol], place: Point) -> bool:
    at = dict(zip(unknowns, map(rational, place), strict=True))
    one, two = ([complex(sp.diff(b.expr, x).evalf(30, subs=at)) for x in unknowns] for b in (seam.before, seam.after))
    cross, sizes = abs(one[0] * two[1] - one[1] * two[0]), [abs(n[0]) + abs(n[1]) for n in (one, two)]
    return bool(cross > 1e-9 * sizes[0] * sizes[1])


def _jumps(seam: Seam, unknowns: Sequence[sp.Symbol], place: Point) -> bool:
    """Whether g is not 0 on the other side of a seam, so that K ends on it."""
    height = complex(seam.before.expr.evalf(30, subs=dict(zip(unknowns, map(rational, place), strict=True))))
    return bool(abs(height) > 1e-9)


def _tips(subject: FormulaSubject, parameters: Values) -> Iterator[tuple[PlaneSection, list[Place]]]:
    """Planes through a line on which a root is 0, with the places where g is 0 on it."""
    forces, rng = subject.simple.forces, random.Random(3)
    g = subject.formula_at(parameters)
    known = set[tuple[Any, ...]]()
    for node in sorted(g.atoms(sp.Add, Norm), key=sp.default_sort_key):
        for base, u in _zero_lines(node, forces, rng):
            if (key := (*base, *u)) in known or len(known) == _TIPS:
                continue
            known.add(key)
            section = PlaneSection.through(forces, base, u, _direction(rng, len(forces)))
            a, b = section.at
            if places := [(s, 0.0) for s in _zeros_along(g.xreplace(section.coordinates()), a, b)]:
                yield section, places


def _zero_lines(node: Any, forces: Sequence[sp.Symbol], rng: random.Random) -> Iterator[tuple[Point, Point]]:
    """Lines on which the squares in a norm or in a sum are all 0, each by a point and a direction."""
    squares = [c**2 for c in node.args] if isinstance(node, Norm) else [t for t in node.args if t.is_polynomial(*forces)]
    whole = node.is_polynomial(*forces)
    under = sp.Add(*(t for t in squares if whole or any(f.is_Pow and f.exp == 2 for f in sp.Mul.make_args(t))))
    if (found := quadratic(under, forces)) is None or not (kernel := found[0].nullspace()):
        return
    try:
        base = found[0].gauss_jordan_solve(-found[1])
    except ValueError:  # it has no least value
        return
    centre = base[0].subs(dict.fromkeys(base[1], 0))
    for shares in ([int(i == k) for i in range(len(kernel))] for k in range(len(kernel))):
        mixed = shares if len(kernel) == 1 else [s + rng.choice((0, 1, -1)) for s in shares]
        u = sum((s * v for s, v in zip(mixed, kernel, strict=True)), sp.zeros(len(forces), 1))
        if any(u):
            yield tuple(fraction(c) for c in centre), tuple(fraction(c) for c in u)


def quadratic(expr: sp.Expr, forces: Sequence[sp.Symbol]) -> tuple[sp.Matrix, sp.Matrix] | None:
    """Second derivatives, and first ones at zero force, of a polynomial of degree 2 with fractions; None for any other formula."""
    if not expr.is_polynomial(*forces) or (form := sp.Poly(expr, *forces)).total_degree() != 2 or form.domain not in (sp.ZZ, sp.QQ):
        return None
    slope = sp.Matrix([form.diff(x)(*(0 for _ in forces)) for x in forces])
    return sp.hessian(form.as_expr(), forces), slope


def _zeros_along(h: sp.Expr, a: sp.Symbol, b: sp.Symbol) -> list[float]:
    """Where h changes its sign along b = 0, taken a little beside it, for it may be 0/0 on the line itself."""
    from scipy.optimize import brentq  # it takes longer to import than most laws to be looked at

    level, radii = compiled(h, (a, b)), 10.0 ** np.linspace(-4, 4, 400)
    grid = np.concatenate([-radii[::-1], radii])
    signs = np.sign(level(grid, np.full_like(grid, 1e-9)))
    return [float(brentq(lambda x: float(level(x, 1e-9)), grid[k], grid[k + 1])) for k in np.flatnonzero(signs[:-1] * signs[1:] < 0)]


def _planes(subject: FormulaSubject, parameters: Values, price: int, drawn: bool) -> Iterator[tuple[PlaneSection, list[Place]]]:
    """Some through a point of K: ``drawn``, each force in units of how far K reaches along it, or across switches of the formula."""
    seen, rng, forces = scout(subject, parameters), random.Random(4), subject.simple.forces
    if seen.centre is None or not len(seen.boundary):
        return
    # What is 0 where the matrices in g are diagonal: there one sees which eigenvalue is the greatest.
    still = {x for node in subject.simple.g.atoms(EigMax) for shear in node.args[3:] for x in shear.free_symbols}
    base = [Fraction(float(c)).limit_denominator(1000) * (x not in still) for x, c in zip(forces, seen.centre, strict=True)]
    units = [Fraction(2) ** math.frexp(max(abs(column), default=1))[1] for column in (seen.boundary - seen.centre).T]
    units = [unit * (x not in still) for x, unit in zip(forces, units, strict=True)]
    random_pairs = ([[c * unit for c, unit in zip(_direction(rng, len(forces)), units, strict=True)] for _ in "uv"] for _ in range(_PLANES))
    for u, v in random_pairs if drawn else _rays_across(subject, seen):
        if not subject.budget.pays(price):
            return
        section = PlaneSection.through(forces, base, u, v)
        yield section, _turns(subject, parameters, section)


def _rays_across(subject: FormulaSubject, seen: BoundaryScout) -> Iterator[list[list[Fraction]]]:
    """A ray to a point of the boundary, and what leads across it to a near one where a switch of the formula has the other sign.

    The first is one of the fewer rays on one side of the switch.
    """
    units = seen.directions / np.linalg.norm(seen.directions, axis=1, keepdims=True)
    for switch in dict.fromkeys(s for piece in subject.pieces or () for s in piece.signs):
        side = compiled(switch.subs(rationals(seen.parameters)), subject.simple.forces)
        above = np.broadcast_to(side(*seen.boundary.T), len(units)) > 0
        few, others = sorted((np.flatnonzero(above), np.flatnonzero(~above)), key=len)
        for k in few[:_NEAREST]:
            near = units[others[int(np.argmax(units[others] @ units[k]))]]
            aside = near - (near @ units[k]) * units[k]
            yield [[Fraction(float(c)).limit_denominator(1000) for c in way] for way in (units[k], aside / np.linalg.norm(aside))]


def _direction(rng: random.Random, dimension: int) -> Point:
    """Whole numbers of many sizes, none of them 0, so that few planes lie along a seam."""
    return tuple(Fraction(rng.choice((-1, 1)) * rng.randint(1, 9)) for _ in range(dimension))


def _turns(subject: FormulaSubject, parameters: Values, section: PlaneSection) -> list[Place]:
    """Places of the boundary in a plane at which its direction jumps, seen from a = b = 0."""
    level = compiled(subject.formula_at(parameters).xreplace(section.coordinates()), section.at)

    def points(angles: Any) -> Any:
        ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        last, first = Rays(lambda p: level(p[..., 0], p[..., 1]), np.zeros(2), ways).left(10.0 ** np.linspace(-4, 4, 81))
        return np.where(((last > 0) & (last < first))[:, None], last[:, None] * ways, np.nan)

    def bends(angles: Any) -> Any:
        """How much the chord from each point to the next turns at the point between; nan at both ends."""
        chords = np.diff(points(angles), axis=0)
        turn = np.arctan2(chords[:-1, 0] * chords[1:, 1] - chords[:-1, 1] * chords[1:, 0], np.sum(chords[:-1] * chords[1:], axis=1))
        return np.abs(np.where(np.isfinite(turn), turn, 0.0))

    step, found = 2 * np.pi / _DIRECTIONS, list[Place]()
    turn = step * np.arange(-1, _DIRECTIONS + 1) + 1e-3
    with np.errstate(all="ignore"):
        bent = bends(turn)
        beside = np.maximum(np.roll(bent, 3), np.roll(bent, -3))
        for k in np.argsort(beside - bent)[:_PLACES]:
            middle, width = turn[k + 1], step
            for _ in range(5):  # a jump is left however near one looks; a bend goes with the distance
                near = middle + width * np.linspace(-1, 1, 17)
                left = bends(near)
                middle, width = near[int(np.argmax(left)) + 1], width / 6
            (place,) = points(np.array([middle]))
            again = any(np.linalg.norm(place - other) < 1e-3 * np.linalg.norm(place) for other in found)
            if left.max() > _JUMP and np.all(np.isfinite(place)) and not again:
                found.append((float(place[0]), float(place[1])))
    return found


def sharp_points(subject: FormulaSubject, parameters: Values) -> Iterator[SharpPoint]:
    """Places with directions: g > 0 on two of them, as it seems, and g < 0 on one between these; while steps are left.

    All three lead into the ranges of the forces, so that the place may be at an end of one.
    """
    forces = subject.simple.forces
    g = subject.formula_at(parameters)
    level, pointed = compiled(g, forces), edges(g, forces)
    ways = list(dict.fromkeys([*_ways(len(forces)), *(tuple(Fraction(c, max(map(abs, edge))) for c in edge) for edge in pointed)]))
    opposite = [ways.index(tuple(-c for c in way)) for way in ways]
    steps = np.array([[float(c) for c in way] for way in ways])
    low, high = np.array([subject.domain.get(x.name, REAL).ends for x in forces]).T

    def values(place: Point, reach: float, lean: Any = 0) -> Any:
        points = np.array([float(c) for c in place]) + reach * (steps + lean)
        with np.errstate(all="ignore"):
            return np.where(np.all((low < points) & (points < high), axis=1), level(*points.T), np.nan)

    for place in dict.fromkeys([*_plain_places(g, forces), *_centre(g, forces), *_on_edges(g, forces, pointed)]):
        if not subject.budget.pays(_PLACE):
            return
        size = _SHARP * max(1.0, *(abs(float(c)) for c in place))
        found, nearer = values(place, size), values(place, size / 10)
        home = tuple(-c / max(map(abs, place)) for c in place) if any(place) else None
        back = [k for k, way in enumerate(ways) if way == home]  # on which floats may not see that a load is 0
        falls = [(k, nearer[k] / found[k]) for k in np.argsort(found) if -np.inf < found[k] < 0]
        at_an_end = any(float(c) in ends for c, *ends in zip(place, low, high, strict=True))  # opposite ways are not both in the range
        leans = _LEANS[not at_an_end :]
        ends = [(k, fall, Fraction(0)) for k, fall in [*((k, 0.1) for k in back), *falls[:2]][:2]]
        for k, fall, lean in (*ends, *((k, fall, lean) for lean in leans for k, fall in falls)):
            between = float(lean) * steps[k]
            both, both_nearer = (np.minimum(v, v[opposite]) for v in (values(place, r, between) for r in (size, size / 10)))
            # where g rises less steeply than it falls, K has a tangent
            steep = [i for i in np.argsort(-both) if both[i] > 0 and both_nearer[i] > both[i] * fall / _SAME]
            for i in steep[: 1 if lean else _SHOWN]:
                if lean and not subject.budget.pays(_PLACE):
                    return
                yield parameters, place, ways[i], ways[k], lean


def _plain_places(g: sp.Expr, forces: Sequence[sp.Symbol]) -> Iterator[Point]:
    yield tuple(Fraction(0) for _ in forces)
    for i, x in enumerate(forces):
        along = defined_at(g, {y: sp.S.Zero for y in forces if y != x})
        if along is not None and along.is_polynomial(x) and (form := sp.Poly(along, x)).domain in (sp.ZZ, sp.QQ) and not form.is_ground:
            for root in sorted(form.ground_roots()):
                if root:
                    yield tuple(Fraction(int(root.p), int(root.q)) if k == i else Fraction(0) for k in range(len(forces)))


def centred_choices(subject: FormulaSubject) -> Iterator[Values]:
    """Choices of the parameters at which a quadratic g is 0 at its centre: its matrix, with 1 as a force more, has the determinant 0."""
    forces, one = subject.simple.forces, sp.Dummy()
    if not subject.simple.g.is_polynomial(*forces) or (form := sp.Poly(subject.simple.g, *forces)).total_degree() != 2:
        return
    matrix = sp.hessian(form.homogenize(one).as_expr(), (*forces, one))
    for plain in subject.choices(_CENTRES):
        for x in plain:
            at = matrix.subs({y: rational(value) for y, value in plain.items() if y != x})
            over = sp.numer(sp.together(at.det()))
            if over.has(x) and over.is_polynomial(x) and (line := sp.Poly(over, x)).domain in (sp.ZZ, sp.QQ):
                yield from ({**plain, x: fraction(root)} for root in line.ground_roots())


def _centre(g: sp.Expr, forces: Sequence[sp.Symbol]) -> Iterator[Point]:
    """That of a quadratic g, where g is 0 there."""
    if (found := quadratic(g, forces)) is not None and found[0].det():
        centre = -found[0].LUsolve(found[1])
        if g.xreplace(dict(zip(forces, centre, strict=True))).is_zero:
            yield tuple(map(fraction, centre))


def _on_edges(g: sp.Expr, forces: Sequence[sp.Symbol], pointed: Sequence[tuple[int, ...]]) -> Iterator[Point]:
    """Where rays along edges leave K, at fractions."""
    r = sp.Symbol("r", positive=True)
    for edge in pointed:  # what is 0 on it must be seen to be
        along = defined_at(g, {x: c * r for x, c in zip(forces, edge, strict=True)})
        if along is None:
            continue
        last, first = exits(along, (r,), np.ones((1, 1)), _ALONG, {})
        far = Fraction(float(last[0])).limit_denominator(_LARGEST) if 0 < last[0] < first[0] else Fraction(0)
        place = tuple(far * c for c in edge)
        value = defined_at(g, rationals(dict(zip(forces, place, strict=True)))) if far else None
        if value is not None and value.is_zero:
            yield place


def _ways(dimension: int) -> list[Point]:
    """Directions of small whole numbers, each with its opposite: in many forces some at random (fixed seed), the axes and the pressure."""
    if dimension <= 3:
        return [tuple(map(Fraction, way)) for way in product(range(-2, 3), repeat=dimension) if any(way)]
    rng = random.Random(6)
    drawn = ([rng.randint(-2, 2) for _ in range(dimension)] for _ in iter(int, 1))
    found = dict.fromkeys(tuple(map(Fraction, way)) for way in islice((w for w in drawn if any(w)), _MOST_WAYS // 2))
    axes = [tuple(Fraction(int(i in at)) for i in range(dimension)) for at in (*((k,) for k in range(dimension)), range(3))]
    return list(dict.fromkeys(sign for way in (*found, *axes) for sign in (way, tuple(-c for c in way))))
