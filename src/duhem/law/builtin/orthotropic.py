"""Orthotropic friction: an ellipse on the principal slip directions.

    g = sqrt[(sigma_a/mu_a)^2 + (sigma_b/mu_b)^2] - |sigma_n|

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; mu_a, mu_b > 0 dimensionless.

Verdicts: every claim holds; the dissipation potential is |sigma_n| sqrt[(mu_a d_a)^2 + (mu_b d_b)^2].

Source: R. Michałowski and Z. Mróz (1978), Arch. Mech. 30, 259-276; A. Curnier (1984), Int. J. Solids Struct. 20,
637-647; Antoni et al. (2007), Eq. (35) with mu_i^+ = mu_i^-.
"""

from sympy import Abs, Expr

from duhem.expression import Norm
from duhem.law.formula_law import criterion
from duhem.law.shapes import Quadrants


@criterion(source="Michałowski and Mróz (1978)", closed_form=Quadrants("mu_a", "mu_a", "mu_b", "mu_b"))
def orthotropic(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu_a: Expr, mu_b: Expr) -> Expr:
    """Orthotropic friction: an ellipse."""
    return Norm(sigma_a / mu_a, sigma_b / mu_b) - Abs(sigma_n)
