"""A mended law as a sheet, and as a picture of both boundaries (extra ``plot``)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from duhem.errors import InputError
from duhem.expression.text import formula
from duhem.regions.mending.entry import Mended, Tried
from duhem.regions.mending.limit_load import around, limit_loads, plain_values
from duhem.show import figure
from duhem.show.printing import Sheet, draw, latex_name, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["as_sheet", "plot"]

_HEAD = ("by", "mean change", "largest", "K", "")


@sheet.register(Mended)
def as_sheet(done: Mended) -> Sheet:
    """What was done, the formula, what is proved of it, and a row for each way that was tried."""
    title = f"{done.criterion.name}: {f'mended by {done.by}' if done.by else done.told}"
    return Sheet(title, tuple(_fields(done)), _HEAD, tuple(map(_row, done.tried)) if len(done.tried) > 1 else ())


def _fields(done: Mended) -> Iterator[tuple[str, str]]:
    if done.by:
        mean, largest = done.distance
        yield "before", f"convexity {done.before.value}"
        yield "result", done.told
        sizes = f"{mean:.3g} in the mean, {largest:.3g} at the largest, of the mean limit load over directions of force"
        yield "change", sizes if np.isfinite(largest) else "infinite: one K ends in a direction where the other does not"
    if done.by not in ("", "parameters"):
        yield "g", formula(done.law.g)
    yield "proved", ", ".join(f"{r.claim} {r.verdict.value}" for r in done.verification.results)
    yield "admissible", "yes" if done.admissible else "not proved"


def _row(one: Tried) -> tuple[str, ...]:
    if one.law is None:
        return one.by, "-", "-", "-", one.told
    return one.by, f"{one.distance.mean:.4f}", f"{one.distance.largest:.4f}", "convex" if one.convex else "not proved convex", one.told


@draw.register(Mended)
def plot(done: Mended, file: Any = None, axes: Any = None) -> tuple[Axes, ...]:
    """K of both laws in the plane of the first two forces, free parameters at plain values and the pressure at -1."""
    forces, angles = done.criterion.forces, np.linspace(0.0, 2.0 * np.pi, 1441)
    if len(forces) < 2:
        raise InputError(f"{done.criterion.name} has one force", where="--plot", remedy="only laws of more forces are drawn")
    ways, values = np.zeros((len(angles), len(forces))), plain_values(done.criterion)
    ways[:, :2] = around(angles)

    def paint(place: Axes) -> None:
        looks = ((done.law, "-", f"mended by {done.by}"), (done.criterion, (0, (5, 1.5)), done.criterion.name))
        for i, (law, dashes, label) in enumerate(looks if done.by else looks[1:]):
            line = ways[:, :2] * limit_loads(law, values, ways)[:, None]
            place.plot(*line.T, color=figure.palette(i), linestyle=dashes, linewidth=1.8, label=label)
        place.set_aspect("equal", adjustable="datalim")
        for axis, force in zip((place.xaxis, place.yaxis), forces, strict=False):
            figure.measure(axis, f"${latex_name(force)}$", "unit of stress")
        figure.legend(place)

    return figure.drawn(paint, file, axes, size=(5.6, 5.2), title=f"{done.criterion.name}: {done.told}")
