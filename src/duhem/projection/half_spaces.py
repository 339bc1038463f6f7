"""The closest point of an intersection of half-spaces: every set of faces is tried, or half-spaces are added one by one.

The first is for a K that planes bound, as the greatest of affine functions.

With s in K = {s : N s <= o} the closest point to t in the metric of k^-1 is s = t - k N_S^T w for the faces S that press on it, where
N_S s = o_S and w >= 0 (the conditions of Karush, Kuhn and Tucker, which for a convex K are enough).  A law has few faces, so the sets
of at most d of them are few, and each is tried on all points that are left at once, the smallest first.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, product
from math import comb, prod

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.numpy_ import Program, compiled
from duhem.expression.vocabulary import Neg, Pos
from duhem.projection.increment import ROUNDING, Increment
from duhem.projection.result import Array
from duhem.projection.row_by_row import products, times

__all__ = ["Faces", "HalfSpaces", "faces", "planes"]

_MOST_FACES = 200
_MOST_SETS = 1200  # more take longer than a search
_INDEPENDENT = 1e-10  # the least eigenvalue of the products of unit normals


@dataclass(frozen=True, eq=False)
class Faces:
    """K = {sigma : normals sigma <= offsets}: ``normals`` (m, d), ``offsets`` a program each, over what the law has beside its forces."""

    normals: Array
    offsets: tuple[Program, ...]

    def at(self, given: Sequence[Array], count: int) -> Array:
        """The offsets (count, m) at one array of each of the law's other numbers."""
        return np.stack([np.broadcast_to(offset(*given), (count,)) for offset in self.offsets], axis=1)

    def closest(self, trial: Array, offsets: Array, stiffness: Array) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
        """Stress (N, d), slip (N, d), multiplier (N,) and where they were ``found``, of ``trial`` stresses (N, d) outside K."""
        stress, slip, multiplier, left = trial.copy(), np.zeros_like(trial), np.zeros(len(trial)), np.arange(len(trial))
        for chosen, root, pushed, along in _sets(self.normals.tobytes(), stiffness.tobytes(), trial.shape[1]):
            if not left.size:
                break
            normals, t, o = self.normals[chosen], trial[left], offsets[left]
            weights = products(times(products(t, normals) - o[:, chosen], root), root)
            s = times(t, along) + times(o[:, chosen], pushed)
            s -= times(products(s, normals) - o[:, chosen], pushed)  # what rounding left of the way to the faces
            beyond, sizes = products(s, self.normals) - o, products(np.abs(s), np.abs(self.normals)) + np.abs(o)
            right = (beyond <= ROUNDING * sizes).all(axis=1) & (weights > 0.0).all(axis=1)
            done = left[right]
            stress[done], slip[done] = s[right], times(weights[right], normals)
            multiplier[done] = times(weights[right], np.ones((len(chosen), 1)))[:, 0]
            left = left[~right]
        found = np.ones(len(trial), dtype=np.bool_)
        found[left] = False
        return stress, slip, multiplier, found


@lru_cache(maxsize=64)
def _sets(normals: bytes, stiffness: bytes, d: int) -> tuple[tuple[list[int], Array, Array, Array], ...]:
    """The sets S of independent faces, each with ``root``, ``pushed`` and ``along``.

    G = (N_S k N_S^T)^-1 = root root^T makes weights of distances, G N_S k stresses of offsets, and 1 - N_S^T G N_S k takes a trial along
    the faces.  With k = L L^T and L^T N_S^T = Q R, root = R^-1: of an inverse of N_S k N_S^T, whose condition is that of R squared,
    half the digits would be left.
    """
    n, k = np.frombuffer(normals).reshape(-1, d), np.frombuffer(stiffness).reshape(d, d)
    lower = np.linalg.cholesky(k)

    def each() -> Iterator[tuple[list[int], Array, Array, Array]]:
        for count in range(1, d + 1):
            for chosen in map(list, combinations(range(len(n)), count)):
                gram = n[chosen] @ k @ n[chosen].T
                size = np.sqrt(np.diagonal(gram))
                if (size > 0.0).all() and np.linalg.eigvalsh(gram / np.outer(size, size))[0] > _INDEPENDENT:
                    across, upper = np.linalg.qr(lower.T @ n[chosen].T)
                    root = np.linalg.inv(upper)
                    pushed = np.asarray(root @ across.T @ lower.T if count < d else np.linalg.inv(n[chosen]).T, dtype=np.float64)
                    yield chosen, root, pushed, np.eye(d) - n[chosen].T @ pushed if count < d else np.zeros((d, d))

    return tuple(each())


@lru_cache(maxsize=64)
def faces(g: sp.Expr, forces: tuple[sp.Symbol, ...], others: tuple[sp.Symbol, ...]) -> Faces | None:
    """The planes where ``g`` is the greatest of affine functions of the ``forces``, written as such, with numbers for slopes; else None."""
    pieces = _pieces(g, set(forces), 1)
    if pieces is None or sum(comb(len(pieces), count) for count in range(1, len(forces) + 1)) > _MOST_SETS:
        return None
    slopes = [[sp.diff(piece, f) for f in forces] for piece in pieces]
    if not all(c.is_number for row in slopes for c in row):
        return None
    heights = [compiled(-piece.xreplace(dict.fromkeys(forces, sp.S.Zero)), others) for piece in pieces]
    return Faces(np.array(slopes, dtype=np.float64), tuple(heights))


def planes(question: Increment) -> tuple[Array, Array] | None:
    """K = {sigma : normals sigma <= offsets} of some increments, normals (m, d) and offsets (N, m); None where ``faces`` tells none."""
    law = question.law
    found = faces(question.g, law.force_symbols(), (law.symbols()[law.pressure],) if law.pressure else ())
    return None if found is None else (found.normals, found.at([question.pressure] if law.pressure else [], len(question.trial)))


def _pieces(g: sp.Expr, forces: set[sp.Symbol], sense: int) -> list[sp.Expr] | None:
    """Affine functions of which ``g`` is the greatest, or for the ``sense`` -1 the least; None where its form does not tell."""
    if not g.free_symbols & forces:
        return [g]
    if g.is_Symbol:
        return [g]
    match g:
        case sp.Max() | sp.Min() if isinstance(g, sp.Max if sense > 0 else sp.Min):
            return _joined(_pieces(part, forces, sense) for part in g.args)
        case sp.Abs() | Pos() | Neg() if sense > 0:
            inner = _pieces(g.args[0], forces, sense)
            ends = {sp.Abs: (1, -1), Pos: (1, 0), Neg: (-1, 0)}[type(g)]
            return None if inner is None or len(inner) > 1 else [end * inner[0] for end in ends]
        case sp.Add():
            terms = [_pieces(part, forces, sense) for part in g.args]
            sizes = [len(part) for part in terms if part is not None]
            if None in terms or prod(sizes) > _MOST_FACES:
                return None
            return list(dict.fromkeys(sp.Add(*choice) for choice in product(*terms)))  # type: ignore[arg-type]
        case sp.Mul():
            factor, rest = g.as_independent(*forces)
            if rest == g or not factor.is_number:
                return None
            inner = _pieces(rest, forces, sense if factor.is_positive else -sense)
            return None if inner is None else [factor * piece for piece in inner]
    return None


def _joined(lists: Iterable[list[sp.Expr] | None]) -> list[sp.Expr] | None:
    every = list(lists)
    return None if None in every else [piece for part in every if part is not None for piece in part]


# -- half-spaces that are added one by one, for many points at once ----------------------------------------------------
#
#     u = argmin |s - u|  subject to  n_i . u <= beta_i,      s - u = sum mu_i n_i,  mu_i >= 0 on the active ones
#
# The dual active-set method of D. Goldfarb and A. Idnani (1983), Math. Program. 27, 1-33: a violated half-space enters,
# those whose multiplier would turn negative leave on the way, and |s - u| never decreases.

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
