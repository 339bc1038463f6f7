"""Figure 1: the law along a line over one cycle of displacement, integrated, not traced."""

from __future__ import annotations

import numpy as np

from duhem.errors import InputError
from duhem.micromodel.figures.recipe import Recipe
from duhem.micromodel.figures.value import Arrows, Axis, Curve, Fact, Figure, Note, Panel, Rule

__all__ = ["RECIPE", "law_1d"]

_SUBSTEPS = 240  # with the defaults the corners of the loop fall on steps


def law_1d(
    mu_plus: float = 0.2, mu_minus: float = 0.08, stiffness: float = 1e11, pressure: float = -1e6, amplitude: float = 6e-6
) -> Figure:
    """sigma_t over u_t from rest to +amplitude, back to -amplitude and to +amplitude again (Antoni et al. 2007, Eq. 1, Fig. 1).

    ``stiffness`` k_t in Pa/m, ``pressure`` sigma_n <= 0 in Pa, ``amplitude`` in m; the figure is in micrometres and MPa.
    The dissipation of the closed cycle is the integral of sigma_t du_in as the integrator sums it, and the area of the loop.
    """
    from duhem.law.catalogue import load
    from duhem.path import Path, simulate

    if not (pressure < 0.0 < amplitude):
        raise InputError("without pressure or displacement there is no loop", remedy="give pressure < 0 < amplitude")
    path = Path.cycle(amplitude, pressure=pressure)
    fixed = {"mu_plus": mu_plus, "mu_minus": mu_minus}
    history = simulate(load("antoni2007-1d"), path, stiffness=stiffness, parameters=fixed, method="exact", substeps=_SUBSTEPS)
    u, sigma = 1e6 * history.displacement[:, 0], 1e-6 * history.stress[:, 0]
    rest, loop = slice(0, _SUBSTEPS + 1), slice(_SUBSTEPS, None)
    back, forth = 3 * _SUBSTEPS // 2, 5 * _SUBSTEPS // 2
    # Halfway along the elastic rise, to say what its slope is.
    half = int(np.argmax(sigma[rest] >= 0.5 * sigma[rest].max()))
    at = np.array([back + _SUBSTEPS // 4, forth + _SUBSTEPS // 4])
    limit = 1e-6 * abs(pressure)
    panel = Panel(
        Axis("u_t", r"tangential displacement $u_t$", "µm"),
        Axis("sigma_t", r"tangential stress $\sigma_t$", "MPa", (-1.5 * mu_minus * limit, 1.2 * mu_plus * limit)),
        (
            Rule("upper limit", "y", mu_plus * limit, 1, r"$\mu^+|\sigma_n|$"),
            Rule("lower limit", "y", -mu_minus * limit, 2, r"$-\mu^-|\sigma_n|$"),
            Rule("zero", "y", 0.0),
            Curve("first loading", u[rest], sigma[rest], None, "first loading"),
            Curve("closed cycle", u[loop], sigma[loop], 0, "closed cycle"),
            Arrows("sense", np.stack([u[at], sigma[at]], axis=1), np.array([[-1.0, 0.0], [1.0, 0.0]]), 0.16e6 * amplitude, 0),
            Note(r"slope $k_t$", float(u[half]), float(sigma[half]), "left"),
        ),
    )
    facts = (
        Fact("dissipation per cycle", float(history.dissipation[-1] - history.dissipation[_SUBSTEPS]), "J/m²"),
        Fact("greatest stress", float(sigma.max()), "MPa"),
        Fact("least stress", float(sigma.min()), "MPa"),
    )
    settings = {**fixed, "stiffness": stiffness, "pressure": pressure, "amplitude": amplitude}
    return Figure(RECIPE.title, "Antoni et al. (2007), Fig. 1, Eq. (1)", settings, (panel,), facts)


RECIPE = Recipe("1", "Asymmetric friction along a line: one cycle of displacement", law_1d)
