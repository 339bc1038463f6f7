"""One style for every picture and one way to save it.  The only place that starts or writes a sheet (matplotlib, extra ``plot``)."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from math import floor, log10
from textwrap import fill
from typing import IO, TYPE_CHECKING, Any, Literal
from warnings import catch_warnings, filterwarnings

from duhem.errors import InputError, MissingExtraError
from duhem.show.place import check_place, written
from duhem.show.settling import EDGE, NOTE, OPEN, SIDES, settle

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

__all__ = [
    "EDGE",
    "GREY",
    "OPEN",
    "Picture",
    "Target",
    "as_svg",
    "check",
    "drawn",
    "hatched",
    "legend",
    "legend_below",
    "listed",
    "measure",
    "note",
    "outsize",
    "palette",
    "pen",
    "save",
    "shortened",
    "snug",
    "style",
    "wrapped",
]

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
_CHARACTER = 0.0075  # inches, of a letter of one point


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
    try:
        from matplotlib.style import context
    except ImportError:
        raise MissingExtraError("matplotlib", "plot") from None
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
            settle(_sheet_of(places), places)
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
            raise InputError(f"{type(place).__name__} is not matplotlib's Axes", where="axes", remedy="give what plt.subplots() makes")
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


def wrapped(text: str, width: float, points: float = 10.0) -> str:
    """``text`` in lines that fit into ``width`` inches, in letters of so many points; words too long are broken, `a = b` is one word."""
    kept = text.replace(" = ", _HELD)
    return "\n".join(fill(line, max(8, int(width / (_CHARACTER * points)))) for line in kept.splitlines()).replace(_HELD, " = ")


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
    axes.annotate(words, at, **SIDES[0], textcoords="offset points", fontsize="small", gid=NOTE)


def check(file: Target | None) -> None:
    """Whether a picture can be drawn and written there, asked before the work rather than after it; a stream is taken as it is.

    Raises MissingExtraError without matplotlib or contourpy, which it brings, InputError for an ending it cannot write, a folder
    that is not there, and a place that cannot be written to.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
    except ImportError:
        raise MissingExtraError("matplotlib", "plot") from None
    try:
        import contourpy  # noqa: F401
    except ImportError:
        raise MissingExtraError("contourpy", "plot") from None
    if file is None or _is_stream(file):
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


def _is_stream(file: object) -> bool:
    return callable(getattr(file, "write", None))


def _ending(file: str) -> str:
    return os.path.splitext(file)[1].removeprefix(".").lower()
