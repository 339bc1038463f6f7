"""The boundary of a set in a plane, from signs alone: lines to the last digit, with the corners where they are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from duhem.expression.rays import Rays

__all__ = ["Line", "Vertex", "Window", "closed", "level_lines", "normals", "region", "traced"]

Array = NDArray[np.float64]
Level = Callable[[Array], Array]
Window = tuple[float, float, float, float]

_GRID = 181
_ASIDE = 0.0137  # of a window: no line of the grid is an axis, on which a formula may be 0 or undefined for reasons of its own
_HALVINGS = 46
_BETWEEN = 16  # parts into which a stretch that bends is cut
_ZOOMS = 5
_LONG = 12.0  # times as long as wide, from where a window is taken for a square
_BENDS = np.radians(4.0)  # between two chords, beyond which they are looked at more closely
_CORNER = np.radians(3.0)  # that is left where a stretch is 8^5 times as short
_TALL = 0.25  # of its chord: the height of a stretch from where it is a tip
_FADES = 0.99  # of a turn that is left where a stretch is 8 times as short, time and again: that of x log x, not of a corner


@dataclass(frozen=True)
class Vertex:
    """A point (2,) of the boundary with the outward unit normals of the sides that meet there, in the order of the line."""

    point: Array
    before: Array
    after: Array

    @property
    def convex(self) -> bool:
        """Whether the set has a normal cone there; at a dent it has none."""
        return bool(self.before[0] * self.after[1] - self.before[1] * self.after[0] > 0.0)


@dataclass(frozen=True)
class Line:
    """Points (m, 2) of the boundary, the set on the left; a closed line ends where it begins."""

    points: Array
    corners: tuple[Vertex, ...] = ()


def closed(points: Array) -> bool:
    """Whether a line ends where it begins."""
    return len(points) > 2 and bool((points[0] == points[-1]).all())


def region(level: Level, window: Window, grid: int = _GRID) -> tuple[Array, Array, Array]:
    """The grid of a window and a little more on its left and below: x (n,), y (n,) and values (n, n) from -1 to 1, <= 0 in the set."""
    a, b, c, d = window
    x, y = np.linspace(a - _ASIDE * (b - a), b, grid), np.linspace(c - _ASIDE * (d - c), d, grid)
    return x, y, _signed(level(np.stack(np.meshgrid(x, y), axis=-1)))


def _signed(value: Array) -> Array:
    """Scaled by what is usual; a level that is undefined or beyond the doubles lies outside, as for who projects."""
    finite = np.isfinite(value)
    scale = float(np.median(np.abs(value[finite]))) if finite.any() else 1.0
    with np.errstate(all="ignore"):
        scaled = np.clip(value / (scale or 1.0), -1.0, 1.0)
    return np.where(np.isnan(value), 1.0, np.where((scaled == 0.0) & (value > 0.0), 1e-300, scaled))


def level_lines(x: Array, y: Array, value: Array) -> list[Array]:
    """Lines (m, 2) along which a value on a grid is 0, as straight as the grid is coarse."""
    from contourpy import contour_generator

    found: list[Array] = contour_generator(x, y, value).lines(0.0)  # type: ignore[assignment]
    return found


def traced(level: Level, window: Window, grid: int = _GRID) -> tuple[tuple[Line, ...], Array]:
    """The boundary of {level <= 0} in a window, and the values of :func:`region`, whose sign says what lies in the set."""
    wide, high = window[1] - window[0], window[3] - window[2]
    if max(wide, high) > _LONG * min(wide, high):
        sides = np.array([wide, high])
        square = (window[0] / wide, window[1] / wide, window[2] / high, window[3] / high)
        found, value = traced(lambda points: level(points * sides), square, grid)
        return tuple(_scaled(line, sides) for line in found), value
    x, y, value = region(level, window, grid)
    lines = []
    for rough in level_lines(x, y, value):
        points = _polished(level, x, y, value, rough)
        if len(points) < 3:
            continue
        lines.append(_sharpened(level, _left(level, points)))
    return tuple(lines), value


def _scaled(line: Line, sides: Array) -> Line:
    """The line with its sides multiplied; normals turn the other way."""
    ways = [[way / sides / np.hypot(*(way / sides)) for way in (corner.before, corner.after)] for corner in line.corners]
    corners = tuple(Vertex(corner.point * sides, *two) for corner, two in zip(line.corners, ways, strict=True))
    return Line(line.points * sides, corners)


def _inside(level: Level, points: Array) -> NDArray[np.bool_]:
    found: NDArray[np.bool_] = level(points) <= 0.0
    return found


def _halved(level: Level, inner: Array, outer: Array) -> Array:
    """Points (m, 2) of the boundary between points in the set and points out of it."""
    rays = Rays(level, inner, outer - inner)
    return rays.at(rays.narrowed(np.zeros(len(inner)), np.ones(len(inner)), _HALVINGS)[0])


def _polished(level: Level, x: Array, y: Array, value: Array, rough: Array) -> Array:
    """The vertices of a contour, each on an edge of the grid, moved along it to the boundary."""
    at = (rough - [x[0], y[0]]) / [x[1] - x[0], y[1] - y[0]]
    low = np.clip(np.floor(at + 1e-9).astype(int), 0, len(x) - 1)
    on = np.abs(at - np.round(at)) < 1e-7
    i0, j0 = np.where(on, np.round(at).astype(int), low).T
    i1, j1 = np.where(on[:, 0], i0, np.minimum(i0 + 1, len(x) - 1)), np.where(on[:, 1], j0, np.minimum(j0 + 1, len(y) - 1))
    first, second = value[j0, i0] <= 0.0, value[j1, i1] <= 0.0
    here, there = np.column_stack([x[i0], y[j0]]), np.column_stack([x[i1], y[j1]])
    cut = first != second
    exact = np.where(cut[:, None], np.where(first[:, None], here, there), rough)
    other = np.where(cut[:, None], np.where(first[:, None], there, here), rough)
    points = _halved(level, exact, other)
    gaps = np.hypot(*np.diff(points, axis=0).T)
    kept = np.concatenate([[True], gaps > 1e-3 * min(x[1] - x[0], y[1] - y[0])])
    ends = closed(rough)
    points = points[kept]
    if ends:
        if len(points) > 2 and np.hypot(*(points[0] - points[-1])) < 1e-3 * (x[1] - x[0]):
            points = points[:-1]
        points = np.vstack([points, points[:1]])
    return points


def _left(level: Level, points: Array) -> Array:
    """The line in the sense that has the set on its left."""
    chords = np.diff(points, axis=0)
    middles, aside = (points[1:] + points[:-1]) / 2.0, 0.05 * np.column_stack([-chords[:, 1], chords[:, 0]])
    left = int(_inside(level, middles + aside).sum()) - int(_inside(level, middles - aside).sum())
    return points if left >= 0 else points[::-1]


def _turns(points: Array) -> Array:
    """The angle (..., m - 2), in rad and > 0 to the left, between the chords at each inner point of lines (..., m, 2)."""
    chords = np.diff(points, axis=-2)
    a, b = chords[..., :-1, :], chords[..., 1:, :]
    return np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], (a * b).sum(axis=-1))


def _turned(points: Array) -> Array:
    """The angle (...) in rad from the first to the last chord of lines (..., m, 2)."""
    one, two = points[..., 1, :] - points[..., 0, :], points[..., -1, :] - points[..., -2, :]
    return np.asarray(np.arctan2(one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0], (one * two).sum(axis=-1)))


def _sharpened(level: Level, points: Array) -> Line:
    """The line with more points where it bends and a point in each corner."""
    ring = closed(points)
    around = np.vstack([points[-2:-1], points]) if ring else points
    turns = np.abs(_turns(around))
    first = 0 if ring else 1  # of the points that have a turn
    at = np.flatnonzero(turns > _BENDS)
    size = len(turns)
    tops: list[int] = []
    for i in at:
        beside = [turns[j % size] if ring else turns[j] for j in (i - 1, i + 1) if ring or 0 <= j < size]
        if all(turns[i] >= b for b in beside) and not (tops and tops[-1] == i - 1):
            tops.append(int(i))
    if ring and len(tops) > 1 and tops[0] == 0 and tops[-1] == size - 1:
        tops.pop()  # the first and the last chord meet in one corner
    if not tops:
        return Line(points)
    before, here, after = (around[[t + k for t in tops]] for k in (0, 1, 2))
    found = _zoomed(level, before, here, after)
    rows = list(points)
    corners, put = [], []
    for top, (stretch, corner) in zip(tops, found, strict=True):
        if corner is not None:
            corners.append(corner)
        put.append((top + first, stretch))
    for row, stretch in reversed(put):
        if len(stretch):
            rows[row : row + 1] = list(stretch)
    made = np.array(rows)
    if ring:
        made[-1] = made[0]
    return Line(made, tuple(corners))


def _zoomed(level: Level, before: Array, here: Array, after: Array) -> list[tuple[Array, Vertex | None]]:
    """Points of the boundary between ``before`` and ``after`` (k, 2) each, and the corner among them if there is one."""
    first: list[Array] = [np.empty((0, 2)) for _ in before]
    a, b = before, after
    bulge = here
    sharpest = np.zeros(len(a), dtype=int)
    good = np.ones(len(a), dtype=bool)
    fine = np.stack([before, here, after], axis=1)
    turned = []
    for zoom in range(_ZOOMS):
        fine, sound = _between(level, a, b, bulge)
        good &= sound
        turned.append(np.abs(_turned(fine)))
        if zoom == 0:
            first = list(fine[:, 1:-1])
        most = np.abs(_turns(fine)).argmax(axis=1)
        sharpest = most if zoom == 0 else sharpest  # the tip is beside this point of the stretch
        row = np.arange(len(a))
        a, bulge, b = fine[row, most], fine[row, most + 1], fine[row, most + 2]
    fades = np.all([later < _FADES * sooner for sooner, later in pairwise(turned[1:])], axis=0)
    result: list[tuple[Array, Vertex | None]] = []
    for i, stretch in enumerate(first):
        if not good[i]:
            result.append((here[i : i + 1], None))
            continue
        one, two = fine[i, 1] - fine[i, 0], fine[i, -1] - fine[i, -2]
        cross = one[0] * two[1] - one[1] * two[0]
        turn = _turned(fine[i])
        if abs(turn) < _CORNER or fades[i]:
            result.append((stretch, None))
            continue
        gap = fine[i, -1] - fine[i, 0]
        share = (gap[0] * two[1] - gap[1] * two[0]) / cross
        tip = fine[i, 0] + share * one if abs(np.sin(turn)) > 0.02 else fine[i, np.abs(_turns(fine[i])).argmax() + 1]
        if not _meets(level, tip, fine[i, 0], fine[i, -1], np.pi - float(abs(turn))):
            result.append((stretch, None))
            continue
        beside = int(sharpest[i]) + _comes_before(stretch[sharpest[i]] - tip, one, two)
        line = np.vstack([stretch[:beside], tip[None], stretch[beside:]])
        result.append((line, Vertex(tip, _right(one), _right(two))))
    return result


def _comes_before(way: Array, one: Array, two: Array) -> bool:
    """Whether what lies a ``way`` off a tip is on the side that leads to it along ``one``, not on that which leads away along ``two``."""
    one, two = one / (np.hypot(*one) or 1.0), two / (np.hypot(*two) or 1.0)
    if one @ two > 0.0:
        return bool(way @ (one + two) < 0.0)
    off = [abs(way[0] * side[1] - way[1] * side[0]) for side in (one, two)]  # of a sharp tip both sides lead the same way
    return bool(off[0] < off[1])


def _meets(level: Level, tip: Array, before: Array, after: Array, opening: float) -> bool:
    """Whether the boundary passes through the middles of both sides of a tip, as it does not where a tip is too thin to be followed."""
    share = min(0.05, 0.25 * opening)
    sides = np.array([tip - before, after - tip])
    middles = np.array([before + tip, tip + after]) / 2.0
    aside = share * np.column_stack([sides[:, 1], -sides[:, 0]])
    return bool(_inside(level, middles - aside).all() and not _inside(level, middles + aside).any())


def _between(level: Level, a: Array, b: Array, bulge: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Lines (k, 17, 2) of the boundary over the chords from a to b (k, 2), and which of them could be followed."""
    chord = b - a
    size = np.hypot(*chord.T)[:, None]
    aside = np.column_stack([chord[:, 1], -chord[:, 0]])  # to the right: out of the set
    height = ((bulge - a) * aside).sum(axis=1, keepdims=True) / np.where(size > 0.0, size, 1.0) ** 2
    share = (np.arange(1, _BETWEEN) / _BETWEEN)[None, :, None]
    along, middle = a[:, None] + share * chord[:, None], (a + b)[:, None] / 2.0
    sides = np.where(share < 0.5, a[:, None], b[:, None])  # to the bulge and from it
    over = bulge[:, None] + np.abs(1.0 - 2.0 * share) * (sides - bulge[:, None])
    tall = (np.abs(height) > _TALL)[:, None]  # seen from the middle of the chord: a tip may lean over its ends
    foot = np.where(tall, middle, along)
    way = np.where(tall, np.sign(height)[:, None] * 2.0 * (over - middle), ((0.3 + 2.0 * np.abs(height)) * aside)[:, None])
    within = _inside(level, foot)[..., None]  # at a dent the chord lies outside
    inner = np.where(within, foot, foot - way)
    outer = np.where(within, foot + way, foot)
    for _ in range(4):  # a tip may be higher than it looks from its chord
        out, held = ~_inside(level, outer)[..., None], _inside(level, inner)[..., None]
        if out.all() and held.all():
            break
        outer, inner = np.where(out, outer, 2.0 * outer - foot), np.where(held, inner, 2.0 * inner - foot)
    sound: NDArray[np.bool_] = np.all(_inside(level, inner) & ~_inside(level, outer), axis=1)
    shape = inner.shape
    found = _halved(level, inner.reshape(-1, 2), outer.reshape(-1, 2)).reshape(shape)
    return np.concatenate([a[:, None], found, b[:, None]], axis=1), sound


def _right(chord: Array) -> Array:
    """The outward unit normal of a chord that has the set on its left."""
    return np.array([chord[1], -chord[0]]) / (np.hypot(*chord) or 1.0)


def normals(points: Array) -> Array:
    """Outward unit normals (m, 2) of the line (m, 2) that has the set on its left: those of parabolas through three points."""
    chords = np.diff(points, axis=0)
    sizes = np.maximum(np.hypot(*chords.T), np.finfo(float).tiny)[:, None]
    units = chords / sizes
    around = (units[-1:], sizes[-1:], units[:1], sizes[:1]) if closed(points) else (units[:1], sizes[:1], units[-1:], sizes[-1:])
    before, after = np.vstack([around[0], units]), np.vstack([units, around[2]])
    ways = before * np.vstack([sizes, around[3]]) + after * np.vstack([around[1], sizes])
    ways = np.where(np.abs(ways).sum(axis=1, keepdims=True) > 0.0, ways, before)
    return np.column_stack([ways[:, 1], -ways[:, 0]]) / np.hypot(*ways.T)[:, None]
