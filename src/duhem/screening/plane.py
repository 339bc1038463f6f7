"""Verdicts over one or two parameters: where each row of a table lies and what came of it there, and the picture (extra ``plot``).

In the picture a mark and a hue stand for each verdict, so that either tells it.
"""

from __future__ import annotations

import json
import re
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import chain
from statistics import median
from typing import TYPE_CHECKING, NamedTuple

from duhem.errors import InputError, meant
from duhem.expression.number import exact_number, nearest_double
from duhem.law.catalogue import load
from duhem.law.law_sheet import stress_powers, unit_in_words
from duhem.screening.campaign import Campaign, VerdictLine, counted
from duhem.screening.summary import Summary
from duhem.screening.table import read_lines
from duhem.show import figure
from duhem.show.printing import draw, latex_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

__all__ = ["NO_VERDICT", "VerdictPanel", "VerdictPlane", "check", "chosen", "plane", "plot", "plot_table", "varying"]

NO_VERDICT = "no verdict"
_MOST = 36  # panels of a picture
_LOOKED_AT = 64  # rows, before a long run
_RIM = 0.08  # of a mark, white: what lies below it ends where it begins, for an eye that takes their hues for one too
_LANE = 0.1  # inches between the marks of two verdicts on the line of a claim
_CROWD = 400  # points of one verdict in a panel; the marks of more are smaller, so that the few stand out


@dataclass(frozen=True)
class VerdictPanel:
    """The points at which each verdict was found; with one parameter their second coordinate counts the claims."""

    title: str
    law: str
    points: dict[str, tuple[array[float], array[float]]] = field(default_factory=dict)

    def add(self, verdict: str, x: float, y: float) -> None:
        across, up = self.points.setdefault(verdict, (array("d"), array("d")))
        across.append(x)
        up.append(y)


@dataclass(frozen=True)
class VerdictPlane:
    """A panel for each law and claim over two ``axes``, or for each law over one with a line for each of ``claims``.

    ``beside`` are parameters that vary too, along neither axis; ``unplaced`` rows have no number on an axis, of ``rows``.
    """

    axes: tuple[str, ...]
    claims: tuple[str, ...]
    panels: tuple[VerdictPanel, ...]
    beside: tuple[str, ...]
    unplaced: int
    rows: int


def varying(rows: Iterable[tuple[str, Mapping[str, str]]]) -> dict[str, bool]:
    """The parameters that rows of a law and its values fix, and whether each has two values with one law."""
    first, found = dict[tuple[str, str], str](), dict[str, bool]()
    for law, values in rows:
        for name, value in values.items():
            found[name] = found.get(name, False) or first.setdefault((law, name), value) != value
    return found


def chosen(axes: Sequence[str] | None, found: Mapping[str, bool]) -> tuple[str, ...]:
    """One or two parameters to draw over: ``axes``, or those that vary.  InputError where these are none or too many."""
    if axes is None:
        names = tuple(name for name, varies in found.items() if varies)
        if not names:
            raise InputError("no parameter has two values", where="axes", remedy="the picture needs one or two parameters that vary")
        if len(names) > 2:
            words = f"{', '.join(names[:8])}{' ...' if len(names) > 8 else ''} vary"
            raise InputError(words, where="axes", remedy=f"name one or two of them: {','.join(names[:2])}")
        return names
    names = tuple(axes)
    if not 0 < len(names) < 3 or len(set(names)) < len(names):
        raise InputError(f"{','.join(names)[:60] or 'nothing'} is not one or two parameters", where="axes", remedy="write for example mu,e")
    for name in names:
        if name not in found:
            raise InputError(f"no row has a value of {name[:40]!r}", where="axes", remedy=meant(name, tuple(found)))
    return names


def plane(lines: Iterable[VerdictLine], axes: tuple[str, ...], found: Mapping[str, bool]) -> VerdictPlane:
    """Where the ``lines`` of a table lie over one or two of the parameters that were ``found``.

    InputError where no row has a number on each axis, or pictures of so many laws and claims would be too many.
    """
    panels, claims = dict[tuple[str, str], VerdictPanel](), dict[str, int]()
    unplaced, rows, last = 0, 0, 0
    for line in lines:
        new, last = line.row != last, line.row
        rows += new
        point = _point(json.loads(line.parameters), axes)
        if point is None:
            unplaced += new
            continue
        count = claims.setdefault(line.claim, len(claims))
        key = (line.law, line.claim if len(axes) == 2 else "")
        if key not in panels:
            if len(panels) == _MOST:
                raise InputError(f"there are more than {_MOST} pairs of a law and a claim", remedy="draw a table of fewer laws or claims")
            panels[key] = VerdictPanel(f"{line.law}: {line.claim}" if len(axes) == 2 else line.law, line.law)
        panels[key].add(line.verdict or NO_VERDICT, *point, *((float(count),) if len(axes) == 1 else ()))
    if not panels:
        raise InputError(f"no row has a number for {' and '.join(axes)}", where="axes", remedy="name parameters that occur in one law")
    beside = tuple(name for name, varies in found.items() if varies and name not in axes)
    return VerdictPlane(axes, tuple(claims), tuple(panels.values()), beside, unplaced, rows)


def _point(values: Mapping[str, str], axes: tuple[str, ...]) -> tuple[float, ...] | None:
    """The nearest doubles; None where a value is missing, no number or beyond all doubles."""
    try:
        point = [nearest_double(exact_number(values[name])) for name in axes]
    except (KeyError, InputError):
        return None
    known = tuple(x for x in point if x is not None)
    return known if len(known) == len(axes) else None


class _Look(NamedTuple):
    mark: str
    colour: str
    size: float  # of what may hide others less than of what is below it


# Drawn in this order: where several rows lie at one point each shows its rim around the next.
_LOOKS: Mapping[str, _Look] = {
    verdict: look
    for look, *verdicts in (
        (_Look("s", "0.75", 11.0), "not_applicable"),
        (_Look("o", figure.palette(0), 8.0), "proved", "ok", "passed"),
        (_Look("v", figure.palette(2), 6.5), "xfailed", "tested"),
        (_Look("X", figure.palette(1), 6.5), "refuted", "failed", "flagged"),
        (_Look("P", figure.palette(3), 6.5), "wrong", "xpassed"),
        (_Look("d", figure.palette(4), 6.5), "undecided"),
        (_Look("*", "black", 5.5), NO_VERDICT),
    )
    for verdict in verdicts
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
        raised = re.sub(r"\^\((.+)\)$", r"$^{\1}$", unit or "")
        figure.measure(axis, f"${latex_name(name)}$", raised, size if figure.outsize(size) != 1.0 else 0.0)


@lru_cache(maxsize=64)
def _unit(law: str, name: str) -> str | None:
    """The unit of a parameter, as the formula of the law has it; None where that, or the law, is not known here."""
    try:
        return None if ":" in law else unit_in_words(stress_powers(load(law)).get(name))
    except InputError:
        return None


def _size(panel: VerdictPanel, i: int) -> float:
    return max(abs(x) for points in panel.points.values() for x in points[i])
