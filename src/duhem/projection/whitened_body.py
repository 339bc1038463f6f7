"""The set K of each point in working units: lengths of its own size, stresses whitened by the stiffness.

With the stiffness k = kappa L L^T (kappa its mean eigenvalue) and a size R of K a point, stresses are sigma = R x and
x = L u; distances |u| are then the k^-1 metric up to a factor, and K has extent 1 in the direction of the trial.  What is asked of such
a set before anything is searched for stands here too: points inside it, and directions along which it does not end.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.jets import Choices, JetProgram, formula, program
from duhem.expression.numpy_ import Program
from duhem.projection.increment import Increment
from duhem.projection.result import Array
from duhem.projection.row_by_row import length, times
from duhem.projection.scaled_formula import ScaledFormula

__all__ = ["Body", "Index", "Piece", "body", "inner_points", "lineality", "whitening"]

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
