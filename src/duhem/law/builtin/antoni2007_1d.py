"""Asymmetric friction along a line.

    g = <sigma_t>_+ / mu_plus + <sigma_t>_- / mu_minus - |sigma_n|,   so -mu_minus |sigma_n| <= sigma_t <= mu_plus |sigma_n|

Force: one tangential stress; pressure sigma_n <= 0 in compression; one common unit; mu_plus, mu_minus > 0
dimensionless.

Verdicts: every claim holds; the boundary is two points, each with one outward normal, so smoothness is proved.  It is
the plane law of the same paper, Eq. (35), restricted to one direction.

Source: N. Antoni, J.-L. Ligier, P. Saffré, J. Pastor (2007), Int. J. Eng. Sci. 45, 587-600, Eq. (1).
"""

from sympy import Abs, Expr

from duhem.expression import Neg, Pos
from duhem.law.formula_law import criterion
from duhem.law.shapes import Interval

SEGMENT = Interval("mu_plus", "mu_minus")


@criterion(forces=["sigma_t"], source="Antoni, Ligier, Saffré and Pastor (2007), Eq. (1)", closed_form=SEGMENT)
def antoni2007_1d(sigma_t: Expr, sigma_n: Expr, mu_plus: Expr, mu_minus: Expr) -> Expr:
    """Asymmetric friction along a line: an interval."""
    return Pos(sigma_t) / mu_plus + Neg(sigma_t) / mu_minus - Abs(sigma_n)
