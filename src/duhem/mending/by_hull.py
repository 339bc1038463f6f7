"""The convex hull of K in the plane of two forces: each dent is bridged by the line that touches K on both sides of it.

Let gamma be the gauge of K, L_i <= 1 the lines and s_i > 0 the cones of the dents.  Then

    max(L_1, ..., L_n, gamma - M (pos(s_1) + ... + pos(s_n)))

is the gauge of the hull for an M so large that L_i is the greatest inside cone i: outside of the cones no L is greater than gamma.  So is
max(L_1, ..., min(gamma, T_1, ..., T_n)) with T_i = max(d, L_i - M s_i), which subtracts nothing from a root.  What g = A - S^k B says of
gamma^k = A/B is said of these without a quotient.  A line that has short fractions, perhaps in its squares, stands in this exactly; others
are moved inward by a thousandth, so that they cut K and meet it in corners.  What has no such g is bounded by a polygon around K.

Everything here is found in floating point: what is proved of the result is proved of its text.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise, product
from math import ceil, gcd

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression import Norm, balls
from duhem.expression.numpy_ import evaluate
from duhem.expression.parse import parse_expression
from duhem.expression.text import formula
from duhem.law.formula_law import Criterion
from duhem.mending.formulas import decimal, linear, norm_of, power, total
from duhem.mending.limit_load import LoadScale, limit_loads, plain_values, ways_of

__all__ = ["by_hull", "hull_loads"]

Array = NDArray[np.float64]
_DEEP = 1e-7  # of the load: a dent that is no deeper is rounding
_MOST_DENTS, _FEW_DENTS = 6, 2  # with short fractions, and with long ones
_SEAM = 1e-6
_WINDOWS = (0.02, 0.005, 0.005)  # rad around a place where a line touches
_INWARD = Fraction(1, 1000)
_ALIKE, _MOST_DENOMINATOR = 3e-7, 400
_SHORT = [w for w in product(range(-3, 4), repeat=2) if gcd(*w) == 1]  # directions of axes of symmetry
_MOST_SIDES, _OUTWARD = 32, 1e-3
_HALVINGS = 20
Touched = Callable[[Array], Array]  # points (m, 2) of the boundary at angles (m,), where K is of the scale 1


@dataclass(frozen=True)
class Dent:
    """``line`` . force <= S touches K at two rays, ``cosine`` away from the ``axis`` between them."""

    line: Array
    axis: Array
    cosine: float


@dataclass(frozen=True)
class Split:
    """g = over - S**power*under, both > 0."""

    over: sp.Expr
    under: sp.Expr
    power: int


def hull_loads(points: Array, ways: Array) -> Array:
    """How far the convex hull of points (m, 2) around zero reaches along ``ways`` (n, 2)."""
    from scipy.spatial import ConvexHull

    faces = ConvexHull(points).equations
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / (ways @ (faces[:, :2] / -faces[:, 2:]).T).max(axis=1))


def by_hull(law: Criterion, scale: LoadScale) -> Iterator[tuple[str, str]]:
    """g of the hull, exact ones first, then those with lines moved inward, last a polygon around K; what is said of each."""
    values = plain_values(law)
    size = scale.size(values)

    def touched(angles: Array) -> Array:
        ways = np.column_stack([np.cos(angles), np.sin(angles)])
        return ways * (limit_loads(law, values, ways) / size)[:, None]

    ways = ways_of(law)
    points = touched(np.arctan2(ways[:, 1], ways[:, 0]))
    if not np.isfinite(points).all():
        raise InputError("K has no end in some directions", where=law.name, remedy="mend it by parameters")
    dents = _dents(points, touched)
    split = _split(law, scale, ways, np.linalg.norm(points, axis=1))
    if split is not None and len(dents) <= _MOST_DENTS:
        for forms, squares, told in _forms(dents, law.forces):
            yield _text(law, scale, split, forms, ways, squares), told
    yield _polygon(law, scale, points, [dent.line for dent in dents])


# -- dents -------------------------------------------------------------------------------------------------------------


def _dents(points: Array, touched: Touched) -> list[Dent]:
    from scipy.spatial import ConvexHull

    found, angles = list[Dent](), np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    corners = sorted(ConvexHull(points).vertices.tolist())
    for i, j in pairwise([*corners, corners[0] + len(points)]):
        line = _through(points[i], points[j % len(points)])
        between = np.arange(i, j + 1) % len(points)
        if (1.0 - points[between] @ line).max() > _DEEP:
            ends = np.array([angles[i], angles[j % len(points)] + (2.0 * np.pi if j >= len(points) else 0.0)])
            for window in _WINDOWS:
                ends = np.array([_where_it_touches(touched, line, end, window) for end in ends])
                line = _through(*touched(ends))
            middle, half = ends.mean(), np.ptp(ends) / 2.0
            found.append(Dent(line, np.array([np.cos(middle), np.sin(middle)]), float(np.cos(half))))
    return found


def _through(p: Array, q: Array) -> Array:
    """The line through two points: where it is 1."""
    normal = np.array([q[1] - p[1], p[0] - q[0]])
    return np.asarray(normal / (normal @ p))


def _where_it_touches(touched: Touched, line: Array, near: float, window: float) -> float:
    """The angle near one at which the boundary is farthest out across a line: by a polynomial, at a corner by the points alone."""
    steps = np.linspace(-1.0, 1.0, 41)
    reach = touched(near + window * steps) @ line
    fit = np.polynomial.Polynomial.fit(steps, reach, 8)
    best = steps[reach.argmax()]
    roots = [x.real for x in fit.deriv().roots() if abs(x.imag) < 1e-9 and abs(x.real - best) < 0.1]
    smooth = roots and np.abs(fit(steps) - reach).max() < 1e-10
    return float(near + window * (max(roots, key=fit) if smooth else best))


# -- as formulas -------------------------------------------------------------------------------------------------------


def _split(law: Criterion, scale: LoadScale, ways: Array, loads: Array) -> Split | None:
    """What g is in the scale, where it is of this form."""
    t, table = sp.Symbol("t", positive=True), law.symbols()
    carrier = next((n for n in (law.pressure, *scale.powers) if n and scale.powers.get(n)), None)
    swap = {**law.settled(), **{table[n]: sp.S.One for n in law.parameters if law.parameters[n].value is None}}
    swap |= {table[law.pressure]: sp.S.NegativeOne} if law.pressure else {}
    if carrier is not None:
        swap[table[carrier]] = -t if carrier == law.pressure else t
    g = law.g.xreplace(swap).expand() if carrier is not None else law.g.xreplace(swap)
    if carrier is None:
        constant, over = g.as_coeff_Add()
        under, power = -constant, None
    else:
        try:
            terms = sp.Poly(g, t).as_dict()
        except sp.PolynomialError:
            return None
        if len(terms) != 2 or (0,) not in terms:
            return None
        over = terms.pop((0,))
        (((most,), rest),) = terms.items()
        under, power = -rest, sp.Integer(most) / scale.powers[carrier]
    names = law.force_symbols()
    high, low = (np.broadcast_to(evaluate(x, dict(zip(names, ways.T, strict=True))), len(ways)) for x in (over, under))
    if not ((high > 0).all() and (low > 0).all()):
        return None
    if power is None:
        twice = np.broadcast_to(evaluate(over, dict(zip(names, 2.0 * ways.T, strict=True))), len(ways))
        power = sp.Integer(round(float(np.log2(twice[0] / high[0]))))
    if not (power.is_Integer and power > 0) or not np.allclose((high / low) ** (-1.0 / float(power)), loads, rtol=1e-9):
        return None
    return Split(over, under, int(power))


_Form = tuple[str, str]  # a line, and what is > 0 in its cone; their squares where it says so


def _forms(dents: Sequence[Dent], forces: Sequence[str]) -> Iterator[tuple[list[_Form], bool, str]]:
    """The lines and cones of all dents, and whether these are squares; exact ones first."""
    told = "each dent is bridged by the line that touches K on both sides of it"
    for squares in (False, True):
        exact = [form for dent in dents if (form := _exact(dent, forces, squares)) is not None]
        if len(exact) == len(dents):
            yield exact, squares, told
    moved = [
        (linear(dent.line * float(1 + _INWARD), forces), f"{linear(dent.axis, forces)} - {decimal(dent.cosine)}*{norm_of(forces)}")
        for dent in dents
    ]
    if len(dents) <= _FEW_DENTS:
        yield moved, False, f"{told}, moved inward by {_INWARD}"


def _exact(dent: Dent, forces: Sequence[str], squares: bool) -> _Form | None:
    """By short fractions, of a dent that is symmetric about a short direction."""
    away = np.array([dent.line / np.linalg.norm(dent.line), dent.axis])
    w = next((w for w in _SHORT if np.abs(away - np.array(w) / np.hypot(*w)).max() < 1e-5), None)
    if w is None:
        return None
    power, r = 1 + squares, np.hypot(*w)
    limit, cosine = (_fraction(x**power) for x in (1.0 / (np.linalg.norm(dent.line) / r), dent.cosine * r))
    if limit is None or cosine is None:
        return None
    load = " + ".join({1: "", -1: "-"}.get(c, f"{c}*") + f for c, f in zip(w, forces, strict=True) if c).replace("+ -", "- ")
    norm = norm_of(forces)
    if squares:
        return f"{1 / limit}*pos({load})**2", f"pos({load})**2 - {cosine}*{norm}**2"
    return f"{1 / limit}*({load})", f"{load} - {cosine}*{norm}"


def _fraction(x: float) -> Fraction | None:
    near = Fraction(x).limit_denominator(_MOST_DENOMINATOR)
    return near if abs(near - Fraction(x)) < _ALIKE * x else None


def _text(law: Criterion, scale: LoadScale, split: Split, forms: Sequence[_Form], ways: Array, squares: bool) -> str:
    """The gauge of the hull, multiplied out; where g has roots, that from which nothing is subtracted."""
    known = dict(zip(law.forces, law.force_symbols(), strict=True))
    places = dict(zip(known.values(), ways.T, strict=True))

    def at(text: str) -> Array:
        return np.asarray(np.broadcast_to(evaluate(parse_expression(text, known), places), len(ways)))

    twice = 2 if squares and split.power % 2 else 1
    degree = split.power * twice
    over, under = (formula(x**twice) for x in (split.over, split.under))
    norm, rest = norm_of(law.forces), degree - 1 - squares
    lines = [power(f"({x})", degree // 2) if squares else x if degree == 1 else power(f"pos({x})", degree) for x, _ in forms]
    cones = [f"({cone})*{power(norm, rest)}" if rest else cone for _, cone in forms]
    gauge, high, wide = at(over) / at(under), np.maximum([at(line) for line in lines], 0.0), np.array([at(cone) for cone in cones])
    inside = wide > _SEAM
    with np.errstate(divide="ignore", invalid="ignore"):
        steep = np.where(np.abs(wide) > _SEAM, (gauge - high) / np.abs(wide), 0.0).max()
    m, times = ceil(1.5 * steep) + 1, "" if under == "1" else f"*({under})"
    load, parts = f"{power(f'({scale.text})', degree)}{times}", [f"({line}){times}" for line in lines]
    if {x.args for x in law.g.atoms(Norm)} <= {law.force_symbols()} and all(x.exp.is_Integer for x in law.g.atoms(sp.Pow)):
        return f"max({', '.join(parts)}, {over} - {m}*({total(f'pos({cone})' for cone in cones)}){times}) - {load}"
    least = f"{decimal(0.5 * high[inside].min(), 2)}*{power(norm, degree)}"
    slopes = [f"max({least}, {line} - {m}*({cone})){times}" for line, cone in zip(lines, cones, strict=True)]
    return f"max({', '.join(parts)}, min({over}, {', '.join(slopes)})) - {load}"


# -- a polygon ---------------------------------------------------------------------------------------------------------


def _polygon(law: Criterion, scale: LoadScale, points: Array, lines: Sequence[Array]) -> tuple[str, str]:
    """Lines all around K and those of its dents, each a little outside, and whether they are shown to enclose K."""
    from scipy.spatial import ConvexHull

    angles = np.linspace(0.0, 2.0 * np.pi, max(3, _MOST_SIDES - len(lines)), endpoint=False)
    shape = np.linalg.cholesky(np.linalg.inv(points.T @ points))  # of a long K the sides are evenly around as if it were round
    normals = np.column_stack([np.cos(angles), np.sin(angles)]) @ shape.T
    rows = np.vstack([normals / (normals @ points.T).max(axis=1)[:, None], *[line[None] for line in lines]]) * (1.0 - _OUTWARD)
    rows = rows[ConvexHull(rows).vertices]
    faces = [tuple(Fraction(decimal(x)) for x in row) for row in rows.tolist()]
    closed = _encloses(law, scale, faces)
    told = f"a polygon of {len(faces)} sides around K{', which is shown by enclosures' if closed else ''}"
    sides = [linear(row, law.forces) for row in rows]
    return f"max({', '.join(sides)}) - {scale.text}", told


def _encloses(law: Criterion, scale: LoadScale, faces: Sequence[tuple[Fraction, ...]]) -> bool:
    """Whether g > 0 on the whole boundary, so that what of K is joined to zero force lies in the polygon."""
    values, table = plain_values(law), law.symbols()
    fixed = {table[name]: value for name, value in values.items()} | ({table[law.pressure]: sp.S.NegativeOne} if law.pressure else {})
    if scale.size(values) != 1.0:
        return False
    level = balls.compiled(law.g.xreplace(fixed), law.force_symbols())
    corners = [_meeting(one, two) for one, two in pairwise([faces[-1], *faces, faces[0]])]

    def outside(p: tuple[Fraction, ...], q: tuple[Fraction, ...], halvings: int) -> bool:
        if balls.certain_sign(level(*(balls.ball(min(a, b), max(a, b)) for a, b in zip(p, q, strict=True)))) == 1:
            return True
        middle = tuple((a + b) / 2 for a, b in zip(p, q, strict=True))
        return halvings > 0 and outside(p, middle, halvings - 1) and outside(middle, q, halvings - 1)

    return all(outside(p, q, _HALVINGS) for p, q in pairwise(corners))


def _meeting(one: tuple[Fraction, ...], two: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
    across = one[0] * two[1] - one[1] * two[0]
    return (two[1] - one[1]) / across, (one[0] - two[0]) / across
