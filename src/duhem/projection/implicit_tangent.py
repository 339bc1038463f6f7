"""Consistent tangents of the slip increment of any convex law, by differentiating its optimality conditions.

With n the gradients of the pieces that press, H their Hessians and lambda their multipliers,

    [k^-1 + sum lambda H   n] [d sigma ]   [d u - sum lambda d(n)/d(sigma_n) d sigma_n]
    [n^T                   0] [d lambda] = [         - dg/d(sigma_n) d sigma_n        ]

(J. C. Simo and R. L. Taylor, 1985, Comput. Methods Appl. Mech. Eng. 48, 101-118; at corners as in Simo, J. G. Kennedy and
S. Govindjee, 1988, Int. J. Numer. Methods Eng. 26, 2161-2185).  Solved in whitened stresses and on the directions that
the normals leave free, so that d sigma/d u is symmetric with eigenvalues in [0, 1] in the metric of k, rounding included.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from duhem.expression.jets import Choices, JetProgram, formula
from duhem.projection.halfspaces import HalfSpaces
from duhem.projection.increment import Increment
from duhem.projection.result import Array, Solution
from duhem.projection.whitened_body import whitening

__all__ = ["tangent"]

_SMOOTH = 1e-8  # a slip this close to the normal of one piece is normal to it
_BESIDE = 1e-6  # relative; pieces that hold this close to a corner may meet in it
_MEETS = 1e-9
_INDEPENDENT = 1e-6  # a unit normal this close to the span of others lies in it
_LITTLE = 1e-3  # of the push: sums of normals that are closer than this to the edge of their cone are on it


def tangent(increment: Increment, solution: Solution) -> tuple[Array, Array | None]:
    """d sigma/d u (N, d, d) in Pa/m, and d sigma/d sigma_n (N, d) or None for a law without pressure.

    Where the projection has no derivative (a seam in the curvature, the edge of a normal cone) it is that of the pieces
    that hold at the stress; nan at the tip of a cone, which has more normals than pieces, and where the solution failed.
    """
    n, d = solution.stress.shape
    law = increment.law
    names = (*law.force_symbols(), *([law.symbols()[law.pressure]] if law.pressure else []))
    stiffness, root = whitening(increment)
    pieces = _Pieces(formula(increment.g, names, ()), root, law.pressure is not None)
    slips = np.flatnonzero((solution.slip != 0.0).any(axis=1) & ~solution.failed)
    of_u, of_pressure = np.tile(increment.stiffness, (n, 1, 1)), np.zeros((n, d))
    of_u[slips], of_pressure[slips] = np.nan, np.nan
    point = np.concatenate([solution.stress, increment.pressure[:, None]], axis=1)[:, : len(names)]
    push = stiffness * (solution.slip @ root)  # s - u = sum lambda n, whitened
    smooth = _only_one(pieces, point[slips], push[slips])
    for at, choices, multipliers in [
        (slips[smooth], None, np.linalg.norm(push[slips[smooth]], axis=1)[:, None]),
        *(_meeting(pieces, point[i], push[i], i) for i in slips[~smooth]),
    ]:
        if at.size:
            inner, load = pieces.rates(point[at], multipliers, choices)
            half = np.sqrt(stiffness) * root
            of_u[at], of_pressure[at] = half @ inner @ half.T, load @ root.T
    of_u[solution.failed], of_pressure[solution.failed] = np.nan, np.nan
    return (of_u + np.swapaxes(of_u, 1, 2)) / 2, of_pressure if law.pressure else None


class _Pieces:
    """The smooth pieces of g and their slopes in whitened forces and, in the last place, in the pressure."""

    def __init__(self, g: JetProgram, root: Array, pressure: bool) -> None:
        self.g, self.root, self.pressure = g, root, pressure

    def at(self, point: Array, choices: Choices | None = None) -> tuple[Array, Array, Array, Array, Array, Choices]:
        """Level, unit normal, Hessian, and rates of level and normal with pressure, over the slope; and the piece."""
        jet, taken = self.g(point, (), choices)
        assert jet.gradient is not None and jet.hessian is not None
        d = len(self.root)
        with np.errstate(all="ignore"):
            normal = jet.gradient[:, :d] @ self.root
            slope = np.linalg.norm(normal, axis=1)
            bend = self.root.T @ jet.hessian[:, :d, :d] @ self.root / slope[:, None, None]
            turn = jet.hessian[:, :d, d] @ self.root if self.pressure else np.zeros_like(normal)
            rise = jet.gradient[:, d] if self.pressure else np.zeros_like(slope)
            return jet.value / slope, normal / slope[:, None], bend, rise / slope, turn / slope[:, None], taken

    def rates(self, point: Array, multipliers: Array, choices: Choices | None) -> tuple[Array, Array]:
        """d u/d s (M, d, d) and d u/d sigma_n (M, d), whitened, where J pieces press with ``multipliers`` (M, J)."""
        count, d = multipliers.shape[1], len(self.root)
        found = [self.at(point, None if choices is None else choices[:, j]) for j in range(count)]
        normal = np.stack([f[1] for f in found], axis=1)
        rise = np.stack([f[3] for f in found], axis=1)
        bend = np.eye(d) + np.einsum("nj,njab->nab", multipliers, np.stack([f[2] for f in found], axis=1))
        turn = np.einsum("nj,nja->na", multipliers, np.stack([f[4] for f in found], axis=1))
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


def _only_one(pieces: _Pieces, point: Array, push: Array) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Where the slip is normal to the piece that holds."""
    normal = pieces.at(point)[1]
    return np.asarray(np.linalg.norm(push / np.linalg.norm(push, axis=1)[:, None] - normal, axis=1) <= _SMOOTH)


def _meeting(pieces: _Pieces, point: Array, push: Array, index: int) -> tuple[Array, Choices | None, Array]:
    """The pieces that press at a corner, found around it, with their multipliers; the piece that holds if none fits."""
    d = len(pieces.root)
    ways = np.array([w for w in product((-1.0, 0.0, 1.0), repeat=d) if any(w)]) if d <= 3 else np.vstack([np.eye(d), -np.eye(d)])
    size = float(np.abs(point[:d]).max() or np.linalg.norm(push))
    beside = np.tile(point, (len(ways), 1))
    beside[:, :d] += _BESIDE * size * ways
    candidates = np.unique(pieces.at(beside)[5], axis=0)
    level, normal, *_ = pieces.at(np.tile(point, (len(candidates), 1)), candidates)
    candidates, normal = candidates[np.abs(level) <= _MEETS * size], normal[np.abs(level) <= _MEETS * size]
    cone = HalfSpaces.around(push[None] / np.linalg.norm(push))
    one = np.zeros(1, dtype=np.intp)
    placed: dict[int, int] = {}
    for j in range(len(candidates)):
        slot = cone.free_slot(one)
        placed[int(slot[0])] = j
        cone.add(one, slot, normal[j : j + 1], np.zeros(1))
    pressing = [i for i in placed if cone.active[0, i] and cone.multipliers[0, i] > 0.0]
    at = np.array([index])
    if np.linalg.norm(cone.point) > _BESIDE:  # a tip with more normals than pieces
        return at[:0], None, np.zeros((0, 1))
    multipliers = cone.multipliers[0, pressing] * np.linalg.norm(push)
    holds = [placed[i] for i in pressing]
    more = _holding_too(normal, holds, push / np.linalg.norm(push))
    return at, candidates[[*holds, *more]][None], np.append(multipliers, np.zeros(len(more)))[None]


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
