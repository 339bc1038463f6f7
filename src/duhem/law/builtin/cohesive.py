"""Coulomb friction with cohesion.

    g = |sigma_t| - (cohesion + mu |sigma_n|)

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; cohesion > 0 in the unit of the stresses;
mu > 0 dimensionless.

Verdicts: every claim holds; the dissipation potential is (cohesion + mu |sigma_n|) |d|.

Source: C. A. Coulomb (1776), Mém. Acad. R. Sci. 7, 343-382.
"""

from sympy import Abs, Expr

from duhem.expression import Norm
from duhem.law.formula_law import criterion
from duhem.law.shapes import Disk


@criterion(source="Coulomb (1776)", closed_form=Disk(load="cohesion + mu*abs(sigma_n)"))
def cohesive(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu: Expr, cohesion: Expr) -> Expr:
    """Coulomb friction with cohesion."""
    return Norm(sigma_a, sigma_b) - (cohesion + mu * Abs(sigma_n))
