"""A law whose K is bounded by planes, as the planes: what quadratic programs take."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np
import sympy as sp

from duhem.expression.numpy_ import compiled
from duhem.expression.vocabulary import Neg, Norm, Pos
from duhem.projection.increment import Increment
from duhem.projection.result import Array

__all__ = ["Faces", "faces"]

_MOST = 200


@dataclass(frozen=True)
class Faces:
    """K = {sigma : normals sigma <= offsets}: ``normals`` (m, d), ``offsets`` (N, m), one row a pressure."""

    normals: Array
    offsets: Array


def faces(question: Increment) -> Faces | None:
    """The planes where g is a greatest of affine functions of the forces, written as such; else None."""
    law, n = question.law, len(question.trial)
    found = _planes(question.g, law.force_symbols(), law.symbols()[law.pressure] if law.pressure else None)
    if found is None:
        return None
    normals, offsets = found
    given = [question.pressure] if law.pressure else []
    return Faces(normals, np.stack([np.broadcast_to(offset(*given), (n,)) for offset in offsets], axis=1))


@lru_cache(maxsize=64)
def _planes(g: sp.Expr, forces: tuple[sp.Symbol, ...], pressure: sp.Symbol | None) -> tuple[Array, list[Callable[..., Array]]] | None:
    """The normals (m, d) of the planes and programs for their offsets: the law's own, so that no peer is timed finding them again."""
    pieces = _pieces(g, set(forces))
    if pieces is None or len(pieces) > _MOST:
        return None
    slopes = [[sp.diff(piece, f) for f in forces] for piece in pieces]
    if not all(c.is_Rational for row in slopes for c in row):
        return None
    known = [] if pressure is None else [pressure]
    return np.array(slopes, dtype=np.float64), [compiled(-piece.xreplace(dict.fromkeys(forces, sp.S.Zero)), known) for piece in pieces]


def _pieces(g: sp.Expr, forces: set[sp.Symbol]) -> list[sp.Expr] | None:
    """Affine functions whose greatest is ``g``; None where that is not to be seen from how it is written."""
    if not g.free_symbols & forces:
        return [g]
    match g:
        case sp.Max():
            found = [_pieces(part, forces) for part in g.args]
            return None if None in found else [piece for part in found if part is not None for piece in part]
        case sp.Abs() | Pos() | Neg():
            inner = _pieces(g.args[0], forces)
            ends = {sp.Abs: (1, -1), Pos: (1, 0), Neg: (-1, 0)}[type(g)]
            return None if inner is None or len(inner) > 1 else [end * inner[0] for end in ends]
        case Norm() if len(g.args) == 1:
            return _pieces(sp.Abs(g.args[0]), forces)
        case sp.Add():
            terms = [_pieces(part, forces) for part in g.args]
            if None in terms:
                return None
            every = [part for part in terms if part is not None]
            return [sp.Add(*choice) for choice in product(*every)] if np.prod([len(part) for part in every]) <= _MOST else None
        case sp.Mul():
            factor, rest = g.as_independent(*forces)
            inner = _pieces(rest, forces) if rest != g else None
            if inner is None or not factor.is_Rational or (factor.is_negative and len(inner) > 1):
                return None
            return [factor * piece for piece in inner]
    return [sp.expand(g)] if g.is_Symbol else None
