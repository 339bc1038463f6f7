"""How far a slip is from the normals of K around a stress: corners count, and bends too sharp for the digits of a stress."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache, reduce
from itertools import chain, combinations, repeat

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.scalar_jets import scalar_jets
from duhem.expression.vocabulary import EigMax
from duhem.projection import newton_step, slip_kernel
from duhem.projection.half_spaces import HalfSpaces
from duhem.projection.increment import ROUNDING, Metric
from duhem.projection.module_text import module_text
from duhem.projection.plain_numbers import FAULTS, interpreted, zeros
from duhem.projection.result import Array, Pointwise
from duhem.projection.row_by_row import dot, length, spanning, times, unit
from duhem.projection.scaled_formula import Level

__all__ = ["Suspect", "beside", "off_cone", "off_edge"]

_Sides = tuple[Array, Array, Array]  # unit normals, lengths of the gradient, heights over the stress in lengths of it

_BLOCK = 16_384
_BESIDE = (1e-15, 1e-13, 1e-11, 1e-9, 1e-8, 5e-8, 1e-6, 1e-4)  # of the length of a stress: normals are looked for this close to it
_CLOSEST = (1e-13, 1e-9)  # the same, where the axes lie along edges
_TURNS = 6
_APEX = (1e-13, 1e-9, 5e-8)  # the same about an apex
_CUTS = 24
_CLOSE = 2.0  # times as far from the boundary as from the stress is not beside it
_THIN = 1e-13  # of the length of a stress: what is less than this across is rounding
_OPPOSED = -0.9  # cosine of two normals so close to each other that K is thin, or a point


@dataclass(frozen=True)
class Suspect(Pointwise):
    """Points (M,) whose slip is not along the gradient at their stress; ``slip``, its ``rounding`` and ``multiplier`` over ``scale``.

    ``scale`` is the length of the stress, of the trial at the ``tip`` of a cone, where the stress is zero; ``size`` the unit R of
    the level, and ``multiplier`` that of its gradient.  ``slip`` and lengths are those of the metric of k.
    """

    stress: Array
    pressure: Array
    size: Array
    slip: Array
    multiplier: Array
    scale: Array
    rounding: Array
    tip: NDArray[np.bool_]


def off_cone(level: Level, metric: Metric, suspect: Suspect) -> Array:
    """The least length of boundary around a stress in which K has its slip for a normal, as a share of the stress.

    The closest point is then as near as that: so corners count, and bends too sharp for the digits of a stress
    (|x|^p, p near 1), and on a flat side a slip that is off by an angle does not.
    """
    best = np.full(len(suspect.slip), np.inf)
    if level.scaled.expr.has(EigMax):
        best = off_edge(level, metric, suspect)
    left = np.flatnonzero(~(best <= 10.0 * _CLOSEST[0]))
    ways = beside(suspect.stress.shape[1])
    askew = ((share, _askew(ways, turn)) for turn in range(_TURNS if level.jets.kinks else 0) for share in _CLOSEST)
    for share, way in chain(zip(_BESIDE, repeat(ways)), askew):  # the latter are drawn where they are needed
        if not left.size:
            break
        best[left] = np.fmin(best[left], np.maximum(_off_normals(level, metric, suspect.of(left), share * way, share), share))
        left = left[~(best[left] <= 10.0 * share)]
    left = np.flatnonzero(~(best <= 10.0 * _APEX[-1]))  # also where sides far about the stress come close to the slip
    for share in _APEX if left.size and suspect.slip.shape[1] > 1 else ():
        best[left] = np.fmin(best[left], np.maximum(_off_tangents(level, metric, suspect.of(left), share, share * ways), share))
        left = left[~(best[left] <= 10.0 * share)]
    return best


def _askew(ways: Array, turn: int) -> Array:
    """As many ways, none of them along an edge: where pieces are equal along the axes, one of them stands for all there."""
    other = np.random.default_rng(turn).standard_normal(ways.shape)
    return np.asarray(other / np.linalg.norm(other, axis=1)[:, None])


def _off_normals(level: Level, metric: Metric, at: Suspect, ways: Array, enough: float) -> Array:
    """Distance of the slips from the cone of the normals these ways from the stress, or of the multiplier from theirs if that is more.

    Of a slip that is no farther than ``enough`` from one cone no others are tried.
    """
    d, left = at.stress.shape[1], np.arange(len(at.slip))
    off, on = _sides(level, metric, at, np.broadcast_to(ways[:, None], (len(ways), len(left), d)))
    thin = _opposed(off[0])
    bare = (thin & (np.linalg.norm(ways, axis=1).min() <= 2.0 * _THIN)) | at.tip
    normals, steep, heights = (np.where(bare[:, None] if x.ndim > 2 else bare, x, y) for x, y in zip(off, on, strict=True))
    best = np.full(len(left), np.inf)
    for chosen in _choices(len(normals), d, most=max(1, _BLOCK // len(left))):
        sets, count = chosen.shape
        taken = (x[chosen[:, :, None], left] for x in (normals, steep, heights))
        cones = _Cones(*(np.moveaxis(x, 1, -1).reshape(-1, *x.shape[3:], count) for x in taken))
        again = np.tile(left, sets)
        best[left] = np.fmin(best[left], np.fmin.reduce(cones.off(at.of(again), thin[again]).reshape(sets, -1), axis=0))
        if not (left := left[~(best[left] <= enough)]).size:
            break
    return best


def _opposed(normals: Array) -> NDArray[np.bool_]:
    """Where normals (W, M, d) next to a stress point against each other: K is a point, or next to, and no one multiplier belongs to it."""
    return np.asarray(reduce(np.fmin, [dot(a, b) for a, b in combinations(normals, 2)]) < _OPPOSED)


def _off_tangents(level: Level, metric: Metric, at: Suspect, near: float, ways: Array) -> Array:
    """The same at an apex of bent sides, or in a point whose sides are seen from a narrow angle, where ways that matter are found in turn.

    Of the tangent cone at the stress, cut out by the sides seen so far, the slip is to have the apex for its closest point.  Where it
    has another, that way either leads into K, and the slip is no normal, or beyond a side not seen yet, which is the next.
    """
    count, d = at.slip.shape
    way, size = unit(at.slip)
    outer = HalfSpaces.around(way)
    steep, heights = np.ones(outer.held.shape), np.zeros(outer.held.shape)
    left = np.flatnonzero(np.isfinite(way).all(axis=1))
    for _ in range(_CUTS):
        if not left.size:
            break
        rest, far = unit(outer.point[left])
        going = far * size[left] > at.rounding[left]
        left, rest = left[going], rest[going]
        beside_it, _ = _sides(level, metric, at.of(left), near * rest[None])  # at the boundary may be the apex itself
        normal, rate, height = (x[0] for x in beside_it)
        new = np.isfinite(normal).all(axis=1) & (dot(normal, rest) > 0.0)
        left, normal = left[new], normal[new]
        slot = outer.free_slot(left)
        steep[left, slot], heights[left, slot] = rate[new], height[new]
        outer.add(left, slot, normal, np.zeros(len(left)))
    pressing = outer.active & (outer.multipliers > 0.0)
    first = np.argsort(~pressing, axis=1, kind="stable")[:, :d]
    rows = np.arange(count)[:, None]
    normals, heights = (np.where(p, x, 0.0) for p, x in ((pressing[:, :, None], outer.normals), (pressing, heights)))
    cones = _Cones(np.swapaxes(normals[rows, first], 1, 2), steep[rows, first], heights[rows, first])
    around = _sides(level, metric, at, np.broadcast_to(ways[:, None], (len(ways), count, d)))[0][0]
    return cones.off(at, _opposed(around))


def _sides(level: Level, metric: Metric, at: Suspect, ways: Array) -> tuple[_Sides, _Sides]:
    """The sides of K these ``ways`` (W, M, d) (in lengths of the stress) from it, and at the boundary from there, (W, M) of them."""
    many, _, d = ways.shape
    at, way = at.of(np.tile(np.arange(len(at.slip)), many)), ways.reshape(-1, d)
    there = at.stress + at.scale[:, None] * times(way, metric.to_stress)
    jet, _ = level.slopes(there, at.pressure, at.size)
    assert jet.gradient is not None
    normal, steep = unit(times(jet.gradient, metric.of_slip))
    fall = (jet.value / steep * (at.size / at.scale))[:, None] * normal
    on = level.gradient(there - at.scale[:, None] * times(fall, metric.to_stress), at.pressure, at.size)
    beyond, rate = unit(times(on, metric.of_slip))
    close = length(fall) <= _CLOSE * length(way)

    def sides(normal: Array, steep: Array) -> _Sides:
        return normal.reshape(many, -1, d), steep.reshape(many, -1), dot(normal, way - fall).reshape(many, -1)

    return sides(normal, steep), sides(np.where(close[:, None], beyond, np.nan), rate)


@dataclass(frozen=True)
class _Cones:
    """Cones of ``normals`` (M, d, count); ``steep`` and ``heights`` (M, count) of their sides."""

    normals: Array
    steep: Array
    heights: Array

    def off(self, at: Suspect, thin: NDArray[np.bool_]) -> Array:
        """Distance of each slip from its cone, or of the multiplier from that of the cone, or of where its sides meet; inf of none."""
        usable, inverse, weights, rest = _spanned(self.normals, at.slip)
        meet = length(np.einsum("ncd,nc->nd", inverse, self.heights))
        sides = np.moveaxis(self.normals, 2, 0)
        sharp = reduce(np.fmin, [dot(a, b) for a, b in combinations(sides, 2)], np.ones(len(usable))) < 0.0
        meet = np.where(sharp & ~at.tip, meet, 0.0)  # where the sides meet, which may be far off at a sharp corner
        total = (weights / self.steep).sum(axis=1)
        amount = np.where(thin, 0.0, np.abs(total / at.multiplier - 1.0))
        rest = np.where(rest <= at.rounding, 0.0, rest)
        return np.where(usable, np.maximum(np.maximum(rest, amount), meet), np.inf)


def _spanned(normals: Array, slip: Array) -> tuple[NDArray[np.bool_], Array, Array, Array]:
    """Of cones (M, d, count): which are known, their inverses, the weights of the slips (M, d) in them and what is left of these."""
    usable: NDArray[np.bool_] = np.asarray(np.isfinite(normals).all(axis=(1, 2)))
    inverse = spanning(np.where(usable[:, None, None], normals, 0.0), ROUNDING)
    weights = np.maximum(inverse @ slip[:, :, None], 0.0)
    return usable, inverse, weights[:, :, 0], length(slip - (normals @ weights)[:, :, 0])


def _choices(many: int, d: int, most: int) -> Iterator[NDArray[np.intp]]:
    """All sets of at most ``d`` of ``many`` sides (sets, count), of one count at a time and at most so many together."""
    for count in range(1, d + 1):
        sets = np.array(list(combinations(range(many), count)))
        yield from (sets[start : start + most] for start in range(0, len(sets), most))


@lru_cache(maxsize=16)
def beside(d: int) -> Array:
    """Ways off a point: the axes both ways, and in few dimensions what lies between them."""
    grid = np.stack(np.meshgrid(*([[-1.0, 0.0, 1.0]] * min(d, 3)), indexing="ij"), axis=-1).reshape(-1, min(d, 3))
    return grid[(grid != 0.0).any(axis=1)] if d <= 2 else np.vstack([np.eye(d), -np.eye(d)])


# -- edges where two eigenvalues are equal: round ones, which no few normals around tell --------------------------------


def off_edge(level: Level, metric: Metric, at: Suspect) -> Array:
    """As :func:`off_cone` says it of edges, one point after the other; inf where no edge says anything."""
    best = np.full(len(at.slip), np.inf)
    if (made := _edged(level)) is None:
        return best
    run, constants = made
    columns = [*level.scaled.values(at.pressure, at.size).values(), *(np.full(len(best), c) for c in constants)]
    data = np.stack(columns, axis=-1) if columns else np.empty((len(best), 0))
    of_slip, distance, d = metric.of_slip.tolist(), np.linalg.norm(at.slip, axis=1), at.stress.shape[1]
    for i, size in enumerate(at.size):
        v, room = zeros(slip_kernel.NORMAL_ROW + 1, d), zeros(slip_kernel.CORNER, 2 * d + 1)
        v[slip_kernel.AT], v[slip_kernel.K_SLIP] = (at.stress[i] / size).tolist(), at.slip[i].tolist()
        numbers = float(at.multiplier[i]), float(at.scale[i] / size), float(distance[i]), 1.0, np.inf
        with suppress(*FAULTS):
            best[i] = run(v, room, data[i].tolist(), of_slip, *numbers)
    return best


@lru_cache(maxsize=256)
def _edged(level: Level) -> tuple[Callable[..., float], tuple[float, ...]] | None:
    """The function of the law and the constants of its formula; None where these have no text or cannot be double."""
    forces, others = level.bounds.symbols[: level.forces], level.bounds.symbols[level.forces :]
    try:
        jets = scalar_jets(level.scaled.expr, forces, others)
    except InputError:  # a word without text
        return None
    if not jets.pairs:
        return None
    sources = (newton_step.eliminated, newton_step.length, slip_kernel)
    text = module_text(level.scaled, level.forces, jets, (jets.pair_piece,), sources, ("edged",))
    return interpreted(text, "edged"), jets.constants
