"""Two directions that slip independently of each other: a rectangle.

    g = max(|sigma_a|/mu_a, |sigma_b|/mu_b) - |sigma_n|

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; mu_a, mu_b > 0 dimensionless.

Verdicts: smoothness is refuted at the corners, every other claim holds; the dissipation potential is
|sigma_n| (mu_a |d_a| + mu_b |d_b|).

Source: R. T. Rockafellar (1970), Convex Analysis, section 13 (support functions); W. T. Koiter (1953), Q. Appl. Math.
11, 350-354 (normality at corners).
"""

from sympy import Abs, Expr, Max

from duhem.law.formula_law import criterion


@criterion(source="Koiter (1953)")
def box(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu_a: Expr, mu_b: Expr) -> Expr:
    """Two independent slip directions: a rectangle."""
    return Max(Abs(sigma_a) / mu_a, Abs(sigma_b) / mu_b) - Abs(sigma_n)
