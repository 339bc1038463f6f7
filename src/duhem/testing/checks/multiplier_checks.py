"""What a multiplier is; u is the error in stress the routine is held to (:mod:`duhem.testing.checks.routine_checks`)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks.query import NothingToCheck, Query
from duhem.testing.checks.registry import Finding, register
from duhem.testing.checks.reply import Reply

__all__: list[str] = []

_BESIDE = (4.0, 64.0, 1024.0)  # times u: so far from the stress gradients are taken, the second and third at kinks alone
_WITHIN = tuple(4.0**-i for i in range(8))  # times u: where slopes change sooner than that far from the stress
_ALONG = 1.0 - 1e-6  # cosine of a slip along the normal


@register(
    "multiplier",
    statement="the multiplier is never negative, zero where the trial is admissible, and the slip over the gradient of g as it is written",
    formula="lambda >= 0; sigma_tr in K => lambda = 0; k^-1 (sigma_tr - sigma) = lambda dg/dsigma",
    source="Antoni et al. (2007), Eq. 36; at corners F. H. Clarke (1983), Optimization and Nonsmooth Analysis, section 2.3",
    tolerance="sign: none; zero: lambda |grad g| <= 2 u, the slip that rounding of the boundary explains; size: |sigma_tr - sigma| within "
    "2 u of lambda times the slopes of g along it within 4 u of the stress, at a kink within 1024 u, if the stress is on the boundary and "
    "the slip normal to it; where the gradient vanishes on the boundary there is "
    "none, and where some of those slopes are not positive (the tip of a cone, a K that thin) there is no one multiplier",
)
def multiplier(q: Query) -> Finding:
    found = q.here
    given = found.multiplier
    if given is None:
        raise NothingToCheck("the routine returns no multiplier")
    amount = np.where(given >= 0.0, given, np.inf)
    gradient = q.gradient(found)
    with np.errstate(all="ignore"):
        size = np.where(amount == 0.0, 0.0, amount * q.dual_length(gradient))
    allowed = 2.0 * q.unit(found)
    free = q.certainly((size > allowed) & np.isfinite(amount), found.trial, outside=False)
    none = _vanishing(q, found)
    wrong = free | ~np.isfinite(given) & ~(given > 0.0) & ~(none & np.isnan(given)) | (amount != given) & ~np.isnan(given)
    return Finding(np.where(wrong, size, np.where(none, 0.0, _lacking(q, found, given))), allowed)


def _vanishing(q: Query, found: Reply) -> NDArray[np.bool_]:
    """Where a stress that slips has a gradient that is 0 on the boundary: it doubles, of one piece of g, within what u allows."""
    asked, u = found.trial - found.stress, q.unit(found)
    length = q.length(asked)
    gradient, piece = q.region.slope(found.stress, q.pressure)
    with np.errstate(all="ignore"):
        step = (_BESIDE[0] * u / length)[:, None] * asked
        beside = [q.dual_length(q.region.slope(found.stress + s * step, q.pressure, choices=piece)[0]) for s in (1.0, -1.0)]
    return np.asarray((length > 2.0 * u) & (np.fmax(*beside) >= 2.0 * q.dual_length(gradient)))


def _lacking(q: Query, found: Reply, amount: Array) -> Array:
    """By how much the length of the slip misses what a multiplier (N,) makes of the slopes of g; 0 where that is not known.

    Of a stress off the boundary, or a slip that is not normal to it, other checks tell, and no multiplier would do.
    """
    asked = found.trial - found.stress
    length, u = q.length(asked), q.unit(found)
    with np.errstate(all="ignore"):
        way = asked / length[:, None]
        least, most, kink = _slopes(q, found.stress, way, _BESIDE[0] * u)
        for share in _BESIDE[1:]:
            if not kink.any():
                break
            low, high, _ = _slopes(q, found.stress, way, share * u)
            least, most = np.where(kink, np.minimum(least, low), least), np.where(kink, np.maximum(most, high), most)
        steep = q.dual_length(q.gradient(found))
        there = np.abs(q.region.level(found.stress, q.pressure)) <= _BESIDE[0] * u * np.maximum(steep, most)
        normal = kink | (least >= _ALONG * steep)
        off = np.maximum(length - amount * most, amount * least - length)
        known = (length > 2.0 * u) & there & normal & (least > 0.0) & np.isfinite(most) & np.isfinite(off)
        for share in _WITHIN:
            if not (known & (off > 2.0 * u)).any():
                break
            low, high, _ = _slopes(q, found.stress, way, share * u)
            least, most = np.fmin(least, low), np.fmax(most, high)
            off = np.maximum(length - amount * most, amount * least - length)
    return np.where(known, np.maximum(off, 0.0), 0.0)


def _slopes(q: Query, stress: Array, way: Array, near: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """The least and the greatest slope of g along ``way`` (N, d), at the stress and ``near`` it; where its formula changes its piece."""
    n, d = stress.shape
    beside = np.concatenate([np.zeros((1, n, d)), *(s * np.broadcast_to(x, (1, n, d)) for x in (way, *q.axes) for s in (1.0, -1.0))])
    points = (stress + near[:, None] * beside).reshape(-1, d)
    gradient, pieces = q.region.slope(points, np.tile(q.pressure, len(beside)))
    slopes = np.einsum("snd,nd->sn", gradient.reshape(-1, n, d), way)
    around = pieces.reshape(len(beside), n, -1)
    return slopes.min(axis=0), slopes.max(axis=0), np.asarray((around != around[0]).any(axis=(0, 2)))
