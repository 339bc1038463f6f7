"""Optimality of a slip increment, recomputed from the law's own formula whatever method solved it.

With |x|_k the norm of a slip (x . k x)^1/2 and of a stress (x . k^-1 x)^1/2, all five residuals are pure numbers,
unchanged by the units: a residual of size q moves the stress by about q of its own size.  They are the conditions of
Karush, Kuhn and Tucker for the closest point (R. T. Rockafellar, 1970, Convex Analysis, section 28), with Antoni et al.
(2007), Eq. (36).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import reduce
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from duhem.expression.jets import Choices, Jet, JetProgram, formula, program
from duhem.projection.allocation import keep_freed_memory
from duhem.projection.increment import Increment
from duhem.projection.known_points import beyond_tangents, raised, tips
from duhem.projection.result import Array, Residuals, Solution
from duhem.projection.stiffness_factors import factors

__all__ = ["residuals"]

_Sides = tuple[Array, Array, Array]  # unit normals, lengths of the gradient, heights over the stress in lengths of it

_BLOCK = 16_384
_BESIDE = (1e-15, 1e-13, 1e-11, 1e-9, 1e-8, 5e-8, 1e-6, 1e-4)  # of the length of a stress: normals are looked for this close to it
_CLOSE = 2.0  # times as far from the boundary as from the stress is not beside it
_THIN = 1e-13  # of the length of a stress: what is less than this across is rounding
_ROUNDING = 4e-15  # of each number that enters
_QUANTILES = (0.0, 0.5, 1.0)  # pressures at which K is looked at, of those that occur
_OPPOSED = -0.9  # cosine of two normals so close to each other that K is thin, or a point
_SUSPECT = 1e-9  # a normal farther off than this is looked at again, as the normal of a corner


def residuals(increment: Increment, solution: Solution, convex: bool = False) -> Residuals:
    """The five residuals of each point (N,); nan or inf where the solution is.

    ``convex``: K is known to be, so that the first four are enough and fewer tau are tried for the fifth.
    """
    n = len(solution.multiplier)
    out = Residuals(*(np.zeros(n) for _ in range(5)))
    judge = _Judge(increment, convex or not (solution.slip.any() or solution.multiplier.any()))  # to stick is to be closest
    keep_freed_memory(n)
    with np.errstate(all="ignore"):
        for start in range(0, n, _BLOCK):
            block = slice(start, start + _BLOCK)
            judge.fill(
                increment.trial[block],
                increment.pressure[block],
                Solution(solution.stress[block], solution.slip[block], solution.multiplier[block], solution.failed[block]),
                Residuals(*(getattr(out, name)[block] for name in Residuals.__dataclass_fields__)),
            )
    return out


class _Judge:
    """The law's formula, its slopes, and the metric of one set of increments."""

    def __init__(self, increment: Increment, convex: bool) -> None:
        law = increment.law
        self.forces = law.force_symbols()
        self.pressure = law.symbols()[law.pressure] if law.pressure else None
        self.formula: JetProgram = formula(increment.g, self.forces, () if self.pressure is None else (self.pressure,))
        names = self.forces if self.pressure is None else (*self.forces, self.pressure)
        self.g = program(increment.g, names)
        self.stiffness = increment.stiffness
        lower, inverse = factors(increment.stiffness)
        self.of_slip, self.of_stress, self.to_stress = lower, inverse.T, lower.T
        self.largest = float(increment.pressure.min(initial=0.0))
        self.tips = tips(self.g, len(self.forces), self.largest if law.pressure else None)
        self.convex = convex
        if not convex:
            pressures = np.quantile(increment.pressure, _QUANTILES, method="nearest") if law.pressure else None
            found = beyond_tangents(self.g, self.formula, len(self.forces), None if pressures is None else np.unique(pressures))
            self.tips = np.vstack([self.tips, found])

    def value(self, stress: Array, pressure: Array) -> Array:
        return self.g(*stress.T) if self.pressure is None else self.g(*stress.T, pressure)

    def slopes(self, stress: Array, pressure: Array, choices: Choices | None = None) -> tuple[Jet, Choices]:
        return self.formula(stress, () if self.pressure is None else (pressure,), choices, second=False)

    def fill(self, trial: Array, pressure: Array, got: Solution, out: Residuals) -> None:
        """The residuals of one block."""
        moved = (got.multiplier != 0.0) | (_widest(got.slip) != 0.0) | (_widest(got.stress - trial) != 0.0)
        still = np.flatnonzero(~moved)
        g = self.value(got.stress[still], pressure[still])
        out.feasibility[still] = np.where(np.isnan(g), np.nan, 0.0)
        if (over := still[g > 0.0]).size:  # a stick on the boundary, to rounding
            jet, _ = self.slopes(got.stress[over], pressure[over])
            out.feasibility[over] = _share(jet.value, _dot(np.abs(_slope(jet.gradient)), np.abs(got.stress[over])))
        at = np.flatnonzero(moved)
        if at.size:
            self._moved(at, trial[at], pressure[at], got, out)

    def _moved(self, at: NDArray[np.intp], trial: Array, pressure: Array, got: Solution, out: Residuals) -> None:
        stress, slip, multiplier = got.stress[at], got.slip[at], got.multiplier[at]
        jet, _ = self.slopes(stress, pressure)
        slope = _slope(jet.gradient)
        g = jet.value
        relative = _share(np.abs(g), _dot(np.abs(slope), np.abs(stress)))
        aim, point, moved = trial @ self.of_stress, stress @ self.of_stress, slip @ self.of_slip
        size = np.maximum(_widest(aim), _widest(point))
        size = np.where(size > 0.0, size, 1.0)[:, None]
        aim, point, moved, pull = aim / size, point / size, moved / size, multiplier[:, None] * slope @ self.of_slip / size
        distance, reach = _length(moved), _length(point)
        whole = distance + reach
        effort = np.sign(multiplier) * _share(_length(pull), whole)
        out.multiplier_sign[at] = np.maximum(-effort, 0.0)
        room = np.where(reach > 0.0, reach, _length(aim))
        depth = _share(np.abs(g), _length(slope @ self.of_slip)) / size[:, 0]
        near = _share(depth, room)
        out.feasibility[at] = np.where(g <= 0.0, 0.0, np.where(near <= _ROUNDING, near, relative))
        out.complementarity[at] = _share(np.minimum(distance, depth), room)
        missed = self._unbalanced(trial, stress, slip) @ self.of_stress / size
        balance = np.maximum(_share(_length(aim - moved - point), _length(aim) + reach), _share(_length(missed), room))
        rounding = _ROUNDING * _length(np.abs(slip) @ np.abs(self.of_slip) / size)
        off = _length(moved - pull)
        off = np.where(off <= rounding, _share(off, whole), _share(off, room))  # far from K a small angle can be a long way on it
        if (suspect := np.flatnonzero(~(off <= _SUSPECT))).size:
            scale = room[suspect] * size[suspect, 0]
            slips, amount = moved[suspect] / room[suspect, None], multiplier[suspect] / scale
            rounding = rounding[suspect] / room[suspect]
            doubt = _Suspect(stress[suspect], pressure[suspect], slips, amount, scale, rounding, reach[suspect] == 0.0)
            off[suspect] = np.fmin(off[suspect], self._off_cone(doubt))
        out.stationarity[at] = np.maximum(balance, off)
        out.variational[at] = self._excess(pressure, point, moved, size, whole, reach) + 0.0 * whole
        if not self.convex:
            out.variational[at] = np.fmax(out.variational[at], self._beside_excess(pressure, point, moved, size, whole, room)) + 0.0 * whole

    def _excess(self, pressure: Array, point: Array, moved: Array, size: Array, whole: Array, reach: Array) -> Array:
        """The largest (sigma_tr - sigma) . k^-1 (tau - sigma) over known points tau of K, relative; lengths are over ``size``."""
        worst, work = np.zeros(len(whole)), _dot(point, moved)
        share = np.ones(pressure.size) if self.largest == 0.0 else pressure / self.largest
        for tip, way, far in zip(self.tips, *map(np.nan_to_num, _unit(self.tips @ self.of_stress)), strict=True):  # the origin has no way
            away = share * (far / size[:, 0])
            excess = away * (moved @ way) - work
            if (beyond := np.flatnonzero(excess > 0.0)).size:
                inside = self.value(share[beyond, None] * tip, pressure[beyond]) < 0.0  # at = 0 it may be rounding alone
                relative = _share(excess[beyond], whole[beyond] * (away[beyond] + reach[beyond]))
                worst[beyond] = np.fmax(worst[beyond], np.where(inside, relative, 0.0))
        return worst

    def _beside_excess(self, pressure: Array, point: Array, moved: Array, size: Array, whole: Array, room: Array) -> Array:
        """The same over points tau close to the stress."""

        def inside(points: Array, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
            stress: Array = size[rows] * (points @ self.to_stress)
            return np.asarray(self.value(stress, pressure[rows]) < 0.0)

        normal, distance = map(np.nan_to_num, _unit(moved))
        return np.asarray(_share(distance * raised(inside, point, normal, room), whole * 2.0 * room))

    def _unbalanced(self, trial: Array, stress: Array, slip: Array) -> Array:
        """trial - k slip - stress, beyond what the rounding of each explains, component by component."""
        k = self.stiffness
        missed = trial - slip @ k - stress
        return np.sign(missed) * np.maximum(np.abs(missed) - _ROUNDING * (np.abs(slip) @ np.abs(k) + np.abs(trial) + np.abs(stress)), 0.0)

    def _off_cone(self, suspect: _Suspect) -> Array:
        """The least length of boundary around a stress in which K has its slip for a normal, as a share of the stress.

        The closest point is then as near as that: so corners count, and bends too sharp for the digits of a stress
        (|x|^p, p near 1), and on a flat side a slip that is off by an angle does not.
        """
        best = np.full(len(suspect.slip), np.inf)
        left = np.arange(len(best))
        for share in _BESIDE:
            found = np.maximum(self._off_normals(suspect.of(left), share), share)
            best[left] = np.fmin(best[left], found)
            left = left[~(best[left] <= 10.0 * share)]
            if not left.size:
                break
        return best

    def _off_normals(self, at: _Suspect, share: float) -> Array:
        """Distance of the slips from the cone of the normals this close to the stress, or of the multiplier from theirs if that is more."""
        d, every = at.stress.shape[1], np.arange(len(at.slip))
        off, on = self._beside(at, share * _ways(d))
        facing = reduce(np.fmin, [_dot(a, b) for a, b in combinations(off[0], 2)])
        thin = facing < _OPPOSED  # a point, or next to: no one multiplier, and no boundary to tell its sides apart
        bare = (thin & (share <= _THIN)) | at.tip
        normals, steep, heights = (np.where(bare[:, None] if x.ndim > 2 else bare, x, y) for x, y in zip(off, on, strict=True))
        best = np.full(len(every), np.inf)
        for chosen in _choices(len(normals), d, most=max(1, _BLOCK // len(every))):
            sets, count = chosen.shape
            cones = _Cones(*(np.moveaxis(x[chosen], 1, -1).reshape(-1, *x.shape[2:], count) for x in (normals, steep, heights)))
            again = np.tile(every, sets)
            best = np.fmin(best, np.fmin.reduce(cones.off(at.of(again), thin[again], bare[again]).reshape(sets, -1), axis=0))
        return best

    def _beside(self, at: _Suspect, ways: Array) -> tuple[_Sides, _Sides]:
        """The sides of K these ``ways`` (W, d) (in lengths of the stress) from it, and at the boundary from there, (W, M) of them."""
        many, d = ways.shape
        at, way = at.of(np.tile(np.arange(len(at.slip)), many)), np.repeat(ways, len(at.slip), axis=0)
        there = at.stress + at.scale[:, None] * (way @ self.to_stress)
        jet, _ = self.slopes(there, at.pressure)
        normal, steep = _unit(_slope(jet.gradient) @ self.of_slip)
        fall = (jet.value / steep / at.scale)[:, None] * normal
        on, _ = self.slopes(there - at.scale[:, None] * (fall @ self.to_stress), at.pressure)
        beyond, rate = _unit(_slope(on.gradient) @ self.of_slip)
        close = _length(fall) <= _CLOSE * _length(way)

        def sides(normal: Array, steep: Array) -> _Sides:
            return normal.reshape(many, -1, d), steep.reshape(many, -1), _dot(normal, way - fall).reshape(many, -1)

        return sides(normal, steep), sides(np.where(close[:, None], beyond, np.nan), rate)


@dataclass(frozen=True)
class _Suspect:
    """Points (M,) whose slip is not along the gradient at their stress; ``slip``, its ``rounding`` and ``multiplier`` over ``scale``.

    ``scale`` is the length of the stress, of the trial at the ``tip`` of a cone, where the stress is zero.  ``slip`` and
    lengths are those of the metric of k.
    """

    stress: Array
    pressure: Array
    slip: Array
    multiplier: Array
    scale: Array
    rounding: Array
    tip: NDArray[np.bool_]

    def of(self, at: NDArray[np.intp]) -> _Suspect:
        return _Suspect(*(getattr(self, f.name)[at] for f in fields(self)))


@dataclass(frozen=True)
class _Cones:
    """Cones of ``normals`` (M, d, count); ``steep`` and ``heights`` (M, count) of their sides."""

    normals: Array
    steep: Array
    heights: Array

    def off(self, at: _Suspect, thin: NDArray[np.bool_], bare: NDArray[np.bool_]) -> Array:
        """Distance of each slip from its cone, or of the multiplier from that of the cone, or of where its sides meet; inf of none."""
        usable: NDArray[np.bool_] = np.asarray(np.isfinite(self.normals).all(axis=(1, 2)))
        inverse = np.linalg.pinv(np.where(usable[:, None, None], self.normals, 0.0), rcond=_ROUNDING)
        weights = np.maximum(inverse @ at.slip[:, :, None], 0.0)
        meet = _length(np.einsum("ncd,nc->nd", inverse, self.heights))
        sides = np.moveaxis(self.normals, 2, 0)
        sharp = reduce(np.fmin, [_dot(a, b) for a, b in combinations(sides, 2)], np.ones(len(usable))) < 0.0
        meet = np.where(sharp & ~bare, meet, 0.0)  # where the sides meet, which may be far off at a sharp corner
        rest = _length(at.slip - (self.normals @ weights)[:, :, 0])
        total = (weights[:, :, 0] / self.steep).sum(axis=1)
        amount = np.where(thin, 0.0, np.abs(total / at.multiplier - 1.0))
        rest = np.where(rest <= at.rounding, 0.0, rest)
        return np.where(usable, np.maximum(np.maximum(rest, amount), meet), np.inf)


def _choices(many: int, d: int, most: int) -> Iterator[NDArray[np.intp]]:
    """All sets of at most ``d`` of ``many`` sides (sets, count), of one count at a time and at most so many together."""
    for count in range(1, d + 1):
        sets = np.array(list(combinations(range(many), count)))
        yield from (sets[start : start + most] for start in range(0, len(sets), most))


def _ways(d: int) -> Array:
    """The axes both ways, and in few dimensions what lies between them."""
    grid = np.stack(np.meshgrid(*([[-1.0, 0.0, 1.0]] * min(d, 3)), indexing="ij"), axis=-1).reshape(-1, min(d, 3))
    return grid[(grid != 0.0).any(axis=1)] if d <= 2 else np.vstack([np.eye(d), -np.eye(d)])


def _dot(first: Array, second: Array) -> Array:
    return reduce(np.add, (a * b for a, b in zip(first.T, second.T, strict=True)))  # as in _widest


def _length(vectors: Array) -> Array:
    return np.asarray(np.sqrt(_dot(vectors, vectors)))


def _unit(vectors: Array) -> tuple[Array, Array]:
    """Directions and lengths, of very small vectors too."""
    size = _widest(vectors)
    length = _length(vectors / size[:, None])
    return vectors / size[:, None] / length[:, None], length * size


def _widest(vectors: Array) -> Array:
    """The largest size of a component, column by column: there are many rows and few columns."""
    return reduce(np.maximum, np.abs(vectors).T)


def _slope(gradient: Array | None) -> Array:
    assert gradient is not None
    return gradient


def _share(part: Array, whole: Array) -> Array:
    """part/whole, with 0/0 = 0."""
    return np.where(part == 0.0, 0.0, part / whole)
