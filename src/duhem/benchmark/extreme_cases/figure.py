"""Accurate digits over decades, a panel an axis, a line a method; crosses are silently wrong (matplotlib, extra ``plot``)."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from duhem.benchmark.extreme_cases.cases import AXES
from duhem.benchmark.extreme_cases.judge import MOST, POOR
from duhem.benchmark.extreme_cases.stress import ExtremeCases
from duhem.errors import InputError
from duhem.show.figure import check

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["save"]


def save(result: ExtremeCases, file: str | os.PathLike[str]) -> None:
    """One figure: digits of the stress (lines) and of the slip (dotted) on every axis that was run."""
    check(file)
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    shown = [axis for axis in AXES if any(row.axis == axis for row in result.rows)] or ["load"]
    columns = min(3, len(shown))
    lines = -(-len(shown) // columns)
    figure = Figure(figsize=(5.0 * columns, 3.4 * lines), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(lines, columns, squeeze=False).ravel()
    for panel in panels[len(shown) :]:
        panel.set_axis_off()
    for panel, axis in zip(panels, shown, strict=False):
        _panel(panel, result, axis)
    if panels[0].get_legend_handles_labels()[0]:
        panels[0].legend(frameon=False, fontsize=8)
    figure.suptitle(f"{result.law}: accurate digits of stress (line) and slip (dotted); crosses: wrong without a flag", fontsize=9)
    try:
        figure.savefig(file, dpi=150)
    except OSError as fault:
        raise InputError(f"the figure cannot be written: {fault}", where=f"{file}", remedy="write where you may") from None


def _panel(panel: Axes, result: ExtremeCases, axis: str) -> None:
    labels = list(dict.fromkeys(row.label for row in result.rows if row.axis == axis))
    for i, method in enumerate(result.methods):
        rows = [row for row in result.rows if row.axis == axis and row.method == method]
        x = [labels.index(row.label) for row in rows]
        colour = f"C{i}"
        panel.plot(x, [row.stress_digits for row in rows], color=colour, linewidth=1.2, label=method)
        panel.plot(x, [row.slip_digits for row in rows], color=colour, linewidth=0.9, linestyle=":")
        for wrong, digits in (("wrong_stress", "stress_digits"), ("wrong_slip", "slip_digits")):
            bad = [(at, getattr(row, digits)) for at, row in zip(x, rows, strict=True) if getattr(row, wrong)]
            panel.plot([at for at, _ in bad], [y for _, y in bad], "x", color=colour, markersize=6)
    panel.axhline(POOR, color="0.7", linewidth=0.8)
    step = max(1, len(labels) // 8)
    panel.set_xticks(range(0, len(labels), step), labels[::step], fontsize=7, rotation=45 if axis == "special values" else 0)
    panel.set(title=axis, ylim=(-0.5, MOST + 1.0), ylabel="digits")
