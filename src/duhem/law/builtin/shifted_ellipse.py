"""Asymmetric friction by translation: an ellipse whose centre is off the origin.

    g = sqrt{[(sigma_a - shift |sigma_n|)/mu_a]^2 + (sigma_b/mu_b)^2} - |sigma_n|,   |shift| < mu_a

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; mu_a, mu_b > 0 and the real
shift are dimensionless.  The coefficients along +a and -a are mu_a + shift and mu_a - shift.

Verdicts: every claim holds while |shift| < mu_a, which is what keeps the origin inside K and the dissipation
non-negative; the dissipation potential is |sigma_n| {shift d_a + sqrt[(mu_a d_a)^2 + (mu_b d_b)^2]}.

Source: R. T. Rockafellar (1970), Convex Analysis, section 13 (support function of a translated set).
"""

from sympy import Abs, Expr

from duhem.expression import Norm
from duhem.law.domain import REAL
from duhem.law.formula_law import criterion
from duhem.law.shapes import Quadrants

OFF_CENTRE = Quadrants("mu_a", "mu_a", "mu_b", "mu_b", centre_a="shift*abs(sigma_n)")
INSIDE = ["shift < mu_a", "-mu_a < shift"]  # the origin


@criterion(parameters={"shift": REAL}, constraints=INSIDE, source="Rockafellar (1970)", closed_form=OFF_CENTRE)
def shifted_ellipse(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu_a: Expr, mu_b: Expr, shift: Expr) -> Expr:
    """Asymmetric friction by translation: an ellipse off centre."""
    return Norm((sigma_a - shift * Abs(sigma_n)) / mu_a, sigma_b / mu_b) - Abs(sigma_n)
