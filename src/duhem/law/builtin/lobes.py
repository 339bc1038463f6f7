"""Friction with an n-fold texture; the law of the catalogue has three lobes.

    r = mu |sigma_n| (1 + e cos n theta),   written   g = r^(n+1) - mu |sigma_n| (r^n + e Re (sigma_a + i sigma_b)^n),   |e| < 1

with r = |sigma_t|, so that no 0/0 arises at the origin, where g = 0 though it is inside K.
Forces: two tangential stresses; pressure sigma_n <= 0 in compression; one common unit; mu > 0 and e dimensionless.
g has the unit of a stress to the power n + 1.

Verdicts: K is convex if and only if |e| <= 1/(1 + n^2), that is 1/10 for three lobes, so convexity over the declared
domain is refuted; the boundary is smooth, and normality dissipates because K is star-shaped about the origin.  The
polar gauge has no closed form.

Source: M. P. do Carmo (1976), Differential Geometry of Curves and Surfaces (a polar curve is convex if and only if
r^2 + 2 r'^2 - r r'' >= 0; least where cos n theta = -sign e).
"""

from sympy import Abs, Expr, I, expand, re

from duhem.expression import Norm
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion, criterion

DEPTH = Domain.between(-1, 1)


def lobe_law(n: int) -> Criterion:
    """The law with n >= 1 lobes; registered as ``lobes-n``, and as ``lobes`` for n = 3."""

    @criterion(name="lobes" if n == 3 else f"lobes-{n}", parameters={"e": DEPTH}, constraints=["-1 < e", "e < 1"], source="do Carmo (1976)")
    def law(sigma_a: Expr, sigma_b: Expr, sigma_n: Expr, mu: Expr, e: Expr) -> Expr:
        """Friction with an n-fold texture: a curve with lobes."""
        r, wave = Norm(sigma_a, sigma_b), re(expand((sigma_a + I * sigma_b) ** n))
        return r ** (n + 1) - mu * Abs(sigma_n) * (r**n + e * wave)

    return law


lobes = lobe_law(3)
