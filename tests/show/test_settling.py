"""A drawn sheet is as high as its axes, and its notes hide nothing."""

from typing import Any

import numpy as np
import pytest

from duhem.show import figure

pytest.importorskip("matplotlib")

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tests.oracles.legible import faults


@pytest.mark.slow
def test_rows_of_flat_axes_leave_no_blank_sheet() -> None:
    def paint(*places: Axes) -> None:
        for axes in places:
            axes.plot([0.0, 3.0], [0.0, 1.0], label="line")
            axes.set_aspect("equal", adjustable="box")
        figure.snug(places)
        figure.legend_below(places)

    sheet = figure.drawn(paint, panels=8, columns=2, size=(4.9, 4.7), title="flat")[0].figure
    sheet.draw_without_rendering()
    under = sheet.legends[0].get_window_extent().y1
    axes = [axes.get_tightbbox() for axes in sheet.axes]
    blank = sheet.bbox.height - max(box.y1 for box in axes) + min(box.y0 for box in axes) - under
    assert blank < 0.1 * sheet.bbox.height  # once 0.6 of it
    widths = [box.width for box in axes]
    assert min(widths) > 0.4 * sheet.bbox.width


def test_numbers_do_not_touch_where_another_resolution_gives_an_axis_a_little_more_room() -> None:
    def paint(axes: Axes) -> None:
        axes.set(xlim=(-0.62, -0.435), ylim=(0.456, 0.641))
        figure.measure(axes.xaxis, "a")
        figure.measure(axes.yaxis, "b")

    sheet = figure.drawn(paint, size=(3.4, 3.0))[0].figure
    assert isinstance(sheet, Figure)
    sheet.set_figwidth(3.57)
    with figure.style():
        assert not faults(sheet)


@pytest.mark.slow
def test_a_title_wider_than_its_axes_does_not_reach_into_those_beside_it() -> None:
    def paint(*places: Axes) -> None:
        for axes in places:
            axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0), aspect="equal")
            figure.measure(axes.xaxis, "a")
            figure.measure(axes.yaxis, "b")
        places[1].set(ylim=(0.0, 0.2), title="what is said of the plane in the middle")
        figure.snug(places)

    places = figure.drawn(paint, panels=3, size=(3.5, 2.0))
    sheet = places[0].figure
    assert isinstance(sheet, Figure) and not faults(sheet)
    assert places[1].title.get_fontsize() == 10.0


def test_a_note_keeps_clear_of_the_way_between_points() -> None:
    (axes,) = figure.drawn(_noted)
    line, words = axes.lines[0], axes.texts[0]
    way = line.get_transform().transform_path(line.get_path())
    assert words.get_visible() and not way.intersects_bbox(words.get_window_extent(), filled=False)


def test_a_note_keeps_off_the_marks_of_other_points_and_off_the_boundary_where_it_can() -> None:
    points = {"inside": (0.0, 0.0), "first": (-0.6, -0.5), "second": (-0.5, -0.44)}

    def paint(axes: Any) -> None:
        axes.set(xlim=(-1, 1), ylim=(-1, 1))
        axes.plot([-1.0, 1.0], [0.07, 0.07], gid=figure.EDGE)
        for words, point in points.items():
            figure.note(axes, words, point)

    (axes,) = figure.drawn(paint)
    inside, first, _ = (text.get_window_extent() for text in axes.texts)
    assert not inside.y0 < axes.transData.transform((0.0, 0.07))[1] < inside.y1
    assert not first.contains(*axes.transData.transform(points["second"])) and all(text.get_visible() for text in axes.texts)


def test_a_note_stands_on_its_own_axes() -> None:
    def paint(axes: Any) -> None:
        axes.set(xlim=(-1, 1), ylim=(-1, 1))
        for x, y in ((-1.0, 0.9), (0.9, -1.0)):
            axes.plot([-0.85, x], [-0.9, y], gid=figure.EDGE)
        figure.note(axes, "many words of a note", (-0.9, -0.95))

    (axes,) = figure.drawn(paint)
    box, room = axes.texts[0].get_window_extent(), axes.bbox
    assert axes.texts[0].get_visible() and room.x0 - 9.0 <= box.x0 and room.y0 - 9.0 <= box.y0


def test_letters_a_little_too_large_for_a_flat_axis_are_read_still() -> None:
    def paint(axes: Axes) -> None:
        axes.set(xlim=(0.0, 10.0), ylim=(0.0, 1.3), aspect="equal")
        figure.measure(axes.yaxis, "across it", "unit of stress")

    (axes,) = figure.drawn(paint, size=(5.0, 4.0))
    assert axes.yaxis.label.get_fontsize() == 6.0


def test_a_note_keeps_off_arrows() -> None:
    def paint(axes: Any) -> None:
        axes.set(xlim=(-1, 1), ylim=(-1, 1))
        axes.quiver([0.0], [0.0], [0.3], [0.3], angles="xy", scale_units="xy", scale=1.0)
        figure.note(axes, "words", (0.0, 0.0))

    (axes,) = figure.drawn(paint)
    box = axes.texts[0].get_window_extent()
    along = axes.transData.transform(np.linspace(0.0, 0.3, 50)[:, None] * [1.0, 1.0])
    assert axes.texts[0].get_visible() and not any(box.contains(*point) for point in along)


def _noted(axes: Any) -> None:
    axes.plot([0.0, 1.0], [0.0, 1.0], gid=figure.OPEN)
    figure.note(axes, "here", (0.5, 0.5))
