"""The work-precision figure: error on x, run time on y, both logarithmic, a panel a scene (matplotlib, extra ``plot``)."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from duhem.benchmark.work_precision import increments as increment
from duhem.benchmark.work_precision import paths as path
from duhem.benchmark.work_precision.result import Measurement, WorkPrecision
from duhem.errors import InputError
from duhem.show.figure import check

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["save"]

_EXACT = 2.0**-54  # where a method with no error at all is drawn
_TITLES = {increment.SCENE: "one increment", path.SCENE: "a loading path"}


def save(result: WorkPrecision, file: str | os.PathLike[str]) -> None:
    """One panel for each scene with errors; bars from the least to the most time; what failed is named under the panel."""
    check(file)
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    scenes = [scene for scene in _TITLES if any(row.scene == scene for row in result.rows)] or [increment.SCENE]
    figure = Figure(figsize=(6.4 * len(scenes), 5.2), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, scene in zip(figure.subplots(1, len(scenes), squeeze=False)[0], scenes, strict=True):
        _panel(axes, result, scene)
    figure.suptitle(f"{result.law}: {result.subject}", fontsize=9)
    try:
        figure.savefig(file, dpi=150)
    except OSError as fault:
        raise InputError(f"the figure cannot be written: {fault}", where=f"{file}", remedy="write where you may") from None


def _panel(axes: Axes, result: WorkPrecision, scene: str) -> None:
    rows = [row for row in result.rows if row.scene == scene]
    for method in dict.fromkeys(row.method for row in rows):
        mine = [row for row in rows if row.method == method and row.seconds is not None and row.error.get("stress", -1.0) >= 0.0]
        if mine:
            x = [max(row.error["stress"], _EXACT) for row in mine]
            times = [row.seconds for row in mine if row.seconds is not None]
            y = [t.median for t in times]
            bars = [[t.median - t.least for t in times], [t.most - t.median for t in times]]
            axes.errorbar(x, y, yerr=bars, marker="o", markersize=4, linewidth=1.0, capsize=2, label=method)
    own = result.reference.get(scene)
    title = _TITLES[scene] + (f" (reference: own error {own:.0e})" if isinstance(own, float) else "")
    failed = sorted({_name(row) for row in rows if row.failure is not None})
    axes.set(xscale="log", yscale="log", xlabel="largest relative error of the stress", ylabel="time (s)", title=title)
    if failed:
        axes.text(0.01, 0.01, "failed: " + "; ".join(failed), transform=axes.transAxes, fontsize=7, color="tab:red")
    axes.grid(True, which="major", linewidth=0.3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, fontsize=8)


def _name(row: Measurement) -> str:
    return f"{row.method} {row.setting}".strip()
