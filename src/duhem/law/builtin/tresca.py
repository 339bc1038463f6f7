"""Tresca's yield criterion in principal stresses.

    g = max(|s1 - s2|, |s2 - s3|, |s3 - s1|) - yield_stress

Forces: the principal stresses s1, s2, s3, in any order, in one unit with yield_stress > 0 (uniaxial).  No pressure.
K is a hexagonal cylinder along s1 = s2 = s3.

Verdicts: smoothness is refuted at the edges, every other claim holds; the dissipation potential is
yield_stress max(|d1|, |d2|, |d3|) where d1 + d2 + d3 = 0, and infinite elsewhere.

Source: H. Tresca (1864), C. R. Acad. Sci. Paris 59, 754-758; W. T. Koiter (1953), Q. Appl. Math. 11, 350-354.
"""

from sympy import Abs, Expr, Max

from duhem.law.formula_law import criterion


@criterion(forces=["s1", "s2", "s3"], pressure=None, source="Tresca (1864)")
def tresca(s1: Expr, s2: Expr, s3: Expr, yield_stress: Expr) -> Expr:
    """Tresca's yield criterion in principal stresses."""
    return Max(Abs(s1 - s2), Abs(s2 - s3), Abs(s3 - s1)) - yield_stress
