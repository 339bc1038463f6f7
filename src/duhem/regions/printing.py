"""A region as text for people, as a sheet, in LaTeX, and as a picture: the line of the parameter, or the plane of two (extra ``plot``).

A mended law is a sheet, and a picture of both boundaries.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.expression.parse import parse_relation
from duhem.expression.text import formula
from duhem.law.atlas.entry import entry
from duhem.law.catalogue import load_formula
from duhem.regions.mending.entry import Mended, Tried
from duhem.regions.mending.limit_load import around, limit_loads, plain_values
from duhem.regions.result import FoundRegion, PavedRegion
from duhem.show import figure
from duhem.show.page import PAGE, Page
from duhem.show.printing import Sheet, draw, latex, latex_name, plain, sheet, text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["as_dict", "as_latex", "as_sheet", "as_text", "plot", "plot_of_mended", "sheet_of_mended"]

_HEAD = ("where", "verdict", "trust", "by")
_MOST_ROWS = 40
_FINE = 401  # places along each edge of a picture
_LOOKS = (("proved", figure.palette(0), ""), ("refuted", figure.palette(1), "///"), ("open", figure.GREY, "..."))
_WORDS = {"proved": "holds", "refuted": "fails", "open": "open"}


@text.register(FoundRegion)
def as_text(region: FoundRegion, page: Page = PAGE) -> str:
    """The sentence, over what it was asked, a row a cell, and the ends with their polynomials."""
    law, fields = region.criterion, dict(_fields(region))
    asked = [line for name, said in fields.items() for line in page.field(name, said, max(map(len, fields)))]
    head = [*page.hanging(f"{law.name}: {law.summary}" if law.summary else law.name), *asked]
    ends = [line for said in _ends(region) for line in page.item(said)]
    return page.report([head, [*page.hanging(f"{region.sentence}.")], page.table([_HEAD, *_rows(region)], "llll", "", rule=True), ends])


@sheet.register(FoundRegion)
def as_sheet(region: FoundRegion) -> Sheet:
    """The same as a sheet."""
    notes = (("Ends", tuple(_ends(region))),)
    return Sheet(f"{region.criterion.name}: {region.sentence}", tuple(_fields(region)), _HEAD, tuple(_rows(region)), notes)


@plain.register(FoundRegion)
def as_dict(region: FoundRegion) -> dict[str, Any]:
    """The JSON of the interface."""
    return {
        "criterion": region.criterion.name,
        "claim": region.claim,
        "parameters": list(region.parameters),
        "domain": region.over,
        "fixed": {name: str(own.value) for name, own in region.criterion.parameters.items() if own.value is not None},
        "condition": region.condition,
        "exact": region.exact,
        "cells": [cell._asdict() | {"sample": dict(cell.sample)} for cell in region.cells],
        "ends": [end._asdict() | {"enclosure": list(end.enclosure)} for end in region.ends],
        "open_share": region.open_share,
        "joined": list(region.joined),
    }


@latex.register(FoundRegion)
def as_latex(region: FoundRegion) -> str:
    """The condition as a formula."""
    words = {"true": r"\text{for all values}", "false": r"\text{for no value}"}
    if (condition := region.condition) in words:
        return words[condition]
    names = {name: sp.Symbol(latex_name(name), real=True) for name in region.parameters}
    stretches = map(region.relations, region.stretches("proved"))
    said = r" \;\vee\; ".join(r" \;\wedge\; ".join(_latex_relation(part, names) for part in parts) for parts in stretches)
    return reduce(lambda text, x: text.replace(rf"{x} \;\wedge\; {x} ", f"{x} "), map(str, names.values()), said)  # low <= x <= high


def _latex_relation(text: str, names: dict[str, sp.Symbol]) -> str:
    equal = text.replace("==", "<=")
    said = str(sp.latex(parse_relation(equal, names)))
    return said if equal == text else said.replace(r"\leq", "=")


def _fields(region: FoundRegion) -> Iterator[tuple[str, str]]:
    law, names = region.criterion, region.parameters
    yield "claim", region.claim
    yield "over", f"all {', '.join(names)}" if region.over == "true" else region.over
    if others := [own.stated(other) for other, own in law.parameters.items() if other not in names]:
        yield "others", ", ".join(others)
    if published := _published(region)[0]:
        yield "published", published


def _published(region: FoundRegion) -> tuple[str, list[float]]:
    """What the literature claims of a law of the atlas, and the values that it has for the parameters of a region, if they all have one.

    Of another law that has its name nothing is known.
    """
    said, values, law = "", list[float](), region.criterion
    with suppress(InputError):
        if (own := load_formula(law.name)).summary == law.summary:
            values = [float(x.value) for x in map(own.parameters.get, region.parameters) if x is not None and x.value is not None]
            said = entry(law.name).claims.get(region.claim, "")
    return said, values if len(values) == len(region.parameters) else []


def _rows(region: FoundRegion) -> list[tuple[str, ...]]:
    if isinstance(region, PavedRegion) and len(region.known) > _MOST_ROWS:
        return list(_counted(region))
    whole = f"all {', '.join(region.parameters)}"
    shown = zip(region.cells, (str(leaf.get("rule", "")) for _, leaf in region.known), strict=True)
    return [(whole if c.condition == "true" else c.condition.replace("==", "="), c.verdict, c.trust or "-", rule) for c, rule in shown]


def _counted(region: PavedRegion) -> Iterator[tuple[str, ...]]:
    """A row a verdict, where leaves are many."""
    for verdict in ("proved", "refuted", "open"):
        own = [leaf for _, leaf in region.known if leaf["verdict"] == verdict]
        by = ", ".join(dict.fromkeys(str(leaf["rule"]) for leaf in own if "rule" in leaf))
        if own:
            count = "1 cell" if len(own) == 1 else f"{len(own)} cells"
            yield f"{count}, {region.percentage(verdict)} of the domain", verdict, "checked" if by else "-", by


def _ends(region: FoundRegion) -> Iterator[str]:
    for end in region.ends:
        root = "" if end.enclosure[0] == end.enclosure[1] else f" = {float(sp.Rational(end.enclosure[0])):.12g}"
        still = "still" if end.closed else "no longer"
        yield f"{end.parameter} = {end.value}{root}: root of {end.polynomial}; {region.claim} {still} holds there"


@draw.register(FoundRegion)
def plot(region: FoundRegion, file: Any = None, axes: Any = None) -> tuple[Axes, ...]:
    """Where the claim holds, fails and is open on the line of a parameter or in the plane of two; hatches tell what colours tell."""
    if (n := len(region.parameters)) > 2:
        raise InputError("a picture is of one parameter or two", where=region.criterion.name, remedy="fix others with --set")
    title, size = f"{region.criterion.name}: {region.sentence}", (6.0, 4.4) if n == 2 else (7.2, 2.0)
    return figure.drawn(lambda place: _paint(place, region), file, axes, size=size, title=title)


def _paint(axes: Axes, region: FoundRegion) -> None:
    line, (said, point) = len(region.parameters) == 1, _published(region)
    ranges = [_shown_range(region, name) for name in region.parameters]
    grid = np.meshgrid(*(np.linspace(low, high, _FINE) for low, high in [*ranges, *([(0.0, 1.0)] if line else [])]))
    verdicts = region.at(dict(zip(region.parameters, grid, strict=False)))
    for verdict, colour, lines in _LOOKS:
        there = verdicts == verdict
        if there.any():
            axes.contourf(*grid, there, levels=[0.5, 1.5], colors=[colour], alpha=0.75, hatches=[lines])
            axes.fill([], [], facecolor=colour, hatch=lines, alpha=0.75, label=f"{region.claim} {_WORDS[verdict]}")
    for end in region.ends:
        x = float(sp.Rational(end.enclosure[0]))
        axes.plot([x], [0.5], "o", color="black", markerfacecolor="black" if end.closed else "white", markersize=7, zorder=4)
        label = f"${latex_name(end.parameter)} = {sp.latex(sp.sympify(end.value, rational=True))}$"
        axes.annotate(label, (x, 1.05), ha="center", va="bottom")
    if line:
        axes.set_ylim(0.0, 1.6 if region.ends else 1.0)
        axes.set_yticks([])
    elif point and all(low <= at <= high for at, (low, high) in zip(point, ranges, strict=True)):
        axes.plot(*([at] for at in point), "o", color="black", markeredgecolor="white", linestyle="none", label="published")
    published = f"\npublished: {said}" if line and said else ""
    for axis, name in zip((axes.xaxis, axes.yaxis), region.parameters, strict=False):
        axis.set_label_text(f"${latex_name(name)}${published}")
    figure.legend(axes)


def _shown_range(region: FoundRegion, name: str) -> tuple[float, float]:
    """The range of a parameter, in the place of each end that it has not a part of what is between the ends of the places."""
    whole = region.box(region.everything)[name]
    marks = [float(end) for cell, _ in region.places for end in region.box(cell)[name][:2] if end is not None] or [0.0]
    wide = max(max(marks) - min(marks), 1.0) / (2 * len(region.parameters))
    low, high = whole[:2]
    return min(marks) - wide if low is None else float(low), max(marks) + wide if high is None else float(high)


# -- mended laws -------------------------------------------------------------------------------------------------------

_HEAD_OF_WAYS = ("by", "mean change", "largest", "K", "")


@sheet.register(Mended)
def sheet_of_mended(done: Mended) -> Sheet:
    """What was done, the formula, what is proved of it, and a row for each way that was tried."""
    title = f"{done.criterion.name}: {f'mended by {done.by}' if done.by else done.told}"
    return Sheet(title, tuple(_of_mended(done)), _HEAD_OF_WAYS, tuple(map(_way, done.tried)) if len(done.tried) > 1 else ())


def _of_mended(done: Mended) -> Iterator[tuple[str, str]]:
    if done.by:
        mean, largest = done.distance
        yield "before", f"convexity {done.before.value}"
        yield "result", done.told
        sizes = f"{mean:.3g} in the mean, {largest:.3g} at the largest, of the mean limit load over directions of force"
        yield "change", sizes if np.isfinite(largest) else "infinite: one K ends in a direction where the other does not"
    if done.by not in ("", "parameters"):
        yield "g", formula(done.law.g)
    yield "proved", ", ".join(f"{r.claim} {r.verdict.value}" for r in done.verification.results)
    yield "admissible", "yes" if done.admissible else "not proved"


def _way(one: Tried) -> tuple[str, ...]:
    if one.law is None:
        return one.by, "-", "-", "-", one.told
    return one.by, f"{one.distance.mean:.4f}", f"{one.distance.largest:.4f}", "convex" if one.convex else "not proved convex", one.told


@draw.register(Mended)
def plot_of_mended(done: Mended, file: Any = None, axes: Any = None) -> tuple[Axes, ...]:
    """K of both laws in the plane of the first two forces, free parameters at plain values and the pressure at -1."""
    forces, angles = done.criterion.forces, np.linspace(0.0, 2.0 * np.pi, 1441)
    if len(forces) < 2:
        raise InputError(f"{done.criterion.name} has one force", where="--plot", remedy="only laws of more forces are drawn")
    ways, values = np.zeros((len(angles), len(forces))), plain_values(done.criterion)
    ways[:, :2] = around(angles)

    def paint(place: Axes) -> None:
        looks = ((done.law, "-", f"mended by {done.by}"), (done.criterion, (0, (5, 1.5)), done.criterion.name))
        for i, (law, dashes, label) in enumerate(looks if done.by else looks[1:]):
            line = ways[:, :2] * limit_loads(law, values, ways)[:, None]
            place.plot(*line.T, color=figure.palette(i), linestyle=dashes, linewidth=1.8, label=label)
        place.set_aspect("equal", adjustable="datalim")
        for axis, force in zip((place.xaxis, place.yaxis), forces, strict=False):
            figure.measure(axis, f"${latex_name(force)}$", "unit of stress")
        figure.legend(place)

    return figure.drawn(paint, file, axes, size=(5.6, 5.2), title=f"{done.criterion.name}: {done.told}")
