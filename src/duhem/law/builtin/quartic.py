"""Quartic friction with the symmetry of the square.

    g = sigma_a^4 + c sigma_a^2 sigma_b^2 + sigma_b^4 - (mu |sigma_n|)^4,   c > -2

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; mu > 0 and c dimensionless.
g has the unit of a stress to the fourth.  At c = -2 the form is (sigma_a^2 - sigma_b^2)^2 and K is unbounded, so
c = -2 lies outside the constraint; c = 2 is the disk.

Verdicts: K is convex if and only if 0 <= c <= 6, so convexity over the declared domain is refuted; the boundary is
smooth and normality dissipates by Euler's identity for homogeneous functions.  The polar gauge has no closed form
used here.

Source: M. Gotoh (1977), Int. J. Mech. Sci. 19, 505-512 (fourth-order criteria); the range of c is that of a
non-negative Hessian, 48 c + 144 - 12 c^2 >= 0 on the diagonals and c >= 0 on the axes.
"""

from sympy import Abs, Expr

from duhem.law.domain import Domain
from duhem.law.formula_law import criterion


@criterion(parameters={"c": Domain.between(-2, None)}, constraints=["c > -2"], source="Gotoh (1977)")
def quartic(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu: Expr, c: Expr) -> Expr:
    """Quartic friction with the symmetry of the square."""
    return sigma_a**4 + c * sigma_a**2 * sigma_b**2 + sigma_b**4 - (mu * Abs(sigma_n)) ** 4
