"""Asymmetric orthotropic friction: four quarter ellipses, one coefficient per sense of each direction.

    g = sqrt[(sigma_a/mu_a^±)^2 + (sigma_b/mu_b^±)^2] - |sigma_n|,   mu_i^+ where sigma_i >= 0, mu_i^- where sigma_i <= 0

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; the four coefficients are
positive and dimensionless.  The brackets are written with pos(x) = max(x, 0) and neg(x) = max(-x, 0).

Verdicts: every claim holds for all positive coefficients: K is convex and its boundary C1 (not C2 across the axes
unless the coefficients match); the dissipation potential is |sigma_n| sqrt[(mu_a^± d_a)^2 + (mu_b^± d_b)^2].

Source: N. Antoni, J.-L. Ligier, P. Saffré, J. Pastor (2007), Int. J. Eng. Sci. 45, 587-600, Eq. (35).
"""

from sympy import Abs, Expr

from duhem.expression import Neg, Norm, Pos
from duhem.law.formula_law import criterion
from duhem.law.shapes import Quadrants

QUARTERS = Quadrants("mu_a_plus", "mu_a_minus", "mu_b_plus", "mu_b_minus")


@criterion(source="Antoni, Ligier, Saffré and Pastor (2007), Eq. (35)", closed_form=QUARTERS)
def antoni2007(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu_a_plus: Expr, mu_a_minus: Expr, mu_b_plus: Expr, mu_b_minus: Expr) -> Expr:
    """Asymmetric orthotropic friction: four quarter ellipses."""
    along_a = Pos(sigma_a) / mu_a_plus + Neg(sigma_a) / mu_a_minus
    along_b = Pos(sigma_b) / mu_b_plus + Neg(sigma_b) / mu_b_minus
    return Norm(along_a, along_b) - Abs(sigma_n)
