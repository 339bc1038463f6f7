"""What K itself must be, whatever routine is used.  Exact: a violation is confirmed in 60 digits, so nothing is allowed for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from duhem.expression.jets import Choices
from duhem.expression.rays import Rays
from duhem.projection.result import Array
from duhem.testing.checks.query import NothingToCheck, Query
from duhem.testing.checks.registry import Finding, register
from duhem.testing.drawn.case import vector

__all__ = ["Dents"]

_EPS = float(np.finfo(np.float64).eps)
_ANGLES = 64
_PLANES = 2  # of a case
_NEAR, _FAR = 2.0**-30, 2.0**10  # shares of the size of K between which its boundary is looked for
_BITS = 36  # then it is known to a part in 10^9
_DRAWN_IN = (0.1, 0.25, 0.5)  # shares of a stress of K, one of which lies inside where neither 0 nor the middle surely does
_ALONG = 1e-3  # a direction that is nearer to another than this spans no plane with it
_DIGITS = (1, 2, 3, 5, 8)  # in which a pair is told, if it can be
_TURN = 2.0 * np.pi / _ANGLES * np.arange(_ANGLES)
_COS, _SIN = np.cos(_TURN).round(15), np.sin(_TURN).round(15)  # no share of an axis on the other
_LEFT, _RIGHT = (np.ravel(each) for each in np.meshgrid(np.arange(_ANGLES), np.arange(1, _ANGLES // 2), indexing="ij"))
_RIGHT = (_LEFT + _RIGHT) % _ANGLES  # opposite points are left out: their middle is deep inside


class Dents:
    """Pairs of stresses on the boundary of K whose middle lies outside: looked for all round in planes of forces, not where a draw falls.

    A dent between two drawn stresses is met by chance; between two of so many boundary points all round a plane it is met where it is
    wider than two of their angles.  Doubles only suggest: whether a pair shows a dent is decided in 60 digits.

    The planes of a case go through a point inside K(sigma_n) of some rows, and are spanned by the directions of ``inside`` and ``beside``.
    Forces are measured by how far K reaches along their axes.  ``rows`` are those whose plane was looked at, in ``pairs`` of points.
    """

    def __init__(self, query: Query) -> None:
        self.query = query
        pressed = query.case.pressure is None or query.pressure != 0.0
        likely = np.flatnonzero(np.broadcast_to(pressed, len(query.case)))[:_PLANES]
        size, middle = self._measured(likely)
        known = np.isfinite(size).all(axis=1) & (query.case.trial.shape[1] > 1)
        self.rows, self.size, self.middle, self.pairs = likely[known], size[known], middle[known], int(known.sum()) * len(_LEFT)

    def _measured(self, rows: NDArray[np.intp]) -> tuple[Array, Array]:
        """How far K reaches along each axis (M, d), nan where no point surely inside is known, and such a point (M, d)."""
        query, d = self.query, self.query.case.trial.shape[1]
        reach = query.reaches[rows]
        ends = np.where(np.isfinite(reach), reach, 0.0)
        size = np.maximum(ends[:, :d], ends[:, d:])
        least = size.max(axis=1, keepdims=True)
        size = np.where(size > 0.0, size, np.where(least > 0.0, least, 1.0))
        ends = np.where(np.isfinite(reach), reach, np.tile(size, 2))
        middle = (ends[:, :d] - ends[:, d:]) / (2.0 * d)
        load = query.pressure[rows]
        middle = np.where(query.region.surely_inside(middle, load)[:, None], middle, 0.0)
        lost = np.flatnonzero(~query.region.surely_inside(middle, load))
        if lost.size and d > 1:
            middle[lost] = self._drawn_in(rows[lost], ends[lost])
        return np.where(query.region.surely_inside(middle, load)[:, None], size, np.nan), middle

    def _drawn_in(self, rows: NDArray[np.intp], ends: Array) -> Array:
        """Of the ends of K on the axes (M, 2 d) and the stresses drawn, all drawn in towards 0, the one surely inside with the least g.

        K of a g that is 0 or has no value at the origin: symmetric, it has its middle there.  (M, d), 0 where there is none.
        """
        query, (m, d) = self.query, (len(rows), self.query.case.trial.shape[1])
        axes = ends[:, :, None] * np.vstack([np.eye(d), -np.eye(d)])
        whole = np.concatenate([axes, query.case.inside[rows][:, None], query.case.beside[rows][:, None]], axis=1)
        points = np.concatenate([share * whole for share in _DRAWN_IN], axis=1).reshape(-1, d)
        load = np.repeat(query.pressure[rows], len(points) // m)
        level = np.where(query.region.surely_inside(points, load), query.region.level(points, load), np.inf).reshape(m, -1)
        best = np.argmin(level, axis=1)
        return np.where(np.isfinite(level[range(m), best])[:, None], points.reshape(m, -1, d)[range(m), best], 0.0)

    def deepest(self) -> dict[int, tuple[Array, Array]]:
        """By row, two stresses (d,) of K whose middle lies outside, in as few digits as show it."""
        if not self.rows.size:
            return {}
        edge = self._boundary()
        first, last = edge[:, _LEFT], edge[:, _RIGHT]
        level = self.query.region.level(0.5 * (first + last), self.query.pressure[self.rows, None])
        level = np.where(np.isfinite(level), level, -np.inf)
        found = {}
        for i in np.flatnonzero((level > 0.0).any(axis=1)).tolist():
            at = int(np.argmax(level[i]))
            if (pair := self._shown(i, first[i, at], last[i, at])) is not None:
                found[int(self.rows[i])] = pair
        return found

    def _boundary(self) -> Array:
        """Points of K next to its boundary (M, angles, d)."""
        first, second = self._planes()
        way = (_COS[:, None] * first[:, None] + _SIN[:, None] * second[:, None]) * self.size[:, None]
        m, n, d = way.shape
        load = np.repeat(self.query.pressure[self.rows], n)[:, None]
        middle, ways = np.repeat(self.middle, n, axis=0), way.reshape(m * n, d)
        rays = Rays(lambda points: self.query.region.level(points, load), middle, ways)
        ends = rays.inside(np.array([_NEAR, _FAR]))
        inner, _ = rays.ended(np.full(m * n, _NEAR), np.full(m * n, _FAR), bits=_BITS)
        inner = np.where(ends[:, 0], np.where(ends[:, 1], _FAR, inner), 0.0)
        return rays.at(inner).reshape(m, n, d)

    def _planes(self) -> tuple[Array, Array]:
        """Two directions (M, d), orthogonal where forces are measured by the size of K."""
        case = self.query.case
        m, d = self.size.shape
        axes = [np.tile(axis, (m, 1)) for axis in np.eye(d)]
        asked = [each[self.rows] / self.size for each in (case.inside, case.beside)]
        first, second = np.zeros((m, d)), np.zeros((m, d))
        for each in (*asked, *axes):
            with np.errstate(all="ignore"):
                way = each / np.abs(each).max(axis=1, keepdims=True)
                way = way / np.linalg.norm(way, axis=1, keepdims=True)
                rest = way - (way * first).sum(axis=1, keepdims=True) * first
                size = np.linalg.norm(rest, axis=1, keepdims=True)
                new = np.isfinite(size) & (size > _ALONG)
                one = new & ~first.any(axis=1, keepdims=True)
                two = new & ~one & ~second.any(axis=1, keepdims=True)
                first, second = np.where(one, way, first), np.where(two, rest / size, second)
        return first, second

    def _shown(self, i: int, first: Array, last: Array) -> tuple[Array, Array] | None:
        """The pair in few digits, or as it was found, or None where many digits don't confirm it."""
        inner, load = self.middle[i], float(self.query.pressure[self.rows[i]])
        pairs = (*self._rounder(inner, first, last, load), (first, last))
        return next((pair for pair in pairs if self.query.region.dented(*pair, inner, load)), None)

    def _rounder(self, inner: Array, first: Array, last: Array, load: float) -> Sequence[tuple[Array, Array]]:
        """The same pair drawn in a little and in few digits, where doubles say that it shows the dent still."""
        pairs = [
            tuple(np.array([float(f"{x:.{digits - 1}e}") for x in inner + (1.0 - share) * (end - inner)]) for end in (first, last))
            for digits in _DIGITS
            for share in (10.0**-digits, 0.2 * 10.0**-digits)
        ]
        one, other = (np.array(each) for each in zip(*pairs, strict=True))
        levels = [self.query.region.level(point, np.full(len(point), load)) for point in (one, other, 0.5 * (one + other))]
        return [pairs[j] for j in np.flatnonzero((levels[0] <= 0.0) & (levels[1] <= 0.0) & (levels[2] > 0.0))]  # type: ignore[misc]


@register(
    statement="zero stress is admissible",
    formula="0 in K(sigma_n)",
    source="Antoni et al. (2007), Eqs. 27, 28: Phi* least at 0",
    tolerance="none: 60 digits",
    law_only=True,
)
def origin(q: Query) -> Finding:
    zero = np.zeros_like(q.case.trial)
    out = q.certainly(~q.region.surely_inside(zero, q.pressure), zero, outside=True)
    return Finding(out.astype(np.float64), np.zeros(len(zero)), unknown=q.region.unknown(zero, q.pressure))


@register(
    statement="the midpoint of two stresses in K lies in K",
    formula="p, q in K(sigma_n) => (p + q)/2 in K(sigma_n)",
    source="Antoni et al. (2007), Eq. 34; Rockafellar (1970), section 2",
    tolerance="none: p, q and their middle are judged in 60 digits (the middle of two doubles, rounded once, within 4 eps of |p| + |q|; "
    "of two boundary points, moved by 1e-12 of its way to a stress inside)",
    law_only=True,
    needs="a stress inside K, and none is known",
)
def convexity(q: Query) -> Finding:
    p, other = q.case.inside, q.case.beside
    shrink = 1.0 - 4.0 * _EPS
    middle = 0.5 * (p + other) * shrink  # in K with p, q and 0, and farther inside than its rounding
    found = q.certainly(~(q.region.level(middle, q.pressure) <= 0.0), middle, outside=True)
    for end in (p, other, np.zeros_like(p)):
        found = q.certainly(found, end, outside=False)
    dents = Dents(q)
    tried = {"pairs of stresses": len(p)} | ({"pairs of boundary points": dents.pairs} if p.shape[1] > 1 else {})
    if pairs := dents.deepest():
        rows = list(pairs)
        p, other = p.copy(), other.copy()
        p[rows], other[rows] = (np.array(each) for each in zip(*pairs.values(), strict=True))
        found[rows] = True
    told, middle = np.full(len(p), "", dtype=object), 0.5 * (p + other)
    for i in np.flatnonzero(found):
        told[i] = f"{vector(p[i])} and {vector(other[i])} lie in K, and their midpoint {vector(middle[i])} does not"
    shown = replace(q.case, inside=p, beside=other) if pairs else None
    return Finding(found * q.length(p - other), np.zeros(len(p)), told, tried=tried, case=shown)


@register(
    statement="the boundary has one normal at a seam, whichever side it is taken from",
    formula="n from the left = n from the right, where the piece of g changes",
    source="theory of gauges: gamma' continuous across seams (Antoni et al. 2007, Eq. 35)",
    tolerance="64 eps + what the normal of either piece turns over 16 eps, which is how far the point may lie off the seam",
    law_only=True,
    demanded=False,
)
def smoothness(q: Query) -> Finding:
    if q.case.trial.shape[1] < 2:
        raise NothingToCheck("in one dimension the boundary is two points")
    first, last = _directed(q.case.inside), _directed(q.case.beside)

    def at(way: Array, pressure: Array) -> Array:
        reach = q.region.reach(way, pressure)
        return np.where(np.isfinite(reach), reach, 1.0)[:, None] * way

    def piece(ways: Array) -> Choices:
        """That of directions (N, n, d), as (N, n, pieces)."""
        n, many, d = ways.shape
        load = np.repeat(q.pressure, many)
        return q.region.slope(at(ways.reshape(-1, d), load), load)[1].reshape(n, many, -1)

    none = np.zeros(len(first))
    here = piece(first[:, None])
    rays = Rays(lambda ways: np.where((piece(ways) == here).all(axis=2), -1.0, 1.0), first, last - first)
    apart = ~rays.inside(np.ones(1))[:, 0]
    if not apart.any():
        return Finding(none, none)
    low, high = rays.ended(none, np.ones(len(first)))
    here, there = here[:, 0], piece(rays.at(high)[:, None])[:, 0]
    seam = at(rays.at(low), q.pressure)
    blur = 16.0 * _EPS * np.linalg.norm(seam, axis=1) / np.maximum(np.linalg.norm(rays.at(low), axis=1), _EPS)
    beside = seam + blur[:, None] * _directed(last - first)

    def normal(point: Array, piece: Choices) -> Array:
        return _directed(q.region.slope(point, q.pressure, choices=piece)[0])

    jump = np.linalg.norm(normal(seam, here) - normal(seam, there), axis=1)
    turn = np.maximum(*(np.linalg.norm(normal(seam, side) - normal(beside, side), axis=1) for side in (here, there)))
    whole = (np.abs(seam).max(axis=1) > 0.0) & apart & np.isfinite(jump) & np.isfinite(turn)
    return Finding(np.where(whole, jump, 0.0), 64.0 * _EPS + np.where(whole, turn, 0.0))


def _directed(vectors: Array) -> Array:
    size = np.linalg.norm(vectors, axis=1, keepdims=True)
    with np.errstate(all="ignore"):
        return np.where(size > 0.0, vectors / size, vectors)
