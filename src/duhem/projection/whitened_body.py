"""The set K of each point in working units: lengths of its own size, stresses whitened by the stiffness.

With the stiffness k = kappa L L^T (kappa its mean eigenvalue) and a size R of K a point, stresses are sigma = R x and
x = L u; distances |u| are then the k^-1 metric up to a factor, and K has extent 1 in the direction of the trial.  What is asked of such
a set before anything is searched for stands here too: points inside it, and directions along which it does not end.

Where K has no inner point, as at sigma_n = 0, where most laws leave the origin alone, there is nothing to start a search from.  From the
trial stress on, K is then shut in by the half-spaces h(x) + grad h(x) . (y - x) <= 0 at the nearest point x of those before (J. E. Kelley
1960).  Two of them end at the tip of a cone; where g has no slope in the point (a sum of squares) each brings x nearer by a fixed share.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.jets import Choices, JetProgram, formula, program
from duhem.expression.numpy_ import Program
from duhem.projection.half_spaces import HalfSpaces
from duhem.projection.increment import Increment
from duhem.projection.result import Array, Solution
from duhem.projection.row_by_row import length, times
from duhem.projection.scaled_formula import ScaledFormula, grown, level_of, power_of_two, scaled

__all__ = ["Body", "Index", "Piece", "body", "inner_points", "lineality", "shrunk", "whitening"]

Index = NDArray[np.intp]


@dataclass(frozen=True)
class Piece:
    """A smooth piece at a point, its level a signed distance to first order, in whitened units.

    ``level`` (M,), unit ``normal`` (M, d), ``curvature`` (M, d, d) the Hessian over the slope; ``slope`` (M,) = |grad h|;
    ``choices`` (M, kinks) name the piece.
    """

    level: Array
    normal: Array
    curvature: Array
    slope: Array
    choices: Choices


@dataclass(frozen=True)
class Body:
    """K = {h <= 0} of N points; ``root`` is L; ``data`` what h holds besides the forces, (N,) each; ``size`` R (N,)."""

    scaled: ScaledFormula
    value: Program
    jets: JetProgram
    data: tuple[Array, ...]
    size: Array
    root: Array

    def resized(self, pressure: Array, size: Array) -> Body:
        """The same bodies measured by other sizes."""
        values = self.scaled.values(pressure, size)
        return Body(self.scaled, self.value, self.jets, tuple(values[q] for q in self.scaled.data), size, self.root)

    def of(self, at: Index) -> Body:
        """The bodies of the points ``at`` alone."""
        return Body(self.scaled, self.value, self.jets, tuple(q[at] for q in self.data), self.size[at], self.root)

    def whitened(self, x: Array) -> Array:
        """u = L^-1 x."""
        u = np.empty_like(x)
        for i, row in enumerate(self.root):  # which is lower triangular
            u[:, i] = (x[:, i] - sum(row[j] * u[:, j] for j in range(i) if row[j])) / row[i]
        return u

    def level(self, x: Array, at: Index) -> Array:
        """h at the stresses ``x`` (M, d) of the points ``at``; where h is undefined, outside."""
        found = self.value(*x.T, *(q[at] for q in self.data))
        return np.where(np.isnan(found), np.inf, found)

    def piece(self, x: Array, at: Index, choices: Choices | None = None, second: bool = True) -> Piece:
        """The smooth piece that holds at ``x``, or the one that ``choices`` name."""
        jet, taken = self.jets(x, [q[at] for q in self.data], choices, second)
        assert jet.gradient is not None
        with np.errstate(all="ignore"):
            gradient = times(jet.gradient, self.root)
            slope = length(gradient)
            slope = np.where(np.isfinite(slope), slope, np.nan)  # of an infinite one every level would be a share of nothing
            unit = 1.0 / slope
            curvature = np.zeros((len(at), 0, 0))
            if jet.hessian is not None:
                curvature = (self.root.T @ jet.hessian @ self.root) * unit[:, None, None]
            return Piece(jet.value * unit, gradient * unit[:, None], curvature, slope, taken)


def body(scaled: ScaledFormula, forces: tuple[sp.Symbol, ...], pressure: Array, size: Array, root: Array) -> Body:
    """The bodies of one law, measured by ``size`` (N,)."""
    data = tuple(scaled.data)
    empty = Body(scaled, program(scaled.expr, (*forces, *data)), formula(scaled.expr, forces, data), (), size, root)
    return empty.resized(pressure, size)


def whitening(increment: Increment) -> tuple[float, Array]:
    """Mean eigenvalue kappa of the stiffness and L with k = kappa L L^T; diagonal stiffness keeps L diagonal."""
    k = increment.stiffness
    with np.errstate(over="ignore"):
        mean = float(np.trace(k) / len(k))
    mean = mean if np.isfinite(mean) else float(np.max(np.diagonal(k)))  # any size near theirs does, where only the sum overflows
    return mean, np.diag(np.sqrt(np.diag(k) / mean)) if increment.diagonal else np.asarray(np.linalg.cholesky(k / mean))


_MARGIN = 1e-11  # in sizes of K
_MAGNITUDES = 4.0 ** np.arange(2, -22, -1)
_DIRECTIONS = 48
_MOST_DIAGONAL = 6  # forces
_SAMPLED_AT_ONCE = 1024  # points: two dozen samples of each at a time stay in the cache


def inner_points(body: Body, at: Index) -> tuple[Array, NDArray[np.bool_]]:
    """Centres (M, d) well inside K in units of the size, the origin wherever it is inside, as it is for admissible laws.

    And where there is none: K has no inner point that sampling finds.
    """
    d = len(body.root)
    centre = np.zeros((len(at), d))
    outside = ~_inner(body, centre, at)
    for directions in (_any_directions, _diagonals):
        if (who := np.flatnonzero(outside)).size:
            centre[who] = _mean_of_samples(body, at[who], directions(d))
            outside[who] = ~_inner(body, centre[who], at[who])
    return centre, outside


def _any_directions(d: int) -> Array:
    """By chance and along the axes (W, d)."""
    return np.concatenate([np.random.default_rng(0).standard_normal((_DIRECTIONS, d)), np.eye(d), -np.eye(d)])


def _diagonals(d: int) -> Array:
    """All sums of axes, both ways: a cone about the hydrostatic axis fills too little of six dimensions to be met by chance."""
    few = min(d, _MOST_DIAGONAL)
    sums = np.array([w for w in product((0.0, 1.0), repeat=few) if sum(w) > 1])
    sums = np.hstack([sums, np.zeros((len(sums), d - few))]) if sums.size else np.zeros((0, d))
    return np.concatenate([sums, -sums])


def _inner(body: Body, x: Array, at: Index) -> NDArray[np.bool_]:
    d = len(body.root)
    inside = body.level(x, at) < 0  # at = 0 it may be rounding alone
    for e in np.concatenate([np.eye(d), -np.eye(d)]):
        inside &= body.level(x + _MARGIN * e, at) <= 0
    return inside


def _mean_of_samples(body: Body, at: Index, directions: Array) -> Array:
    """The mean of the sampled points that lie in K: inside it, K being convex.  Of each ray it is the farthest that counts."""
    d, many = len(body.root), len(_MAGNITUDES)
    mean = np.zeros((len(at), d))
    for start in range(0, len(at), _SAMPLED_AT_ONCE):
        block = at[start : start + _SAMPLED_AT_ONCE]
        total, count, row = np.zeros((len(block), d)), np.zeros(len(block)), np.repeat(block, many)
        for direction in directions:
            ray = _MAGNITUDES[:, None] * direction / np.linalg.norm(direction)
            inside = (body.level(np.tile(ray, (len(block), 1)), row) <= 0).reshape(-1, many)
            seen = inside.any(axis=1)
            total[seen] += ray[np.argmax(inside[seen], axis=1)]
            count += seen
        mean[start : start + _SAMPLED_AT_ONCE] = total / np.maximum(count, 1)[:, None]
    return mean


_SAMPLES = 64
_ALIKE = 1e-9
_SIZES = (-8.0, -1.0, 1.0, 8.0)


def lineality(body: Body) -> Array:
    """An orthonormal basis (d, r) of the directions along which K does not end in either sense, in whitened space; r = 0 for a bounded K.

    The pressure axis of a metal is one.  Along them the projection keeps the trial stress, and taking them out first keeps the digits
    that a large pressure part would cost.  They are found numerically, as the directions orthogonal to every gradient of a sample, along
    which the level does not change from the origin either: a sample may miss the short sides of a slender K.  Whoever uses them checks
    the result on the formula itself.
    """
    d, n = len(body.root), len(body.size)
    at = np.arange(_SAMPLES * d) % n
    x = np.random.default_rng(0).standard_normal((len(at), d)) * 10.0 ** np.linspace(-2, 2, len(at))[:, None]
    normal = body.piece(x, at, second=False).normal
    sound = np.all(np.isfinite(normal), axis=1)
    if sound.sum() < len(at) // 2:
        return np.zeros((d, 0))
    _, values, directions = np.linalg.svd(np.linalg.qr(normal[sound], mode="r"))
    endless = np.asarray(directions[values <= _ALIKE * values[0]].T)
    return endless if not endless.size or _constant(body, endless, at) else np.zeros((d, 0))


def _constant(body: Body, endless: Array, at: Index) -> bool:
    """Whether the level at the origin is that a few sizes of K away, along each direction and all of them together."""
    d, r = endless.shape
    ways = np.vstack([np.zeros(r), np.eye(r), np.ones(r)]) @ endless.T @ body.root.T
    who, origin = np.repeat(at, len(ways)), np.zeros((len(at), d))
    start = np.repeat(body.level(origin, at), len(ways))
    return all(
        bool((np.abs(body.level(np.tile(size * ways, (len(at), 1)), who) - start) <= _ALIKE * (1.0 + np.abs(start))).all())
        for size in _SIZES
    )


# -- a K without an inner point ----------------------------------------------------------------------------------------

_ROUNDS = 200
_STILL = 1e-16  # a point that a round moves by no more than the rounding of its trial is where the next leaves it
_REACHED = 1e-9  # distances from K, in lengths of the trial
_ORIGIN = (1e-7, 1e-4)  # within this of the origin, the origin is meant if it is in K; where g is flat, the rounding of g hides more
_FLAT = 1e-3  # of the slope at the trial: less is none at the point
_BESIDE = 4.0  # times as far away as the point from the origin: what is off beyond the origin cannot cancel it
_SEEN = 1e6  # times its rounding, g shows where K is
_SMALL = (2.0**-30, 2.0**-40)  # pressures close to none, relative to the trial
_SETTLED = 1e-5


def shrunk(increment: Increment, at: Index, solve: Callable[[Increment], Solution]) -> Solution:
    """The increments ``at`` (M,), whose trial is outside a K without inner points; ``failed`` where none is found.

    Stress in Pa, slip k^-1 (sigma_tr - sigma) in m.  The multiplier at the tip of a cone is the limit of small pressures,
    by ``solve``; where g has no slope in the point, so that no multiple of it is the slip, it is that of |sigma - point|.
    """
    asked = increment.of(at)
    trial, forces = asked.trial, asked.law.force_symbols()
    formula = scaled(asked.g, forces, asked.pressure_symbol)
    k = body(formula, forces, asked.pressure, power_of_two(np.max(np.abs(trial), axis=1)), whitening(asked)[1])
    found = _nearest(k, trial / k.size[:, None])
    away = trial / k.size[:, None] - found.end
    near, far = np.linalg.norm(k.whitened(found.end), axis=1), np.linalg.norm(k.whitened(away), axis=1)
    share = np.divide(_BESIDE * near, far, out=np.ones_like(far), where=far > _BESIDE * near)
    own = power_of_two(near)  # small beside a far trial is not yet small: the same again, from a trial as near as the point
    again = found.end + share[:, None] * away
    nearer = _nearest(k.resized(asked.pressure, k.size * own), again / own[:, None])
    with np.errstate(all="ignore"):
        value, hidden = level_of(asked).bounded(again * k.size[:, None], asked.pressure, k.size * own)
    blind = ~(value > _SEEN * hidden)  # g has lost its digits before: a point beside the origin says nothing
    stress = np.where(found.failed | nearer.failed | blind, found.x.T, nearer.x.T * own).T * k.size[:, None]
    slip = np.asarray(np.linalg.solve(asked.stiffness, (trial - stress).T).T)
    scale = np.max(np.abs(slip), axis=1, initial=0.0)
    length = scale * np.linalg.norm(slip / np.where(scale > 0.0, scale, 1.0)[:, None], axis=1)
    with np.errstate(over="ignore", invalid="ignore"):
        weight = grown(found.weight / whitening(asked)[0], k.size, 2.0 - formula.degree)
    multiplier = np.where(found.flat, length, weight)
    tips = np.flatnonzero(~found.flat & (asked.pressure == 0.0) & ~stress.any(axis=1)) if asked.law.pressure else at[:0]
    if tips.size:
        multiplier[tips] = _limit(replace(asked, trial=trial[tips]), multiplier[tips], solve)
    return Solution(stress, slip, multiplier, found.failed)


def _limit(increment: Increment, otherwise: Array, solve: Callable[[Increment], Solution]) -> Array:
    """The multipliers of vanishing pressures, where they settle; beside a trial so small that these have no digits there are none."""
    size, found = np.max(np.abs(increment.trial), axis=1), otherwise.copy()
    at = np.flatnonzero(size * min(_SMALL) >= np.finfo(np.float64).tiny)
    if not at.size:
        return found
    small, smaller = (solve(replace(increment, trial=increment.trial[at], pressure=-size[at] * share)) for share in _SMALL)
    settled = ~small.failed & ~smaller.failed & np.isclose(small.multiplier, smaller.multiplier, rtol=_SETTLED, atol=0.0)
    found[at[settled]] = smaller.multiplier[settled]
    return found


@dataclass(frozen=True)
class _Nearest:
    """``x`` (M, d), the origin where that is meant and ``end`` is as near as it is; ``weight`` (M,) the sum of the multipliers of
    the gradients; ``flat`` where these vanish towards x."""

    x: Array
    end: Array
    weight: Array
    flat: NDArray[np.bool_]
    failed: NDArray[np.bool_]


def _nearest(k: Body, trial: Array) -> _Nearest:
    s = k.whitened(trial)
    outer = HalfSpaces.around(s)
    slopes, first, last = np.ones(outer.held.shape), np.full(len(s), np.nan), np.full(len(s), np.nan)
    distance, left = np.full(len(s), np.inf), np.arange(len(s))
    for _ in range(_ROUNDS):
        x = times(outer.point[left], k.root.T)
        piece = k.piece(x, left, second=False)
        outside = np.isfinite(piece.normal).all(axis=1) & (piece.level > 0.0)
        distance[left] = np.where(piece.level > 0.0, piece.level, np.where(k.level(x, left) <= 0.0, 0.0, np.inf))
        left, normal, level, slope = left[outside], piece.normal[outside], piece.level[outside], piece.slope[outside]
        if not left.size:
            break
        first[left], last[left] = np.where(np.isnan(first[left]), slope, first[left]), slope
        slot = outer.free_slot(left)
        slopes[left, slot] = slope
        before = outer.point[left]
        outer.add(left, slot, normal, np.einsum("nd,nd->n", normal, before) - level)
        left = left[np.abs(outer.point[left] - before).max(axis=1) > _STILL]
    x = times(outer.point, k.root.T)
    origin = np.zeros_like(x)
    flat = last < _FLAT * first
    near = np.linalg.norm(outer.point, axis=1) <= np.where(flat, _ORIGIN[1], _ORIGIN[0]) * np.linalg.norm(s, axis=1)
    near &= k.level(origin, np.arange(len(x))) <= 0.0
    with np.errstate(all="ignore"):
        weight = np.where(outer.active, outer.multipliers / slopes, 0.0).sum(axis=1)
    failed = ~(near | (distance <= _REACHED * np.linalg.norm(s, axis=1)))
    return _Nearest(np.where(near[:, None], origin, x), x, weight, flat, failed)
