"""Directions in which something of K(sigma_n) happens: seams of the formula, corners, and the mean stress, with its apexes."""

from __future__ import annotations

import numpy as np

from duhem.expression.rays import Rays
from duhem.projection.result import Array
from duhem.testing.drawn.region import Region

__all__ = ["TURNS", "turned"]

TURNS: list[str] = [*["as drawn"] * 9, "corner", "mean", "equal", *["seam"] * 3]
"""What is made of a direction; the first, which is nothing, as often as the rest together and a little more."""


def turned(region: Region, way: Array, other: Array, turns: list[str], pressure: Array) -> Array:
    """Directions (N, d) of largest component 1, some of ``way`` turned.

    ``corner``: all components that are not tiny alike in size.  ``mean``: normal components alike, no shear, for laws of a
    stress; the way to an apex.  ``equal``: the first two components equal, where principal stresses are.  ``seam``: the last
    number before the smooth piece of g changes on the way to ``other``, and the first after it in every second row.
    """
    found, kind = way.copy(), np.array(turns)
    at = kind == "corner"
    found[at] = np.where(np.abs(way[at]) > 1e-3, np.sign(way[at]), 0.0)
    stress = region.law.stress
    if stress is not None:
        normal = ~np.array(stress.shears)
        at = kind == "mean"
        found[at] = np.where(way[at, :1] < 0.0, -1.0, 1.0) * normal
    if way.shape[1] > 1:
        at = kind == "equal"
        found[at, 1] = found[at, 0]
        size = np.abs(found[at]).max(axis=1, keepdims=True)
        found[at] = np.where(size > 0.0, found[at] / np.where(size > 0.0, size, 1.0), way[at])
    if (rows := np.flatnonzero(kind == "seam")).size:
        found[rows] = _seam(region, way[rows], other[rows], pressure[rows], rows % 2 == 1)
    return found


def _seam(region: Region, first: Array, last: Array, pressure: Array, beyond: Array) -> Array:
    """Where the piece of g changes between two directions, at stresses of the size of the boundary; ``first`` where it does not."""
    with np.errstate(all="ignore"):
        reach = region.reach(first, pressure)
        size = np.where(np.isfinite(reach) & (reach > 0.0), reach, 1.0)
        here = region.slope(size[:, None] * first, pressure)[1]

        def level(points: Array) -> Array:
            """Negative on the piece of the first direction; points (M, n, d)."""
            m, n, d = points.shape
            stress = (size[:, None, None] * points).reshape(m * n, d)
            piece = np.asarray(region.slope(stress, np.repeat(pressure, n))[1]).reshape(m, n, -1)
            return np.where((piece == np.asarray(here).reshape(m, 1, -1)).all(axis=2), -1.0, 1.0)

        rays = Rays(level, first, last - first)
        changes = ~rays.inside(np.array([1.0]))[:, 0]
        if not changes.any():
            return first
        inner, outer = rays.narrowed(np.zeros(len(first)), np.ones(len(first)), at_once=6)
    share = np.where(beyond, outer, inner)
    way = rays.at(share)
    longest = np.abs(way).max(axis=1, keepdims=True)
    good = changes[:, None] & (longest > 1e-300)
    return np.where(good, way / np.where(good, longest, 1.0), first)
