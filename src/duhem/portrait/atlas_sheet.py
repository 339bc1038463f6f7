"""The atlas as one sheet: a small picture of each law, filled by the verdict on its convexity."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from duhem.errors import InputError
from duhem.law.atlas.entry import AtlasEntry
from duhem.law.catalogue import load_named
from duhem.portrait.drawing import fill
from duhem.portrait.numbers import numbered
from duhem.portrait.plane import usual
from duhem.portrait.plot import cut
from duhem.portrait.section import View
from duhem.show import figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["atlas_sheet"]

_COLUMNS = 8
_TITLE = "The atlas: a section of each law at plain numbers, verdicts over the whole domain of its file"
_LOOKS: dict[str, dict[str, Any]] = {
    "proved": {"facecolor": figure.palette(0), "alpha": 0.3, "label": "$K$ convex: proved"},
    "refuted": {"facecolor": figure.palette(1), "alpha": 0.45, "lines": "xxx", "label": "$K$ convex: refuted"},
    "open": {"facecolor": "0.75", "alpha": 0.6, "lines": "...", "label": "$K$ convex: open"},
}
_TOLD = ("origin", "normality", "dissipation")


def atlas_sheet(
    laws: Sequence[AtlasEntry], file: figure.Target | None = None, on_law: Callable[[str], object] = lambda name: None
) -> tuple[Axes, ...]:
    """One section of each law at plain numbers, filled by whether K is convex; below its name the other claims that do not hold.

    ``on_law`` is called with the name of each law before it is drawn.  Raises what :func:`duhem.portrait.plot` raises.
    """
    figure.check(file)
    views = []
    for law in laws:
        on_law(law.name)
        at = numbered(load_named(law.name))
        views.append(_first(law, [partial(cut, at, plane) for plane in usual(at.law, None)]))

    def paint(*places: Axes) -> None:
        for place, law, view in zip(places, laws, views, strict=True):
            _small(place, law, view)
        figure.legend_below(places)

    columns = min(_COLUMNS, len(laws))
    return figure.drawn(paint, file, panels=len(laws), columns=columns, size=(2.0, 2.15), title=_TITLE)


def _first(law: AtlasEntry, cuts: Sequence[Callable[[], View]]) -> View:
    for each in cuts[:-1]:
        try:
            return each()
        except InputError:  # this plane holds no point of K; another does
            continue
    return cuts[-1]()


def _small(axes: Axes, law: AtlasEntry, view: View) -> None:
    a, b, c, d = view.window
    convex = law.verdicts["convexity"]
    look = _LOOKS[convex if convex in _LOOKS else "open"]
    fill(axes, view, **look)
    for line in view.lines:
        axes.plot(*line.points.T, color="black", linewidth=0.9, zorder=3)
    axes.set(xlim=(a, b), ylim=(c, d), xticks=[], yticks=[])
    axes.set_aspect("equal" if 0.125 < (b - a) / (d - c) < 8.0 else "auto", adjustable="box")
    axes.set_xlabel(view.plane.x_symbol, fontsize=8.6, labelpad=2)
    axes.set_ylabel(view.plane.y_symbol, fontsize=8.6, labelpad=2)
    others = [f"{claim} {_word(law.verdicts[claim])}" for claim in _TOLD if law.verdicts[claim] not in ("proved", "not_applicable")]
    axes.set_title("\n".join([figure.shortened(law.name, 24), *others]), fontsize=7.5)


def _word(verdict: str) -> str:
    return verdict if verdict == "refuted" else "open"
