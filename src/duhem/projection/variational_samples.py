"""Points tau of K that are known, and the variational inequality of answers, which is tried on them.

On a K that is not convex the conditions of Karush, Kuhn and Tucker hold at points that are not the closest.  The
inequality (sigma_tr - sigma) . k^-1 (tau - sigma) <= 0 for all tau of K still singles out the closest point, of any K:

    |sigma_tr - tau|^2 = |sigma_tr - sigma|^2 - 2 (sigma_tr - sigma) . k^-1 (tau - sigma) + |tau - sigma|^2.

No finite set of tau shows it.  :func:`tips` go with every law; where K is not known to be convex, :func:`beyond_tangents`
looks along rays from the origin once a law and pressure, and :meth:`Variational.beside` close to each answer.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache, reduce

import numpy as np
from numpy.typing import NDArray

from duhem.expression.rays import Rays, evenly_between
from duhem.projection.extended_precision import as_pairs, close_look
from duhem.projection.in_blocks import FEW_SEARCHED
from duhem.projection.increment import Increment, Metric
from duhem.projection.judge_kernel import FARTHEST
from duhem.projection.result import ACCURACY, Array
from duhem.projection.row_by_row import columns_times, dot, length, share, unit, widest
from duhem.projection.scaled_formula import Level, power_of_two

__all__ = ["Variational", "beyond_tangents", "looks", "points_seen", "tangents", "tips"]

# -- points of K that are known by the sign of g alone ------------------------------------------------------------------

_HALVES = (32, 16, 8, 4, 2, 1)
_CUTS = 11  # into 64 parts each, so that none is left of the doubles between two: 64^11 > 2^63
_RAYS = 384
_RADII = np.concatenate([2.0 ** np.arange(-12, -4), np.arange(1, 129) / 16, 2.0 ** np.arange(3.25, 10.25, 0.25)])  # in extents of K
_LADDER = 2.0 ** np.arange(-1000, 1000, 0.5)
_BITS = 48
_MOST = 1500  # points of one boundary; where g is noise the rays cross it everywhere
_WITHIN = 1e-9  # of a radius: points this far from the boundary are still inside after a few roundings
_BEYOND = 1e-8  # of the distance: less than this beyond a tangent plane is rounding
_ASIDE = (0.3, 0.03, 0.003)  # of the length of a stress
_RAISE = 4e-7  # of it: an answer that passes may be off by a quarter of this
_DOUBLINGS = 20


@lru_cache(maxsize=256)
def tips(g: Level, d: int, pressure: float | None) -> Array:
    """Points of K at one pressure (2 d + 1, d), or close guesses: the origin, and how far K goes along the axes both ways.

    From within, by a bisection of the judge's own that shares nothing with the methods, and that halves by doubles, so that it sees
    parts of K far out; the origin again where K does not contain it.  Several halvings go a call, as few points cost as much as one.
    """
    ways, row = np.vstack([np.eye(d), -np.eye(d)]), np.arange(2 * d)
    low, high = np.zeros(2 * d), np.full(2 * d, 1e300)
    with np.errstate(all="ignore"):
        for _ in range(_CUTS):
            between = evenly_between(low, high, 2 * _HALVES[0])
            points = (between[:, :, None] * ways[:, None, :]).reshape(-1, d)
            rest = () if pressure is None else (np.full(len(points), pressure),)
            inside = g(*points.T, *rest).reshape(between.shape) < 0.0
            ends, last = np.column_stack([low, between, high]), np.zeros(2 * d, dtype=np.intp)
            for half in _HALVES:
                last += np.where(inside[row, last + half - 1], half, 0)
            low, high = ends[row, last], ends[row, last + 1]
            if (high - low <= 1e-12 * high).all():
                break
    return np.vstack([np.zeros(d), low[:, None] * ways])


def beyond_tangents(g: Level, d: int, pressures: Array | None) -> Array:
    """Points of K (n, d) at the first of the ``pressures``, or of K at another and scaled to it, if K is seen not to be convex.

    None, (0, d), where no point that is found on the boundary lies beyond the tangent plane of another.
    """
    if pressures is None:
        return _not_convex(g, d, None)
    first = float(pressures[0])
    scales = {look: 1.0 if look == first else first / look for look in looks(g, d, pressures) if look < 0.0 or look == first}
    return np.vstack([np.zeros((0, d)), *(_not_convex(g, d, look) * scale for look, scale in scales.items())])


def looks(g: Level, d: int, pressures: Array) -> list[float]:
    """At which pressures to look at K, if it is asked for at these: at -1 alone where K grows with the pressure."""
    return sorted({_alike(g, d, float(pressure)) for pressure in pressures})


def points_seen(g: Level, d: int, pressure: float | None) -> tuple[Array, Array]:
    """Points of K (n, d) at one pressure, just within its boundary or far out on rays that do not end, and its extents (d,)."""
    inner, _, endless, scale = _boundary(g, d, pressure)
    return np.vstack([inner, endless]), scale


def _alike(g: Level, d: int, pressure: float) -> float:
    """-1 where K there is K at the pressure -1, scaled, so that one look is enough for a law; else the pressure itself."""
    inner, outer = _boundary(g, d, -1.0)[:2]
    if pressure < 0.0 and len(inner):
        inside = g(*(-pressure * inner).T, np.full(len(inner), pressure)) < 0.0
        outside = g(*(-pressure * outer).T, np.full(len(outer), pressure)) > 0.0
        if (inside & outside).all():
            return -1.0
    return pressure


@lru_cache(maxsize=256)
def _not_convex(g: Level, d: int, pressure: float | None) -> Array:
    """The points of :func:`_boundary` and beyond at one pressure, if one lies beyond the tangent plane of another; else none."""
    (known, scale), inner = points_seen(g, d, pressure), _boundary(g, d, pressure)[0]
    if not len(inner):
        return inner
    with np.errstate(all="ignore"):
        size = power_of_two(widest(inner))
        jet, _ = g.slopes(inner, np.full(len(inner), 0.0 if pressure is None else pressure), size)
        assert jet.gradient is not None
        at, to, normal = inner / scale, known / scale, jet.gradient * scale
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        excess = normal @ to.T - np.einsum("nd,nd->n", normal, at)[:, None]
        apart = np.linalg.norm(at, axis=1)[:, None] + np.linalg.norm(to, axis=1)
        return known if (excess > _BEYOND * apart).any() else np.zeros((0, d))


@lru_cache(maxsize=256)
def _boundary(g: Level, d: int, pressure: float | None) -> tuple[Array, Array, Array, Array]:
    """Where rays from the origin enter and leave K: points just inside and just outside (n, d); far points of rays that do
    not end in K (m, d); and the extents of K along the axes (d,)."""

    def level(points: Array) -> Array:
        flat = points.reshape(-1, d)
        return g(*flat.T, *(() if pressure is None else (np.full(len(flat), pressure),))).reshape(points.shape[:-1])

    with np.errstate(all="ignore"):
        scale = _extents(level, tips(g, d, pressure))
        if not scale.size:
            return np.zeros((0, d)), np.zeros((0, d)), np.zeros((0, d)), np.ones(d)
        rays = Rays(level, np.zeros(d), _directions(d) * scale)
        radii = np.concatenate([[0.0], _RADII])
        inside = rays.inside(radii)
        row, step = np.nonzero(inside[:, 1:] != inside[:, :-1])
        row, step = row[:: 1 + len(row) // _MOST], step[:: 1 + len(row) // _MOST]
        leaves = inside[row, step]
        low, high = radii[step], radii[step + 1]
        crossed = Rays(level, np.zeros(d), rays.way[row])
        inner, outer = crossed.narrowed(np.where(leaves, low, high), np.where(leaves, high, low), _BITS, 4)
        aside = np.where(leaves, 1.0, -1.0) * _WITHIN
        within, without = crossed.at(inner * (1.0 - aside)), crossed.at(outer * (1.0 + aside))
        sound = (level(within) < 0.0) & (level(without) > 0.0)
        return within[sound], without[sound], rays.at(np.full(len(inside), radii[-1]))[inside[:, -1]], scale


def _extents(level: Callable[[Array], Array], known: Array) -> Array:
    """How far K goes along each axis (d,), one length for all where not from the origin on; none (0,) where it is not seen."""
    d = known.shape[1]
    reach = np.abs(known[1:]).max(axis=1).reshape(2, d).max(axis=0)
    seen = (reach > 0.0) & (reach < 1e299)
    if seen.any():
        return np.where(seen, reach, reach[seen].max())
    ways = _directions(d)[:: 1 if d > 2 else _RAYS // 32]
    inside = np.any(level(_LADDER[:, None] * ways[:, None, :]) < 0.0, axis=0)  # at = 0 it may be rounding alone
    ends = _LADDER[:-1][inside[:-1] & ~inside[1:]]
    return np.full(d, ends[-1]) if ends.size else np.zeros(0)


def _directions(d: int) -> Array:
    """Rays: evenly round a plane, else the axes and what chance gives, the same each time."""
    if d == 1:
        return np.array([[1.0], [-1.0]])
    if d == 2:
        angle = 2.0 * np.pi * np.arange(_RAYS) / _RAYS
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)
    chance = np.random.default_rng(0).standard_normal((_RAYS - 2 * d, d))
    return np.vstack([np.eye(d), -np.eye(d), chance / np.linalg.norm(chance, axis=1)[:, None]])


def tangents(normal: Array) -> Iterator[Array]:
    """Unit vectors (N, d) across the normals, both ways: the axes without their share of the normal."""
    d = normal.shape[1]
    across = [np.stack([-normal[:, 1], normal[:, 0]], axis=1)] if d == 2 else []
    if d > 2:
        across = [np.eye(d)[i] - normal[:, i : i + 1] * normal for i in range(d)]
    for way in across:
        size = np.sqrt(np.einsum("nd,nd->n", way, way))[:, None]
        along = way / np.where(size > 0.0, size, 1.0)
        yield along
        yield -along


# -- the inequality -----------------------------------------------------------------------------------------------------

_QUANTILES = (0.0, 0.5, 1.0)  # pressures at which K is looked at, of those that occur


@dataclass(frozen=True, eq=False)
class Variational:
    """``tips`` (T, d) are points of K at the pressure ``largest``, ``reaches`` (T, d) they in the metric of k.

    ``largest`` is the largest of the pressures; of few points on a convex K the power of two within it.  ``convex``: K need not be
    looked at close to each answer.  ``increment`` has the law for more digits.
    """

    level: Level
    metric: Metric
    tips: Array
    reaches: Array
    largest: float
    convex: bool
    increment: Increment

    @classmethod
    def of(cls, increment: Increment, level: Level, metric: Metric, convex: bool) -> Variational:
        d, pressed = level.forces, increment.law.pressure is not None
        largest = float(increment.pressure.min(initial=0.0))
        if convex and len(increment.pressure) <= FEW_SEARCHED:  # points that come one after the other share the tips of few pressures
            largest = -math.ldexp(1.0, math.frexp(largest)[1] - 1) if largest else 0.0
        known = tips(level, d, largest if pressed else None)
        if not convex:
            pressures = np.quantile(increment.pressure, _QUANTILES, method="nearest") if pressed else None
            known = np.vstack([known, beyond_tangents(level, d, None if pressures is None else np.unique(pressures))])
        return cls(level, metric, known, known @ metric.of_stress, largest, convex, increment)

    @property
    def around_origin(self) -> bool:
        """Whether K at that pressure goes on from no stress: then the sets {g <= e} are looked at from there."""
        return bool(self.tips.any())

    def part(self, pressure: Array) -> Array:
        """The pressures as parts of the one at which the tips are known."""
        return np.ones(pressure.size) if self.largest == 0.0 else pressure / self.largest

    def rise(self, s: Array, slope: Array, pressure: Array, units: Array, room: Array, far: Array) -> Array:
        """By how much h rises to stresses ``s`` (M, d) in ``units``, as over their own lengths; nan where nothing is known.

        It rises from a mean of the known points of K on the axes, not with equal weights: a formula may have no value in the middle.
        ``slope`` is dh/ds, ``room`` and ``far`` are the lengths of stress and slip in the metric.  How far the closest point goes
        with the boundary is estimated by a parabola on the way from that place, where the sets {h <= e} are not alike seen from there:
        exactly for a quadratic h.
        """
        d, part = s.shape[1], self.part(pressure) / units
        centre = np.zeros_like(s)
        for weight, tip in enumerate(self.tips[: 2 * d + 1]):
            centre += weight / (d * (2 * d + 1)) * np.clip(part[:, None] * tip, -FARTHEST, FARTHEST)
        rise = -self.level.value(*centre.T, *self.level.scaled.values(pressure, units).values())
        height, reach = dot(slope, s - centre), length((s - centre) @ self.metric.of_stress) * units
        bend = 2.0 * np.maximum(height - rise, 0.0) * units / length(slope @ self.metric.of_slip) * far / reach**2
        low = np.minimum(height, rise) if self.level.jets.kinks else height  # a piece that is as high may be flatter
        return np.where((rise > 0.0) & (height > 0.0), low * room / (reach * np.sqrt(1.0 + bend)), np.nan)

    def beyond(self, pressure: Array, point: Array, moved: Array) -> NDArray[np.intp]:
        """The points (d, N) with one of the tips beyond the plane across the slip, whether or not it lies in K."""
        most = reduce(np.maximum, columns_times(moved, self.reaches.T))
        return np.flatnonzero(~(self.part(pressure) * most <= dot(point.T, moved.T)))

    def excess(self, pressure: Array, point: Array, moved: Array, size: Array, whole: Array, reach: Array) -> Array:
        """The largest (sigma_tr - sigma) . k^-1 (tau - sigma) over known points tau of K, relative; lengths are over ``size``."""
        worst, work, part = np.zeros(len(whole)), dot(point, moved), self.part(pressure)
        for tip, way, far in zip(self.tips, *map(np.nan_to_num, unit(self.reaches)), strict=True):  # the origin has no way
            away = part * (far / size)
            excess = away * (moved @ way) - work
            if (beyond := np.flatnonzero(excess > 0.0)).size:
                inside = self._inside(part[beyond, None] * tip, pressure[beyond])
                relative = share(excess[beyond], whole[beyond] * (away[beyond] + reach[beyond]))
                against = np.flatnonzero(inside & (relative > ACCURACY))
                inside[against] = ~self._outside(part[beyond[against], None] * tip, pressure[beyond[against]])
                worst[beyond] = np.fmax(worst[beyond], np.where(inside, relative, 0.0))
        return worst

    def beside(self, pressure: Array, point: Array, moved: Array, size: Array, whole: Array, room: Array) -> Array:
        """The same over points tau close to the stress: how far K goes beyond the plane through it across the slip."""
        (normal, distance), height = map(np.nan_to_num, unit(moved)), np.zeros(len(point))
        steps = _RAISE * 2.0 ** np.arange(_DOUBLINGS)

        def inside(points: Array, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
            return self._inside(size[rows, None] * (points @ self.metric.to_stress), pressure[rows])

        for way in tangents(normal):
            for aside in _ASIDE:
                beside = point + (aside * room)[:, None] * way
                at = np.flatnonzero(inside(beside + (_RAISE * room)[:, None] * normal, np.arange(len(point))))
                if at.size:
                    lifts = room[at, None] * steps
                    above = beside[at, None, :] + lifts[:, :, None] * normal[at, None, :]
                    in_k = inside(above.reshape(-1, point.shape[1]), np.repeat(at, _DOUBLINGS)).reshape(lifts.shape)
                    height[at] = np.maximum(height[at], np.where(in_k, lifts, 0.0).max(axis=1))
        return np.asarray(share(distance * height, whole * 2.0 * room))

    def _outside(self, stress: Array, pressure: Array) -> NDArray[np.bool_]:
        """What more digits show to be no point of K: what rounding of g calls one speaks against no answer."""
        size = power_of_two(widest(stress))
        value, bound = close_look(self.increment).level(as_pairs(stress, size), pressure, size)
        return np.asarray(value > bound)

    def _inside(self, stress: Array, pressure: Array) -> NDArray[np.bool_]:
        return np.asarray(self.level(*stress.T, pressure) < 0.0)  # at = 0 it may be rounding alone
