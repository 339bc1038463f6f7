"""Drawing a figure's value (extra ``plot``)."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from duhem.micromodel.figures.value import Arrows, Band, Curve, Figure, Layer, Marks, Note, Panel, Rule
from duhem.show import figure as show

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Sheet

__all__ = ["draw", "save"]

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
