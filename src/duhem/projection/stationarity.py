"""Newton's method on the optimality conditions of a projection, on one smooth piece or where several meet.

    s - u = sum lambda_j n_j(u),   level_j(u) = 0        (u whitened, n_j unit normals of the pieces)

Every step is damped until the error falls, so that a curvature without bound (|x|^p, p < 2) does no harm.  Whether the
end of it is the projection is for the caller to check: multipliers, feasibility, and the pieces being those of K there.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from duhem.expression.jets import Choices
from duhem.projection.result import Array
from duhem.projection.row_by_row import times
from duhem.projection.whitened_body import Body, Index

__all__ = ["Stationary", "refine", "stationary"]

_HALVINGS = 6
_PROGRESS = 0.9  # a step that leaves more of the error is the last: there is a kink in the way


@dataclass(frozen=True)
class Stationary:
    """How far the points ``x`` (M, d) are from stationary, with the best multipliers (M, J) for the normals there.

    ``away`` (M,) = |s - u|; ``turn`` (M,) = |s - u - sum lambda n| / (1 + |s - u|); ``level`` (M, J) distances to the pieces.
    """

    x: Array
    multiplier: Array
    normal: Array
    curvature: Array
    slope: Array
    level: Array
    rest: Array
    away: Array
    choices: Any

    @property
    def turn(self) -> Array:
        return np.linalg.norm(self.rest, axis=1) / (1.0 + self.away)

    @property
    def error(self) -> Array:
        """One number to bring down; never nan."""
        found = np.hypot(self.turn, np.max(np.abs(self.level), axis=1))
        return np.where(np.isnan(found), np.inf, found)

    def put(self, where: Index, other: Stationary) -> None:
        """Overwrite the points ``where``."""
        for f in fields(self):
            getattr(self, f.name)[where] = getattr(other, f.name)

    def take(self, where: Any) -> Stationary:
        """The points ``where``."""
        return Stationary(*(getattr(self, f.name)[where] for f in fields(self)))


def stationary(body: Body, trial: Array, x: Array, at: Index, choices: Choices | None) -> Stationary:
    """The state at ``x`` (M, d); ``trial`` (M, d) whitened; ``choices`` (M, J, kinks) names the pieces, None the one that holds."""
    count = 1 if choices is None else choices.shape[1]
    pieces = [body.piece(x, at, None if choices is None else choices[:, j]) for j in range(count)]
    normal = np.stack([p.normal for p in pieces], axis=1)
    away = trial - body.whitened(x)
    with np.errstate(all="ignore"):
        multiplier = np.einsum("nd,njd->nj", away, normal)
        if count > 1:
            known = np.where(np.isfinite(normal), normal, 0.0)
            multiplier = np.einsum("ndj,nd->nj", np.linalg.pinv(known, rcond=1e-13), away)
        rest = away - np.einsum("nj,njd->nd", multiplier, normal)
    return Stationary(
        x.copy(),
        multiplier,
        normal,
        np.stack([p.curvature for p in pieces], axis=1),
        np.stack([p.slope for p in pieces], axis=1),
        np.stack([p.level for p in pieces], axis=1),
        rest,
        np.linalg.norm(away, axis=1),
        np.stack([p.choices for p in pieces], axis=1),
    )


def refine(body: Body, trial: Array, x: Array, at: Index, choices: Choices | None = None, steps: int = 15) -> Stationary:
    """Damped Newton from ``x`` until nothing improves, at most ``steps`` times; the best state of each point."""
    best = stationary(body, trial, x, at, choices)
    who = np.flatnonzero(np.isfinite(best.error))
    for _ in range(steps):
        who = who[best.error[who] > 1e-17]
        if not who.size:
            break
        step = times(_newton_step(best.take(who)), body.root.T)
        sound = np.all(np.isfinite(step), axis=1)
        who, step = who[sound], step[sound]
        before = best.error[who]
        left, share = np.arange(len(who)), 1.0
        for _ in range(_HALVINGS):
            if not left.size:
                break
            these = who[left]
            found = stationary(
                body, trial[these], best.x[these] + share * step[left], at[these], None if choices is None else choices[these]
            )
            better = found.error < best.error[these]
            best.put(these[better], found.take(better))
            settled = best.error[these] < 1e-14  # what does not improve here is rounding
            left, share = left[~better & ~settled], share * (0.5 if share > 0.2 else 0.1)
        who = who[best.error[who] < _PROGRESS * before]
    return best


def _newton_step(state: Stationary) -> Array:
    m, j, d = state.normal.shape
    with np.errstate(all="ignore"):
        matrix = np.zeros((m, d + j, d + j))
        matrix[:, :d, :d] = np.eye(d) + np.einsum("nj,njab->nab", np.maximum(state.multiplier, 0.0), state.curvature)
        matrix[:, :d, d:] = np.swapaxes(state.normal, 1, 2) * (1.0 + state.away)[:, None, None]  # multipliers in their own size
        matrix[:, d:, :d] = state.normal
        matrix[:, d:, d:] = -1e-14 * np.eye(j)
        right = np.concatenate([state.rest, -state.level], axis=1)
        size = np.maximum(np.max(np.abs(matrix), axis=2), 1e-300)  # rows of one size
        matrix, right = matrix / size[:, :, None], right / size
        sound = np.all(np.isfinite(matrix), axis=(1, 2)) & np.all(np.isfinite(right), axis=1)
        step = np.full((m, d), np.nan)
        if sound.any():
            step[sound] = _solved(matrix[sound], right[sound])[:, :d]
    return step


def _solved(matrix: Array, right: Array) -> Array:
    try:
        return np.asarray(np.linalg.solve(matrix, right[:, :, None])[:, :, 0])
    except np.linalg.LinAlgError:  # one of them is singular: least squares for that one
        if len(matrix) > 1:
            return np.concatenate([_solved(matrix[i : i + 1], right[i : i + 1]) for i in range(len(matrix))])
        return np.asarray(np.einsum("nab,nb->na", np.linalg.pinv(matrix), right))
