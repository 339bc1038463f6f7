"""Isotropic Coulomb friction.

    g = |sigma_t| - mu |sigma_n|,   sigma_t = (sigma_a, sigma_b)

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; all in Pa (or one common unit); mu > 0
is dimensionless.  K(sigma_n) is a disk.

Verdicts: every claim holds; the dissipation potential is mu |sigma_n| |d|.  Normality acts in the tangential plane
at frozen sigma_n; in (sigma_t, sigma_n) the law is not associated (Moreau, 1970).

Source: C. A. Coulomb (1785), Théorie des machines simples; J. J. Moreau (1970), C. R. Acad. Sci. Paris A 271,
608-611; Antoni et al. (2007), Eq. (35) with equal coefficients.
"""

from sympy import Abs, Expr

from duhem.expression import Norm
from duhem.law.formula_law import criterion
from duhem.law.shapes import Disk


@criterion(source="Coulomb (1785)", closed_form=Disk("mu"))
def coulomb(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu: Expr) -> Expr:
    """Isotropic Coulomb friction: a disk."""
    return Norm(sigma_a, sigma_b) - mu * Abs(sigma_n)
