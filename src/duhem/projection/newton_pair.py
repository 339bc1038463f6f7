"""An edge of K where two eigenvalues are equal: the cone of normals there, of three pieces.

An eigenvalue that is double has a plane of axes n, and K is n . A n <= ... for each of them: any three of these pieces meet in the edge.
A normal of K there is the sum of theirs by multipliers of any sign, as long as the matrix of two rows that they make in the plane is
positive definite; then it is also such a sum by three other axes with multipliers above 0.

Compiled with :mod:`duhem.projection.newton_kernel`.
"""

from __future__ import annotations

from typing import Any

from numpy import sqrt

from duhem.projection.newton_step import LENGTHS, LEVELS, NORMALS, RAWBEND, SLOPES, D

__all__ = ["spread"]

# -- compiled from here ----------------------------------------------------------------------------------------

FLAT_PAIR = 1e-9  # of a matrix of multipliers: its determinant is nothing


def spread(v: Any, m: Any) -> bool:
    """Puts the pieces of three axes with multipliers above 0 in the place of those of two axes and their mean; False where none are."""
    mixed = 0.5 * v[LENGTHS, 2] / v[SLOPES, 2]
    first, second = v[LENGTHS, 0] / v[SLOPES, 0] + mixed, v[LENGTHS, 1] / v[SLOPES, 1] + mixed
    if not (first > 0.0 and second > 0.0 and first * second - mixed * mixed > FLAT_PAIR * first * second):
        return False
    top, aside = sqrt(first), mixed / sqrt(first)
    across = sqrt(second - aside * aside)
    for i in range(3):  # rows of a root of the matrix, turned by thirds of a turn
        c, s = (1.0 if i == 0 else -0.5), (0.0 if i == 0 else sqrt(0.75) if i == 1 else -sqrt(0.75))
        a, b = top * c, aside * c + across * s
        square = a * a + b * b
        one, other, both = (a * a - a * b) / square, (b * b - a * b) / square, 2.0 * a * b / square
        for k in range(D):  # the gradient there, of the three that are known
            m[RAWBEND, i, k] = one * v[SLOPES, 0] * m[NORMALS, 0, k] + other * v[SLOPES, 1] * m[NORMALS, 1, k]
            m[RAWBEND, i, k] += both * v[SLOPES, 2] * m[NORMALS, 2, k]
        m[RAWBEND + 1, 0, i] = one * v[SLOPES, 0] * v[LEVELS, 0] + other * v[SLOPES, 1] * v[LEVELS, 1] + both * v[SLOPES, 2] * v[LEVELS, 2]
        m[RAWBEND + 1, 1, i] = square / 1.5
    for i in range(3):
        steep = 0.0
        for k in range(D):
            steep += m[RAWBEND, i, k] * m[RAWBEND, i, k]
        steep = sqrt(steep)
        for k in range(D):
            m[NORMALS, i, k] = m[RAWBEND, i, k] / steep
        v[SLOPES, i], v[LEVELS, i], v[LENGTHS, i] = steep, m[RAWBEND + 1, 0, i] / steep, m[RAWBEND + 1, 1, i] * steep
    return True
