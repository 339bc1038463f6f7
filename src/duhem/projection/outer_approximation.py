"""The nearest point of an intersection of half-spaces, for many points at once, when half-spaces are added one by one.

    u = argmin |s - u|  subject to  n_i . u <= beta_i,      s - u = sum mu_i n_i,  mu_i >= 0 on the active ones

The dual active-set method of D. Goldfarb and A. Idnani (1983), Math. Program. 27, 1-33: a violated half-space enters,
those whose multiplier would turn negative leave on the way, and |s - u| never decreases.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array

__all__ = ["HalfSpaces"]

_PARALLEL = 1e-10  # a normal this close to the span of the active ones counts as lying in it


@dataclass
class HalfSpaces:
    """Slots of half-spaces for N points: ``normals`` (N, m, d), ``offsets`` and ``multipliers`` (N, m); nearest ``point`` (N, d).

    ``held`` marks slots in use, ``active`` those that press on the point.  A work area of one solve, changed in place.
    """

    point: Array
    normals: Array
    offsets: Array
    multipliers: Array
    held: NDArray[np.bool_]
    active: NDArray[np.bool_]

    @classmethod
    def around(cls, points: Array) -> HalfSpaces:
        """No half-space yet: the nearest point is ``points`` (N, d) itself."""
        n, d = points.shape
        m = 2 * d + 2
        off = np.zeros((n, m), dtype=bool)
        return cls(points.copy(), np.zeros((n, m, d)), np.zeros((n, m)), np.zeros((n, m)), off, off.copy())

    def free_slot(self, who: NDArray[np.intp]) -> NDArray[np.intp]:
        """A slot for a new half-space: an empty one, or else the inactive one farthest from the point."""
        slack = self.offsets[who] - np.einsum("nmd,nd->nm", self.normals[who], self.point[who])
        worth = np.where(self.active[who], -np.inf, np.where(self.held[who], slack, np.inf))
        return np.asarray(np.argmax(worth, axis=1), dtype=np.intp)

    def add(self, who: NDArray[np.intp], slot: NDArray[np.intp], normals: Array, offsets: Array) -> None:
        """Put a half-space into ``slot`` of the points ``who`` and move their nearest points."""
        self.normals[who, slot], self.offsets[who, slot] = normals, offsets
        self.multipliers[who, slot], self.held[who, slot], self.active[who, slot] = 0.0, True, False
        self._drive_out(who)
        self._settle(who)

    def _drive_out(self, who: NDArray[np.intp]) -> None:
        for _ in range(6 * self.normals.shape[1]):
            gap = np.einsum("nmd,nd->nm", self.normals[who], self.point[who]) - self.offsets[who]
            gap = np.where(self.held[who] & ~self.active[who], gap, -np.inf)
            entering = np.argmax(gap, axis=1)
            size = 1.0 + np.linalg.norm(self.point[who], axis=1)
            violated = gap[np.arange(len(who)), entering] > 1e-16 * size
            who, entering = who[violated], entering[violated]
            if not who.size:
                return
            self._enter(who, entering)

    def _settle(self, who: NDArray[np.intp]) -> None:
        """Bring the point back onto the active planes: far trial points leave rounding of their own size on it."""
        pressing = self.normals[who] * self.active[who][:, :, None]
        gap = np.where(self.active[who], self.offsets[who] - np.einsum("nmd,nd->nm", pressing, self.point[who]), 0.0)
        self.point[who] += np.einsum("ndm,nm->nd", np.linalg.pinv(pressing, rcond=1e-13), gap)

    def _enter(self, who: NDArray[np.intp], entering: NDArray[np.intp]) -> None:
        fresh = np.zeros(len(who))  # the multiplier of the entering half-space
        for _ in range(self.normals.shape[1] + 1):
            active = self.active[who]
            normal = self.normals[who, entering]
            spread = np.linalg.pinv(np.swapaxes(self.normals[who] * active[:, :, None], 1, 2), rcond=1e-13)  # (n, m, d)
            shares = np.where(active, np.einsum("nmd,nd->nm", spread, normal), 0.0)
            rest = normal - np.einsum("nm,nmd->nd", shares, self.normals[who])
            square = np.einsum("nd,nd->n", rest, rest)
            gap = np.einsum("nd,nd->n", normal, self.point[who]) - self.offsets[who, entering]
            with np.errstate(all="ignore"):
                full = np.where(square > _PARALLEL**2, np.maximum(gap, 0.0) / square, np.inf)
                limits = np.where(active & (shares > 0), self.multipliers[who] / shares, np.inf)
            leaving = np.argmin(limits, axis=1)
            most = limits[np.arange(len(who)), leaving]
            step = np.minimum(full, most)
            stuck = ~np.isfinite(step)
            step = np.where(stuck, 0.0, step)
            self.multipliers[who] = np.where(active, np.maximum(self.multipliers[who] - step[:, None] * shares, 0.0), 0.0)
            fresh += step
            self.point[who] -= np.where(square > _PARALLEL**2, step, 0.0)[:, None] * rest
            done = full <= most
            entered = done & ~stuck
            self.active[who[entered], entering[entered]] = True
            self.multipliers[who[entered], entering[entered]] = fresh[entered]
            drop = ~done & ~stuck
            self.active[who[drop], leaving[drop]] = False
            self.multipliers[who[drop], leaving[drop]] = 0.0
            self.held[who[stuck], entering[stuck]] = False  # parallel to what is there, to rounding: says nothing new
            who, entering, fresh = who[drop], entering[drop], fresh[drop]
            if not who.size:
                return
