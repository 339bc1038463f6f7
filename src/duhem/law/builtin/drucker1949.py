"""Drucker's isotropic yield criterion with the third invariant, in principal stresses.

    g = J2^3 - c J3^2 - k^6,   c < 27/4

with J2, J3 the second and third invariants of the deviator of (s1, s2, s3).
Forces: the principal stresses s1, s2, s3 in one unit with k > 0 (pure shear); c real and dimensionless.  No
pressure.  g has the unit of a stress to the sixth.  Because J3^2 <= 4/27 J2^3, with equality in uniaxial tension, the
section of the cylinder K is bounded if and only if c < 27/4.

Verdicts: K is convex if and only if -27/8 <= c <= 9/4, so convexity over the declared domain is refuted; the surface is
smooth and normality dissipates by Euler's identity for homogeneous functions.  The polar gauge has no closed form.

Source: D. C. Drucker (1949), J. Appl. Mech. 16, 349-357 (c = 9/4); O. Cazacu and F. Barlat (2001), Math. Mech.
Solids 6, 613-630 (range of c).
"""

from sympy import Expr

from duhem.law.domain import REAL
from duhem.law.formula_law import criterion


@criterion(forces=["s1", "s2", "s3"], pressure=None, parameters={"c": REAL}, constraints=["c < 27/4"], source="Drucker (1949)")
def drucker1949(s1: Expr, s2: Expr, s3: Expr, k: Expr, c: Expr) -> Expr:
    """Drucker's yield criterion with the third invariant."""
    second = ((s1 - s2) ** 2 + (s2 - s3) ** 2 + (s3 - s1) ** 2) / 6
    third = (2 * s1 - s2 - s3) * (2 * s2 - s3 - s1) * (2 * s3 - s1 - s2) / 27
    return second**3 - c * third**2 - k**6
