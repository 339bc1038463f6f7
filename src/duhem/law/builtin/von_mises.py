"""Von Mises' yield criterion in principal stresses.

    g = sqrt{[(s1 - s2)^2 + (s2 - s3)^2 + (s3 - s1)^2]/2} - yield_stress

Forces: the principal stresses s1, s2, s3 in one unit with yield_stress > 0 (uniaxial).  No pressure.
K is a circular cylinder along s1 = s2 = s3.

Verdicts: every claim holds; the dissipation potential is yield_stress sqrt(2/3) |d| where d1 + d2 + d3 = 0, and
infinite elsewhere.

Source: R. von Mises (1913), Nachr. Ges. Wiss. Göttingen, Math.-Phys. Klasse, 582-592.
"""

from sympy import Expr, sqrt

from duhem.expression import Norm
from duhem.law.formula_law import criterion


@criterion(forces=["s1", "s2", "s3"], pressure=None, source="von Mises (1913)")
def von_mises(s1: Expr, s2: Expr, s3: Expr, yield_stress: Expr) -> Expr:
    """Von Mises' yield criterion in principal stresses."""
    return Norm(s1 - s2, s2 - s3, s3 - s1) / sqrt(2) - yield_stress
