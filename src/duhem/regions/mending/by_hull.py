"""The convex hull of K in the plane of two forces: each dent is bridged by the line that touches K on both sides of it.

Let gamma be the gauge of K, L_i <= 1 the lines and s_i > 0 the cones of the dents.  Outside of these no L_i is greater than gamma, and so

    max(L_1, ..., L_n, min(gamma, T_1, ..., T_n)),   T_i = max(d, L_i - m s_i) with a great m and a small d > 0,

is the gauge of the hull: inside cone i T_i is no greater than L_i, elsewhere no less than gamma.  Where g has no roots but the norm,
gamma - m (pos(s_1) + ... + pos(s_n)) takes the place of the minimum, and is sooner proved.  What g = A - S^k B says of gamma^k = A/B
is said of these without a quotient.  So it is of dents that are symmetric about short directions, where the line or its square has
short fractions.  Other hulls are enclosed by a polygon.  All this is found in floating point: what is proved is proved of the text.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import pairwise, product
from math import ceil, gcd
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression import Norm, balls
from duhem.expression.numpy_ import evaluate
from duhem.expression.parse import parse_expression
from duhem.expression.text import formula
from duhem.law.formula_law import Criterion
from duhem.regions.mending.formulas import decimal, linear, power, total
from duhem.regions.mending.limit_load import LoadScale, limit_loads, plain_values, ways_of

__all__ = ["by_hull"]

Array = NDArray[np.float64]
_DEEP, _SEAM = 1e-7, 1e-6  # of the load, where a dent begins; of a cone, what is its border
_WINDOW = 0.02  # rad around the place where a line touches
_ALIKE, _MOST_DENOMINATOR = 1e-11, 10_000
_SHORT = [(np.array([a, b]) / np.hypot(a, b), (a, b)) for a, b in product(range(-3, 4), repeat=2) if gcd(a, b) == 1]
_MOST_SIDES, _OUTWARD = 32, 5e-4
_HALVINGS = 20


class Bridge(NamedTuple):
    """The ``line`` . force <= 1 touches K at two rays; of a symmetric dent its ``axis``, its distance and the cosine of half its width."""

    line: Array
    axis: tuple[int, int] | None = None
    reach: float = 0.0
    cosine: float = 0.0


def by_hull(law: Criterion, scale: LoadScale) -> Iterator[tuple[str, str]]:
    """g of the hull: exact ones first, last a polygon around K; and what each is."""
    ways, values = ways_of(law), plain_values(law)

    def boundary(angles: Array) -> Array:
        around = np.column_stack([np.cos(angles), np.sin(angles)])
        return around * (limit_loads(law, values, around) / scale.size(values))[:, None]

    points = ways * (limit_loads(law, values, ways) / scale.size(values))[:, None]
    dents = list(_dents(points, boundary))
    split = _split(law, scale, ways, np.linalg.norm(points, axis=1))
    for squares in (False, True):
        forms = [_form(dent, law.forces, squares) for dent in dents]
        if split is not None and forms and None not in forms:
            yield _text(law, scale, split, [form for form in forms if form], ways, squares), "the convex hull: lines bridge the dents"
    yield _polygon(law, scale, points, [dent.line for dent in dents])


def _dents(points: Array, boundary: Callable[[Array], Array]) -> Iterator[Bridge]:
    from scipy.spatial import ConvexHull

    corners = sorted(ConvexHull(points).vertices.tolist())
    for i, j in pairwise([*corners, corners[0] + len(points)]):
        across = points[j % len(points)] - points[i]
        line = np.array([across[1], -across[0]]) / (across[1] * points[i][0] - across[0] * points[i][1])
        if (1.0 - points[np.arange(i, j) % len(points)] @ line).max() < _DEEP:
            continue
        step, steps = 2.0 * np.pi / len(points), np.linspace(-1.0, 1.0, 41)
        for unit, axis in _SHORT:
            middle = np.array([np.cos(step * (i + j) / 2.0), np.sin(step * (i + j) / 2.0)])
            if max(np.abs(line / np.linalg.norm(line) - unit).max(), np.abs(middle - unit).max()) < 1e-5:
                reach = np.polynomial.Polynomial.fit(steps, boundary(step * j + _WINDOW * steps) @ unit, 10)
                best = float(min((x.real for x in reach.deriv().roots() if abs(x.imag) < 1e-9), key=abs, default=0.0))
                yield Bridge(line, axis, float(reach(best)), float(np.cos(step * (j - i) / 2.0 + _WINDOW * best)))
                break
        else:
            yield Bridge(line)


def _split(law: Criterion, scale: LoadScale, ways: Array, loads: Array) -> tuple[sp.Expr, sp.Expr, int] | None:
    """A, B and k where g = A - S^k B, both > 0; None for another g."""
    t, table = sp.Symbol("t", positive=True), law.symbols()
    name = next((n for n in reversed(list(scale.powers)) if scale.powers[n]), None)  # that stands for the scale
    if name is None:
        return None
    swap = {**law.settled(), **{table[n]: sp.S.NegativeOne if n == law.pressure else sp.S.One for n in scale.powers}}
    swap |= {table[name]: -t if name == law.pressure else t}
    try:
        terms = sp.Poly(law.g.xreplace(swap).expand(), t).as_dict()
    except sp.PolynomialError:
        return None
    over, degree = terms.pop((0,), sp.S.Zero), sum(map(sum, terms)) / scale.powers[name]
    under = -sum(terms.values())
    if len(terms) != 1 or not (degree.is_Integer and degree > 0):
        return None
    high, low = (evaluate(x, dict(zip(law.force_symbols(), ways.T, strict=True))) for x in (over, under))
    fits = (np.minimum(high, low) > 0).all() and np.allclose(high / low * loads ** float(degree), 1.0, rtol=1e-9)
    return (over, under, int(degree)) if fits else None


def _form(dent: Bridge, forces: Sequence[str], squares: bool) -> tuple[str, str] | None:
    """The line of a dent and what is > 0 in its cone, or their squares, by short fractions."""
    if dent.axis is None:
        return None
    size, n = float(np.hypot(*dent.axis)), 1 + squares
    limit, cosine = (Fraction((x * size) ** n).limit_denominator(_MOST_DENOMINATOR) for x in (dent.reach, dent.cosine))
    if any(abs(float(near) - (x * size) ** n) > _ALIKE for near, x in ((limit, dent.reach), (cosine, dent.cosine))):
        return None
    load = total({1: "", -1: "-"}.get(c, f"{c}*") + f for c, f in zip(dent.axis, forces, strict=True) if c)
    load = power(f"pos({load})", 2) if squares else f"({load})"
    norm = f"norm({', '.join(forces)})"
    return f"{1 / limit}*{load}", f"{load} - {cosine}*{power(norm, n)}"


def _text(law: Criterion, scale: LoadScale, split: Any, forms: Sequence[tuple[str, str]], ways: Array, squares: bool) -> str:
    """The gauge of the hull, multiplied out, to the power of g, or twice that where squares of odd powers are asked for."""
    known = dict(zip(law.forces, law.force_symbols(), strict=True))
    places = dict(zip(known.values(), ways.T, strict=True))

    def at(text: str) -> Array:
        return np.asarray(np.broadcast_to(evaluate(parse_expression(text, known), places), len(ways)))

    twice = 2 if squares and split[2] % 2 else 1
    over, under, degree = formula(split[0] ** twice), formula(split[1] ** twice), split[2] * twice
    norm, rest = f"norm({', '.join(law.forces)})", degree - 1 - squares
    lines = [power(f"({x})", degree // 2) if squares else x if degree == 1 else power(f"pos({x})", degree) for x, _ in forms]
    cones = [f"({cone})*{power(norm, rest)}" if rest else cone for _, cone in forms]
    gauge, high, wide = at(over) / at(under), np.maximum([at(line) for line in lines], 0.0), np.array([at(cone) for cone in cones])
    with np.errstate(divide="ignore", invalid="ignore"):
        steep = ceil(1.5 * np.where(np.abs(wide) > _SEAM, (gauge - high) / np.abs(wide), 0.0).max()) + 1
    times = "" if under == "1" else f"*({under})"
    load, parts = f"{power(f'({scale.text})', degree)}{times}", [f"({line}){times}" for line in lines]
    if {x.args for x in law.g.atoms(Norm)} <= {law.force_symbols()} and all(x.exp.is_Integer for x in law.g.atoms(sp.Pow)):
        return f"max({', '.join(parts)}, {over} - {steep}*({total(f'pos({cone})' for cone in cones)}){times}) - {load}"
    least = f"{decimal(0.5 * high[wide > _SEAM].min(), 2)}*{power(norm, degree)}"
    slopes = [f"max({least}, {line} - {steep}*({cone})){times}" for line, cone in zip(lines, cones, strict=True)]
    return f"max({', '.join(parts)}, min({over}, {', '.join(slopes)})) - {load}"


# -- a polygon ---------------------------------------------------------------------------------------------------------


def _polygon(law: Criterion, scale: LoadScale, points: Array, lines: Sequence[Array]) -> tuple[str, str]:
    """Lines all around K and those of its dents, each a little outside, and whether they are shown to enclose K."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points)
    outer, faces = points[hull.vertices], hull.equations[:, :2] / -hull.equations[:, 2:]
    angles = np.unique([*(0.5 * np.pi * np.arange(4)), *(np.arctan2(y, x) % (2.0 * np.pi) for x, y in lines)])
    while True:
        normals = np.column_stack([np.cos(angles), np.sin(angles)])
        reach = (normals @ outer.T).max(axis=1)
        if len(angles) >= _MOST_SIDES:
            break
        halves = np.diff(angles, append=angles[0] + 2.0 * np.pi) / 2.0  # one side more, below the corner that lies farthest off the hull
        middles, after = angles + halves, np.roll(reach, -1)
        along, aside = (reach + after) / (2.0 * np.cos(halves)), (after - reach) / (2.0 * np.sin(halves))
        corners = along * np.array([np.cos(middles), np.sin(middles)]) + aside * np.array([-np.sin(middles), np.cos(middles)])
        beyond = np.hypot(*corners) * (1.0 - 1.0 / (faces @ corners).max(axis=0))
        angles = np.unique([*angles, middles[beyond.argmax()]])
    rows = (1.0 - _OUTWARD) * normals / reach[:, None]
    rows = rows[ConvexHull(rows).vertices]
    closed = _encloses(law, scale, [(Fraction(decimal(x)), Fraction(decimal(y))) for x, y in rows.tolist()])
    told = f"a polygon of {len(rows)} sides around K{', as enclosures of g on it show' if closed else ''}"
    return f"max({', '.join(linear(row, law.forces) for row in rows)}) - {scale.text}", told


def _encloses(law: Criterion, scale: LoadScale, faces: Sequence[tuple[Fraction, Fraction]]) -> bool:
    """Whether g > 0 on the whole boundary, so that what of K is joined to zero force lies in the polygon."""
    values, table = plain_values(law), law.symbols()
    fixed = {table[name]: value for name, value in values.items()} | ({table[law.pressure]: sp.S.NegativeOne} if law.pressure else {})
    level = balls.compiled(law.g.xreplace(fixed), law.force_symbols())
    corners = list[tuple[Fraction, ...]]()
    for (a, b), (c, d) in pairwise([faces[-1], *faces, faces[0]]):
        corners.append(((d - b) / (a * d - b * c), (a - c) / (a * d - b * c)))

    def outside(p: tuple[Fraction, ...], q: tuple[Fraction, ...], halvings: int) -> bool:
        if balls.certain_sign(level(*(balls.ball(min(a, b), max(a, b)) for a, b in zip(p, q, strict=True)))) == 1:
            return True
        middle = tuple((a + b) / 2 for a, b in zip(p, q, strict=True))
        return halvings > 0 and outside(p, middle, halvings - 1) and outside(middle, q, halvings - 1)

    return scale.size(values) == 1.0 and all(outside(p, q, _HALVINGS) for p, q in pairwise(corners))
