"""One style for every picture and one way to save it.  The only place that starts or writes a sheet (matplotlib, extra ``plot``).

A drawn sheet is settled: numbers do not touch, rows are as high as their axes, notes stand where they hide nothing.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import pairwise, permutations
from math import floor, log10
from textwrap import fill
from typing import IO, TYPE_CHECKING, Any, Literal
from warnings import catch_warnings, filterwarnings

from duhem.errors import InputError, imported_from
from duhem.show.place import check_place, written

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch
    from matplotlib.path import Path
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

__all__ = [
    "EDGE", "GREY", "OPEN", "Picture", "Target", "as_svg", "check", "drawn", "hatched", "legend", "legend_below",
    "listed", "measure", "note", "outsize", "palette", "pen", "save", "shortened", "snug", "style", "wrapped",
]  # fmt: skip

Target = str | bytes | os.PathLike[Any] | IO[bytes]

# Okabe and Ito (2008): told apart with any colour vision; dashes and marks tell the same without colour.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
_DASHES = ("-", (0, (6, 2)), (0, (6, 2, 1.5, 2)), (0, (1.5, 1.5)), (0, (3, 1.5)))
_MARKS = ("o", "s", "^", "D", "v", "P", "X", "*")
GREY = "0.45"

_STYLE = {
    "axes.formatter.use_mathtext": True,
    "axes.labelsize": "medium",
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": "medium",
    "figure.titlesize": "medium",
    "font.size": 10.0,
    "legend.fontsize": "small",
    "legend.frameon": False,
    "legend.handlelength": 2.8,
    "lines.linewidth": 1.6,
    "lines.markersize": 5.0,
    "lines.solid_capstyle": "round",  # a curve that ends where it began shows no seam
    "svg.hashsalt": "duhem",  # the same picture gives the same file
    "xtick.labelsize": "small",
    "ytick.labelsize": "small",
}
_UNDATED: dict[str, dict[str, Any]] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_PREFIXED = ("Pa", "N", "m", "J/m²")
_SHORT, _LONG = 1e-3, 1e5  # between which numbers are written out
_LEAST, _MOST = 1e-200, 1e200
_NO_LETTER = r"Glyph \d+ .*missing from (font|current font)|Matplotlib currently does not support \w+ natively"
_HELD = "\u00a0=\u00a0"
_CHARACTER = 0.075  # inches, of a letter


def palette(i: int) -> str:
    """The colour of the i-th of several curves."""
    return _COLOURS[i % len(_COLOURS)]


def pen(i: int) -> dict[str, Any]:
    """Colour, dashes and mark of the i-th of several curves; no two of the first 56 share colour and mark."""
    return {"color": palette(i), "linestyle": _DASHES[i % len(_DASHES)], "marker": _MARKS[i % len(_MARKS)]}


class Picture(tuple["Axes", ...]):
    """The axes of a new sheet, which no other part of a notebook knows: as the last value of a cell they show the sheet."""

    def _repr_png_(self) -> bytes:
        from io import BytesIO

        beside = BytesIO()
        with style():
            _sheet_of(self).savefig(beside, format="png", dpi=100)
        return beside.getvalue()


@contextmanager
def style() -> Iterator[None]:
    """The house style, whatever the reader's own settings are, while it lasts; a letter that the font lacks is drawn as a box.

    Raises MissingExtraError without matplotlib.
    """
    with imported_from("matplotlib", "plot"):
        from matplotlib.style import context
    with context(["default", _STYLE]), catch_warnings():
        filterwarnings("ignore", message=_NO_LETTER, category=UserWarning)
        yield


def drawn(
    paint: Callable[..., None],
    file: Target | None = None,
    axes: Iterable[Axes] | None = None,
    *,
    panels: int = 1,
    columns: int = 3,
    size: tuple[float, float] = (6.0, 4.4),
    title: str = "",
) -> tuple[Axes, ...]:
    """Let ``paint`` draw on ``panels`` axes, those given or the axes of a new sheet, and write ``file`` if one is given.

    ``size`` in inches is that of a panel; ``columns`` of them stand side by side.  ``title`` stands on a new sheet only, whose axes are
    a :class:`Picture`.
    Raises MissingExtraError without matplotlib, InputError for a file that cannot be written or axes that are too few.
    """
    if file is not None:
        check(file)
    with style():
        if axes is not None:
            places = _given(axes, panels)
            paint(*places)
        else:
            places = Picture(_sheet(panels, min(columns, panels), size, title))
            paint(*places)
            _settle(_sheet_of(places), places)
    if file is not None:
        save(_sheet_of(places), file)
    return places


def listed(axes: Iterable[Axes] | Axes) -> tuple[Axes, ...]:
    """The axes that are given, one alone too."""
    try:
        return tuple(axes)  # type: ignore[arg-type]
    except TypeError:
        return (axes,)  # type: ignore[return-value]


def _given(axes: Iterable[Axes], panels: int) -> tuple[Axes, ...]:
    from matplotlib.axes import Axes as Kind

    places = listed(axes)
    if len(places) != panels:
        raise InputError(f"this picture has {panels} axes, {len(places)} are given", where="axes", remedy=f"give {panels}")
    for place in places:
        if not isinstance(place, Kind):
            raise InputError(f"{type(place).__name__} is not matplotlib's Axes", where="axes", remedy="give axes from plt.subplots()")
    return places


def _sheet(panels: int, columns: int, size: tuple[float, float], title: str) -> tuple[Axes, ...]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    rows = -(-panels // columns)
    width = size[0] * columns
    sheet = Figure(figsize=(width, size[1] * rows), layout="constrained")
    FigureCanvasAgg(sheet)
    if title:
        for share in (1.0, 0.75, 0.5):
            said = sheet.suptitle(wrapped(title, share * width).replace("$", r"\$"))
            if said.get_window_extent().width <= sheet.bbox.width:
                break
    every = sheet.subplots(rows, columns, squeeze=False).ravel()
    for spare in every[panels:]:
        spare.remove()
    return tuple(every[:panels])


def _sheet_of(places: tuple[Axes, ...]) -> Figure:
    sheet = places[0].get_figure(root=True)
    assert sheet is not None
    return sheet


def wrapped(text: str, width: float) -> str:
    """``text`` in lines that fit into ``width`` inches; words too long are broken, `a = b` is one word."""
    kept = text.replace(" = ", _HELD)
    return "\n".join(fill(line, max(8, int(width / _CHARACTER))) for line in kept.splitlines()).replace(_HELD, " = ")


def shortened(text: str, most: int = 36) -> str:
    """``text``, its middle left out where it is longer than ``most``."""
    return text if len(text) <= most else f"{text[: most // 2]}…{text[-(most - 1) // 2 :]}"


def measure(axis: Axis, symbol: str, unit: str = "", size: float = 0.0) -> None:
    """Write ``symbol [unit]`` at an axis, ``[–]`` where it is dimensionless.

    With the ``size`` of the greatest number on it, the numbers at its ticks count the unit with the prefix that suits
    them (kPa, µm), or a power of ten where there is none; of a unit that takes no prefix, as MPa, they count a power of
    ten where they are long.  What is drawn stays in the unit itself, over :func:`outsize`.
    """
    from matplotlib.ticker import ScalarFormatter

    takes = unit in _PREFIXED
    power = _power(size) if takes or not _SHORT <= size < _LONG else 0
    if power:
        numbers = ScalarFormatter(useOffset=False)
        if outsize(size) == 1.0:
            numbers.set_powerlimits((power, power))
        axis.set_major_formatter(numbers)
        axis.offsetText.set_visible(False)  # the unit says it
    prefix = _PREFIXES.get(power) if takes or not power else None
    counted = f"$10^{{{power}}}$ {unit}".rstrip() if prefix is None else prefix + unit
    axis.set_label_text(f"{symbol} [{counted or '–'}]")


def outsize(size: float) -> float:
    """What numbers up to ``size`` are divided by before they are drawn: 1 but where a canvas's own arithmetic would end."""
    return 1.0 if size == 0.0 or _LEAST < size < _MOST else 10.0 ** _power(size)


def _power(size: float) -> int:
    """The greatest multiple of three whose power of ten is not above ``size``; 0 for 0."""
    return 3 * floor(log10(size) / 3.0 + 1e-12) if size else 0


def legend(axes: Axes, where: Literal["above", "best", "lower right"] = "above") -> None:
    """Name what is labelled on the axes: above them, in as many columns as fit, or at a place where there is room."""
    handles, labels = axes.get_legend_handles_labels()
    if not labels:
        return
    labels = [_entry(label) for label in labels]
    if where != "above":
        axes.legend(handles, labels, loc=where)
        return
    for columns in range(min(len(labels), 4), 0, -1):
        made = axes.legend(handles, labels, ncols=columns, loc="lower center", bbox_to_anchor=(0.5, 1.0), borderaxespad=0.2)
        if made.get_window_extent().width <= axes.get_window_extent().width:
            return


def _entry(label: str) -> str:
    """A label of a legend, not too long; mathematics is not cut."""
    return label if "$" in label else shortened(label)


def snug(places: tuple[Axes, ...]) -> None:
    """Bring axes of a fixed shape close to each other, on a sheet of their own."""
    _sheet_of(places).set_layout_engine("compressed")


def legend_below(places: tuple[Axes, ...]) -> None:
    """One legend for several axes, below them all; on the first of them where the sheet does not make room for it.

    What has one label on the same axes is one entry, drawn over each other.
    """
    from matplotlib.legend_handler import HandlerTuple

    named: dict[str, Any] = {}
    for axes in places:
        own: dict[str, tuple[Any, ...]] = {}
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            own[_entry(label)] = (*own.get(_entry(label), ()), handle)
        named = own | named
    if not named:
        return
    entries = {"handles": [*named.values()], "labels": [*named], "handler_map": {tuple: HandlerTuple(ndivide=1)}}
    sheet = _sheet_of(places)
    if sheet.get_layout_engine() is None:
        places[0].legend(**entries, loc="best")
        return
    for columns in range(len(named), 0, -1):
        made = sheet.legend(**entries, ncols=columns, loc="outside lower center")
        if made.get_window_extent().width <= sheet.bbox.width or columns == 1:
            return
        made.remove()


def hatched(axes: Axes, area: Patch, lines: str, colour: str) -> None:
    """Add an area with lines over it, as faint as it is: a patch of their own, for in one patch a file in SVG fades them twice."""
    from matplotlib.colors import to_rgba
    from matplotlib.patches import PathPatch

    look = {"facecolor": "none", "edgecolor": to_rgba(colour, area.get_alpha()), "linewidth": 0.0, "hatch": lines}
    axes.add_patch(area)
    axes.add_patch(PathPatch(area.get_path(), **look, zorder=area.get_zorder(), label=str(area.get_label())))


def note(axes: Axes, words: str, at: tuple[float, float]) -> None:
    """Words beside a point, on the side where there is room; on a sheet of its own they are left out where there is none."""
    axes.annotate(words, at, **_SIDES[0], textcoords="offset points", fontsize="small", gid=_NOTE)


def check(file: Target | None) -> None:
    """Whether a picture can be drawn and written there, asked before the work rather than after it; a stream is taken as it is.

    Raises MissingExtraError without matplotlib or contourpy, which it brings, InputError for an ending it cannot write, a folder
    that is not there, and a place that cannot be written to.
    """
    with imported_from("matplotlib", "plot"):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
    with imported_from("contourpy", "plot"):
        import contourpy  # noqa: F401
    if file is None or callable(getattr(file, "write", None)):
        return
    if not isinstance(file, str | bytes | os.PathLike):
        raise InputError(f"{type(file).__name__} is no file", where="file", remedy="give a name or an open binary file")
    file = os.fsdecode(file)
    ending = _ending(file)
    if ending not in (known := FigureCanvasAgg.get_supported_filetypes()):
        first = ("png", "pdf", "svg")
        remedy = f"end the name in {', '.join(f'.{form}' for form in (*first, *sorted(set(known) - set(first))))}"
        raise InputError(f"{ending or 'no ending'} is no format of a figure", where=f"{file}", remedy=remedy)
    check_place(file)


def save(sheet: Figure, file: Target) -> None:
    """Write a sheet in the format that the file's ending names, whole or not at all; the same sheet gives the same bytes.

    Into a stream it is written as PNG.

    Raises what :func:`check` raises.
    """
    check(file)
    if not isinstance(file, str | bytes | os.PathLike):
        with style():
            sheet.savefig(file, format="png", dpi=160)
        return
    file = os.fsdecode(file)
    form = _ending(file)
    with written(file) as beside, style():
        sheet.savefig(beside, format=form, dpi=160, metadata=_UNDATED.get(form))


def as_svg(places: tuple[Axes, ...]) -> str:
    """The sheet of some axes as the text of an SVG file, the same for the same sheet."""
    from io import StringIO

    beside = StringIO()
    with style():
        _sheet_of(places).savefig(beside, format="svg", metadata=_UNDATED["svg"])
    return beside.getvalue()


def _ending(file: str) -> str:
    return os.path.splitext(file)[1].removeprefix(".").lower()


# -- what a drawn sheet needs to be read ----------------------------------------------------------------------------------

_NOTE = "note"  # gid of words beside a point
OPEN = "open"  # gid of a line that notes keep clear of
EDGE = "edge"  # gid of a line that they keep clear of where there is room for that too
_SIDES: tuple[dict[str, Any], ...] = tuple(
    {"xytext": (5 * x, 5 * y), "ha": "left" if x > 0 else "right", "va": "bottom" if y > 0 else "top"}
    for x, y in ((1, 1), (-1, 1), (1, -1), (-1, -1))
)
_MARK = 7.0  # points
_OVER = 9.0  # pixels that a note may stand over the side of its axes: as far as a tick and its pad
_APART = 8.0  # pixels between a title and the axes beside it
_SMALLEST = 1.0  # points, of letters
_READ = 6.0  # points that letters keep where they take a little more room than they have
_BEFORE_UNIT = " ["
_BLANK = 0.3  # inches that a sheet may leave free


def _settle(sheet: Figure, places: tuple[Axes, ...]) -> None:
    """Fewer numbers on axes on which they touch, words that keep to their place, no blank sheet, notes that hide nothing."""
    from matplotlib.text import Annotation

    _uncrowd(sheet, places)
    if _trimmed(sheet, places):
        _uncrowd(sheet, places)
    _keep_counts(places)
    for axes in places:
        notes = [text for text in axes.texts if isinstance(text, Annotation) and text.get_gid() == _NOTE]
        taken = [_mark(sheet, axes, note.xy) for note in notes]
        lines = [_paths(axes, OPEN), [*_paths(axes, EDGE), *_shafts(axes)]]
        for text in notes:
            for side, across, place in _sides(axes.bbox, *lines):
                text.set(position=side["xytext"], ha=side["ha"], va=side["va"])
                box = text.get_window_extent()
                room = all(place.contains(*corner) for corner in box.corners()) and not box.count_overlaps(taken)
                if room and not any(line.intersects_bbox(box, filled=False) for line in across):
                    taken.append(box)
                    break
            else:
                text.set_visible(False)


def _trimmed(sheet: Figure, places: tuple[Axes, ...]) -> bool:
    """Give the rows of a sheet the heights of their axes, and take off it what axes of a fixed shape leave blank; whether it was much."""
    boxes = [box for axes in places if (box := axes.get_tightbbox()) is not None]
    top = max([box.y1 for box in boxes] + [text.get_window_extent().y1 for text in sheet.texts])
    under = max([legend.get_window_extent().y1 for legend in sheet.legends], default=0.0)
    blank = (sheet.bbox.height - top + min(box.y0 for box in boxes) - under) / sheet.dpi
    if blank < _BLANK:
        return False
    heights: dict[int, float] = {}
    for axes, spec in ((axes, axes.get_subplotspec()) for axes in places):
        assert spec is not None
        heights[spec.rowspan.start] = max(heights.get(spec.rowspan.start, 0.0), axes.get_position().height)
        grid = spec.get_gridspec()
    grid.set_height_ratios([heights[row] for row in sorted(heights)])
    sheet.set_figheight(sheet.get_figheight() - blank + _BLANK / 2.0)
    return True


def _mark(sheet: Figure, axes: Axes, point: tuple[float, float]) -> Bbox:
    """What the mark of a point covers."""
    from matplotlib.transforms import Bbox

    x, y = axes.transData.transform(point)
    half = _MARK / 2.0 * sheet.dpi / 72.0
    return Bbox.from_extents(x - half, y - half, x + half, y + half)


def _paths(axes: Axes, kind: str) -> list[Path]:
    return [line.get_transform().transform_path(line.get_path()) for line in axes.lines if line.get_gid() == kind]


def _shafts(axes: Axes) -> list[Path]:
    """The arrows, each from its foot to its tip."""
    import numpy as np
    from matplotlib.path import Path
    from matplotlib.quiver import Quiver

    every = [np.array([each.X, each.Y, each.U, each.V], dtype=float).T for each in axes.collections if isinstance(each, Quiver)]
    return [Path(axes.transData.transform([(x, y), (x + u, y + v)])) for arrows in every for x, y, u, v in arrows]


def _sides(room: Bbox, lines: list[Path], edges: list[Path]) -> Iterator[tuple[dict[str, Any], list[Path], Bbox]]:
    """Where a note may stand, the lines it must not touch there, none of all, none of the first kind, or else any, and its room."""
    for free in ([*lines, *edges], lines, []):
        for place in (room, room.padded(_OVER)):
            yield from ((side, free, place) for side in _SIDES)


def _uncrowd(sheet: Figure, places: tuple[Axes, ...]) -> None:
    from matplotlib.ticker import LogLocator, MaxNLocator

    numbered = [
        axis for axes in places for axis in (axes.xaxis, axes.yaxis) if isinstance(axis.get_major_locator(), LogLocator | MaxNLocator)
    ]
    for _ in range(6):
        sheet.draw_without_rendering()
        crowded = [axis for axis in numbered if _touching(axis)]
        long = [_brought_in(axis) for axes in places for axis in (axes.xaxis, axes.yaxis)]
        long += [
            _set_smaller(axes.title, sheet.bbox.width / _columns(axes) / (axes.title.get_window_extent().width or 1.0)) for axes in places
        ]
        long.append(_moved_apart(sheet, places))
        if not crowded and not any(long):
            return
        for axis in crowded:
            fewer = max(2, len(axis.get_majorticklocs()) - 3)
            logarithmic = isinstance(axis.get_major_locator(), LogLocator)
            axis.set_major_locator(LogLocator(numticks=fewer) if logarithmic else MaxNLocator(fewer - 1, steps=[1, 2, 2.5, 5, 10]))


def _keep_counts(places: tuple[Axes, ...]) -> None:
    """As many numbers on each axis as it has now: at another resolution a little more room would bring others, which may touch."""
    from matplotlib.ticker import AutoLocator, MaxNLocator

    for axis in (axis for axes in places for axis in (axes.xaxis, axes.yaxis)):
        if isinstance(axis.get_major_locator(), AutoLocator):
            axis.set_major_locator(MaxNLocator(min(max(axis.get_tick_space(), 1), 9), steps=[1, 2, 2.5, 5, 10]))


def _brought_in(axis: Axis) -> bool:
    """Whether the label was longer than its axis: it is broken before its unit, then set in letters as small as it takes."""
    from matplotlib.axis import XAxis

    box, edge = axis.label.get_window_extent(), axis.axes.bbox
    share = edge.width / (box.width or 1.0) if isinstance(axis, XAxis) else edge.height / (box.height or 1.0)
    text = axis.label.get_text()
    if share >= 1.0 or not axis.get_visible():
        return False
    if _BEFORE_UNIT not in text:
        return _set_smaller(axis.label, share)
    axis.set_label_text(text.replace(_BEFORE_UNIT, "\n["))
    return True


def _moved_apart(sheet: Figure, places: tuple[Axes, ...]) -> bool:
    """Whether a title reached into the axes beside it, for a layout gives axes no room for the width of their titles: columns get it."""
    over = 0.0
    for axes, other in permutations(places, 2):
        title = axes.title.get_window_extent()
        taken = [other.bbox, other.title.get_window_extent(), other.yaxis.get_tightbbox()]
        for box in (box for box in taken if box is not None and title.overlaps(box)):
            over = max(over, min(title.x1 - box.x0, box.x1 - title.x0))
    layout = sheet.get_layout_engine()
    if over == 0.0 or layout is None:
        return False
    layout.set(w_pad=layout.get()["w_pad"] + (over + _APART) / 2.0 / sheet.dpi)  # type: ignore[call-arg]
    return True


def _columns(axes: Axes) -> int:
    spec = axes.get_subplotspec()
    return spec.get_gridspec().ncols if spec is not None else 1


def _set_smaller(words: Text, share: float) -> bool:
    """Set words of which only a share fits in smaller letters; whether that was so."""
    size = float(words.get_fontsize())
    if share >= 1.0 or size <= _SMALLEST:
        return False
    smaller = max(_SMALLEST, 0.98 * share * size)
    chosen = _READ if 0.8 * _READ < smaller < _READ else smaller
    words.set_fontsize(chosen)
    return chosen < size


def _touching(axis: Axis) -> bool:
    """Whether two numbers of an axis overlap, with a letter's gap between them."""
    from matplotlib.axis import XAxis

    low, high = sorted(axis.get_view_interval())
    boxes = [tick.label1.get_window_extent() for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high and tick.label1.get_text()]
    along = "x" if isinstance(axis, XAxis) else "y"
    spans = sorted((getattr(box, f"{along}0"), getattr(box, f"{along}1")) for box in boxes)
    gap = 4.0 if along == "x" else 0.0
    return any(here[1] + gap > there[0] for here, there in pairwise(spans))
