"""A parameter plane with its verdicts as a picture (extra ``plot``): a mark and a hue for each verdict, so that either tells it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import chain
from statistics import median
from typing import TYPE_CHECKING, NamedTuple

from duhem.errors import InputError
from duhem.law.catalogue import load
from duhem.law.units import stress_powers, unit_in_words
from duhem.screening.campaign import Campaign
from duhem.screening.lines import VerdictLine
from duhem.screening.plane import NO_VERDICT, VerdictPanel, VerdictPlane, chosen, plane, varying
from duhem.screening.rows import counted
from duhem.screening.summary import Summary
from duhem.screening.table import read_lines
from duhem.show import figure
from duhem.show.notation import latex_name
from duhem.show.printing import draw

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

__all__ = ["check", "plot", "plot_table"]

_LOOKED_AT = 64  # rows, before a long run
_RIM = 0.08  # of a mark, white: what lies below it ends where it begins, for an eye that takes their hues for one too
_LANE = 0.1  # inches between the marks of two verdicts on the line of a claim
_CROWD = 400  # points of one verdict in a panel; the marks of more are smaller, so that the few stand out


class _Look(NamedTuple):
    mark: str
    colour: str
    size: float  # of what may hide others less than of what is below it


# Drawn in this order: where several rows lie at one point each shows its rim around the next.
_LOOKS: Mapping[str, _Look] = {
    "not_applicable": _Look("s", "0.75", 11.0),
    "proved": _Look("o", figure.palette(0), 8.0),
    "ok": _Look("o", figure.palette(0), 8.0),
    "passed": _Look("o", figure.palette(0), 8.0),
    "xfailed": _Look("v", figure.palette(2), 6.5),
    "tested": _Look("v", figure.palette(2), 6.5),
    "refuted": _Look("X", figure.palette(1), 6.5),
    "failed": _Look("X", figure.palette(1), 6.5),
    "flagged": _Look("X", figure.palette(1), 6.5),
    "wrong": _Look("P", figure.palette(3), 6.5),
    "xpassed": _Look("P", figure.palette(3), 6.5),
    "undecided": _Look("d", figure.palette(4), 6.5),
    NO_VERDICT: _Look("*", "black", 5.5),
}
_OTHER = _Look("P", figure.palette(3), 6.0)


def check(campaign: Campaign, axes: Sequence[str] | None) -> None:
    """Before a long run, InputError where a look at some of its rows shows that it has no such plane."""
    rows = len(campaign)
    some = sorted({round(1 + i * (rows - 1) / (_LOOKED_AT - 1)) for i in range(_LOOKED_AT)} | set(_firsts(campaign)))
    found = varying((row.name.shown, row.values) for row in map(campaign.row, some))
    if axes is not None or any(found.values()) or len(some) == rows:
        chosen(axes, found)


def _firsts(campaign: Campaign) -> Iterator[int]:
    """The first row of each block, which has values that no other may have."""
    first = 1
    for block in campaign.blocks:
        if len(block):
            yield first
        first += len(block)


def plot_table(table: str, file: figure.Target | None = None, axes: Sequence[str] | None = None) -> tuple[Axes, ...]:
    """The picture of a finished table, .csv or .parquet.  Raises what :meth:`Summary.plot` raises, and InputError for no such table."""
    return _plot(lambda: read_lines(table), file, axes)


@draw.register(Summary)
def plot(summary: Summary, file: figure.Target | None = None, *, axes: Sequence[str] | None = None) -> tuple[Axes, ...]:
    """The picture of a campaign's lines."""
    if summary.table is not None:
        return plot_table(summary.table, file, axes)
    return _plot(lambda: summary.lines, file, axes)


def _plot(lines: Callable[[], Iterable[VerdictLine]], file: figure.Target | None, axes: Sequence[str] | None) -> tuple[Axes, ...]:
    found = varying((line.law, json.loads(line.parameters)) for line in lines())
    seen = plane(lines(), chosen((axes,) if isinstance(axes, str) else axes, found), found)

    def paint(*places: Axes) -> None:
        for place, panel in zip(places, seen.panels, strict=True):
            _paint(place, panel, seen)
        figure.legend_below(places)

    size = (4.2, 3.6) if len(seen.axes) == 2 else (6.4, 1.5 + _height(seen) * len(seen.claims))
    columns = 3 if len(seen.axes) == 2 else 1
    return figure.drawn(paint, file, panels=len(seen.panels), columns=columns, size=size, title=_title(seen))


def _title(seen: VerdictPlane) -> str:
    said = counted(seen.rows, "row")
    if seen.unplaced:
        said += f", {seen.unplaced} of them without a number for {' and '.join(seen.axes)}"
    if seen.beside:
        names = f"{', '.join(seen.beside[:6])}{' ...' if len(seen.beside) > 6 else ''}"
        said += f"; {names} {'varies' if len(seen.beside) == 1 else 'vary'} too"
    return said


def _paint(axes: Axes, panel: VerdictPanel, seen: VerdictPlane) -> None:
    axes.set_title(figure.shortened(panel.title).replace("$", r"\$"))
    scale, order = [figure.outsize(_size(panel, i)) for i in range(len(seen.axes))], _ordered(seen)
    for verdict in (one for one in order if one in panel.points):
        aside = (order.index(verdict) - (len(order) - 1) / 2.0) * _LANE / _height(seen)
        look, (x, y) = _LOOKS.get(verdict, _OTHER), panel.points[verdict]
        size = max(2.0, look.size * min(1.0, (_CROWD / len(x)) ** 0.5))
        axes.plot(
            [value / scale[0] for value in x],
            [value / scale[-1] for value in y] if len(seen.axes) == 2 else [value + aside for value in y],
            look.mark,
            color=look.colour,
            markersize=size,
            markeredgecolor="white",
            markeredgewidth=_RIM * size,
            label=verdict.replace("_", " "),
            linestyle="none",
        )
    for i, (name, axis) in enumerate(zip(seen.axes, (axes.xaxis, axes.yaxis), strict=False)):
        _axis(axis, name, panel, i)
    if len(seen.axes) == 1:
        axes.set_yticks(range(len(seen.claims)), seen.claims)
        axes.set_ylim(len(seen.claims) - 0.5, -0.5)


def _ordered(seen: VerdictPlane) -> list[str]:
    """The verdicts there are, in the order in which they are drawn."""
    order = {verdict: i for i, verdict in enumerate(_LOOKS)}
    return sorted({verdict for panel in seen.panels for verdict in panel.points}, key=lambda one: (order.get(one, len(order)), one))


def _height(seen: VerdictPlane) -> float:
    """Inches of the line of a claim."""
    return max(0.4, _LANE * (len(_ordered(seen)) + 1))


def _axis(axis: Axis, name: str, panel: VerdictPanel, i: int) -> None:
    """Powers of ten where the values lie as these do."""
    values = sorted({*chain.from_iterable(points[i] for points in panel.points.values())})
    if len(values) > 2 and values[0] > 0.0 and median(values) - values[0] < 0.1 * (values[-1] - values[0]):
        getattr(axis.axes, f"set_{'xy'[i]}scale")("log")
    size, unit = _size(panel, i), _unit(panel.law, name)
    if unit is None and figure.outsize(size) == 1.0:
        axis.set_label_text(f"${latex_name(name)}$")
    else:
        figure.measure(axis, f"${latex_name(name)}$", unit or "", size if figure.outsize(size) != 1.0 else 0.0)


@lru_cache(maxsize=64)
def _unit(law: str, name: str) -> str | None:
    """The unit of a parameter, as the formula of the law has it; None where that, or the law, is not known here."""
    try:
        return None if ":" in law else unit_in_words(stress_powers(load(law)).get(name))
    except InputError:
        return None


def _size(panel: VerdictPanel, i: int) -> float:
    return max(abs(x) for points in panel.points.values() for x in points[i])
