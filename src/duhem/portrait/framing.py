"""Where K lies in a plane, and the window that shows it: seen along rays, from its signs and, where no ray meets K, down the values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.portrait.lines import Window, level_lines, region
from duhem.portrait.plane import Plane

__all__ = ["MARGIN", "Framed", "framed", "missed"]

Array = NDArray[np.float64]
Level = Callable[[Array], Array]

MARGIN = 0.16  # of the size of K that is left free around it, for normals

_DECADES = (-6.0, 8.0)
_FAR = (-30.0, 30.0)  # decades where these say nothing, or only that all is K
_PER_DECADE = 10
_GUIDED = 0.26  # and where the names of axes stand beyond them
_ENDLESS = 2.5  # how much more than what ends is shown of a K that does not end
_BEYOND = 1.25  # times what it is to reach
_FEW = 5  # rays, of which the ends of so many tell how large a K is that does not end
_THIN = 30.0  # times as long as wide, from where each side has a margin of its own
_DESCENTS = 90  # rings around a point whose value falls
_RING = np.array([[np.cos(t), np.sin(t)] for t in np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)])


def _ways(count: int) -> Array:
    """Directions (count, 2) all around, exactly along the axes and their bisectors, and each with its opposite and mirrored ones."""
    angles = np.linspace(0.0, np.pi / 4.0, count // 8, endpoint=False)
    cos, sin = np.cos(angles), np.sin(angles)
    half = [[np.sqrt(0.5), np.sqrt(0.5)]]
    quarter = np.vstack([np.column_stack([cos, sin]), half, np.column_stack([sin, cos])[:0:-1]])
    turned = np.column_stack([-quarter[:, 1], quarter[:, 0]])
    return np.vstack([quarter, turned, -quarter, -turned])


_WAYS = _ways(96)


@dataclass(frozen=True)
class Framed:
    """A ``window``, whether ``whole`` K is in it, and points (m, 2) of K that were met on the way: none where none was found."""

    window: Window
    whole: bool
    points: Array


def framed(level: Level, plane: Plane, scale: float, reach: float = 0.0) -> Framed:
    """A window around K, seen from the plane's 0 along rays of many lengths, or from a point to which the level falls.

    Of a K that does not end it shows what is up to ``reach``, and beyond.
    """
    if not plane.y_symbol:
        return _on_line(level, scale)
    start = np.zeros(2)
    points, inside, radii = _rays(level, start, scale, _DECADES)
    if not inside.any():
        start = _lowest(level, points, scale)
        points, inside, radii = _rays(level, start, scale, _FAR)
        if level(start) <= 0.0 and not inside.any():
            free = max(scale, 1.2 * float(np.abs(start).max()))
            return Framed(_pressed(plane, (start[0] - free, start[0] + free, start[1] - free, start[1] + free)), False, start[None])
    if not inside.any():
        return Framed(_pressed(plane, (-scale, scale, -scale, scale)), False, np.empty((0, 2)))
    if inside.all():
        points, inside, radii = _rays(level, start, scale, _FAR)
    known = points[inside]
    ends = inside[-_PER_DECADE:].any(axis=0)
    if not ends.any():
        x, y = known.T
        return Framed(_closer(level, plane, (float(x.min()), float(x.max()), float(y.min()), float(y.max()))), True, known)
    lengths = np.where(inside, radii[:, None], 0.0).max(axis=0)[~ends]
    lengths = lengths[(lengths > radii[0]) & (lengths < radii[-_PER_DECADE])]
    first = inside[0].any()
    near = radii[inside.any(axis=1)][0]
    size = _ENDLESS * (float(np.median(lengths)) if len(lengths) >= _FEW else max(scale if first else 0.0, 1.5 * near))
    size = max(size, _BEYOND * reach)
    box = _pressed(plane, (-size, size, -size, size))
    if not plane.pressed:
        return Framed(box, False, known)
    x, y, value = region(level, box, 121)
    high = size
    if (value[[0, -1]][:, x > -0.98 * size] <= 0).any():  # cut off along the pressure: shown whole where twice the height does it
        _, above, more = region(level, (*box[:2], -2.0 * size, 2.0 * size), 241)
        if not (more[[0, -1]] <= 0).any():
            y, value, high = above, more, 2.0 * size
    rows = y[(value <= 0).any(axis=1)]
    if len(rows):
        free = MARGIN * max(size, rows[-1] - rows[0]) / 2.0
        box = (*box[:2], float(max(rows[0] - free, -high)), float(min(rows[-1] + free, high)))
    return Framed(box, False, known)


def missed(level: Level, window: Window, grid: tuple[Array, Array, Array], points: Array) -> tuple[bool, Array]:
    """Whether a point of K, of those given or in the middle of a cell of the grid, lies where no corner of cells around is in K.

    And those given (m, 2) that do.
    """
    x, y, value = grid
    held = np.pad(value <= 0.0, 1)
    seen = np.asarray(np.lib.stride_tricks.sliding_window_view(held, (4, 4)).any(axis=(2, 3)))
    a, b, c, d = window
    near = points[(points[:, 0] >= a) & (points[:, 0] <= b) & (points[:, 1] >= c) & (points[:, 1] <= d)]
    i = np.clip(np.searchsorted(x, near[:, 0]) - 1, 0, len(x) - 2)
    j = np.clip(np.searchsorted(y, near[:, 1]) - 1, 0, len(y) - 2)
    lost = near[~seen[j, i]]
    middles = np.stack(np.meshgrid((x[1:] + x[:-1]) / 2.0, (y[1:] + y[:-1]) / 2.0), axis=-1)
    return len(lost) > 0 or bool(((level(middles) <= 0.0) & ~seen).any()), lost


def _pressed(plane: Plane, box: Window) -> Window:
    return (float(box[0]), 0.0 if plane.pressed else float(box[1]), float(box[2]), float(box[3]))


def _rays(level: Level, start: Array, scale: float, decades: tuple[float, float]) -> tuple[Array, NDArray[np.bool_], Array]:
    """Points (m, 96, 2) around one, whether they lie in K, and their distances (m,)."""
    radii = scale * np.logspace(*decades, int(_PER_DECADE * (decades[1] - decades[0])) + 1)
    points = start + radii[:, None, None] * _WAYS
    with np.errstate(all="ignore"):
        return points, level(points) <= 0.0, radii


def _lowest(level: Level, points: Array, scale: float) -> Array:
    """Where a level falls to, from the least of points: rings around it that shrink where none of their points is lower."""
    every = np.vstack([np.zeros((1, 2)), points.reshape(-1, 2)])
    value = level(every)
    value = np.where(np.isnan(value), np.inf, value)
    at = int(np.argmin(value))
    best, least = every[at], value[at]
    size = max(float(np.abs(best).max()), 1e-3 * scale)
    for _ in range(_DESCENTS):
        if least <= 0.0:
            break
        ring = best + size * _RING
        around = level(ring)
        around = np.where(np.isnan(around), np.inf, around)
        at = int(np.argmin(around))
        if around[at] < least:
            best, least = ring[at], around[at]
        else:
            size /= 2.0
    return best


def _on_line(level: Level, scale: float) -> Framed:
    """The window of one force: from the ends of what is K on its axis."""
    far = scale * np.logspace(*_DECADES, 12 * _PER_DECADE * 14 + 1)
    near = np.linspace(-20.0 * scale, 20.0 * scale, 4001)
    x = np.unique(np.concatenate([-far, near, far]))
    held = level(np.column_stack([x, np.zeros(len(x))])) <= 0.0
    known = np.column_stack([x[held], np.zeros(int(held.sum()))])
    if not held.any():
        return Framed((-scale, scale, -scale, scale), False, known)
    turns = np.flatnonzero(held[1:] != held[:-1])
    ends = np.array([*x[turns], *x[turns + 1]]) if len(turns) else np.array([-scale, scale])
    a, b = float(ends.min()), float(ends.max())
    endless = held[0] or held[-1]
    free = (1.0 if endless else 0.35) * ((b - a) or abs(a) or scale)
    a, b = a - free, b + free
    return Framed((a, b, -0.3 * (b - a), 0.3 * (b - a)), not endless, known)


def _closer(level: Level, plane: Plane, box: Window) -> Window:
    """The window of a K that ends: first by the rays, then by the boundary in it; one side by itself where K is thin along it."""
    known = box
    for grow in (0.35, _GUIDED if plane.guides else MARGIN):
        wide, high = box[1] - box[0], box[3] - box[2]
        long = max(wide, high)
        each = (wide, high) if min(wide, high) > 0.0 and long > _THIN * min(wide, high) and not plane.guides else (long, long)
        x_free, y_free = (grow * size or 1.0 for size in each)
        box = _within(plane, (box[0] - x_free, box[1] + x_free, box[2] - y_free, box[3] + y_free))
        if grow == 0.35:
            x, y, value = region(level, box, 121)
            if (found := level_lines(x, y, value)) and not (value[0] <= 0).any() and not (value[-1] <= 0).any():
                every = np.vstack(found)
                (a, c), (b, d) = every.min(axis=0), every.max(axis=0)
                box = (min(float(a), known[0]), max(float(b), known[1]), min(float(c), known[2]), max(float(d), known[3]))
                box = (box[0], 0.0, *box[2:]) if plane.pressed and (value[:, -1] <= 0).any() else box
    return box


def _within(plane: Plane, box: Window) -> Window:
    return (box[0], min(box[1], 0.0), *box[2:]) if plane.pressed else box
