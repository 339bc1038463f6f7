"""Oblique sliding over a profile of wedges: the wedge micro-model carried to every slip direction.

    boundary T = [tan_beta R(tan_alpha, mu_alpha) + tan_alpha R(-tan_beta, mu_beta)]/(tan_alpha + tan_beta) times |sigma_n|,
    R(t, mu) = (t + w mu cos phi, w mu sin phi)/(1 - w mu t cos phi),   w = sqrt[(1 + t^2)/(1 + t^2 cos^2 phi)],

slip direction (cos phi, sin phi).  R is the traction of one side of slope t along t_a, on which the tip of a spring moves with
v = (cos phi, sin phi, t cos phi) and is pushed by a force along n/|n| - mu v/|v|, n = (-t, 0, 1); sides weigh by their lengths.
Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; slopes and local friction
coefficients positive and dimensionless, mu_alpha tan_alpha < 1 and mu_beta tan_beta < 1 (Eqs. 4, 16: springs slide up each side).

Verdicts: the law dissipates in every direction, but the slip is not normal to the boundary, and near the limits of sliding
the curve is dented.  At given values the boundary is shown to be smooth; that it is star-shaped about zero, hence simple, for
all values is proved by duhem.micromodel.derivation.  On t_a it reduces to the coefficients of Eqs. (13), (15).

Source: N. Antoni, J.-L. Ligier, P. Saffré and J. Pastor (2007), Int. J. Eng. Sci. 45, 587-600, section 2 (announced there).
"""

from sympy import Expr, cos, sin, sqrt

from duhem.expression import symbol
from duhem.law.curve_law import ParametricCriterion
from duhem.law.domain import POSITIVE

NAMES = "tan_alpha", "tan_beta", "mu_alpha", "mu_beta"
phi, (a, b, mu_a, mu_b) = symbol("phi"), map(POSITIVE.symbol, NAMES)


def _side(t: Expr, mu: Expr) -> tuple[Expr, Expr]:
    friction = mu * sqrt((1 + t**2) / (1 + t**2 * cos(phi) ** 2))
    return (t + friction * cos(phi)) / (1 - friction * t * cos(phi)), friction * sin(phi) / (1 - friction * t * cos(phi))


wedge = ParametricCriterion(
    "wedge", tuple((b * x + a * y) / (a + b) for x, y in zip(_side(a, mu_a), _side(-b, mu_b), strict=True)), dict.fromkeys(NAMES, POSITIVE),
    constraints=("mu_alpha*tan_alpha < 1", "mu_beta*tan_beta < 1"), flow=("cos(phi)", "sin(phi)"), instead="antoni2007",
    summary="Oblique sliding over a profile of wedges: a boundary curve with a slip of its own (non-associated).",
    source="Antoni et al. (2007), section 2, Eqs. (4), (6), (13), (15), (16)", derivation="duhem.micromodel.derivation:derive",
)  # fmt: skip
