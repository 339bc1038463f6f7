"""How far the closest point goes when the boundary of K does: where K is thin farther along it than across.

Where g is off by e its boundary is e/|n| away, n = dg/dsigma, and the point of it that is closest to a trial t is |w| times as far away:

    sigma + lambda k n = t,  g(sigma) = e:      w = n/|n| - z,   (1 + lambda H) z = lambda H n/|n|  across n,

H the Hessian of g, all in the metric of k.  Of all y with y . n = |n| it is w that makes y . (1 + lambda H) y least, whatever H is
along n: so |w| <= |sigma| |n| / sigma . n where the sets {g <= e} are alike seen from no stress, as those of gauges and their powers are.
"""

from __future__ import annotations

import numpy as np

from duhem.projection.level import Level
from duhem.projection.metric import Metric
from duhem.projection.result import Array
from duhem.projection.row_by_row import length, unit

__all__ = ["shifts"]


def shifts(level: Level, metric: Metric, stress: Array, pressure: Array, units: Array, multiplier: Array) -> Array:
    """|w| (M,) at stresses (M, d) in ``units`` R of the level, with multipliers of h; nan where g has no curvature there."""
    d = stress.shape[1]
    normal, _ = unit(level.gradient(stress, pressure, units) @ metric.of_slip)
    bend = (multiplier / units)[:, None, None] * (metric.of_slip.T @ level.hessian(stress, pressure, units) @ metric.of_slip)
    known = np.asarray(np.isfinite(bend).all(axis=(1, 2)) & np.isfinite(normal).all(axis=1))
    bend, normal = np.where(known[:, None, None], bend, 0.0), np.where(known[:, None], normal, np.eye(d)[0])
    across = np.eye(d) - normal[:, :, None] * normal[:, None, :]
    stiff = np.eye(d) + across @ bend @ across  # 1 along the normal
    aside = across @ bend @ normal[:, :, None]
    sizes = np.sqrt(np.abs(np.diagonal(stiff, axis1=1, axis2=2)))
    sizes = np.where(sizes > 0.0, sizes, 1.0)
    scaled = stiff / (sizes[:, :, None] * sizes[:, None, :])
    z = (np.linalg.pinv(scaled, rcond=1e-15, hermitian=True) @ (aside / sizes[:, :, None]))[:, :, 0] / sizes
    return np.where(known, np.hypot(1.0, length(z)), np.nan)
