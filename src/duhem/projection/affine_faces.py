"""The closest point of a K that planes bound, as the greatest of affine functions: every set of faces is tried.

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

__all__ = ["Faces", "faces", "planes"]

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
