"""Where the print of the paper contradicts itself, each with numbers computed from what it says elsewhere.

Source: Antoni et al. (2007), Eqs. (7)-(10), (35), section 3.2.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from duhem.law.catalogue import load_formula
from duhem.micromodel.experiment.friction_test import STEEL_ON_ALUMINIUM, Experiment
from duhem.micromodel.facets import F_0, HEIGHT, K_N, SLOPE, U, averages, height

__all__ = ["Erratum", "errata"]


@dataclass(frozen=True)
class Erratum:
    """``printed``: what stands at ``place``; ``follows``: what its own premises give; ``numbers``: ours, each computed here."""

    place: str
    printed: str
    follows: str
    numbers: Mapping[str, Any]


def errata(experiment: Experiment = STEEL_ON_ALUMINIUM) -> tuple[Erratum, ...]:
    """The four, in the order of the paper."""
    return _spring_force(), _differentiability(), _misprinted_load(experiment), _rounded_prediction(experiment)


def _spring_force() -> Erratum:
    top = HEIGHT / SLOPE["alpha"]
    period = HEIGHT * (1 / SLOPE["alpha"] + 1 / SLOPE["beta"])
    rise = sp.integrate(height("alpha"), (U, 0, top)) + sp.integrate(height("beta"), (U, top, period))
    as_printed = sp.expand(sp.cancel(-(F_0 + K_N * sp.cancel(rise / period))))
    derived = sp.expand(averages(+1).normal)
    return Erratum(
        "Eq. (9)",
        "F_n = -(F_0 + k_n u_n), with F_0 = -k_n (delta - h) <= 0",
        "its mean over a period is not Eq. (10), F_0 - k_n h/2, which follows from F_n = F_0 - k_n u_n; Eqs. (13), (15) stand",
        {
            "mean of Eq. (9) as printed": as_printed,
            "mean of F_0 - k_n u_n": derived,
            "printed less Eq. (10)": sp.expand(as_printed - derived),
        },
    )


def _differentiability() -> Erratum:
    law = load_formula("antoni2007").fix({"mu_a_plus": "0.2", "mu_a_minus": "0.08", "mu_b_plus": "0.12", "mu_b_minus": "0.15"})
    names = law.symbols()

    def rate(sense: int) -> sp.Rational:
        """g along sense * t_a from the origin at sigma_n = 0, where it is homogeneous: the one-sided derivative."""
        values = {names["sigma_a"]: sp.Integer(sense), names["sigma_b"]: sp.S.Zero, names["sigma_n"]: sp.S.Zero}
        at = law.g.xreplace(values | {names[n]: d.value for n, d in law.parameters.items()})
        return sp.nsimplify(at.doit())

    return Erratum(
        "section 2.6, before Eq. (35)",
        "the criterion (35) is differentiable",
        "it is, except at sigma_t = 0: there the one-sided derivatives along t_a and -t_a do not add up to zero (Fig. 5 coefficients)",
        {"derivative along +t_a": rate(+1), "derivative along -t_a": rate(-1), "their sum": rate(+1) + rate(-1)},
    )


def _misprinted_load(experiment: Experiment) -> Erratum:
    printed = sp.Integer(229)
    other = printed / experiment.normal_load
    mu = experiment.local_friction(minus=other)
    return Erratum(
        "section 3.2, Fig. 8",
        "tangential loads of 330 N and 229 N, coefficients of 0.33 and 0.29",
        "0.29 is the coefficient of 290 N; 229 N would also contradict the model, whose other coefficient would be too small",
        {
            "229 N over the normal load": other,
            "load of 0.29 (N)": experiment.measured_minus * experiment.normal_load,
            "mu_a_plus where mu_a_minus is that": experiment.predicted(mu.low).plus.n(15),
        },
    )


def _rounded_prediction(experiment: Experiment) -> Erratum:
    quarter, less = experiment.predicted("0.25"), experiment.predicted("0.24")
    return Erratum(
        "section 3.2, Fig. 9",
        "near a local coefficient of 0.25 the calculated coefficients are 0.32 and 0.29",
        "Eqs. (13), (15) give 0.32 and 0.29 at two different local coefficients, both nearer 0.24",
        {
            "mu_a_plus at 0.25": quarter.plus,
            "mu_a_minus at 0.25": quarter.minus,
            "mu_a_plus at 0.24": less.plus.n(6),
            "mu_a_minus at 0.24": less.minus.n(6),
            "mu where mu_a_plus = 0.32": experiment.local_friction(plus="0.32"),
            "mu where mu_a_minus = 0.29": experiment.local_friction(minus="0.29"),
        },
    )
