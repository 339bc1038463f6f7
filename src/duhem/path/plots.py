"""Figures of a history: stress path over the criterion, hysteresis loops, energies.  Needs matplotlib (extra ``plot``)."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from duhem.errors import InputError, MissingExtraError
from duhem.expression.numpy_ import evaluate
from duhem.path.history import History

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from duhem.law.formula_law import Criterion

__all__ = ["energies", "hysteresis", "save", "stress_path"]

_GRID = 241


def save(history: History, file: str | os.PathLike[str], *, law: Criterion | None = None, **parameters: float) -> None:
    """The three figures side by side, in the format that the file's ending names.

    ``law`` and its ``parameters`` add the criterion to the stress path of two forces, at the least and greatest pressure.
    Raises MissingExtraError without matplotlib, InputError for a file or format that cannot be written.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "plot") from None
    figure = Figure(figsize=(13.0, 4.2), layout="constrained")
    FigureCanvasAgg(figure)
    left, middle, right = figure.subplots(1, 3)
    if len(history.forces) >= 2:
        stress_path(left, history, law, **parameters)
    else:
        left.plot(history.time, history.stress[:, 0])
        left.set(xlabel="time", ylabel=history.forces[0])
    hysteresis(middle, history)
    energies(right, history)
    try:
        figure.savefig(file, dpi=150, metadata={} if str(file).endswith(".png") else None)
    except (OSError, ValueError) as fault:
        raise InputError(f"the figure cannot be written: {fault}", where=f"{file}", remedy="end the name in .png, .pdf or .svg") from None


def stress_path(axes: Axes, history: History, law: Criterion | None = None, **parameters: float) -> None:
    """The first two forces, over the boundary of K at the extreme pressures where ``law`` is given and has two forces."""
    a, b = history.stress[:, 0], history.stress[:, 1]
    axes.plot(a, b, linewidth=1.2)
    axes.plot(a[0], b[0], "o", markersize=4)
    if law is not None and len(law.forces) == 2:
        table = law.symbols()
        extremes = sorted({float(history.pressure.min()), float(history.pressure.max())})
        reach = 1.3 * float(np.abs(history.stress).max()) or 1.0
        grid = np.linspace(-reach, reach, _GRID)
        x, y = np.meshgrid(grid, grid)
        for pressure in extremes:
            known: dict[Any, Any] = {table[f]: v for f, v in zip(law.forces, (x, y), strict=True)}
            known |= {table[name]: value for name, value in parameters.items()}
            if law.pressure:
                known[table[law.pressure]] = pressure
            axes.contour(x, y, evaluate(law.g, known), levels=[0.0], colors="0.4", linewidths=0.8)
    axes.set(xlabel=history.forces[0], ylabel=history.forces[1], aspect="equal")


def hysteresis(axes: Axes, history: History) -> None:
    """Each force over its own displacement."""
    for i, force in enumerate(history.forces):
        axes.plot(history.displacement[:, i], history.stress[:, i], label=force)
    axes.set(xlabel="displacement", ylabel="stress")
    axes.legend(frameon=False)


def energies(axes: Axes, history: History) -> None:
    """Work, free energy and dissipation over time."""
    for name in ("work", "psi", "dissipation"):
        axes.plot(history.time, getattr(history, name), label=name)
    axes.set(xlabel="time", ylabel="energy")
    axes.legend(frameon=False)
