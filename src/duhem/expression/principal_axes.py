"""Eigenvalues and unit eigenvectors of a symmetric matrix of three rows, in plain loops that a compiler and the export take too.

The eigenvalue that is farthest from the other two follows from the invariants of the deviator, where that loses no digits; its
eigenvector is across the rows of what is left of the matrix, and in the plane across it one rotation parts the other two, equal or not
(W. M. Scherzinger and C. R. Dohrmann, 2008, Comput. Methods Appl. Mech. Engrg. 197, 4007-4015).  Each eigenvalue is then the quotient
n . A n, off by some roundings of the entries.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy import arccos, cos, sqrt

__all__ = ["FUNCTIONS", "greatest", "principal_axes"]


def form(axes: Any, i: int, j: int, xx: float, yy: float, zz: float, yz: float, xz: float, xy: float) -> float:
    """n_i . A n_j for rows of ``axes``."""
    a, b, c = axes[j, 0], axes[j, 1], axes[j, 2]
    return axes[i, 0] * (xx * a + xy * b + xz * c) + axes[i, 1] * (xy * a + yy * b + yz * c) + axes[i, 2] * (xz * a + yz * b + zz * c)


def led(axes: Any, first: int) -> None:
    """The longest row from the ``first`` to row 3 takes the place of the first, with length 1."""
    best, most = first, -1.0
    for i in range(first, 4):
        square = axes[i, 0] * axes[i, 0] + axes[i, 1] * axes[i, 1] + axes[i, 2] * axes[i, 2]
        if square > most:
            best, most = i, square
    size = sqrt(most)
    for k in range(3):
        axes[first, k], axes[best, k] = axes[best, k], axes[first, k]
        axes[first, k] /= size


def parted(axes: Any, x: float, y: float, z: float, yz: float, xz: float, xy: float) -> None:
    """Rows 1 to 3 become the axes of a matrix without trace, of which the largest entry is 1."""
    second = 0.5 * (x * x + y * y + z * z) + (yz * yz + xz * xz + xy * xy)
    third = x * y * z + 2.0 * yz * xz * xy - x * yz * yz - y * xz * xz - z * xy * xy
    share = min(abs(third) * 1.5 * sqrt(3.0) / (second * sqrt(second)), 1.0)
    apart = 2.0 * sqrt(second / 3.0) * cos(arccos(share) / 3.0) * (1.0 if third > 0.0 else -1.0)
    axes[1, 0], axes[1, 1], axes[1, 2] = x - apart, xy, xz
    axes[2, 0], axes[2, 1], axes[2, 2] = xy, y - apart, yz
    axes[3, 0], axes[3, 1], axes[3, 2] = xz, yz, z - apart
    led(axes, 1)
    for i in range(2, 4):
        along = axes[i, 0] * axes[1, 0] + axes[i, 1] * axes[1, 1] + axes[i, 2] * axes[1, 2]
        for k in range(3):
            axes[i, k] -= along * axes[1, k]
    led(axes, 2)
    axes[3, 0] = axes[1, 1] * axes[2, 2] - axes[1, 2] * axes[2, 1]
    axes[3, 1] = axes[1, 2] * axes[2, 0] - axes[1, 0] * axes[2, 2]
    axes[3, 2] = axes[1, 0] * axes[2, 1] - axes[1, 1] * axes[2, 0]
    mixed = form(axes, 1, 2, x, y, z, yz, xz, xy)
    if mixed != 0.0:
        ratio = 0.5 * (form(axes, 2, 2, x, y, z, yz, xz, xy) - form(axes, 1, 1, x, y, z, yz, xz, xy)) / mixed
        tangent = (1.0 if ratio > 0.0 else -1.0) / (abs(ratio) + sqrt(ratio * ratio + 1.0))
        cosine = 1.0 / sqrt(tangent * tangent + 1.0)
        for k in range(3):
            a, b = axes[1, k], axes[2, k]
            axes[1, k], axes[2, k] = cosine * (a - tangent * b), cosine * (b + tangent * a)


def ordered(axes: Any, i: int) -> None:
    """Axis ``i`` and the next one change places where its eigenvalue is the greater."""
    if axes[0, i - 1] > axes[0, i]:
        axes[0, i - 1], axes[0, i] = axes[0, i], axes[0, i - 1]
        for k in range(3):
            axes[i, k], axes[i + 1, k] = axes[i + 1, k], axes[i, k]


def principal_axes(axes: Any, xx: float, yy: float, zz: float, yz: float, xz: float, xy: float) -> None:
    """Row 0 of ``axes`` becomes the eigenvalues, rising, and rows 1 to 3 unit eigenvectors; all nan where an entry is undefined."""
    x, y, z = ((xx - yy) + (xx - zz)) / 3.0, ((yy - zz) + (yy - xx)) / 3.0, ((zz - xx) + (zz - yy)) / 3.0
    unit = max(max(max(abs(x), abs(y)), abs(z)), max(max(abs(yz), abs(xz)), abs(xy)))
    sound = isfinite(x + y + z) and isfinite(yz + xz + xy)
    for i in range(3):
        for k in range(3):
            axes[1 + i, k] = (1.0 if i == k else 0.0) if sound else np.nan
    if sound and unit > 1e-300:
        per = 1.0 / unit
        parted(axes, x * per, y * per, z * per, yz * per, xz * per, xy * per)
    for i in range(3):
        axes[0, i] = form(axes, 1 + i, 1 + i, xx, yy, zz, yz, xz, xy)
    ordered(axes, 1)
    ordered(axes, 2)
    ordered(axes, 1)


def greatest(xx: float, yy: float, zz: float, yz: float, xz: float, xy: float) -> float:
    """The greatest eigenvalue; nan where an entry is undefined."""
    axes = np.empty((4, 3))
    principal_axes(axes, xx, yy, zz, yz, xz, xy)
    return float(axes[0, 2])


FUNCTIONS = form, led, parted, ordered, principal_axes, greatest
"""What a text that calls the last two is compiled with."""
