"""Coordinates in which a set around 0 is round, and polynomials in them.

The least ellipsoid with centre 0 around points of the boundary is the unit ball of the new coordinates: a set that is the
same on both sides holds the ball of radius 1/sqrt(n) (John 1948).  Whatever linear map the set went through, there it looks alike.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

from duhem.proof.search.blocks import Polynomial, added, times

__all__ = ["Axes", "in_coordinates", "round_coordinates"]

Axes = tuple[tuple[Fraction, ...], ...]  # x = L w: a row for each old coordinate
_ROUNDS, _TURNS, _BITS = 4, 20, 20


def round_coordinates(reach: Callable[[Any], Any], directions: Any, long: float) -> Axes | None:
    """Those in which no ray is ``long`` times another, if some such are found, in short fractions; None where there are none.

    ``reach(u)`` is the distance of the boundary along each direction; infinite is no point of it.
    """
    import numpy as np

    n, axes = directions.shape[1], np.eye(directions.shape[1])
    for _ in range(_ROUNDS):  # from few points along an axis that is long, the next ellipsoid is found from more
        rays = directions @ axes.T
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        distance = reach(rays)
        met = np.isfinite(distance)
        points = np.linalg.solve(axes, (distance[met, None] * rays[met]).T).T
        lengths = np.linalg.norm(points, axis=1)
        if len(points) <= n or lengths.max() <= long * lengths.min():
            break
        axes = axes @ np.linalg.cholesky(n * _around(points))
    return None if np.array_equal(axes, np.eye(n)) else tuple(tuple(_short(float(a)) for a in row) for row in axes)


def _around(points: Any) -> Any:
    """M of the ellipsoid x . M^-1 x = n that holds the points, all but the least (Titterington 1976)."""
    import numpy as np

    weights = np.full(len(points), 1 / len(points))
    for _ in range(_TURNS):
        moment = (weights[:, None] * points).T @ points
        weights *= (points * np.linalg.solve(moment, points.T).T).sum(axis=1) / points.shape[1]
    return (weights[:, None] * points).T @ points


def _short(number: float) -> Fraction:
    """A fraction of few digits near by."""
    import numpy as np

    mantissa, exponent = np.frexp(number)
    return round(float(mantissa) * 2**_BITS) * Fraction(2) ** (int(exponent) - _BITS)


def in_coordinates(p: Polynomial, axes: Axes) -> Polynomial:
    """w -> p(L w)."""
    n = len(axes)
    lines = [{tuple(int(k == j) for k in range(n)): a for j, a in enumerate(row) if a} for row in axes]
    return _composed(p, lines, n)


def _composed(p: Polynomial, lines: Sequence[Polynomial], among: int) -> Polynomial:
    """After Horner in the last of so many coordinates that are still old."""
    if not among or not p:
        return {(0,) * len(lines): sum(p.values(), Fraction(0))} if p else {}
    i = among - 1
    parts = [{m: c for m, c in p.items() if m[i] == k} for k in range(max(m[i] for m in p), -1, -1)]
    return reduce(lambda found, part: added(times(found, lines[i]), _composed(part, lines, i)), parts, {})
