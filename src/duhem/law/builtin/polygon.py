"""Linearised Coulomb friction: a polygon of twelve sides around the Coulomb disk.

    g = max(|sigma_a|, |sigma_b|, (4 |sigma_a| + 3 |sigma_b|)/5, (3 |sigma_a| + 4 |sigma_b|)/5) - mu |sigma_n|

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; mu > 0 dimensionless.
The unit normals (1, 0), (4/5, 3/5), (3/5, 4/5), (0, 1) and their mirror images are rational, unlike those of the
regular octagon: every side is tangent to the disk of radius mu |sigma_n| exactly, and linear arithmetic over the
rationals decides the law.  The farthest corners, on the rays of slope 1/3 and 3, lie sqrt(10)/3 = 1.054 radii out.

Verdicts: smoothness is refuted at the corners, every other claim holds; the dissipation potential is the greatest
product of d with a corner.

Source: A. Klarbring (1986), Comput. Methods Appl. Mech. Eng. 58, 175-200 (piecewise linear friction).
"""

from sympy import Abs, Expr, Max

from duhem.law.formula_law import criterion


@criterion(source="Klarbring (1986)")
def polygon(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu: Expr) -> Expr:
    """Linearised Coulomb friction: twelve sides with rational normals."""
    x, y = Abs(sigma_a), Abs(sigma_b)
    return Max(x, y, (4 * x + 3 * y) / 5, (3 * x + 4 * y) / 5) - mu * Abs(sigma_n)
