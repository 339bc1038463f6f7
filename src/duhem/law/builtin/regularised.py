"""Coulomb friction with its tip smoothed by a hyperbola.

    g = sqrt(|sigma_t|^2 + c^2) - (mu |sigma_n| + c)

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; c > 0 in the unit of the stresses; mu > 0
dimensionless.  K(sigma_n) is the disk of radius sqrt[(mu sigma_n)^2 + 2 c mu |sigma_n|]; unlike Coulomb's cone, g is
differentiable at sigma_t = 0 too.

Verdicts: every claim holds; the dissipation potential is sqrt[(mu sigma_n)^2 + 2 c mu |sigma_n|] |d|.

Source: A. J. Abbo and S. W. Sloan (1995), Comput. Struct. 54, 427-441 (the hyperbolic tip, there for Mohr-Coulomb).
"""

from sympy import Abs, Expr

from duhem.expression import Norm
from duhem.law.formula_law import criterion
from duhem.law.shapes import Disk

DISK = Disk(
    load="sqrt(mu*abs(sigma_n)*(mu*abs(sigma_n) + 2*c))", slope="sqrt(mu*abs(sigma_n)*(mu*abs(sigma_n) + 2*c))/(mu*abs(sigma_n) + c)"
)


@criterion(source="Abbo and Sloan (1995)", closed_form=DISK)
def regularised(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu: Expr, c: Expr) -> Expr:
    """Coulomb friction with its tip smoothed by a hyperbola."""
    return Norm(sigma_a, sigma_b, c) - (mu * Abs(sigma_n) + c)
