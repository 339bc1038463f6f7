"""K in a plane: its boundary with corners, seams, normals and slips, as plain numbers that are drawn as they are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.gradient import gradient
from duhem.expression.numpy_ import Program, compiled
from duhem.law.curve_law import ParametricCriterion
from duhem.law.formula_law import Criterion
from duhem.portrait.framing import MARGIN, Framed, framed, missed
from duhem.portrait.lines import Line, Vertex, Window, closed, level_lines, normals, region, traced
from duhem.portrait.numbers import Numbered
from duhem.portrait.plane import Plane
from duhem.portrait.seams import switches

__all__ = ["NOTHING", "Arrow", "View", "beside", "section"]

Array = NDArray[np.float64]

NOTHING = "no point of $K$ is found here"
_ARROWS = 18
_ASIDE = 0.03  # of the window's size, from a corner
_SMOOTH = 0.94  # cosine between the normals beside a point, below which it has none
_POINT = 1e-12  # of the law's stresses: K that is no larger is drawn as a point
_SLENDER = 12.0  # times as long as wide, from where a section is not drawn to scale
_STEPS = 721  # angles at which a boundary curve is computed


@dataclass(frozen=True)
class Arrow:
    """A direction (2,) at a point (2,), of length 1 where it lies in the plane."""

    at: Array
    along: Array


@dataclass(frozen=True)
class View:
    """K in a plane, in a window of it.

    ``lines`` bound K, which lies on their left.  ``grid`` x, y and a value on them that is <= 0 in K where a formula is known; None
    for a boundary curve, which encloses K.  ``normals`` are outward and stand aside from corners; ``slips`` are there where the law's
    slip is not normal to K by definition.  ``whole`` where all of K is in the window.  ``remark`` says, with LaTeX, what of K the
    lines do not show, and ``points`` (m, 2) are points of such a part.
    """

    plane: Plane
    window: Window
    lines: tuple[Line, ...]
    grid: tuple[Array, Array, Array] | None = None
    seams: tuple[Array, ...] = ()
    normals: tuple[Arrow, ...] = ()
    slips: tuple[Arrow, ...] = ()
    whole: bool = True
    remark: str = ""
    points: Array = field(default_factory=lambda: np.empty((0, 2)))

    @property
    def slender(self) -> bool:
        """Whether the window is so much longer than wide that it is not drawn to scale."""
        a, b, c, d = self.window
        return max((b - a) / (d - c), (d - c) / (b - a)) > _SLENDER

    @property
    def corners(self) -> tuple[Vertex, ...]:
        """The corners of all lines."""
        return tuple(corner for line in self.lines for corner in line.corners)

    @property
    def outermost(self) -> float:
        """The greatest number on the axes."""
        return max(map(abs, self.window))

    @property
    def size(self) -> float:
        """The greater side of the window."""
        return _width(self.window)


@dataclass(frozen=True)
class Formula:
    """The formulas of a law over the coordinates of stress space, at fixed numbers."""

    law: Criterion
    g: Program = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "g", self.program(self.law.g))

    def program(self, expr: sp.Expr) -> Program:
        """The expression as a function of the forces and the pressure; an InputError for numbers beyond the doubles."""
        known = self.law.symbols()
        names = [*self.law.forces, *([self.law.pressure] if self.law.pressure else [])]
        return compiled(expr.xreplace(self.law.settled()), [known[name] for name in names])

    def level(self, plane: Plane) -> Callable[[Array], Array]:
        """g at points (..., 2) of a plane; nan where the pressure is above 0."""

        def value(points: Array) -> Array:
            at = plane.at(points)
            found = self.g(*np.moveaxis(at, -1, 0))
            return np.where(at[..., -1] > 0.0, np.nan, found) if self.law.pressure else found

        return value


def section(given: Numbered, plane: Plane, window: Window | None = None, *, needed: bool = True, reach: float = 0.0) -> View:
    """The section of K by a plane, in a window that shows all of it where that can be, and else what is up to ``reach``.

    InputError where it has no point of K and one is ``needed``.
    """
    if isinstance(given.law, ParametricCriterion):
        return _of_curve(given.law, plane, window)
    formula = Formula(given.law)
    level = formula.level(plane)
    scale = max(given.size, float(np.abs(plane.base).max()), reach)
    seen = Framed(window, True, np.empty((0, 2))) if window else framed(level, plane, scale, reach)
    if window is None and needed and not len(seen.points):
        tried = "0, along rays from it and where g falls to from there"
        remedy = "name another plane or pressure, or set other parameters"
        raise InputError(f"no point of K is found on {plane.plain}: looked at {tried}", where=given.law.name, remedy=remedy)
    if window is None and len(seen.points) and _width(seen.window) < _POINT * given.size:
        return _of_point(plane, seen.points.mean(axis=0), given.size)
    window = seen.window
    lines, value = traced(level, window)
    x, y, _ = region(lambda points: points[..., 0], window)
    found = View(plane, window, lines, (x, y, value), _seams(formula, plane, (x, y, value)), whole=seen.whole)
    found = replace(found, **_unseen(level, found, seen.points))
    found = replace(found, lines=tuple(_without_beginnings(found)))
    if not plane.slips:
        return found
    found = replace(found, normals=tuple(_normals(found)))
    return found if given.law.associated else replace(found, slips=_slips(formula, plane, found.normals))


def _width(window: Window) -> float:
    return max(window[1] - window[0], window[3] - window[2])


def _of_point(plane: Plane, point: Array, size: float) -> View:
    """K that is lost in the rounding of its law: a point, in a window of the size of the law's stresses."""
    (x, y), remark = point.tolist(), "all of $K$ is within $10^{-12}$ of one point"
    return View(plane, (x - size, x + size, y - size, y + size), (), remark=remark, points=point[None])


def _unseen(level: Callable[[Array], Array], found: View, points: Array) -> dict[str, Any]:
    """What a reader must be told of K that the lines do not show, and points of K that stand for what is too thin for lines."""
    assert found.grid is not None
    inside = found.grid[2] <= 0.0
    held = inside.any()
    if inside.all():
        return {"remark": "all of the window is $K$"}
    missing, lost = missed(level, found.window, found.grid, points)
    if missing:
        if not held:
            return {"remark": "$K$ is thinner than the picture resolves: only points that were met are drawn", "points": points}
        return {"remark": f"pieces of $K$ thinner than 1/{len(found.grid[0]) - 1} of the window may be missing", "points": lost}
    return {} if held else {"remark": NOTHING}


def _without_beginnings(found: View) -> Iterator[Line]:
    """The lines with the corners that are some: none is where a piece of K begins that is too thin for lines."""
    for line in found.lines:
        yield replace(line, corners=tuple(at for at in line.corners if not _within(found.points, at.point, _ASIDE * found.size)))


def _within(points: Array, of: Array, distance: float) -> bool:
    return bool((np.hypot(*(points - of).T) < distance).any())


def _seams(formula: Formula, plane: Plane, grid: tuple[Array, Array, Array]) -> tuple[Array, ...]:
    """Lines inside K on which g changes its piece."""
    x, y, _ = grid
    level, law = formula.level(plane), formula.law
    found = []
    for switch, others in switches(law.g, law.force_symbols()):
        at, rest = formula.program(switch), [formula.program(other) for other in others]

        def on(points: Array, at: Program = at) -> Array:
            return np.asarray(at(*np.moveaxis(plane.at(points), -1, 0)))

        value = on(np.stack(np.meshgrid(x, y), axis=-1))
        size = float(np.nanmax(np.abs(value))) if np.isfinite(value).any() else 0.0
        if size == 0.0 or not np.isfinite(size) or not ((value > 1e-9 * size).any() and (value < -1e-9 * size).any()):
            continue
        for line in level_lines(x, y, value / size):
            there = np.moveaxis(plane.at(line), -1, 0)
            kept = level(line) <= 0.0
            for other in rest:
                kept &= other(*there) <= 1e-9 * size
            ends = np.flatnonzero(np.diff(np.concatenate([[False], kept, [False]]).astype(int)))
            found += [line[a:b] for a, b in zip(ends[::2], ends[1::2], strict=True) if b - a > 1]
    return tuple(found)


def _normals(found: View) -> list[Arrow]:
    """Evenly along the boundary, aside from corners, whose normals are a fan, and from where a line that ends turns back."""
    step = sum(_length(line.points) for line in found.lines) / _ARROWS
    arrows: list[Arrow] = []
    for line in found.lines:
        points = line.points
        passed = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        count = max(1, round(passed[-1] / step))
        ways = normals(points)
        tips = np.array([corner.point for corner in line.corners]).reshape(-1, 2)
        around = len(points) - closed(points)
        for place in (np.arange(count) + 0.5) * passed[-1] / count:
            i = min(int(np.searchsorted(passed, place)), len(points) - 1)
            if i in (0, len(points) - 1) and not closed(points):
                continue
            smooth = ways[(i - 1) % around] @ ways[(i + 1) % around] > _SMOOTH
            if smooth and not _within(tips, points[i], _ASIDE * found.size):
                arrows.append(Arrow(points[i], ways[i]))
    return arrows


def _length(points: Array) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def beside(given: Numbered, found: View, point: Array) -> View:
    """The section with no normals but that of the boundary next to a point (2,), and the law's own slip there."""
    if not found.lines or not found.plane.slips:
        return replace(found, normals=(), slips=())
    points = np.vstack([line.points for line in found.lines])
    ways = np.vstack([normals(line.points) for line in found.lines])
    nearest = int(np.argmin(np.hypot(*(points - point).T)))
    arrows = (Arrow(points[nearest], ways[nearest]),)
    law = given.law
    if law.associated:
        return replace(found, normals=arrows, slips=())
    if isinstance(law, ParametricCriterion):
        return replace(found, normals=arrows, slips=_Curve(law, found.plane).slips(arrows))
    slips = _slips(Formula(law), found.plane, arrows)
    return replace(found, normals=arrows, slips=slips)


def _slips(formula: Formula, plane: Plane, at_normals: Sequence[Arrow]) -> tuple[Arrow, ...]:
    """The law's own slip where the normals stand, as long in the plane as its part there; of several surfaces that of the one reached."""
    law = formula.law
    if not at_normals:
        return ()
    points = np.array([arrow.at for arrow in at_normals])
    at = np.moveaxis(plane.at(points), -1, 0)
    if law.surfaces:
        reached = np.array([formula.program(s.g)(*at) for s in law.surfaces]).argmax(axis=0)
        flows = [s.flow or gradient(s.g, law.force_symbols()) for s in law.surfaces]
    else:
        reached, flows = np.zeros(len(points), dtype=int), [law.flow or ()]
    rate = np.array([[formula.program(part)(*at) for part in flow] for flow in flows])  # surface, force, point
    chosen = rate[reached, :, np.arange(len(points))]
    if law.pressure:
        chosen = np.column_stack([chosen, np.zeros(len(points))])
    shares = plane.shares(chosen)
    size = np.linalg.norm(chosen, axis=1)
    return tuple(Arrow(p, s / w) for p, s, w in zip(points, shares, size, strict=True) if np.isfinite(s).all() and w > 0.0)


@dataclass(frozen=True)
class _Curve:
    """A boundary curve at fixed numbers, seen in a plane of its two forces."""

    law: ParametricCriterion
    plane: Plane

    def at(self, parts: Sequence[sp.Expr], angles: Array) -> Array:
        """Two components (m, 2) at angles (m,), in the order of the plane's axes."""
        known = self.law.symbols()
        fixed = {known[name]: domain.value for name, domain in self.law.parameters.items() if domain.value is not None}
        values = [compiled(part.xreplace(fixed), [known[self.law.angle]])(angles) for part in parts]
        return np.stack(values, axis=-1)[:, [int(np.argmax(self.plane.x)), int(np.argmax(self.plane.y))]]

    def points(self, angles: Array) -> Array:
        """The boundary (m, 2) under the pressure of the plane."""
        return abs(float(self.plane.base[-1])) * self.at(self.law.boundary, angles)

    def slips(self, normals: Sequence[Arrow]) -> tuple[Arrow, ...]:
        """The law's own slip at the points of the curve next to those of normals."""
        angles = np.linspace(0.0, 2.0 * np.pi, 8 * _STEPS)
        points = self.points(angles)
        at = angles[[int(np.argmin(np.hypot(*(points - arrow.at).T))) for arrow in normals]]
        ways = self.at(self.law.flow or (), at)
        return tuple(Arrow(arrow.at, way / np.hypot(*way)) for arrow, way in zip(normals, ways, strict=True))


def _of_curve(law: ParametricCriterion, plane: Plane, window: Window | None) -> View:
    """A boundary curve, computed at angles; its corners are where its tangent jumps."""
    curve = _Curve(law, plane)
    points = curve.points(np.linspace(0.0, 2.0 * np.pi, _STEPS))
    points[-1] = points[0]
    if window is None:
        (a, c), (b, d) = points.min(axis=0), points.max(axis=0)
        free = MARGIN * max(b - a, d - c)
        window = (float(a - free), float(b + free), float(c - free), float(d + free))
    size = max(window[1] - window[0], window[3] - window[2])
    shown = points[np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 1e-9 * size])]
    found = View(plane, window, (Line(shown, tuple(_jumps(shown))),))
    found = replace(found, normals=tuple(_normals(found)))
    return found if law.flow is None else replace(found, slips=curve.slips(found.normals))


def _jumps(points: Array) -> list[Vertex]:
    """Corners of a curve that is computed at many points: a turn by far more than beside it."""
    chords = np.diff(np.vstack([points[-2:-1], points]), axis=0)
    units = chords / np.hypot(*chords.T)[:, None]
    turns = np.array([np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b) for a, b in pairwise(units)])
    size = len(turns)
    found = []
    for i, turn in enumerate(turns):
        beside = max(abs(turns[(i - 2) % size]), abs(turns[(i + 2) % size]))
        if turn > np.radians(5.0) and turn > 4.0 * beside and turn >= max(turns[i - 1], turns[(i + 1) % size]):
            a, b = units[i], units[i + 1]
            found.append(Vertex(points[i], np.array([a[1], -a[0]]), np.array([b[1], -b[0]])))
    return found
