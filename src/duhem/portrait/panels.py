"""K and the witnesses of a verification as pictures of their own, for a page that is narrow or wide."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

from duhem.portrait.drawing import paint_section, paint_violation
from duhem.portrait.numbers import numbered
from duhem.portrait.plane import usual
from duhem.portrait.plot import cut, stated
from duhem.portrait.violation import drawable, violation
from duhem.proof.verification import Verification
from duhem.show import figure
from duhem.show.document import Drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["panels"]


def panels(found: Verification) -> tuple[Drawing, ...]:
    """The witnesses of what is refuted, at their numbers, and then what :func:`duhem.plot` shows of the law if nobody says what.

    Raises MissingExtraError without matplotlib, InputError where no numbers are found for what is left open.
    """
    figure.check(None)
    return tuple(_drawn(found))


def _drawn(found: Verification) -> Iterator[Drawing]:
    refuted = tuple(violation(found.criterion, result) for result in drawable(found))
    for each in refuted:
        title = f"{each.claim} refuted"
        about = f"The witness that refutes {each.claim}; {' with '.join(stated(each.numbered).splitlines())}"
        yield _panel(partial(paint_violation, seen=each, unit="", title=title), about)
    given = refuted[0].numbered if refuted else numbered(found.criterion)
    for plane in usual(given.law, None):
        seen = cut(given, plane)
        yield _panel(partial(paint_section, found=seen), f"K in {seen.plane.plain}; {' with '.join(stated(given).splitlines())}")


def _panel(paint: Callable[[Axes], None], caption: str) -> Drawing:
    def whole(place: Axes) -> None:
        paint(place)
        figure.snug((place,))
        figure.legend_below((place,))

    return Drawing(figure.as_svg(figure.drawn(whole, size=(4.5, 4.3))), caption)
