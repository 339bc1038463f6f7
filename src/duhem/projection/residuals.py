"""Optimality of a slip increment, recomputed from the law's own formula whatever method solved it.

With |x|_k the norm of a slip (x . k x)^1/2 and of a stress (x . k^-1 x)^1/2, all five residuals are pure numbers,
unchanged by the units: a residual of size q moves the stress by about q of its own size.  They are the conditions of
Karush, Kuhn and Tucker for the closest point (R. T. Rockafellar, 1970, Convex Analysis, section 28), with Antoni et al.
(2007), Eq. (36).

A formula that cancels gives g = 0 wherever it has lost its digits.  So g comes with a bound of its rounding, in units of the
stress; where that bound hides what is asked, g and its slope are looked up in as many digits as it takes.

Which points of a block are plainly right is found first, by few passes over columns where the judge takes many.  Every threshold
beyond which that looks closer is halved here, and where it asks for one of two things the stricter is asked, so that both say the same
of every point, whatever the last digits of either.  What does not pass, or is too large or too small to be squared, is left.
:mod:`duhem.projection.judge_kernel` says the same to a compiler.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.expression.vocabulary import EigMax
from duhem.projection.extended_precision import (
    LEAST_SLIP,
    SLIP_SHARE,
    ClosestInDigits,
    as_pairs,
    close_look,
    closest_beside,
    departures,
    pushed_back,
)
from duhem.projection.in_blocks import BLOCK, in_blocks, keep_freed_memory
from duhem.projection.increment import ROUNDING, Increment, Metric
from duhem.projection.judge_kernel import LOW
from duhem.projection.normal_cones import Suspect, off_cone
from duhem.projection.result import ACCURACY, Array, Residuals, Solution
from duhem.projection.row_by_row import any_of, columns_times, dot, length, share, unit, widest
from duhem.projection.scaled_formula import Level, Placed, level_of, power_of_two
from duhem.projection.variational_samples import Variational

__all__ = ["Judge", "Told", "residuals"]

_BLOCK = 16_384
_SUSPECT = 1e-9  # a normal farther off than this is looked at again, as the normal of a corner
_HIDDEN = 1e-9  # of a stress: where rounding of g hides as much of the boundary, its slope is not known either
_NOISE = 1e-13  # less than this, and the slope of g is as good as any
_ENDS = 2.0**-1018, 2.0**1021  # of the range of doubles, less a few digits
_ENDLESS = 2.0**500  # times as far as the boundary: nobody knows
_FLAT = 2.0**-30  # of what g changes by over the stress: of less rounding may be all
_BESIDE = 2.0**-990  # a stress beside none
_BLIND = 1e-9  # of the stress: at the end of a shorter slip rounding of doubles may choose the wrong one of two pieces
_AROUND = 3.0  # times as far as a corner is beside the stress: as it is a diagonal off, and the closest point as far again
_CLOSE = 1e-3  # how far an answer may be off for the closest point to be looked for beside it
_NEAR = 2.0**10  # sizes of K: so far is a trial brought that leaves no stress
_UNKNOWN = 10.0 * ACCURACY  # nobody knows how far off a point is


@dataclass(frozen=True, eq=False)
class Told:
    """``dissipation`` (N,), ``status`` and ``residuals`` are good but for the points ``left``, None for all of them."""

    dissipation: Array
    status: NDArray[np.int8]
    residuals: Residuals
    left: NDArray[np.intp] | None

    @classmethod
    def nothing(cls, n: int) -> Told:
        """Room for what is to be said of n points."""
        return cls(np.empty(n), np.empty(n, dtype=np.int8), Residuals(*(np.zeros(n) for _ in range(5))), None)


def residuals(increment: Increment, solution: Solution, convex: bool = False) -> Residuals:
    """The five residuals of each point (N,); nan or inf where the solution is.

    ``convex``: K is known to be, so that the first four are enough and fewer tau are tried for the fifth.
    """
    out = Residuals(*(np.zeros(len(solution.multiplier)) for _ in range(5)))
    Judge.of(increment, solution, convex).look(solution, out)
    return out


class Judge:
    """The law's formula, its slopes, the metric and the known points of K of some increments; ``convex``: as for :func:`residuals`."""

    def __init__(self, increment: Increment, convex: bool) -> None:
        self.increment, self.stiffness = increment, increment.stiffness
        self.level: Level = level_of(increment)
        self.pieces = bool(self.level.jets.kinks) or self.level.scaled.expr.has(EigMax)
        self.metric = Metric.of(increment.stiffness)
        self.known = Variational.of(increment, self.level, self.metric, convex)
        self.first = FirstLook(self.level, self.stiffness, self.metric, self.known)

    @classmethod
    def of(cls, increment: Increment, solution: Solution, convex: bool) -> Judge:
        """That of a solution of as many points; ``convex`` as for :func:`residuals`."""
        return cls(increment, convex or not (solution.slip.any() or solution.multiplier.any()))  # to stick is to be closest

    def look(
        self,
        solution: Solution,
        out: Residuals,
        at: NDArray[np.intp] | None = None,
        threads: int | None = 1,
        then: Callable[[slice], None] | None = None,
    ) -> tuple[NDArray[np.intp], dict[int, ClosestInDigits | None]]:
        """The residuals into ``out``, which is zero; where points ``at`` are given, of these alone, and each of them closely.

        ``threads`` share the first look at all points; None for as many as there are.  ``then`` is told each block after it.  Returned
        are the points that were looked at closely, and the closest points that were looked for beside answers, by the place of each.
        """
        if at is not None and not at.size:
            return at, {}
        keep_freed_memory(len(solution.multiplier) if at is None else at.size)
        seen = dict[int, ClosestInDigits | None]()
        with np.errstate(all="ignore"):
            still, moved = self.first.left(self.increment, solution, out, threads, then) if at is None else self._sorted(solution, at)
            for some in _in_parts(still):
                seen |= self._still(some, solution.stress.take(some, axis=0), self.increment.pressure[some], solution, out)
            for some in _in_parts(moved):
                seen |= self._moved(some, self.increment.trial.take(some, axis=0), self.increment.pressure[some], solution, out)
        return np.concatenate([still, moved]), seen

    def _sorted(self, solution: Solution, at: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Those that stick and those that move."""
        away = solution.stress.take(at, axis=0) - self.increment.trial.take(at, axis=0)
        moved = (solution.multiplier[at] != 0.0) | (widest(solution.slip.take(at, axis=0)) != 0.0) | (widest(away) != 0.0)
        return at[~moved], at[moved]

    def _still(
        self, at: NDArray[np.intp], stress: Array, pressure: Array, got: Solution, out: Residuals
    ) -> dict[int, ClosestInDigits | None]:
        """The residuals of points that stick, and what was seen beside those of which a slip is lost."""
        size = power_of_two(widest(stress))
        g, hidden = self.level.bounded(stress, pressure, size)
        close, unknown = np.flatnonzero(~(np.abs(g) > hidden)), np.zeros(at.size, dtype=np.bool_)
        slope = np.full(stress.shape, np.nan)  # of those that are close, where it is little
        if close.size:
            g = g.copy()
            few = stress[close], pressure[close], size[close]
            steep = dot(np.abs(self.level.gradient(*few)), np.abs(few[0]) / few[2][:, None])
            flat = np.flatnonzero((steep < _FLAT) & (widest(few[0]) > 0.0))
            if flat.size:  # a small g is far from the boundary there, if g changes less yet
                points = as_pairs(few[0][flat], few[2][flat])
                slope[close[flat]] = close_look(self.increment).slopes(points, few[1][flat], few[2][flat])
                steep[flat] = dot(np.abs(slope[close[flat]]), np.abs(few[0][flat]) / few[2][flat][:, None])
            g[close], off = self._looked_up(*few, np.nan_to_num(steep, nan=1.0))
            unknown[close[flat]] = ~((g[close] != 0.0) | (off <= ACCURACY * steep))[flat]
        if (bare := np.flatnonzero(np.isnan(g))).size:
            g = g.copy()
            g[bare] = self.level.limit(stress[bare], pressure[bare], size[bare])
        out.feasibility[at] = np.where(np.isnan(g) | unknown, np.nan, 0.0)
        if (over := np.flatnonzero(g > 0.0)).size:  # a stick on the boundary, to rounding: a slip is lost
            plain = self.level.gradient(stress[over], pressure[over], size[over])
            slopes, point = np.where(np.isnan(slope[over]), plain, slope[over]), stress[over] / size[over, None]
            out.feasibility[at[over]] = share(g[over], dot(np.abs(slopes), np.abs(point)))
            depth = share(share(g[over], length(slopes @ self.metric.of_slip)), length(point @ self.metric.of_stress))
            out.stationarity[at[over]] = SLIP_SHARE * np.minimum(depth / LEAST_SLIP, 1.0)
        lost = np.flatnonzero((out.stationarity[at] > ACCURACY) & (out.feasibility[at] <= ACCURACY) & ~got.failed[at])
        return dict(zip(at[lost].tolist(), self._closest_beside(at[lost], got, np.zeros(lost.size), size[lost])[2], strict=True))

    def _looked_up(self, stress: Array, pressure: Array, size: Array, steep: Array | float = 1.0) -> tuple[Array, Array]:
        """g in units of the stress, as good as a double can tell, 0 where no digit of it shows, and what it is off by.

        ``steep`` is as of the close look.
        """
        value, bound = close_look(self.increment).level(as_pairs(stress, size), pressure, size, steep)
        return np.where(np.abs(value) <= bound, 0.0, value), bound

    def _moved(
        self, at: NDArray[np.intp], trial: Array, pressure: Array, got: Solution, out: Residuals
    ) -> dict[int, ClosestInDigits | None]:
        """The residuals of points that move, and what was seen beside them."""
        stress, slip = got.stress.take(at, axis=0), got.slip.take(at, axis=0)
        units = power_of_two(np.where(widest(stress) > 0.0, widest(stress), widest(trial)))
        g, hidden = self.level.bounded(stress, pressure, units)
        slope = self.level.gradient(stress, pressure, units)
        aim, point, moved = trial @ self.metric.of_stress, stress @ self.metric.of_stress, slip @ self.metric.of_slip
        size = np.maximum(widest(aim), widest(point))
        size = np.where(size > 0.0, size, 1.0)
        aim, point, moved = aim / size[:, None], point / size[:, None], moved / size[:, None]
        distance, reach = length(moved), length(point)
        whole, room = distance + reach, np.where(reach > 0.0, reach, length(aim))
        steep = length(slope @ self.metric.of_slip)
        hidden = share(share(hidden, steep) * (units / size), room)
        far = np.maximum(distance / room, 1.0)
        known = ~((hidden <= _NOISE) | (hidden * far <= _HIDDEN))
        if (looked := np.flatnonzero(known)).size:
            g, slope, steep = g.copy(), slope.copy(), steep.copy()
            g[looked], _ = self._looked_up(stress[looked], pressure[looked], units[looked])
            points = as_pairs(stress[looked], units[looked])
            slope[looked] = close_look(self.increment).slopes(points, pressure[looked], units[looked])
            steep[looked], hidden[looked] = length(slope[looked] @ self.metric.of_slip), 0.0
        multiplier = self._multiplier(got.multiplier[at], distance * size, steep, units)
        pull = (multiplier / size)[:, None] * (slope @ self.metric.of_slip)
        effort = np.sign(multiplier) * share(length(pull), whole)
        out.multiplier_sign[at] = np.maximum(-effort, 0.0)
        depth = share(np.abs(g), steep) * (units / size)
        below = share(depth, room)
        relative = share(np.abs(g), dot(np.abs(slope), np.abs(stress) / units[:, None]))
        out.feasibility[at] = np.where(g <= 0.0, 0.0, np.where(below <= ROUNDING, below, relative))
        out.complementarity[at] = share(np.minimum(distance, depth), room)
        missed = self._unbalanced(trial, stress, slip)
        gap = length(aim - moved - point)
        balance = np.maximum(share(gap, length(aim) + reach), share(widest(missed), units))
        balance = np.maximum(balance, share(length(missed @ self.metric.of_stress / size[:, None]), room))
        rounding = ROUNDING * length(np.abs(slip) @ np.abs(self.metric.of_slip) / size[:, None])
        turned = length(moved - pull)
        off = np.where(turned <= rounding, share(turned, whole), share(turned, room))  # far from K a small angle can be a long way on it
        least = np.minimum(distance, room)
        spread = self._spread(stress, pressure, units, slope, multiplier, steep * reach * size, (depth + hidden * room) / least)
        far_off = (np.fmin(below, out.feasibility[at]) > _UNKNOWN) | (out.complementarity[at] > _UNKNOWN)  # wrong, whatever is beside
        cone = turned.copy()  # the length of boundary that has the slip for a normal
        if (suspect := np.flatnonzero(~(off <= _SUSPECT))).size:
            some = suspect[~far_off[suspect]]
            lengths = moved / room[:, None], multiplier / (room * size), room * size, rounding / room, reach == 0.0
            found = off_cone(self.level, self.metric, Suspect(stress, pressure, units, *lengths).of(some))
            off[some], cone[some] = np.fmin(off[some], found), np.fmin(cone[some], _AROUND * found * room[some])
            hard = suspect[known[suspect] & (reach[suspect] > 0.0)]
            off[hard] = np.fmin(off[hard], _HIDDEN)  # it is looked for in many digits
        out.stationarity[at] = np.maximum(balance, off)
        across = np.where(reach > 0.0, (depth + hidden * room) * spread, 0.0)  # how near no stress is to the boundary is asked below
        missing = gap + across + self.metric.blur * whole
        certain = self.metric.certain
        sure = (missing + cone <= certain * least) & (out.stationarity[at] <= ACCURACY)
        passes = (missing + cone <= certain * room) & (cone <= certain * least) & (out.stationarity[at] <= ACCURACY) & (reach > 0.0)
        short = ~sure & passes & ((distance * (certain / ACCURACY) > _BLIND * room) | (not self.pieces))
        short[suspect] = False  # at a corner the end of a slip that is too long lies on a side of K, where g does not show the error
        if (some := np.flatnonzero(short)).size:  # what is left of a difference of stresses: more digits tell where the slip leads
            ends = pushed_back(trial[some], slip[some], self.stiffness, units[some])
            value, bound = close_look(self.increment).level(ends, pressure[some], units[some])
            missing[some] = share(np.abs(value) + bound, steep[some]) * (units / size)[some] * spread[some]
            sure[some] = (missing + cone)[some] <= certain * least[some]
        if (none := np.flatnonzero((reach == 0.0) & (distance > 0.0))).size:
            inside, astray = self._off_no_stress(trial[none], pressure[none], stress[none], slip[none], got.multiplier[at[none]])
            zero = np.flatnonzero(~stress[none].any(axis=1))
            inside[zero[self._nearer(trial[none[zero]], pressure[none[zero]])]] = 1.0
            out.complementarity[at[none]] = np.maximum(out.complementarity[at[none]], inside)
            out.stationarity[at[none]] = np.maximum(out.stationarity[at[none]], astray)
        out.variational[at] = self.known.excess(pressure, point, moved, size, whole, reach) + 0.0 * whole
        if not self.known.convex:
            out.variational[at] = np.fmax(out.variational[at], self.known.beside(pressure, point, moved, size, whole, room)) + 0.0 * whole
        near = ~far_off & (share(np.fmin(off * room, turned), whole) <= _CLOSE) & (share(gap, length(aim) + reach) <= _CLOSE)
        rounding_alone = (distance >= room) & (cone + across <= certain * room)  # of a long way from afar may be in doubt
        left = np.flatnonzero(~sure | (out.feasibility[at] > ACCURACY))
        unknown = np.where(rounding_alone, 0.0, _UNKNOWN)[left]
        aside = share(turned, distance)[left]
        return self._refereed(at[left], multiplier[left], aside, units[left], balance[left], near[left], unknown, got, out)

    def _refereed(
        self, at: NDArray[np.intp], multiplier: Array, aside: Array, units: Array, balance: Array, near: NDArray[np.bool_],
        unknown: Array, got: Solution, out: Residuals,
    ) -> dict[int, ClosestInDigits | None]:  # fmt: skip
        """Stationarity of points that doubles do not decide, and what is beside them.

        It is looked for, at some milliseconds a point, where the answer is ``near`` to one: elsewhere it is wrong already.
        ``unknown`` is the least residual where none is found.
        """
        given = out.stationarity[at]
        known = np.isfinite(got.stress[at]).all(axis=1) & np.isfinite(got.slip[at]).all(axis=1)
        close = known & near & ~got.failed[at]
        out.stationarity[at] = np.maximum(given, unknown)
        if not (few := np.flatnonzero(close)).size:
            return {}
        question, answer, points = self._closest_beside(at[few], got, multiplier[few], units[few])
        off = departures(question, answer, multiplier[few], aside[few], points)
        told = np.maximum(np.where(np.isnan(off), given[few], off), balance[few])
        out.feasibility[at[few]] = np.fmin(out.feasibility[at[few]], off)  # a point of K is as near as that
        out.stationarity[at[few]] = np.where(np.isinf(off), out.stationarity[at[few]], told)
        return dict(zip(at[few].tolist(), points, strict=True))

    def _closest_beside(
        self, at: NDArray[np.intp], got: Solution, multiplier: Array, units: Array
    ) -> tuple[Increment, Solution, list[ClosestInDigits | None]]:
        """The question and answer of some points, and what is beside them."""
        question, answer = self.increment.of(at), got.of(at)
        return question, answer, closest_beside(question, answer, multiplier, units)

    def _off_no_stress(self, trial: Array, pressure: Array, stress: Array, slip: Array, given: Array) -> tuple[Array, Array]:
        """How far slips beside no stress (M,) are from the boundary and from the normals of K, as shares of its size; 0 where unknown.

        It is looked at in the size of K: beside a trial far away K itself may be lost in rounding.  What is closest to a trial t is closest
        to every r t, 0 < r <= 1, where it is no stress.  So such an answer is judged once more beside a trial brought near, in units of
        each size that the data of g have: no stress is inside K by no more than rounding, and the slip along a normal that K has there.
        A point is taken for inside K where g is below zero by more than its rounding.  ``given`` are multipliers of g.
        """
        level, metric, inside, off = self.level, self.metric, np.zeros(len(trial)), np.zeros(len(trial))
        for datum, value in level.scaled.values(pressure, np.ones(len(trial))).items():
            weight = float(level.scaled.data[datum].weight)
            own = np.abs(value) ** (1.0 / weight) if weight else np.zeros(len(trial))
            at = np.flatnonzero((own > 0.0) & (own < widest(trial)))
            if not at.size:
                continue
            size = power_of_two(own[at])
            g, hidden = level.bounded(stress[at], pressure[at], size)
            steep = length(level.gradient(stress[at], pressure[at], size) @ metric.of_slip)
            way, far = unit(slip[at] @ metric.of_slip)
            reach = size * length(unit(trial[at])[0] @ metric.of_stress)
            depth = np.where(steep > 0.0, np.minimum(-g / steep * (size / reach), 1.0), 1.0)
            inside[at] = np.maximum(inside[at], np.where(g < -hidden, depth, 0.0))
            moved = way * np.minimum(far / reach, _NEAR)[:, None]
            multiplier = level.multiplier(given[at], size) / np.maximum(reach, far / _NEAR)
            tip = np.ones(at.size, dtype=np.bool_)
            there = Suspect(stress[at], pressure[at], size, moved, multiplier, reach, ROUNDING * length(moved), tip)
            off[at] = np.maximum(off[at], np.where(inside[at] > 0.0, 0.0, off_cone(level, metric, there)))
        return inside, off

    def _nearer(self, trial: Array, pressure: Array) -> NDArray[np.bool_]:
        """Whether a point of K beside no stress, on the way to the trial (M, d), is shown to be nearer to it than no stress is."""
        there = trial * (_BESIDE / widest(trial))[:, None]
        size = power_of_two(widest(there))
        g, hidden = self.level.bounded(there, pressure, size)
        found = np.zeros(len(trial), dtype=np.bool_)
        for i in np.flatnonzero(~(g > hidden)).tolist():
            found[i] = close_look(self.increment).holds(there[i], float(pressure[i]))
        return found

    def _multiplier(self, given: Array, slip: Array, steep: Array, units: Array) -> Array:
        """Multipliers of h for those of g, which at large and small stresses may be beyond doubles: there the slip's own."""
        if self.level.scaled.degree == 1.0:
            return given
        expected = slip / steep
        own = self.level.own(expected, units)
        beyond = np.where(own > 1.0, (own >= _ENDS[1]) & (given >= _ENDS[1]), (own <= _ENDS[0]) & (given >= 0.0) & (given <= _ENDS[0]))
        return np.where(beyond, expected, self.level.multiplier(given, units))

    def _spread(self, stress: Array, pressure: Array, units: Array, slope: Array, multiplier: Array, reach: Array, missing: Array) -> Array:
        """How many times as far as the boundary the closest point goes (M,), as from no stress where that tells enough.

        ``reach`` is the length of the stress times that of the slope, ``missing`` a share of the stress or of the slip, the shorter.
        Where g has kinks a flatter piece may be missed by as much as the one that holds, and no curvature tells how far it is.
        """
        height, bent = dot(slope, stress / units[:, None]) * units, bool(self.level.jets.kinks) and self.known.around_origin
        if bent:
            height = np.minimum(height, self.level.rise(pressure, units) * units)
        if (low := np.flatnonzero(~(height > LOW * reach) & self.known.around_origin)).size:
            s, way, unit = stress[low] / units[low, None], slope[low], units[low]
            room, far = length(stress[low] @ self.metric.of_stress), multiplier[low] * length(way @ self.metric.of_slip)
            height[low] = np.fmax(height[low], self.known.rise(s, way, pressure[low], unit, room, far) * unit)
        alike = np.where(height > 0.0, reach / height, np.inf) if self.known.around_origin else np.full(len(reach), np.inf)
        alike = np.where(reach > 0.0, alike, 1.0)
        if (few := np.flatnonzero(~(missing * alike <= self.metric.certain))).size:
            found = self._shifts(stress[few], pressure[few], units[few], multiplier[few])
            alike[few] = np.fmax(alike[few], found) if bent else np.where(np.isnan(found), alike[few], found)
        return np.clip(np.where(np.isnan(alike), _ENDLESS, alike), 1.0, _ENDLESS)

    def _shifts(self, stress: Array, pressure: Array, units: Array, multiplier: Array) -> Array:
        """|w| (M,), how many times as far as the boundary the closest point goes, where K is thin farther along it than across.

        Where g is off by e its boundary is e/|n| away, n = dg/dsigma, and the point of it that is closest to a trial t is |w| times as
        far away:

            sigma + lambda k n = t,  g(sigma) = e:      w = n/|n| - z,   (1 + lambda H) z = lambda H n/|n|  across n,

        H the Hessian of g, all in the metric of k.  Of all y with y . n = |n| it is w that makes y . (1 + lambda H) y least, whatever H
        is along n: so |w| <= |sigma| |n| / sigma . n where the sets {g <= e} are alike seen from no stress, as those of gauges and their
        powers are.  nan where g has no curvature.
        """
        d, of_slip = stress.shape[1], self.metric.of_slip
        normal, _ = unit(self.level.gradient(stress, pressure, units) @ of_slip)
        bend = (multiplier / units)[:, None, None] * (of_slip.T @ self.level.hessian(stress, pressure, units) @ of_slip)
        known = np.asarray(np.isfinite(bend).all(axis=(1, 2)) & np.isfinite(normal).all(axis=1))
        bend, normal = np.where(known[:, None, None], bend, 0.0), np.where(known[:, None], normal, np.eye(d)[0])
        across = np.eye(d) - normal[:, :, None] * normal[:, None, :]
        stiff = np.eye(d) + across @ bend @ across  # 1 along the normal
        aside = across @ bend @ normal[:, :, None]
        sizes = np.sqrt(np.abs(np.diagonal(stiff, axis1=1, axis2=2)))
        sizes = np.where(sizes > 0.0, sizes, 1.0)
        scaled = stiff / (sizes[:, :, None] * sizes[:, None, :])
        z = (np.linalg.pinv(scaled, rcond=1e-15, hermitian=True) @ (aside / sizes[:, :, None]))[:, :, 0] / sizes
        return np.where(known, np.hypot(1.0, length(z)), np.nan)

    def _unbalanced(self, trial: Array, stress: Array, slip: Array) -> Array:
        """trial - k slip - stress, beyond what the rounding of each explains, component by component."""
        k = self.stiffness
        missed = trial - slip @ k - stress
        return np.sign(missed) * np.maximum(np.abs(missed) - ROUNDING * (np.abs(slip) @ np.abs(k) + np.abs(trial) + np.abs(stress)), 0.0)


def _in_parts(points: NDArray[np.intp]) -> Iterator[NDArray[np.intp]]:
    """No more of them at once than the cache holds."""
    for start in range(0, points.size, _BLOCK):
        yield points[start : start + _BLOCK]


# -- which points of a block are plainly right -------------------------------------------------------------------------


_HALF = 0.5  # of a threshold of the judge
_OFF = _HALF * 1e-9  # of a stress: what rounding of g hides of the boundary, or a slip is off its normal
_SQUARES = 2.0**-900, 2.0**900  # squares of lengths that have all their digits
_MULTIPLIERS = 2.0**-1017, 2.0**1020  # well within the range of doubles
_NONE = np.empty(0, dtype=np.intp)


@dataclass(frozen=True, eq=False)
class FirstLook:
    """The law, the ``stiffness``, its metric and the ``known`` points of K."""

    level: Level
    stiffness: Array
    metric: Metric
    known: Variational

    def left(
        self, increment: Increment, solution: Solution, out: Residuals, threads: int | None = 1, then: Callable[[slice], None] | None = None
    ) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The points that stick, and those that move, of which nothing is said yet; of the others ``out`` has the residuals.

        ``out`` is all zero before; what it has of points that move and are left counts for nothing.  ``then`` is told each block that
        was looked at, while it is in the cache.
        """
        found = dict[int, tuple[NDArray[np.intp], NDArray[np.intp]]]()

        def look(block: slice) -> None:
            with np.errstate(all="ignore"):
                still, moved = self._block(increment.trial[block], increment.pressure[block], solution.of(block), out.of(block))
                found[block.start] = still + block.start, moved + block.start
            if then is not None:
                then(block)

        in_blocks(len(solution.multiplier), BLOCK, look, threads)
        stills, moves = zip(*(found[start] for start in sorted(found)), strict=True) if found else ((_NONE,), (_NONE,))
        return np.concatenate(stills), np.concatenate(moves)

    def _block(self, trial: Array, pressure: Array, got: Solution, out: Residuals) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The same of one block."""
        moved = any_of((got.stress != trial) | (got.slip != 0.0))
        moved |= got.multiplier != 0.0
        size = power_of_two(widest(got.stress))
        there = self.level.placed(got.stress, pressure, size)
        value, hidden = there.bounded()
        still = np.flatnonzero(~(moved | (value * _HALF < -hidden)))
        at = np.flatnonzero(moved)
        if not at.size:
            return still, at
        vectors = (np.ascontiguousarray(x.take(at, axis=0).T).T for x in (trial, got.stress, got.slip))  # column by column in memory
        numbers = (x.take(at) for x in (pressure, got.multiplier, size, value, hidden))
        plain = self._moved(out, at, there.of(at), *vectors, *numbers)
        return still, at[:0] if plain.all() else at[~plain]

    def _moved(
        self, out: Residuals, at: NDArray[np.intp], there: Placed, trial: Array, stress: Array, slip: Array, pressure: Array, given: Array,
        size: Array, level: Array, hidden: Array,
    ) -> NDArray[np.bool_]:  # fmt: skip
        """Whether each of the points ``at`` (M,) of a block that move is plainly right, with their residuals into ``out``.

        ``given`` are multipliers of g; ``size`` is the unit of ``there``, ``level`` h and ``hidden`` a bound of its rounding.  ``room`` and
        ``far`` are the lengths of stress and slip in the metric.
        """
        metric, slopes = self.metric, there.slopes()
        point, moved = columns_times(stress.T, metric.of_stress), columns_times(slip.T, metric.of_slip)
        normal, aim = columns_times(slopes, metric.of_slip), columns_times(trial.T, metric.of_stress)
        multiplier, (missed, plain) = self.level.multiplier(given, size), self._missed(trial, stress, slip)
        squares = room2, far2 = _squared(point), _squared(moved)
        plain &= _within(given, *_MULTIPLIERS)
        for square in squares:
            plain &= _within(square, *_SQUARES)
        room, far, height = np.sqrt(room2, out=room2), np.sqrt(far2, out=far2), dot(slopes.T, there.s.T)
        if self.level.jets.kinks:  # a piece that is as high may be flatter
            np.minimum(height, there.rise(), out=height)
        unit, value = _length(normal), np.abs(level)
        unit *= room
        if (low := np.flatnonzero(~(height * size > LOW * unit))).size:
            some = there.s.T[low], slopes.T[low], pressure[low], size[low], room[low], far[low]
            height[low] = np.fmax(height[low], self.known.rise(*some))
        plain &= (height > 0.0) & self.known.around_origin
        np.divide(size, unit, out=unit)  # of h, as a share of the stress
        depth, sunk, ratio = value * unit, hidden / height, far / room
        gap = _length(columns_times(missed, metric.of_stress))
        normal *= multiplier
        turned = _length(np.subtract(moved, normal, out=normal))
        off, rounding = room + far, turned <= (_HALF * ROUNDING) * far
        if not rounding.all():  # where it is rounding, of the whole way
            off = room + far * rounding.astype(np.float64)
        np.divide(turned, off, out=off)
        stationarity = _length(aim)
        stationarity += room
        np.divide(gap, stationarity, out=stationarity)
        np.maximum(stationarity, off, out=stationarity)
        plain &= stationarity <= _OFF
        value /= height
        value += sunk
        gap += turned
        gap /= room
        value += gap
        ways = 1.0 + ratio
        value += metric.blur * ways  # seen from no stress, as K may be thin
        most = _HALF * metric.certain
        ratio *= most
        plain &= (value <= most) & (value <= ratio)
        sunk *= ways
        plain &= sunk <= _OFF
        above = np.maximum(level, np.zeros_like(unit))
        above *= unit
        if (high := np.flatnonzero(above > _HALF * ROUNDING)).size:
            above[high] = level[high] / dot(np.abs(slopes.T[high]), np.abs(there.s.T[high]))
            plain &= ~(above > _HALF * ACCURACY)
        out.feasibility[at], out.complementarity[at], out.stationarity[at] = above, depth, stationarity
        excess = self._excess(pressure, point, moved, room, far)
        if excess is not None:
            out.variational[at] = excess
            plain &= excess <= _HALF * ACCURACY
        return plain

    def _missed(self, trial: Array, stress: Array, slip: Array) -> tuple[Array, NDArray[np.bool_]]:
        """trial - k slip - stress (d, M), and the points where all of it is rounding."""
        missed, rounding = columns_times(slip.T, self.stiffness), np.ones(len(trial), dtype=np.bool_)
        for t, moved, s in zip(trial.T, missed, stress.T, strict=True):
            np.subtract(t, moved, out=moved)
            moved -= s
            size = np.abs(t)
            size += np.abs(s)
            size *= _HALF * ROUNDING
            rounding &= np.abs(moved) <= size
        if (more := np.flatnonzero(~rounding)).size:  # where parts of k slip cancel
            whole = np.abs(slip[more]) @ np.abs(self.stiffness) + np.abs(trial[more]) + np.abs(stress[more])
            rounding[more] = (np.abs(missed.T[more]) <= (_HALF * ROUNDING) * whole).all(axis=1)
        return missed, rounding

    def _excess(self, pressure: Array, point: Array, moved: Array, room: Array, far: Array) -> Array | None:
        """The residual of the variational inequality (M,), None where it is 0 for all."""
        known = self.known

        def found(at: NDArray[np.intp] | slice, of: Callable[..., Array]) -> Array:
            return of(pressure[at], point.T[at], moved.T[at], np.ones(len(room[at])), (far + room)[at], room[at])

        few = known.beyond(pressure, point, moved)
        if known.convex and not few.size:
            return None
        excess = np.zeros(len(room))
        if few.size:
            excess[few] = found(few, known.excess)
        return excess if known.convex else np.fmax(excess, found(slice(None), known.beside))


def _squared(columns: Array) -> Array:
    """Squares of lengths (M,) of vectors (d, M)."""
    found, *others = np.square(columns)
    for square in others:
        found += square
    return np.asarray(found)


def _length(columns: Array) -> Array:
    """The same, their roots."""
    squares = _squared(columns)
    return np.sqrt(squares, out=squares)


def _within(numbers: Array, least: float, most: float) -> NDArray[np.bool_] | bool:
    """Which of them lie in a range: True where all do, as they mostly do."""
    return bool(numbers.min(initial=most) >= least and numbers.max(initial=least) <= most) or (numbers >= least) & (numbers <= most)
