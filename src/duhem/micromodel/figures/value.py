"""A figure as a value, what is on it in numbers before anything is drawn, how it is made (a function of named numbers) and drawn."""

from __future__ import annotations

import csv
import inspect
import io
import math
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError, meant
from duhem.show import figure as show
from duhem.show.page import Page

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Sheet

__all__ = [
    "Array",
    "Arrows",
    "Axis",
    "Band",
    "Curve",
    "Fact",
    "Figure",
    "Layer",
    "Marks",
    "Note",
    "Panel",
    "Recipe",
    "Rule",
    "Table",
    "draw",
    "save",
    "unknown",
]

Array = NDArray[np.float64]
Row = tuple[str, float, float, float, float]  # series, x, y, dx, dy
_NONE = math.nan


@dataclass(frozen=True)
class Fact:
    """A number that the figure shows or rests on: ``value`` in ``unit`` (empty for a dimensionless one)."""

    name: str
    value: float
    unit: str = ""

    def __str__(self) -> str:
        return f"{self.name} = {self.value:.6g} {self.unit}".rstrip()


@dataclass(frozen=True)
class Axis:
    """``symbol`` as on the figure (mathtext), ``name`` the same in plain text, ``unit`` of the numbers.

    ``limits`` of the view and ``step`` of its ticks where the numbers alone do not give good ones.
    """

    name: str
    symbol: str
    unit: str = ""
    limits: tuple[float, float] | None = None
    step: float | None = None

    def __str__(self) -> str:
        return f"{self.name} ({self.unit})" if self.unit else self.name


@dataclass(frozen=True, eq=False)
class _Points:
    """Places (x, y), both (n,).

    Here and below ``name`` is the key, ``label`` what stands on the figure (mathtext; nothing if empty), and ``hue`` a place
    in the palette, None for grey.
    """

    name: str
    x: Array
    y: Array
    hue: int | None = 0
    label: str = ""

    def rows(self) -> Iterator[Row]:
        return ((self.name, x, y, _NONE, _NONE) for x, y in zip(self.x.tolist(), self.y.tolist(), strict=True))


class Curve(_Points):
    """A line through places."""


class Marks(_Points):
    """Marks at places."""


@dataclass(frozen=True, eq=False)
class Arrows:
    """Unit directions ``along`` (n, 2) from the points ``start`` (n, 2); ``length`` is that of each in units of the axes."""

    name: str
    start: Array
    along: Array
    length: float
    hue: int | None = None
    label: str = ""

    def rows(self) -> Iterator[Row]:
        return ((self.name, *p, *d) for p, d in zip(self.start.tolist(), self.along.tolist(), strict=True))


@dataclass(frozen=True)
class Rule:
    """A line across the panel: all points whose ``axis`` coordinate is ``at``."""

    name: str
    axis: Literal["x", "y"]
    at: float
    hue: int | None = None
    label: str = ""

    def rows(self) -> Iterator[Row]:
        yield (self.name, self.at, _NONE, _NONE, _NONE) if self.axis == "x" else (self.name, _NONE, self.at, _NONE, _NONE)


@dataclass(frozen=True)
class Band:
    """A range low <= x <= high, shaded."""

    name: str
    low: float
    high: float
    label: str = ""

    def rows(self) -> Iterator[Row]:
        return ((self.name, end, _NONE, _NONE, _NONE) for end in (self.low, self.high))


@dataclass(frozen=True)
class Note:
    """Words (mathtext) at a point; ``side`` is where they stand as seen from it."""

    text: str
    x: float
    y: float
    side: Literal["left", "above left", "below right", "centre"]

    def rows(self) -> Iterator[Row]:
        return iter(())


Layer = Curve | Marks | Arrows | Rule | Band | Note


@dataclass(frozen=True, eq=False)
class Panel:
    """Two axes and what is drawn on them, the first layer lowest; ``equal`` where a length is the same on both.

    ``legend`` is where there is room for it.
    """

    x: Axis
    y: Axis
    layers: tuple[Layer, ...]
    equal: bool = False
    legend: Literal["above", "lower right"] = "above"

    def __getitem__(self, name: str) -> Any:
        """The layer of that name; KeyError if there is none."""
        return {layer.name: layer for layer in self.layers if not isinstance(layer, Note)}[name]


@dataclass(frozen=True, eq=False, kw_only=True)
class _Made:
    """What a recipe says of what it has made: ``settings`` are the parameters it was computed from, ``source`` author, year, figure."""

    title: str = ""
    source: str = ""
    settings: Mapping[str, float] = field(default_factory=dict)
    facts: tuple[Fact, ...] = ()

    def __getitem__(self, name: str) -> float:
        """The value of the fact of that name; KeyError if there is none."""
        return {fact.name: fact.value for fact in self.facts}[name]


@dataclass(frozen=True, eq=False)
class Figure(_Made):
    """Panels side by side."""

    panels: tuple[Panel, ...]

    def to_csv(self) -> str:
        """Every point of every layer, one a row: panel, series, x, y, and the direction dx, dy of an arrow."""
        rows = (
            (f"{panel.y} over {panel.x}", series, *map(_cell, numbers))
            for panel in self.panels
            for layer in panel.layers
            for series, *numbers in layer.rows()
        )
        return _csv(("panel", "series", "x", "y", "dx", "dy"), rows)


@dataclass(frozen=True, eq=False)
class Table(_Made):
    """A figure that says more in rows: ``rows`` of text and numbers under ``columns``; ``remarks`` below them."""

    columns: tuple[str, ...]
    rows: tuple[tuple[str | float, ...], ...]
    remarks: tuple[str, ...] = ()

    def column(self, name: str) -> tuple[str | float, ...]:
        """One column from top to bottom."""
        at = self.columns.index(name)
        return tuple(row[at] for row in self.rows)

    def to_csv(self) -> str:
        """The table; every number is read back to the last bit."""
        return _csv(self.columns, (tuple(map(_cell, row)) for row in self.rows))

    def to_text(self, width: int | None = None) -> str:
        """The table in columns for reading, numbers to four digits, with its remarks; lines of any length or folded at ``width``."""
        cells = [self.columns, *(tuple(f"{c:.4g}" if isinstance(c, float) else c for c in row) for row in self.rows)]
        align = "".join("l" if isinstance(c, str) else "r" for c in self.rows[0])
        page = Page(width)
        return "\n".join([*page.table(cells, align, ""), *(line for remark in self.remarks for line in page.hanging(remark))])


def _cell(value: str | float) -> str:
    return value if isinstance(value, str) else "" if math.isnan(value) else repr(float(value))


def _csv(header: tuple[str, ...], rows: Any) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return stream.getvalue()


@dataclass(frozen=True)
class Recipe:
    """The figure ``name``; its parameters and their defaults are those of ``function``; ``drawn`` unless it is a table."""

    name: str
    title: str
    source: str
    function: Callable[..., Figure | Table]
    drawn: bool = True

    @property
    def parameters(self) -> Mapping[str, float]:
        """Name and default of each parameter, in order."""
        return {name: float(p.default) for name, p in inspect.signature(self.function).parameters.items()}

    def __call__(self, **settings: float) -> Figure | Table:
        """The figure, computed from its defaults and ``settings``.  InputError for an unknown name or what is no finite number."""
        known = self.parameters
        given = {**known, **settings}
        for name, value in settings.items():
            if name not in known:
                raise unknown(f"parameter of figure {self.name}", name, known)
            if not math.isfinite(value):
                raise InputError(f"{name} is {value}", where=f"figure {self.name}", remedy="give a finite number")
        return replace(self.function(**given), title=self.title, source=self.source, settings=given)


def unknown(what: str, name: str, known: Mapping[str, object]) -> InputError:
    """The error for a name that is not among ``known``, with the nearest of them."""
    return InputError(f"unknown {what} {name[:60]!r}", remedy=meant(name, known, f"there are: {', '.join(known)}", both=True))


# -- drawn (extra plot) ------------------------------------------------------------------------------------------------


_DOTS = show.pen(3)["linestyle"]  # grey is told from the first of the palette by its dots
_SIDES = {
    "centre": ((0, 0), "center", "center"),
    "left": ((-7, 0), "right", "center"),
    "above left": ((-4, 4), "right", "bottom"),
    "below right": ((5, -2), "left", "top"),
}


def draw(figure: Figure) -> Sheet:
    """``figure`` as one of matplotlib, which a notebook shows.  Raises MissingExtraError without matplotlib."""
    sheet = _drawn(figure)[0].get_figure(root=True)
    assert sheet is not None
    return sheet


def save(figure: Figure, file: str | os.PathLike[str]) -> None:
    """Draw ``figure`` into ``file``, in the format its ending names (png, pdf, svg).

    Raises MissingExtraError without matplotlib, InputError for a file or format that cannot be written.
    """
    _drawn(figure, file)


def _drawn(figure: Figure, file: str | os.PathLike[str] | None = None) -> tuple[Axes, ...]:
    def paint(*places: Axes) -> None:
        for axes, panel in zip(places, figure.panels, strict=True):
            _panel(axes, panel)

    width = 5.3 if figure.panels[0].equal else 6.0  # of a panel
    return show.drawn(paint, file, panels=len(figure.panels), size=(width, 4.4), title=figure.title)


def _panel(axes: Axes, panel: Panel) -> None:
    from matplotlib.ticker import MultipleLocator

    for order, layer in enumerate(panel.layers):
        _draw(layer, axes, order + 1.0)
    show.measure(axes.xaxis, panel.x.symbol, panel.x.unit)
    show.measure(axes.yaxis, panel.y.symbol, panel.y.unit)
    if panel.x.limits:
        axes.set_xlim(panel.x.limits)
    if panel.y.limits:
        axes.set_ylim(panel.y.limits)
    if panel.equal:
        axes.set_aspect("equal")
    for axis, own in ((axes.xaxis, panel.x.step), (axes.yaxis, panel.y.step)):
        if step := _tick_step(axes) if panel.equal else own:
            axis.set_major_locator(MultipleLocator(step))
    show.legend(axes, panel.legend)


def _tick_step(axes: Axes) -> float:
    """One distance of ticks for both axes."""
    from matplotlib.ticker import MaxNLocator

    low, high = max((axes.get_xlim(), axes.get_ylim()), key=lambda ends: ends[1] - ends[0])
    ticks = MaxNLocator(9, steps=[1, 2, 5, 10]).tick_values(low, high)
    return float(ticks[1] - ticks[0])


def _colour(hue: int | None) -> str:
    return show.GREY if hue is None else show.palette(hue)


def _draw(layer: Layer, axes: Axes, order: float) -> None:
    match layer:
        case Curve():
            dash = _DOTS if layer.hue is None else show.pen(layer.hue)["linestyle"]
            axes.plot(layer.x, layer.y, color=_colour(layer.hue), linestyle=dash, linewidth=1.8, label=layer.label or "_", zorder=order)
        case Marks():
            axes.plot(layer.x, layer.y, "o", color=_colour(layer.hue), markersize=5, label=layer.label or "_", zorder=order)
        case Arrows():
            _arrows(layer, axes, order)
        case Rule():
            _rule(layer, axes, order)
        case Band():
            axes.axvspan(layer.low, layer.high, color="0.9", linewidth=0, label=layer.label or "_", zorder=order)
        case Note():
            offset, across, along = _SIDES[layer.side]
            words: dict[str, Any] = {"xytext": offset, "textcoords": "offset points", "ha": across, "va": along, "fontsize": "small"}
            axes.annotate(layer.text, (layer.x, layer.y), **words, zorder=order)


def _arrows(layer: Arrows, axes: Axes, order: float) -> None:
    step = layer.length * layer.along
    axes.quiver(
        *layer.start.T,
        *step.T,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        width=0.004,
        headwidth=4.5,
        headlength=6.0,
        headaxislength=5.5,
        color=_colour(layer.hue),
        zorder=order,
    )
    if layer.label:  # in the legend a quiver would be a patch
        axes.plot([], [], color=_colour(layer.hue), linewidth=1.0, marker=">", markersize=4, label=layer.label)
    axes.update_datalim(layer.start + step)  # a quiver counts its tails only
    axes.autoscale_view()


def _rule(layer: Rule, axes: Axes, order: float) -> None:
    line, turn = (axes.axhline, 0) if layer.axis == "y" else (axes.axvline, 90)
    line(layer.at, color=_colour(layer.hue), linewidth=0.9, linestyle=(0, (4, 3)) if layer.label else "-", zorder=order)
    if layer.label:
        at = (1.0, layer.at) if layer.axis == "y" else (layer.at, 1.0)
        frame = axes.get_yaxis_transform() if layer.axis == "y" else axes.get_xaxis_transform()
        offset, across, along = ((-2, 3), "right", "bottom") if layer.axis == "y" else ((-3, -2), "right", "top")
        axes.annotate(
            layer.label,
            at,
            xycoords=frame,
            xytext=offset,
            textcoords="offset points",
            ha=across,
            va=along,
            rotation=turn,
            fontsize="small",
            color=_colour(layer.hue),
            zorder=order,
        )
