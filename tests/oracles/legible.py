"""What is wrong with a drawn sheet to whoever reads it, measured on the pixels that matplotlib's Agg canvas gives each artist."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

SLACK = 1.0  # pixels by which boxes may touch: an empty border of the letters


@dataclass(frozen=True)
class Words:
    """A text as the rectangle it covers: corners (4, 2) in pixels, in order."""

    text: str
    corners: np.ndarray

    @classmethod
    def of(cls, text: Text) -> Words:
        around, turn = text.get_window_extent(), text.get_rotation()
        text.set_rotation(0.0)
        level = text.get_window_extent()
        text.set_rotation(turn)
        c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        half = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.maximum([level.width - SLACK, level.height - SLACK], 0.0) / 2.0
        middle = [(around.x0 + around.x1) / 2.0, (around.y0 + around.y1) / 2.0]
        return cls(text.get_text(), half @ np.array([[c, s], [-s, c]]) + middle)

    def meets(self, other: Words) -> bool:
        """Whether the rectangles overlap: no side of either separates them."""
        for corners in (self.corners, other.corners):
            for side in np.diff(corners[:3], axis=0):
                normal = np.array([-side[1], side[0]])
                mine, theirs = self.corners @ normal, other.corners @ normal
                if mine.max() <= theirs.min() or theirs.max() <= mine.min():
                    return False
        return True

    def within(self, sheet: Figure) -> bool:
        (x0, y0), (x1, y1) = self.corners.min(axis=0), self.corners.max(axis=0)
        return bool(x0 >= sheet.bbox.x0 and y0 >= sheet.bbox.y0 and x1 <= sheet.bbox.x1 and y1 <= sheet.bbox.y1)


def faults(sheet: Figure) -> list[str]:
    """What a reader would trip over: words on words or cut off, axes that say no unit, legends on marks, marks out of view."""
    FigureCanvasAgg(sheet).draw()
    words = [Words.of(text) for text in _texts(sheet)]
    found = [f"{w.text!r} is cut off" for w in words if not w.within(sheet)]
    found += [f"{a.text!r} overlaps {b.text!r}" for a, b in combinations(words, 2) if a.meets(b)]
    for axes in sheet.axes:
        found += _silent(axes)
        marks = _marks(axes)
        shown = axes.get_window_extent().padded(SLACK)
        out = [mark for mark in marks if not shown.contains(*mark)]
        found += [f"{len(out)} marks lie outside the axes"] if out else []
        legends = [legend for legend in (axes.get_legend(), *sheet.legends) if legend is not None]
        for box in (legend.get_window_extent() for legend in legends):
            hidden = sum(bool(box.contains(*mark)) for mark in marks)
            found += [f"a legend covers {hidden} marks"] if hidden else []
    return found


def _texts(sheet: Figure) -> Iterator[Text]:
    """Everything written on the sheet, its title among its texts."""
    every: list[Text] = [*sheet.texts, *(text for legend in sheet.legends for text in legend.get_texts())]
    for axes in sheet.axes:
        every += [axes.title, *axes.texts, *(axes.get_legend().get_texts() if axes.get_legend() else [])]
        for axis in _seen(axes).values():
            every += [axis.label, axis.offsetText, *_ticks(axis)]
    return (text for text in every if text.get_visible() and text.get_text().strip())


def _seen(axes: Axes) -> dict[str, Axis]:
    """The axes that are drawn: one force has no second."""
    return {name: axis for name, axis in (("x", axes.xaxis), ("y", axes.yaxis)) if axis.get_visible()}


def _ticks(axis: Axis) -> list[Text]:
    """The labels at the ticks in view."""
    to_even = axis.get_transform().transform  # what lies evenly on the axis, also on a logarithmic one
    low, high = sorted(to_even(np.array(axis.get_view_interval())))
    ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
    seen = [tick for tick in ticks if low - 1e-9 * (high - low) <= to_even(np.array([tick.get_loc()]))[0] <= high + 1e-9 * (high - low)]
    return [tick.label1 for tick in seen if tick.label1.get_visible()]


def _silent(axes: Axes) -> list[str]:
    """The axes whose label names no quantity or neither a unit nor [–], unless their ticks are named in words."""
    found = []
    for name, axis in _seen(axes).items():
        label = axis.label.get_text()
        worded = any(re.match(r"[A-Za-z]", text.get_text()) for text in _ticks(axis))
        if not label or not (worded or re.search(r"\S[ \n]\[.+\]$", label)):
            found.append(f"the {name} axis says {label!r}: no quantity with a unit")
    return found


def _marks(axes: Axes) -> np.ndarray:
    """The marked points in pixels (n, 2)."""
    lines = [line for line in axes.lines if line.get_marker() not in ("", " ", "none", "None", None) and len(line.get_xdata())]
    points = [line.get_transform().transform(np.column_stack(line.get_data()).astype(float)) for line in lines]
    every = np.concatenate([np.empty((0, 2)), *points])
    return every[np.isfinite(every).all(axis=1)]
