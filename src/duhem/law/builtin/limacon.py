"""Asymmetric friction with one harmonic: Pascal's limaçon.

    r = mu |sigma_n| (1 + e cos theta),   written   g = r^2 - mu |sigma_n| (r + e sigma_a),   0 <= e < 1

with r = |sigma_t| and r cos theta = sigma_a, so that no 0/0 arises at the origin, where g = 0 though it is inside K.
Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; mu > 0 and e dimensionless.
g has the unit of a stress squared.

Verdicts: K is convex if and only if e <= 1/2 (r^2 + 2 r'^2 - r r'' >= 0), so convexity over the declared domain is
refuted; the boundary is smooth, and normality dissipates because K is star-shaped about the origin.  The polar gauge
has no closed form.

Source: E. H. Lockwood (1961), A Book of Curves, Cambridge University Press (limaçon).
"""

from sympy import Abs, Expr

from duhem.expression import Norm
from duhem.law.domain import Domain
from duhem.law.formula_law import criterion


@criterion(parameters={"e": Domain.between(0, 1)}, constraints=["e < 1"], source="Lockwood (1961)")
def limacon(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu: Expr, e: Expr) -> Expr:
    """Asymmetric friction with one harmonic: a limaçon."""
    r = Norm(sigma_a, sigma_b)
    return r**2 - mu * Abs(sigma_n) * (r + e * sigma_a)
