"""Limit points over the identified criterion, outliers marked (extra ``plot``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from duhem.errors import InputError
from duhem.identification.result import Identification
from duhem.law.formula_law import Criterion
from duhem.law.outline import outline
from duhem.show import figure
from duhem.show.notation import latex_name, latex_number
from duhem.show.printing import draw

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["check", "plot"]


def check(law: Criterion) -> None:
    """InputError for a law that is not drawn."""
    if len(law.forces) != 2:
        raise InputError(f"{law.name} has {len(law.forces)} forces", where="--plot", remedy="only laws of two forces are drawn")


@draw.register(Identification)
def plot(done: Identification, file: figure.Target | None = None, *, ax: Axes | None = None) -> Axes:
    """Forces over |sigma_n| and the boundary of K at the median pressure, on ``ax`` or a sheet of its own; the axes.

    Raises MissingExtraError without matplotlib, InputError for a law that has not two forces or has open parameters, and
    for a file that cannot be written.
    """
    check(done.law)
    if done.open:
        raise InputError(
            f"{', '.join(done.open)} is not identified", where="--plot", remedy="fix it with --set NAME=VALUE to draw the criterion"
        )
    title = f"{done.family.name} on {len(done.points)} points"
    return figure.drawn(lambda axes: _paint(axes, done), file, None if ax is None else [ax], size=(5.6, 5.2), title=title)[0]


def _paint(axes: Axes, done: Identification) -> None:
    law, points = done.law, done.points
    load = np.ones(len(points)) if points.pressure is None else np.abs(points.pressure)
    places = points.forces / load[:, None]
    middle, reach = float(np.median(load)), float(np.abs(places).max())
    for i, line in enumerate(outline(law, done.coefficients, -middle, reach * middle or 1.0)):
        axes.plot(*(line / middle).T, color="black", label="_" if i else _said(done, middle), zorder=1)
    wrong = [o.row - 1 for o in done.outliers]
    sound = np.setdiff1d(np.arange(len(points)), wrong)
    axes.plot(*places[sound].T, "o", color=figure.palette(0), label="limit points", zorder=2)
    if wrong:
        axes.plot(*places[wrong].T, "X", markersize=9, color=figure.palette(1), label="outliers: their rows beside them", zorder=3)
    for o in done.outliers:
        figure.note(axes, f"{o.row}", places[o.row - 1])
    axes.axhline(0.0, color="0.8", linewidth=0.6, zorder=0)
    axes.axvline(0.0, color="0.8", linewidth=0.6, zorder=0)
    axes.set_aspect("equal", adjustable="datalim")
    for axis, force in zip((axes.xaxis, axes.yaxis), law.forces, strict=True):
        if law.pressure:
            figure.measure(axis, rf"${latex_name(force)}\,/\,|{latex_name(law.pressure)}|$")
        else:
            figure.measure(axis, f"${latex_name(force)}$", "unit of the points")
    figure.legend(axes)


def _said(done: Identification, middle: float) -> str:
    """What the line is; K need not grow in proportion to the pressure."""
    name = done.law.pressure
    return "boundary of $K$" + (rf" at ${latex_name(name)} = {latex_number(-middle)}$" if name else "")
