"""Strategies for histories of a material of which no law is known: how far it is elastic is asked of the routine itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.projection.result import Array
from duhem.testing.drawn.case import Case
from duhem.testing.drawn.decades import Strategy
from duhem.testing.routines.material import Material

__all__ = ["elastic_reach", "histories"]

_MANTISSAS = (1.0, 3.0, 1.5, 7.0, 2.2)
_COMPONENTS = [*(s * m * 10.0**k for k in (0, -1, -3, -6) for m in _MANTISSAS for s in (1.0, -1.0)), 0.0, 0.0, 0.0, 0.0]
_TRIALS = [2.0, 0.5, 1.0, 10.0, 1.2, 0.9, 3.0, 1.0 + 1e-6, 1.0 - 1e-6, 100.0, 1e-3]  # times the elastic reach
_MOVES = [0.5, -0.5, 0.1, -0.1, 1.0, -2.0, 1e-3, -1e-3, 1e-6, 10.0]
_STRETCHES = [2.0, 0.5, 0.0, 1.5, 10.0, 0.1, 100.0]
_SIZES = [0.0, 2.0, 0.5, 1.5, 5.0, 3.0]  # of the path before, times the elastic reach; at 0 the step is the first
_KNOTS = 4
_DECADES = range(-12, 14)
_HALVES = 8
_ELASTIC = 1e-9  # relative error in stress up to which an answer counts as elastic

Made = Callable[[Mapping[str, float], Array], Material]  # parameters and stiffness to a material


def elastic_reach(material: Material, way: Array, pressure: Array | None) -> Array:
    """How far along ``way`` (N, d) a first increment of stress is answered elastically, (N,), to a few per cent; nan where asking fails.

    Looked for by decades from 1e-12 to 1e13; 0 where it is elastic at none of these, inf where at all.
    """
    n = len(way)
    root = np.linalg.cholesky(material.elastic)

    def elastic(size: Array, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
        trial = size[rows, None] * way[rows]
        load = None if pressure is None else pressure[rows]
        before = material.virgin(len(rows))
        if material.towards is not None:
            after = material.towards(before, trial, load, 1.0)
        else:
            after = material.advance(before, np.asarray(np.linalg.solve(material.elastic, trial.T).T), load, 1.0)
        off = np.linalg.norm(np.linalg.solve(root, (after.stress - trial).T), axis=0)
        return np.asarray(off <= _ELASTIC * np.linalg.norm(np.linalg.solve(root, trial.T), axis=0))

    low, high, open_ = np.zeros(n), np.full(n, np.inf), np.arange(n)
    try:
        with np.errstate(all="ignore"):
            for power in _DECADES:
                size = np.full(n, 10.0**power)
                good = elastic(size, open_)
                low[open_[good]], high[open_[~good]] = size[open_[good]], size[open_[~good]]
                open_ = open_[good]
                if not open_.size:
                    break
            between = np.flatnonzero((low > 0.0) & np.isfinite(high))
            for _ in range(_HALVES if between.size else 0):
                size = np.where(np.isfinite(high), np.sqrt(low * np.where(np.isfinite(high), high, 1.0)), low)
                good = elastic(size, between)
                low[between[good]], high[between[~good]] = size[between[good]], size[between[~good]]
    except Exception:  # the routine raises: a check tells of it, with a case
        return np.full(n, np.nan)
    return np.where(np.isfinite(high), low, np.inf)


def _path(kind: int, ways: Array) -> Array:
    """Knots (``_KNOTS``, d) of a path of size 1 from 0: along one way, to and fro, and round corners."""
    one, two, three = ways
    if kind == 0:
        return np.linspace(0.0, 1.0, _KNOTS)[:, None] * one
    if kind == 1:
        return np.array([0.0, 1.0, -1.0, 0.3])[:, None] * one
    return np.array([0.0 * one, one, two, three if kind == 2 else one - two])


@st.composite
def histories(
    draw: st.DrawFn,
    made: Made,
    values: Mapping[str, Any],
    stiffness: ArrayLike | Strategy,
    pressure: float | Strategy | None,
    rows: int = 1,
) -> Case:
    """A :class:`Case` of ``rows`` histories of the material that ``made`` makes; ``values`` are numbers or strategies, by name.

    The steps of a case of one shrink; those of a larger one are picked from the same tables by a seed.
    """
    numbers = {name: float(draw(value) if isinstance(value, st.SearchStrategy) else value) for name, value in values.items()}
    k = np.asarray(draw(stiffness) if isinstance(stiffness, st.SearchStrategy) else stiffness, dtype=np.float64)
    k = np.diag(k) if k.ndim == 1 else k
    if k.ndim != 2 or k.shape[0] != k.shape[1]:
        raise InputError(f"stiffness has the shape {k.shape}", where="stiffness", remedy="without a law give (d,) or (d, d)")
    d = len(k)
    material = made(numbers, k)
    tables: list[list[Any]] = [*[_COMPONENTS] * (4 * d), _TRIALS, _MOVES, _MOVES, _STRETCHES, _SIZES, [0, 1, 2, 3]]
    lengths = [len(table) for table in tables]
    if rows == 1:
        picked = np.array([draw(st.tuples(*(st.integers(0, length - 1) for length in lengths)))])
    else:
        picked = np.random.default_rng(draw(st.integers(0, 2**32 - 1))).integers(0, lengths, (rows, len(lengths)))
    columns = [np.array([table[i] for i in column]) for table, column in zip(tables, picked.T.tolist(), strict=True)]
    ways = np.stack([_unit(np.stack(columns[i * d : (i + 1) * d], axis=1)) for i in range(4)])
    amount, move, other_move, stretch, size, kind = columns[4 * d :]
    given = None if pressure is None else [_loads(draw, pressure, rows) for _ in range(2)]
    load = None if given is None else given[0]
    reach = elastic_reach(material, ways[:2].reshape(2 * rows, d), None if load is None else np.tile(load, 2)).reshape(2, rows)
    known = reach[np.isfinite(reach) & (reach > 0.0)]
    typical = float(np.median(known)) if known.size else 1.0
    reach = np.where(np.isfinite(reach) & (reach > 0.0), reach, typical)
    trial = (amount * reach[0])[:, None] * ways[0]
    path = np.array([s * _path(int(kind_), ways[1:, i]) for i, (s, kind_) in enumerate(zip(size * reach[1], kind, strict=True))])
    share = np.linspace(0.0, 1.0, _KNOTS)
    zero = np.zeros((rows, d))
    return Case(
        parameters=numbers,
        stiffness=k,
        pressure=load,
        trial=trial,
        other=trial + (move * reach[0])[:, None] * ways[2],
        third=trial + (other_move * reach[0])[:, None] * ways[3],
        inside=zero,
        beside=zero,
        stretch=stretch,
        factor=2.0,
        path=path,
        loads=None if given is None else (1.0 - share) * given[1][:, None] + share * given[0][:, None],
    )


def _unit(ways: Array) -> Array:
    size = np.abs(ways).max(axis=1, keepdims=True)
    return np.where(size == 0.0, np.eye(ways.shape[1])[0], ways / np.where(size == 0.0, 1.0, size))


def _loads(draw: st.DrawFn, pressure: float | Strategy, rows: int) -> Array:
    if isinstance(pressure, st.SearchStrategy):
        return np.array(draw(st.lists(pressure, min_size=rows, max_size=rows)), dtype=np.float64)
    return np.full(rows, float(pressure))
