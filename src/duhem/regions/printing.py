"""A region as text for people, as a sheet, in LaTeX, and as a picture: the line of the parameter (extra ``plot``)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import sympy as sp

from duhem.errors import InputError
from duhem.law.atlas.entry import entry
from duhem.proof.kernel.parameter_cells import ParameterCell
from duhem.proof.kernel.real_root import RealRoot
from duhem.regions.numbers import written_root
from duhem.regions.result import ParameterRegion
from duhem.show import figure
from duhem.show.notation import latex_name
from duhem.show.page import PAGE, Page
from duhem.show.printing import draw, latex, plain, sheet, text
from duhem.show.sheet import Sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["as_dict", "as_latex", "as_sheet", "as_text", "plot"]

_HEAD = ("where", "verdict", "trust", "by")
_WORDS = {"proved": "holds", "refuted": "fails", "open": "open"}


@text.register(ParameterRegion)
def as_text(region: ParameterRegion, page: Page = PAGE) -> str:
    """The sentence, over what it was asked, a row a cell, and the ends with their polynomials."""
    law = region.criterion
    head = [*page.hanging(f"{law.name}: {law.summary}" if law.summary else law.name)]
    fields = dict(_fields(region))
    size = max(map(len, fields))
    table = page.table([_HEAD, *_rows(region)], "llll", "", rule=True)
    ends = [line for said in _ends(region) for line in page.item(said)]
    told = [*page.hanging(f"{region.sentence}.")]
    return page.report([[*head, *(line for name, said in fields.items() for line in page.field(name, said, size))], told, table, ends])


@sheet.register(ParameterRegion)
def as_sheet(region: ParameterRegion) -> Sheet:
    """The same as a sheet."""
    title = f"{region.criterion.name}: {region.sentence}"
    return Sheet(title, tuple(_fields(region)), _HEAD, tuple(_rows(region)), (("Ends", tuple(_ends(region))),))


@plain.register(ParameterRegion)
def as_dict(region: ParameterRegion) -> dict[str, Any]:
    """The JSON of the interface."""
    return region.to_dict()


@latex.register(ParameterRegion)
def as_latex(region: ParameterRegion) -> str:
    """The condition as a formula."""
    words = {"true": r"\text{for all values}", "false": r"\text{for no value}"}
    if (condition := region.condition) in words:
        return words[condition]
    (name,) = region.parameters
    return r" \;\vee\; ".join(_latex_between(cell, name) for cell in region.stretches("proved"))


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


def _fields(region: ParameterRegion) -> Iterator[tuple[str, str]]:
    law, (name,) = region.criterion, region.parameters
    yield "claim", region.claim
    yield "over", f"all {name}" if (over := region.to_dict()["domain"]) == "true" else over
    if others := [own.stated(other) for other, own in law.parameters.items() if other != name]:
        yield "others", ", ".join(others)
    if published := _published(region):
        yield "published", published


def _published(region: ParameterRegion) -> str:
    """What the literature claims of a law of the atlas; of another law that has its name nothing is known."""
    with suppress(InputError):
        own = entry(region.criterion.name)
        return own.claims.get(region.claim, "") if own.summary == region.criterion.summary else ""
    return ""


def _rows(region: ParameterRegion) -> list[tuple[str, ...]]:
    found, (name,) = list[tuple[str, ...]](), region.parameters
    for cell, done in zip(region.cells, region.decided, strict=True):
        by = "" if done.row is None else str(done.row["rule"])
        single = done.cell.low if done.cell.single else None
        where = cell.condition if single is None else f"{name} = {written_root(single)}"
        found.append((f"all {name}" if done.cell == region.domain else where, cell.verdict, cell.trust or "-", by))
    return found


def _ends(region: ParameterRegion) -> Iterator[str]:
    for end in region.ends:
        root = "" if end.enclosure[0] == end.enclosure[1] else f" = {float(sp.Rational(end.enclosure[0])):.12g}"
        word = "still holds" if end.closed else "no longer holds"
        yield f"{end.parameter} = {end.value}{root}: root of {end.polynomial}; {region.claim} {word} there"


@draw.register(ParameterRegion)
def plot(region: ParameterRegion, file: Any = None, axes: Any = None) -> tuple[Axes, ...]:
    """The line of the parameter, where the claim holds, fails and is open, with its ends; hatches tell what colours tell."""
    title = f"{region.criterion.name}: {region.sentence}"
    return figure.drawn(lambda place: _paint(place, region), file, axes, size=(7.2, 2.0), title=title)


def _paint(axes: Axes, region: ParameterRegion) -> None:
    from matplotlib.patches import Rectangle

    low, high = _window(region)
    for verdict, colour, lines in (("proved", figure.palette(0), ""), ("refuted", figure.palette(1), "///"), ("open", figure.GREY, "...")):
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


def _window(region: ParameterRegion) -> tuple[float, float]:
    """The domain, of an infinite one what is around its ends."""
    own = region.domain
    marks = [float(sp.Rational(end.enclosure[0])) for end in region.ends] + [
        float(e.low) for e in (own.low, own.high) if e is not None
    ] or [0.0]
    wide = max(max(marks) - min(marks), 1.0)
    low = min(marks) - 0.5 * wide if own.low is None else float(own.low.low)
    high = max(marks) + 0.5 * wide if own.high is None else float(own.high.low)
    return low, high
