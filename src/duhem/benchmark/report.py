"""Benchmarks as tables and figures (extra ``plot``).

Of scenes there are errors beside times and targets with their outcome, and a figure of error and run time.  Of extreme cases the tables
have decades down, methods across, and what was silently wrong; the figure has accurate digits over decades, a panel an axis, a line a
method, and crosses where an answer is silently wrong.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from math import ceil, floor, log10
from typing import TYPE_CHECKING, Any

from duhem.benchmark import throughput, work_precision
from duhem.benchmark.extreme_cases import AXES, MOST, POOR, ExtremeCases, Tally
from duhem.benchmark.measurement import Measurement, Spread, WorkPrecision, report
from duhem.law.law_sheet import UNIT
from duhem.show import figure
from duhem.show.page import PAGE, Page, tied
from duhem.show.printing import draw, latex_number, text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["as_text", "duration", "extreme_cases_as_text", "panels", "picture"]

_TITLES = {
    throughput.SINGLE: "One increment: four trial stresses, each solved alone; largest relative error, time an increment",
    work_precision.PATH: "A loading path of four straight steps: largest error of the stress at the corners, time of the whole path",
    throughput.CALLS: "Many increments through duhem.project: wall time a point",
    work_precision.LONG: "Many implicit steps through duhem.simulate: wall time a step of one point",
    throughput.SCENE: "Many increments at once: processor time a point; errors of some points, flags of the first 100, first call by the "
    "clock on the wall, what it compiles included",
}
_ERRORS = {throughput.SINGLE: ("stress", "slip"), work_precision.PATH: ("stress",), throughput.SCENE: ("stress", "slip")}

_NO_ERROR = 2.0**-54  # where a method with no error at all is drawn
_DRAWN = {throughput.SINGLE: "one increment", work_precision.PATH: "a loading path"}
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
    judged = ["flagged"] if scene not in (work_precision.PATH, throughput.CALLS, work_precision.LONG) else []
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
    noted = [row for row in rows if row.note and row.failure is None and scene != work_precision.PATH]
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


def panels(result: WorkPrecision | ExtremeCases) -> tuple[str, ...]:
    """What is drawn, an axes each: scenes, or axes of difficulty."""
    if isinstance(result, ExtremeCases):
        return tuple(axis for axis in AXES if any(row.axis == axis for row in result.rows)) or ("load",)
    return tuple(scene for scene in _DRAWN if any(row.scene == scene for row in result.rows)) or (throughput.SINGLE,)


@draw.register(WorkPrecision)
@draw.register(ExtremeCases)
def picture(
    result: WorkPrecision | ExtremeCases, file: str | os.PathLike[str] | None = None, *, axes: Iterable[Axes] | None = None
) -> tuple[Axes, ...]:
    """One of ``axes`` for each of :func:`panels`, or a sheet.

    Of scenes bars go from the least to the most time, and what failed is named above.  Of extreme cases digits of the stress are solid
    lines, those of the slip dotted ones.
    """
    shown = panels(result)

    def paint(*places: Axes) -> None:
        for place, each in zip(places, shown, strict=True):
            if isinstance(result, ExtremeCases):
                _panel_of_an_axis(place, result, each)
            else:
                _panel(place, result, each, list(dict.fromkeys(row.method for row in result.rows)))
        if isinstance(result, ExtremeCases):
            _key(places[0], result)
        figure.legend_below(places)

    size = (5.2, 3.6) if isinstance(result, ExtremeCases) else (_WIDTH, 5.2)
    return figure.drawn(paint, file, axes, panels=len(shown), size=size, title=f"{result.law}: {result.subject}")


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


# -- extreme cases -----------------------------------------------------------------------------------------------------


LEGEND = (
    "Cells: accurate digits of the stress / of the slip, the fewest of the points, at most 16. F: flagged (status inaccurate or "
    "failed, or an error raised). X: numbers that are not finite. O: outside K. !stress, !slip: silently wrong, that is fewer than "
    "6 digits of it and no flag."
)

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


@text.register(ExtremeCases)
def extreme_cases_as_text(result: ExtremeCases, page: Page = PAGE) -> str:
    """Axis by axis, then a summary for each method, refusals, and what was left out."""
    facts = [f"reference: the optimality conditions in many digits, its own error {result.reference:.0e}"]
    axes = [_axis(result, axis, meaning, page) for axis, meaning in AXES.items()]
    return report(
        result,
        facts,
        [page.hanging(LEGEND, rest=""), *axes, ["Summary", *_summary(result, page)], _refusals(result, page), _errors(result, page)],
        page,
    )


def _axis(result: ExtremeCases, axis: str, meaning: str, page: Page) -> list[str]:
    rows = {(row.label, row.method): row for row in result.rows if row.axis == axis}
    labels = dict.fromkeys(label for label, _ in rows)
    body = [[label, *(_cell(rows[label, m]) if (label, m) in rows else "" for m in result.methods)] for label in labels]
    return [*page.hanging(f"{axis}: {meaning}"), *page.table([["", *result.methods], *body], "l")] if rows else []


def _cell(row: Tally) -> str:
    if row.failure is not None:
        return tied("- / -") + "  F"
    marks = [
        "F" if row.flagged else "",
        "X" if row.finite < row.points else "",
        "O" if row.feasible < row.finite else "",
        " !stress" if row.wrong_stress else "",
        " !slip" if row.wrong_slip else "",
    ]
    digits = tied(f"{row.stress_digits:4.1f} / {row.slip_digits:4.1f}")
    return f"{digits} {''.join(marks).lstrip()}".rstrip()


def _summary(result: ExtremeCases, page: Page) -> list[str]:
    body: list[tuple[str, ...]] = [("method", "points", "finite", "in K", "flagged", "silently wrong: stress", "slip")]
    for method in result.methods:
        rows = [row for row in result.rows if row.method == method]
        counts = [sum(getattr(row, name) for row in rows) for name in ("points", "finite", "feasible", "flagged")]
        wrong = result.silently_wrong[method]
        body.append((method, *map(str, counts), *map(str, wrong)))
    return page.table(body, "lr")


def _refusals(result: ExtremeCases, page: Page) -> list[str]:
    if not result.refusals:
        return []
    held = sum(r.held for r in result.refusals)
    title = f"Input that cannot be used: {held} of {len(result.refusals)} refused with argument and index named"
    answered = [f"{r.method}, {r.what} ({r.place}): {r.answer}" for r in result.refusals if not r.held]
    return [*page.hanging(title), *(line for sentence in answered for line in page.item(sentence))]


def _errors(result: ExtremeCases, page: Page) -> list[str]:
    raised = {(row.method, row.failure) for row in result.rows if row.failure is not None}
    return page.items("Errors raised", [f"{method}: {failure}" for method, failure in sorted(raised, key=str)])


def _panel_of_an_axis(axes: Axes, result: ExtremeCases, axis: str) -> None:
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
