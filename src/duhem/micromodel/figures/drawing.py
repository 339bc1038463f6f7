"""Drawing a figure's value.  The only place that knows matplotlib (extra ``plot``)."""

from __future__ import annotations

import os
from functools import singledispatch
from typing import TYPE_CHECKING

from duhem.errors import InputError, MissingExtraError
from duhem.micromodel.figures.value import Arrows, Band, Curve, Figure, Layer, Note, Panel, Points, Rule

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Sheet

__all__ = ["FORMATS", "draw", "save"]

FORMATS = ("png", "pdf", "svg")
# Okabe and Ito (2008): told apart with any colour vision; the dashes tell the curves apart without colour.
_PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00")
_DASHES = ("-", (0, (6, 2)), (0, (6, 2, 1.5, 2)), (0, (1.5, 1.5)), (0, (3, 1.5)))
_GREY = "0.45"
_SIDES = {"left": ((-7, 0), "right", "center"), "above left": ((-4, 4), "right", "bottom"), "below right": ((4, -4), "left", "top")}
_UNDATED = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}  # the same figure gives the same file


def draw(figure: Figure) -> Sheet:
    """``figure`` as one of matplotlib, which a notebook shows.  Raises MissingExtraError without matplotlib."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure as Sheet
    except ImportError:
        raise MissingExtraError("matplotlib", "plot") from None
    width = sum(5.3 if panel.equal else 6.0 for panel in figure.panels)
    sheet = Sheet(figsize=(width, 4.4), layout="constrained")
    FigureCanvasAgg(sheet)
    sheet.suptitle(figure.title, fontsize="medium")
    for axes, panel in zip(sheet.subplots(1, len(figure.panels), squeeze=False)[0], figure.panels, strict=True):
        _panel(axes, panel)
    return sheet


def save(figure: Figure, file: str | os.PathLike[str]) -> None:
    """Draw ``figure`` into ``file``, in the format its ending names (png, pdf, svg).

    Raises MissingExtraError without matplotlib, InputError for a file or format that cannot be written.
    """
    sheet = draw(figure)
    from matplotlib import rc_context

    try:
        with rc_context({"svg.hashsalt": "duhem"}):
            sheet.savefig(file, dpi=160, metadata=_UNDATED.get(os.fspath(file)[-3:]))
    except (OSError, ValueError) as fault:
        reason = getattr(fault, "strerror", None) or fault
        endings = ", ".join(f".{name}" for name in FORMATS)
        raise InputError(f"the figure cannot be written: {reason}", where=f"{file}", remedy=f"end the name in {endings}") from None


def _panel(axes: Axes, panel: Panel) -> None:
    from matplotlib.ticker import MultipleLocator

    for order, layer in enumerate(panel.layers):
        _draw(layer, axes, order + 1.0)
    axes.set(xlabel=panel.x.label, ylabel=panel.y.label)
    if panel.x.limits:
        axes.set_xlim(panel.x.limits)
    if panel.y.limits:
        axes.set_ylim(panel.y.limits)
    if panel.equal:
        axes.set_aspect("equal")
    for axis, own in ((axes.xaxis, panel.x.step), (axes.yaxis, panel.y.step)):
        if step := _tick_step(axes) if panel.equal else own:
            axis.set_major_locator(MultipleLocator(step))
    axes.tick_params(labelsize="small")
    axes.spines[["top", "right"]].set_visible(False)
    if labels := axes.get_legend_handles_labels()[1]:
        legend = axes.legend(frameon=False, fontsize="small", handlelength=2.8, ncols=1 if panel.legend != "above" else min(len(labels), 3))
        legend.set_loc("lower center" if panel.legend == "above" else panel.legend)
        if panel.legend == "above":
            legend.set_bbox_to_anchor((0.5, 1.0), axes.transAxes)


def _tick_step(axes: Axes) -> float:
    """One distance of ticks for both axes."""
    from matplotlib.ticker import MaxNLocator

    low, high = max((axes.get_xlim(), axes.get_ylim()), key=lambda ends: ends[1] - ends[0])
    ticks = MaxNLocator(9, steps=[1, 2, 5, 10]).tick_values(low, high)
    return float(ticks[1] - ticks[0])


def _colour(hue: int | None) -> str:
    return _GREY if hue is None else _PALETTE[hue % len(_PALETTE)]


@singledispatch
def _draw(layer: Layer, axes: Axes, order: float) -> None:
    raise TypeError(f"{type(layer).__name__} is no layer")


@_draw.register(Curve)
def _(layer: Curve, axes: Axes, order: float) -> None:
    dash = "-" if layer.hue is None else _DASHES[layer.hue % len(_DASHES)]
    axes.plot(layer.x, layer.y, color=_colour(layer.hue), linestyle=dash, linewidth=1.8, label=layer.label or "_", zorder=order)


@_draw.register(Points)
def _(layer: Points, axes: Axes, order: float) -> None:
    axes.plot(layer.x, layer.y, "o", color=_colour(layer.hue), markersize=5, label=layer.label or "_", zorder=order)


@_draw.register(Arrows)
def _(layer: Arrows, axes: Axes, order: float) -> None:
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


@_draw.register(Rule)
def _(layer: Rule, axes: Axes, order: float) -> None:
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


@_draw.register(Band)
def _(layer: Band, axes: Axes, order: float) -> None:
    axes.axvspan(layer.low, layer.high, color="0.9", linewidth=0, label=layer.label or "_", zorder=order)


@_draw.register(Note)
def _(layer: Note, axes: Axes, order: float) -> None:
    offset, across, along = _SIDES[layer.side]
    axes.annotate(
        layer.text, (layer.x, layer.y), xytext=offset, textcoords="offset points", ha=across, va=along, fontsize="small", zorder=order
    )
