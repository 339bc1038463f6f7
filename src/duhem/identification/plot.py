"""Limit points over the identified criterion, outliers marked.  Needs matplotlib (extra ``plot``)."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from duhem.errors import InputError, MissingExtraError
from duhem.expression.numpy_ import evaluate
from duhem.identification.result import Identification
from duhem.show.printing import draw

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["save"]

_GRID = 241


@draw.register(Identification)
def save(done: Identification, file: str | PathLike[str]) -> None:
    """Forces over |sigma_n| and the boundary of K at the median pressure, in the format that the file's ending names.

    Raises MissingExtraError without matplotlib, InputError for a law that has not two forces or has open parameters, and
    for a file that cannot be written.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "plot") from None
    if len(done.law.forces) != 2:
        raise InputError(f"{done.law.name} has {len(done.law.forces)} forces", where="--plot", remedy="only laws of two forces are drawn")
    if done.open:
        raise InputError(
            f"{', '.join(done.open)} is not identified", where="--plot", remedy="fix it with --set NAME=VALUE to draw the criterion"
        )
    figure = Figure(figsize=(5.6, 5.0), layout="constrained")
    FigureCanvasAgg(figure)
    _draw(figure.subplots(), done)
    try:
        figure.savefig(file, dpi=150)
    except (OSError, ValueError) as fault:
        raise InputError(f"the figure cannot be written: {fault}", where=f"{file}", remedy="end the name in .png, .pdf or .svg") from None


def _draw(axes: Axes, done: Identification) -> None:
    law, points = done.law, done.points
    load = np.ones(len(points)) if points.pressure is None else np.abs(points.pressure)
    places = points.forces / load[:, None]
    reach = 1.15 * float(np.abs(places).max())
    x, y = np.meshgrid(*[np.linspace(-reach, reach, _GRID)] * 2)
    table, middle = law.symbols(), float(np.median(load))
    known: dict[Any, Any] = {table[law.forces[0]]: x * middle, table[law.forces[1]]: y * middle}
    known |= {table[name]: value for name, value in done.coefficients.items()}
    if law.pressure:
        known[table[law.pressure]] = -middle
    axes.contour(x, y, evaluate(law.g, known), levels=[0.0], colors="0.2", linewidths=1.2)
    wrong = [o.row - 1 for o in done.outliers]
    sound = np.setdiff1d(np.arange(len(points)), wrong)
    axes.plot(*places[sound].T, "o", markersize=4, label="points")
    if wrong:
        axes.plot(*places[wrong].T, "x", markersize=8, markeredgewidth=2, color="C3", label="outliers")
        for o in done.outliers:
            axes.annotate(f"row {o.row}", places[o.row - 1], xytext=(6, 4), textcoords="offset points", fontsize="small")
    over = f" / |{law.pressure}|" if law.pressure else ""
    axes.axhline(0.0, color="0.8", linewidth=0.6, zorder=0)
    axes.axvline(0.0, color="0.8", linewidth=0.6, zorder=0)
    axes.set(xlabel=law.forces[0] + over, ylabel=law.forces[1] + over, aspect="equal")
    axes.legend(frameon=False, loc="upper right")
