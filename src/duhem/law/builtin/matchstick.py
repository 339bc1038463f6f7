"""Friction whose coefficient averages in squares over the slip angle: a hippopede (elliptic lemniscate of Booth).

    r^2 = sigma_n^2 (mu_a^2 cos^2 theta + mu_b^2 sin^2 theta),   written   g = r^2 - |sigma_n| sqrt[(mu_a sigma_a)^2 + (mu_b sigma_b)^2]

with r = |sigma_t|, so that no 0/0 arises at the origin, where g = 0 though it is inside K.
Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; mu_a, mu_b > 0 dimensionless.
g has the unit of a stress squared.  It is the pedal curve of the ellipse with half-axes mu_a, mu_b.

Verdicts: K is convex if and only if 1/2 <= (mu_a/mu_b)^2 <= 2, so convexity over the declared domain is refuted; the
boundary is smooth, and normality dissipates because K is star-shaped about the origin.  The polar gauge has no closed
form in general.

Source: J. D. Lawrence (1972), A Catalog of Special Plane Curves, Dover (hippopede).
"""

from sympy import Abs, Expr

from duhem.expression import Norm
from duhem.law.formula_law import criterion


@criterion(source="Lawrence (1972)")
def matchstick(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu_a: Expr, mu_b: Expr) -> Expr:
    """Coefficient averaged in squares: a hippopede."""
    return Norm(sigma_a, sigma_b) ** 2 - Abs(sigma_n) * Norm(mu_a * sigma_a, mu_b * sigma_b)
