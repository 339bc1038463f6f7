"""Limit points over the identified criterion, outliers marked (extra ``plot``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from duhem.errors import InputError
from duhem.identification.result import Identification
from duhem.law.formula_law import Criterion
from duhem.law.outline import outline, ray_ends
from duhem.show import figure
from duhem.show.notation import latex_name, latex_number
from duhem.show.printing import draw

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["check", "plot"]

_ALIKE = 1e-9


def check(law: Criterion) -> None:
    """InputError for a law that is not drawn."""
    if len(law.forces) != 2:
        raise InputError(f"{law.name} has {len(law.forces)} forces", where="--plot", remedy="only laws of two forces are drawn")


@draw.register(Identification)
def plot(done: Identification, file: figure.Target | None = None, *, ax: Axes | None = None) -> Axes:
    """Points and the boundary of K at the median pressure, on ``ax`` or a sheet of its own; the axes.

    Where K grows in proportion to the pressure, forces are those over |sigma_n|.  Otherwise, as with adhesion, each point is
    as many times as far out on its ray as the boundary at the median pressure is, compared with that at its own pressure.

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
    middle, factor = float(np.median(load)), np.ones_like(load)
    there, pressure = "", law.pressure or ""
    if pressure:
        there = rf" at ${latex_name(pressure)} = {latex_number(-middle)}$"
        end, own = (ray_ends(law, done.coefficients, at, points.forces) for at in (np.full_like(load, -middle), -load))
        factor = np.divide(end, own, out=factor, where=own > 0.0)
    ratios = bool(pressure) and np.allclose(factor, middle / load, rtol=_ALIKE, atol=0.0)
    places, unit = (points.forces / load[:, None], middle) if ratios else (points.forces * factor[:, None], 1.0)
    for i, line in enumerate(outline(law, done.coefficients, -middle, float(np.abs(places).max()) * unit or 1.0)):
        axes.plot(*(line / unit).T, color="black", label="_" if i else f"boundary of $K${there}", zorder=1)
    wrong = [o.row - 1 for o in done.outliers]
    sound = np.setdiff1d(np.arange(len(points)), wrong)
    moved = "" if ratios or not np.ptp(load) else f", moved along rays to those{there}"
    axes.plot(*places[sound].T, "o", color=figure.palette(0), label=f"limit points{moved}", zorder=2)
    if wrong:
        axes.plot(*places[wrong].T, "X", markersize=9, color=figure.palette(1), label="outliers: their rows beside them", zorder=3)
    for o in done.outliers:
        figure.note(axes, f"{o.row}", places[o.row - 1])
    axes.axhline(0.0, color="0.8", linewidth=0.6, zorder=0)
    axes.axvline(0.0, color="0.8", linewidth=0.6, zorder=0)
    axes.set_aspect("equal", adjustable="datalim")
    for axis, force in zip((axes.xaxis, axes.yaxis), law.forces, strict=True):
        if ratios:
            figure.measure(axis, rf"${latex_name(force)}\,/\,|{latex_name(pressure)}|$")
        else:
            figure.measure(axis, f"${latex_name(force)}$", "unit of the points")
    figure.legend(axes)
