"""K in a plane: its boundary with corners, seams, normals and slips, as plain numbers that are drawn as they are.

The law has a number for each parameter: those given, those it fixes, and for what is left open a plain one inside its domain.  The window
that shows K is found along rays, from the signs of g and, where no ray meets K, down its values.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, pairwise
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression import Neg, Pos, Where
from duhem.expression.branches import gradient
from duhem.expression.numpy_ import Program, compiled
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_domain
from duhem.portrait.lines import Line, Vertex, Window, closed, level_lines, normals, region, traced
from duhem.portrait.plane import Plane
from duhem.proof.facts.formula_subject import admitted_values

__all__ = [
    "MARGIN", "NOTHING", "SLENDER", "Arrow", "Framed", "Numbered", "Switch", "View", "beside", "framed", "missed", "numbered", "section",
    "switches",
]  # fmt: skip

Array = NDArray[np.float64]
Level = Callable[[Array], Array]


@dataclass(frozen=True)
class Numbered:
    """A law with every parameter fixed, and the names of those that nobody gave: they are ``chosen`` to have something to draw."""

    law: Law
    chosen: tuple[str, ...] = ()

    def values(self) -> dict[str, sp.Rational]:
        """The numbers by name."""
        return {name: domain.value for name, domain in self.law.parameters.items() if domain.value is not None}

    @property
    def size(self) -> float:
        """The greatest of 1 and the parameters: where a boundary is looked for there are stresses of this order."""
        return max([1.0, *(abs(float(value)) for value in self.values().values() if np.isfinite(float(value)))])


def numbered(law: Law, given: Mapping[str, Any] | None = None) -> Numbered:
    """The law at the numbers ``given`` and plain ones for the others.

    InputError for a number outside its domain, and where none is found for what is left open.
    """
    fixed = law.fix(given)
    check_domain(fixed)
    left = tuple(name for name, domain in fixed.parameters.items() if domain.value is None)
    if (found := admitted_values(fixed)) is None:
        raise InputError(f"duhem found no numbers for {', '.join(left)}", where=law.name, remedy="give each of them")
    return Numbered(fixed.fix({name: found[name] for name in left}), left)


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
    endless, step = held[0] or held[-1], b - a
    long = step if len(turns) != 1 else max(-a, b)  # of one end alone: as far as from 0
    free = (1.0 if endless else 0.35) * (long if long > step or len(turns) != 1 else scale)
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
        high_x = min(box[1] + x_free, 0.0) if plane.pressed else box[1] + x_free
        box = (box[0] - x_free, high_x, box[2] - y_free, box[3] + y_free)
        if grow == 0.35:
            x, y, value = region(level, box, 121)
            if (found := level_lines(x, y, value)) and not (value[0] <= 0).any() and not (value[-1] <= 0).any():
                every = np.vstack(found)
                (a, c), (b, d) = every.min(axis=0), every.max(axis=0)
                box = (min(float(a), known[0]), max(float(b), known[1]), min(float(c), known[2]), max(float(d), known[3]))
                box = (box[0], 0.0, *box[2:]) if plane.pressed and (value[:, -1] <= 0).any() else box
    return box


_MOST = 24  # arguments of a maximum, beyond which the seams between them are not looked for

Switch = tuple[sp.Expr, tuple[sp.Expr, ...]]
"""An expression that is 0 on a seam, and others that are <= 0 where the seam is one: elsewhere another piece holds."""


def switches(g: sp.Expr, forces: Sequence[sp.Symbol]) -> tuple[Switch, ...]:
    """Where a formula changes its piece, by what its kinks compare: the seams, each once; a factor before a comparison is dropped."""
    found: dict[sp.Expr, Switch] = {}
    for node in sp.preorder_traversal(g):
        for switch, others in _of(node):
            plain = switch.as_coeff_Mul()[1]
            if plain.free_symbols & set(forces):
                found.setdefault(plain, (switch, others))
    return tuple(found.values())


def _of(node: sp.Basic) -> Iterator[Switch]:
    if isinstance(node, sp.Abs | Pos | Neg):
        yield node.args[0], ()
    elif isinstance(node, sp.Max | sp.Min) and len(node.args) <= _MOST:
        sense = 1 if isinstance(node, sp.Max) else -1
        for a, b in combinations(node.args, 2):
            yield a - b, tuple(sense * (c - a) for c in node.args if c not in (a, b))
    elif isinstance(node, Where):
        for relation in node.args[0].atoms(sp.core.relational.Relational):
            yield relation.lhs - relation.rhs, ()


NOTHING = "no point of $K$ is found here"
_ARROWS = 18
_ASIDE = 0.03  # of the window's size, from a corner
_SMOOTH = 0.94  # cosine between the normals beside a point, below which it has none
_POINT = 1e-12  # of the law's stresses: K that is no larger is drawn as a point
SLENDER = 12.0  # times as long as wide, from where a section is not drawn to scale
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
        return max((b - a) / (d - c), (d - c) / (b - a)) > SLENDER

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
        return compiled(expr.xreplace(self.law.settled()), [known[name] for name in self.law.coordinates])

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
        tried = "zero force, rays from it, and the minimum of g found from there"
        remedy = "choose another plane or pressure, or other parameters"
        raise InputError(f"duhem found no point of K on {plane.plain}; it searched {tried}", where=given.law.name, remedy=remedy)
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
    (x, y), remark = point.tolist(), "$K$ is a single point, up to $10^{-12}$"
    return View(plane, (x - size, x + size, y - size, y + size), (), remark=remark, points=point[None])


def _unseen(level: Callable[[Array], Array], found: View, points: Array) -> dict[str, Any]:
    """What a reader must be told of K that the lines do not show, and points of K that stand for what is too thin for lines."""
    assert found.grid is not None
    inside = found.grid[2] <= 0.0
    held = inside.any()
    if inside.all():
        return {"remark": "$K$ fills the whole picture"}
    missing, lost = missed(level, found.window, found.grid, points)
    if missing:
        if not held:
            return {"remark": "$K$ is too thin for this picture: the points are some points of $K$", "points": points}
        return {"remark": f"pieces of $K$ thinner than 1/{len(found.grid[0]) - 1} of the picture may be missing", "points": lost}
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
    shown = points[np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 1e-9 * _width(window)])]
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
