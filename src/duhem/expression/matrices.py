"""Symmetric matrices of three rows, given by their entries xx, yy, zz, yz, xz, xy, over numbers of any kind."""

from __future__ import annotations

from typing import Any

__all__ = ["deviator", "rows"]


def rows(xx: Any, yy: Any, zz: Any, yz: Any, xz: Any, xy: Any) -> list[list[Any]]:
    """The matrix, row by row."""
    return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]


def deviator(xx: Any, yy: Any, zz: Any, yz: Any, xz: Any, xy: Any) -> tuple[Any, Any, Any]:
    """A third of the trace; J2 and J3, half the square and the determinant of what is left without it.

    The greatest eigenvalue is mean + 2 sqrt(J2/3) cos(theta), cos(3 theta) = 3 sqrt(3)/2 J3/J2^(3/2), 0 <= theta <= pi/3.
    """
    mean = (xx + yy + zz) / 3
    x, y, z = ((2 * xx - yy - zz) / 3, (2 * yy - zz - xx) / 3, (2 * zz - xx - yy) / 3)
    squares = [d * d for d in (xx - yy, yy - zz, zz - xx)]
    shears = [s * s for s in (yz, xz, xy)]
    second = (squares[0] + squares[1] + squares[2]) / 6 + (shears[0] + shears[1] + shears[2])
    return mean, second, x * y * z + 2 * yz * xz * xy - x * shears[0] - y * shears[1] - z * shears[2]
