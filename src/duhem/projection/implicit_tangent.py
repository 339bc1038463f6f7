"""Consistent tangents of the slip increment of any convex law, by differentiating its optimality conditions.

With n the gradients of the pieces that press, H their Hessians and lambda their multipliers,

    [k^-1 + sum lambda H   n] [d sigma ]   [d u - sum lambda d(n)/d(sigma_n) d sigma_n]
    [n^T                   0] [d lambda] = [         - dg/d(sigma_n) d sigma_n        ]

(J. C. Simo and R. L. Taylor, 1985, Comput. Methods Appl. Mech. Eng. 48, 101-118; at corners as in Simo, J. G. Kennedy and
S. Govindjee, 1988, Int. J. Numer. Methods Eng. 26, 2161-2185).  Solved in whitened stresses and on the directions that
the normals leave free, so that d sigma/d u is symmetric with eigenvalues in [0, 1] in the metric of k, rounding included.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import chain, product

import numpy as np
from numpy.typing import NDArray

from duhem.expression import Where
from duhem.expression.jets import Choices, JetProgram, formula
from duhem.projection.half_spaces import HalfSpaces
from duhem.projection.increment import Increment
from duhem.projection.result import Array, Pointwise, Solution
from duhem.projection.row_by_row import length as lengths
from duhem.projection.whitened_body import whitening

__all__ = ["tangent"]

_SMOOTH = 1e-8  # a slip this close to the normal of one piece is normal to it, if no other piece is there
_ALONG = 1e-11  # closer, what is left is rounding
_BESIDE = 1e-6  # relative; pieces that hold this close to a corner may meet in it, and normals this close to a tip are its own
_MEETS = 1e-9
_INDEPENDENT = 1e-6  # a unit normal this close to the span of others lies in it
_APART = 1e-4  # least singular value of unit normals that are independent at the point too: they are taken _BESIDE it
_OTHER_WAYS = 8  # a force
_TILT = 0.05
_HARDLY = 1e-5
_AT_ONCE = 256  # corners, around each of which some dozens of points are looked at
_LITTLE = 1e-3  # of the push: sums of normals that are closer than this to the edge of their cone are on it


@np.errstate(all="ignore")  # squares of numbers near the ends of the range; what has no value is nan
def tangent(increment: Increment, solution: Solution) -> tuple[Array, Array | None]:
    """d sigma/d u (N, d, d) in Pa/m, and d sigma/d sigma_n (N, d) or None for a law without pressure.

    Where the projection has no derivative (a seam in the curvature, the edge of a normal cone) it is that of the pieces
    that hold at the stress; nan where more normals meet than there are pieces (a tip whose cone of normals has the push on its
    edge, an edge of equal eigenvalues), where a curvature is infinite, and where the solution failed.

    A K without inner points, as at sigma_n = 0 for most laws, has the tangent 0 where it is a point, trials that stick there
    included; nan where the pieces found do not tell how it lies.  With the pressure it opens on one side only: d sigma/d sigma_n is of
    that side, and nan where the pieces that press do not tell it (round boundaries, more than one sum of normals).
    """
    n, d = solution.stress.shape
    law = increment.law
    names = (*law.force_symbols(), *filter(None, (increment.pressure_symbol,)))
    stiffness, root = whitening(increment)
    pieces = _Pieces(formula(increment.g, names, (), strict=True), root, law.pressure is not None)
    slips = np.flatnonzero((solution.slip != 0.0).any(axis=1) & ~solution.failed)
    of_u, of_pressure = np.tile(increment.stiffness, (n, 1, 1)), np.zeros((n, d))
    of_u[slips], of_pressure[slips] = np.nan, np.nan
    point = np.concatenate([solution.stress, increment.pressure[:, None]], axis=1)[:, : len(names)]
    push = stiffness * (solution.slip @ root)  # s - u = sum lambda n, whitened
    length = lengths(push)
    there = pieces.at(point[slips])
    off = np.linalg.norm(push[slips] / length[slips, None] - there.normal, axis=1)
    along = off <= (_ALONG if there.choices.shape[1] else _SMOOTH)
    smooth = along & np.isfinite(there.bend).all(axis=(1, 2))
    smooth[smooth] = pieces.open_behind(point[slips[smooth]], there.of(smooth).normal, length[slips[smooth]])
    if increment.g.has(Where):
        smooth[smooth] = _holds_beside(pieces, point[slips[smooth]])
    alone = there.of(smooth)
    half = np.sqrt(stiffness) * root
    rates = _rates(alone.normal[:, None], alone.rise[:, None], *alone.weighted(length[slips[smooth]]))
    corners = slips[~smooth]
    for at, found in chain([(slips[smooth], rates)], zip(corners, _at_corners(pieces, point[corners], push[corners]), strict=True)):
        if found is not None:
            of_u[at], of_pressure[at] = half @ found[0] @ half.T, found[1] @ root.T
    if (stuck := np.flatnonzero(~solution.failed & (length == 0.0))).size:
        _held_without_slip(pieces, point, stuck, of_u)
    of_u[solution.failed], of_pressure[solution.failed] = np.nan, np.nan
    return (of_u + np.swapaxes(of_u, 1, 2)) / 2, of_pressure if law.pressure else None


@dataclass(frozen=True)
class _Normals(Pointwise):
    """Of M pieces, over their slopes and whitened: level (M,), normal (M, d), Hessian, rates of level and normal with pressure."""

    level: Array
    normal: Array
    bend: Array
    rise: Array
    turn: Array
    choices: Choices

    def weighted(self, multipliers: Array) -> tuple[Array, Array]:
        """lambda H (M, d, d) and lambda dn/d(sigma_n) (M, d)."""
        return multipliers[:, None, None] * self.bend, multipliers[:, None] * self.turn


class _Pieces:
    """The smooth pieces of g and their slopes in whitened forces and, in the last place, in the pressure."""

    def __init__(self, g: JetProgram, root: Array, pressure: bool) -> None:
        self.g, self.root, self.pressure = g, root, pressure

    def at(self, point: Array, choices: Choices | None = None) -> _Normals:
        """Those that hold at the points, or those that ``choices`` name."""
        jet, taken = self.g(point, (), choices)
        assert jet.gradient is not None and jet.hessian is not None
        d = len(self.root)
        with np.errstate(all="ignore"):
            normal = jet.gradient[:, :d] @ self.root
            slope = lengths(normal)
            bend = self.root.T @ jet.hessian[:, :d, :d] @ self.root / slope[:, None, None]
            turn = jet.hessian[:, :d, d] @ self.root if self.pressure else np.zeros_like(normal)
            rise = jet.gradient[:, d] if self.pressure else np.zeros_like(slope)
            return _Normals(jet.value / slope, normal / slope[:, None], bend, rise / slope, turn / slope[:, None], taken)

    def open_behind(self, point: Array, normal: Array, push: Array) -> NDArray[np.bool_]:
        """Whether the inside of K is met next to the points (M,), against their normals: a K that has none has more normals there."""
        d, found = len(self.root), np.zeros(len(point), dtype=np.bool_)
        size = np.abs(point[:, :d]).max(axis=1, initial=0.0)
        size = np.where(size > 0.0, size, push)
        for step in (_BESIDE, _MEETS):
            left = np.flatnonzero(~found)
            inside = point[left]
            inside[:, :d] -= (step * size[left])[:, None] * (normal[left] @ self.root.T)
            found[left] = self.g(inside, (), None, False)[0].value < 0.0
        return found

    def reach(self, point: Array, inner: Array, step: float) -> bool:
        """Whether the stress can follow (d, d) from the point, one way or the other, and stay in K."""
        d = len(self.root)
        if not np.isfinite(inner).all():
            return False
        vectors, shares, _ = np.linalg.svd(inner)
        ways = vectors[:, shares > _SMOOTH].T @ self.root.T
        beside = np.tile(point, (2 * len(ways), 1))
        beside[:, :d] += step * np.vstack([ways, -ways])
        with np.errstate(all="ignore"):
            jet = self.g(beside, (), None, False)[0]
            assert jet.gradient is not None
            out = jet.value > _LITTLE * step * np.linalg.norm(jet.gradient[:, :d] @ self.root, axis=1)
        return not (out[: len(ways)] & out[len(ways) :]).any()


def _rates(normal: Array, rise: Array, bend: Array, turn: Array) -> tuple[Array, Array]:
    """d u/d s (M, d, d) and d u/d sigma_n (M, d), whitened, where J pieces press with normals (M, J, d), rates of level ``rise`` (M, J).

    ``bend`` (M, d, d) and ``turn`` (M, d) are the sums of their Hessians and of their normals' rates, times their multipliers.
    """
    count, d = normal.shape[1:]
    bend = np.eye(d) + bend
    free = np.linalg.svd(normal, full_matrices=True)[2][:, count:]  # (M, d - J, d)
    along = np.swapaxes(free, 1, 2)
    inner = along @ _inverse(free @ bend @ along) @ free
    across = -np.einsum("ndj,nj->nd", np.linalg.pinv(normal), rise)
    load = across - np.einsum("nab,nb->na", inner, turn + np.einsum("nab,nb->na", bend, across))
    return inner, load


def _inverse(bend: Array) -> Array:
    """Of 1 + a Hessian that is positive semidefinite where K is convex, up to rounding: no eigenvalue is below 1."""
    sound = np.asarray(np.isfinite(bend).all(axis=(1, 2), keepdims=True))
    values, vectors = np.linalg.eigh(np.where(sound, bend, 0.0))
    inverse = (vectors / np.maximum(values, 1.0)[:, None, :]) @ np.swapaxes(vectors, 1, 2)
    return np.where(sound, inverse, np.nan)


def _holds_beside(pieces: _Pieces, point: Array) -> NDArray[np.bool_]:
    """Whether the piece that holds at the point holds anywhere beside it (M,): a choice may give the value at a tip by itself."""
    d = len(pieces.root)
    here, found = pieces.at(point).choices, np.zeros(len(point), dtype=np.bool_)
    size = np.abs(point[:, :d]).max(axis=1, initial=0.0, keepdims=True)
    for way in _ways(d):
        beside = point.copy()
        beside[:, :d] += _BESIDE * size * way
        found |= (pieces.at(beside).choices == here).all(axis=1)
    return found


def _at_corners(pieces: _Pieces, point: Array, push: Array) -> Iterator[tuple[Array, Array] | None]:
    """d u/d s (d, d) and d u/d sigma_n (d,) where several normals meet, looked for around each point; None if they do not tell."""
    d = len(pieces.root)
    ways, size = _ways(d), np.abs(point[:, :d]).max(axis=1, initial=0.0)
    size = np.where(size > 0.0, size, lengths(push))
    many = len(ways)
    for first in range(0, len(point), _AT_ONCE):
        some = np.arange(first, min(first + _AT_ONCE, len(point)))
        beside = np.repeat(point[some], many, axis=0)
        beside[:, :d] += _BESIDE * np.repeat(size[some], many)[:, None] * np.tile(ways, (len(some), 1))
        around = pieces.at(beside)
        choices = [np.unique(around.choices[many * i : many * (i + 1)], axis=0) for i in range(len(some))]
        counts = [len(each) for each in choices]
        there = pieces.at(np.repeat(point[some], counts, axis=0), np.concatenate(choices))
        for i, last in enumerate(np.cumsum(counts).tolist()):
            here = there.of(slice(last - counts[i], last))
            found = _at_corner(here, around.of(slice(many * i, many * (i + 1))), push[some[i]], float(size[some[i]]))
            told = found is not None and (not found[0].any() or pieces.reach(point[some[i]], found[0], _BESIDE * float(size[some[i]])))
            yield found if told else None


def _at_corner(there: _Normals, around: _Normals, push: Array, size: float) -> tuple[Array, Array] | None:
    """Of the pieces found around a point, continued to it: smooth pieces meet, or all normals beside it are those of a tip, which stays."""
    d, length = len(push), float(lengths(push[None])[0])
    meeting = there.of((np.abs(there.level) <= _MEETS * size) & np.isfinite(there.bend).all(axis=(1, 2)))
    tip = around.of(np.isfinite(around.normal).all(axis=1))
    for normals, few in ((meeting, True), (tip, False)):
        found = _pressing(normals.normal, push / length)
        if found is not None and (few or (len(found[0]) == d and _is_tip(normals.normal, found[0], push / length))):
            press = normals.of(found[0])
            bend, turn = press.weighted(found[1] * length) if few else (np.zeros((1, d, d)), np.zeros((1, d)))
            inner, load = _rates(press.normal[None], press.rise[None], bend.sum(axis=0)[None], turn.sum(axis=0)[None])
            return inner[0], load[0] if _followed(normals, load[0], few and bool(found[1].all())) else np.full(d, np.nan)
    return None


def _is_tip(normals: Array, pressing: NDArray[np.intp], way: Array) -> bool:
    """Whether the d ``pressing`` normals are independent at the point too, beside which the axes of equal eigenvalues turn.

    A tip has more normals than these d if the push, turned a little to any side, is still a sum of all normals.
    """
    if np.linalg.svd(normals[pressing])[1][-1] > _APART:
        return True
    return all(_is_sum(way + side, normals) for side in _LITTLE * np.vstack([np.eye(len(way)), -np.eye(len(way))]))


def _followed(normals: _Normals, load: Array, told: bool) -> bool:
    """Whether ``load`` (d,) is the rate of the stress with the pressure: of a K without inner points if the pieces have ``told`` it, each
    by a share of its own, and none of the others is left as the pressure falls."""
    if not _without_inside(normals.normal):
        return True
    rate = normals.normal @ load + normals.rise
    return told and bool((rate >= -_SMOOTH * (1.0 + np.abs(normals.rise))).all())


def _without_inside(normals: Array) -> bool:
    """Whether a sum of the normals, none with a negative share, is none: no point is inside of all half-spaces."""
    from scipy.optimize import nnls

    if not np.isfinite(normals).all():
        return False
    system = np.vstack([normals.T, np.ones(len(normals))])
    return bool(nnls(system, np.append(np.zeros(normals.shape[1]), 1.0))[1] <= _SMOOTH)


def _held_without_slip(pieces: _Pieces, point: Array, at: NDArray[np.intp], of_u: Array) -> None:
    """Trials on a K without inner points: where it is a point they stay, so that ``of_u`` is 0; else nan, as nothing presses."""
    d = len(pieces.root)
    at = at[pieces.g(point[at], (), None, False)[0].value >= 0.0]
    ways, sides = _ways(d), np.vstack([np.eye(d), -np.eye(d)])
    places, which = np.unique(point[at], axis=0, return_inverse=True)
    for i, place in enumerate(places):
        size = float(np.abs(place[:d]).max(initial=0.0)) or float(np.abs(place).max(initial=0.0)) or 1.0
        beside = np.tile(place, (len(ways), 1))
        beside[:, :d] += _BESIDE * size * ways
        around = pieces.at(beside)
        normals = around.normal[np.isfinite(around.normal).all(axis=1)]
        if (around.level < 0.0).any() or not len(normals) or not _without_inside(normals):
            continue
        held = all(_is_sum(side, normals) for side in sides)
        of_u[at[which.ravel() == i]] = 0.0 if held else np.nan


@cache
def _ways(d: int) -> Array:
    """Directions (M, d) beside the axes and, for few forces, the diagonals, and others: none lies on a plane of symmetry."""
    regular = np.array([w for w in product((-1.0, 0.0, 1.0), repeat=d) if any(w)]) if d <= 3 else np.vstack([np.eye(d), -np.eye(d)])
    other = np.random.default_rng(0).standard_normal((len(regular) + _OTHER_WAYS * d, d))
    other[: len(regular)] = regular + _TILT * other[: len(regular)]
    axes = np.vstack([np.eye(d), -np.eye(d)])  # a thin K shows some sides close to an axis alone
    other = np.vstack([other, axes + _HARDLY * other[-len(axes) :]])
    return np.asarray(other / np.linalg.norm(other, axis=1)[:, None])


def _pressing(normals: Array, push: Array) -> tuple[NDArray[np.intp], Array] | None:
    """Which normals the push is a sum of, with their shares; and those with share 0 that hold too; None if it is no sum."""
    cone = HalfSpaces.around(push[None])
    one = np.zeros(1, dtype=np.intp)
    placed: dict[int, int] = {}
    for j in range(len(normals)):
        slot = cone.free_slot(one)
        placed[int(slot[0])] = j
        cone.add(one, slot, normals[j : j + 1], np.zeros(1))
    if np.linalg.norm(cone.point) > _BESIDE:
        return None
    slots = [i for i in placed if cone.active[0, i] and cone.multipliers[0, i] > 0.0]
    holds = [placed[i] for i in slots]
    more = _holding_too(normals, holds, push)
    return np.array([*holds, *more], dtype=np.intp), np.append(cone.multipliers[0, slots], np.zeros(len(more)))


def _holding_too(normals: Array, pressing: list[int], push: Array) -> list[int]:
    """Pieces that hold the stress as well, independent of the ``pressing``, where the push is more than one sum of normals.

    A push along the axis of a pyramid is the sum of two opposite normals, and the tip stays under all four of them: those are
    meant without which, a little of it taken off, the push is still a sum.
    """
    held, more = list(pressing), list[int]()
    for j in range(len(normals)):
        basis = np.linalg.qr(normals[held].T)[0]
        rest = normals[j] - basis @ (basis.T @ normals[j])
        if j not in held and np.linalg.norm(rest) > _INDEPENDENT and _is_sum(push - _LITTLE * normals[j], normals):
            held.append(j)
            more.append(j)
    return more


def _is_sum(push: Array, normals: Array) -> bool:
    """Whether the push is a sum of normals, none of them with a negative share."""
    cone, one = HalfSpaces.around(push[None]), np.zeros(1, dtype=np.intp)
    for normal in normals:
        cone.add(one, cone.free_slot(one), normal[None], np.zeros(1))
    return bool(np.linalg.norm(cone.point) <= _SMOOTH)
