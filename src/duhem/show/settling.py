"""What a drawn sheet needs to be read: numbers that do not touch, rows as high as their axes, notes where they hide nothing."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise, permutations
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.path import Path
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

__all__ = ["EDGE", "NOTE", "OPEN", "SIDES", "settle"]

NOTE = "note"  # gid of words beside a point
OPEN = "open"  # gid of a line that notes keep clear of
EDGE = "edge"  # gid of a line that they keep clear of where there is room for that too
SIDES: tuple[dict[str, Any], ...] = tuple(
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


def settle(sheet: Figure, places: tuple[Axes, ...]) -> None:
    """Fewer numbers on axes on which they touch, words that keep to their place, no blank sheet, notes that hide nothing."""
    from matplotlib.text import Annotation

    _uncrowd(sheet, places)
    if _trimmed(sheet, places):
        _uncrowd(sheet, places)
    _keep_counts(places)
    for axes in places:
        notes = [text for text in axes.texts if isinstance(text, Annotation) and text.get_gid() == NOTE]
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
            yield from ((side, free, place) for side in SIDES)


def _uncrowd(sheet: Figure, places: tuple[Axes, ...], rounds: int = 6) -> None:
    from matplotlib.ticker import LogLocator, MaxNLocator

    numbered = [
        axis for axes in places for axis in (axes.xaxis, axes.yaxis) if isinstance(axis.get_major_locator(), LogLocator | MaxNLocator)
    ]
    for _ in range(rounds):
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
