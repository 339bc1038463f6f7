"""Chords that leave K, found in floating point: their ends are affine in the parameters.  Nothing here is trusted.

They join two points in a plane of forces where lines from points of an axis leave K, or the ranges of the forces.
Where K turns convex at an end of a cell of one parameter, chords are the shorter, or leave K by the less, the nearer the parameter is to
that end.  So there an end of a chord begins where a line leaves K at that very value, or at a tip of K on the axis, and moves with the
distance from it.  A chord of another kind would leave a convex K at that value too, or touch its boundary there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations, permutations
from math import cos, pi, sin
from typing import Any, NamedTuple

import numpy as np

from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import pay
from duhem.regions.seen import Array, count, level

__all__ = ["Family", "Suggestion", "along", "chords"]

_STARTS, _TURNS = 193, 32  # of lines both ways from an axis, and around its origin
_STEPS, _FEW = (1, 2, 3, 5), 12  # between the starts of two lines; of others every so many
_FAR = (1, 64)  # along an axis, in halves of the range of a force that has one
_RADII = np.array([0.0, *2.0 ** np.arange(-20, 10, 0.5)])
_HALVINGS = 42  # of what is between a radius inside and one outside
_ROUNDING, _ALIKE, _PRICE = 1e-13, 1e-6, 5_000
_FEW_PLACES = 3  # at which lines are looked for
_SHORT, _SAME = 10_000, 1e-11  # the denominator of a number that is taken to be exact, and how near to it
_TURNED = np.array([*permutations((0.1, -0.2, 0.4))])[:, None, :]  # principal values in every order
_ALONG = (Fraction(0), Fraction(-1, 2))  # the meridian axis, where deviatoric planes lie

Vector = tuple[Fraction, ...]
_Plane = tuple[Vector, Vector, Vector]  # a point, an axis through it, and the way of the lines
_MERIDIAN: Vector = (Fraction(1),) * 3
_DEVIATORIC: tuple[Vector, ...] = (Fraction(1), Fraction(-1), Fraction(0)), (Fraction(1), Fraction(1), Fraction(-2))


class _Line(NamedTuple):
    """From a point, one way; the point drifts with the distance of the parameter from an end of its cell."""

    start: Vector
    way: Vector
    drift: Vector


class Family(NamedTuple):
    """Lines, and how the ends of chords move along them: with the parameters, or with the distance from an ``end`` of a cell."""

    lines: Sequence[_Line]
    end: Fraction | None = None


class Suggestion(NamedTuple):
    """A rule that refutes, with its evidence; of a chord the family of the two lines on which its ends lie."""

    rule: str
    evidence: Mapping[str, Any]
    family: Family | None = None


def along(law: StatedLaw, places: Mapping[str, Array], ends: Sequence[Fraction], families: Sequence[Family]) -> Iterator[Suggestion]:
    """Yield chords between lines that refuted another cell."""
    for family in families:
        if family.end is None or family.end in ends:
            yield from _Lines.of(law, places, family).told()


def chords(law: StatedLaw, places: Mapping[str, Array], turning: Sequence[Fraction]) -> Iterator[Suggestion]:
    """Chords that leave K at all of some values of the parameters.

    Beside an end of a cell of one parameter at which K is ``turning`` convex these are those that move with the distance from it.
    """
    at = [*dict.fromkeys(np.linspace(0, count(places) - 1, _FEW_PLACES).round().astype(int).tolist())]
    few = {name: x[at] for name, x in places.items()}
    for plane in _planes(law, few):
        near = (family for end in turning for family in _near(law, few, plane, end))
        for family in near if turning else (Family(_lines(*plane, far)) for far in _FAR):
            pay(_PRICE)
            if (best := _Lines.of(law, few, family).deepest()) is not None:
                yield from _Lines.of(law, places, family._replace(lines=[family.lines[k] for k in best])).told()


def _near(law: StatedLaw, places: Mapping[str, Array], plane: _Plane, end: Fraction) -> Iterator[Family]:
    """Yield lines that leave K at the end of the cell at distances that are short fractions; and lines from a tip of K.

    The start of a line of the second kind moves away from the tip in proportion to the distance of the parameter from that end.
    """
    (origin, along, across), there = plane, dict.fromkeys(places, np.array([float(end)]))
    for far in _FAR:
        yield Family(_lines(origin, along, across, far), end)
    nothing = (Fraction(0),) * len(origin)
    axis = Family([_Line(origin, tuple(way * x for x in along), nothing) for way in (1, -1)])
    for line, reach in zip(axis.lines, _Lines.of(law, there, axis).reach[:, 0].tolist(), strict=True):
        if (share := _exact(reach)) is not None:
            tip = tuple(o + share * w for o, w in zip(origin, line.way, strict=True))
            yield Family([_Line(tip, own.way, own.start) for own in _lines(nothing, along, across, 1)], end)


def _exact(x: float) -> Fraction | None:
    """The short fraction that floating point cannot tell from x."""
    near = Fraction(x).limit_denominator(_SHORT) if np.isfinite(x) else None
    return near if near is not None and abs(float(near) - x) < _SAME else None


def _about_zero(own: Sequence[Any] | None) -> tuple[Fraction, Fraction]:
    """The range of a force; of one without an end one of length 2, about 0 where it has none."""
    low, high = (None, None) if own is None else own[:2]
    first = low if low is not None else Fraction(-1) if high is None else high - 2
    return first, first + 2 if high is None else high


def _planes(law: StatedLaw, places: Mapping[str, Array]) -> Iterator[_Plane]:
    """Of principal values meridian and deviatoric planes, else those along forces."""
    ends, n = dict[str, tuple[Any, ...]](law.ranges), len(law.forces)
    first = {name: x[:1] for name, x in places.items()}
    if n == len(_MERIDIAN) and not ends and np.isfinite(turned := level(law, first, _TURNED)).all() and np.ptp(turned) < _ALIKE:
        yield from (((Fraction(0),) * n, _MERIDIAN, way) for way in _DEVIATORIC)
        yield from (((share,) * n, one, two) for share in _ALONG for one, two in permutations(_DEVIATORIC))
        return
    boxes = [_about_zero(ends.get(f)) for f in law.forces]
    middle = tuple((low + high) / 2 for low, high in boxes)
    units = [tuple((high - low) / 2 if i == k else Fraction(0) for i, (low, high) in enumerate(boxes)) for k in range(n)]
    yield from ((middle, one, two) for one, two in (permutations(units, 2) if n > 1 else [(units[0], units[0])]))


def _lines(origin: Vector, along: Vector, across: Vector, far: int) -> list[_Line]:
    """Both ways from points of the axis, and all around from its origin."""
    shares, nothing = [Fraction(far * (2 * k - _STARTS + 1), _STARTS - 1) for k in range(_STARTS)], (Fraction(0),) * len(origin)
    starts = [tuple(o + share * a for o, a in zip(origin, along, strict=True)) for share in shares]
    turns = [[Fraction(word(2 * pi * k / _TURNS)).limit_denominator(8) for word in (cos, sin)] for k in range(_TURNS)]
    around = [_Line(origin, tuple(one * a + two * b for a, b in zip(along, across, strict=True)), nothing) for one, two in turns]
    return [*(_Line(start, tuple(way * x for x in across), nothing) for start in starts for way in (1, -1)), *around]


# Lines of which the ends are joined: those that start near each other on one side, those along the axis with all, and some of all.
_SIDE_BY_SIDE = [(2 * k + side, 2 * (k + step) + side) for step in _STEPS for k in range(_STARTS - step) for side in (0, 1)]
_WITH_THE_AXIS = [(2 * _STARTS + turn, k) for turn in (0, _TURNS // 2) for k in range(2 * _STARTS)]
_SOME = [*(2 * k + side for k in range(0, _STARTS, _FEW) for side in (0, 1)), *range(2 * _STARTS, 2 * _STARTS + _TURNS)]
_PAIRS = np.array([*_SIDE_BY_SIDE, *_WITH_THE_AXIS, *combinations(_SOME, 2)]).T


class _Lines(NamedTuple):
    """Lines, and how far along each leaves K, at each of the ``places``; not a number where it does not start in K.

    ``begun`` is the same distance where the parameter is at the end of its cell; it is empty if no chord moves from there.
    """

    law: StatedLaw
    places: Mapping[str, Array]
    family: Family
    starts: Array
    ways: Array
    reach: Array
    begun: Sequence[Fraction | None]

    @classmethod
    def of(cls, law: StatedLaw, places: Mapping[str, Array], family: Family) -> _Lines:
        starts, ways, drifts = (np.array([[float(x) for x in line[i]] for line in family.lines])[:, None, :] for i in range(3))
        begun = list[Fraction | None]()
        if family.end is not None:
            begun = [Fraction(0)] * len(family.lines)  # at a tip
            if not drifts.any():
                there = dict.fromkeys(places, np.array([float(family.end)]))
                begun = [*map(_exact, cls.of(law, there, Family(family.lines)).reach[:, 0].tolist())]
            starts = starts + drifts * np.abs(next(iter(places.values())) - float(family.end))[:, None]
        return cls(law, places, family, starts, ways, _reach(law, places, starts, ways), begun)

    @property
    def powers(self) -> dict[str, Array]:
        """What ends are made of, as text: 1, and what they move with; those of several parameters stay where they are."""
        found, end = {"": np.ones(count(self.places))}, self.family.end
        if end is None:
            return found | ({f"*{name}": x for name, x in self.places.items()} if len(self.places) == 1 else {})
        ((name, x),) = self.places.items()
        return found | {f"*({name} - ({end}))" if x[0] > end else f"*({end} - {name})": np.abs(x - float(end))}

    def fitted(self) -> Array:
        """How far along each line an end lies, by powers of the parameters: less far than it leaves K at any place."""
        powers = np.array([*self.powers.values()])
        if self.family.end is not None:
            begun = np.array([np.nan if x is None else float(x) for x in self.begun])
            return np.column_stack([begun, ((self.reach - begun[:, None]) / powers[1]).min(axis=1)])
        found = self.reach @ np.linalg.pinv(powers)
        found[:, 0] += (self.reach - found @ powers).min(axis=1)
        stays = np.eye(len(powers))[0] * self.reach.min(axis=1)[:, None]  # what moves goes back beyond its start where K opens on the way
        return np.where((found @ powers).min(axis=1)[:, None] < 0, stays, found)

    def levels(self, fitted: Array, pairs: Array) -> Array:
        """g at midpoints, the least of all places."""
        ends = self.starts + (fitted @ np.array([*self.powers.values()]))[:, :, None] * self.ways
        depth = level(self.law, self.places, (ends[pairs[0]] + ends[pairs[1]]) / 2).min(axis=1)
        return np.asarray(np.where(np.isfinite(depth), depth, -np.inf))

    def deepest(self) -> Array | None:
        """The two lines of which the midpoint is farthest outside; None where none is."""
        fitted = self.fitted()
        pairs = _PAIRS[:, np.isfinite(fitted[_PAIRS]).all(axis=(0, 2))]
        depth = self.levels(fitted, pairs)
        return pairs[:, depth.argmax()] if depth.size and depth.max() > _ROUNDING else None

    def told(self) -> Iterator[Suggestion]:
        """The chord of the only two lines with ends in short numbers, which lie as far inside as the midpoint allows."""
        own, both, begins = self.fitted(), np.array([[0], [1]]), self.family.end is not None
        inward = np.eye(own.shape[1])[int(begins)] * max(1.0, float(np.abs(own).max()))
        for bits in np.arange(3, 42, 0.25).tolist():
            if self.levels(own - 2.0**-bits * inward, both)[0] > _ROUNDING:
                fine = int(2.0 ** (bits + 4) * max(1.0, *(float(np.abs(x).max()) for x in self.powers.values())))
                exact = [[Fraction(x).limit_denominator(fine) for x in line] for line in (own - 2.0 ** -(bits + 1) * inward).tolist()]
                if begins:
                    exact = [[first or Fraction(0), *rest] for first, (_, *rest) in zip(self.begun, exact, strict=True)]
                p, q = (self._written(line, parts) for line, parts in zip(self.family.lines, exact, strict=True))
                yield Suggestion("chord", {"p": p, "q": q, **({} if self.law.pressure is None else {"pressure": "-1"})}, self.family)
                return

    def _written(self, line: _Line, parts: list[Fraction]) -> dict[str, str]:
        """A point by its components that are not 0."""
        found = dict[str, str]()
        for force, x, d, drift in zip(self.law.forces, *line, strict=True):
            told = [x + d * parts[0], *(drift + d * c for c in parts[1:])]
            if said := [f"({c}){what}" if what else f"{c}" for c, what in zip(told, self.powers, strict=True) if c]:
                found[force] = " + ".join(said)
        return found


def _reach(law: StatedLaw, places: Mapping[str, Array], starts: Array, ways: Array) -> Array:
    """How far along lines each leaves K first, at each of the places."""

    def along_lines(radii: Array) -> Array:
        points = starts[:, :, None] + radii[..., None] * ways[:, :, None]
        found = level(law, places, points.transpose(0, 2, 1, 3).reshape(-1, *points.shape[1::2]))
        return found.reshape(len(points), -1, points.shape[1]).transpose(0, 2, 1)

    shape = (len(starts), count(places))
    found = along_lines(np.broadcast_to(_RADII, (*shape, len(_RADII))))
    held = found <= 0
    held[..., 0] |= np.isnan(found[..., 0]) & held[..., 1]  # an angle has no value on the axis from which a line starts
    first = np.logical_and.accumulate(held, axis=2).sum(axis=2)  # outside
    low, high = _RADII[np.maximum(first - 1, 0)], _RADII[np.minimum(first, len(_RADII) - 1)]
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        inside = along_lines(middle[:, :, None])[:, :, 0] <= 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.where(first == 0, np.nan, low)  # it does not start in K
