"""Chords that leave K, found in floating point: their ends are affine in the parameters.  Nothing here is trusted.

In a plane of forces they join two points where lines from points of an axis leave K, or the ranges of the forces.  It is looked again
with shorter steps where a midpoint was nearest to the outside.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import permutations
from math import cos, pi, sin

import numpy as np

from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import pay
from duhem.regions.seen import Array, count, value_of

__all__ = ["chords"]

_STARTS, _TURNS, _CLOSER, _SHORTER = 25, 16, 4, 6  # of lines: on an axis, and from one point; how often it is looked again, and by how much
_FAR = (2, 64)  # along an axis, in halves of the range of a force that has one
_RADII = np.array([0.0, *2.0 ** np.arange(-20, 10, 0.5)])
_ROUNDING, _PRICE = 1e-13, 20_000
_HYDROSTATIC, _AXES = (1, 1, 1), ((1, -1, 0), (1, 1, -2))
_ALONG = (0, Fraction(-1, 2), Fraction(1, 2))  # where the planes of deviators lie

Vector = tuple[Fraction, ...]
_Line = tuple[Vector, Vector]  # from a point, one way


def chords(law: StatedLaw, places: Mapping[str, Array]) -> Iterator[dict[str, dict[str, str]]]:
    """The ends ``p`` and ``q`` of chords that leave K at all of some values of the parameters, those with the same ends for all first."""
    known = np.array([np.ones(count(places)), *places.values()])
    for origin, along, across in _planes(law):
        for far in _FAR:
            low, high = Fraction(-far), Fraction(far)
            for _ in range(_CLOSER):
                pay(_PRICE)
                seen = _Lines.of(law, places, _lines(origin, along, across, low, high))
                if len(seen.lines) < 2:
                    break
                for powers in (known[:1], known) if len(places) else (known,):
                    fitted = seen.fitted(powers)
                    (one, two), depth = seen.deepest(fitted, powers)
                    if depth > 0:
                        yield from seen.told([one, two], fitted, powers, ("", *places))
                x = sum(_share(seen.lines[k][0], origin, along) for k in (one, two)) / 2
                low, high = x + (low - high) / (2 * _SHORTER), x + (high - low) / (2 * _SHORTER)


def _planes(law: StatedLaw) -> Iterator[tuple[Vector, Vector, Vector]]:
    """A point, an axis through it, and the way of the lines: of principal values in meridian and deviatoric planes, else along two forces."""
    ends = dict(law.ranges)
    middle, half = list[Fraction](), list[Fraction]()
    for low, high, *_ in (ends.get(f, (None, None)) for f in law.forces):
        both = low is not None and high is not None
        half.append((high - low) / 2 if both else Fraction(1))
        middle.append((high + low) / 2 if both else Fraction(0) if low is high else low + 1 if high is None else high - 1)
    n = len(half)
    if n == 3:
        for axis in _AXES:
            yield tuple(middle), _vector(_HYDROSTATIC), _vector(axis)
        for share in _ALONG:
            for one, two in permutations(_AXES):
                yield tuple(m + share for m in middle), _vector(one), _vector(two)
    units = [tuple(half[i] if i == k else Fraction(0) for i in range(n)) for k in range(n)]
    for one, two in permutations(units, 2) if n > 1 else [(units[0], units[0])]:
        yield tuple(middle), one, two


def _vector(parts: tuple[int, ...]) -> Vector:
    return tuple(map(Fraction, parts))


def _moved(point: Vector, way: Vector, share: Fraction) -> Vector:
    return tuple(x + share * d for x, d in zip(point, way, strict=True))


def _share(point: Vector, origin: Vector, along: Vector) -> Fraction:
    """How far along an axis a point of it is."""
    return next((x - o) / a for x, o, a in zip(point, origin, along, strict=True) if a)


def _lines(origin: Vector, along: Vector, across: Vector, low: Fraction, high: Fraction) -> Iterator[_Line]:
    """Both ways from points of a part of the axis, and all around from its origin."""
    for k in range(_STARTS):
        start = _moved(origin, along, low + (high - low) * k / (_STARTS - 1))
        yield from ((start, tuple(way * x for x in across)) for way in (Fraction(1), Fraction(-1)))
    for k in range(_TURNS):
        one, two = (Fraction(word(2 * pi * k / _TURNS)).limit_denominator(8) for word in (cos, sin))
        yield origin, tuple(one * a + two * b for a, b in zip(along, across, strict=True))


@dataclass(frozen=True)
class _Lines:
    """Lines from points of K, and where each leaves it at each of the ``places``."""

    law: StatedLaw
    places: Mapping[str, Array]
    lines: list[_Line]
    reach: Array

    @classmethod
    def of(cls, law: StatedLaw, places: Mapping[str, Array], lines: Iterator[_Line]) -> _Lines:
        """Those of the lines that start in K at all of the places."""
        every = [*lines]
        starts, ways = (np.array([[float(x) for x in line[i]] for line in every])[:, None, :] for i in (0, 1))
        size, stay = count(places), np.ones((len(every), count(places)), dtype=bool)
        low, high = np.zeros(stay.shape), np.full(stay.shape, np.inf)
        for radius in _RADII:
            inside = _level(law, places, starts + radius * ways + np.zeros((1, size, 1))) <= 0
            low = np.where(stay & inside, radius, low)
            high = np.where(stay & ~inside, radius, high)
            stay &= inside
        told = (high > 0).all(axis=1)
        starts, ways, low, high = starts[told], ways[told], low[told], np.minimum(high[told], _RADII[-1])
        for _ in range(45):
            middle = (low + high) / 2
            inside = _level(law, places, starts + middle[:, :, None] * ways) <= 0
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        return cls(law, places, [line for line, here in zip(every, told, strict=True) if here], low)

    def fitted(self, powers: Array) -> Array:
        """How far along each line an end lies, by powers of the parameters: less far than it leaves K at any place."""
        found = self.reach @ np.linalg.pinv(powers)
        found[:, 0] += (self.reach - found @ powers).min(axis=1)
        return np.asarray(found)

    def ends(self, which: list[int], fitted: Array, powers: Array) -> Array:
        """The ends on some lines at each place."""
        starts, ways = (np.array([[float(x) for x in self.lines[k][i]] for k in which])[:, None, :] for i in (0, 1))
        return np.asarray(starts + (fitted @ powers)[:, :, None] * ways)

    def deepest(self, fitted: Array, powers: Array) -> tuple[tuple[int, int], float]:
        """The two lines of which the midpoint is farthest outside at all places, and g there."""
        ends = self.ends([*range(len(self.lines))], fitted, powers)
        one, two = np.triu_indices(len(ends), 1)
        level = _level(self.law, self.places, (ends[one] + ends[two]) / 2)
        depth = np.nan_to_num(level, nan=-np.inf, posinf=-np.inf).min(axis=1)
        best = int(np.argmax(depth))
        return (int(one[best]), int(two[best])), float(depth[best]) - _ROUNDING

    def told(self, which: list[int], fitted: Array, powers: Array, names: tuple[str, ...]) -> Iterator[dict[str, dict[str, str]]]:
        """A chord with ends in short numbers, which lie as far inside as the midpoint allows."""
        own = fitted[which]
        for bits in range(3, 40, 3):
            inward = 2.0**-bits * max(1.0, float(np.abs(own).max()))
            short = own - inward * np.eye(1, own.shape[1])
            if np.all(_level(self.law, self.places, self.ends(which, short, powers).mean(axis=0)[None]) > _ROUNDING):
                fine = int(16 * max(1.0, float(np.abs(powers).max())) / inward)
                short = own - inward / 2 * np.eye(1, own.shape[1])
                exact = [[Fraction(x).limit_denominator(fine) for x in line] for line in short.tolist()]
                p, q = (self._written(self.lines[k], parts, names) for k, parts in zip(which, exact, strict=True))
                yield {"p": p, "q": q}
                return

    def _written(self, line: _Line, parts: list[Fraction], names: tuple[str, ...]) -> dict[str, str]:
        """A point by its components that are not 0."""
        found = dict[str, str]()
        for force, x, d in zip(self.law.forces, *line, strict=True):
            plain = [str(x + d * parts[0])] if x + d * parts[0] else []
            if said := [*plain, *(f"({d * c})*{name}" for c, name in zip(parts[1:], names[1:], strict=False) if d * c)]:
                found[force] = " + ".join(said)
        return found


def _level(law: StatedLaw, places: Mapping[str, Array], points: Array) -> Array:
    """g at points of each place, which are rows of places; infinite outside of the ranges."""
    rows, size, _ = points.shape
    at = {name: np.tile(x, rows) for name, x in places.items()} | dict(zip(law.forces, points.reshape(rows * size, len(law.forces)).T, strict=True))
    level = value_of(law.g, at)
    for name, (low, high, *_) in law.ranges:
        if name in law.forces:
            for beyond in (None if low is None else float(low) - at[name], None if high is None else at[name] - float(high)):
                level = level if beyond is None else np.where(beyond > 0, np.inf, level)
    return np.asarray(level.reshape(rows, size))
