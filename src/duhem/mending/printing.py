"""A mended law as text for people, as a sheet, and as a picture: both boundaries in one section (extra ``plot``)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from duhem.expression.text import formula
from duhem.mending.limit_load import plain_values
from duhem.mending.result import Mended, Tried
from duhem.portrait.drawing import paint_section
from duhem.portrait.plane import usual
from duhem.portrait.section import Numbered, section
from duhem.show import figure
from duhem.show.page import PAGE, Page
from duhem.show.printing import draw, sheet, text
from duhem.show.sheet import Sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["as_sheet", "as_text", "plot"]

_HEAD = ("by", "mean change", "largest", "K", "")


@text.register(Mended)
def as_text(done: Mended, page: Page = PAGE) -> str:
    """What was done, the formula, what is proved of it, and a row for each way that was tried."""
    law, fields = done.criterion, dict(_fields(done))
    size = max(map(len, fields))
    head = [*page.hanging(f"{law.name}: {law.summary}" if law.summary else law.name)]
    table = page.table([_HEAD, *map(_row, done.tried)], "lrrll", "", rule=True) if len(done.tried) > 1 else []
    return page.report([[*head, *(line for name, said in fields.items() for line in page.field(name, said, size))], table])


@sheet.register(Mended)
def as_sheet(done: Mended) -> Sheet:
    """The same as a sheet."""
    return Sheet(f"{done.criterion.name}: {done.told}", tuple(_fields(done)), _HEAD, tuple(map(_row, done.tried)))


def _fields(done: Mended) -> Iterator[tuple[str, str]]:
    yield "mended" if done.by else "result", f"by {done.by}: {done.told}" if done.by else done.told
    if done.by:
        mean, largest = done.distance.mean, done.distance.largest
        yield "change", f"{mean:.3g} in the mean, {largest:.3g} at the largest, of the mean limit load over directions of force"
        if done.by != "parameters":
            yield "g", formula(done.law.g)
    yield "proved", ", ".join(f"{r.claim} {r.verdict.value}" for r in done.verification.results)
    yield "admissible", "yes" if done.admissible else "not proved"


def _row(one: Tried) -> tuple[str, ...]:
    if one.distance is None:
        return one.by, "-", "-", "-", one.told
    return one.by, f"{one.distance.mean:.4f}", f"{one.distance.largest:.4f}", "convex" if one.convex else "not proved convex", one.told


@draw.register(Mended)
def plot(done: Mended, file: Any = None, axes: Any = None) -> tuple[Axes, ...]:
    """K of the mended law, and the boundary of K before, in the first plane of forces, free parameters at plain numbers."""
    values = plain_values(done.criterion)
    before, after = (
        Numbered(law.fix({n: values[n] for n, own in law.parameters.items() if own.value is None})) for law in (done.criterion, done.law)
    )
    plane = usual(before.law, None)[0]
    old, new = (section(law, plane) for law in (before, after))
    (a, b, c, d), (e, f, g, h) = old.window, new.window
    window = (min(a, e), max(b, f), min(c, g), max(d, h))
    old, new = section(before, plane, window), replace(section(after, plane, window), slips=())

    def paint(place: Axes) -> None:
        paint_section(place, new)
        for i, line in enumerate(old.lines):
            style = {"color": figure.palette(1), "linestyle": (0, (5, 1.5)), "linewidth": 1.6, "zorder": 3.2}
            place.plot(*line.points.T, label="_" if i else f"before: {done.criterion.name}", **style)
        figure.legend(place)

    return figure.drawn(paint, file, axes, size=(5.6, 5.2), title=f"{done.criterion.name}, mended by {done.by}" if done.by else done.told)
