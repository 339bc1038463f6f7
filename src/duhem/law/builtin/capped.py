"""Coulomb friction capped by a shear strength, after Orowan.

    g = |sigma_t| - min(mu |sigma_n|, tau_max)

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; tau_max > 0 in the unit of the stresses;
mu > 0 dimensionless.  K(sigma_n) is a disk that stops growing at |sigma_n| = tau_max/mu.

Verdicts: every claim holds; the dissipation potential is min(mu |sigma_n|, tau_max) |d|.

Source: E. Orowan (1943), Proc. Inst. Mech. Eng. 150, 140-167.
"""

from sympy import Abs, Expr, Min

from duhem.expression import Norm
from duhem.law.formula_law import criterion
from duhem.law.shapes import Disk


@criterion(source="Orowan (1943)", closed_form=Disk(load="min(mu*abs(sigma_n), tau_max)"))
def capped(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu: Expr, tau_max: Expr) -> Expr:
    """Coulomb friction capped by a shear strength."""
    return Norm(sigma_a, sigma_b) - Min(mu * Abs(sigma_n), tau_max)
