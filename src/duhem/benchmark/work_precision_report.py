"""A benchmark as tables, errors beside times and targets with their outcome, and as a figure of error and run time (extra ``plot``)."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from math import ceil, floor, log10
from typing import TYPE_CHECKING

from duhem.benchmark import increments as increment
from duhem.benchmark import paths as path
from duhem.benchmark import throughput
from duhem.benchmark.measurement import Measurement, Spread, WorkPrecision
from duhem.benchmark.study import report
from duhem.show import figure
from duhem.show.notation import latex_number
from duhem.show.page import PAGE, Page, tied
from duhem.show.printing import draw, text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["as_text", "duration", "panels", "picture"]

_TITLES = {
    increment.SCENE: "One increment: four trial stresses, each solved alone; largest relative error, time an increment",
    path.SCENE: "A loading path of four straight steps: largest error of the stress at the corners, time of the whole path",
    throughput.CALLS: "Many increments through duhem.project: wall time a point",
    path.LONG: "Many implicit steps through duhem.simulate: wall time a step of one point",
    throughput.SCENE: "Many increments at once: processor time a point; errors of some points, flags of the first 100, first call by the "
    "clock on the wall, what it compiles included",
}
_ERRORS = {increment.SCENE: ("stress", "slip"), path.SCENE: ("stress",), throughput.SCENE: ("stress", "slip")}

_NO_ERROR = 2.0**-54  # where a method with no error at all is drawn
_DRAWN = {increment.SCENE: "one increment", path.SCENE: "a loading path"}
_WIDTH = 6.4
_DECADES = 2  # the fewest an axis shows: less has no number to read


@text.register(WorkPrecision)
def as_text(result: WorkPrecision, page: Page = PAGE) -> str:
    """All there is, in the order of the scenes."""
    facts = result.machine
    versions = ", ".join(tied(f"{name} {v}") for name, v in facts["versions"].items())
    system = f"{facts['processors_usable']} processors usable, {facts['system']}, Python {facts['python']}"
    scenes = [_scene(result, scene, title, page) for scene, title in _TITLES.items()]
    return report(result, [f"{facts['processor']}, {system}, {versions}"], [*scenes, _targets(result, page)], page)


def _scene(result: WorkPrecision, scene: str, title: str, page: Page) -> list[str]:
    rows = [row for row in result.rows if row.scene == scene]
    return [*page.hanging(title), *_own_error(result, scene, page), *_table(rows, scene, page)] if rows else []


def _own_error(result: WorkPrecision, scene: str, page: Page) -> list[str]:
    own = result.reference.get(scene)
    if own is None:
        return []
    many = f"reference: the optimality conditions in many digits, its own error {own:.0e}" if isinstance(own, float) else ""
    return page.item(many or f"no reference: {own}")


def _table(rows: Sequence[Measurement], scene: str, page: Page) -> list[str]:
    names = _ERRORS.get(scene, ())
    judged = ["flagged"] if scene not in (path.SCENE, throughput.CALLS, path.LONG) else []
    called = ["first call"] if scene == throughput.SCENE else []
    head = ("method", "setting", *(f"error in {n}" for n in names), *judged, *called, "time", "least", "most", "runs")
    body: list[tuple[str, ...]] = [head]
    for row in rows:
        if row.failure is not None:
            body.append((row.method, row.setting, f"failed: {row.failure}"))
            continue
        if "megabytes" in row.error:
            body.append((row.method, row.setting, f"{row.error['megabytes']:.1f} MB"))
            continue
        errors = [f"{row.error[n]:.1e}" if n in row.error else "" for n in names]
        time = _time(row.seconds) if row.seconds else ("",) * 4
        first = [duration(row.first) if row.first is not None else "" for _ in called]
        body.append((row.method, row.setting, *errors, *([str(row.flagged) if row.error else ""] if judged else []), *first, *time))
    noted = [row for row in rows if row.note and row.failure is None and scene != path.SCENE]
    notes = [line for row in noted for line in page.item(f"note: {' '.join(filter(None, (row.method, row.setting)))}: {row.note}")]
    return [*page.table(body, "llr"), *notes]


def _time(spread: Spread) -> tuple[str, ...]:
    return (*map(duration, (spread.median, spread.least, spread.most)), str(spread.repeats))


def duration(seconds: float) -> str:
    """Three digits with a unit that people read."""
    for unit, name in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us")):
        if seconds >= unit:
            return f"{seconds / unit:.3g} {name}"
    return f"{seconds * 1e9:.3g} ns"


def _targets(result: WorkPrecision, page: Page) -> list[str]:
    rows = [("ratio", "value", "target", "")]
    for target in result.targets:
        outcome = {True: "holds", False: "DOES NOT HOLD", None: f"not taken: {target.reason}"}[target.holds]
        value = "-" if target.value is None else f"{target.value:.3g}"
        rows.append((target.what, value, tied(f"{target.relation} {target.bound:g}"), outcome))
    return ["Targets (ratios of medians within this run)", *page.table(rows, "lrll")] if result.targets else []


def panels(result: WorkPrecision) -> tuple[str, ...]:
    """The scenes that are drawn, an axes each."""
    return tuple(scene for scene in _DRAWN if any(row.scene == scene for row in result.rows)) or (increment.SCENE,)


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
    said = _DRAWN[scene]
    if isinstance(own, float):
        said += f" (error of the reference itself: ${latex_number(own, 2)}$)"
    failed = sorted({f"{row.method} {row.setting}".strip() for row in rows if row.failure is not None})
    return said + ("\nfailed: " + "; ".join(map(figure.shortened, failed)) if failed else "")


def _decades(values: Sequence[float]) -> tuple[float, float]:
    """Powers of ten around the values, some decades apart and not at a value."""
    low, high = floor(log10(min(values) * 0.6)), ceil(log10(max(values) * 1.6))
    missing = max(0, _DECADES - (high - low))
    return 10.0 ** (low - missing // 2), 10.0 ** (high + missing - missing // 2)
