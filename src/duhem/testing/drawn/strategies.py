"""Hypothesis strategies for increments of a law, stratified by decade.

``floats(1e-12, 1e12)`` draws hardly anything below 1e6; here each decade is as likely as the next, and points on, next to
and one unit in the last place off the seams and the boundary are drawn on purpose.  The first value of every table is
the simplest, which is what a failing case shrinks to.  Without a law it is asked of the routine itself how far it is elastic.

What a run may be asked is checked before anything is drawn.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from numbers import Integral, Real
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError, words_of
from duhem.expression.given_array import reals
from duhem.expression.rays import Rays
from duhem.law.catalogue import load, load_formula
from duhem.law.formula_law import Criterion
from duhem.projection.increment import factors, refused
from duhem.projection.result import Array
from duhem.testing.drawn.case import Case, Region
from duhem.testing.drawn.values import MANTISSAS, Strategy, admitted, decades, scaled, table
from duhem.testing.routines import ELASTIC, Material, Unfinished

__all__ = [
    "ACCURACY", "TRIES", "TURNS", "RunOptions", "cases", "check_share", "decades", "histories", "loadings", "numbers", "parameters",
    "pressures", "stiffness_matrix", "stiffnesses", "trials", "turned", "ways",
]  # fmt: skip

ACCURACY = 1e-9  # relative error in stress a routine is held to, unless it promises another
TRIES = 200  # to make a failing case smaller, counted, so that what is told does not depend on the load of the machine
_SYMMETRIC = "give a symmetric positive definite stiffness, in Pa/m"


@dataclass(frozen=True)
class RunOptions:
    """How a run draws cases and makes a failing one small, as :func:`duhem.testing.conformance` takes it; None where left out."""

    stiffness: ArrayLike | Strategy | None = None
    pressure: float | Strategy | None = None
    accuracy: float = ACCURACY
    max_examples: int | None = None
    rows: int = 30
    every: int | None = None
    tries: int = TRIES
    seconds: float | None = None
    seed: int | None = None
    largest_strain: float | None = None
    scale: float | None = None

    def check(self, law: Criterion | None) -> None:
        """Raise InputError for the first option that cannot be used."""
        _check_stiffness(self.stiffness, law)
        _check_pressure(self.pressure, law)
        if not _is_number(self.accuracy) or not 0.0 < self.accuracy < 1.0:  # beyond, every stress would do
            low = _is_number(self.accuracy) and self.accuracy <= 0.0
            what = "the accuracy is not positive" if low else f"{self.accuracy!r} is not a relative error"
            raise InputError(what, where="accuracy", remedy="give a number between 0 and 1, for example 1e-9")
        if self.seconds is not None and not (_is_number(self.seconds) and self.seconds >= 0.0):
            raise InputError(f"{self.seconds!r} is not a time", where="seconds", remedy="give a number >= 0, or remove it")
        for name in ("largest_strain", "scale"):
            if (strain := getattr(self, name)) is None:
                continue
            if law is not None:
                remedy = "remove it: with a law, increments are drawn by the size of K"
                raise InputError("the size of increments is given with a law", where=name, remedy=remedy)
            if not (_is_number(strain) and strain > 0.0):
                raise InputError(f"{strain!r} is not a strain", where=name, remedy="give a number > 0, for example 1e-2")
        for name, least in (("rows", 1), ("every", 1), ("tries", 0), ("max_examples", 1), ("seed", None)):
            given = getattr(self, name)
            if given is None and name not in ("rows", "tries"):  # which may not be left out
                continue
            if isinstance(given, bool) or not isinstance(given, Integral):
                remedy = f"give one, for example {max(least or 0, 1) * 10}"
                raise InputError(f"{given!r} is not a whole number", where=name, remedy=remedy)
            if least is not None and given < least:
                raise InputError(f"{given} is too small", where=name, remedy=f"give {least} or more")


def check_share(given: Any, where: str) -> None:
    """Raise InputError unless it is a number from 0 to 1."""
    if not _is_number(given) or not 0.0 <= given <= 1.0:
        raise InputError(f"{given!r} is not a fraction", where=where, remedy="give a number from 0 to 1, for example 0.1")


def stiffness_matrix(given: ArrayLike, law: Criterion | None) -> Array:
    """Return k (d, d) of one number, (d,) or (d, d) in Pa/m, without a law (d,) or (d, d).  Raises InputError for another shape.

    One number is a stiffness as :func:`duhem.project` takes it: of the tensors, where the law declares a stress.
    """
    d = 0 if law is None else len(law.forces)
    remedy = f"give one number, ({d},) or ({d}, {d})" if d else "without a law give (d,) or (d, d)"
    k = numbers(given, "stiffness", remedy)
    n = d or len(np.atleast_1d(k))
    if k.size == 0 or k.shape not in ([(), (n,), (n, n)] if d else [(n,), (n, n)]):
        raise InputError(f"stiffness has the shape {k.shape}", where="stiffness", remedy=remedy)
    if k.ndim == 0 and law is not None and law.stress is not None:
        k = k * law.stress.unit_stiffness
    return k if k.ndim == 2 else np.diag(np.broadcast_to(k, (n,)))


def _check_stiffness(given: ArrayLike | Strategy | None, law: Criterion | None) -> None:
    """Raise InputError unless it is of a shape that the law takes, and positive definite; a strategy is not looked into."""
    if given is None or isinstance(given, SearchStrategy):
        return
    k, least = stiffness_matrix(given, law), np.min(np.asarray(given, dtype=np.float64))
    if np.ndim(given) < 2 and least <= 0.0:
        raise InputError(f"{least} is not positive", where="stiffness", remedy=_SYMMETRIC)
    scale = np.sqrt(np.abs(np.diagonal(k)))
    if (np.abs(k - k.T) > 4.0 * np.finfo(float).eps * np.outer(scale, scale)).any():
        raise InputError("the matrix is not symmetric", where="stiffness", remedy=_SYMMETRIC)
    factors(np.tril(k) + np.tril(k, -1).T)


def _check_pressure(given: float | Strategy | None, law: Criterion | None) -> None:
    """Raise InputError unless it is one number <= 0, in Pa, that the law admits; a strategy is not looked into."""
    if given is None or isinstance(given, SearchStrategy):
        return
    value = numbers(given, "pressure", "give one number, for example -1e6")
    name = "sigma_n" if law is None or law.pressure is None else law.pressure
    if value.ndim:
        raise InputError(f"pressure has the shape {value.shape}", where="pressure", remedy="give one number, for example -1e6")
    if value > 0.0:
        raise InputError(f"{name} = {value} is positive", where="pressure", remedy=f"{name} <= 0 in compression: give a number <= 0")
    if law is not None and law.pressure is not None and refused(law, value[None])[0]:
        what = f"{name} = {value} is outside the range of {law.domain[name].stated(name)}"
        raise InputError(what, where="pressure", remedy="give a number within it")


def _is_number(given: Any) -> bool:
    return isinstance(given, Real) and not isinstance(given, bool | np.bool_) and isfinite(given)


def numbers(given: Any, where: str, remedy: str) -> Array:
    """Finite numbers as an array.  Raises InputError for anything else."""
    if (found := reals(given)) is None or not np.isfinite(found).all():
        raise InputError(f"{str(given)[:60]!r} is not made of finite numbers", where=where, remedy=remedy)
    return found


# -- cases, and the numbers in them ------------------------------------------------------------------------------------

_ULP = float(np.finfo(np.float64).eps)
_LEAST, _SMALL = 5e-324, 1e-310  # a share of the first is nothing, of the second not
_STEPS = 6  # of a loading path


def pressures(low: int = -6, high: int = 6) -> Strategy:
    """sigma_n <= 0 in Pa by decades, and none at all (the tip of a cone)."""
    return table(_pressures(low, high))


def _pressures(low: int, high: int) -> list[float]:
    return [*(-scaled(m, k) for m in MANTISSAS for k in sorted(range(low, high + 1), key=abs)), *[0.0] * 4]  # often at the tip


def _admitted(law: Criterion) -> list[float]:
    """Return the pressures in the range that the law declares, with its ends."""
    own = law.domain.get(law.pressure or "")
    if own is None:
        return _pressures(-6, 6)
    low, high = own.ends
    return [*(p for p in _pressures(-6, 6) if low <= p <= high), *(end for end in (high, low) if -np.inf < end <= 0.0)]


def stiffnesses(d: int, low: int = -3, high: int = 3) -> Strategy:
    """k (d, d) in Pa/m, symmetric positive definite: scalar, diagonal (each entry by decades), and coupled.

    Coupled ones have the diagonal D and k = D^1/2 [(1 - c) I + c s s^T] D^1/2 with signs s and 0 < c < 1.
    """
    one = decades(low, high)
    scalar = one.map(lambda x: np.eye(d) * x)
    diagonal = st.tuples(*[one] * d).map(np.diag)

    def coupled(drawn: tuple[Array, float, tuple[float, ...]]) -> Array:
        k, c, signs = drawn
        s, root = np.array(signs), np.sqrt(np.diag(k))
        return k + np.where(np.eye(d) == 1.0, 0.0, c * np.outer(s * root, s * root))

    full = st.tuples(diagonal, table([0.5, 0.1, 0.9, 0.99, 1e-6]), st.tuples(*[table([1.0, -1.0])] * d)).map(coupled)
    return scalar | diagonal | full if d > 1 else scalar


def parameters(law: Criterion | str | Path, values: Mapping[str, Any] | None = None) -> Strategy:
    """A number for each parameter of ``law`` that ``values`` leaves open, inside its domain and the constraints.

    Positive parameters by decades from 1e-3 to 1e3; ends of closed intervals, and their neighbours, among the others.  Each is
    drawn from what the constraints leave to it, however little that is.
    """
    return _drawn(load_formula(law).fix(values))


@st.composite
def _drawn(draw: st.DrawFn, law: Criterion) -> dict[str, float]:
    return admitted(law).values(lambda n: draw(st.integers(0, n - 1)))


# Of size 1 at most, so that the largest of a direction can be put to 1 and the others stay as short as they are.  By decades they
# lie next to the axes, nearly all: hundredths go all round.
_SIZES = [1.0, *(scaled(m, -k) for k in range(1, 13) for m in (*MANTISSAS[1:], 1.0)), _ULP, 0.0, _LEAST, _SMALL]
_HUNDREDTHS = [k / 100 for k in range(5, 100)] * 2
_COMPONENTS = [s * x for x in (*_SIZES, *[_ULP, 0.0, _LEAST, _SMALL, 1.0] * 22, *_HUNDREDTHS) for s in (1.0, -1.0)]


def ways(d: int) -> Strategy:
    """Directions (d,) of largest component 1: components by decades from 1e-12, on an axis, and 5e-324 and 1e-310 beside one."""
    return st.tuples(*[table(_COMPONENTS)] * d).map(lambda way: _unit(np.array([way]))[0])


def _unit(ways: Array) -> Array:
    """Return directions with the components of the largest size, which is 1 at most, put to 1."""
    size = np.abs(ways).max(axis=1, keepdims=True)
    return np.where(size < 1e-300, np.eye(ways.shape[1])[0], np.where(np.abs(ways) == size, np.sign(ways), ways))


TURNS: list[str] = [*["as drawn"] * 9, "corner", "mean", "equal", *["seam"] * 3]
"""What is made of a direction; the first, which is nothing, as often as the rest together and a little more."""


def turned(region: Region, way: Array, other: Array, turns: list[str], pressure: Array) -> Array:
    """Directions (N, d) of largest component 1, some of ``way`` turned.

    ``corner``: all components that are not tiny alike in size.  ``mean``: normal components alike, no shear, for laws of a
    stress; the way to an apex.  ``equal``: the first two components equal, where principal stresses are.  ``seam``: the last
    number before the smooth piece of g changes on the way to ``other``, and the first after it in every second row.
    """
    found, kind = way.copy(), np.array(turns)
    at = kind == "corner"
    found[at] = np.where(np.abs(way[at]) > 1e-3, np.sign(way[at]), 0.0)
    stress = region.law.stress
    if stress is not None:
        normal = ~np.array(stress.shears)
        at = kind == "mean"
        found[at] = np.where(way[at, :1] < 0.0, -1.0, 1.0) * normal
    if way.shape[1] > 1:
        at = kind == "equal"
        found[at, 1] = found[at, 0]
        size = np.abs(found[at]).max(axis=1, keepdims=True)
        found[at] = np.where(size > 0.0, found[at] / np.where(size > 0.0, size, 1.0), way[at])
    if (rows := np.flatnonzero(kind == "seam")).size:
        found[rows] = _seam(region, way[rows], other[rows], pressure[rows], rows % 2 == 1)
    return found


def _seam(region: Region, first: Array, last: Array, pressure: Array, beyond: Array) -> Array:
    """Where the piece of g changes between two directions, at stresses of the size of the boundary; ``first`` where it does not."""
    with np.errstate(all="ignore"):
        reach = region.reach(first, pressure)
        size = np.where(np.isfinite(reach) & (reach > 0.0), reach, 1.0)
        here = region.slope(size[:, None] * first, pressure)[1]

        def level(points: Array) -> Array:
            """Negative on the piece of the first direction; points (M, n, d)."""
            m, n, d = points.shape
            stress = (size[:, None, None] * points).reshape(m * n, d)
            piece = np.asarray(region.slope(stress, np.repeat(pressure, n))[1]).reshape(m, n, -1)
            return np.where((piece == np.asarray(here).reshape(m, 1, -1)).all(axis=2), -1.0, 1.0)

        rays = Rays(level, first, last - first)
        changes = ~rays.inside(np.array([1.0]))[:, 0]
        if not changes.any():
            return first
        inner, outer = rays.narrowed(np.zeros(len(first)), np.ones(len(first)), at_once=6)
    share = np.where(beyond, outer, inner)
    way = rays.at(share)
    longest = np.abs(way).max(axis=1, keepdims=True)
    good = changes[:, None] & (longest > 1e-300)
    return np.where(good, way / np.where(good, longest, 1.0), first)


# Where a trial stress lies: on a ray, at a multiple of its end on the boundary or so many units in the last place beyond
# that; or off the boundary along its normal, where the closest point is known to be that end, on or beside a seam.
_PLACES: list[tuple[str, float]] = [
    ("ray", 2.0),
    ("ray", 0.5),
    *[("ray", 0.0)] * 2,
    *(("ray", scaled(m, k)) for m in MANTISSAS for k in (0, -1, 1, -3, 2, 3)),
    *(("normal", scaled(m, k)) for m in MANTISSAS[:6] for k in (0, -2, 1, -6, -10, 3)),
    *(("ray", 1.0 + s * x) for x in (1e-3, 1e-6, 1e-8, 1e-12) for s in (1.0, -1.0)),
    *(("ulps", n) for n in (1, 0, 2, -1) * 4),
]
_OPEN = 0.25  # of the cases: one row asks for no stress under the least pressure, as a contact that has opened does; 0/0 to many
_MOVES = [s * scaled(m, k) for m in MANTISSAS[:4] for k in (0, -1, -3, -6, -9, 1, 2) for s in (1.0, -1.0)]
_SHARES = [1.0, 0.5, 0.0, 0.9, 0.99, 1.0 - 1e-6, 1.0 - 1e-12]
_STRETCHES = [2.0, 0.5, 0.0, 1.5, 10.0, 0.1, 0.01, 100.0]
_KINDS = ["cycle", "circle", "polygon"]
_AMPLITUDES = [scaled(m, k) for m in MANTISSAS for k in (0, -1, 1, 2)]


def trials(law: Criterion | str | Path, values: Mapping[str, float], pressure: float | None) -> Strategy:
    """Trial stresses (d,) of one law: inside, far outside, on the boundary and next to it, and along its normals."""
    region = Region(load(law), dict(values))
    load_ = np.array([0.0 if pressure is None else pressure])
    drawn = st.tuples(ways(len(region.law.forces)), table(_PLACES))

    def placed(row: tuple[Array, tuple[str, float]]) -> Array:
        way = row[0][None]
        return _placed(region, way, region.reach(way, load_), [row[1]], load_, np.eye(way.shape[1]))[0][0]

    return drawn.map(placed)


def loadings(d: int, steps: int = _STEPS) -> Strategy:
    """Loading paths (steps, d) of size 1, the first knot 0: to and fro along a line, round a circle, from corner to corner."""
    drawn = st.tuples(table(_KINDS), ways(d), ways(d), ways(d))
    return drawn.map(lambda row: _path(*row, steps))


def _path(kind: str, first: Array, second: Array, third: Array, steps: int) -> Array:
    share = np.arange(steps) / max(steps - 1, 1)
    if kind == "cycle":
        return np.sin(2.5 * np.pi * share)[:, None] * first
    if kind == "circle":
        angle = 2.0 * np.pi * share[:, None]
        return np.sin(angle) * first + (1.0 - np.cos(angle)) * second
    corners = np.array([np.zeros_like(first), first, second, third, -first])
    return corners[np.arange(steps) % len(corners)]


def _placed(
    region: Region, way: Array, reach: Array, places: Sequence[tuple[str, float]], pressure: Array, stiffness: Array
) -> tuple[Array, Array]:
    """Trial stresses (N, d) and the boundary points on their rays; where K has no size or no end, of size 1."""
    size = np.where(np.isfinite(reach) & (reach > 0.0), reach, 1.0)
    kind = np.array([name for name, _ in places])
    amount = np.array([x for _, x in places])[:, None]
    edge = size[:, None] * way
    beyond = size[:, None] + amount * np.spacing(size)[:, None]
    trial = np.select([kind[:, None] == "ray", kind[:, None] == "ulps"], [amount * edge, beyond * way], edge)
    _, inverse = factors(stiffness)
    with np.errstate(all="ignore"):
        normal = region.slope(edge, pressure)[0] @ stiffness
        length = np.sqrt(((normal @ inverse.T) ** 2).sum(axis=1))[:, None]
        out = edge + amount * normal / length * np.sqrt(((edge @ inverse.T) ** 2).sum(axis=1))[:, None]
    along = (kind == "normal") & np.isfinite(out).all(axis=1)
    return np.where(along[:, None], out, trial), edge


def cases(
    law: Criterion | str | Path,
    values: Mapping[str, Any] | None = None,
    *,
    stiffness: ArrayLike | Strategy | None = None,
    pressure: float | Strategy | None = None,
    rows: int = 1,
) -> Strategy:
    """A :class:`Case` of ``rows`` increments of ``law``; ``values``, ``stiffness`` and ``pressure`` are drawn where left out.

    One number is a stiffness as :func:`duhem.project` takes it: of the tensors, where the law declares a stress.
    A case of one increment shrinks; the rows of a larger one are picked from the same tables by a seed.
    """
    known = load_formula(law)
    fixed, d = known.fix(values), len(known.forces)
    numbers = {name: float(domain.value) for name, domain in fixed.parameters.items() if domain.value is not None}
    k_drawn = _given(stiffness, stiffnesses(d)).map(lambda x: stiffness_matrix(x, known))
    given = None if pressure is None or not known.pressure else _given(pressure, st.nothing())
    tables = [*[_COMPONENTS] * (3 * d), *_TABLES, *[_admitted(known)] * 2]

    @st.composite
    def case(draw: st.DrawFn) -> Case:
        values = numbers | draw(_drawn(fixed))
        k = draw(k_drawn)
        factor = draw(table([2.0, 0.5, 4.0, 2.0**20, 2.0**-20]))
        picked, rng = _picked(draw, tables, rows)
        if rng is not None and rng.random() < _OPEN:
            picked[-1, 3 * d], picked[-1, -2] = _PLACES.index(("ray", 0.0)), tables[-2].index(max(tables[-2]))
        columns = _columns(tables, picked)
        loads = np.array(columns[-2:], dtype=np.float64) if given is None else _loads(draw, given, rows)
        return _case(Region(known, {name: values[name] for name in known.parameters}), k, factor, loads, columns)

    return case()


_TABLES: list[list[Any]] = [
    _PLACES, _MOVES, _MOVES, _SHARES, _SHARES, _STRETCHES, _KINDS, _AMPLITUDES, TURNS,
]  # fmt: skip


def _given(given: Any, otherwise: Strategy) -> Strategy:
    """Return what is given, a strategy or a value, as a strategy; ``otherwise`` where it is None."""
    return otherwise if given is None else given if isinstance(given, st.SearchStrategy) else st.just(given)


def _picked(draw: st.DrawFn, tables: Sequence[Sequence[Any]], rows: int) -> tuple[NDArray[np.intp], np.random.Generator | None]:
    """Return places (rows, tables) in tables: those of one row are drawn, so that they shrink, those of several come from a drawn seed."""
    lengths = [len(each) for each in tables]
    if rows == 1:
        return np.array([draw(st.tuples(*(st.integers(0, n - 1) for n in lengths)))]), None
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    return rng.integers(0, lengths, (rows, len(lengths))), rng


def _columns(tables: Sequence[Sequence[Any]], picked: NDArray[np.intp]) -> list[list[Any]]:
    """Return, for each table, its entries at the places of its column."""
    return [[each[i] for i in column] for each, column in zip(tables, picked.T.tolist(), strict=True)]


def _loads(draw: st.DrawFn, pressure: float | Strategy, rows: int) -> Array:
    """Return pressures (2, rows), two for each row, as they are given or drawn."""
    if isinstance(pressure, st.SearchStrategy):
        return np.array([draw(st.lists(pressure, min_size=rows, max_size=rows)) for _ in range(2)], dtype=np.float64)
    return np.full((2, rows), float(pressure))


def _case(region: Region, k: Array, factor: float, loads: Array, columns: list[Any]) -> Case:
    d, pressed = len(k), region.law.pressure is not None
    loads = loads if pressed else np.zeros_like(loads)
    pressure, n = loads[0], loads.shape[1]
    all_ways = [_unit(np.array(columns[i * d : (i + 1) * d]).T) for i in range(3)]
    all_ways[0] = turned(region, all_ways[0], all_ways[1], columns[3 * d + len(_TABLES) - 1], pressure)
    reaches = region.reach(np.concatenate(all_ways), np.tile(pressure, 3)).reshape(3, n)
    places, *others = columns[3 * d : 3 * d + len(_TABLES)]
    move_2, move_3, share_2, share_3, stretch = (np.array(column)[:, None] for column in others[:5])
    way, way_2, way_3 = all_ways
    trial, edge = _placed(region, way, reaches[0], places, pressure, k)
    size = np.maximum(np.abs(trial).max(axis=1), np.abs(edge).max(axis=1))[:, None]
    ends = np.where(np.isfinite(reaches), reaches, 1.0)[:, :, None]  # any point where K does not end
    amplitude = np.array(others[6]) * np.abs(edge).max(axis=1)
    turns = zip(amplitude, others[5], way, way_2, way_3, strict=True)
    path = np.array([size_ * _path(kind, a, b, c, _STEPS) for size_, kind, a, b, c in turns])
    between = np.linspace(0.0, 1.0, _STEPS)
    return Case(
        parameters=region.parameters,
        stiffness=k,
        pressure=pressure if pressed else None,
        trial=trial,
        other=trial + move_2 * size * way_2,
        third=trial + move_3 * size * way_3,
        inside=share_2 * ends[1] * way_2,
        beside=share_3 * ends[2] * way_3,
        stretch=stretch[:, 0],
        factor=factor,
        path=path,
        loads=(1.0 - between) * loads[0][:, None] + between * loads[1][:, None] if pressed else None,
    )


# -- histories of a material of which no law is known --------------------------------------------------------------------

_FEW = (1.0, 3.0, 1.5, 7.0, 2.2)
_FORCES = [*(s * m * 10.0**k for k in (0, -1, -3, -6) for m in _FEW for s in (1.0, -1.0)), 0.0, 0.0, 0.0, 0.0]
_AMOUNTS = [2.0, 0.5, 1.0, 10.0, 1.2, 0.9, 3.0, 1.0 + 1e-6, 1.0 - 1e-6, 100.0, 1e-3]  # times the elastic reach
_STEPS_ASIDE = [0.5, -0.5, 0.1, -0.1, 1.0, -2.0, 1e-3, -1e-3, 1e-6, 10.0]
_LONGER = [2.0, 0.5, 0.0, 1.5, 10.0, 0.1, 100.0]
_BEFORE = [0.0, 2.0, 0.5, 1.5, 5.0, 3.0]  # of the path before, times the elastic reach; at 0 the step is the first
_KNOTS = 4
_DURATIONS = [0.5, 2.0, 0.1, 10.0]  # s, of a leg
_LOWEST, _HIGHEST = -12, 13
_HALVES, _BEYOND = 8, 1
_FARTHEST = 100.0  # elastic strains, the typical one of a case: no increment goes farther


def _elastic_reach(
    material: Material, way: Array, pressure: Array | None, accuracy: float, largest: float | None, searched: Counter[str]
) -> Array:
    """How far along ``way`` (N, d) a first increment of stress is answered elastically, (N,), to a few per cent; nan where asking fails.

    Looked for by decades from 1e-12 to 1e13, and from 1e-12 to 1e4 of the stiffness, which may have any unit; no farther than one beyond
    the first limit that is met, nor than the ``largest`` strain; 0 where it is elastic at none of these, inf where at all.  What the
    routine raises is counted in ``searched``; Unfinished is raised.
    """
    n = len(way)
    root = np.linalg.cholesky(material.elastic)
    most = np.inf if largest is None else largest / np.abs(np.linalg.solve(material.elastic, way.T)).max(axis=0)
    stiff = round(float(np.log10(np.diag(material.elastic).max())))
    powers = range(min(_LOWEST, stiff + _LOWEST), max(_HIGHEST, stiff + 4) + 1)
    last = len(powers)

    def elastic(size: Array, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
        trial = size[rows, None] * way[rows]
        load = None if pressure is None else pressure[rows]
        before = material.virgin(len(rows))
        if material.towards is not None:
            after = material.towards(before, trial, load, 1.0)
        else:
            after = material.advance(before, np.asarray(np.linalg.solve(material.elastic, trial.T).T), load, 1.0)
        off = np.linalg.norm(np.linalg.solve(root, (after.stress - trial).T), axis=0)
        return np.asarray(off <= max(ELASTIC, accuracy) * np.linalg.norm(np.linalg.solve(root, trial.T), axis=0))

    low, high, open_, size = np.zeros(n), np.full(n, np.inf), np.arange(n), np.zeros(n)
    try:
        with np.errstate(all="ignore"):
            for i, power in enumerate(powers):
                size = np.full(n, 10.0**power)
                open_ = open_[(size <= most)[open_]]
                if not open_.size or i >= last:
                    break
                good = elastic(size, open_)
                last = min(last, i + 1 + _BEYOND) if low.any() and not good.all() else last
                low[open_[good]], high[open_[~good]] = size[open_[good]], size[open_[~good]]
                open_ = open_[good]
            between = np.flatnonzero((low > 0.0) & np.isfinite(high))
            for _ in range(_HALVES if between.size else 0):
                size = np.where(np.isfinite(high), np.sqrt(low * np.where(np.isfinite(high), high, 1.0)), low)
                good = elastic(size, between)
                low[between[good]], high[between[~good]] = size[between[good]], size[between[~good]]
    except Unfinished as fault:  # each further search would wait as long
        where = f"the search for the elastic range, by increments of stress of {size.max():.3g}"
        raise Unfinished(fault.what, where=where, remedy=fault.remedy) from None
    except (Exception, SystemExit) as fault:
        searched[f"the routine raised {type(fault).__name__}: {words_of(fault)}"] += 1
        return np.full(n, np.nan)
    return np.where(np.isfinite(high), low, np.inf)


def _knots(kind: int, ways: Array) -> Array:
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
    made: Callable[[Mapping[str, float], Array], Material],
    values: Mapping[str, Any],
    stiffness: ArrayLike | Strategy,
    pressure: float | Strategy | None,
    rows: int = 1,
    *,
    accuracy: float = ELASTIC,
    largest_strain: float | None = None,
    scale: float | None = None,
    timed: bool = False,
    searched: Counter[str] | None = None,
) -> Case:
    """A :class:`Case` of ``rows`` histories of the material that ``made`` makes; ``values`` are numbers or strategies, by name.

    Increments are drawn in multiples of the elastic range, which is looked for, or is the stress of the strain ``scale``; no strain is
    larger than ``largest_strain``, 100 times the typical elastic one if left out.  A leg of a ``timed`` one takes ``factor`` s.
    ``searched`` counts what is found (:class:`duhem.testing.checks.registry.Visited`).  The steps of a case of one shrink; those of a
    larger one are picked from the same tables by a seed.
    """
    searched = Counter() if searched is None else searched
    numbers = {name: float(draw(_given(value, st.nothing()))) for name, value in values.items()}
    k = stiffness_matrix(draw(_given(stiffness, st.nothing())), None)
    d = len(k)
    material = made(numbers, k)
    tables: list[list[Any]] = [*[_FORCES] * (4 * d), _AMOUNTS, _STEPS_ASIDE, _STEPS_ASIDE, _LONGER, _BEFORE, [0, 1, 2, 3]]
    columns = [np.array(column) for column in _columns(tables, _picked(draw, tables, rows)[0])]
    ways = np.stack([_scaled(np.stack(columns[i * d : (i + 1) * d], axis=1)) for i in range(4)])
    amount, move, other_move, stretch, size, kind = columns[4 * d :]
    given = None if pressure is None else _loads(draw, pressure, rows)
    load = None if given is None else given[0]
    stretched = np.abs(np.linalg.solve(material.elastic, ways[:2].reshape(2 * rows, d).T)).max(axis=0).reshape(2, rows)
    if scale is None:
        loads = None if load is None else np.tile(load, 2)
        reach = _elastic_reach(material, ways[:2].reshape(2 * rows, d), loads, accuracy, largest_strain, searched).reshape(2, rows)
    else:
        reach = scale / stretched
    known = np.isfinite(reach) & (reach > 0.0)
    searched["range" if known.any() else "none"] += 1
    typical = float(np.median(reach[known])) if known.any() else 1.0
    reach = np.where(known, reach, typical)
    if largest_strain is None:
        largest_strain = _FARTHEST * float(np.median((reach * stretched)[known])) if known.any() else np.inf
    trial = np.minimum(amount * reach[0], largest_strain / stretched[0])[:, None] * ways[0]
    far = np.minimum(size * reach[1], largest_strain / stretched[1])
    path = np.array([s * _knots(int(kind_), ways[1:, i]) for i, (s, kind_) in enumerate(zip(far, kind, strict=True))])
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
        factor=draw(table(_DURATIONS)) if timed else 1.0,
        path=path,
        loads=None if given is None else (1.0 - share) * given[1][:, None] + share * given[0][:, None],
    )


def _scaled(ways: Array) -> Array:
    size = np.abs(ways).max(axis=1, keepdims=True)
    return np.where(size == 0.0, np.eye(ways.shape[1])[0], ways / np.where(size == 0.0, 1.0, size))
