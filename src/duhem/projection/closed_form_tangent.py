"""Consistent tangents d sigma/d u and d sigma/d sigma_n of the closed-form step: implicit differentiation of its equations.

With G the Hessian of the gauge, sigma + k lambda n = sigma_tr and n . d sigma = d e give in two dimensions
(J. C. Simo and R. L. Taylor, 1985, Comput. Methods Appl. Mech. Eng. 48, 101-118)

    d sigma/d u = s s^T / (s . k^-1 s + lambda s . G s),   s perpendicular to n,

and on a quarter ellipse with sigma = e y, y = (mu_a w_a, mu_b w_b), the choice s = (-mu_a w_b, mu_b w_a) makes
s . G s = 1/e.  Symmetric, and with eigenvalues in [0, 1] in the metric of k.  At a seam, where the curvature jumps, it is
the one-sided value of the quarter the slip points to.
"""

from __future__ import annotations

import numpy as np
import sympy as sp

from duhem.expression.jets import formula
from duhem.law.shapes import Interval
from duhem.projection.coefficients import centre, coefficients, declared, of_pressure
from duhem.projection.increment import Increment
from duhem.projection.result import Array, Solution
from duhem.projection.stiffness_factors import factors

__all__ = ["tangent"]


def tangent(increment: Increment, solution: Solution) -> tuple[Array, Array | None]:
    """d sigma/d u (N, d, d) in Pa/m, and d sigma/d sigma_n (N, d) or None for a law without pressure.

    Where K is a point d sigma/d u = 0, trials that stick there included; d sigma/d sigma_n is of the side where K opens.
    """
    slips = (solution.slip != 0.0).any(axis=1)
    n, d = solution.stress.shape
    size = of_pressure(increment, declared(increment).load)(increment.pressure)
    single = (size == 0.0) | coefficients(increment).empty | (not any(coefficients(increment).mu))
    of_u = np.where((slips | single)[:, None, None], 0.0, increment.stiffness)
    of_load, through = np.zeros((n, d)), np.zeros((n, d, d))
    at = np.flatnonzero(slips)
    with np.errstate(all="ignore"):
        slip = solution.slip[at]
        if isinstance(declared(increment), Interval):
            of_load[at, 0] = np.where(slip[:, 0] < 0.0, -coefficients(increment).mu[1], coefficients(increment).mu[0])
        else:
            load = of_pressure(increment, declared(increment).load)(increment.pressure[at])
            of_u[at], of_load[at], through[at] = _on_ellipse(increment, slip, load)
        if increment.law.pressure is None:
            return of_u, None
        of_pressure_ = _rate(increment, declared(increment).load)[:, None] * of_load
        if middle := centre(declared(increment)):
            moving = np.stack([_rate(increment, c) for c in middle], axis=1)
            of_pressure_ += moving - np.einsum("nij,nj->ni", through, moving)
        return of_u, np.where(slips[:, None], of_pressure_, 0.0)


def _on_ellipse(increment: Increment, slip: Array, load: Array) -> tuple[Array, Array, Array]:
    """d sigma/d u, d sigma/d e and d sigma/d sigma_tr of slipping points."""
    found = coefficients(increment)
    e = np.zeros_like(load) if found.empty else load
    mu = np.stack([np.where(slip[:, i] < 0.0, found.mu[2 * i + 1], found.mu[2 * i]) for i in (0, 1)], axis=1)
    size = np.abs(slip).max(axis=1, keepdims=True)
    force = mu * (slip / size)
    length = np.hypot(force[:, 0], force[:, 1])[:, None]
    w, multiplier = force / length, (length * size)[:, 0]  # slip_i = lambda w_i/mu_i
    y = mu * w
    s = np.stack([-mu[:, 0] * w[:, 1], mu[:, 1] * w[:, 0]], axis=1)
    root = factors(increment.stiffness)[1].T  # k^-1 = root root^T
    s_root, y_root = s @ root, y @ root
    whole = (s_root * s_root).sum(axis=1) + np.where(e > 0.0, multiplier / e, np.inf)
    root_whole = np.sqrt(whole)[:, None]
    part = s / root_whole  # the same factor twice, so that rounding keeps the symmetry
    of_load = y - part / root_whole * (s_root * y_root).sum(axis=1)[:, None]
    return part[:, :, None] * part[:, None, :], of_load, part[:, :, None] * (s_root @ root.T / root_whole)[:, None, :]


def _rate(increment: Increment, entry: object) -> Array:
    """d entry/d sigma_n (N,), one-sided where the entry has a kink."""
    law = increment.law
    assert law.pressure is not None
    table = law.symbols()
    at = sp.sympify(entry).xreplace({table[name]: sp.Rational(value) for name, value in increment.parameters.items()})
    jet, _ = formula(at, (table[law.pressure],), ())(increment.pressure[:, None], (), second=False)
    assert jet.gradient is not None
    return jet.gradient[:, 0]
