"""The convex hull of K in the plane of two forces: each dent is bridged by the line that touches K on both sides of it.

Let gamma be the gauge of K, L_i <= 1 the lines and s_i > 0 the cones of the dents.  Outside of these no L_i is greater than gamma, and so

    max(L_1, ..., L_n, gamma - m (pos(s_1) + ... + pos(s_n)))

is the gauge of the hull if m is great: inside of the cones it is lowered below the lines.  What g = A - S^k B says of gamma^k = A/B is said
of this without a quotient.  So it is of dents that are symmetric about short directions, where the line or its square has short fractions.
Other hulls are enclosed by a polygon.  All this is found in floating point: what is proved is proved of the text.

Of more than two forces the hull is known where it follows from that of a section by the plane of two.  If the square of the gauge is
gamma(x, y)^2 + (z/Z)^2 + ..., that of the hull is so too, with the gauge of the section's hull in place of gamma: the squares of the
support functions add up.  If g is gamma(s) + h(p), gamma a symmetric gauge of the deviator s and p the mean stress, all sections across
the hydrostatic axis are alike, and so are their hulls.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations, pairwise, permutations, product
from math import ceil, gcd
from typing import NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression import balls
from duhem.expression.numpy_ import evaluate
from duhem.expression.parse import parse_expression
from duhem.expression.text import formula
from duhem.law.formula_law import Criterion
from duhem.regions.mending.formulas import decimal, greatest, linear, times, total
from duhem.regions.mending.limit_load import ScaledLaw, around, limit_loads, scale_of

__all__ = ["by_hull", "by_sections", "polygon"]

Array = NDArray[np.float64]
_DEEP, _SEAM = 1e-7, 1e-6  # of the load, where a dent begins; of a cone, what is its border
_WINDOW = 0.02  # rad around the place where a line touches
_ALIKE, _MOST_DENOMINATOR = 1e-11, 10_000
_SHORT = [(np.array([a, b]) / np.hypot(a, b), (a, b)) for a, b in product(range(-3, 4), repeat=2) if gcd(a, b) == 1]
_MOST_SIDES, _OUTWARD = 128, (2e-3,)  # the latter where a corner of K lies between two directions
_HALVINGS, _NOTHING = 20, 1e-7  # the last of the greater component of a side


class Bridge(NamedTuple):
    """The ``line`` . force <= 1 touches K at two rays; of a symmetric dent its ``axis``, its distance and the cosine of half its width."""

    line: Array
    axis: tuple[int, int] | None = None
    reach: float = 0.0
    cosine: float = 0.0


def by_hull(scaled: ScaledLaw) -> Iterator[tuple[str, str]]:
    """g of the hull: exact ones first, last a polygon around K; and what each is."""
    dents, split = list(_dents(scaled)), _split(scaled)
    for squares in (False, True):
        forms = [form for dent in dents if (form := _form(dent, scaled.law.forces, squares))]
        if split is not None and 0 < len(forms) == len(dents):
            yield _text(scaled, *split, forms, squares), "the convex hull: lines bridge the dents"
    sides, told = polygon(scaled, [dent.line for dent in dents])
    yield f"{greatest(linear(side, scaled.law.forces) for side in sides)} - {scaled.text}", told


def _dents(scaled: ScaledLaw) -> Iterator[Bridge]:
    from scipy.spatial import ConvexHull

    points, step, steps = scaled.ways * scaled.loads[:, None], 2.0 * np.pi / len(scaled.ways), np.linspace(-1.0, 1.0, 41)
    corners = sorted(ConvexHull(points).vertices.tolist())
    for i, j in pairwise([*corners, corners[0] + len(points)]):
        across = points[j % len(points)] - points[i]
        line = np.array([across[1], -across[0]]) / (across[1] * points[i][0] - across[0] * points[i][1])
        if (1.0 - points[np.arange(i, j) % len(points)] @ line).max() < _DEEP:
            continue
        normal, (middle,) = line / np.linalg.norm(line), around(np.array([step * (i + j) / 2.0]))
        for unit, axis in _SHORT:
            if max(np.abs(normal - unit).max(), np.abs(middle - unit).max()) < 1e-5:
                near = around(step * j + _WINDOW * steps)
                reaches = limit_loads(scaled.law, scaled.values, near) / scaled.size * (near @ unit)
                reach = np.polynomial.Polynomial.fit(steps, reaches, 10)
                best = float(min((x.real for x in reach.deriv().roots() if abs(x.imag) < 1e-9), key=abs, default=0.0))
                yield Bridge(line, axis, float(reach(best)), float(np.cos(step * (j - i) / 2.0 + _WINDOW * best)))
                break
        else:
            yield Bridge(line)


def _split(scaled: ScaledLaw) -> tuple[sp.Expr, sp.Expr, int] | None:
    """A, B and k where g = A - S^k B, both > 0; None for another g."""
    law, powers, t = scaled.law, scaled.powers, sp.Symbol("t", positive=True)
    if not (moving := [n for n, power in powers.items() if power]):
        return None
    name = moving[-1]  # that stands for the scale
    sizes = {n: (t if n == name else sp.S.One) * (-1 if n == law.pressure else 1) for n in powers}
    swap = {**law.settled(), **{law.symbols()[n]: size for n, size in sizes.items()}}
    try:
        terms = sp.Poly(law.g.xreplace(swap).expand(), t).as_dict()
    except sp.PolynomialError:
        return None
    over, degree = terms.pop((0,), sp.S.Zero), sum(map(sum, terms)) / powers[name]
    under = -sum(terms.values())
    if len(terms) != 1 or not (degree.is_Integer and degree > 0):
        return None
    high, low = (evaluate(x, dict(zip(law.force_symbols(), scaled.ways.T, strict=True))) for x in (over, under))
    fits = (np.minimum(high, low) > 0).all() and np.allclose(high / low * scaled.loads ** float(degree), 1.0, rtol=1e-9)
    return (over, under, int(degree)) if fits else None


def _form(dent: Bridge, forces: Sequence[str], squares: bool) -> tuple[str, str] | None:
    """The line of a dent and what is > 0 in its cone, or their squares, by short fractions."""
    if dent.axis is None:
        return None
    size, n = float(np.hypot(*dent.axis)), 1 + squares
    exact = [(x * size) ** n for x in (dent.reach, dent.cosine)]
    limit, cosine = (Fraction(x).limit_denominator(_MOST_DENOMINATOR) for x in exact)
    if not np.allclose([float(limit), float(cosine)], exact, rtol=_ALIKE, atol=[0.0, _ALIKE]):
        return None
    load = total({1: "", -1: "-"}.get(c, f"{c}*") + f for c, f in zip(dent.axis, forces, strict=True) if c)
    load = f"pos({load})**2" if squares else f"({load})"
    return f"{1 / limit}*{load}", f"{load} - {cosine}*{times((_norm(forces), n))}"


def _norm(forces: Sequence[str]) -> str:
    return f"norm({', '.join(forces)})"


def _text(scaled: ScaledLaw, over: sp.Expr, under: sp.Expr, degree: int, forms: Sequence[tuple[str, str]], squares: bool) -> str:
    """The gauge of the hull, multiplied out, to the power of g, or twice that where squares of odd powers are asked for."""
    known = dict(zip(scaled.law.forces, scaled.law.force_symbols(), strict=True))
    places = dict(zip(known.values(), scaled.ways.T, strict=True))

    def at(text: str) -> Array:
        return np.asarray(np.broadcast_to(evaluate(parse_expression(text, known), places), len(scaled.ways)))

    twice = 2 if squares and degree % 2 else 1
    top, low, degree = formula(over**twice), formula(under**twice), degree * twice
    lines = [times((f"({x})", degree // 2)) if squares else x if degree == 1 else times((f"pos({x})", degree)) for x, _ in forms]
    cones = [times(f"({cone})", (_norm(scaled.law.forces), degree - 1 - squares)) for _, cone in forms]
    gauge, high, wide = at(top) / at(low), np.maximum([at(line) for line in lines], 0.0), np.array([at(cone) for cone in cones])
    with np.errstate(divide="ignore", invalid="ignore"):
        steep = ceil(1.5 * np.where(np.abs(wide) > _SEAM, (gauge - high) / np.abs(wide), 0.0).max()) + 1
    below = () if low == "1" else (f"({low})",)
    arms = [times(f"({line})", *below) for line in lines]
    lowered = times(str(steep), f"({total(f'pos({cone})' for cone in cones)})", *below)
    return f"max({', '.join(arms)}, {top} - {lowered}) - {times((f'({scaled.text})', degree), *below)}"


# -- a polygon ---------------------------------------------------------------------------------------------------------


def polygon(scaled: ScaledLaw, lines: Sequence[Array] = (), far: float = 5e-3) -> tuple[Array, str]:
    """Lines (m, 2) all around K and those of its dents, each a little outside, and whether they are shown to enclose K.

    No corner lies farther off the hull than ``far`` of the mean load, as far as so many sides are enough.
    """
    from scipy.spatial import ConvexHull

    hull = ConvexHull(scaled.ways * scaled.loads[:, None])
    outer, faces = hull.points[hull.vertices], hull.equations[:, :2] / -hull.equations[:, 2:]
    angles = np.unique([*(0.5 * np.pi * np.arange(4)), *(np.arctan2(y, x) % (2.0 * np.pi) for x, y in lines)])
    while True:
        normals = around(angles)
        reach = (normals @ outer.T).max(axis=1)
        rows, after = normals / reach[:, None], np.append(angles[1:], angles[0] + 2.0 * np.pi)
        corners = np.linalg.solve(np.stack([rows, np.roll(rows, -1, axis=0)], axis=1), np.ones((len(rows), 2, 1)))[..., 0]
        beyond = np.linalg.norm(corners, axis=1) * (1.0 - 1.0 / (corners @ faces.T).max(axis=1))
        farthest = beyond.argmax()  # of the corners off the hull: one side more, below it
        if beyond[farthest] < far * scaled.loads.mean() or len(angles) >= _MOST_SIDES:
            break
        angles = np.unique([*angles, (angles[farthest] + after[farthest]) / 2.0])
    rows = normals / reach[:, None]
    rows = rows[ConvexHull(rows).vertices]
    rows = np.where(np.abs(rows) > _NOTHING * np.abs(rows).max(axis=1, keepdims=True), rows, 0.0)
    for outward in (far / 10.0, *_OUTWARD):
        sides = (1.0 - outward) * rows
        if closed := _encloses(scaled, [(Fraction(decimal(x)), Fraction(decimal(y))) for x, y in sides.tolist()]):
            break
    told = " around K, as enclosures of g on it show" if closed else ", which may cut off some of K"
    return sides, f"a polygon of {len(rows)} sides{told}"


def _encloses(scaled: ScaledLaw, faces: Sequence[tuple[Fraction, Fraction]]) -> bool:
    """Whether g > 0 on the whole boundary at ``scaled.values``, so that what of K is joined to zero force lies in the polygon."""
    law, table = scaled.law, scaled.law.symbols()
    fixed = dict(scaled.values) | ({law.pressure: sp.S.NegativeOne} if law.pressure else {})
    level = balls.compiled(law.g.xreplace({table[name]: x for name, x in fixed.items()}), law.force_symbols())
    neighbours = pairwise([faces[-1], *faces, faces[0]])
    corners = [((d - b) / (a * d - b * c), (a - c) / (a * d - b * c)) for (a, b), (c, d) in neighbours]

    def outside(p: tuple[Fraction, ...], q: tuple[Fraction, ...], halvings: int) -> bool:
        if balls.certain_sign(level(*(balls.ball(min(a, b), max(a, b)) for a, b in zip(p, q, strict=True)))) == 1:
            return True
        middle = tuple((a + b) / 2 for a, b in zip(p, q, strict=True))
        return halvings > 0 and outside(p, middle, halvings - 1) and outside(middle, q, halvings - 1)

    return scaled.size == 1.0 and all(outside(p, q, _HALVINGS) for p, q in pairwise(corners))


# -- of more than two forces, by a section ----------------------------------------------------------------------------

_EQUAL, _FAR = 1e-9, 5e-3


def by_sections(scaled: ScaledLaw) -> tuple[str, str]:
    """g of a law whose K contains the hull closely, and what it is; InputError where the hull does not follow from a section."""
    if (found := _of_a_deviator(scaled) or _of_squares(scaled)) is None:
        what = "of more than two forces, the hull is known of sums of squares and of cones about the hydrostatic axis"
        raise InputError(what, where=scaled.law.name, remedy="mend it by parameters or coefficients")
    return found


def _of_squares(scaled: ScaledLaw) -> tuple[str, str] | None:
    law, ways, n = scaled.law, scaled.ways, len(scaled.law.forces)
    ends = limit_loads(law, scaled.values, np.eye(n)) / scaled.size
    for pair in combinations(range(n), 2):
        rest = [k for k in range(n) if k not in pair]
        flat = np.where(np.isin(np.arange(n), pair), ways, 0.0)
        lengths = np.linalg.norm(flat, axis=1)
        loads = limit_loads(law, scaled.values, flat / lengths[:, None]) / scaled.size
        squares = (lengths / loads) ** 2 + np.sum((ways[:, rest] / ends[rest]) ** 2, axis=1)
        if np.allclose(squares * scaled.loads**2, 1.0, rtol=_EQUAL):
            forces, symbols = tuple(law.forces[k] for k in pair), law.force_symbols()
            free = {name: own for name, own in law.parameters.items() if own.value is None}
            round_ = {symbols[k]: sp.Rational(decimal(ends[k])) * symbols[k] for k in pair}  # that long sets are seen as well as others
            g = law.g.xreplace({**law.settled(), **round_, **{symbols[k]: sp.S.Zero for k in rest}})
            section = scale_of(Criterion(law.name, formula(g), free, forces, law.pressure))
            sides, told = polygon(section, far=_FAR * float(scaled.loads.mean() / scaled.loads.max()))
            others = (f"({law.forces[k]}/{decimal(ends[k])})**2" for k in rest)
            face = f"pos({greatest(linear(side / ends[list(pair)], forces) for side in sides)})**2"
            return f"{total([face, *others])} - ({scaled.text})**2", f"{told}, in the plane of {' and '.join(forces)}"
    return None


def _of_a_deviator(scaled: ScaledLaw) -> tuple[str, str] | None:
    law, symbols = scaled.law, scaled.law.force_symbols()
    if law.stress is None or law.stress.kind != "principal" or scaled.powers:
        return None
    g, mean = law.g.xreplace(law.settled()), sp.Symbol("mean", real=True)
    x, y, z = symbols
    gauge = g.xreplace({z: -x - y}) - g.xreplace(dict.fromkeys(symbols, sp.S.Zero))
    axis = g.xreplace(dict.fromkeys(symbols, mean))
    points = scaled.ways * np.abs(evaluate(g, dict.fromkeys(symbols, 0.0)))

    def level(points: Array) -> Array:
        return evaluate(gauge, dict(zip((x, y), (points - points.mean(axis=1, keepdims=True)).T, strict=False)))

    own, whole = level(points), evaluate(g, dict(zip(symbols, points.T, strict=True)))
    alike = [level(2.0 * points) / 2.0, whole - evaluate(axis, {mean: points.mean(axis=1)})]
    if not all(np.allclose(own, other, atol=_EQUAL) for other in (*alike, *(level(points[:, list(p)]) for p in permutations(range(3))))):
        return None
    sides, told = polygon(scale_of(Criterion(law.name, f"{formula(gauge)} - 1", {}, law.forces[:2], None)))
    weights = np.column_stack([sides, np.zeros(len(sides))])
    weights = -np.sort(weights.mean(axis=1, keepdims=True) - weights, axis=1)  # of stresses in order: the greatest of all permutations
    stresses = [f"principal({law.stress.name}, {k})" for k in (1, 2, 3)]
    rest = formula(axis.xreplace({mean: sp.Add(*symbols) / 3}))
    return f"{greatest(linear(row, stresses) for row in weights)} + {rest}", f"{told}, across the hydrostatic axis"
