"""The extreme cases as tables and as a figure (extra ``plot``).

Tables have decades down, methods across, and what was silently wrong; the figure has accurate digits over decades, a panel an axis, a
line a method, and crosses where an answer is silently wrong.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from duhem.benchmark.extreme_cases import AXES, MOST, POOR, ExtremeCases, Tally
from duhem.benchmark.study import report
from duhem.law.units import UNIT
from duhem.show import figure
from duhem.show.page import PAGE, Page, tied
from duhem.show.printing import draw, text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["as_text", "panels", "picture"]

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
def as_text(result: ExtremeCases, page: Page = PAGE) -> str:
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
