"""Sections drawn in the house style (extra ``plot``)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from duhem.law.units import UNIT
from duhem.portrait.lines import Vertex, closed
from duhem.portrait.marks import TrialStep, Violation
from duhem.portrait.section import Arrow, View
from duhem.show import figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["fill", "paint_section", "paint_step", "paint_violation"]

Array = NDArray[np.float64]
_DARK = "0.25"  # of normals: pink beside it is grey to one reader in twenty
_ARROW = 0.085  # of the window's size
_SHAFT = 0.0135  # inches
_BLUE, _RED, _GREEN, _ORANGE = (figure.palette(i) for i in (0, 1, 2, 4))
_REMARK = 3.2  # inches: no wider than a panel among others
_SPREAD = 3  # normals of a fan beside its two sides
_ROLES = {"sigma": r"$\sigma$", "inside": r"$\sigma$", "tau": r"$\tau$", "midpoint": "midpoint", "origin": "$0$"}


def paint_section(axes: Axes, found: View, unit: str = "", title: str = "", *, fans: bool = True, size: float = 0.0) -> None:
    """K, its boundary, normals with fans at corners, seams, and slips that are not normal; ``size`` as in :func:`frame`."""
    frame(axes, found, unit, title, size)
    fill(axes, found)
    for i, seam in enumerate(found.seams):
        axes.plot(*seam.T, color=figure.GREY, linestyle=(0, (1, 2)), linewidth=1.2, label="_" if i else "seam of $g$", zorder=2)
    for i, line in enumerate(found.lines):
        axes.plot(*line.points.T, color=_BLUE, linewidth=1.8, label="_" if i else "boundary of $K$", zorder=3, gid=figure.EDGE)
    a, b, c, d = found.window
    x, y = found.points.T
    shown = found.points[(x >= a) & (x <= b) & (y >= c) & (y <= d)]
    if len(shown):
        axes.plot(*shown.T, ".", color=_BLUE, markersize=4, label="points of $K$", zorder=3)
    if found.slender:
        return  # a normal would not look like one
    long = _ARROW * found.size
    if found.plane.slips and found.plane.y_symbol:
        if fans:
            _fans(axes, [corner for corner in found.corners if corner.convex], long)
        _arrows(axes, _whole(found, found.normals, long), long, _DARK, "normal", found.slips == ())
    if found.slips:
        _arrows(axes, _whole(found, found.slips, 1.25 * long), 1.25 * long, _RED, "slip direction (not normal)", True)


def frame(axes: Axes, found: View, unit: str, title: str = "", size: float = 0.0) -> None:
    """The window with its axes through 0, to scale, and what is measured on them, in a unit that suits the ``size`` of a whole sheet."""
    a, b, c, d = found.window
    for rule, ends in ((axes.axhline, (c, d)), (axes.axvline, (a, b))):
        if ends[0] < 0.0 < ends[1]:
            rule(0.0, color="0.85", linewidth=0.7, zorder=0)
    for symbol, way in found.plane.guides.items():
        far = [edge / part for edge, part in ((b if way[0] > 0 else a, way[0]), (d if way[1] > 0 else c, way[1])) if part]
        x, y = (0.94 * min(far) * part for part in way)
        axes.plot([0.0, x], [0.0, y], color="0.7", linewidth=0.8, zorder=0.5)
        paper = {"facecolor": "white", "linewidth": 0, "pad": 1.0}
        axes.text(x, y, f"${symbol}$", fontsize="small", color="0.35", ha="center", va="center", bbox=paper, zorder=0.6)
    axes.set_xlim(a, b)
    axes.set_ylim(c, d)
    wide, high = max(abs(a), abs(b)), max(abs(c), abs(d))
    if not (found.slender or found.plane.pressed):  # along the pressure there are no normals, whose angles would have to be right
        axes.set_aspect("equal", adjustable="box")
        wide = high = max(wide, high, size)  # one scale, one unit
    figure.measure(axes.xaxis, found.plane.x_symbol, unit or UNIT, wide)
    figure.measure(axes.yaxis, found.plane.y_symbol, unit or UNIT, high)
    if not found.plane.y_symbol:
        axes.yaxis.set_visible(False)
    said, remark = (figure.wrapped(text, _REMARK) for text in (title, found.remark))
    lines = [said, found.plane.told(unit), "different scales on the two axes" if found.slender else "", remark]
    axes.set_title("\n".join(line for line in lines if line))


def fill(axes: Axes, found: View, lines: str = "", **look: Any) -> None:
    """The area of K, perhaps with ``lines`` over it: what its boundary encloses, or where that leaves the window, what the grid says."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    look = {"facecolor": _BLUE, "alpha": 0.14, "linewidth": 0, "zorder": 1, "label": "$K$"} | look
    if all(closed(line.points) for line in found.lines) and found.lines and not _filled_edge(found):
        paths = [Path(line.points, closed=True) for line in found.lines]
    elif found.grid is not None:
        from contourpy import FillType, contour_generator

        made: Any = contour_generator(*found.grid, fill_type=FillType.OuterOffset).filled(-np.inf, 0.0)
        paths = [
            Path(points[s:e], closed=True)
            for points, places in zip(*made, strict=True)
            for s, e in zip(places[:-1].astype(int), places[1:].astype(int), strict=True)
        ]
    else:
        return
    if not paths:
        return
    area = PathPatch(Path.make_compound_path(*paths), **look)
    if lines:
        figure.hatched(axes, area, lines, "black")
    else:
        axes.add_patch(area)


def _filled_edge(found: View) -> bool:
    """Whether K reaches the edge of the window."""
    if found.grid is None:
        return False
    value = found.grid[2]
    return bool((value[0] <= 0).any() or (value[-1] <= 0).any() or (value[:, 0] <= 0).any() or (value[:, -1] <= 0).any())


def _fans(axes: Axes, corners: Iterable[Vertex], size: float) -> None:
    from matplotlib.patches import Polygon

    for i, corner in enumerate(corners):
        turn = np.arctan2(corner.before[0] * corner.after[1] - corner.before[1] * corner.after[0], corner.before @ corner.after)
        start = np.arctan2(corner.before[1], corner.before[0])
        angles = start + np.linspace(0.0, turn, 24)
        rim = corner.point + size * np.column_stack([np.cos(angles), np.sin(angles)])
        area = np.vstack([corner.point, rim])
        label = "_" if i else "normal cone at a corner"
        cone = Polygon(area, closed=True, facecolor=_ORANGE, alpha=0.35, linewidth=0, zorder=2.5, label=label)
        figure.hatched(axes, cone, "///", _DARK)
        ways = start + np.linspace(0.0, turn, 2 + (_SPREAD if abs(turn) > 0.8 else 0))
        _arrows(axes, [Arrow(corner.point, np.array([np.cos(w), np.sin(w)])) for w in ways], size, _DARK, "", True)


def _whole(found: View, arrows: Sequence[Arrow], size: float) -> Sequence[Arrow]:
    """The arrows that the window holds whole; all of them where it holds none so."""
    a, b, c, d = found.window
    tips = ((arrow, arrow.at + size * arrow.along) for arrow in arrows)
    return [arrow for arrow, (x, y) in tips if a <= x <= b and c <= y <= d] or arrows


def _arrows(axes: Axes, arrows: Iterable[Arrow], size: float, colour: str, label: str, first: bool) -> None:
    """Arrows of one length; a legend shows a line with a head."""
    every, wide = list(arrows), 1.0 if colour == _DARK else 1.5
    if not every:
        return
    x, y = np.array([a.at for a in every]).T.tolist()
    u, v = (size * np.array([a.along for a in every])).T.tolist()
    axes.quiver(
        x, y, u, v, angles="xy", scale_units="xy", scale=1.0, units="inches", width=wide * _SHAFT, headwidth=4.2, headlength=5.0,
        headaxislength=4.6, color=colour, zorder=4 if first else 3.5, clip_on=True,
    )  # fmt: skip
    if label:
        axes.plot([], [], color=colour, linewidth=wide, marker=">", markersize=2.5 + 1.5 * wide, label=label)


def paint_step(axes: Axes, step: TrialStep) -> None:
    """A trial stress, the closest point of K and the way between them."""
    _way(axes, step.trial, step.stress, color=_GREEN, linewidth=1.2, linestyle="--", zorder=6)
    axes.plot(*step.trial, "s", color=_GREEN, markersize=6, label=r"trial stress $\sigma^\mathrm{tr}$", zorder=6)
    axes.plot(*step.stress, "o", color="black", markersize=5, label=f"stress at the end ({step.status})", zorder=6)
    if step.slip is not None:
        _way(axes, step.stress, step.stress + step.slip, color=_RED, linewidth=1.8, zorder=6.5)
        axes.plot([], [], color=_RED, linewidth=1.8, marker=">", markersize=4, label=r"direction of the slip $\Delta u^\mathrm{in}$")


def _way(axes: Axes, start: Array, end: Array, **look: Any) -> None:
    from matplotlib.patches import FancyArrowPatch

    ends = [(float(x), float(y)) for x, y in (start, end)]
    axes.add_patch(FancyArrowPatch(*ends, arrowstyle="-|>", mutation_scale=12.0, shrinkA=0.0, shrinkB=2.0, **look))


def paint_violation(axes: Axes, seen: Violation, unit: str, title: str) -> None:
    """The section with the points of a witness and the way between two of them."""
    paint_section(axes, seen.section, unit, title, fans=False)
    if seen.way is not None:
        axes.plot(
            *seen.way.T, color=_RED, linewidth=2.0, linestyle=(0, (5, 1.5)), zorder=5, label="chord between two points", gid=figure.OPEN
        )
    for i, (role, point) in enumerate(seen.points.items()):
        mark, label = "X" if role == "midpoint" else "o", "_" if i else "witness"
        axes.plot(*point, mark, color=_RED, markeredgecolor="black", markersize=7, zorder=6, label=label)
        words = role if "corner" in seen.points else _ROLES.get(role, f"${role}$" if len(role) == 1 else role)
        figure.note(axes, words, (float(point[0]), float(point[1])))
