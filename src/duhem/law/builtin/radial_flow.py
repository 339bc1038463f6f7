"""Orthotropic friction that slips along the stress: the simplest non-associated rule.

    g = sqrt[(sigma_a/mu_a)^2 + (sigma_b/mu_b)^2] - |sigma_n|,   slip direction (sigma_a, sigma_b)

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; mu_a, mu_b > 0 dimensionless.

Verdicts: K is convex and smooth, and the law dissipates (force . flow = |sigma_t|^2), but normality is refuted unless
mu_a = mu_b.

Source: R. Michałowski and Z. Mróz (1978), Arch. Mech. 30, 259-276 (associated and non-associated sliding rules).
"""

from sympy import Abs, Expr

from duhem.expression import Norm
from duhem.law.formula_law import criterion


@criterion(flow=["sigma_a", "sigma_b"], source="Michałowski and Mróz (1978)")
def radial_flow(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu_a: Expr, mu_b: Expr) -> Expr:
    """Orthotropic friction that slips along the stress (non-associated)."""
    return Norm(sigma_a / mu_a, sigma_b / mu_b) - Abs(sigma_n)
