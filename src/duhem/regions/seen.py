"""Where a claim seems to hold: formulas at many values of the parameters, in floating point.  Nothing here is trusted."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import reduce
from itertools import pairwise, product
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.expression.elementary import ELEMENTARY, array_function
from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.dents import FAMILIES, Dent, dents
from duhem.proof.kernel.domain import gap
from duhem.proof.kernel.polynomial import Polynomial
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import UNREADABLE, Term, number, parse
from duhem.regions.places import between

__all__ = [
    "RAYS", "Array", "Flags", "changes", "count", "level", "looked_at", "margins", "met", "of_one_sign", "polynomial_at", "telling",
    "value_of",
]  # fmt: skip

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
RAYS = 721  # between the ends of a dent
_RAYS_OF_A_DENT = (RAYS // 2, 65, 65, 65)
_PLACES, _SAMPLES, _ZERO = 9, 97, 1e-11
_MOST_PLACES, _FEW_PLACES, _FINER = 30, 12, 12  # of several parameters, of which constraints may leave few
_SIZES, _MOST_WAYS = (1e-3, 0.1, 1.0, 10.0, 1e3), 80  # of forces
_AT_END = 2.0**-20  # how near to an end of a cell it is looked, as a share


def telling(law: StatedLaw, claim: str) -> tuple[Dent, ...]:
    """What is >= 0 where the claim of a law seems to hold: its dents, or -g at zero force; nothing where none of these tells it."""
    if claim == "origin":
        at_zero = law.g.put({Term("name", name=f): number(0) for f in law.forces})
        with suppress(*UNREADABLE):
            value_of(at_zero, looked_at(law))
            return (Dent("origin", "at zero force", {((at_zero, 1),): Fraction(-1)}, (Fraction(0), Fraction(0)), over(law)),)
    for family in FAMILIES if claim == "convexity" else ():
        with suppress(*UNREADABLE):
            if found := tuple(dents(law, family)):
                return found
    return ()


def margins(told: Sequence[Dent], places: Mapping[str, Array]) -> Array:
    """By how much a claim seems to hold at some places, as a share of what is added up; < 0 where it seems to fail."""
    least = reduce(np.minimum, (_least(dent, places) for dent in told))
    return np.where(np.abs(least) <= _ZERO, 0.0, least)


def _least(dent: Dent, places: Mapping[str, Array]) -> Array:
    """The least value of a dent, as a share of the sizes that are added up: on many rays, then ever closer to the least."""
    low, high = (np.full(count(places), float(end)) for end in dent.between)
    for rays in _RAYS_OF_A_DENT if dent.between[0] < dent.between[1] else (1,):
        along = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, rays)
        seen = _relative(dent.poly, {name: np.repeat(x, rays) for name, x in places.items()} | {RAY.name: along.ravel()})
        least = seen.reshape(along.shape).min(axis=1)
        at, step = along[np.arange(len(low)), seen.reshape(along.shape).argmin(axis=1)], (high - low) / max(rays - 1, 1)
        low, high = np.maximum(low, at - step), np.minimum(high, at + step)
    return least


def changes(told: Sequence[Dent], name: str, own: Bounds) -> list[tuple[float, float, bool]]:
    """Stretches of the one parameter in a range, and whether the claim is seen to hold there; none where that cannot be told."""

    def holds(*x: float) -> list[bool]:
        return [bool(margin >= 0) for margin in margins(told, {name: np.array(x)})]

    with suppress(*UNREADABLE):
        places = _in(own, np.linspace(0, 1, _SAMPLES + 2)[1:-1].tolist())
        flags = holds(*places)
        stretches, start = list[tuple[float, float, bool]](), places[0]
        for (x, one), (y, two) in pairwise(zip(places, flags, strict=True)):
            if one != two:
                low, high = x, y
                while high - low > 1e-13 * max(1.0, abs(low)) and low < (middle := (low + high) / 2) < high:
                    low, high = (middle, high) if holds(middle) == [one] else (low, middle)
                stretches.append((start, low, one))
                start = high
        return [*stretches, (start, places[-1], flags[-1])]
    return []


def looked_at(law: StatedLaw, names: Collection[str] | None = None, most: int = _MOST_PLACES) -> dict[str, Array]:
    """Values of the parameters that are free, near their ends and between them, as far as the constraints on these alone allow them."""
    free = [n for n, own in law.parameters.items() if not own.single and (names is None or n in names)]
    shares = [_AT_END, 2.0**-10, *np.linspace(0.05, 0.95, _PLACES), 1 - 2.0**-10]
    if len(free) > 1:
        shares = [_AT_END, *np.linspace(0, 1, max(4, int(most ** (1 / len(free)))))[1:-1]]
    each = [_in(law.parameters[name], [*shares, 1 - _AT_END]) for name in free]
    places = dict(zip(free, np.array(list(product(*each))).T, strict=True)) if free else {}
    for c in law.constraints if len(free) > 1 else ():
        with suppress(ValueError):
            if c.names() <= {*free}:
                held = value_of(gap(c), places) > (-_ZERO if len(c.op) == 2 else _ZERO)
                places = {n: x[held] for n, x in places.items()}
    few = len(free) > 1 and count(places) < _FEW_PLACES and most < _MOST_PLACES * _FINER**2
    return looked_at(law, names, most * _FINER) if few else places


def count(places: Mapping[str, Array]) -> int:
    """How many there are: one of no parameter."""
    return len(next(iter(places.values()), [0.0]))


def _in(own: Bounds, shares: Sequence[float]) -> list[float]:
    return [float(between(own, own, Fraction(share))) for share in shares]


def _relative(poly: Polynomial, at: Mapping[str, Array]) -> Array:
    """A polynomial at many places, as a share of the sizes that are added up."""
    return polynomial_at(poly, at) / np.maximum(polynomial_at(poly, at, size=True), 1e-300)


def polynomial_at(poly: Polynomial, at: Mapping[str, Array], size: bool = False) -> Array:
    """A polynomial at many places, or the sum of the sizes of its terms; infinite where it has no value."""
    total = np.zeros(count(at))
    with np.errstate(all="ignore"):
        for m, c in poly.items():
            part = np.full_like(total, float(c))
            for x, n in m:
                part = part * value_of(x, at) ** float(n)
            total = total + (np.abs(part) if size else part)
    return np.where(np.isnan(total), np.inf, total)


def of_one_sign(law: StatedLaw, places: Mapping[str, Array]) -> bool:
    """Whether g is > 0, or never, at forces along axes and diagonals, near zero and far from it, for all of the values; in their ranges."""
    ways = [way for way in product((0.0, 1.0, -1.0), repeat=len(law.forces)) if any(way)][:_MOST_WAYS]
    values = level(law, places, np.outer(_SIZES, ways).reshape(-1, 1, len(law.forces)).repeat(count(places), axis=1))
    positive = (values[values != np.inf] if law.ranges else values) > 0
    return bool(positive.all() or not positive.any())


def level(law: StatedLaw, places: Mapping[str, Array], points: Array) -> Array:
    """g at points of each place, which are rows of places; infinite outside of the ranges."""
    rows, size, n = points.shape
    at = {name: np.tile(x, rows) for name, x in places.items()} | dict(zip(law.forces, points.reshape(rows * size, n).T, strict=True))
    found = value_of(law.g, at)
    for name, (low, high, *_) in law.ranges:
        if name in law.forces:
            inside = (at[name] >= (-np.inf if low is None else float(low))) & (at[name] <= (np.inf if high is None else float(high)))
            found = np.where(inside, found, np.inf)
    return found.reshape(rows, size)


def met(comparisons: Iterable[str], points: Mapping[str, Array]) -> Flags:
    """Where many points meet all of some comparisons; not where a side has no value."""
    return np.logical_and.reduce([np.ones(count(points), dtype=bool), *(value_of(parse(text), points) > 0 for text in comparisons)])


def value_of(term: Term, at: Mapping[str, Array]) -> Array:
    """A term at many places, not a number where it has no value, a comparison 1 or 0; ValueError for a word that is not read here.

    A name of which nothing is said is that of the pressure, -1.
    """
    size, known = count(at), dict[int, Array]()

    def of(part: Term) -> Array:
        if part.op == "number":
            return np.full(size, float(part.value))
        if part.op == "name":
            return at[part.name] if part.name in at else np.full(size, np.pi if part.name == "pi" else -1.0)
        if part.op not in _WORDS:
            raise ValueError(f"{part.op} is not read here")
        if id(part) not in known:
            known[id(part)] = np.asarray(_WORDS[part.op](*map(of, part.args)), dtype=float)
        return known[id(part)]

    with np.errstate(all="ignore"):
        return of(term)


_WORDS: Mapping[str, Callable[..., Any]] = {
    **{name: array_function(word.numpy) for name, word in ELEMENTARY.items()},
    **dict.fromkeys(("max", "or"), lambda *x: np.maximum.reduce(x)), **dict.fromkeys(("min", "and"), lambda *x: np.minimum.reduce(x)),
    "+": lambda *x: sum(x), "*": lambda *x: prod(x), "**": np.power, "abs": np.abs, "norm": lambda *x: np.sqrt(sum(y * y for y in x)),
    "pos": lambda x: np.maximum(x, 0.0), "neg": lambda x: np.maximum(-x, 0.0), "atan2": np.arctan2,
    "<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal, "where": lambda holds, *sides: np.where(holds > 0, *sides),
}  # fmt: skip
