"""Hosford's isotropic yield criterion in principal stresses.

    g = {[|s1 - s2|^m + |s2 - s3|^m + |s3 - s1|^m]/2}^(1/m) - yield_stress,   m > 1

Forces: the principal stresses s1, s2, s3, in any order, in one unit with yield_stress > 0 (uniaxial); m real and
dimensionless.  No pressure.  K is a cylinder along s1 = s2 = s3: m = 2 and m = 4 give von Mises, m = 1 and
m -> oo Tresca; m = 1 has corners and lies outside the constraint.

Verdicts: every claim holds for m > 1 (a norm of a linear map; C1 because x -> |x|^m is); the polar gauge has no closed
form in general.

Source: W. F. Hosford (1972), J. Appl. Mech. 39, 607-609.
"""

from sympy import Abs, Expr

from duhem.law.domain import Domain
from duhem.law.formula_law import criterion


@criterion(
    forces=["s1", "s2", "s3"], pressure=None, parameters={"m": Domain.between(1, None)}, constraints=["m > 1"], source="Hosford (1972)"
)
def hosford(s1: Expr, s2: Expr, s3: Expr, yield_stress: Expr, m: Expr) -> Expr:
    """Hosford's yield criterion in principal stresses."""
    return ((Abs(s1 - s2) ** m + Abs(s2 - s3) ** m + Abs(s3 - s1) ** m) / 2) ** (1 / m) - yield_stress
