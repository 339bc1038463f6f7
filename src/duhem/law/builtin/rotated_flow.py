"""Coulomb friction whose slip turns away from the stress by a fixed angle.

    g = |sigma_t| - mu |sigma_n|,   slip direction = sigma_t rotated by delta,   0 <= delta <= 3/2 rad

Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; mu > 0 dimensionless, delta
in radians, counted from a to b.

Verdicts: K is convex and smooth; the law dissipates because force . flow = |sigma_t|^2 cos delta and 3/2 < pi/2;
normality is refuted unless delta = 0.

Source: A. Zmitrowicz (1981), Wear 73, 9-39 (friction not collinear with slip).
"""

from sympy import Abs, Expr, Rational

from duhem.expression import Norm
from duhem.law.domain import Domain
from duhem.law.formula_law import criterion

FLOW = ("cos(delta)*sigma_a - sin(delta)*sigma_b", "sin(delta)*sigma_a + cos(delta)*sigma_b")


@criterion(parameters={"delta": Domain.between(0, Rational(3, 2))}, flow=FLOW, source="Zmitrowicz (1981)")
def rotated_flow(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu: Expr, delta: Expr) -> Expr:
    """Coulomb friction whose slip turns away from the stress (non-associated)."""
    return Norm(sigma_a, sigma_b) - mu * Abs(sigma_n)
