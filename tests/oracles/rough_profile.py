r"""The wedge micro-model by brute force: springs on a rough profile, and integrals over a density of heights.

Two ways to the coefficients of :mod:`duhem.micromodel.wedge` that use neither Eq. (13) nor Eq. (15): each spring's force is
solved from Coulomb's law on the side it stands on, for wedges whose heights vary and whose shape (alpha, beta) does not.
Angles in radians, heights in one unit of length; the spring force f = k_n (clearance + z) grows with the height z.

Source: Antoni, Ligier, Saffré, Pastor (2007), Eqs. (2)-(12) and the remark after (18) on distributions of heights.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.micromodel.wedge import limit_point

__all__ = ["Measured", "by_quadrature", "reaction", "simulate_profile"]

Array = NDArray[np.float64]
Heights = Callable[[np.random.Generator, int], Array]


@dataclass(frozen=True)
class Measured:
    """Mean traction (2,) per unit normal load and its standard error (2,), from ``springs`` springs."""

    traction: Array
    standard_error: Array
    springs: int


def simulate_profile(
    alpha: float,
    beta: float,
    mu_alpha: float,
    mu_beta: float,
    *,
    heights: Heights,
    phi: float = 0.0,
    wedges: int = 2000,
    springs: int = 200,
    clearance: float = 0.1,
    seed: int = 0,
) -> Measured:
    """Slide a bed of springs at angle ``phi`` (rad) over ``wedges`` wedges of random heights, about ``springs`` springs on each.

    ``heights`` draws heights > 0, as ``lambda rng, n: rng.lognormal(0, 0.5, n)``; wedges of a height stand as often as it is
    drawn.  ``clearance`` >= 0 is the compression of a spring in a valley.  phi = 0 measures (mu_plus, 0), phi = pi
    (-mu_minus, 0).  The standard error is that of a ratio of means over wedges.  InputError as
    :func:`duhem.micromodel.wedge.coefficients`, for heights that are not > 0, and for fewer than two wedges.
    """
    limit_point(phi, alpha, beta, mu_alpha, mu_beta)  # the checks of the arguments
    if wedges < 2 or springs < 1 or clearance < 0:
        raise InputError("too few to measure", where="wedges, springs", remedy="give two wedges or more, springs > 0, clearance >= 0")
    rng = np.random.default_rng(seed)
    h = np.asarray(heights(rng, wedges), dtype=float)
    if h.shape != (wedges,) or not (np.isfinite(h).all() and (h > 0).all()):
        raise InputError(f"heights must give {wedges} finite heights > 0", where="heights", remedy="redraw or take absolute values")
    rise, fall = np.tan(alpha), np.tan(beta)
    lengths = h * (1 / rise + 1 / fall)
    pitch = lengths.mean() / springs  # springs stand evenly, the first at random, whatever the wedge below
    edges = np.concatenate([[0.0], np.cumsum(lengths)])
    places = np.arange(rng.uniform(0, pitch), edges[-1], pitch)
    wedge = np.minimum(np.searchsorted(edges, places, side="right") - 1, wedges - 1)
    u = places - edges[wedge]
    climbing = u < h[wedge] / rise
    z = np.where(climbing, u * rise, (lengths[wedge] - u) * fall)
    force = reaction(np.where(climbing, rise, -fall), np.where(climbing, mu_alpha, mu_beta), phi)
    pressed = (clearance + z)[:, None] * force / force[:, 2:]  # the spring sets the vertical part
    sums = np.stack([np.bincount(wedge, weights=column, minlength=wedges) for column in pressed.T], axis=1)
    tangential, vertical = -sums[:, :2], sums[:, 2]
    ratio = tangential.sum(axis=0) / vertical.sum()
    spread = tangential - ratio * vertical[:, None]
    error = np.sqrt((spread**2).sum(axis=0) / (wedges * (wedges - 1))) / vertical.mean()
    return Measured(ratio, error, len(places))


def by_quadrature(
    alpha: float,
    beta: float,
    mu_alpha: float,
    mu_beta: float,
    *,
    density: Callable[[float], float],
    most: float,
    phi: float = 0.0,
    clearance: float = 0.1,
) -> Array:
    """Mean traction (2,) per unit normal load by adaptive quadrature over heights in (0, ``most``) and over both sides.

    ``density`` is that of the heights, normalised or not.  InputError as :func:`duhem.micromodel.wedge.coefficients`.
    """
    from scipy.integrate import quad

    limit_point(phi, alpha, beta, mu_alpha, mu_beta)
    total = np.zeros(3)
    for slope, mu in ((np.tan(alpha), mu_alpha), (-np.tan(beta), mu_beta)):
        force = reaction(np.asarray([slope]), np.asarray([mu]), phi)[0]

        def side(h: float, run: float = 1 / abs(slope)) -> float:
            inner, _ = quad(lambda u: clearance + u / run, 0.0, h * run)
            return float(density(h) * inner)

        share, _ = quad(side, 0.0, most, epsabs=0.0, epsrel=1e-12, limit=200)
        total += share * force / force[2]
    return np.asarray(-total[:2] / total[2])


def reaction(slope: Array, mu: Array, phi: float) -> Array:
    """Direction (n, 3) of the force of a side on the end of a spring that slips at angle phi: n/|n| - mu v/|v|."""
    one, zero = np.ones_like(slope), np.zeros_like(slope)
    normal = np.stack([-slope, zero, one], axis=1)
    velocity = np.stack([np.cos(phi) * one, np.sin(phi) * one, slope * np.cos(phi)], axis=1)
    unit_normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    unit_velocity = velocity / np.linalg.norm(velocity, axis=1, keepdims=True)
    return np.asarray(unit_normal - mu[:, None] * unit_velocity)
