"""A region as text for people, as a sheet, in LaTeX, and as a picture: the line of the parameter, or the plane of two (extra ``plot``)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.expression.parse import parse_relation
from duhem.law.atlas.entry import entry
from duhem.law.catalogue import load_formula
from duhem.proof.kernel.real_root import RealRoot
from duhem.regions.line import ParameterCell
from duhem.regions.numbers import written_root
from duhem.regions.paved import PavedRegion
from duhem.regions.result import FoundRegion, ParameterRegion
from duhem.show import figure
from duhem.show.notation import latex_name
from duhem.show.page import PAGE, Page
from duhem.show.printing import draw, latex, plain, sheet, text
from duhem.show.sheet import Sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["as_dict", "as_latex", "as_sheet", "as_text", "plot"]

_HEAD = ("where", "verdict", "trust", "by")
_MOST_ROWS = 40
_FINE = 401  # places along each edge of a picture
_LOOKS = (("proved", figure.palette(0), ""), ("refuted", figure.palette(1), "///"), ("open", figure.GREY, "..."))
_WORDS = {"proved": "holds", "refuted": "fails", "open": "open"}


@text.register(FoundRegion)
def as_text(region: FoundRegion, page: Page = PAGE) -> str:
    """The sentence, over what it was asked, a row a cell, and the ends with their polynomials."""
    law = region.criterion
    head = [*page.hanging(f"{law.name}: {law.summary}" if law.summary else law.name)]
    fields = dict(_fields(region))
    size = max(map(len, fields))
    table = page.table([_HEAD, *_rows(region)], "llll", "", rule=True)
    ends = [line for said in _ends(region) for line in page.item(said)]
    told = [*page.hanging(f"{region.sentence}.")]
    return page.report([[*head, *(line for name, said in fields.items() for line in page.field(name, said, size))], told, table, ends])


@sheet.register(FoundRegion)
def as_sheet(region: FoundRegion) -> Sheet:
    """The same as a sheet."""
    title = f"{region.criterion.name}: {region.sentence}"
    return Sheet(title, tuple(_fields(region)), _HEAD, tuple(_rows(region)), (("Ends", tuple(_ends(region))),))


@plain.register(FoundRegion)
def as_dict(region: FoundRegion) -> dict[str, Any]:
    """The JSON of the interface."""
    return region.to_dict()


@latex.register(FoundRegion)
def as_latex(region: FoundRegion) -> str:
    """The condition as a formula."""
    words = {"true": r"\text{for all values}", "false": r"\text{for no value}"}
    if (condition := region.condition) in words:
        return words[condition]
    if isinstance(region, PavedRegion):
        names = {name: sp.Symbol(latex_name(name), real=True) for name in region.parameters}
        parts = map(region.relations, region.stretches("proved"))
        said = [r" \;\wedge\; ".join(_latex_relation(text, names) for text in part) for part in parts]
    else:
        (name,) = region.parameters
        said = [_latex_between(cell, name) for cell in cast("ParameterRegion", region).stretches("proved")]
    return r" \;\vee\; ".join(said)


def _latex_relation(text: str, names: dict[str, sp.Symbol]) -> str:
    equal = text.replace("==", "<=")
    said = str(sp.latex(parse_relation(equal, names)))
    return said if equal == text else said.replace(r"\leq", "=")


def _latex_between(cell: ParameterCell, name: str) -> str:
    x = latex_name(name)
    if cell.single and cell.low is not None:
        return f"{x} = {_latex_number(cell.low)}"
    below, above = ("<" if left_out else r"\leq" for left_out in (cell.open, cell.open_high))
    low = "" if cell.low is None else f"{_latex_number(cell.low)} {below} "
    high = "" if cell.high is None else f" {above} {_latex_number(cell.high)}"
    return f"{low}{x}{high}"


def _latex_number(end: RealRoot) -> str:
    return str(sp.latex(sp.sympify(written_root(end), rational=True)))


def _fields(region: FoundRegion) -> Iterator[tuple[str, str]]:
    law, names = region.criterion, region.parameters
    yield "claim", region.claim
    yield "over", f"all {', '.join(names)}" if region.over == "true" else region.over
    if others := [own.stated(other) for other, own in law.parameters.items() if other not in names]:
        yield "others", ", ".join(others)
    if published := _published(region):
        yield "published", published


def _published(region: FoundRegion) -> str:
    """What the literature claims of a law of the atlas; of another law that has its name nothing is known."""
    with suppress(InputError):
        own = entry(region.criterion.name)
        return own.claims.get(region.claim, "") if own.summary == region.criterion.summary else ""
    return ""


def _published_point(region: FoundRegion) -> list[float]:
    """The values that the law of the atlas has for the parameters of a region, if they all have one."""
    with suppress(InputError):
        own = load_formula(region.criterion.name)
        domains = [own.parameters[name] for name in region.parameters if name in own.parameters]
        values = [float(own.value) for own in domains if own.value is not None]
        return values if own.summary == region.criterion.summary and len(values) == len(region.parameters) else []
    return []


def _rows(region: FoundRegion) -> list[tuple[str, ...]]:
    if isinstance(region, PavedRegion) and len(region.known) > _MOST_ROWS:
        return list(_counted(region))
    rules = (str((done.row or {}).get("rule", "")) for _, done in region.known)
    whole = f"all {', '.join(region.parameters)}"
    shown = zip(region.cells, rules, strict=True)
    return [(whole if c.condition == "true" else c.condition.replace("==", "="), c.verdict, c.trust or "-", rule) for c, rule in shown]


def _counted(region: PavedRegion) -> Iterator[tuple[str, ...]]:
    """A row a verdict, where leaves are many."""
    for verdict in ("proved", "refuted", "open"):
        own = [leaf.row or {} for _, leaf in region.known if leaf.verdict == verdict]
        by = ", ".join(dict.fromkeys(str(row["rule"]) for row in own if row))
        if own:
            count = "1 cell" if len(own) == 1 else f"{len(own)} cells"
            yield f"{count}, {region.percentage(verdict)} of the domain", verdict, "checked" if by else "-", by


def _ends(region: FoundRegion) -> Iterator[str]:
    for end in region.ends:
        root = "" if end.enclosure[0] == end.enclosure[1] else f" = {float(sp.Rational(end.enclosure[0])):.12g}"
        word = "still holds" if end.closed else "no longer holds"
        yield f"{end.parameter} = {end.value}{root}: root of {end.polynomial}; {region.claim} {word} there"


@draw.register(FoundRegion)
def plot(region: FoundRegion, file: Any = None, axes: Any = None) -> tuple[Axes, ...]:
    """Where the claim holds, fails and is open on the line of a parameter or in the plane of two; hatches tell what colours tell."""
    title = f"{region.criterion.name}: {region.sentence}"
    if isinstance(region, PavedRegion):
        if len(region.parameters) != 2:
            raise InputError("a picture is of one parameter or two", where=region.criterion.name, remedy="fix others with --set")
        return figure.drawn(lambda place: _paint_plane(place, region), file, axes, title=title)
    return figure.drawn(lambda place: _paint(place, cast("ParameterRegion", region)), file, axes, size=(7.2, 2.0), title=title)


def _paint_plane(axes: Axes, region: PavedRegion) -> None:
    ranges = [_shown_range(region, name) for name in region.parameters]
    x, y = np.meshgrid(*(np.linspace(low, high, _FINE) for low, high in ranges))
    verdicts = region.at(dict(zip(region.parameters, (x, y), strict=True)))
    for verdict, colour, lines in _LOOKS:
        there = verdicts == verdict
        if there.any():
            axes.contourf(x, y, there, levels=[0.5, 1.5], colors=[colour], alpha=0.75, hatches=[lines])
            axes.fill([], [], facecolor=colour, hatch=lines, alpha=0.75, label=f"{region.claim} {_WORDS[verdict]}")
    if (point := _published_point(region)) and all(low <= at <= high for at, (low, high) in zip(point, ranges, strict=True)):
        axes.plot(*([at] for at in point), "o", color="black", markeredgecolor="white", linestyle="none", label="published")
    for axis, name in zip((axes.xaxis, axes.yaxis), region.parameters, strict=True):
        axis.set_label_text(f"${latex_name(name)}$")
    figure.legend(axes)


def _shown_range(region: PavedRegion, name: str) -> tuple[float, float]:
    """The range of a parameter, of an endless one what is around the ends of the places."""
    marks = [float(end) for place, _ in region.places for end in place.box[name][:2] if end is not None]
    return _around(region.whole[name].low, region.whole[name].high, marks, 1 / 4)


def _around(first: Fraction | None, last: Fraction | None, marks: list[float], share: float) -> tuple[float, float]:
    """A range, and a share of what is between the ``marks`` in the place of each end that it has not."""
    low, high = (None if end is None else float(end) for end in (first, last))
    marks = [*marks, *(end for end in (low, high) if end is not None)] or [0.0]
    wide = share * max(max(marks) - min(marks), 1.0)
    return min(marks) - wide if low is None else low, max(marks) + wide if high is None else high


def _paint(axes: Axes, region: ParameterRegion) -> None:
    from matplotlib.patches import Rectangle

    first, last = (None if end is None else end.low for end in region.domain[:2])
    low, high = _around(first, last, [float(sp.Rational(end.enclosure[0])) for end in region.ends], 1 / 2)
    for verdict, colour, lines in _LOOKS:
        for i, cell in enumerate(region.stretches(verdict)):
            start, stop = (low if cell.low is None else float(cell.low.low)), (high if cell.high is None else float(cell.high.high))
            if stop <= low or start >= high:
                continue
            start, stop = max(start, low), min(stop, high)
            label = "_" if i else f"{region.claim} {_WORDS[verdict]}"
            axes.add_patch(
                Rectangle((start, 0.0), stop - start, 1.0, facecolor=colour, edgecolor="white", hatch=lines, alpha=0.75, label=label)
            )
    for end in region.ends:
        x = float(sp.Rational(end.enclosure[0]))
        filled = end.closed
        axes.plot([x], [0.5], "o", color="black", markerfacecolor="black" if filled else "white", markersize=7, zorder=4)
        axes.annotate(
            f"${latex_name(end.parameter)} = {sp.latex(sp.sympify(end.value, rational=True))}$", (x, 1.05), ha="center", va="bottom"
        )
    axes.set_xlim(low, high)
    axes.set_ylim(0.0, 1.6 if region.ends else 1.0)
    axes.set_yticks([])
    published = f"\npublished: {said}" if (said := _published(region)) else ""
    axes.set_xlabel(f"${latex_name(region.parameters[0])}${published}")
    figure.legend(axes)
