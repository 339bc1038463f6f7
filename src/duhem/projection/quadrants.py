"""Closest points on the four-quadrant ellipse: four quarter ellipses, each with two of the four coefficients.

:class:`Quarters` has the constants of the quarters, computed exactly from coefficients and stiffness.  :func:`project` fills in stress,
slip and multiplier for a block of trial stresses: it finds which points slip and which quarter holds each result.  :func:`plain_closest`
does so for one point on plain numbers.  The formulas of one quarter stand in :mod:`duhem.projection.quarter_ellipse`.  :func:`clamped` is
for one force, or for one axis where a coefficient is zero.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import lru_cache
from struct import Struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.projection.in_blocks import FEW
from duhem.projection.plain_numbers import FAULTS
from duhem.projection.quarter_ellipse import CLOSE, NEAR, SAFE, SEAM, SURE, closest, formulas
from duhem.projection.result import Array

__all__ = ["Quarters", "clamped", "plain_clamped", "plain_closest", "project", "stacked"]

_DOUBLE, _WORD = Struct("<d"), Struct("<q")
_FORMULAS = formulas()
_CLOSEST = closest(
    lambda function: function,
    formulas(
        where=lambda condition, a, b: a if condition else b,
        sqrt=math.sqrt,
        bits=(lambda x: _WORD.unpack(_DOUBLE.pack(x))[0], lambda bits: _DOUBLE.unpack(_WORD.pack(bits))[0]),
    ),
)
_DIGITS = 120
_MANY = 1_024  # points of which quarters are worth a loop over them


@dataclass(frozen=True, eq=False)
class Quarters:
    """Constants of the quarters, indexed by 2 (sigma_b < 0) + (sigma_a < 0): computed exactly, rounded once.

    ``mu`` (4, 2): coefficients; ``axes`` (4, 2, 2): rows v_1, v_2 of the principal axes of D k^-1 D, D = diag(mu), with
    ``axes_low`` what rounding took off; ``ratio`` r = c_2/c_1, and 1/c_1 = ``compliance`` 2^``power``.
    ``flat``: a coefficient is zero there.  ``first``: the place of v_1 if the axes are those of the law, else -1.
    """

    mu: Array
    axes: Array
    axes_low: Array
    ratio: Array
    compliance: Array
    power: NDArray[np.intc]
    flat: NDArray[np.bool_]
    first: NDArray[np.intp]
    stiffness: Array

    @classmethod
    def of(cls, coefficients: Sequence[float], stiffness: Array) -> Quarters:
        """From (a_plus, a_minus, b_plus, b_minus) >= 0 and the (2, 2) stiffness in Pa/m."""
        a, b = coefficients[:2], coefficients[2:]
        mu = np.array([(a[i & 1], b[i >> 1]) for i in range(4)])
        k = (float(stiffness[0, 0]), float(stiffness[0, 1]), float(stiffness[1, 1]))
        rows = [_quarter((m1, m2), k) for m1, m2 in mu.tolist()]
        axes, low, ratio, compliance, power, first = (np.array([row[i] for row in rows]) for i in range(6))
        return cls(mu, axes, low, ratio, compliance, power.astype(np.intc), (mu == 0.0).any(axis=1), first, np.asarray(stiffness))

    @property
    def diagonal(self) -> bool:
        """Whether the result stays in the quadrant of its trial."""
        return bool((self.first >= 0).all())

    @property
    def round(self) -> bool:
        """Whether the closest point lies on the ray of the trial."""
        return bool((self.ratio == 1.0).all())


@lru_cache(maxsize=1024)
def _quarter(mu: tuple[float, float], stiffness: tuple[float, float, float]) -> tuple[object, ...]:
    """Axes, their low parts, r, 1/c_1 as fraction and exponent, and the place of axis 1, for one quarter."""
    k11, k12, k22 = map(Fraction, stiffness)
    m1, m2 = map(Fraction, mu)
    det = k11 * k22 - k12 * k12
    if k12 == 0:
        a, b = m1 * m1 / k11, m2 * m2 / k22  # 1/c_1 is the smaller of the two
        first = 0 if a <= b else 1
        small, large = min(a, b), max(a, b)
        ratio = small / large if large else Fraction(1)
        return np.eye(2)[[first, 1 - first]], np.zeros((2, 2)), float(ratio), *_parts(small), first
    from mpmath import MPContext

    context = MPContext()
    context.dps = _DIGITS

    def number(x: Fraction) -> object:
        return context.mpf(x.numerator) / x.denominator

    p, q, s = number(m1 * m1 * k22 / det), number(-m1 * m2 * k12 / det), number(m2 * m2 * k11 / det)
    half = (p - s) / 2  # type: ignore[operator]
    large = (p + s) / 2 + context.hypot(half, q)  # type: ignore[operator]
    small = (p * s - q * q) / large  # type: ignore[operator]
    angle = context.atan2(2 * q, p - s) / 2  # type: ignore[operator]
    cos, sin = context.cos(angle), context.sin(angle)
    exact = [[-sin, cos], [cos, sin]]  # v_2 belongs to the larger eigenvalue of D k^-1 D
    high = np.array([[float(x) for x in row] for row in exact])
    low = np.array([[float(x - y) for x, y in zip(row, rounded, strict=True)] for row, rounded in zip(exact, high.tolist(), strict=True)])
    return high, low, float(small / large), float(context.frexp(small)[0]), int(context.frexp(small)[1]), -1


def _parts(x: Fraction) -> tuple[float, int]:
    """Fraction and exponent of a number that may lie beyond the range of a float."""
    power = x.numerator.bit_length() - x.denominator.bit_length()
    return float(x / Fraction(2) ** power), power


def stacked(each: Sequence[Quarters]) -> Quarters:
    """Several quarters under each other, for points that have different ones: see ``own`` of :func:`project`."""
    first, *others = each
    if not others:
        return first
    rows = {field.name: np.concatenate([getattr(q, field.name) for q in each]) for field in fields(Quarters) if field.name != "stiffness"}
    return Quarters(**rows, stiffness=first.stiffness)


def project(
    trial: Array, load: Array, quarters: Quarters, stress: Array, slip: Array, multiplier: Array, own: NDArray[np.intp] | None = None
) -> None:
    """Fill ``stress`` (n, 2), ``slip`` (n, 2), row by row in memory, and ``multiplier`` (n,) of the gauge for one block of trial stresses.

    ``load`` (n,) >= 0, in the unit of the stresses.  Points inside keep their trial stress, slip and multiplier zero.
    ``own`` (n,) says which of several :func:`stacked` quarters is that of each point.
    The multiplier is nan where a number of the slip or the stress has left the range of a float.
    """
    with np.errstate(all="ignore"):
        if own is None and len(load) <= FEW and not quarters.flat.any():
            _one_by_one(trial, load, quarters, stress, slip, multiplier)
        else:
            _project(trial, load, quarters, stress, slip, multiplier, own)


def _one_by_one(trial: Array, load: Array, quarters: Quarters, stress: Array, slip: Array, multiplier: Array) -> None:
    """What arrays find, to the bit, on plain numbers; arrays take the point of which an operation has no value."""
    for n, (given, e) in enumerate(zip(trial.tolist(), load.tolist(), strict=True)):
        if (found := plain_closest(quarters, given, e)) is None:
            here = slice(n, n + 1)
            _project(trial[here], load[here], quarters, stress[here], slip[here], multiplier[here], None)
        else:
            stress[n], slip[n], multiplier[n] = found


def plain_closest(quarters: Quarters, trial: Sequence[float], load: float) -> tuple[list[float], list[float], float] | None:
    """Stress, slip and multiplier of the gauge for one trial on plain numbers; None where an operation has no value."""
    s, moved, weight = dict[tuple[int, int], float](), dict[tuple[int, int], float](), dict[int, float]()
    try:
        _CLOSEST(0, {(0, 0): trial[0], (0, 1): trial[1]}, {0: load}, *_tables(quarters), s, moved, weight)
    except FAULTS:
        return None
    return [s[0, 0], s[0, 1]], [moved[0, 0], moved[0, 1]], weight[0]


_Table = dict[Any, Any]  # numbers by their places: the functions of one point ask for array[i, j]


@lru_cache(maxsize=256)
def _tables(quarters: Quarters) -> tuple[_Table, ...]:
    """mu, axes, low, ratio, compliance, power and first."""
    q = quarters
    rows: list[_Table] = [{}, {}]
    for found, axes in zip(rows, (q.axes, q.axes_low), strict=True):
        for place in np.ndindex(4, 2):
            found[place] = axes[place].tolist()
            found.update({(*place, i): x for i, x in enumerate(found[place])})
    return _table(q.mu), *rows, *(_table(x) for x in (q.ratio, q.compliance, q.power, q.first))


def _table(array: NDArray[Any]) -> _Table:
    return {place if array.ndim > 1 else place[0]: array[place].item() for place in np.ndindex(*array.shape)}


@dataclass(frozen=True, eq=False)
class _Block:
    """Trial stresses (n, 2) and loads (n,) as given, then over 2^``scale``, None where no point needs it."""

    trial: Array
    load: Array
    scaled: Array
    e: Array
    scale: NDArray[np.intc] | None


def _exponents(trial: Array, load: Array) -> NDArray[np.intc] | None:
    """Binary exponents by which to scale each point, or None where no point of the block needs it."""
    if trial.size and (trial.max() > SAFE or trial.min() < -SAFE or load.max() > SAFE or load.min() < 1.0 / SAFE):
        return np.asarray(np.frexp(np.maximum(np.abs(trial).max(axis=1), load))[1])
    return None


def _project(
    trial: Array, load: Array, quarters: Quarters, stress: Array, slip: Array, multiplier: Array, own: NDArray[np.intp] | None
) -> None:
    stress[:], slip[:], multiplier[:] = trial, 0.0, 0.0
    scale = _exponents(trial, load)
    scaled, e = (trial, load) if scale is None else (np.ldexp(trial, -scale[:, None]), np.ldexp(load, -scale))
    block = _Block(trial, load, scaled, e, scale)
    negative = np.less(scaled.T, 0.0, out=np.empty((2, len(load)), dtype=np.bool_))
    inner = e * (1.0 - 1e-13)  # within that, rounding does not decide
    if own is None and quarters.diagonal and not quarters.flat.any() and len(load) >= _MANY:
        far = ~(_gauge(scaled, quarters) <= inner * inner)
        for quadrant in range(4):  # one by one: their constants are numbers, not one a point
            here = far & (negative[0] == bool(quadrant & 1))
            here &= negative[1] == bool(quadrant & 2)
            if (at := np.flatnonzero(here)).size:
                _slipped(at, quadrant, block, quarters, stress, slip, multiplier)
        return
    quadrant = negative[0] + 2 * negative[1]
    if own is not None:
        quadrant += 4 * own
    p = scaled * (1.0 / quarters.mu).take(quadrant, axis=0)
    p *= p
    outside = np.flatnonzero(~(p[:, 0] + p[:, 1] <= inner * inner))
    if quarters.flat.any():
        flat = quarters.flat.take(quadrant.take(outside))
        _flat(outside[flat], trial, load, quarters, quadrant, stress, slip, multiplier)
        outside = outside[~flat]
    if outside.size:
        _slipped(outside, quadrant.take(outside), block, quarters, stress, slip, multiplier)


def _gauge(t: Array, quarters: Quarters) -> Array:
    """(sigma_a/mu_a)^2 + (sigma_b/mu_b)^2, to rounding, where no coefficient is zero."""
    squares = []
    for i in (0, 1):
        plus, minus = quarters.mu[0, i], quarters.mu[1 + i, i]
        larger = t[:, i] * (1.0 / plus)
        np.maximum(larger, t[:, i] * (-1.0 / minus), out=larger)
        squares.append(np.multiply(larger, larger, out=larger))
    return np.add(squares[0], squares[1], out=squares[0])


def _slipped(
    outside: NDArray[np.intp], quadrant: Any, of: _Block, quarters: Quarters, stress: Array, slip: Array, multiplier: Array
) -> None:
    """Fill in what slips of the points ``outside``; the ``quadrant`` is one a point, or one of all."""
    solve = _straight if quarters.diagonal else _oblique
    kept, w, z, used = solve(of.scaled.take(outside, axis=0), of.e.take(outside), quadrant, quarters)
    at, scale = outside if kept is None else outside.take(kept), of.scale
    plain = scale is None and np.abs(quarters.power).max() < 900
    z = z * (np.ldexp(quarters.compliance, quarters.power) if plain else quarters.compliance).take(used)
    power = None if plain else quarters.power.take(used) + (0 if scale is None else scale.take(at))
    lengths = z if power is None else np.ldexp(z, power)
    load, sound = of.load.take(at), np.isfinite(lengths)
    stresses, slips = np.empty((at.size, 2)), np.empty((at.size, 2))
    for i in (0, 1):
        mu = quarters.mu[:, i].take(used)
        slipped = w[i] / mu
        slipped *= z
        slipped = slipped if power is None else np.ldexp(slipped, power)
        np.multiply(mu * load, w[i], out=stresses[:, i])  # within the trial's size
        slips[:, i] = slipped
        sound &= np.isfinite(slipped)
    _pairs(stress)[at], _pairs(slip)[at] = _pairs(stresses), _pairs(slips)
    multiplier[at] = lengths if sound.all() else np.where(sound, lengths, np.nan)


def _pairs(vectors: Array) -> NDArray[np.complex128]:
    """Rows (n, 2), whole, as one number each: they are put in their places by one pass."""
    return vectors.view(np.complex128)[:, 0]


def _ratios(t: Array, quadrant: Any, e: Array, quarters: Quarters) -> tuple[Array, Array, Array, Array, Array]:
    """p_1, p_2 as double words in the law's axes, and F."""
    t1, t2 = np.abs(t[:, 0]), np.abs(t[:, 1])
    mu1, mu2 = quarters.mu[:, 0].take(quadrant), quarters.mu[:, 1].take(quadrant)
    p1, l1 = _FORMULAS.quotient(t1, mu1)
    p2, l2 = _FORMULAS.quotient(t2, mu2)
    f = _FORMULAS.excess(p1, l1, p2, l2, e)
    if (close := np.flatnonzero(np.abs(f) <= CLOSE * e * e)).size:
        f[close] = _FORMULAS.close_excess(*(_some(x, close) for x in (t1, mu1, t2, mu2, e)))
    return p1, l1, p2, l2, f


def _some(of: Any, at: NDArray[np.intp]) -> Any:
    """What points ``at`` have of it, where it is not one of all."""
    return of.take(at) if np.ndim(of) else of


def _either(condition: Any, yes: Array, no: Array) -> Array:
    """``np.where``, without a pass where it is one of all."""
    return np.where(condition, yes, no) if np.ndim(condition) else yes if condition else no


Found = tuple[NDArray[np.intp] | None, tuple[Array, Array], Array, Any]


def _straight(t: Array, e: Array, quadrant: Any, quarters: Quarters) -> Found:
    """Slipping points, None for all, signed directions in the law's axes, z and quadrants, where these axes are principal."""
    ratio = quarters.ratio.take(quadrant)
    swapped = quarters.first.take(quadrant) == 1
    t1, t2 = np.abs(t.T, out=np.empty(t.shape[::-1]))
    mu1, mu2 = (quarters.mu[:, i].take(quadrant) for i in (0, 1))
    p1, l1, p2, l2, f = _FORMULAS.on_grid(t1, mu1, t2, mu2, e)
    cusp = np.abs(_either(swapped, p1, p2) - (1.0 - ratio) * e)
    if (close := np.flatnonzero((np.abs(f) <= NEAR * e * e) | (cusp <= NEAR * e))).size:
        few = t.take(close, axis=0), _some(quadrant, close), e.take(close)
        p1[close], l1[close], p2[close], l2[close], f[close] = _ratios(*few, quarters)
    slips = f > 0.0
    kept = None if slips.all() else np.flatnonzero(slips)
    if kept is not None:
        p1, p2, l1, l2, f, e, quadrant, ratio, swapped = (_some(x, kept) for x in (p1, p2, l1, l2, f, e, quadrant, ratio, swapped))
        t = t.take(kept, axis=0)
    if quarters.round:
        length = np.hypot(p1, p2)
        w1, w2 = p1 / length, p2 / length
    else:
        first, second = _either(swapped, p2, p1), _either(swapped, p1, p2)
        v1, v2 = _FORMULAS.direction(first, second, _either(swapped, l1, l2), e, ratio)
        w1, w2 = _either(swapped, v2, v1), _either(swapped, v1, v2)
    z = _FORMULAS.multiplier(f, _either(swapped, w2, w1), _either(swapped, w1, w2), e, ratio)
    return kept, (np.copysign(w1, t[:, 0]), np.copysign(w2, t[:, 1])), z, quadrant


def _oblique(t: Array, e: Array, quadrant: NDArray[np.intp], quarters: Quarters) -> Found:
    """The same where the stiffness couples the axes: quadrants are tried from the trial's on until one holds its result.

    So close to a seam that rounding decides, the quadrant that holds it best is taken.
    """
    kept = np.flatnonzero(_ratios(t, quadrant, e, quarters)[-1] > 0.0)
    n = kept.size
    w1, w2, z = np.zeros(n), np.zeros(n), np.zeros(n)
    used, miss = np.zeros(n, dtype=np.intp), np.full(n, np.inf)
    for flip in range(4):
        open_ = np.flatnonzero(miss > -SURE)
        if not open_.size:
            break
        at = kept.take(open_)
        tried = quadrant.take(at) ^ flip
        a, b, c = _in_quarter(t.take(at, axis=0), e.take(at), tried, quarters)
        beyond = [np.where(tried >> i & 1, x, -x) for i, x in enumerate((a, b))]
        for i in (0, 1):  # an axis with one coefficient for both senses is no seam
            beyond[i][quarters.mu[:, i].take(tried) == quarters.mu[:, i].take(tried ^ (1 << i))] = -np.inf
        missed = np.where(np.isfinite(c) & (c > 0.0), np.maximum(*beyond), np.inf)
        better = missed < miss.take(open_)
        to = open_[better]
        w1[to], w2[to], z[to], used[to], miss[to] = (x[better] for x in (a, b, c, tried, missed))
    seam = miss > 0.0  # rounding put a result on a seam just beyond it, seen from either side
    for i, w in enumerate((w1, w2)):
        mu = quarters.mu[:, i]
        over = seam & ((w < 0.0) != (used >> i & 1 == 1)) & (mu.take(used) != mu.take(used ^ (1 << i)))
        w[over] = 0.0
    z[miss > SEAM] = np.nan
    return kept, (w1, w2), z, used


def _in_quarter(t: Array, e: Array, quadrant: NDArray[np.intp], quarters: Quarters) -> tuple[Array, Array, Array]:
    """Directions in the law's axes and z, as if the ellipse of ``quadrant`` filled the plane."""
    p1, l1, p2, l2, f = _ratios(t, quadrant, e, quarters)
    x = [(np.copysign(p, s), np.where(np.signbit(s), -low, low)) for p, low, s in ((p1, l1, t[:, 0]), (p2, l2, t[:, 1]))]
    rotated = []
    for i in (0, 1):
        axis, low = quarters.axes[:, i].take(quadrant, axis=0), quarters.axes_low[:, i].take(quadrant, axis=0)
        (a, a_low), (b, b_low) = (_FORMULAS.product(axis[:, j], x[j][0]) for j in (0, 1))
        high = a + b
        v = high - a
        rounding = (a - (high - v)) + (b - v)
        rounding = rounding + (a_low + b_low) + sum(axis[:, j] * x[j][1] + low[:, j] * x[j][0] for j in (0, 1))
        rotated.append((high + rounding, rounding - ((high + rounding) - high)))
    (y1, _), (y2, y2_low) = rotated
    ratio = quarters.ratio.take(quadrant)
    w1, w2 = _FORMULAS.direction(np.abs(y1), np.abs(y2), np.where(np.signbit(y2), -y2_low, y2_low), e, ratio)
    z = _FORMULAS.multiplier(f, w1, w2, e, ratio)
    w1, w2 = np.copysign(w1, y1), np.copysign(w2, y2)
    axes = quarters.axes.take(quadrant, axis=0)
    return axes[:, 0, 0] * w1 + axes[:, 1, 0] * w2, axes[:, 0, 1] * w1 + axes[:, 1, 1] * w2, z


def _flat(
    at: NDArray[np.intp],
    trial: Array,
    load: Array,
    quarters: Quarters,
    quadrant: NDArray[np.intp],
    stress: Array,
    slip: Array,
    multiplier: Array,
) -> None:
    """Quadrants in which K is a segment or a point: each axis by itself."""
    for i in (0, 1):
        mu = quarters.mu[:, i].take(quadrant.take(at))
        stress[at, i], slip[at, i], part = clamped(trial[at, i], mu, load.take(at), float(quarters.stiffness[i, i]))
        multiplier[at] += part


def clamped(trial: Array, mu: Array, load: Array, stiffness: float) -> tuple[Array, Array, Array]:
    """Stress, slip and multiplier of one force held in |sigma| <= mu load, exact about which points slip."""
    size = np.abs(trial)
    scale = np.frexp(np.maximum(size, load))[1]
    size, e = np.ldexp(size, -scale), np.ldexp(load, -scale)
    limit, low = _FORMULAS.product(mu, e)
    excess = (size - limit) - low
    slips = excess > 0.0
    slipped = np.where(slips, np.ldexp(excess, scale) / stiffness, 0.0)
    stress = np.where(slips, np.copysign(mu * load, trial), trial)
    return stress, np.copysign(slipped, trial), mu * slipped


def plain_clamped(trial: float, mu: float, load: float, stiffness: float) -> tuple[float, float, float] | None:
    """The same of one force on plain numbers; None where an operation has no value."""
    size = abs(trial)
    try:
        scale = math.frexp(max(size, load))[1]
        size, e = math.ldexp(size, -scale), math.ldexp(load, -scale)
        limit, low = _FORMULAS.product(mu, e)
        excess = (size - limit) - low
        if not excess > 0.0:
            return trial, math.copysign(0.0, trial), mu * 0.0
        slipped = math.ldexp(excess, scale) / stiffness
    except FAULTS:
        return None
    return math.copysign(mu * load, trial), math.copysign(slipped, trial), mu * slipped
