"""What a consistent tangent is; u is the error in stress the routine is held to (:mod:`duhem.testing.checks.routine_checks`)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks.query import NothingToCheck, Query
from duhem.testing.checks.registry import Finding, register

__all__ = ["asymmetry"]

_EPS = float(np.finfo(np.float64).eps)
_RESOLVED = 0.05  # of k: differences that disagree by more do not tell
_LEAST = 320.0  # times u: the shortest step of which rounding leaves a difference as good as that
_FINER = 12  # steps, each a quarter of the one before: the last is some thousand roundings long


@register(
    statement="the consistent tangent is symmetric and has eigenvalues in [0, k]",
    formula="C = C^T, 0 <= x . C x <= x . k x",
    source="Simo and Taylor (1985), Comput. Methods Appl. Mech. Eng. 48, 101-118",
    tolerance="d^2 (accuracy + 8 eps), in the metric of k",
)
def tangent(q: Query) -> Finding:
    c, finite = _tangent(q)
    off, allowed = _beyond(q, c)
    return Finding(np.where(finite, off, np.inf), allowed)


def _beyond(q: Query, c: Array) -> tuple[Array, Array]:
    """Return by how much tangents are not symmetric or leave [0, k] (N,), and by how much they may."""
    eigen = np.linalg.eigvalsh(0.5 * (c + np.swapaxes(c, 1, 2)))
    off, allowed = asymmetry(q, c)
    return np.maximum(off, np.maximum(-eigen.min(axis=1), eigen.max(axis=1) - 1.0)), allowed


def asymmetry(q: Query, c: Array) -> tuple[Array, Array]:
    """Return by how much tangents (N, d, d) in the metric of k are not symmetric (N,), and by how much they may be."""
    return np.abs(c - np.swapaxes(c, 1, 2)).max(axis=(1, 2)), np.full(len(c), c.shape[1] ** 2 * (q.accuracy + 8.0 * _EPS))


@register(
    statement="the consistent tangent agrees with finite differences of the routine where these are accurate (not near a flat point of K)",
    formula="C du = d sigma",
    source="Simo and Taylor (1985), Comput. Methods Appl. Mech. Eng. 48, 101-118",
    tolerance="what the differences at h and h/2, either way, disagree by (twice), + 16 u/h, with h the geometric mean of u and "
    "|sigma_tr| + |sigma|, or 320 u where they disagree by k/20 and neither way agrees with the tangent; what they are off by there, where "
    "smaller steps one way come ten times closer (K may be thinner than h), or where at all of them the two ways disagree by a quarter "
    "of it (no slope); any in [0, k] within 4 u of the boundary, where it jumps",
    again=True,
)
def slope(q: Query) -> Finding:
    here, (c, finite) = q.here, _tangent(q)
    u = q.unit(here)
    h = np.sqrt(u * (q.length(here.trial) + q.length(here.stress)))
    h = np.where(h > 0.0, h, 1e5 * u)  # no stress at all: small beside K
    h = np.where(h > 0.0, h, 1.0)
    worst = np.where(finite, 0.0, np.inf)
    rows, d = np.arange(len(c)), len(q.axes)
    for i in range(d) if q.whole is None else [(q.rows + q.turn) % d]:  # of some rows among others, one axis each
        axis, column = np.broadcast_to(q.axes[i], (len(c), d)), c[rows, :, i]
        slopes, step, kink = _slopes(q, h, axis), h, np.ones(len(c), dtype=np.bool_)
        off, spread, near = _misses(slopes, column)
        ratio = off / (2.0 * spread + 16.0 * u / h + 8.0 * _EPS)
        if (unresolved := q.sound & (ratio <= 1.0) & (spread > _RESOLVED) & (near > _RESOLVED) & (_LEAST * u < h)).any():
            least = np.where(unresolved, _LEAST * u, h)
            off_then, spread, _ = _misses(_slopes(q, least, axis), column)
            seen = unresolved & (spread <= _RESOLVED)
            off, step = np.where(seen, off_then, off), np.where(seen, least, h)
            ratio = np.where(seen, off / (2.0 * spread + 16.0 / _LEAST + 8.0 * _EPS), ratio)
        for _ in range(_FINER):
            if not (q.sound & ~(ratio <= 1.0)).any():
                break
            step = step / 4.0
            slopes = _slopes(q, step, axis)
            near = _misses(slopes, column)[2]
            ratio = np.where(near <= off / 10.0, np.minimum(ratio, 1.0), ratio)
            kink &= np.linalg.norm(slopes[:2].mean(axis=0) - slopes[2:].mean(axis=0), axis=1) >= off / 4.0
        ratio = np.where(kink, np.minimum(ratio, 1.0), ratio)
        worst = np.maximum(worst, ratio)
    if (q.sound & finite & ~(worst <= 1.0)).any():
        off, allowed = _beyond(q, c)
        worst = np.where(finite & (off <= allowed) & _at_the_end(q), np.minimum(worst, 1.0), worst)
    return Finding(worst, np.ones(len(worst)))


def _misses(slopes: Array, column: Array) -> tuple[Array, Array, Array]:
    """Of slopes (4, N, d): what a column (N, d) misses of their mean, what they differ from it, what it misses of the nearer way."""
    middle, apart = slopes.mean(axis=0), np.linalg.norm(slopes - column, axis=2)
    spread = np.linalg.norm(slopes - middle, axis=2).max(axis=0)
    return np.linalg.norm(column - middle, axis=1), spread, np.minimum(apart[:2].max(axis=0), apart[2:].max(axis=0))


def _at_the_end(q: Query) -> NDArray[np.bool_]:
    """Where the trial lies within 4 u of the end of K and comes back so near: k from inside, and outside what curvature makes of it."""
    here, (n, d) = q.here, q.case.trial.shape
    u = q.unit(here)
    ways = np.vstack([q.axes, -q.axes])
    around = (here.trial[:, None, :] + 4.0 * u[:, None, None] * ways).reshape(n * 2 * d, d)
    outside = (q.region.level(around, np.repeat(q.pressure, 2 * d)) > 0.0).reshape(n, 2 * d).any(axis=1)
    return np.asarray((q.length(here.stress - here.trial) <= 4.0 * u) & (outside | (u == 0.0)))


def _slopes(q: Query, h: Array, axis: Array) -> Array:
    """Slopes (4, N, d) of the routine along an axis a row (N, d), in the metric of k, by differences at h and h/2, either way."""
    here, shares = q.here, (1.0, 0.5, -1.0, -0.5)
    found = q.ask(*(here.trial + s * h[:, None] * axis for s in shares))
    return np.stack([q.shadow(beside.stress - here.stress) / (s * h[:, None]) for s, beside in zip(shares, found, strict=True)])


def _tangent(q: Query) -> tuple[Array, NDArray[np.bool_]]:
    """Return the routine's tangents (N, d, d) in the metric of k, with 0 in place of those that are not finite, and which are (N,)."""
    given = q.here.tangent
    if given is None:
        raise NothingToCheck("the routine returns no tangent")
    c = q.whitened(given)
    finite = np.asarray(np.isfinite(c).all(axis=(1, 2)))
    return np.where(finite[:, None, None], c, 0.0), finite
