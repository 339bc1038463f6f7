"""The work-precision figure: error on x, run time on y, both logarithmic, a panel a scene (extra ``plot``)."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from math import ceil, floor, log10
from typing import TYPE_CHECKING

from duhem.benchmark.work_precision import increments as increment
from duhem.benchmark.work_precision import paths as path
from duhem.benchmark.work_precision.result import Measurement, WorkPrecision
from duhem.show import figure
from duhem.show.notation import latex_number
from duhem.show.printing import draw

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["panels", "picture"]

_NO_ERROR = 2.0**-54  # where a method with no error at all is drawn
_TITLES = {increment.SCENE: "one increment", path.SCENE: "a loading path"}
_WIDTH = 6.4
_DECADES = 2  # the fewest an axis shows: less has no number to read


def panels(result: WorkPrecision) -> tuple[str, ...]:
    """The scenes that are drawn, an axes each."""
    return tuple(scene for scene in _TITLES if any(row.scene == scene for row in result.rows)) or (increment.SCENE,)


@draw.register(WorkPrecision)
def picture(result: WorkPrecision, file: str | os.PathLike[str] | None = None, *, axes: Iterable[Axes] | None = None) -> tuple[Axes, ...]:
    """One of ``axes`` for each of :func:`panels`, or a sheet; bars from the least to the most time; what failed is named above."""
    scenes = panels(result)
    methods = list(dict.fromkeys(row.method for row in result.rows))

    def paint(*places: Axes) -> None:
        for place, scene in zip(places, scenes, strict=True):
            _panel(place, result, scene, methods)
        figure.legend_below(places)

    title = f"{result.law}: {result.subject}"
    return figure.drawn(paint, file, axes, panels=len(scenes), size=(_WIDTH, 5.2), title=title)


def _panel(axes: Axes, result: WorkPrecision, scene: str, methods: Sequence[str]) -> None:
    rows = [row for row in result.rows if row.scene == scene]
    errors, times = [], []
    for method in dict.fromkeys(row.method for row in rows):
        spreads = [
            (max(row.error["stress"], _NO_ERROR), row.seconds)
            for row in rows
            if row.method == method and row.seconds is not None and row.error.get("stress", -1.0) >= 0.0
        ]
        if spreads:
            x, y = [error for error, _ in spreads], [seconds.median for _, seconds in spreads]
            bars = [[t.median - t.least for _, t in spreads], [t.most - t.median for _, t in spreads]]
            axes.errorbar(x, y, yerr=bars, **figure.pen(methods.index(method)), linewidth=1.1, elinewidth=1.1, capsize=2.5, label=method)
            errors += x
            times += [end for _, t in spreads for end in (t.least, t.most)]
    if errors and min(errors) <= _NO_ERROR:
        axes.axvline(_NO_ERROR, color=figure.GREY, linewidth=0.9, linestyle=(0, (4, 3)), zorder=0, label="no error")
    axes.set(xscale="log", yscale="log")
    for limits, values in ((axes.set_xlim, errors), (axes.set_ylim, times)):
        if values:
            limits(*_decades(values))
    figure.measure(axes.xaxis, "largest relative error of the stress")
    figure.measure(axes.yaxis, "time", "s")
    axes.grid(True, which="major", linewidth=0.3)
    axes.set_title(figure.wrapped(_heading(result, scene, rows), _WIDTH - 1.4))


def _heading(result: WorkPrecision, scene: str, rows: Sequence[Measurement]) -> str:
    own = result.reference.get(scene)
    said = _TITLES[scene]
    if isinstance(own, float):
        said += f" (own error of the reference: ${latex_number(own, 2)}$)"
    failed = sorted({f"{row.method} {row.setting}".strip() for row in rows if row.failure is not None})
    return said + ("\nfailed: " + "; ".join(map(figure.shortened, failed)) if failed else "")


def _decades(values: Sequence[float]) -> tuple[float, float]:
    """Powers of ten around the values, some decades apart and not at a value."""
    low, high = floor(log10(min(values) * 0.6)), ceil(log10(max(values) * 1.6))
    missing = max(0, _DECADES - (high - low))
    return 10.0 ** (low - missing // 2), 10.0 ** (high + missing - missing // 2)
