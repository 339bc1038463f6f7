"""Chords that leave K, found in floating point: their ends are affine in the parameters.  Nothing here is trusted.

In a plane of forces they join two points where lines from points of an axis leave K, or the ranges of the forces.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import combinations, permutations
from math import cos, pi, sin

import numpy as np

from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import pay
from duhem.regions.seen import Array, count, in_ranges, value_of

__all__ = ["chords"]

_STARTS, _TURNS = 193, 16  # of lines both ways from an axis, and around its origin
_STEPS, _FEW = (1, 2, 3, 5), 12  # between the starts of two lines; of others every so many
_FAR = (1, 64)  # along an axis, in halves of the range of a force that has one
_RADII = np.array([0.0, *2.0 ** np.arange(-20, 10, 0.5)])
_PARTS, _FINER = np.linspace(0.0, 1.0, 33), 8  # of what is between a radius inside and one outside, and how often
_ROUNDING, _ALIKE, _PRICE = 1e-13, 1e-6, 20_000
_FEW_PLACES = 3  # at which lines are looked for
_TURNED = np.array([*permutations((0.1, -0.2, 0.4))])[:, None, :]  # principal values in every order
_ALONG = (Fraction(0), Fraction(-1, 2))  # the meridian axis, where deviatoric planes lie

Vector = tuple[Fraction, ...]
_Line = tuple[Vector, Vector]  # from a point, one way
_MERIDIAN: Vector = (Fraction(1),) * 3
_DEVIATORIC: tuple[Vector, ...] = (Fraction(1), Fraction(-1), Fraction(0)), (Fraction(1), Fraction(1), Fraction(-2))


def chords(law: StatedLaw, places: Mapping[str, Array]) -> Iterator[dict[str, dict[str, str]]]:
    """The ends ``p`` and ``q`` of chords that leave K at all of some values of the parameters; with the same ends for all, if these do."""
    at = [*dict.fromkeys(np.linspace(0, count(places) - 1, _FEW_PLACES).round().astype(int).tolist())]
    few = {name: x[at] for name, x in places.items()}
    for origin, along, across in _planes(law, few):
        for far in _FAR:
            pay(_PRICE)
            lines = _Lines.of(law, few, _lines(origin, along, across, far))
            for moving in (False, True) if places else (False,):
                if (best := lines.deepest(moving)) is not None:
                    yield from _Lines.of(law, places, [lines.lines[k] for k in best]).told(moving)


def _planes(law: StatedLaw, places: Mapping[str, Array]) -> Iterator[tuple[Vector, Vector, Vector]]:
    """A point, an axis through it, and the way of the lines: of principal values in meridian and deviatoric planes, else along forces."""
    ends, n = dict(law.ranges), len(law.forces)
    if n == len(_MERIDIAN) and not ends and np.ptp(_level(law, {name: x[:1] for name, x in places.items()}, _TURNED)) < _ALIKE:
        yield from (((Fraction(0),) * n, _MERIDIAN, way) for way in _DEVIATORIC)
        yield from (((share,) * n, one, two) for share in _ALONG for one, two in permutations(_DEVIATORIC))
        return
    middle = tuple(_middle(*ends[f][:2])[0] if f in ends else Fraction(0) for f in law.forces)
    half = [_middle(*ends[f][:2])[1] if f in ends else Fraction(1) for f in law.forces]
    units = [tuple(x if i == k else Fraction(0) for i, x in enumerate(half)) for k in range(n)]
    yield from ((middle, one, two) for one, two in (permutations(units, 2) if n > 1 else [(units[0], units[0])]))


def _middle(low: Fraction | None, high: Fraction | None) -> tuple[Fraction, Fraction]:
    """The middle of a range and half of its width; 1 where it has an end alone."""
    if low is None or high is None:
        return (low + 1 if low is not None else high - 1 if high is not None else Fraction(0)), Fraction(1)
    return (high + low) / 2, (high - low) / 2


def _lines(origin: Vector, along: Vector, across: Vector, far: int) -> list[_Line]:
    """Both ways from points of the axis, and all around from its origin."""
    shares = [Fraction(far * (2 * k - _STARTS + 1), _STARTS - 1) for k in range(_STARTS)]
    starts = [tuple(o + share * a for o, a in zip(origin, along, strict=True)) for share in shares]
    turns = [[Fraction(word(2 * pi * k / _TURNS)).limit_denominator(8) for word in (cos, sin)] for k in range(_TURNS)]
    around = [(origin, tuple(one * a + two * b for a, b in zip(along, across, strict=True))) for one, two in turns]
    return [*((start, tuple(way * x for x in across)) for start in starts for way in (1, -1)), *around]


@cache
def _pairs() -> Array:
    """Lines of which the ends are joined: those that start near each other on one side, those along the axis with all, and some of all."""
    near = [(2 * k + side, 2 * (k + step) + side) for step in _STEPS for k in range(_STARTS - step) for side in (0, 1)]
    some = [2 * k + side for k in range(0, _STARTS, _FEW) for side in (0, 1)]
    axis = [(2 * _STARTS + turn, k) for turn in (0, _TURNS // 2) for k in range(2 * _STARTS)]
    return np.array([*near, *axis, *combinations([*some, *range(2 * _STARTS, 2 * _STARTS + _TURNS)], 2)]).T


@dataclass(frozen=True)
class _Lines:
    """Lines, and how far along each leaves K, at each of the ``places``; not a number where it does not start in K."""

    law: StatedLaw
    places: Mapping[str, Array]
    lines: list[_Line]
    starts: Array
    ways: Array
    reach: Array

    @classmethod
    def of(cls, law: StatedLaw, places: Mapping[str, Array], lines: list[_Line]) -> _Lines:
        starts, ways = (np.array([[float(x) for x in line[i]] for line in lines])[:, None, :] for i in (0, 1))
        shape = (len(lines), count(places))
        low, high = np.zeros(shape), np.full(shape, np.nan)
        for shares in (_RADII, *[_PARTS] * _FINER):
            radii = low[:, :, None] + shares * (1.0 if shares is _RADII else (high - low)[:, :, None])
            points = starts[:, :, None] + radii[..., None] * ways[:, :, None]
            inside = _level(law, places, points.transpose(0, 2, 1, 3).reshape(-1, *points.shape[1::2])) <= 0
            first = np.logical_and.accumulate(inside.reshape(shape[0], -1, shape[1]), axis=1).sum(axis=1)[:, :, None]  # outside
            low = np.take_along_axis(radii, np.maximum(first - 1, 0), axis=2)[:, :, 0]
            high = np.take_along_axis(radii, np.minimum(first, len(shares) - 1), axis=2)[:, :, 0]
            low[first[:, :, 0] == 0] = np.nan  # it does not start in K
        return cls(law, places, lines, starts, ways, low)

    def powers(self, moving: bool) -> Array:
        """What ends are made of: 1, and each parameter if they move."""
        return np.array([np.ones(count(self.places)), *(self.places.values() if moving else ())])

    def fitted(self, powers: Array) -> Array:
        """How far along each line an end lies, by powers of the parameters: less far than it leaves K at any place."""
        found = self.reach @ np.linalg.pinv(powers)
        found[:, 0] += (self.reach - found @ powers).min(axis=1)
        return np.asarray(found)

    def levels(self, fitted: Array, powers: Array, pairs: Array) -> Array:
        """g at midpoints, the least of all places."""
        ends = self.starts + (fitted @ powers)[:, :, None] * self.ways
        level = _level(self.law, self.places, (ends[pairs[0]] + ends[pairs[1]]) / 2).min(axis=1)
        return np.asarray(np.where(np.isfinite(level), level, -np.inf))

    def deepest(self, moving: bool) -> Array | None:
        """The two lines of which the midpoint is farthest outside; None where none is."""
        powers = self.powers(moving)
        fitted = self.fitted(powers)
        pairs = _pairs()[:, np.isfinite(fitted[:, 0])[_pairs()].all(axis=0)]
        level = self.levels(fitted, powers, pairs)
        return pairs[:, level.argmax()] if level.size and level.max() > _ROUNDING else None

    def told(self, moving: bool) -> Iterator[dict[str, dict[str, str]]]:
        """The chord of the only two lines with ends in short numbers, which lie as far inside as the midpoint allows."""
        powers = self.powers(moving)
        own, both = self.fitted(powers), np.array([[0], [1]])
        inward = np.eye(1, own.shape[1]) * max(1.0, float(np.abs(own).max()))
        for bits in range(3, 42, 3):
            if self.levels(own - 2.0**-bits * inward, powers, both)[0] > _ROUNDING:
                fine = int(2.0 ** (bits + 4) * max(1.0, float(np.abs(powers).max())))
                exact = [[Fraction(x).limit_denominator(fine) for x in line] for line in (own - 2.0 ** -(bits + 1) * inward).tolist()]
                p, q = (self._written(line, parts) for line, parts in zip(self.lines, exact, strict=True))
                yield {"p": p, "q": q}
                return

    def _written(self, line: _Line, parts: list[Fraction]) -> dict[str, str]:
        """A point by its components that are not 0."""
        found = dict[str, str]()
        for force, x, d in zip(self.law.forces, *line, strict=True):
            terms = [(x + d * parts[0], ""), *((d * c, f"*{name}") for c, name in zip(parts[1:], self.places, strict=False))]
            if said := [f"({c}){what}" if what else f"{c}" for c, what in terms if c]:
                found[force] = " + ".join(said)
        return found


def _level(law: StatedLaw, places: Mapping[str, Array], points: Array) -> Array:
    """g at points of each place, which are rows of places; infinite outside of the ranges."""
    rows, size, n = points.shape
    at = {name: np.tile(x, rows) for name, x in places.items()} | dict(zip(law.forces, points.reshape(rows * size, n).T, strict=True))
    return np.where(in_ranges(law, at), value_of(law.g, at), np.inf).reshape(rows, size)
