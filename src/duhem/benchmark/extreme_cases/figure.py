"""Accurate digits over decades, a panel an axis, a line a method; crosses are silently wrong (extra ``plot``)."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from duhem.benchmark.extreme_cases.cases import AXES
from duhem.benchmark.extreme_cases.judge import MOST, POOR
from duhem.benchmark.extreme_cases.stress import ExtremeCases
from duhem.law.units import UNIT
from duhem.show import figure
from duhem.show.printing import draw

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["panels", "picture"]

_QUANTITIES = {
    "load": (r"$|\sigma_n|$ or trial stress", UNIT),
    "stiffness ratio": ("largest over smallest stiffness", ""),
    "aspect of K": ("one axis of $K$ shortened by", ""),
    "trial size": ("trial stress over reach of $K$", ""),
    "seam distance": ("component across an axis over reach of $K$", ""),
    "boundary distance": ("relative distance from $K$", ""),
}
_NUMBERS = 12  # most at an axis
_APART = 0.5  # the methods at one place stand side by side within this part of a place


def panels(result: ExtremeCases) -> tuple[str, ...]:
    """The axes of difficulty that are drawn, an axes each."""
    return tuple(axis for axis in AXES if any(row.axis == axis for row in result.rows)) or ("load",)


@draw.register(ExtremeCases)
def picture(result: ExtremeCases, file: str | os.PathLike[str] | None = None, *, axes: Iterable[Axes] | None = None) -> tuple[Axes, ...]:
    """One of ``axes`` for each of :func:`panels`, or a sheet; accurate digits of the stress (solid) and of the slip (dotted)."""
    shown = panels(result)

    def paint(*places: Axes) -> None:
        for place, axis in zip(places, shown, strict=True):
            _panel(place, result, axis)
        _key(places[0], result)
        figure.legend_below(places)

    title = f"{result.law}: {result.subject}"
    return figure.drawn(paint, file, axes, panels=len(shown), size=(5.2, 3.6), title=title)


def _panel(axes: Axes, result: ExtremeCases, axis: str) -> None:
    labels = list(dict.fromkeys(row.label for row in result.rows if row.axis == axis))
    for i, method in enumerate(result.methods):
        rows = [row for row in result.rows if row.axis == axis and row.method == method]
        aside = _APART * ((i + 0.5) / len(result.methods) - 0.5)
        x, pen = [labels.index(row.label) + aside for row in rows], figure.pen(i)
        plain = {"color": pen["color"], "marker": pen["marker"], "markersize": 4.0}
        solid, dotted = ("-", ":") if axis in _QUANTITIES else ("none", "none")  # nothing lies between places named in words
        axes.plot(x, [row.stress_digits for row in rows], **plain, linewidth=1.1, linestyle=solid)
        axes.plot(x, [row.slip_digits for row in rows], **plain, linewidth=0.9, linestyle=dotted, markerfacecolor="white")
        for wrong, digits in (("wrong_stress", "stress_digits"), ("wrong_slip", "slip_digits")):
            bad = [(at, getattr(row, digits)) for at, row in zip(x, rows, strict=True) if getattr(row, wrong)]
            axes.plot([at for at, _ in bad], [y for _, y in bad], "x", color="black", markersize=8.0, zorder=3)
    axes.axhline(POOR, color=figure.GREY, linewidth=0.9, linestyle=(0, (4, 3)), zorder=0)
    step = -(-max(len(labels), 1) // _NUMBERS)
    turned: dict[str, Any] = {"rotation": 40, "ha": "right", "rotation_mode": "anchor"} if max(map(len, labels), default=0) > 4 else {}
    axes.set_xticks(range(0, len(labels), step), [_written(label) for label in labels[::step]], **turned)
    axes.set_ylim(-0.7, MOST + 1.0)
    axes.set_title(axis)
    if axis in _QUANTITIES:
        figure.measure(axes.xaxis, *_QUANTITIES[axis])
    else:
        axes.set_xlabel("case")
    figure.measure(axes.yaxis, "accurate digits")


def _written(label: str) -> str:
    """A power of ten as one."""
    mantissa, e, power = label.partition("e")
    if mantissa == "1" and e and power.lstrip("-").isdigit():
        return f"$10^{{{int(power)}}}$" if int(power) else "1"
    return figure.shortened(label, 24)


def _key(axes: Axes, result: ExtremeCases) -> None:
    """What the looks of a line mean."""
    for i, method in enumerate(result.methods):
        axes.plot([], [], color=figure.pen(i)["color"], marker=figure.pen(i)["marker"], linestyle="none", label=method)
    axes.plot([], [], color="black", marker="o", markersize=4.0, linewidth=1.1, label="stress")
    axes.plot([], [], color="black", marker="o", markersize=4.0, linewidth=0.9, linestyle=":", markerfacecolor="white", label="slip")
    axes.plot([], [], "x", color="black", markersize=8.0, label="wrong without a flag")
    axes.plot([], [], color=figure.GREY, linewidth=0.9, linestyle=(0, (4, 3)), label=f"{POOR:g} digits")
