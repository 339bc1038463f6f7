"""Superelliptic friction: the unit ball of a p-norm, between the diamond and the box.

    g = [(|sigma_a|/mu_a)^p + (|sigma_b|/mu_b)^p]^(1/p) - |sigma_n|,   p > 1

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; mu_a, mu_b > 0 and p are
dimensionless.  At p = 1 the curve is a diamond and has corners, so p = 1 lies outside the constraint.

Verdicts: every claim holds for p > 1: convex by Minkowski's inequality, C1 because x -> |x|^p is; the dissipation
potential is |sigma_n| times the q-norm of (mu_a d_a, mu_b d_b), 1/p + 1/q = 1 (Hölder).  The curvature vanishes on the
axes where p > 2 and is infinite there where p < 2.

Source: G. Lamé (1818), Examen des différentes méthodes (the curve); R. T. Rockafellar (1970), Convex Analysis,
section 15 (polar gauges).
"""

from sympy import Abs, Expr

from duhem.law.domain import Domain
from duhem.law.formula_law import criterion


@criterion(parameters={"p": Domain.between(1, None)}, constraints=["p > 1"], source="Lamé (1818)")
def superellipse(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu_a: Expr, mu_b: Expr, p: Expr) -> Expr:
    """Superelliptic friction: the ball of a p-norm."""
    return ((Abs(sigma_a) / mu_a) ** p + (Abs(sigma_b) / mu_b) ** p) ** (1 / p) - Abs(sigma_n)
