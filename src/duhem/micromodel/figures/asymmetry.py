"""Figure 4: how the asymmetry of friction depends on the shape of a wedge of given height and period."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from duhem.errors import InputError
from duhem.micromodel.figures.recipe import Recipe
from duhem.micromodel.figures.value import Array, Axis, Curve, Fact, Figure, Layer, Marks, Panel, Rule
from duhem.micromodel.wedge import coefficients

__all__ = ["RECIPE", "asymmetry"]

_POINTS = 1201
_WITHIN = 1e-9  # how close to the ends of the sliding range, as a part of it, the curves are sampled


def asymmetry(height_over_period: float = 0.2, mu_high: float = 0.3, mu_low: float = 0.2) -> Figure:
    """mu_a^+ - mu_a^- over alpha, where 1/tan alpha + 1/tan beta = L/h (Antoni et al. 2007, Eqs. 4, 16, 17, Fig. 4).

    Three cases of (mu_alpha, mu_beta): (high, high), (high, low), (low, high).  Each curve ends where a side can no longer
    be climbed, mu_alpha tan alpha = 1 or mu_beta tan beta = 1; there the asymmetry is unbounded.  Angles in degrees.
    """
    if not (height_over_period > 0.0 < mu_low < mu_high):
        raise InputError("this is no figure of three cases", remedy="give height_over_period > 0 and 0 < mu_low < mu_high")
    period = 1.0 / height_over_period
    layers: list[Layer] = []
    facts: list[Fact] = [Fact("alpha where alpha = beta", float(np.degrees(np.arctan(2.0 * height_over_period))), "deg")]
    for hue, (mu_alpha, mu_beta) in enumerate([(mu_high, mu_high), (mu_high, mu_low), (mu_low, mu_high)]):
        case = f"{mu_alpha:g}, {mu_beta:g}"
        if period <= mu_alpha + mu_beta:
            raise InputError(
                f"no wedge of this height and period can be climbed on both sides with {case}",
                remedy=f"keep height_over_period below 1/(mu_alpha + mu_beta) = {1.0 / (mu_alpha + mu_beta):g}",
            )
        # cot alpha lies between mu_alpha (Eq. 4) and L/h - mu_beta (Eq. 16).
        low, high = np.arctan(1.0 / (period - mu_beta)), np.arctan(1.0 / mu_alpha)
        alpha = low + (high - low) * (0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, _POINTS)))
        alpha = np.clip(alpha, low + _WITHIN * (high - low), high - _WITHIN * (high - low))
        difference = _difference(alpha, period, mu_alpha, mu_beta)
        zero = _zero(alpha, period, mu_alpha, mu_beta)
        said = "".join(f": zero at {angle:.1f}°" for angle in np.degrees(zero))
        layers += [
            Curve(case, np.degrees(alpha), difference, hue, rf"$\mu_\alpha = {mu_alpha:g},\ \mu_\beta = {mu_beta:g}$" + said),
            Marks(f"zero ({case})", np.degrees(zero), 0.0 * zero, hue),
        ]
        ends = {"least alpha": low, "greatest alpha": high}
        facts += [Fact(f"{name} ({case})", float(np.degrees(end)), "deg") for name, end in ends.items()]
        facts += [Fact(f"zero ({case})", float(angle), "deg") for angle in np.degrees(zero)]
    panel = Panel(
        Axis("alpha", r"slope angle $\alpha$", "deg"),
        Axis("mu_plus - mu_minus", r"asymmetry $\mu_a^+ - \mu_a^-$", "", (-0.3, 0.3)),
        (Rule("no asymmetry", "y", 0.0), Rule("alpha = beta", "x", facts[0].value, None, r"$\alpha = \beta$"), *layers),
        legend="lower right",
    )
    settings = {"height_over_period": height_over_period, "mu_high": mu_high, "mu_low": mu_low}
    return Figure(RECIPE.title, "Antoni et al. (2007), Fig. 4, Eq. (17)", settings, (panel,), tuple(facts))


def _difference(alpha: Array, period: float, mu_alpha: float, mu_beta: float) -> Array:
    beta = np.arctan2(np.tan(alpha), period * np.tan(alpha) - 1.0)
    plus, minus = coefficients(alpha, beta, mu_alpha, mu_beta)
    return np.asarray(plus - minus)


def _zero(alpha: Array, period: float, mu_alpha: float, mu_beta: float) -> Array:
    """Every angle at which the sampled curve changes sign, to rounding."""
    from scipy.optimize import brentq

    def at(angle: float) -> float:
        return float(_difference(np.array(angle), period, mu_alpha, mu_beta))

    signs = np.sign(_difference(alpha, period, mu_alpha, mu_beta))
    brackets = ((float(p), float(q)) for (p, q), (s, t) in zip(pairwise(alpha), pairwise(signs), strict=True) if s * t < 0.0)
    return np.array([brentq(at, *bracket, xtol=1e-15) for bracket in brackets])


RECIPE = Recipe("4", "Asymmetry of friction against the slope of a wedge of given height and period", asymmetry)
