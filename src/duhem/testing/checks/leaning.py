"""Points of K beside an answer, to where its slip leans off the normal.

A slip that is not normal to the boundary at the answer dissipates more at some point of K nearby, however little it leans: along the
boundary the power grows with the first power of the way, and K falls away with the second.  Points that are drawn find a slip that leans
a little only where they happen to lie there.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from duhem.projection.result import Array
from duhem.testing.checks.query import Query
from duhem.testing.checks.reply import Reply

__all__ = ["leaning"]

_WAYS = 1.0, 0.1, 0.01  # of the stress's length times the sine of the lean, which is best where K is round about the origin


def leaning(q: Query, found: Reply, slip: Array, unit: Array) -> Iterator[Array]:
    """Points of K (N, d), where k ``slip`` (N, d) leans off the normal by more than ``unit`` (N,); elsewhere the stress itself.

    With L^-1 the shadow of a stress in the metric of k^-1 and n = L^T grad g, the slip's shadow less its part along n says which
    way; a point outside K is drawn back to it on its ray from the origin.
    """
    stress = found.stress
    with np.errstate(all="ignore"):
        normal, shadow = q.gradient(found) @ q.axes.T, q.shadow(slip)
        normal = normal / np.linalg.norm(normal, axis=1)[:, None]
        lean = shadow - np.einsum("ij,ij->i", shadow, normal)[:, None] * normal
        size = np.linalg.norm(lean, axis=1)
        way = (q.length(stress) / q.length(slip))[:, None] * lean @ q.axes
    rows = np.flatnonzero((size > 2.0 * unit) & np.isfinite(way).all(axis=1) & way.any(axis=1))
    if not rows.size:
        return
    there = np.concatenate([stress[rows] + share * way[rows] for share in _WAYS])  # all at once: a reach costs its calls, not its rays
    reach = q.region.reach(there, np.tile(q.pressure[rows], len(_WAYS)))
    for drawn_back in np.split(np.minimum(reach, 1.0)[:, None] * there, len(_WAYS)):
        points = stress.copy()
        points[rows] = drawn_back
        yield points
