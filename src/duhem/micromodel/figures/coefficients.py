"""Figure 9: the apparent coefficients of the specimen against the local one, beside the measured values."""

from __future__ import annotations

import numpy as np

from duhem.errors import InputError
from duhem.micromodel.experiment import STEEL_ON_ALUMINIUM, Experiment
from duhem.micromodel.figures.recipe import Recipe
from duhem.micromodel.figures.value import Axis, Band, Curve, Fact, Figure, Marks, Note, Panel, Rule
from duhem.micromodel.wedge import coefficients

__all__ = ["RECIPE", "apparent"]

_POINTS = 401


def apparent(
    mu: float = 0.25,
    mu_low: float = float(STEEL_ON_ALUMINIUM.mu_low),
    mu_high: float = float(STEEL_ON_ALUMINIUM.mu_high),
    mu_least: float = 0.15,
    mu_greatest: float = 0.35,
    period: float = float(STEEL_ON_ALUMINIUM.period),
    height: float = float(STEEL_ON_ALUMINIUM.height),
    tan_alpha: float = float(STEEL_ON_ALUMINIUM.tan_alpha),
    measured_plus: float = float(STEEL_ON_ALUMINIUM.measured_plus),
    measured_minus: float = float(STEEL_ON_ALUMINIUM.measured_minus),
) -> Figure:
    """mu_a^+ and mu_a^- over the local coefficient mu_alpha = mu_beta (Antoni et al. 2007, Eqs. 13, 15, Fig. 9).

    ``mu`` at which values are marked, the range mu_low to mu_high that the paper takes as admissible, the ends mu_least and
    mu_greatest of the curves, ``period`` and ``height`` of the wedges in m, the slope of one side, and the measured
    coefficients; but for the lengths all dimensionless.
    """
    if not 0.0 <= mu_least < mu_greatest:
        raise InputError("this range of mu is empty", remedy="give 0 <= mu_least < mu_greatest")
    test = Experiment(period, height, tan_alpha, STEEL_ON_ALUMINIUM.normal_load, measured_plus, measured_minus, mu_low, mu_high)
    local = np.linspace(mu_least, mu_greatest, _POINTS)
    plus, minus = coefficients(np.arctan(tan_alpha), np.arctan(float(test.tan_beta)), local, local)
    marked = test.predicted(mu)
    panel = Panel(
        Axis("mu", r"local coefficient $\mu = \mu_\alpha = \mu_\beta$", "", (mu_least, mu_greatest)),
        Axis("mu_a", r"apparent coefficient $\mu_a^\pm$"),
        (
            Band("admissible", mu_low, mu_high, rf"admissible, ${mu_low:g} \leq \mu \leq {mu_high:g}$"),
            Rule("measured along +t_a", "y", measured_plus, 0, rf"measured along $+t_a$: {measured_plus:g}"),
            Rule("measured along -t_a", "y", measured_minus, 1, rf"measured along $-t_a$: {measured_minus:g}"),
            Curve("mu_a_plus", local, plus, 0, r"$\mu_a^+$, Eq. (13)"),
            Curve("mu_a_minus", local, minus, 1, r"$\mu_a^-$, Eq. (15)"),
            Marks("marked mu_a_plus", np.array([mu]), np.array([float(marked.plus)]), 0),
            Marks("marked mu_a_minus", np.array([mu]), np.array([float(marked.minus)]), 1),
            Note(f"{float(marked.plus):.4f}", mu, float(marked.plus), "above left"),
            Note(f"{float(marked.minus):.4f}", mu, float(marked.minus), "below right"),
        ),
    )
    facts = (
        Fact(f"mu_a_plus at mu = {mu:g}", float(marked.plus)),
        Fact(f"mu_a_minus at mu = {mu:g}", float(marked.minus)),
        Fact(f"mu at which mu_a_plus = {measured_plus:g}", float(test.local_friction(plus=measured_plus))),
        Fact(f"mu at which mu_a_minus = {measured_minus:g}", float(test.local_friction(minus=measured_minus))),
    )
    settings = {"mu": mu, "mu_low": mu_low, "mu_high": mu_high, "mu_least": mu_least, "mu_greatest": mu_greatest}
    settings |= {"period": period, "height": height, "tan_alpha": tan_alpha}
    settings |= {"measured_plus": measured_plus, "measured_minus": measured_minus}
    return Figure(RECIPE.title, "Antoni et al. (2007), Fig. 9, Eqs. (13), (15)", settings, (panel,), facts)


RECIPE = Recipe("9", "Apparent coefficients of friction of the specimen against the local one", apparent)
